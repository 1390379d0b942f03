r"""The natural map of the joint laws: forces t obey them where t is the return map of the trial forces t - y.

y holds gap and slip of each pair in units of force, normal first: lengths times a positive weight, which may be another
one for each pair and direction. The states of pairs are read off the same trial forces. Any dimension.
"""

from __future__ import annotations

import numpy as np

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.problem.pair_state import Normal, PairStates


def natural_map(cone: Cone, y: Array, t: Array, dilatancy: Array) -> Array:
    """Return t minus the return map of t - y, (m, d); zero exactly where the joint laws hold.

    Parameters
    ----------
    cone : Cone
    y : (m, d) array
        Gap without dilatancy and slip, in units of force; slip zero where a pair is smooth.
    t : (m, d) array
        Forces.
    dilatancy : (m,) array
        tan(psi).
    """
    distance: Array = t - cone.project(t - y, dilatancy)
    return distance


def read_states(cone: Cone, y: Array, t: Array, dilatancy: Array, active: Array | None = None) -> PairStates:
    """Return the states that the natural map assigns to a point.

    A pair slips where the trial friction t_t - y_t lies beyond the strength it has at its trial normal force, an open
    pair with strength left too; one without any strength is given no slip.

    Parameters
    ----------
    cone : Cone
    y, t : (m, d) arrays
        See :func:`natural_map`.
    dilatancy : (m,) array
    active : (m,) boolean array, optional
        Pairs that can carry force at all; the others are open.
    """
    trial = t[:, 0] - y[:, 0] + dilatancy * _size(y[:, 1:])
    tangential = t[:, 1:] - y[:, 1:]
    size = _size(tangential)
    closed = trial > -cone.tension
    strength = cone.strength(np.clip(trial, -cone.tension, cone.cap))
    slips = (size > strength) & (strength > 0) & cone.rough
    if active is not None:
        closed, slips = closed & active, slips & active
    normal = np.where(closed & (trial > cone.cap), Normal.CRUSHED, np.where(closed, Normal.CLOSED, Normal.OPEN))
    direction = np.where(slips[:, None], -tangential / np.where(slips, size, 1.0)[:, None], 0.0)
    return PairStates(normal.astype(np.int8), direction)


def _size(v: Array) -> Array:
    """Return the lengths (m,) of vectors (m, d-1)."""
    return np.abs(v[:, 0]) if v.shape[1] == 1 else np.asarray(np.linalg.norm(v, axis=1))
