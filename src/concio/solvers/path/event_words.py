"""Events of a path: what two successive states of the pairs differ in, in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.solvers.path.equations import PathEquations
from concio.solvers.path.path_state import CLOSED, CRUSHED, OPEN, STICK
from concio.solvers.path.rates import grips
from concio.solvers.path.record import Event

NORMAL = {
    (CLOSED, OPEN): "opens",
    (OPEN, CLOSED): "closes",
    (OPEN, CRUSHED): "crushes",
    (CLOSED, CRUSHED): "crushes",
    (CRUSHED, CLOSED): "recovers",
    (CRUSHED, OPEN): "opens",
}
"""Words for changes of the normal state."""


@dataclass(frozen=True, eq=False)
class Moment:
    """States of all pairs at a moment.

    Parameters
    ----------
    states : PairStates
    grip : (m,) boolean array
        Which pairs can carry friction.
    """

    states: PairStates
    grip: Array

    @classmethod
    def of(cls, equations: PathEquations) -> Moment:
        """Copy the present states."""
        return cls(PairStates.plane(equations.contact.copy(), equations.sliding), grips(equations))


def changes(old: Moment, new: Moment, parameter: float, control: float, step: int) -> list[Event]:
    """Return the events that lead from one set of states to another.

    Parameters
    ----------
    old, new : Moment
    parameter, control : float
        Where it happens.
    step : int
        Index of the state of the path.
    """
    found = []
    for k in np.flatnonzero(old.states.differ(new.states)):
        was, now = int(old.states.normal[k]), int(new.states.normal[k])
        if was != now:
            found.append(Event(parameter, control, int(k), NORMAL[was, now], 0, step))
        side = int(new.states.sign[k]) if new.grip[k] else 0
        before = int(old.states.sign[k]) if old.grip[k] else 0
        if side != before and new.grip[k]:
            kind = "slips" if side != STICK else "sticks"
            if not (kind == "sticks" and was != now):
                found.append(Event(parameter, control, int(k), kind, side, step))
    return found
