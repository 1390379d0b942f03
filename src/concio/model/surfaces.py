"""Surfaces of polyhedra: triangles, coplanar faces put together, grids of hexahedra and prisms as closed surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from concio.errors import GeometryError
from concio.kinematics.frames import cross, tangents
from concio.kinematics.mass import signed_area
from concio.model.linked import linked, pairs_within
from concio.model.polyhedron import Polyhedron
from concio.model.topology import Loop, topology

if TYPE_CHECKING:
    from collections.abc import Iterable

Array = np.ndarray
Surface = tuple[Array, tuple[Loop, ...], tuple[tuple[int, Loop], ...]]
"""Vertices (n, 3), faces, and holes of faces as in :class:`Polyhedron`."""

COPLANAR = 1e-6
"""Share of the longest side of a block by which two faces may leave one plane and still be put together."""


def merged_faces(
    points: Array, faces: Sequence[Loop], holes: Sequence[tuple[int, Loop]] = (), *, within: float = 0.0
) -> Surface:
    """Return a closed surface with neighbouring coplanar faces put together and needless vertices left out.

    Faces that do not close are returned as they are. Faces are coplanar within the larger of :data:`COPLANAR` of the
    block's size and ``within`` [m].
    """
    top = topology(tuple(faces), tuple(holes))
    if top.fault is not None:
        return points, tuple(faces), tuple(holes)
    size = float(np.ptp(points, axis=0).max())
    area = top.area_vectors(points)
    length = np.linalg.norm(area, axis=1)
    normal = area / np.where(length > 0, length, 1.0)[:, None]
    middle = top.by_face(points[top.start]) / top.sides_of_face[:, None]
    a, b = top.edge_faces.T
    order = np.argsort(top.face, kind="stable")
    begin = np.concatenate([[0], np.cumsum(top.sides_of_face)])
    worst = np.zeros(len(a))
    for first, second in ((a, b), (b, a)):  # vertices of the second off the plane of the first
        count = top.sides_of_face[second]
        edge = np.repeat(np.arange(len(a)), count)
        side = order[np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + begin[second][edge]]
        off = np.abs(((points[top.start[side]] - middle[first][edge]) * normal[first][edge]).sum(1))
        np.maximum.at(worst, edge, off)
    same = (worst <= max(COPLANAR * size, within)) & ((normal[a] * normal[b]).sum(1) > 0.5)
    group = linked(np.stack([a[same], b[same]], 1), len(faces))
    number = int(group.max(initial=-1)) + 1
    if number == len(faces):
        return straightened(points, tuple(faces), tuple(holes))
    inner = same[_edge_of_side(top)]
    new_faces: list[Loop] = []
    new_holes: list[tuple[int, Loop]] = []
    for g in range(number):
        sides = np.flatnonzero((group[top.face] == g) & ~inner)
        loops = _chained(top.start[sides].tolist(), top.end[sides].tolist())
        frame = tangents(normal[int(np.flatnonzero(group == g)[np.argmax(length[group == g])])])
        areas = [signed_area(points[list(loop)] @ frame.T) for loop in loops]
        outer = [loop for loop, value in zip(loops, areas, strict=True) if value > 0]
        first = len(new_faces)
        new_faces += outer
        for loop, value in zip(loops, areas, strict=True):
            if value <= 0:
                new_holes.append((first + _holder(points, frame, outer, loop), loop))
    return straightened(points, tuple(new_faces), tuple(new_holes))


def _edge_of_side(top: Any) -> Array:
    """Return the number of the edge (s,) of each side."""
    low, high = np.minimum(top.start, top.end), np.maximum(top.start, top.end)
    base = int(top.edges.max()) + 1
    found: Array = np.searchsorted(top.edges[:, 0] * base + top.edges[:, 1], low * base + high)
    return found


def _chained(start: list[int], end: list[int]) -> list[Loop]:
    """Return closed loops of directed sides."""
    following: dict[int, list[int]] = {}
    for p, q in zip(start, end, strict=True):
        following.setdefault(p, []).append(q)
    loops = []
    while following:
        first = next(iter(following))
        loop, at = [], first
        while True:
            loop.append(at)
            ways = following[at]
            at_next = ways.pop()
            if not ways:
                del following[at]
            at = at_next
            if at == first:
                break
        loops.append(tuple(loop))
    return loops


def _holder(points: Array, frame: Array, outer: Sequence[Loop], hole: Loop) -> int:
    if len(outer) == 1:
        return 0
    at = points[hole[0]] @ frame.T
    for k, loop in enumerate(outer):
        if shapely.intersects_xy(shapely.Polygon(points[list(loop)] @ frame.T), *at):
            return k
    return 0


def straightened(points: Array, faces: tuple[Loop, ...], holes: tuple[tuple[int, Loop], ...]) -> Surface:
    """Return the surface without vertices in the middle of straight edges, and without those no face uses."""
    top = topology(faces, holes)
    size = float(np.ptp(points, axis=0).max())
    degree = np.bincount(top.edges.ravel(), minlength=len(points))
    keep = degree > 0
    for v in np.flatnonzero(degree == 2).tolist():
        p, q = (int(e.sum()) - v for e in top.edges[(top.edges == v).any(1)])
        along = points[q] - points[p]
        arm = points[v] - points[p]
        off = np.linalg.norm(cross(along, arm)) / max(float(np.linalg.norm(along)), 1e-300)
        keep[v] = off > 1e-9 * size
    if keep.all():
        return points, faces, holes
    new = (np.cumsum(keep) - 1).tolist()

    def renamed(loop: Loop) -> Loop:
        return tuple(new[v] for v in loop if keep[v])

    return points[keep], tuple(map(renamed, faces)), tuple((face, renamed(loop)) for face, loop in holes)


def welded(points: Array, faces: Iterable[Sequence[int]], tolerance: float) -> tuple[Array, tuple[Loop, ...]]:
    """Return vertices put together within a tolerance [m], and the faces without repeated or lost vertices."""
    group = linked(pairs_within(points, tolerance), len(points))
    number = int(group.max(initial=-1)) + 1
    count = np.bincount(group, minlength=number)
    mean = np.stack([np.bincount(group, points[:, k], number) / count for k in range(3)], 1)
    kept = []
    for face in faces:
        loop = [int(group[v]) for v in face]
        loop = [v for k, v in enumerate(loop) if v != loop[k - 1]]
        if len(set(loop)) >= 3:
            kept.append(tuple(loop))
    return mean, tuple(kept)


def grid_surface(grid: Array) -> Surface:
    """Return the closed surface of a grid of hexahedra (nx + 1, ny + 1, nz + 1, 3).

    The first three indices run along directions that turn like x, y and z; coplanar cell faces become one face.
    """
    grid = np.asarray(grid, dtype=float)
    number = np.arange(int(np.prod(grid.shape[:3]))).reshape(grid.shape[:3])
    faces: list[Loop] = []
    for axis in range(3):
        for end in (0, -1):
            sheet = np.take(number, end, axis=axis)  # (p, q) in the order of the other two axes
            quads = np.stack([sheet[:-1, :-1], sheet[1:, :-1], sheet[1:, 1:], sheet[:-1, 1:]], -1).reshape(-1, 4)
            outward = (end == -1) == (axis != 1)  # x: (y, z) turn like x; y: (x, z) turn against y; z: (x, y) like z
            faces += [tuple(q) for q in (quads if outward else quads[:, ::-1]).tolist()]
    points = grid.reshape(-1, 3)
    return merged_faces(*_collapsed(points, faces))


def _collapsed(points: Array, faces: list[Loop]) -> tuple[Array, tuple[Loop, ...]]:
    """Return a surface with coinciding vertices put together: a grid may end in an edge or a point."""
    size = float(np.ptp(points, axis=0).max())
    used = np.unique(np.array([v for f in faces for v in f]))
    new = np.zeros(len(points), dtype=int)
    new[used] = np.arange(len(used))
    return welded(points[used], [[int(new[v]) for v in f] for f in faces], 1e-9 * size)


def from_grid(name: str, grid: Array, **fields: Any) -> Polyhedron:
    """Return the block that a grid of hexahedra fills; it keeps the grid for its mesh.

    Parameters
    ----------
    name : str
    grid : (nx + 1, ny + 1, nz + 1, 3) array
        Corners of the hexahedra [m]; the indices run along directions that turn like x, y and z.
    **fields
        Further fields of :class:`Polyhedron`.
    """
    points, faces, holes = grid_surface(grid)
    return Polyhedron(name, points, faces, holes=holes, grid=grid, **fields)


def prism(name: str, rings: Sequence[Array], direction: Array, **fields: Any) -> Polyhedron:
    """Return the block that a planar polygon sweeps along a vector.

    Parameters
    ----------
    name : str
    rings : sequence of (n, 3) arrays
        Boundary of the polygon counter-clockwise about ``direction``, then those of its holes, either way round [m].
    direction : (3,) array
        [m].
    **fields
        Further fields of :class:`Polyhedron`.
    """
    if not np.linalg.norm(direction) > 0:
        msg = "the prism has no height"
        raise GeometryError(msg, where=f"block '{name}'")
    points, faces, holes = prism_surface(rings, np.asarray(direction, dtype=float))
    return Polyhedron(name, points, faces, holes=holes, **fields)


def prism_surface(rings: Sequence[Array], direction: Array) -> Surface:
    """Return the closed surface of a prism; see :func:`prism`."""
    axes = tangents(direction / np.linalg.norm(direction))
    turned = [ring if (signed_area(ring @ axes.T) > 0) == (k == 0) else ring[::-1] for k, ring in enumerate(rings)]
    low = np.concatenate(turned)
    n = len(low)
    ends = np.cumsum([0] + [len(ring) for ring in turned]).tolist()
    faces: list[Loop] = []
    holes: list[tuple[int, Loop]] = []
    for k, (p, q) in enumerate(pairwise(ends)):
        lower, upper = tuple(range(q - 1, p - 1, -1)), tuple(range(p + n, q + n))
        if k == 0:
            faces += [lower, upper]
        else:
            holes += [(0, lower), (1, upper)]
    for p, q in pairwise(ends):
        for v in range(p, q):
            w = v + 1 if v + 1 < q else p
            faces.append((v, w, w + n, v + n))
    return np.vstack([low, low + direction]), tuple(faces), tuple(holes)
