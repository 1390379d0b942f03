"""Tetrahedra of any polyhedron: points on its edges, its faces and inside, joined by a Delaunay tetrahedralisation.

The Delaunay tetrahedra of points of a convex body fill it exactly, whatever the points. Of a body that is not convex
they do so once the points on its surface are dense enough; whether they do is seen from their volume and from their
outer sides, all of which must lie on faces, and where they do not, points are put closer (after Ruppert's and
Shewchuk's refinement, without its guarantees). Slivers, flat tetrahedra between well spaced points, are taken away by
moving inner points or adding one (Tournois, Srinivasan and Alliez 2009).

A last resort for bodies all of whose surface is seen from one point: tetrahedra from there to triangles of the faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import scipy  # its parts are loaded when they are used: scipy.spatial takes long
import shapely

from concio.errors import GeometryError
from concio.kinematics.frames import cross, tangents
from concio.model.interfaces.near_space import distance_to_surface, winding
from concio.model.polyhedron import Polyhedron
from concio.model.topology import face_triangles

Array = np.ndarray
Mesh = tuple[Array, Array]

GOOD = 0.15
"""Shape of a tetrahedron above which no effort is made to better it; 1 is regular, 0 flat."""
WORST = 0.01
"""Shape below which a mesh is not accepted."""
ROUNDS = 25
"""Rounds in which slivers are taken away."""
FEW = 3
"""Flat tetrahedra between fixed points that are divided in a round; of many, more."""
ROW = 0.75**0.5
"""Distance of the rows of a triangular lattice, over that of its points."""


def tetrahedra(body: Polyhedron, size: float, marks: Sequence[Array] = ()) -> Mesh:
    """Return points (n, 3) and tetrahedra (e, 4) of a body, right-handed.

    Parameters
    ----------
    body : Polyhedron
    size : float
        Target length of edges [m].
    marks : sequence of (k, 3) arrays
        Polygons on faces whose sides should be edges of elements, as far as the size allows [m].

    Raises
    ------
    GeometryError
        The body could not be filled.
    """
    unit = float(np.ptp(body.vertices, axis=0).max())
    best: Mesh | None = None
    attempts = [partial(_delaunay, body, size * share, marks, 0.7**k) for k, share in enumerate((1.0, 0.85, 0.7, 0.5))]
    for attempt in (*attempts, partial(_star, body)):
        found = attempt()
        if found is None or not _fills(body, *found, unit):
            continue
        if best is None or shape_of(*found).min() > shape_of(*best).min():
            best = found
        if shape_of(*best).min() > 0.05:
            break
    if best is None or shape_of(*best).min() < WORST:
        msg = "the block could not be divided into tetrahedra"
        raise GeometryError(
            msg, where=f"block '{body.name}'", hint="divide it into simpler blocks, change mesh_size, or make it rigid"
        )
    return best


def shape_of(points: Array, cells: Array) -> Array:
    """Return the shape (e,) of tetrahedra: volume over the cube of the root mean square edge, 1 where regular."""
    x = points[cells]
    edges = x[:, [1, 2, 3, 2, 3, 3]] - x[:, [0, 0, 0, 1, 1, 2]]
    volume = (cross(edges[:, 0], edges[:, 1]) * edges[:, 2]).sum(1) / 6
    return np.asarray(6 * np.sqrt(2) * volume / ((edges * edges).sum((1, 2)) / 6) ** 1.5)


def _fills(body: Polyhedron, points: Array, cells: Array, unit: float) -> bool:
    """Tell whether tetrahedra have the volume of a body and every outer side lies on one of its faces."""
    x = points[cells]
    volume = (cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) * (x[:, 3] - x[:, 0])).sum(1) / 6
    if volume.min(initial=1.0) <= 0 or abs(volume.sum() - body.volume) > 1e-9 * body.volume:
        return False
    sides = np.sort(np.concatenate([cells[:, list(s)] for s in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))]), axis=1)
    outer, count = np.unique(sides, axis=0, return_counts=True)
    at = points[outer[count == 1]]
    height = np.abs(np.einsum("kcd,fd->kcf", at, body.normals) - body.offsets).max(1)
    return bool((height.min(1) <= 1e-7 * unit).all())


def _delaunay(body: Polyhedron, size: float, marks: Sequence[Array], closer: float) -> Mesh | None:
    """Return the Delaunay mesh of points at about ``size``; those on edges and faces ``closer`` times that."""
    surface = _surface_points(body, size * closer, marks)
    inner = _inner_points(body, size, surface)
    random = np.random.default_rng(7)
    best: Mesh | None = None
    for _ in range(ROUNDS):
        found = _joined(body, np.vstack([surface, inner]), size)
        if found is None:
            return best
        points, cells = found
        shape = shape_of(points, cells)
        if best is None or shape.min() > shape_of(*best).min():
            best = found
        bad = cells[shape < GOOD]
        if not len(bad):
            break
        movable = np.unique(bad[bad >= len(surface)]) - len(surface)
        inner = inner.copy()
        steps = random.uniform(-0.2, 0.2, (len(movable), 3)) * size
        moved = inner[movable] + steps
        stays = (winding(body, moved) < 0.5) | (distance_to_surface(body, moved) < 0.25 * size)
        inner[movable] = np.where(stays[:, None], inner[movable], moved)
        fixed = bad[(bad < len(surface)).all(1)]
        if len(fixed):  # nothing to move: a point in the middle of the flat one, of a few at a time, or of an eighth
            new = points[fixed[:: -(-len(fixed) // max(FEW, len(fixed) // 8))]].mean(1)
            new = new[(winding(body, new) > 0.5) & (distance_to_surface(body, new) > 0.1 * size)]
            inner = np.vstack([inner, new])
    return best


def _joined(body: Polyhedron, points: Array, size: float) -> Mesh | None:
    """Return the Delaunay tetrahedra of points that lie in a body, flat ones on its faces left out."""
    try:
        cells = scipy.spatial.Delaunay(points).simplices.astype(np.int64)
    except scipy.spatial.QhullError:
        return None
    x = points[cells]
    volume = (cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]) * (x[:, 3] - x[:, 0])).sum(1) / 6
    cells[volume < 0] = cells[volume < 0][:, [0, 2, 1, 3]]
    height = np.abs(np.einsum("kcd,fd->kcf", x, body.normals) - body.offsets).max(1)
    on_face = height.min(1) <= 1e-7 * size  # all four corners in the plane of one face
    cells = cells[~on_face]
    if not body.convex:
        cells = cells[winding(body, points[cells].mean(1)) > 0.5]
    return points, cells


def _surface_points(body: Polyhedron, size: float, marks: Sequence[Array]) -> Array:
    """Return points on the vertices, edges and faces of a body, and along marks [m]."""
    unit = float(np.ptp(body.vertices, axis=0).max())
    p, q = body.topology.edges.T
    lines = [(body.vertices[i], body.vertices[j]) for i, j in zip(p.tolist(), q.tolist(), strict=True)]
    lines += [(a, b) for mark in marks for a, b in zip(mark, np.roll(mark, -1, axis=0), strict=True)]
    found = [body.vertices]
    for a, b in lines:
        parts = max(1, int(np.ceil(np.linalg.norm(b - a) / size - 1e-6)))
        found.append(a + np.arange(parts + 1)[:, None] / parts * (b - a))
    points = _distinct(np.concatenate(found), 1e-6 * unit, keep=len(body.vertices))
    points = _distinct(points, 0.3 * size, keep=len(body.vertices)) if marks else points
    for face in range(len(body.faces)):
        axes = tangents(body.normals[face])
        origin = body.vertices[body.faces[face][0]]
        rings = [(body.vertices[list(loop)] - origin) @ axes.T for loop in body.loops_of(face)]
        shape = shapely.Polygon(rings[0], rings[1:])
        flat = _lattice(shape, size)
        if len(flat):
            new = origin + flat @ axes
            distance, _ = scipy.spatial.cKDTree(points).query(new)
            points = np.vstack([points, new[distance > 0.6 * size]])
    return points


def _lattice(shape: shapely.Polygon, size: float) -> Array:
    """Return points (k, 2) of a triangular lattice well inside a polygon, or its middle where there is room for one."""
    x0, y0, x1, y1 = shape.bounds
    rows, columns = int((y1 - y0) / (size * ROW)), int((x1 - x0) / size)
    i, j = np.meshgrid(np.arange(columns + 2), np.arange(rows + 1))
    x = 0.5 * (x0 + x1 - columns * size) + (i - 0.25 + 0.5 * (j % 2) - 0.25) * size
    y = 0.5 * (y0 + y1 - rows * size * ROW) + j * size * ROW
    flat = np.column_stack([x.ravel(), y.ravel()])
    flat = flat[shapely.contains_xy(shape, *flat.T)]
    found: Array = flat[shapely.distance(shapely.boundary(shape), shapely.points(flat)) > 0.5 * size]
    return found


def _inner_points(body: Polyhedron, size: float, surface: Array) -> Array:
    """Return points inside a body on a body-centred lattice, slightly disordered; at least one."""
    low, high = body.vertices.min(0), body.vertices.max(0)
    step = 1.15 * size
    count = ((high - low) / step).astype(int) + 1
    start = 0.5 * (low + high - (count - 1) * step)
    grid = np.stack(np.meshgrid(*(np.arange(n) for n in count), indexing="ij"), -1).reshape(-1, 3) * step
    points = np.vstack([start + grid, start + grid + 0.5 * step])
    points += np.random.default_rng(3).uniform(-0.03, 0.03, points.shape) * size
    points = points[winding(body, points) > 0.5]
    points = points[distance_to_surface(body, points) > 0.5 * size] if len(points) else points
    if len(points):
        distance, _ = scipy.spatial.cKDTree(surface).query(points)
        points = points[distance > 0.6 * size]
    if not len(points) and winding(body, body.centroid[None])[0] > 0.5:
        points = body.centroid[None] + 1e-3 * size * np.array([[0.3, -0.2, 0.1]])
    return points


def _distinct(points: Array, tolerance: float, keep: int) -> Array:
    """Return points without those closer than a tolerance to one before; the first ``keep`` stay."""
    drop = np.zeros(len(points), dtype=bool)
    for i, j in sorted(scipy.spatial.cKDTree(points).query_pairs(tolerance)):
        if not drop[i] and j >= keep:
            drop[j] = True
    return points[~drop]


def _star(body: Polyhedron) -> Mesh | None:
    """Return tetrahedra from one point to triangles of all faces, None where no point sees the whole surface."""
    from scipy.optimize import linprog  # loaded where it is needed: it takes long

    system = np.column_stack([body.normals, np.ones(len(body.normals))])
    found = linprog([0.0, 0.0, 0.0, -1.0], A_ub=system, b_ub=body.offsets, bounds=[(None, None)] * 3 + [(0, None)])
    if found.x is None or found.x[3] <= 1e-6 * body.size:
        return None
    sides = [face_triangles(body.vertices, body.loops_of(f), body.normals[f]) for f in range(len(body.faces))]
    cells = np.concatenate(sides)
    centre = np.full((len(cells), 1), len(body.vertices))
    return np.vstack([body.vertices, found.x[:3]]), np.column_stack([cells[:, [0, 2, 1]], centre])
