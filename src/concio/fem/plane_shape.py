"""From an outline to its meshed shape: what makes two bodies one shape, and how the shape is built."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Generic, TypeVar

import numpy as np

from concio.errors import InputError
from concio.fem.constitutive import constitutive_matrix
from concio.fem.elements import build
from concio.fem.mesh import mesh_body
from concio.fem.shape import Shape
from concio.model.materials import Elastic
from concio.model.model import Body, Model
from concio.model.polyhedron import Polyhedron
from concio.representation import short_repr

Array = np.ndarray
S = TypeVar("S")


@short_repr
@dataclass(frozen=True)
class Plan(Generic[S]):
    """A shape before it is built: bodies of equal ``key`` have equal shapes."""

    key: tuple[object, ...]
    build: Callable[[], S]


def elastic_material(model: Model, body: Body | Polyhedron) -> Elastic:
    """Return the material of an elastic body."""
    material = model.materials[body.material]
    if not isinstance(material, Elastic):
        msg = f"material '{body.material}' is not elastic"
        raise InputError(msg, where=f"block '{body.name}'")
    return material


def rounded(values: Array, unit: float) -> bytes:
    """Return numbers as multiples of a unit, to compare shapes by."""
    return np.round(np.asarray(values) / unit).astype(np.int64).tobytes()


def plane_shape(model: Model, body: Body, size: float, marks: Sequence[Array]) -> Plan[Shape]:
    """Return the plan of the shape of an outline.

    Parameters
    ----------
    model : Model
    body : Body
    size : float
        Target element size [m].
    marks : sequence of arrays
        For each edge of the outline, then of the holes, where interfaces begin or end [m from its first vertex]; empty
        for none at all.
    """
    cuts = list(marks) or [np.zeros(0)] * len(body.vertices)
    unit = 1e-9 * float(np.ptp(body.outline, axis=0).max())
    origin = body.outline[0]
    grid = None
    if body.grid is not None:
        grid = tuple(rounded(np.asarray(g) - o, unit) for g, o in zip(body.grid, origin, strict=True))
    pieces = tuple(rounded(c, unit) for c in cuts) if body.grid is None else ()
    rings = tuple(rounded(ring - origin, unit) for ring in body.rings)
    key = (rings, body.material, body.thickness, grid, round(size / unit), pieces)
    return Plan(key, partial(_built, model, body, size, cuts))


def _built(model: Model, body: Body, size: float, cuts: list[Array]) -> Shape:
    D = constitutive_matrix(elastic_material(model, body), model.plane)
    points, cells = mesh_body(body, size, model.refinement, cuts)
    elements = build(points - body.outline[0], cells, model.element, D)
    outline, *holes = (ring - body.outline[0] for ring in body.rings)
    return Shape(outline, elements, D, body.thickness, tuple(holes))
