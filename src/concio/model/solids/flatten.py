"""Faces of imported blocks that are not quite plane: snapped into planes within a tolerance, or split."""

from __future__ import annotations

import numpy as np

from concio.model.polyhedron_check import PLANAR
from concio.model.surfaces import COPLANAR, Surface, merged_faces
from concio.model.topology import Loop, face_triangles, topology

Array = np.ndarray
ROUNDS = 50
"""Most times that planes are fitted and vertices moved into them."""
STEEP = 1e-2
"""Planes at a vertex that are nearer to one another than this move it as one [rad]."""


def snapped(surface: Surface, within: float) -> tuple[Surface, float]:
    """Return a surface whose faces are plane, near-coplanar ones put together, and how far a vertex was moved [m].

    Parameters
    ----------
    surface : (points, faces, holes)
        Closed.
    within : float
        No vertex is moved further than this; where that would be needed the surface is returned as it was [m].
    """
    joined = merged_faces(*surface, within=within)
    for points, faces, holes in (joined, surface):
        size = float(np.ptp(points, axis=0).max())
        moved = _in_planes(points, faces, holes, COPLANAR * size)
        if moved is None:
            continue
        far = float(np.linalg.norm(moved - points, axis=1).max())
        if far <= within:
            return (moved, faces, holes), far
    return surface, 0.0


def _in_planes(
    points: Array, faces: tuple[Loop, ...], holes: tuple[tuple[int, Loop], ...], flat: float
) -> Array | None:
    """Return the points moved as little as puts them into the planes of their faces; None where they do not settle."""
    top = topology(faces, holes)
    if top.fault is not None:
        return None
    own: list[list[int]] = [[] for _ in points]
    for vertex, face in zip(top.start.tolist(), top.face.tolist(), strict=True):
        if face not in own[vertex]:
            own[vertex].append(face)
    at = points.copy()
    for _ in range(ROUNDS):
        area = top.area_vectors(at)
        length = np.linalg.norm(area, axis=1)
        if not (length > 0).all():
            return None
        normal = area / length[:, None]
        offset = (top.by_face(at[top.start]) / top.sides_of_face[:, None] * normal).sum(1)
        off = offset[top.face] - (at[top.start] * normal[top.face]).sum(1)
        if np.abs(off).max() <= 1e-3 * flat:
            return at
        for vertex, sides in enumerate(own):
            if sides:
                n = normal[sides]
                at[vertex] += np.linalg.lstsq(n, offset[sides] - n @ at[vertex], rcond=STEEP)[0]
    return at if np.abs(off).max() <= flat else None


def _from_shorter_diagonal(points: Array, face: Loop) -> Loop:
    """Return a quadrilateral from an end of its shorter diagonal on, so that two blocks split a common face alike."""
    if len(face) != 4:
        return face
    a, b, c, d = (points[v] for v in face)
    first, second = float(np.linalg.norm(c - a)), float(np.linalg.norm(d - b))
    if abs(first - second) > 1e-6 * max(first, second):
        return face if first < second else (*face[1:], face[0])
    low = min((0, 2), (1, 3), key=lambda ends: min(tuple(np.round(points[face[k]] / first, 6)) for k in ends))
    return face if low == (0, 2) else (*face[1:], face[0])


def split_warped(surface: Surface) -> tuple[Surface, int]:
    """Return a surface with faces that are not plane split into triangles, and how many were split."""
    points, faces, holes = surface
    top = topology(faces, holes)
    if top.fault is not None:
        return surface, 0
    size = float(np.ptp(points, axis=0).max())
    area = top.area_vectors(points)
    normal = area / np.maximum(np.linalg.norm(area, axis=1), 1e-300)[:, None]
    middle = top.by_face(points[top.start]) / top.sides_of_face[:, None]
    off = np.abs(((points[top.start] - middle[top.face]) * normal[top.face]).sum(1))
    warped = np.bincount(top.face, off > PLANAR * size, len(faces)) > 0
    kept: list[Loop] = []
    new_holes: list[tuple[int, Loop]] = []
    for number, face in enumerate(faces):
        own = [loop for k, loop in holes if k == number]
        if not warped[number]:
            new_holes += [(len(kept), loop) for loop in own]
            kept.append(face)
            continue
        cells = face_triangles(points, [_from_shorter_diagonal(points, face), *own], normal[number])
        kept += [tuple(int(v) for v in cell) for cell in cells]
    return (points, tuple(kept), tuple(new_holes)), int(warped.sum())
