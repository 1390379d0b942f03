"""A buttress as one rigid block against a wall, in the plane and in space, on the fixed body beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from concio.contact.separate import surroundings
from concio.errors import InputError
from concio.model.body import Body
from concio.model.materials import Rigid
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron

Array = np.ndarray

BUTTRESS = "buttress"
"""Name, material and role of the body that is added."""

SIDES: Mapping[str, tuple[int, float]] = {
    "left": (0, -1.0), "right": (0, 1.0), "-x": (0, -1.0), "+x": (0, 1.0), "-y": (1, -1.0), "+y": (1, 1.0),
}  # fmt: skip
"""Horizontal axis and sense of the sides at which a buttress may stand; those along y are of models in space."""


def buttress_box(
    model: Model, bodies: Sequence[int], side: str, height: float | None, width: float
) -> tuple[Array, Array]:
    """Return the low and the high corner of a buttress that is as long as the bodies that it stands against [m].

    Raises
    ------
    InputError
        A plane has no such side.
    """
    axis, sense = SIDES[side]
    if axis and model.dim == 2:
        msg = f"a buttress has no side '{side}' in the plane"
        raise InputError(msg, where="strengthening", hint="one of left, right")
    points = np.vstack([np.asarray(model.bodies[i].vertices) for i in bodies])
    low, high = points.min(0).astype(float), points.max(0).astype(float)
    if height is not None:
        high[-1] = low[-1] + height
    if sense < 0:
        low[axis], high[axis] = low[axis] - width, low[axis]
    else:
        low[axis], high[axis] = high[axis], high[axis] + width
    return low, high


def with_buttress(
    model: Model, bodies: Sequence[int], side: str, height: float | None, width: float, unit_weight: float
) -> Model:
    """Return a model with a buttress.

    Parameters
    ----------
    model : Model
    bodies : sequence of int
        That it stands against.
    side : str
        One of :data:`SIDES`.
    height : float or None
        From the foot of these bodies; None for all of theirs [m].
    width : float
        [m].
    unit_weight : float
        [kN/m3].

    Raises
    ------
    InputError
        No fixed body is under all of it.
    """
    low, high = buttress_box(model, bodies, side, height, width)
    near = 1e-6 * surroundings(model).of(list(bodies))
    fixed = [np.asarray(b.vertices) for b in (model.bodies if model.dim == 3 else model.outlines) if b.kind == "fixed"]
    if not any(abs(v[:, -1].max() - low[-1]) <= near and (v.min(0)[:-1] <= low[:-1] + near).all()
               and (v.max(0)[:-1] >= high[:-1] - near).all() for v in fixed):  # fmt: skip
        where = ", ".join(f"{k} = {a:.4g} to {b:.4g} m" for k, a, b in zip("xy", low[:-1], high[:-1], strict=False))
        msg = f"a buttress of {width:.4g} m has no ground under it, from {where} at z = {low[-1]:.4g} m"
        raise InputError(msg, where="strengthening", hint="make the fixed body wider, or the largest amount smaller")
    body: Body | Polyhedron
    if model.dim == 3:
        body = Polyhedron.box(BUTTRESS, low.tolist(), high.tolist(), kind="rigid", material=BUTTRESS, role=BUTTRESS)
    else:
        outline = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
        thick = max(model.outlines[i].thickness for i in bodies)
        body = Body(BUTTRESS, outline, thickness=thick, kind="rigid", material=BUTTRESS, role=BUTTRESS)
    materials = {**model.materials, BUTTRESS: Rigid(unit_weight=unit_weight)}
    return replace(model, bodies=(*model.bodies, body), materials=materials)
