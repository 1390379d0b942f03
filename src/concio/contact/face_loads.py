"""Pressure and traction on faces in space: the parts of faces that lie in the polygon of a load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from concio.contact.edge_loads import line_tolerance, loaded_bodies, prefers
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID, Discretisation
from concio.fem.solid import SolidShape
from concio.kinematics.frames import tangents
from concio.kinematics.rigid import rigid_operator
from concio.model.model import Load, Model
from concio.model.overlay import common, without

Array = np.ndarray


def plane_of(polygon: Array) -> tuple[Array, Array, Array]:
    """Return a point (3,), the unit normal (3,) and two axes (2, 3) of the plane that fits a polygon (n, 3) best."""
    middle = polygon.mean(0)
    normal = np.linalg.svd(polygon - middle)[2][2]
    return middle, normal, tangents(normal)


def near_polygon(points: Array, polygon: Array, tolerance: float) -> Array:
    """Return which points (n, 3) lie within a tolerance of a planar polygon (k, 3) [m]."""
    middle, normal, axes = plane_of(polygon)
    near: Array = np.abs((points - middle) @ normal) <= tolerance
    shape = shapely.Polygon((polygon - middle) @ axes.T).buffer(tolerance)
    near[near] = shapely.intersects_xy(shape, *((points[near] - middle) @ axes.T).T)
    return near


@dataclass(frozen=True, eq=False)
class LoadedPart:
    """Part of a face that a uniform load acts on.

    Parameters
    ----------
    body, face : int
    part : shapely geometry
        In the plane of the load.
    middle, axes : (3,), (2, 3) arrays
        Origin and axes of that plane.
    pull : (3,) array
        [kN/m2].
    """

    body: int
    face: int
    part: shapely.Geometry
    middle: Array
    axes: Array
    pull: Array

    @property
    def centre(self) -> Array:
        """Centroid (3,) [m]."""
        found: Array = self.middle + np.array([self.part.centroid.x, self.part.centroid.y]) @ self.axes
        return found

    @property
    def force(self) -> Array:
        """Resultant (3,) [kN]."""
        found: Array = self.pull * float(self.part.area)
        return found


def add_face_load(disc: Discretisation, load: Load, f: Array) -> None:
    """Add the nodal forces of a pressure or traction: on parts of faces that lie in its polygon, or along its edge.

    Raises
    ------
    InputError
        There is neither polygon nor edge, the polygon has no area or is not planar, or no face of a body lies in it.
    """
    if load.edge is not None:
        _along_line(disc, load, f)
        return
    for p in loaded_parts(disc.model, load):
        _uniform(disc, p.body, p.face, p.part, p.middle, p.axes, p.pull, f)


def loaded_parts(model: Model, load: Load) -> list[LoadedPart]:
    """Return the parts of faces that the polygon of a pressure or traction covers.

    Raises
    ------
    InputError
        There is no polygon, it has no area or is not planar, or no face of a body lies in it.
    """
    where = f"load group '{load.group}'"
    if load.polygon is None:
        msg = f"a {load.kind} load in space needs a polygon"
        raise InputError(msg, where=where, hint="give the vertices of the loaded area, in order")
    corners = np.array(load.polygon, dtype=float)
    middle, normal, axes = plane_of(corners)
    tolerance = line_tolerance(model, load)
    off = float(np.abs((corners - middle) @ normal).max())
    area = shapely.Polygon((corners - middle) @ axes.T)
    if off > tolerance:
        msg = f"the polygon of a {load.kind} load is not planar: a vertex stands {1e3 * off:.4g} mm off its plane"
        raise InputError(msg, where=where, hint="give several polygons, one for each plane")
    if not area.is_valid or area.area <= tolerance * area.length:
        msg = f"the polygon of a {load.kind} load crosses itself or has no area"
        raise InputError(msg, where=where, hint="list its vertices in order round the area")
    found = _in_polygon(model, load, area, middle, normal, axes, tolerance)
    if not found:
        msg = f"the {load.kind} load on the polygon from {_text(corners[0])} lies on no face of a body"
        raise InputError(msg, where=where, hint="give a polygon in the plane of a face")
    made = []
    for b, face, part in found:
        inward = -model.polyhedra[b].normals[face]
        pull = load.value[0] * inward if load.kind == "pressure" else np.array(load.value, dtype=float)
        made.append(LoadedPart(b, face, part, middle, axes, pull))
    return made


def _text(point: Array) -> str:
    return f"({', '.join(f'{v:g}' for v in point)})"


def _in_polygon(
    model: Model, load: Load, area: shapely.Polygon, middle: Array, normal: Array, axes: Array, tolerance: float
) -> list[tuple[int, int, shapely.Geometry]]:
    """Return bodies, faces and the parts of them that a load acts on: of the two faces of a joint one alone."""
    found = []
    for b in loaded_bodies(model, load):
        body = model.polyhedra[b]
        lies = np.abs(body.normals @ middle - body.offsets) <= tolerance
        lies &= np.abs(body.normals @ normal) >= np.cos(np.deg2rad(0.1))
        for face in np.flatnonzero(lies).tolist():
            rings = [(body.vertices[list(loop)] - middle) @ axes.T for loop in body.loops_of(face)]
            part = common(np.array([shapely.Polygon(rings[0], rings[1:])]), area)[0]
            if part.area > tolerance * max(part.length, tolerance):
                found.append((b, face, part))
    if load.face == "both" or len(found) < 2:
        return found
    up = np.array([float(model.polyhedra[b].normals[face] @ normal) > 0 for b, face, _ in found])
    tree = shapely.STRtree([part for _, _, part in found])
    kept = []
    for k, (b, face, part) in enumerate(found):
        others = [j for j in tree.query(part).tolist() if up[j] != up[k] and found[j][0] != b]
        shared = list(common(np.array([found[j][2] for j in others]), part)) if others else []
        shared = [s for s in shared if s.area > tolerance * max(s.length, tolerance)]
        what = f"{load.kind} load on the polygon from {_text(np.array(load.polygon)[0])}"
        outward = model.polyhedra[b].normals[face]
        if shared and not prefers(load, outward, what, f"load group '{load.group}'"):
            part = without(np.array([part]), shapely.union_all(shared))[0]
            if part.area <= tolerance * max(part.length, tolerance):
                continue
        kept.append((b, face, part))
    return kept


def _along_line(disc: Discretisation, load: Load, f: Array) -> None:
    """Add the nodal forces of a traction per length along a line on one body [kN/m]."""
    where = f"load group '{load.group}'"
    assert load.edge is not None
    p, q = (np.array(end, dtype=float) for end in load.edge)
    bodies = loaded_bodies(disc.model, load)
    if load.kind != "traction" or len(bodies) != 1 or not np.linalg.norm(q - p) > 0:
        msg = f"a {load.kind} load in space along the line from {_text(p)} to {_text(q)} needs one body and a vector"
        raise InputError(msg, where=where, hint="name the block and give kN/m; loads on faces take a polygon")
    b = bodies[0]
    body = disc.model.polyhedra[b]
    heights = np.column_stack([body.normals @ p - body.offsets, body.normals @ q - body.offsets])
    tolerance = line_tolerance(disc.model, load)
    if body.convex and heights.max() > tolerance:
        msg = f"the line from {_text(p)} to {_text(q)} leaves '{body.name}' by {1e3 * heights.max():.4g} mm"
        raise InputError(msg, where=where, hint="give a line on the block")
    force = np.array(load.value) * float(np.linalg.norm(q - p))
    if disc.shape_of[b] == RIGID:
        first, last = disc.offsets[b], disc.offsets[b + 1]
        f[first:last] += rigid_operator(0.5 * (p + q) - disc.centroids[b], disc.reach[b]).T @ force
        return
    for share, weight in zip(*_line_points(disc, b, p, q), strict=True):
        dofs, rows = disc.point_operator(b, p + share * (q - p))
        np.add.at(f, dofs, rows.T @ (weight * force))


def _line_points(disc: Discretisation, b: int, p: Array, q: Array) -> tuple[Array, Array]:
    """Return places (k,) on a line as shares of it and their weights: Gauss points between the nodes that lie on it."""
    along = q - p
    length2 = float(along @ along)
    arm = disc.nodes(b) - p
    share = arm @ along / length2
    off = np.linalg.norm(arm - share[:, None] * along, axis=1)
    on = (off <= 1e-7 * np.sqrt(length2)) & (share > 1e-7) & (share < 1 - 1e-7)
    marks = np.unique(np.concatenate([[0.0, 1.0], np.round(share[on], 9)]))
    if len(marks) == 2:
        marks = np.linspace(0.0, 1.0, 21)
    x, w = np.polynomial.legendre.leggauss(2)
    width = np.diff(marks)
    return (marks[:-1, None] + width[:, None] * (x + 1) / 2).ravel(), (width[:, None] * w / 2).ravel()


def _uniform(
    disc: Discretisation, b: int, face: int, part: shapely.Geometry, middle: Array, axes: Array, pull: Array, f: Array
) -> None:
    """Add a uniform load ``pull`` [kN/m2] on part of a face."""
    first, last = disc.offsets[b], disc.offsets[b + 1]
    if disc.shape_of[b] == FIXED:
        return
    if disc.shape_of[b] == RIGID:
        centre = middle + np.array([part.centroid.x, part.centroid.y]) @ axes
        f[first:last] += rigid_operator(centre - disc.centroids[b], disc.reach[b]).T @ pull * part.area
        return
    shape = disc.shapes[disc.shape_of[b]]
    assert isinstance(shape, SolidShape)
    nodes, weights = shape.face_weights(face, part, middle - disc.origins[b], axes)
    np.add.at(f, first + 3 * nodes[:, None] + np.arange(3), np.outer(weights, pull))
