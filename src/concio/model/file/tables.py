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
    StrictInt,
    StrictStr,
    Tag,
)

from concio.model.file.values import (
    Angle,
    Coefficient,
    Expansion,
    JointStiffness,
    Length,
    Number,
    Stress,
    UnitWeight,
)

Point = Annotated[tuple[Length, ...], Field(min_length=2, max_length=3)]
"""Two coordinates in the plane, three in space."""
Vector = Annotated[tuple[Number, ...], Field(min_length=2, max_length=3)]
Element = Literal["Q4", "Q4I", "Q8", "Q9", "T3", "T6", "H8I", "H8", "H27", "T4", "T10"]
Name = Annotated[StrictStr, Field(min_length=1)]


class Table(BaseModel):
    """A table of a file: unknown keys are an error. Its checks are made when a file is read that has it."""

    model_config = ConfigDict(extra="forbid", defer_build=True)


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
