"""The pairs of a step that can carry force, as a problem of their own: contacts are looked for further than they reach.

In space half of the pairs of a search stand apart, and nearly all arithmetic of a step is work on pairs. The others
carry nothing and are open.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.solvers.stepping.problem import StepProblem, StepSolution

MANY = 100
"""Pairs below which all of them are kept: picking some costs more than they do."""

ROWS = ("columns", "values", "active")
LAWS = ("gap", "origin", "cone", "a_n", "a_t", "dilatancy")
"""What a problem has for each pair."""


@dataclass(frozen=True, eq=False)
class ActivePairs:
    """The active pairs of a problem.

    Parameters
    ----------
    whole, part : StepProblem
        With all pairs, and with the active ones.
    pick : (k,) integer array or None
        Their numbers; None where all are kept.
    """

    whole: StepProblem
    part: StepProblem
    pick: Array | None

    @classmethod
    def of(cls, p: StepProblem, known: ActivePairs | None) -> ActivePairs:
        """Return those of a problem; ``known``: those of an earlier one, whose rows it may share."""
        if known is not None and known.whole is p:
            return known
        if p.pairs < MANY or p.active.all():
            return cls(p, p, None)
        if known is None or known.pick is None or not known.has_rows_of(p):
            pick = np.flatnonzero(p.active)
            return cls(p, replace(p, **{name: getattr(p, name)[pick] for name in (*ROWS, *LAWS)}), pick)
        rows = {name: getattr(known.part, name) for name in ROWS}
        part = replace(p, **rows, **{name: getattr(p, name)[known.pick] for name in LAWS})
        part.share_rows(known.part)
        return cls(p, part, known.pick)

    def has_rows_of(self, p: StepProblem) -> bool:
        """Return whether another problem has the same rows and active pairs."""
        return self.whole.values is p.values and self.whole.active is p.active

    def states(self, states: PairStates) -> PairStates:
        """Return the states of the active pairs of those of all."""
        return states if self.pick is None else states[self.pick]

    def forces(self, t: Array) -> Array:
        """Return the forces (k, d) of the active pairs of those of all (m, d)."""
        return t if self.pick is None else t[self.pick]

    def solution(self, found: StepSolution) -> StepSolution:
        """Return a solution of all pairs as one of the active ones."""
        return replace(found, t=self.forces(found.t), states=self.states(found.states))

    def of_all(self, found: StepSolution) -> StepSolution:
        """Return a solution of the active pairs as one of all."""
        if self.pick is None:
            return found
        m, d = self.whole.pairs, self.whole.dim
        t, normal, direction = np.zeros((m, d)), np.zeros(m, dtype=np.int8), np.zeros((m, d - 1))
        t[self.pick] = found.t
        normal[self.pick], direction[self.pick] = found.states.normal, found.states.direction
        return replace(found, t=t, states=PairStates(normal, direction))
