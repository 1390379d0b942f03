"""The part of each face of blocks in space that no joint covers: what is seen of a structure at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from concio.kinematics.frames import tangents
from concio.model.interfaces.patches import Patch
from concio.model.model import Model

Array = np.ndarray


def free_surface(model: Model, patches: Sequence[Patch]) -> list[tuple[int, int, list[Array]]]:
    """Return body, face and the pieces of it, each a boundary (n, 3) [m], that lie free.

    Parameters
    ----------
    model : Model
        In space.
    patches : sequence of Patch
        Its joints. A piece with holes is returned without them.
    """
    covered: dict[tuple[int, int], list[Patch]] = {}
    for patch in patches:
        covered.setdefault((patch.a, patch.face_a), []).append(patch)
        covered.setdefault((patch.b, patch.face_b), []).append(patch)
    found = []
    for b, body in enumerate(model.polyhedra):
        areas = body.face_areas
        for face, loop in enumerate(body.faces):
            own = covered.get((b, face), [])
            taken = sum(p.area for p in own)
            if not own:
                found.append((b, face, [body.vertices[list(loop)]]))
                continue
            if taken > (1 - 1e-6) * areas[face]:
                continue
            axes, origin = tangents(body.normals[face]), body.vertices[loop[0]]
            shape = shapely.Polygon((body.vertices[list(loop)] - origin) @ axes.T)
            hidden = shapely.union_all([shapely.Polygon((p.polygon - origin) @ axes.T) for p in own])
            left = shapely.get_parts(shape.difference(hidden.buffer(1e-9 * body.size)))
            pieces = [
                origin + shapely.get_coordinates(part.exterior)[:-1] @ axes
                for part in left
                if part.geom_type == "Polygon" and part.area > 1e-6 * areas[face]
            ]
            if pieces:
                found.append((b, face, pieces))
    return found
