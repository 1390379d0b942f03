"""Models stretched along an axis, and thicker ones: what changes where all lengths of one direction do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from concio.model.actions import Point
from concio.model.body import Body
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron

Array = np.ndarray


def stretched(model: Model, factors: Sequence[float]) -> Model:
    """Return a model whose coordinates are multiplied, one factor for each axis; loads keep their values.

    Parameters
    ----------
    model : Model
    factors : sequence of float
        Positive, one for each axis.
    """
    by = np.array(factors, dtype=float)

    def point(p: Sequence[float]) -> Point:
        return tuple((np.array(p, dtype=float) * by).tolist())

    def points(several: Sequence[Point] | None) -> tuple[Point, ...] | None:
        return None if several is None else tuple(point(p) for p in several)

    def ends(edge: tuple[Point, Point] | None) -> tuple[Point, Point] | None:
        return None if edge is None else (point(edge[0]), point(edge[1]))

    return replace(
        model,
        bodies=tuple(_body(b, by) for b in model.bodies),
        supports=tuple(replace(s, edge=ends(s.edge), polygon=points(s.polygon)) for s in model.supports),
        loads=tuple(
            replace(v, edge=ends(v.edge), polygon=points(v.polygon), at=None if v.at is None else point(v.at))
            for v in model.loads
        ),
        ties=tuple(replace(t, at_a=point(t.at_a), at_b=point(t.at_b)) for t in model.ties),
    )


def _body(body: Body | Polyhedron, by: Array) -> Body | Polyhedron:
    if isinstance(body, Body):
        outline, *holes = (ring * by for ring in body.rings)
        grid = None if body.grid is None else (body.grid[0] * by[0], body.grid[1] * by[1])
        return replace(body, outline=outline, holes=tuple(holes), grid=grid)
    return replace(body, vertices=body.vertices * by, grid=None if body.grid is None else body.grid * by)


def thicker(model: Model, factor: float) -> Model:
    """Return a plane model whose bodies are ``factor`` times as thick; point loads keep their values."""
    return replace(model, bodies=tuple(replace(b, thickness=factor * b.thickness) for b in model.outlines))
