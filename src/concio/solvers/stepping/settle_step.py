r"""States that do not hold are settled by one small problem of the pairs concerned, on the factor at hand.

With the pairs V taken out of the matrix, F_V = F - B' D_V B (B their rows), and all others in their states,

.. math:: y_V = y_V^0 + W (t_V - t_V^0), \qquad W = B F_V^{-1} B^T = G (1 - D_V G)^{-1}, \qquad G = B F^{-1} B^T,

which takes two solves a pair and no factorisation. What the small problem's answer violates elsewhere joins V, and so
on. The answer is then made exact in its states with the same factor, updated: F + B' (D' - D) B.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.limits_of_work import STEP_PAIRS, STEP_PROBLEMS
from concio.problem.pair_state import PairStates
from concio.problem.tolerances import STEP_SETTLED
from concio.solvers.algebra.factor import Factor, Solves
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.algebra.updated_blocks import UpdatedBlocks
from concio.solvers.states.pair_laws import PairLaws, dot
from concio.solvers.stepping.problem import Errors, StepProblem
from concio.solvers.stepping.small import solve_small
from concio.solvers.stepping.states import across_slip, laws_of_step, read_states, solve_states


class PairsAsked:
    """The pairs V in question on a factor that is updated for them: two solves each.

    Parameters
    ----------
    p : StepProblem
    factor : Factor
        Holds F, the matrix with all pairs in their states.
    """

    def __init__(self, p: StepProblem, factor: Factor) -> None:
        self.p, self.number = p, np.zeros(0, dtype=int)
        assert factor.D is not None
        self.D = factor.D
        self.blocks = UpdatedBlocks(factor, p.rows[0], len(p.b), p.dim, STEP_PAIRS)

    def again(self, p: StepProblem) -> PairsAsked:
        """Return none of the pairs of a problem with the same rows and factor, which finds the columns made so far."""
        self.p, self.number = p, np.zeros(0, dtype=int)
        if self.blocks.pairs.size > STEP_PAIRS:
            self.blocks.forget()
        return self

    def join(self, added: Array) -> None:
        """Take further pairs in."""
        self.number = np.concatenate([self.number, added])

    def decided(self, laws: PairLaws, x0: Array, t0: Array) -> tuple[Array, Array] | None:
        """Return x (N,) and t (m, d) with these pairs decided by the small problem, all others in their states.

        Parameters
        ----------
        laws : PairLaws
            The states that gave (x0, t0).
        x0, t0 : (N,), (m, d) arrays
        """
        p, d, V = self.p, self.p.dim, self.number
        self.blocks.change(V, np.zeros((V.size, d, d)))
        soft = np.column_stack([p.a_n[V], *[p.a_t[V]] * (d - 1)]).ravel()
        W = self.blocks.flexibility(V) + np.diag(soft)
        y_n, y_t = p.relative(x0, t0)
        y = np.column_stack([y_n, y_t])[V].ravel()
        tau0 = t0[V].ravel()
        forces = solve_small(
            W * (p.force / p.length), (y - W @ tau0) / p.length, p.cone[V].in_units(p.force), p.dilatancy[V]
        )
        if forces is None:
            return None
        tau = forces.ravel() * p.force
        dx = self.blocks.moved(V, tau - tau0)
        moved = p.opening(dx)
        dt_n = -self.D[:, 0, 0] * (moved[:, 0] - dot(laws.wide, moved[:, 1:]))
        dt_t = laws.drag * dt_n[:, None] - laws.across(moved[:, 1:]) / laws.soft_t[:, None]
        t = t0 + np.column_stack([dt_n, dt_t])
        t[V] = tau.reshape(-1, d)
        return x0 + dx, t

    def updated(self, D: Array) -> Solves:
        """Return the factor with these pairs in other states, of blocks ``D`` (m, d, d)."""
        self.blocks.change(self.number, D[self.number])
        return self.blocks


@dataclass(frozen=True, eq=False)
class LinearStep:
    """The linear equations of a step in given states.

    Parameters
    ----------
    laws : PairLaws
    factor : Solves
        Holds their matrix.
    D : (m, d, d) array
        Blocks of the pairs in it.
    """

    laws: PairLaws
    factor: Solves
    D: Array

    def refined(self, p: StepProblem, x: Array, t: Array) -> tuple[Array, Array, Errors]:
        """Return x, t and the errors of a step with these states, by refinement from a point."""
        return solve_states(p, self.factor, self.laws, x, t, self.D)


@dataclass(frozen=True, eq=False)
class Settled:
    """A step whose states were settled.

    Parameters
    ----------
    x : (N,) array
    t : (m, d) array
    states : PairStates
    residual : float
    linear : LinearStep or None
        Of these states; None where nothing was settled.
    """

    x: Array
    t: Array
    states: PairStates
    residual: float
    linear: LinearStep | None = None


def settle(
    p: StepProblem, asked: PairsAsked, linear: PairLaws, states: PairStates, x: Array, t: Array, errors: Errors
) -> Settled:
    """Settle the states of a step whose states, with their laws and factor, gave (x, t), which has these errors."""
    x0, t0 = x, t
    best, laws = p.violation(t, errors)
    found = Settled(x, t, states, best)
    read = read_states(p, x, t, errors)
    for _ in range(STEP_PROBLEMS):
        violated = (laws > STEP_SETTLED) & read.differ(states)
        violated[asked.number] = False
        added = np.flatnonzero(violated)
        if not added.size or len(asked.number) + len(added) > STEP_PAIRS:
            break
        asked.join(added)
        try:
            decided = asked.decided(linear, x0, t0)
        except SingularMatrixError:
            break
        if decided is None:
            break
        x, t = decided
        errors = p.errors(x, t)
        _, laws = p.violation(t, errors)
        read, V = read_states(p, x, t, errors), asked.number
        normal, direction = states.normal.copy(), states.direction.copy()
        normal[V], direction[V] = read.normal[V], read.direction[V]
        now = PairStates(normal, direction)
        settled = laws_of_step(p, now, across_slip(p, x, t))
        D_now = settled.blocks()
        try:
            own = LinearStep(settled, asked.updated(D_now), D_now)
        except SingularMatrixError:
            break
        x1, t1, errors = own.refined(p, x, t)
        residual, laws1 = p.violation(t1, errors)
        if residual < found.residual:
            found = Settled(x1, t1, now, residual, own)
        if residual < STEP_SETTLED:
            break
        laws = np.minimum(laws, laws1)
    return found

