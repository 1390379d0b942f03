"""Where things stand in an IFC file: axes, chains of placements, transformation operators, and the unit of length."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from concio.kinematics.frames import cross
from concio.model.solids.step_file import Instance, StepFile, Typed

Array = np.ndarray

PREFIXES = {
    "EXA": 1e18, "PETA": 1e15, "TERA": 1e12, "GIGA": 1e9, "MEGA": 1e6, "KILO": 1e3, "HECTO": 1e2, "DECA": 10.0,
    "DECI": 0.1, "CENTI": 1e-2, "MILLI": 1e-3, "MICRO": 1e-6, "NANO": 1e-9, "PICO": 1e-12, "FEMTO": 1e-15,
    "ATTO": 1e-18,
}  # fmt: skip
PARALLEL = 1e-9
"""Directions closer than this are one, which spans no axes."""


def metres_of(file: StepFile) -> float | None:
    """Return the metres in the unit of length of the project, None where it states none that is known."""
    projects = [p.value(8) for p in file.of_kind("IFCPROJECT")]
    assigned = [file[n] for n in projects if n in file] or file.of_kind("IFCUNITASSIGNMENT")
    for units in assigned:
        for unit in units.instances(0):
            if unit.value(1) == "LENGTHUNIT":
                return _metres(unit)
    return None


def _metres(unit: Instance) -> float | None:
    factor = 1.0
    for _ in range(10):  # a unit defined by another one, which may be defined by another one
        if unit.kind == "IFCSIUNIT":
            if unit.value(3) != "METRE":
                return None
            return factor * PREFIXES.get(unit.text(2), 1.0)
        if unit.kind != "IFCCONVERSIONBASEDUNIT":
            return None
        measure = unit.instance(3)
        value = measure.value(0)
        number = value.value if isinstance(value, Typed) else value
        if type(number) not in (int, float) or not 0 < number < np.inf:
            measure.refuse("holds no positive number: the unit of length cannot be converted")
        factor *= float(number)
        unit = measure.instance(1)
    return unit.refuse("is defined by itself: the unit of length cannot be converted")


def world_left_out(file: StepFile) -> list[str]:
    """Return in a sentence each coordinate system in space of the project that is not the identity, which is left out.

    Placements of products are not moved by it: readers of IFC differ in whether it moves them.

    Raises
    ------
    InputError
        Its z axis is not upright: the direction of gravity in the file is open.
    """
    found: list[str] = []
    for context in _contexts(file):
        matrix = axes(context.open_instance(4))
        if abs(matrix[2, 2] - 1.0) > PARALLEL:
            what = "has a world coordinate system whose z axis is not upright: where gravity acts is open"
            context.refuse(what, "export the model with z upwards and without a coordinate system of its own")
        if not np.allclose(matrix, np.eye(4), rtol=0.0, atol=PARALLEL):
            at = ", ".join(f"{v:g}" for v in matrix[:3, 3])
            turned = np.rad2deg(np.arctan2(matrix[1, 0], matrix[0, 0]))
            found.append(
                f"the world coordinate system of {context.label}, at ({at}) in units of the file and turned by "
                f"{turned:.4g} degrees about z: coordinates and directions are those of the placements of the products"
            )
    return found


def _contexts(file: StepFile) -> Iterator[Instance]:
    """Yield the representation contexts of the projects in space."""
    for project in file.of_kind("IFCPROJECT"):
        for context in project.instances(7) if project.value(7) is not None else ():
            if context.kind == "IFCGEOMETRICREPRESENTATIONCONTEXT" and context.value(2) == 3:
                yield context


def point(at: Instance, dim: int = 3) -> list[float]:
    """Return the coordinates of a point; a point in the plane stands at z = 0 in space."""
    if at.kind != "IFCCARTESIANPOINT":
        at.refuse("is not an IfcCartesianPoint")
    given = at.listed(0)
    return at.checked((*given, 0.0) if dim == 3 and len(given) == 2 else given, dim, 0)


def direction(of: Instance | None, default: tuple[float, ...]) -> Array:
    """Return a direction of length one."""
    found = np.array(default if of is None else of.checked(of.value(0), len(default), 0), dtype=float)
    length = float(np.linalg.norm(found))
    if of is not None and not 0 < length < np.inf:
        of.refuse("is a direction of no length")
    return found / length


def axes(placement: Instance | None) -> Array:
    """Return the matrix (4, 4) of an axis placement in the plane or in space; none stands at the origin."""
    matrix = np.eye(4)
    if placement is None:
        return matrix
    if placement.kind == "IFCAXIS2PLACEMENT2D":
        x, y = direction(placement.open_instance(1), (1.0, 0.0))
        matrix[:2, :2] = [[x, -y], [y, x]]
        matrix[:3, 3] = [*point(placement.instance(0), 2), 0.0]
        return matrix
    if placement.kind != "IFCAXIS2PLACEMENT3D":
        placement.refuse("is not a placement that can be read", "place the part by IfcAxis2Placement3D")
    z = direction(placement.open_instance(1), (0.0, 0.0, 1.0))
    given = placement.open_instance(2)
    along = direction(given, (0.0, 1.0, 0.0) if given is None and abs(z[0]) > 1 - PARALLEL else (1.0, 0.0, 0.0))
    matrix[:3, :3] = np.column_stack(_frame(placement, along, z))
    matrix[:3, 3] = point(placement.instance(0))
    return matrix


def _frame(of: Instance, along: Array, z: Array) -> tuple[Array, Array, Array]:
    x = along - (along @ z) * z
    length = float(np.linalg.norm(x))
    if length < PARALLEL:
        of.refuse("has two parallel directions, which span no axes")
    x = x / length
    return x, cross(z, x), z


class Placements:
    """Matrices (4, 4) of placements of products, each computed once."""

    def __init__(self) -> None:
        self._known: dict[int, Array] = {}

    def matrix(self, placement: Instance | None) -> Array:
        """Return what takes the coordinates of a product into those of the project."""
        chain: list[Instance] = []
        seen: set[int] = set()
        while placement is not None and placement.number not in self._known:
            if placement.kind != "IFCLOCALPLACEMENT":
                hint = "export with local placements"
                placement.refuse("is a placement along a grid or a line, which is not read", hint)
            if placement.number in seen:
                placement.refuse("is placed relative to itself", "give it a placement of its own")
            seen.add(placement.number)
            chain.append(placement)
            placement = placement.open_instance(0)
        matrix = np.eye(4) if placement is None else self._known[placement.number]
        for own in reversed(chain):
            matrix = self._known[own.number] = matrix @ axes(own.open_instance(1))
        return matrix


def operator(of: Instance) -> Array:
    """Return the matrix (4, 4) of a transformation operator in space: axes, origin and scales."""
    if of.kind not in ("IFCCARTESIANTRANSFORMATIONOPERATOR3D", "IFCCARTESIANTRANSFORMATIONOPERATOR3DNONUNIFORM"):
        of.refuse("is not a transformation in space that can be read")
    third = direction(of.open_instance(4), (0.0, 0.0, 1.0))
    first = of.open_instance(0)
    along = direction(first, (0.0, 1.0, 0.0) if first is None and abs(third[0]) > 1 - PARALLEL else (1.0, 0.0, 0.0))
    x, y, z = _frame(of, along, third)
    second = of.open_instance(1)
    if second is not None and float(direction(second, (0.0, 1.0, 0.0)) @ y) < 0:
        y = -y  # a mirror
    scale = 1.0 if of.value(3) is None else of.number_at(3)
    scales = [scale, *(scale if of.value(k) is None else of.number_at(k) for k in (5, 6))]
    if not min(scales) > 0:
        of.refuse("has a scale that is not positive")
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack([x, y, z]) * scales
    matrix[:3, 3] = point(of.instance(2))
    return matrix
