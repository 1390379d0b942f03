r"""From a point and states that are nearly right to the answer: solve, decide the pairs in question, solve again.

With the states of all pairs given the problem is linear (:mod:`concio.solvers.states.given`). If the answer contradicts
no state it is exact. Pairs it contradicts are decided together by one small linear complementarity problem in which all
others keep their states (:mod:`concio.solvers.states.small_problem`); pairs contradicted then join them, and so on. All
of this happens on one factor, updated by a few columns for each pair in question. Where there are too many of them they
all take the states the point shows, which costs a factorisation.

Where a plane structure is likely to be near the state in which every pair sticks (walls far from their limit, of whose
pairs two in ten open or slip), the interior point is not needed: all pairs that the answer of given states contradicts
take the states it shows, and the right states come after three to six solves. Whether that is likely is seen without
cost: the glued structure, from which a problem has its units, has forces, and where these are far outside the cones
(arches, panels that hang) most states are others.

Forces of redundant pairs (corners) are not unique. Those reported are the least of all that the joint laws allow
(:mod:`concio.solvers.states.redundant_forces`): they depend on nothing but the structure and its displacements.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.problem.tolerances import EXACT
from concio.solvers.algebra.scaled import LOOSE, Scaled
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.states.given import REFINED, TRIED, GivenStates
from concio.solvers.states.redundant_forces import least_forces
from concio.solvers.states.small_problem import decide
from concio.solvers.states.state_reading import Finished, natural_residual, read_states
from concio.solvers.states.static_laws import laws_of

ROUNDS = 12
"""Largest number of times pairs are decided."""

TOGETHER = 40
"""Largest number of pairs decided together."""

PATIENCE = 2
"""Rounds in a row that leave no fewer pairs in question, more than can be decided together, before settling stops."""

NEAR = 0.06
"""Largest distance of the forces of the glued structure from their cones, over the largest of them, at which states
that begin with every pair sticking are worth trying."""

LARGEST = 3000
"""Largest number of pairs at which they are; in larger walls each round contradicts other pairs, for long."""

FALL = 0.7
"""Largest number of pairs contradicted in a round, over that of the round before, where they are not few."""

FEW = 0.03
"""Share of the pairs up to which they are."""

ANCHORS = 8
"""Largest number of times the springs of loose unknowns are anchored again."""


class Settler:
    """Settles the states of the pairs of one structure; its factors and columns live as long as K and C do.

    Parameters
    ----------
    s : Scaled
    """

    def __init__(self, s: Scaled) -> None:
        self.given = GivenStates(s)

    def settle(
        self,
        s: Scaled,
        u: Array,
        t: Array,
        states: PairStates | None = None,
        *,
        undecided: Array | None = None,
        springs: Array | float = LOOSE,
        rounds: int = ROUNDS,
        flips: int = ROUNDS,
        least: bool = True,
    ) -> Finished:
        """Settle the states of a problem, from a point near its answer or from states near its own.

        Parameters
        ----------
        s : Scaled
            The structure this settler was made for, perhaps under other loads, gaps and slip origins.
        u, t : (N,), (m, 2) arrays
            The point, scaled.
        states : PairStates, optional
            Initial states; by default those that the point shows.
        undecided : (k,) integer array, optional
            Pairs whose states are in question from the start.
        springs : (N,) array or float
        rounds : int
            Largest number of times pairs are decided.
        flips : int
            How many of them too many pairs are in question for a small problem, and a factorisation is due.
        least : bool
            Whether forces that are not unique are the least of all; otherwise those near to the point.
        """
        states = read_states(s, u, t) if states is None else states
        run = _Run(self.given, s, u, springs)
        chosen = np.zeros(s.pairs, dtype=bool)
        if undecided is not None:
            chosen[undecided] = True
        with suppress(SingularMatrixError):
            self._settle(run, states, u, t, chosen, rounds, flips)
        found = run.best
        if found is None:
            error, laws = natural_residual(s, u, t)
            found = Finished(u, t, states, error, 0, np.flatnonzero(laws > EXACT))
        elif found.settled:
            found = run.near(found)
            found = least_forces(s, found) if least else found
        return replace(found, solves=run.solves)

    def from_sticking(self, s: Scaled) -> Finished | None:
        """Return the answer to which states lead that begin with every closed pair sticking; None where it is not near.

        All pairs that are contradicted change together: the states of a symmetric structure stay symmetric.
        """
        if s.pairs > LARGEST or s.outside > NEAR:
            return None
        run, allowed = _Run(self.given, s, np.zeros_like(s.f), LOOSE), s.pairs
        states = PairStates.plane(s.x[:, 0] <= 0.0, np.zeros(s.pairs))
        u, t = np.zeros_like(s.f), s.unstressed
        with suppress(SingularMatrixError):
            for _ in range(ROUNDS):
                u, t, wrong, shown = run.solved(states, u, t)
                count = int(wrong.sum())
                if not count:
                    break
                if count > max(FALL * allowed, FEW * s.pairs):
                    return None
                allowed, states = count, _mixed(states, shown, wrong)
        found = run.best
        if found is None or not found.settled:
            return None
        return replace(least_forces(s, run.near(found)), solves=run.solves)

    def _settle(
        self, run: _Run, states: PairStates, u: Array, t: Array, chosen: Array, rounds: int, flips: int
    ) -> None:
        """Decide the pairs in question until none is contradicted, or nothing new comes of it."""
        seen: set[bytes] = set()
        least, late = len(t) + 1, 0
        if 0 < chosen.sum() <= TOGETHER:
            states, u, t = run.decided(states, np.flatnonzero(chosen), u, t) or (states, u, t)
        for left in range(rounds, -1, -1):
            seen.add(states.key())
            u, t, wrong, shown = run.solved(states, u, t)
            if not wrong.any() or not left:
                return
            least, late = (int(wrong.sum()), 0) if wrong.sum() < least else (least, late + 1)
            if late >= PATIENCE and wrong.sum() > TOGETHER:
                return  # far from the answer each round contradicts half of the pairs again
            flipped = _mixed(states, shown, wrong)
            found = None
            if (chosen | wrong).sum() <= TOGETHER:
                chosen |= wrong
                found = run.decided(states, np.flatnonzero(chosen), u, t)
            elif flips <= 0:
                return
            else:
                chosen, flips = np.zeros_like(chosen), flips - 1
            if found is None or found[0].key() in seen:
                found = flipped, u, t
            if found[0].key() in seen:
                return
            states, u, t = found


class _Run:
    """One problem being settled: its best point so far, and the steps of which settling is made."""

    def __init__(self, given: GivenStates, s: Scaled, anchor: Array, springs: Array | float) -> None:
        self.given, self.s, self.anchor, self.springs = given, s, anchor, springs
        self.best: Finished | None = None
        self.begun = given.solves

    @property
    def solves(self) -> int:
        """Linear systems solved for given states."""
        return self.given.solves - self.begun

    def solved(self, states: PairStates, u: Array, t: Array) -> tuple[Array, Array, Array, PairStates]:
        """Solve for given states; return u, t, which pairs (m,) contradict them, and the states they show instead."""
        laws_here = laws_of(self.s, states)
        u, t, _ = self.given.refined(self.s, laws_here, u, t, self.anchor, springs=self.springs, accuracy=TRIED)
        error, laws = natural_residual(self.s, u, t)
        shown = read_states(self.s, u, t)
        wrong = (laws > EXACT) & shown.differ(states)
        for _ in range(ANCHORS):  # a slender arch is hardly stiffer than the springs: where it goes far, they pull
            if error < EXACT or wrong.any():
                break
            self.anchor = u
            v, p, _ = self.given.refined(self.s, laws_here, u, t, self.anchor, springs=self.springs, own=True)
            new, laws = natural_residual(self.s, v, p)
            if not new < error:
                break
            slow = new > 0.5 * error
            u, t, error, shown = v, p, new, read_states(self.s, v, p)
            wrong = (laws > EXACT) & shown.differ(states)
            if slow:
                break
        if self.best is None or error < self.best.error:
            self.best = Finished(u, t, states, error, 0, np.flatnonzero(wrong))
        return u, t, wrong, shown

    def decided(
        self, states: PairStates, pick: Array, u: Array, t: Array
    ) -> tuple[PairStates, Array, Array] | None:
        """Decide the pairs picked, all others held; return the states and a point near, None where that fails."""
        found = decide(self.given, self.s, states, pick, u, t, self.anchor, springs=self.springs)
        return None if found is None else (found.states, found.u, found.t)

    def near(self, found: Finished) -> Finished:
        """Return the answer refined once more from its own forces, springs anchored at it, where that can help."""
        if found.error <= REFINED:
            return found
        laws = laws_of(self.s, found.states)
        u, t, _ = self.given.refined(self.s, laws, found.u, found.t, found.u, springs=self.springs)
        error, _ = natural_residual(self.s, u, t)
        return replace(found, u=u, t=t, error=error) if error <= max(found.error, EXACT) else found


def _mixed(states: PairStates, shown: PairStates, wrong: Array) -> PairStates:
    """Return the states, those of the pairs marked (m,) as they show."""
    return PairStates(
        np.where(wrong, shown.normal, states.normal), np.where(wrong[:, None], shown.direction, states.direction)
    )
