"""Pressure and traction on faces in space: the parts of faces that lie in the polygon of a load."""

from __future__ import annotations

import numpy as np
import shapely

from concio.contact.load_faces import loaded_bodies
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID, Discretisation
from concio.fem.solid import SolidShape
from concio.kinematics.frames import tangents
from concio.kinematics.rigid import rigid_operator
from concio.model.model import Load

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


def add_face_load(disc: Discretisation, load: Load, f: Array) -> None:
    """Add the nodal forces of a pressure or traction on the parts of faces that lie in its polygon.

    Raises
    ------
    InputError
        There is no polygon, it has no area or is not planar, or no face of the bodies lies in it.
    """
    where = f"load group '{load.group}'"
    if load.polygon is None:
        msg = f"a {load.kind} load in space needs a polygon"
        raise InputError(msg, where=where, hint="give the vertices of the loaded area, in order")
    corners = np.array(load.polygon, dtype=float)
    middle, normal, axes = plane_of(corners)
    tolerance = max(1e-6 * disc.size, disc.model.gap_tolerance or 0.0)
    off = float(np.abs((corners - middle) @ normal).max())
    area = shapely.Polygon((corners - middle) @ axes.T)
    if off > tolerance:
        msg = f"the polygon of a {load.kind} load is not planar: a vertex stands {1e3 * off:.4g} mm off its plane"
        raise InputError(msg, where=where, hint="give several polygons, one for each plane")
    if not area.is_valid or area.area <= tolerance * area.length:
        msg = f"the polygon of a {load.kind} load crosses itself or has no area"
        raise InputError(msg, where=where, hint="list its vertices in order round the area")
    loaded = 0.0
    for b in loaded_bodies(disc.model, load):
        body = disc.model.polyhedra[b]
        lies = np.abs(body.normals @ middle - body.offsets) <= tolerance
        lies &= np.abs(body.normals @ normal) >= np.cos(np.deg2rad(0.1))
        for face in np.flatnonzero(lies).tolist():
            rings = [(body.vertices[list(loop)] - middle) @ axes.T for loop in body.loops_of(face)]
            part = shapely.Polygon(rings[0], rings[1:]).intersection(area)
            if part.area <= tolerance * max(part.length, tolerance):
                continue
            loaded += part.area
            pull = -load.value[0] * body.normals[face] if load.kind == "pressure" else np.array(load.value)
            _uniform(disc, b, face, part, middle, axes, pull, f)
    if loaded == 0.0:
        text = f"({', '.join(f'{v:g}' for v in corners[0])})"
        msg = f"the {load.kind} load on the polygon from {text} lies on no face of a body"
        raise InputError(msg, where=where, hint="give a polygon in the plane of a face")


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
