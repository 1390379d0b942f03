"""Bodies in IFC files as surfaces: tessellations, faceted breps, straight prisms, and what is mapped from elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
import shapely

from concio.kinematics.frames import cross, tangents
from concio.kinematics.mass import signed_area
from concio.model.solids.ifc_placement import axes, direction, operator, point
from concio.model.solids.ifc_profiles import indices, rings
from concio.model.solids.step_file import Instance
from concio.model.surfaces import prism_surface
from concio.model.topology import Loop, face_triangles

Array = np.ndarray
Surface = tuple[Array, tuple[Loop, ...]]
"""Vertices (n, 3) and faces without holes."""

MOST_SURFACES = 100_000
"""A file that repeats its parts to more surfaces is refused."""
TESSELLATE = "export the part as a tessellation or faceted brep"
REFUSED = {
    "IFCBOOLEANCLIPPINGRESULT": ("is cut by a boolean operation, which is not carried out", TESSELLATE),
    "IFCBOOLEANRESULT": ("is a boolean operation, which is not carried out", TESSELLATE),
    "IFCCSGSOLID": ("is a solid of boolean operations, which are not carried out", TESSELLATE),
    "IFCADVANCEDBREP": ("has curved faces or edges (advanced brep), which are not read", TESSELLATE),
    "IFCADVANCEDBREPWITHVOIDS": ("has curved faces or edges (advanced brep), which are not read", TESSELLATE),
    "IFCREVOLVEDAREASOLID": ("is a solid of revolution, which is not read", TESSELLATE),
    "IFCFACETEDBREPWITHVOIDS": ("has a cavity", "a block has none: model the blocks round it"),
}


class Bodies:
    """Surfaces of the items of a file, each computed once."""

    def __init__(self) -> None:
        self._known: dict[int, list[Surface]] = {}
        self._count = 0

    def surfaces(self, item: Instance, within: tuple[int, ...] = ()) -> list[Surface]:
        """Return the surfaces of an item of a representation, in coordinates of the product.

        Raises
        ------
        InputError
            The item, or something it consists of, cannot be read.
        """
        if item.number in within:
            item.refuse("contains itself", "save the file once more")
        if item.number not in self._known:
            if item.kind == "IFCMAPPEDITEM":
                found = self._mapped(item, (*within, item.number))
            elif item.kind in READERS:
                found = list(READERS[item.kind](item))
            else:
                item.refuse(*REFUSED.get(item.kind, ("is a kind of geometry that is not read", TESSELLATE)))
            self._known[item.number] = found
        own = self._known[item.number]
        self._count += len(own)
        if self._count > MOST_SURFACES:
            item.refuse(f"repeats its parts to more than {MOST_SURFACES:,} solids", "split the file")
        return own

    def _mapped(self, item: Instance, within: tuple[int, ...]) -> list[Surface]:
        source = item.instance(0)
        matrix = operator(item.instance(1)) @ axes(source.open_instance(0))
        parts = [s for inner in source.instance(1).instances(3) for s in self.surfaces(inner, within)]
        return [moved(part, matrix) for part in parts]


def moved(surface: Surface, matrix: Array) -> Surface:
    """Return a surface after a transformation (4, 4); a mirror turns the faces over."""
    points, faces = surface
    if np.linalg.det(matrix[:3, :3]) < 0:
        faces = tuple(face[::-1] for face in faces)
    return points @ matrix[:3, :3].T + matrix[:3, 3], faces


def _filled(of: Instance, points: Array, loops: list[Loop]) -> list[Loop]:
    """Return a face as it is, or in triangles where it has holes."""
    if len(loops) == 1:
        return loops
    outer = points[list(loops[0])] - points[loops[0][0]]
    normal = cross(outer, np.roll(outer, -1, axis=0)).sum(0)
    length = float(np.linalg.norm(normal))
    if not length > 0:
        of.refuse("has no area")
    normal = normal / length
    frame = tangents(normal)
    flat = [points[list(loop)] @ frame.T for loop in loops]
    if not shapely.Polygon(flat[0], flat[1:]).is_valid:
        of.refuse("has a face whose boundary crosses itself or its holes")
    inner = [loop if signed_area(points[list(loop)] @ frame.T) < 0 else loop[::-1] for loop in loops[1:]]
    return [tuple(t) for t in face_triangles(points, [loops[0], *inner], normal).tolist()]


def _triangulated(item: Instance) -> Iterator[Surface]:
    points = np.array(item.instance(0).rows(0, 3)).reshape(-1, 3)
    renumbered = _renumbered(item, 4)
    faces = [tuple(indices(item, renumbered(row), len(points))) for row in item.listed(3)]
    wrong = next((k for k, face in enumerate(faces, 1) if len(face) != 3), None)
    if wrong is not None:
        item.refuse(f"has {len(faces[wrong - 1])} vertices in triangle {wrong}")
    yield _used(points, [face for face in faces if len(set(face)) == 3])


def _polygonal(item: Instance) -> Iterator[Surface]:
    points = np.array(item.instance(0).rows(0, 3)).reshape(-1, 3)
    renumbered = _renumbered(item, 3)
    faces: list[Loop] = []
    for face in item.instances(2):
        if face.kind not in ("IFCINDEXEDPOLYGONALFACE", "IFCINDEXEDPOLYGONALFACEWITHVOIDS"):
            face.refuse("is not a face of a polygonal face set")
        loops = [face.value(0), *(face.listed(1) if face.kind.endswith("VOIDS") else ())]
        own: list[Loop] = [tuple(indices(face, renumbered(loop), len(points))) for loop in loops]
        if any(len(loop) < 3 for loop in own):
            face.refuse("has less than three vertices, which bound nothing")
        faces += _filled(face, points, own)
    yield _used(points, faces)


def _renumbered(item: Instance, place: int) -> Callable[[object], object]:
    """Return what takes numbers of a face set to those of its points: a list in between is seldom given."""
    table = item.value(place)
    if not isinstance(table, tuple) or not table or not all(type(v) is int for v in table):
        return lambda row: row
    own = table
    return lambda row: tuple(own[k] for k in indices(item, row, len(own)))


def _used(points: Array, faces: list[Loop]) -> Surface:
    """Return a surface without the points that it does not use: face sets of a file may share theirs."""
    used, number = np.unique(np.array([v for f in faces for v in f], dtype=int), return_inverse=True)
    ends = np.cumsum([0] + [len(f) for f in faces]).tolist()
    flat = number.tolist()
    return points[used], tuple(tuple(flat[p:q]) for p, q in pairwise(ends))


def _faces_of(shell: Instance) -> Surface:
    """Return the surface of a shell of faces bounded by polygons."""
    if shell.kind not in ("IFCCLOSEDSHELL", "IFCOPENSHELL", "IFCCONNECTEDFACESET"):
        shell.refuse("is not a shell of faces")
    number: dict[tuple[float, ...], int] = {}
    loops_of: list[tuple[Instance, list[Loop]]] = []
    for face in shell.instances(0):
        if face.kind != "IFCFACE":
            face.refuse("is a face on a surface of its own, which is not read", TESSELLATE)
        loops: list[Loop] = []
        for bound in sorted(face.instances(0), key=lambda b: b.kind != "IFCFACEOUTERBOUND"):
            loop = bound.instance(0)
            if loop.kind != "IFCPOLYLOOP":
                loop.refuse("is a loop of curves, which is not read", TESSELLATE)
            own = tuple(number.setdefault(tuple(point(p)), len(number)) for p in loop.instances(0))
            own = tuple(v for k, v in enumerate(own) if v != own[k - 1])
            loops.append(own if bound.value(1) != "F" else own[::-1])
        if not loops or any(len(loop) < 3 for loop in loops):
            face.refuse("has less than three different vertices, which bound nothing")
        loops_of.append((face, loops))
    points = np.array(list(number), dtype=float).reshape(-1, 3)
    return points, tuple(loop for face, loops in loops_of for loop in _filled(face, points, loops))


def _brep(item: Instance) -> Iterator[Surface]:
    yield _faces_of(item.instance(0))


def _surface_model(item: Instance) -> Iterator[Surface]:
    for shell in item.instances(0):
        yield _faces_of(shell)


def _extruded(item: Instance) -> Iterator[Surface]:
    flat = rings(item.instance(0))
    along, depth = direction(item.instance(2), (0.0, 0.0, 1.0)), item.number_at(3)
    if depth <= 0 or abs(along[2]) < 1e-9:
        item.refuse("is a prism of no height")
    points, faces, holes = prism_surface([np.column_stack([r, np.zeros(len(r))]) for r in flat], depth * along)
    cut: dict[int, list[Loop]] = {}
    for face, loop in holes:
        cut.setdefault(face, []).append(loop)
    filled = tuple(f for k, face in enumerate(faces) for f in _filled(item, points, [face, *cut.get(k, [])]))
    yield moved((points, filled), axes(item.open_instance(1)))


READERS: dict[str, Callable[[Instance], Iterator[Surface]]] = {
    "IFCTRIANGULATEDFACESET": _triangulated, "IFCPOLYGONALFACESET": _polygonal, "IFCFACETEDBREP": _brep,
    "IFCSHELLBASEDSURFACEMODEL": _surface_model, "IFCFACEBASEDSURFACEMODEL": _surface_model,
    "IFCEXTRUDEDAREASOLID": _extruded,
}  # fmt: skip
"""What is read, by class."""
