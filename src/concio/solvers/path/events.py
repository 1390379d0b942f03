"""Events of a path: what two successive states of the pairs differ in, in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.path.equations import PathEquations
from concio.solvers.path.rates import grips
from concio.solvers.path.record import Event
from concio.solvers.path.state import CLOSED, CRUSHED, OPEN, STICK

NORMAL = {
    (CLOSED, OPEN): "opens",
    (OPEN, CLOSED): "closes",
    (CLOSED, CRUSHED): "crushes",
    (CRUSHED, CLOSED): "recovers",
    (CRUSHED, OPEN): "opens",
}
"""Words for changes of the normal state; what is not among them "changes"."""


@dataclass(frozen=True, eq=False)
class PairStates:
    """States of all pairs at a moment, each (m,).

    Parameters
    ----------
    contact, sliding : integer arrays
    grip : boolean array
        Which pairs can carry friction.
    """

    contact: Array
    sliding: Array
    grip: Array

    @classmethod
    def of(cls, equations: PathEquations) -> PairStates:
        """Copy the present states."""
        return cls(equations.contact.copy(), equations.sliding.copy(), grips(equations))


def changes(old: PairStates, new: PairStates, parameter: float, control: float, step: int) -> list[Event]:
    """Return the events that lead from one set of states to another.

    Parameters
    ----------
    old, new : PairStates
    parameter, control : float
        Where it happens.
    step : int
        Index of the state of the path.
    """
    found = []
    for k in np.flatnonzero((old.contact != new.contact) | (old.sliding != new.sliding)):
        was, now = int(old.contact[k]), int(new.contact[k])
        if was != now:
            found.append(Event(parameter, control, int(k), NORMAL.get((was, now), "changes"), 0, step))
        side = int(new.sliding[k]) if new.grip[k] else 0
        before = int(old.sliding[k]) if old.grip[k] else 0
        if side != before and new.grip[k]:
            kind = "slips" if side != STICK else "sticks"
            if not (kind == "sticks" and was != now):
                found.append(Event(parameter, control, int(k), kind, side, step))
    return found
