"""Tables of a model file for what acts on bodies, and for the analysis: supports, loads, ties, stages, parts."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool, StrictInt, StrictStr, ValidationInfo, field_validator

from concio.model.file.tables import Element, Name, Point, Rotation, Table, Vector
from concio.model.file.values import (
    Degrees,
    Force,
    Kelvin,
    KelvinGradient,
    Length,
    Number,
    Stiffness,
    converted,
    units_of,
)
from concio.model.model import Face

LOAD_KINDS: dict[str, tuple[str, tuple[int, ...]]] = {
    "weight": ("number", (2, 3)),
    "pressure": ("stress", (1,)),
    "traction": ("stress", (2, 3)),
    "point": ("force", (2, 3)),
    "body": ("unit weight", (2, 3)),
}
"""Kind of quantity and possible numbers of entries of ``value`` for each kind of load."""


class SupportTable(Table):
    """A support: of a whole body, of an edge, of a polygon on faces in space, or of the point ``at``.

    Keys
    ----
    name :
        Name of the support; reactions are reported under it.
    body :
        Name of the block that is held.
    edge :
        Both ends of the edge that is held.
    polygon :
        Polygon on faces of a block in space that is held.
    at :
        Point that is held; without edge, polygon and point the whole body is.
    directions :
        Directions in which it is held.
    displacement :
        Displacement that is imposed at factor 1.
    rotation :
        Rotation that is imposed at factor 1.
    group :
        Load group whose factor multiplies what is imposed.
    """

    name: Name
    body: Name
    edge: tuple[Point, Point] | None = None
    polygon: list[Point] | None = None
    at: Point | None = None
    directions: Literal["all", "x", "y", "z", "xy", "xz", "yz", "xyz"] = "all"
    displacement: Point | None = None
    rotation: Rotation = 0.0
    group: Name = "settlement"


def load_value(kind: str, value: Any, info: ValidationInfo) -> tuple[float, ...]:
    """Return the numbers of a load in kN and m."""
    quantity, entries = LOAD_KINDS[kind]
    parts = value if isinstance(value, list) else [value]
    if len(parts) not in entries:
        form = "one number" if entries == (1,) else "two numbers [x, y], or three in space"
        msg = f"a {kind} load takes {form}, not {len(parts)}"
        raise ValueError(msg)
    return tuple(converted(part, quantity, units_of(info)) for part in parts)


class LoadTable(Table):
    """A load; the unit of ``value`` follows from its kind.

    Keys
    ----
    kind :
        "weight": multiples of self-weight; "pressure" and "traction": on edges or faces; "point": a force; "body": a
        force per volume.
    bodies :
        Names of the blocks that it acts on; none names all.
    edge :
        Both ends of the edge that it acts on.
    polygon :
        Polygon on faces of blocks in space that it acts on.
    at :
        Point of application of a force.
    group :
        Load group, whose factor multiplies it.
    face :
        Faces that it acts on, by the side that they look to.
    """

    kind: Literal["weight", "pressure", "traction", "point", "body"]
    value: Annotated[Any, Field(description="a number for pressure, [x, y] otherwise, [x, y, z] in space")]
    bodies: list[StrictStr] = Field(default_factory=list)
    edge: tuple[Point, Point] | None = None
    polygon: list[Point] | None = None
    at: Point | None = None
    group: Name = "dead"
    face: Face | None = None

    @field_validator("value", mode="after")
    @classmethod
    def _value(cls, value: Any, info: ValidationInfo) -> tuple[float, ...]:
        return load_value(info.data["kind"], value, info) if "kind" in info.data else ()


class TemperatureTable(Table):
    """A change of temperature of bodies, which expand or shrink.

    Keys
    ----
    change :
        Change of the temperature at ``at``; negative cools.
    bodies :
        Names, roles, layers, or patterns of names; none: every body that is not fixed.
    gradient :
        How the change grows along x, y and, in space, z.
    at :
        Where the change is reached; none: at the centroid of each body.
    group :
        Load group that scales it.
    """

    change: Kelvin
    bodies: list[StrictStr] = Field(default_factory=list)
    gradient: Annotated[tuple[KelvinGradient, ...], Field(max_length=3)] = ()
    at: Point | None = None
    group: Name = "temperature"


class TieTable(Table):
    """A bar that takes tension only; without ``body_b`` it ends at a fixed point.

    Keys
    ----
    name :
        Name of the tie.
    body_a, body_b :
        Blocks that it joins; without the second it ends at a fixed point.
    at_a, at_b :
        Ends.
    stiffness :
        Force per elongation.
    prestress :
        Force before anything is loaded.
    yield_force :
        Force at which it yields; none: it does not.
    break_elongation :
        Elongation at which it breaks; none: it does not.
    kind :
        "soil" presses in place of pulling: a one-way spring with a cap.
    """

    name: Name
    body_a: Name
    at_a: Point
    body_b: StrictStr = ""
    at_b: Point
    stiffness: Stiffness
    prestress: Force = 0.0
    yield_force: Force | None = None
    break_elongation: Length | None = None
    kind: Literal["bar", "soil"] = "bar"


class ControlTable(Table):
    """A point whose displacement is controlled; see :class:`concio.model.stages.ControlPoint`."""

    body: Name
    at: Point
    direction: Vector = (1.0, 0.0)


class StageTable(Table):
    """A stage of a load path; see :class:`concio.model.stages.Stage`.

    Factors are plain numbers, but those called "stress xx", "stress yy", "stress xy" (of a periodic cell) are stresses.

    Keys
    ----
    name :
        Name of the stage.
    """

    name: Name
    factors: dict[str, Any]
    control: ControlTable | None = None
    until: Length = 0.0
    steps: StrictInt = 20

    @field_validator("factors", mode="after")
    @classmethod
    def _factors(cls, value: dict[str, Any], info: ValidationInfo) -> dict[str, float]:
        units = units_of(info)
        kinds = {name: "stress" if name.startswith("stress ") else "number" for name in value}
        return {name: converted(v, kinds[name], units) for name, v in value.items()}


class AnalysisTable(Table):
    """How the model is meshed and how joints are found; see :class:`concio.model.model.Model`.

    Keys
    ----
    thickness :
        Out of plane, of bodies that state none; also in the files of its parts, where these state none.
    """

    plane: Literal["stress", "strain"] = "stress"
    element: Element = "Q4"
    mesh_size: Length | None = None
    refinement: StrictInt = 1
    gap_tolerance: Length | None = None
    gap_reach: Length | None = None
    thickness: Length = 1.0
    contact_points: StrictInt | Literal["auto", "corners"] = "auto"


class SolverTable(Table):
    """What solves the linear systems; "pardiso" comes with ``pip install 'concio[fast]'``.

    Keys
    ----
    engine :
        Library that factorises the linear systems.
    """

    engine: Literal["superlu", "pardiso"] = "superlu"


class ExtrusionTable(Table):
    """Sweeps the plane structure of the file into space; see :func:`concio.extrude`."""

    thickness: Length | None = None
    held: StrictBool = False


class PartTable(Table):
    """A part of the structure: a model file or a generator, placed; see :func:`concio.place`.

    Keys
    ----
    file :
        Another model file, beside this one; in place of a generator.
    repeat :
        How many copies stand in a row.
    step :
        From one copy to the next.
    """

    name: Name | None = None
    file: Name | None = None
    at: Point | None = None
    turn: Degrees = 0.0
    axis: tuple[Number, Number, Number] | None = None
    mirror: StrictStr = ""
    loads: Literal["body", "world"] = "body"
    without: StrictStr | list[StrictStr] = ""
    repeat: Annotated[StrictInt, Field(ge=1, le=10_000)] = 1
    step: Point | None = None
