"""Steps of a motion that end where a tie begins to yield or breaks.

A tie that gives way within a step pulls as it did to its end; the error of its impulse is of the first order in the
step, with a factor that depends on where steps fall. So the step is cut where the elongation is reached.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from concio.analysis.motion.state import MotionState
from concio.contact.attachments import Ties

Array = np.ndarray
Report = TypeVar("Report")

CLOSE = 1e-7
"""Share of the elongation at which a tie gives way to which it is met."""

MOST = 30
"""Steps tried to meet it at most."""


def where_ties_give_way(
    ties: Ties,
    before: MotionState,
    after: MotionState,
    at: Callable[[float], tuple[MotionState, Report]],
    whole: float,
    least: float,
) -> tuple[MotionState, Report] | None:
    """Return the step that ends where the first tie gives way; None where that is at its beginning or at its end.

    Parameters
    ----------
    ties : Ties
    before, after : MotionState
        At the ends of the step in which one does.
    at : callable
        Makes a step of a length [s].
    whole, least : float
        Length of that step, and below which none is made [s].
    """
    limit = _limits(ties, before, after)
    low, high = 0.0, whole
    under, over = _beyond(ties, before, limit), _beyond(ties, after, limit)
    found = None
    for k in range(MOST):
        if over <= CLOSE or not under < 0.0 <= over:
            break
        share = 0.5 if k % 4 == 3 else min(max((0.5 * CLOSE - under) / (over - under), 1e-3), 1.0 - 1e-3)
        length = low + share * (high - low)
        if length < least:
            return None
        trial = at(length)
        reached = _beyond(ties, trial[0], limit)
        if reached >= 0.0:
            high, over, found = length, reached, trial
        else:
            low, under = length, reached
    return found


def _elongation(ties: Ties, state: MotionState) -> Array:
    """Return the elongations of ties since they were described (k,) [m]."""
    return np.asarray(state.ties.plastic - state.ties.sunk - ties.prestress / ties.stiffness)


def _limits(ties: Ties, before: MotionState, after: MotionState) -> Array:
    """Return the elongations (k,) at which ties that give way in a step do, infinite for others [m]."""
    old, new = before.ties, after.ties
    yields = (ties.most - ties.prestress) / ties.stiffness
    limit = np.where((new.plastic > 0) & ~(old.plastic > 0), yields, np.inf)
    return np.asarray(np.where(new.broken & ~old.broken, np.minimum(limit, ties.breaks), limit))


def _beyond(ties: Ties, state: MotionState, limit: Array) -> float:
    """Return how far the first of the ties is beyond its limit, over that; negative where none has reached it."""
    finite = np.isfinite(limit)
    long, limit = _elongation(ties, state)[finite], limit[finite]
    return float(((long - limit) / np.maximum(np.abs(limit), 1e-12)).max(initial=-np.inf))
