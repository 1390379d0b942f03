"""From a polyhedron to its meshed shape: what makes two bodies one shape, and how the shape is built."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from concio.fem.constitutive import solid_matrix
from concio.fem.elements import build, family
from concio.fem.plane_shape import Plan, elastic_material, rounded
from concio.fem.solid import SolidShape
from concio.fem.solid_mesh import Mark, mesh_solid, require_right_handed
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron

Array = np.ndarray


def solid_shape(model: Model, body: Polyhedron, size: float, marks: Sequence[Mark]) -> Plan[SolidShape]:
    """Return the plan of the shape of a polyhedron.

    Parameters
    ----------
    model : Model
    body : Polyhedron
    size : float
        Target element size [m].
    marks : sequence of Mark
        Where interfaces lie on its surface.
    """
    unit = 1e-9 * float(np.ptp(body.vertices, axis=0).max())
    origin = body.vertices[0]
    grid = None if body.grid is None else (body.grid.shape, rounded(body.grid - origin, unit))
    own = tuple(sorted((m.face, rounded(m.polygon - origin, unit)) for m in marks))
    key = (rounded(body.vertices - origin, unit), body.faces, body.holes, body.material, grid, round(size / unit), own)
    return Plan(key, partial(_built, model, body, size, tuple(marks)))


def _built(model: Model, body: Polyhedron, size: float, marks: Sequence[Mark]) -> SolidShape:
    D = solid_matrix(elastic_material(model, body))
    simplices = family(model.element).cells == 4
    points, cells = mesh_solid(body, size, model.refinement, marks, simplices=simplices)
    require_right_handed(points, cells, body.name)
    origin = body.vertices[0]
    elements = build(points - origin, cells, model.element, D)
    return SolidShape(body.vertices - origin, body.faces, body.holes, body.normals, elements, D)
