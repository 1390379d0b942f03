"""Meshes of polyhedra: hexahedra where a block is a grid, a hexahedron or a prism, tetrahedra else.

Marks are the polygons on the surface where interfaces lie. A straight side of such a polygon that runs along a line of
the grid becomes one, so that contact begins and ends with an element wherever the shape allows it. Between marks a span
``L`` gets ``ceil(L / size)`` elements, so that the two sides of an interface match where nothing else divides them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from concio.errors import GeometryError
from concio.fem.facets import local_coordinates
from concio.fem.polygon_mesh import mesh_polygon
from concio.fem.tetrahedra import tetrahedra
from concio.kinematics.frames import cross, tangents
from concio.model.polyhedron import Polyhedron

Array = np.ndarray
Mesh = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Mark:
    """A polygon (k, 3) [m] on a face of a body that an interface covers."""

    face: int
    polygon: Array


def mesh_solid(body: Polyhedron, size: float, refinement: int, marks: Sequence[Mark], *, simplices: bool) -> Mesh:
    """Return points (n, 3) and cells (e, 8 or 4) of a body.

    Parameters
    ----------
    body : Polyhedron
    size : float
        Target element size [m].
    refinement : int
        Each element is split this many times more in each direction.
    marks : sequence of Mark
    simplices : bool
        Whether the elements are tetrahedra: blocks that are not hexahedra are then meshed as such at once.

    Raises
    ------
    GeometryError
        The block cannot be meshed.
    """
    grid = body.grid if body.grid is not None else hexahedron(body)
    if grid is not None:
        return _grid_mesh(grid, size, refinement, marks)
    own, axes = _own_frame(body)
    within = [Mark(m.face, _rounded((m.polygon - body.vertices[0]) @ axes.T, body.length)) for m in marks]
    sweep = None if simplices else prism_of(own)
    if sweep is not None:
        points, cells = _prism_mesh(own, sweep, size, refinement, within)
    else:
        points, cells = tetrahedra(own, size / refinement, [m.polygon for m in within])
    return points @ axes + body.vertices[0], cells


def _own_frame(body: Polyhedron) -> tuple[Polyhedron, Array]:
    """Return a body in a frame of its own, and the axes (3, 3) of that; a body that is turned gets the same mesh."""
    normal = body.normals[0]
    first = body.vertices[body.faces[0][1]] - body.vertices[body.faces[0][0]]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    axes = np.array([first, cross(normal, first), normal])
    return replace(body, vertices=_rounded((body.vertices - body.vertices[0]) @ axes.T, body.length)), axes


def _rounded(points: Array, length: float) -> Array:
    """Return points without the rounding that came of turning them: which of equal meshes is made depends on it."""
    unit = float(2.0 ** (np.floor(np.log2(length)) - 42))
    rounded: Array = unit * np.round(points / unit)
    return rounded


def hexahedron(body: Polyhedron) -> Array | None:
    """Return the corners (2, 2, 2, 3) of a body with six faces of four vertices, None for any other."""
    if body.holes or len(body.vertices) != 8 or len(body.faces) != 6 or {len(f) for f in body.faces} != {4}:
        return None
    low = body.faces[0][::-1]
    up: dict[int, int] = {}
    for p, q in body.topology.edges.tolist():
        if (p in low) != (q in low):
            up[p if p in low else q] = q if p in low else p
    if len(set(up.values())) != 4:
        return None
    number = np.array([[[low[0], up[low[0]]], [low[3], up[low[3]]]], [[low[1], up[low[1]]], [low[2], up[low[2]]]]])
    corners: Array = body.vertices[number]
    return corners


def _grid_mesh(grid: Array, size: float, refinement: int, marks: Sequence[Mark]) -> Mesh:
    """Return a refined grid of hexahedra."""
    lines: list[list[float]] = [list(range(n)) for n in grid.shape[:3]]
    for mark in marks:
        at = _grid_coordinates(grid, mark.polygon)
        if at is None:
            continue
        for p, q in zip(at, np.roll(at, -1, axis=0), strict=True):
            for axis in range(3):
                if abs(p[axis] - q[axis]) <= 1e-6:
                    lines[axis].append(float(0.5 * (p[axis] + q[axis])))
    x, y, z = (_spans(np.array(lines[axis]), _lengths(grid, axis), size, refinement) for axis in range(3))
    points = interpolated_grid(grid, x, y, z)
    return points.reshape(-1, 3), grid_cells(points.shape[:3])


def _lengths(grid: Array, axis: int) -> Array:
    """Return the longest edge of the hexahedra along one axis of a grid, one for each step of the axis."""
    edges = np.linalg.norm(np.diff(grid, axis=axis), axis=-1)
    lengths: Array = edges.max(axis=tuple(k for k in range(3) if k != axis))
    return lengths


def _spans(marks: Array, lengths: Array, size: float, refinement: int) -> Array:
    """Return positions along an axis of a grid: at the marks, and between them no farther than the size apart."""
    marks = np.sort(marks)
    keep = np.concatenate([[True], np.diff(marks) > 1e-5])
    marks = marks[keep]
    found = [marks[:1]]
    for a, b in pairwise(marks.tolist()):
        span = (b - a) * lengths[int(0.5 * (a + b))]
        parts = max(1, int(np.ceil(span / size - 1e-6))) * refinement
        found.append(a + (b - a) * np.arange(1, parts + 1) / parts)
    return np.concatenate(found)


def interpolated_grid(grid: Array, x: Array, y: Array, z: Array) -> Array:
    """Return the points (a, b, c, 3) of a grid at positions along its axes, trilinear between its corners."""
    found = grid
    for axis, at in enumerate((x, y, z)):
        first = np.minimum(at.astype(int), found.shape[axis] - 2)
        share = (at - first).reshape([-1 if k == axis else 1 for k in range(4)])
        found = np.take(found, first, axis=axis) * (1 - share) + np.take(found, first + 1, axis=axis) * share
    return found


def grid_cells(shape: Sequence[int]) -> Array:
    """Return the hexahedra (e, 8) of a grid of points."""
    number = np.arange(int(np.prod(shape))).reshape(shape)
    low, high = slice(None, -1), slice(1, None)
    corners = [(low, low), (high, low), (high, high), (low, high)]
    return np.stack([number[i, j, k].ravel() for k in (low, high) for i, j in corners], axis=1)


def _grid_coordinates(grid: Array, points: Array) -> Array | None:
    """Return the positions (n, 3) along the axes of a grid of points on its surface; None where one is off it."""
    shape = np.array(grid.shape[:3]) - 1
    cells = grid_cells(grid.shape[:3])
    first = np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), -1).reshape(-1, 3)
    corners = grid.reshape(-1, 3)
    found = np.full(points.shape, np.nan)
    low, high = corners[cells].min(1), corners[cells].max(1)
    room = 1e-5 * float((high - low).max())
    near = (low <= points.max(0) + room).all(1) & (high >= points.min(0) - room).all(1)
    for cell, base in zip(cells[near], first[near], strict=True):
        local = _inverse(corners[cell], points)
        inside = (np.abs(local - 0.5) <= 0.5 + 1e-6).all(1) & np.isnan(found[:, 0])
        found[inside] = base + local[inside]
    return None if np.isnan(found).any() else found


_SIGNS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])


def _inverse(corners: Array, points: Array) -> Array:
    """Return the local coordinates (n, 3) of points in a trilinear hexahedron (Newton's method)."""
    local = np.full(points.shape, 0.5)
    for _ in range(30):
        each = np.where(_SIGNS[None], local[:, None], 1 - local[:, None])  # (n, 8, 3)
        values = each.prod(2)
        slopes = np.stack(
            [np.where(_SIGNS[:, k], 1.0, -1.0) * np.delete(each, k, axis=2).prod(2) for k in range(3)], axis=2
        )
        jacobian = np.einsum("nck,cd->ndk", slopes, corners)
        if (np.abs(np.linalg.det(jacobian)) < 1e-300).any():
            return np.full(points.shape, np.inf)
        step = np.linalg.solve(jacobian, (values @ corners - points)[..., None])[..., 0]
        local = np.clip(local - step, -2.0, 3.0)
        if np.abs(step).max(initial=0.0) < 1e-13:
            break
    return local


@dataclass(frozen=True, eq=False)
class Sweep:
    """A prism: its base in the plane, and where each vertex of the base goes.

    Parameters
    ----------
    outline : (n, 2) array
        Base, counter-clockwise about the direction of the sweep.
    origin : (3,) array
    axes : (2, 3) array
        The plane of the base.
    low, high : (n,) integer arrays
        Vertices of the base and of the opposite face.
    lift : (3, 3) array
        (1, s, t) @ lift is where the point (s, t) of the base ends.
    """

    outline: Array
    origin: Array
    axes: Array
    low: Array
    high: Array
    lift: Array


def prism_of(body: Polyhedron) -> Sweep | None:
    """Return the sweep of a body that is a prism or a truncated one, None for any other; the longest base is taken."""
    if body.holes:
        return None
    across: dict[int, list[int]] = {}
    for p, q in body.topology.edges.tolist():
        across.setdefault(p, []).append(q)
        across.setdefault(q, []).append(p)
    for number in sorted(range(len(body.faces)), key=lambda k: -len(body.faces[k])):
        base = body.faces[number][::-1]
        n = len(base)
        if 2 * n != len(body.vertices) or len(body.faces) != n + 2:
            continue
        high = []
        for v in base:
            others = [q for q in across[v] if q not in base]
            if len(across[v]) != 3 or len(others) != 1:
                break
            high.append(others[0])
        if len(high) != n or len(set(high)) != n:
            continue
        low_points, high_points = body.vertices[list(base)], body.vertices[high]
        origin, axes = low_points[0], tangents(-body.normals[number])
        flat = (low_points - origin) @ axes.T
        system = np.column_stack([np.ones(n), flat])
        lift, *_ = np.linalg.lstsq(system, high_points, rcond=None)
        if np.abs(system @ lift - high_points).max() <= 1e-7 * np.ptp(body.vertices, axis=0).max():
            return Sweep(flat, origin, axes, np.array(base), np.array(high), lift)
    return None


def _prism_mesh(body: Polyhedron, sweep: Sweep, size: float, refinement: int, marks: Sequence[Mark]) -> Mesh:
    """Return the sweep of a plane mesh: hexahedra of quadrilaterals, tetrahedra of triangles."""
    n = len(sweep.outline)
    sides = np.roll(sweep.outline, -1, axis=0) - sweep.outline
    length = np.hypot(*sides.T)
    breaks: list[list[float]] = [[] for _ in range(n)]
    layers = [0.0, 1.0]
    side_of = {frozenset((int(sweep.low[k]), int(sweep.low[(k + 1) % n]))): k for k in range(n)}
    for mark in marks:
        face = set(body.faces[mark.face])
        own = [k for pair, k in side_of.items() if pair <= face]
        if len(own) == 1 and len(face) == 4:
            k = own[0]
            corner = body.vertices[[sweep.low[k], sweep.low[(k + 1) % n], sweep.high[(k + 1) % n], sweep.high[k]]]
            at = _face_coordinates(corner, mark.polygon)
            for p, q in zip(at, np.roll(at, -1, axis=0), strict=True):
                if abs(p[0] - q[0]) <= 1e-6:
                    breaks[k].append(float(0.5 * (p[0] + q[0])) * length[k])
                if abs(p[1] - q[1]) <= 1e-6:
                    layers.append(float(0.5 * (p[1] + q[1])))
    found = [np.array(sorted(b)) for b in breaks]
    points, cells = mesh_polygon(sweep.outline, size / refinement, found)
    height = float(np.linalg.norm(body.vertices[sweep.high] - body.vertices[sweep.low], axis=1).max())
    level = _spans(np.array(layers), np.array([height]), size, refinement)
    low = sweep.origin + points @ sweep.axes
    high = np.column_stack([np.ones(len(points)), points]) @ sweep.lift
    every = np.concatenate([low * (1 - t) + high * t for t in level])
    step = len(points)
    under = np.concatenate([cells + k * step for k in range(len(level) - 1)])
    if cells.shape[1] == 4:
        return every, np.column_stack([under, under + step])
    return every, wedges_split(under, under + step)


def _face_coordinates(corners: Array, points: Array) -> Array:
    """Return local coordinates (k, 2) of points (k, 3) in a planar quadrilateral (4, 3)."""
    normal = cross(corners[2] - corners[0], corners[3] - corners[1])
    axes = tangents(normal / np.linalg.norm(normal))
    flat = (corners - corners[0]) @ axes.T
    return local_coordinates(np.broadcast_to(flat, (len(points), 4, 2)), (points - corners[0]) @ axes.T)


def wedges_split(low: Array, high: Array) -> Array:
    """Return three tetrahedra for each wedge between triangles (k, 3); diagonals start at the lower node number.

    Neighbouring wedges then divide their common quadrilateral alike (Dompierre et al. 1999).
    """
    order = np.argsort(low, axis=1)
    rows = np.arange(len(low))[:, None]
    a, b = low[rows, order], high[rows, order]
    even = (order[:, 1] - order[:, 0]) % 3 == 1  # (0, 1, 2) turned round keeps its sense
    parts = []
    for cell in (
        np.column_stack([a[:, 0], a[:, 1], a[:, 2], b[:, 2]]), np.column_stack([a[:, 0], a[:, 1], b[:, 2], b[:, 1]]),
        np.column_stack([a[:, 0], b[:, 1], b[:, 2], b[:, 0]]),
    ):  # fmt: skip
        parts.append(np.where(even[:, None], cell, cell[:, [0, 2, 1, 3]]))
    return np.concatenate(parts)


def require_right_handed(points: Array, cells: Array, name: str) -> None:
    """Raise where a mesh has an element that is turned inside out."""
    first = points[cells[:, 0]]
    third = points[cells[:, 4 if cells.shape[1] == 8 else 3]]
    second = points[cells[:, 3 if cells.shape[1] == 8 else 2]]
    volume = (cross(points[cells[:, 1]] - first, second - first) * (third - first)).sum(1)
    if (volume <= 0).any():
        x, y, z = first[int(np.argmin(volume))]
        msg = f"an element of the mesh at ({x:.4g}, {y:.4g}, {z:.4g}) m is turned inside out"
        raise GeometryError(msg, where=f"block '{name}'", hint="the axes of its grid must turn like x, y and z")

