"""Tables of a model file: what keys there are and what values they take.

Every table refuses keys it does not know. Values are in kN and m after validation (:mod:`concio.model.file.values`).
"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    StrictBool,
    StrictInt,
    StrictStr,
    Tag,
    ValidationInfo,
    field_validator,
)

from concio.model.file.values import (
    Angle,
    Coefficient,
    Degrees,
    Expansion,
    Force,
    JointStiffness,
    Kelvin,
    KelvinGradient,
    Length,
    Number,
    Stiffness,
    Stress,
    UnitWeight,
    converted,
    units_of,
)
from concio.model.model import Face

Point = Annotated[tuple[Length, ...], Field(min_length=2, max_length=3)]
"""Two coordinates in the plane, three in space."""
Vector = Annotated[tuple[Number, ...], Field(min_length=2, max_length=3)]
Element = Literal["Q4", "Q4I", "Q8", "Q9", "T3", "T6", "H8I", "H8", "H27", "T4", "T10"]
Name = Annotated[StrictStr, Field(min_length=1)]

LOAD_KINDS: dict[str, tuple[str, tuple[int, ...]]] = {
    "weight": ("number", (2, 3)),
    "pressure": ("stress", (1,)),
    "traction": ("stress", (2, 3)),
    "point": ("force", (2, 3)),
    "body": ("unit weight", (2, 3)),
}
"""Kind of quantity and possible numbers of entries of ``value`` for each kind of load."""


class Table(BaseModel):
    """A table of a file: unknown keys are an error."""

    model_config = ConfigDict(extra="forbid")


class UnitsTable(Table):
    """The consistent system of the bare numbers of the file.

    Keys
    ----
    force :
        Unit of forces.
    length :
        Unit of lengths; stresses and weights follow from both.
    """

    force: Literal["N", "kN", "MN"] = "kN"
    length: Literal["mm", "cm", "m"] = "m"


class ReportTable(Table):
    """Units in which results are reported; see :class:`concio.Units`."""

    force: Literal["kN", "N", "MN", "kgf", "tf"] = "kN"
    length: Literal["m", "cm", "mm", "ft", "in"] = "m"
    motion: Literal["mm", "m", "cm", "in"] = "mm"
    stress: Literal["auto", "kN/m2", "MPa", "N/mm2", "kPa", "Pa", "bar", "kgf/cm2", "tf/m2"] = "auto"


class MaterialTable(Table):
    """A material; ``kind = "rigid"`` has a unit weight and an expansion only.

    Keys
    ----
    kind :
        A rigid material does not deform.
    E :
        Young's modulus.
    nu :
        Poisson's ratio.
    unit_weight :
        Weight per volume.
    expansion :
        Strain for each kelvin.
    """

    kind: Literal["elastic", "rigid"] = "elastic"
    E: Stress | None = None
    nu: Number | None = None
    unit_weight: UnitWeight = 0.0
    expansion: Expansion = 0.0


class JointTable(Table):
    """A law of joints; see :class:`concio.model.materials.JointLaw`."""

    friction: Coefficient
    cohesion: Stress = 0.0
    tensile_strength: Stress = 0.0
    dilatancy: Coefficient = 0.0
    normal_stiffness: JointStiffness | None = None
    tangential_stiffness: JointStiffness | None = None
    compressive_strength: Stress | None = None


ANGLE = re.compile(r"^\s*[-+.\d,]+\s*(deg|°|rad|gon)")
"""How a text begins that is the angle of a coefficient, and no name."""


def _branch(value: Any) -> str:
    if isinstance(value, dict | Table):
        return "<table>"
    return "<name>" if isinstance(value, str) and not ANGLE.search(value) else "<number>"


def word_or_table(value: Any) -> str:
    """Return the branch of a value that is a table or the name of one."""
    return "<table>" if isinstance(value, dict | Table) else "<name>"


Friction = Annotated[
    Annotated[Coefficient, Tag("<number>")]
    | Annotated[JointTable, Tag("<table>")]
    | Annotated[StrictStr, Tag("<name>")],
    Discriminator(_branch),
]
"""A coefficient, its angle with a unit, a table, or the name of a table in ``[joints]``."""
Material = Annotated[
    Annotated[MaterialTable, Tag("<table>")] | Annotated[StrictStr, Tag("<name>")], Discriminator(word_or_table)
]
"""A table, or the name of a table in ``[materials]``."""


class CourseTable(Table):
    """A course of a bond in block lengths; see :class:`concio.model.generate.bonds.Course`."""

    unit: list[Number]
    left: list[Number] = Field(default_factory=list)
    right: list[Number] = Field(default_factory=list)
    height: Number = 1.0


def _bond_branch(value: Any) -> str:
    return "<list>" if isinstance(value, list | tuple) else "<name>"


def _course_branch(value: Any) -> str:
    return "<table>" if isinstance(value, dict | Table) else "<list>"


Course = Annotated[
    Annotated[CourseTable, Tag("<table>")] | Annotated[list[Number], Tag("<list>")], Discriminator(_course_branch)
]
"""A table, or the lengths that repeat from the left end on."""
Bond = Annotated[
    Annotated[StrictStr, Tag("<name>")] | Annotated[list[Course], Tag("<list>")], Discriminator(_bond_branch)
]
"""The name of a bond, or courses of the file's own from below."""


class RuleTable(Table):
    """Which law the joints between two sorts of bodies have; the last rule that fits wins.

    Keys
    ----
    law :
        Name of a table in ``[joints]``.
    between :
        Roles, layers or names of the two bodies; * stands for any text.
    gap :
        Initial gap of these joints, closed before they press.
    """

    law: Name
    between: tuple[StrictStr, StrictStr] = ("*", "*")
    gap: Length = 0.0


class GridTable(Table):
    """Mesh lines of a rectangular block.

    Keys
    ----
    x, y :
        Places of the mesh lines from one side to the other.
    """

    x: list[Length]
    y: list[Length]


class HoleTable(Table):
    """A hole in a face of a block in space: the number of the face from 0, and its vertices.

    Keys
    ----
    face :
        Number of the face, from 0.
    loop :
        Numbers of the vertices around the hole, from 0.
    """

    face: StrictInt
    loop: list[StrictInt]


Hole = Annotated[
    Annotated[HoleTable, Tag("<table>")] | Annotated[list[Point], Tag("<list>")], Discriminator(_course_branch)
]
"""A hole in a face of a block in space, or an outline in the plane."""


class BlockTable(Table):
    """A block, a mortar film or an obstacle.

    In the plane an outline, or a rectangle by two opposite corners, and holes in it; in space vertices and faces, or a
    box by two opposite corners.

    Keys
    ----
    name :
        Name of the block; each has its own.
    outline :
        Vertices of a polygon, in order.
    holes :
        Holes in the outline, or in faces of a block in space.
    rectangle :
        Two opposite corners, in place of an outline.
    vertices :
        Vertices of a block in space.
    faces :
        Vertices of each face by number from 0, counter-clockwise seen from outside.
    box :
        Two opposite corners of a block in space, in place of vertices and faces.
    material :
        Name of a table in ``[materials]``.
    kind :
        "fixed" is an obstacle, "rigid" does not deform; by default what the material is.
    role :
        Word by which rules find the block, such as "mortar".
    layer :
        Layer of a drawing, by which rules and loads find the block too.
    thickness :
        Out of plane, where it is not that of the model.
    mesh_size :
        Target element size, where it is not that of the model.
    grid :
        Mesh lines of a rectangular block.
    """

    name: Name
    outline: list[Point] | None = None
    holes: list[Hole] = Field(default_factory=list)
    rectangle: tuple[Point, Point] | None = None
    vertices: list[Point] | None = None
    faces: list[list[StrictInt]] | None = None
    box: tuple[Point, Point] | None = None
    hexahedra: list[list[list[Point]]] | None = Field(None, description="corners of hexahedra that fill the block")
    material: StrictStr = "block"
    kind: Literal["elastic", "rigid", "fixed"] | None = None
    role: StrictStr | None = None
    layer: StrictStr = ""
    thickness: Length | None = None
    mesh_size: Length | None = None
    grid: GridTable | None = None


def _rotation_branch(value: Any) -> str:
    return "<list>" if isinstance(value, list | tuple) else "<number>"


Rotation = Annotated[
    Annotated[Angle, Tag("<number>")] | Annotated[tuple[Angle, Angle, Angle], Tag("<list>")],
    Discriminator(_rotation_branch),
]
"""An angle in the plane; in space a vector of rotation about x, y, z."""


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
        Out of plane, of bodies that state none.
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
