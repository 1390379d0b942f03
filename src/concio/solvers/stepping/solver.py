"""The solver of steps: the states of the last step, then a small problem for those that changed, others last."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import Array, Engine
from concio.problem.limits_of_work import STEP_FACTORISATIONS, STEP_PIVOTS
from concio.problem.pair_state import PairStates
from concio.problem.tolerances import STEP_GOOD, STEP_SETTLED
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.interior import engine as interior
from concio.solvers.pivoting import sparse_lemke
from concio.solvers.stepping.active_pairs import ActivePairs
from concio.solvers.stepping.one_factor import OneFactor
from concio.solvers.stepping.problem import StepProblem, StepSolution
from concio.solvers.stepping.settle_step import LinearStep, PairsAsked, settle
from concio.solvers.stepping.softer_joints import by_softer_joints
from concio.solvers.stepping.states import across_slip, halting, laws_of_step, read_states
from concio.solvers.stepping.step_factor import StepFactor

FEW = 25
"""Changed pairs up to which one small problem is cheaper than another factorisation."""

LARGE = 500
"""Unknowns from which on a factorisation costs more than the iterations that take its place."""

FLIPS = 6
"""Times all pairs that violate their law change state together before a small problem settles them."""

MEANS = ("", "same states", "active set", "small problem", "interior point", "pivoting", "softer joints")
"""What solves a step, each where those before it do not."""


class StepSolver:
    """Solves steps of one layout; keeps pattern and ordering.

    Parameters
    ----------
    engine : {"superlu", "pardiso"}, optional
    large : float
        Unknowns from which on, in space, one factorisation does for a step where it can.

    Attributes
    ----------
    solved_by : str
        Last of the means that were needed since :meth:`begin`: a step with impacts, or whose forces turn, is solved
        several times.
    """

    def __init__(self, engine: Engine = "superlu", *, large: float = np.inf) -> None:
        self.engine, self.large = engine, large
        self.factor: StepFactor | None = None
        self._linear: LinearStep | None = None
        self._begun: tuple[LinearStep, PairStates, PairsAsked] | None = None
        self._pairs: ActivePairs | None = None
        self._one: OneFactor | None = None
        self.solved_by = ""

    def begin(self) -> None:
        """Begin with a step of time."""
        self.solved_by = ""

    def new_layout(self) -> None:
        """Forget the pattern: the rows meet other unknowns from now on."""
        self.factor = self._linear = self._begun = self._pairs = self._one = None

    def step_again(self, p: StepProblem, found: StepSolution) -> StepSolution:
        """Solve a step of which only the forces have changed a little since :meth:`step`, with the factors of then.

        Where the states or the slips have become others, the step is solved again.
        """
        before = self._pairs
        pairs = self._pairs = ActivePairs.of(p, before)
        if self._one is not None and before is not None and before.part.values is pairs.part.values:
            now = pairs.solution(found)
            x, t, residual = self._one.again(pairs.part, now.x, now.t)
            if residual < STEP_GOOD:
                return pairs.of_all(replace(now, x=x, t=t, residual=residual))
        if self._linear is not None and before is not None and before.pick is pairs.pick:
            now = pairs.solution(found)
            x, t, errors = self._linear.refined(pairs.part, now.x, now.t)
            residual, _ = pairs.part.violation(t, errors)
            if residual < STEP_GOOD:
                return pairs.of_all(replace(now, x=x, t=t, residual=residual))
            settled = self._settled(pairs.part, now)
            if settled.residual < STEP_SETTLED:
                return self._told(pairs.of_all(settled))
        again = self.step(p, found.states, found.x, found.t)
        return replace(again, factorisations=found.factorisations + again.factorisations)

    def _settled(self, p: StepProblem, at: StepSolution) -> StepSolution:
        """Return a step of which only the forces have changed, settled by small problems on the factor at hand."""
        if self._begun is None or p.dim == 3:
            return replace(at, residual=np.inf)
        linear, states, asked = self._begun
        x, t, errors = linear.refined(p, at.x, at.t)
        settled = settle(p, asked.again(p), linear.laws, states, x, t, errors)
        if settled.linear is not None and settled.residual < STEP_SETTLED:
            self._linear = settled.linear
        return replace(
            at, x=settled.x, t=settled.t, states=settled.states, residual=settled.residual, how="small problem"
        )

    def step(self, p: StepProblem, states: PairStates, x: Array, t: Array) -> StepSolution:
        """Solve a step from the states of the one before and a point near the answer.

        In space the interior point ends where Newton's method in the states it found does the rest; what neither
        solves goes through softer joints.
        """
        pairs = self._take(p)
        part, own = pairs.part, pairs.forces(t)
        found = self._step(part, pairs.states(states), x, own)
        if p.dim == 3 and found.how == "interior point" and found.residual >= STEP_SETTLED:
            found = self._step(part, found.states, found.x, found.t)
        if p.dim == 3 and found.residual >= STEP_SETTLED:
            found = by_softer_joints(part, found, x, own, self._again)
        return self._told(pairs.of_all(found))

    def _take(self, p: StepProblem) -> ActivePairs:
        """Return the active pairs of a problem, whose rows the factors to come have."""
        if self.factor is None:
            self.factor = StepFactor(p.matrix.sparse, p.columns, self.engine)
        pairs = self._pairs = ActivePairs.of(p, self._pairs)
        self.factor.take(p.matrix.sparse, pairs.part.values, pairs.pick)
        return pairs

    def _step(self, p: StepProblem, states: PairStates, x: Array, t: Array) -> StepSolution:
        """Solve a step of active pairs, by each means in its turn."""
        self._one = self._linear = self._begun = None
        if p.dim == 3 and len(p.b) >= self.large:
            assert self.factor is not None
            self._one = OneFactor(self.factor)
            found = self._one.step(p, states, x, t)
            if found is not None and found.residual < STEP_SETTLED:
                return found
            self._one = None
            return self._fallback(p, found)
        found = self._rounds(p, states, x, t)
        if found is not None and found.residual < STEP_SETTLED:
            return found
        return self._fallback(p, found)

    def _again(self, p: StepProblem, at: StepSolution) -> StepSolution:
        """Return what rounds from a solution of nearly the same step find."""
        begun = self.factor.count if self.factor else 0
        found = self._rounds(p, at.states, at.x, at.t)
        spent = self.factor.count - begun if self.factor else 0
        return replace(found or replace(at, residual=np.inf), factorisations=spent)

    def _rounds(self, p: StepProblem, states: PairStates, x: Array, t: Array) -> StepSolution | None:
        """Return the best that rounds of Newton's method, or of the active set, find; None where there is nothing."""
        assert self.factor is not None
        factor, begun = self.factor, self.factor.count
        best: StepSolution | None = None

        def keep(x: Array, t: Array, states: PairStates, residual: float, how: str) -> StepSolution:
            nonlocal best
            found = StepSolution(x, t, states, residual, how, factor.count - begun)
            if best is None or residual < best.residual:
                best = found
            return best

        seen: list[PairStates] = []
        turn = across_slip(p, x, t)
        for round_ in range(STEP_FACTORISATIONS):
            linear = laws_of_step(p, states, turn)
            D = linear.blocks()
            try:
                factor.factorise(D)
                asked = PairsAsked(p, factor)
                self._linear = LinearStep(linear, factor, D)
                self._begun = self._linear, states, asked
                x1, t1, errors = self._linear.refined(p, x, t)
            except SingularMatrixError:
                break
            residual, laws = p.violation(t1, errors)
            found = keep(x1, t1, states, residual, "same states" if not round_ else "active set")
            if residual < STEP_GOOD:
                return found
            new = halting(read_states(p, x1, t1, errors), states)
            changed = int(((laws > STEP_SETTLED) & new.differ(states)).sum())
            seen.append(states)
            if p.dim == 3:  # slips turn: Newton's method goes on from the point, there is no small linear problem
                x, t, turn, states = x1, t1, across_slip(p, x1, t1, errors), new
                continue
            if changed <= FEW or round_ >= FLIPS or any(not new.differ(s).any() for s in seen):
                settled = settle(p, asked, linear, states, x1, t1, errors)
                found = keep(settled.x, settled.t, settled.states, settled.residual, "small problem")
                if found.residual < STEP_SETTLED:
                    self._linear = settled.linear or self._linear
                    return found
                if any(not new.differ(s).any() for s in seen):
                    break
            states = new
        return best

    def response(self, p: StepProblem, states: PairStates, f: Array) -> Array:
        """Return the change of x (N,) under a change f (N,) of the right-hand side, in given states."""
        pairs = self._take(p)
        part = pairs.part
        assert self.factor is not None
        self._linear = self._begun = None
        turn = across_slip(part, np.zeros(len(f)), np.zeros((part.pairs, p.dim)))
        self.factor.factorise(laws_of_step(part, pairs.states(states), turn).blocks())
        return self.factor.solve(f)

    def _told(self, found: StepSolution) -> StepSolution:
        self.solved_by = max(self.solved_by, found.how, key=MEANS.index)
        return found

    def _fallback(self, p: StepProblem, best: StepSolution | None) -> StepSolution:
        problem = p.contact_problem().by(self.engine)
        pick = np.flatnonzero(p.active)
        answer = interior.solve(problem)
        found = self._read(p, pick, answer.displacement, answer.normal_force, answer.friction_force, "interior point")
        if found.residual < STEP_SETTLED:
            return found
        nearest = found if best is None or found.residual < best.residual else best
        if p.dim == 3:
            return nearest
        answer = sparse_lemke.solve(problem, start_states=nearest.states[pick], tries=0, limit=STEP_PIVOTS * len(pick))
        found = self._read(p, pick, answer.displacement, answer.normal_force, answer.friction_force, "pivoting")
        return found if found.residual < nearest.residual else nearest

    def _read(self, p: StepProblem, pick: Array, x: Array, t_n: Array, t_t: Array, how: str) -> StepSolution:
        t = np.zeros((p.pairs, p.dim))
        t[pick, 0], t[pick, 1:] = t_n, t_t
        residual, _ = p.residual(x, t)
        return StepSolution(x, t, read_states(p, x, t), residual, how, 0)
