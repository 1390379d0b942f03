r"""Newton's method in space with one factorisation for a step, and rounds on the pairs in question alone.

Of thousands of pairs in a wall that moves a tenth slips; all others stick, or are open, as the first round says. With
their linear laws they join the matrix,

.. math:: G = A + C_r^T D_r C_r, \qquad F = G + C_q^T D_q C_q,

and what is left is a step of the pairs q in question with the matrix G. From round to round only blocks of these
change. With the factors of F

.. math:: (F + C_q^T \Delta D\, C_q)\, F^{-1} v = v + C_q^T \Delta D\, C_q\, F^{-1} v

takes a solve and a product on these pairs, and generalised minimal residuals need some three such iterations for a
round, for most of the changes are small. The answer is checked on all pairs; those it contradicts are in question next.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.problem.tolerances import STEP_GOOD, STEP_SETTLED
from concio.solvers.algebra.minimal_residuals import minimal_residuals
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.states.pair_laws import PairLaws, dot, side_by_side
from concio.solvers.stepping.matrix import StepMatrix
from concio.solvers.stepping.problem import Errors, StepProblem, StepSolution
from concio.solvers.stepping.states import REFINED, across_slip, halting, laws_of_step, read_states
from concio.solvers.stepping.step_factor import StepFactor, filled

TRIES = 8
"""Times that further pairs come into question."""

AGAIN = 3
"""Corrections at most under forces that have changed a little."""

ROUNDS = 6
"""Rounds of Newton's method at most each time: where more are needed, other pairs are in question (decision 0493)."""

PRECISE = 1e-2
"""Share of the error of linear equations that a round leaves: the laws change by more in it."""

MOST = 25
"""Iterations of a round at most."""

DEAR = 40
"""Iterations that cost as much as another factorisation and more: where further pairs come into question then, it is
made."""

STALLED = 0.1
"""Share of the residual of a round before, above which what is good enough is not made better."""

PICKED = ("columns", "values", "active", "cone", "a_n", "a_t", "dilatancy")
"""What pairs in question have as they had it before."""


class OneFactor:
    """Steps of the same rows and the same matrix.

    Parameters
    ----------
    factor : StepFactor
        That has taken them.
    """

    def __init__(self, factor: StepFactor) -> None:
        self.factor = factor
        self.asked, self.spent = np.zeros(0, dtype=np.intp), 0
        self._rest: tuple[Array, StepMatrix, Array] | None = None
        self._last: tuple[Callable[[Array], Array], Array] = np.zeros_like, np.zeros((0, 0, 0))

    def step(self, p: StepProblem, states: PairStates, x: Array, t: Array) -> StepSolution | None:
        """Return the best that is found from a point (x, t); None where there is nothing."""
        best: StepSolution | None = None
        given, last, begun = states, np.inf, self.factor.count
        try:
            x, t, states = self._first(p, x, t)
            for k in range(TRIES):
                errors = p.errors(x, t)
                residual, wrong = p.violation(t, errors)
                if best is None or residual < best.residual:
                    how = "active set" if states.differ(given).any() else "same states"
                    best = StepSolution(x, t, states, residual, how, self.factor.count - begun)
                if residual < REFINED or (best.residual < STEP_GOOD and residual > STALLED * last):
                    break
                if self.spent > DEAR:
                    x, t, states = self._first(p, x, t)
                    last, errors = np.inf, p.errors(x, t)
                    wrong = p.violation(t, errors)[1]
                last, found = residual, read_states(p, x, t, errors)
                further = (found.slips & ~found.open) | ((wrong > STEP_SETTLED) & found.differ(states))
                further[self.asked] = False
                self._ask(np.flatnonzero(further))
                x, t, states = self._decided(p, errors, x, t, states, halting(found, states) if not k else found)
        except SingularMatrixError:
            pass
        return best

    def again(self, p: StepProblem, x: Array, t: Array) -> tuple[Array, Array, float]:
        """Return where the laws of the last answer (x, t) lead under forces a little different, and the residual."""
        errors = p.errors(x, t)
        residual = p.violation(t, errors)[0]
        beyond, D = self._last
        for _ in range(AGAIN):
            if residual < STEP_GOOD:
                break
            dx, _ = minimal_residuals(self.factor.solve, beyond, errors.r_u, STEP_GOOD / max(residual, STEP_GOOD), MOST)
            x, t = x + dx, t - np.matmul(D, p.opening(dx)[:, :, None])[:, :, 0]
            errors = p.errors(x, t)
            residual = p.violation(t, errors)[0]
        return x, t, residual

    def _first(self, p: StepProblem, x: Array, t: Array) -> tuple[Array, Array, PairStates]:
        """Factorise in the states of a point, and return where these lead."""
        errors = p.errors(x, t)
        states = read_states(p, x, t, errors)
        laws = laws_of_step(p, states, across_slip(p, x, t, errors))
        D = laws.blocks()
        self.factor.factorise(D)
        x, t = _led(p, laws, D, x, laws.imposed(t), self.factor.solve)
        self.asked = np.flatnonzero(laws.drag.any(axis=1) | (states.slips & ~states.open))
        self._D, self._rest, self._last, self.spent = D, None, (np.zeros_like, D), 0
        return x, t, states

    def _ask(self, further: Array) -> None:
        """Take further pairs into question."""
        if not len(further) and self._rest is not None:
            return
        q = self.asked = np.sort(np.concatenate([self.asked, further]))
        D = self._D.copy()
        D[q] = 0.0
        self._rest = q, StepMatrix(self.factor.without(q)), D

    def _decided(
        self, p: StepProblem, errors: Errors, x: Array, t: Array, states: PairStates, found: PairStates
    ) -> tuple[Array, Array, PairStates]:
        """Return where the pairs in question lead, all others in their laws; begun with states ``found`` of them."""
        assert self._rest is not None
        q, matrix, D = self._rest
        y, picked = p.opening(x)[q], {name: getattr(p, name)[q] for name in PICKED}
        rows = _Few(picked["columns"], picked["values"], len(x))
        b = errors.r_u - (rows.back @ t[q])[:-1]
        part = replace(p, matrix=matrix, b=b, gap=p.gap[q] + y[:, 0], origin=p.origin[q] - y[:, 1:], **picked)
        part.__dict__.update(flexibility=p.flexibility[q], added=tuple(a[q] for a in p.added), rows=(rows, rows.back))
        dx, t_q, own = self._rounds(part, found[q], np.zeros_like(x), t[q], self._D[q])
        beyond, D_q = self._last
        now = D.copy()
        now[q] = D_q
        self._last = beyond, now
        t = t - np.matmul(D, p.opening(dx)[:, :, None])[:, :, 0]
        t[q] = t_q
        normal, direction = states.normal.copy(), states.direction.copy()
        normal[q], direction[q] = own.normal, own.direction
        return x + dx, t, PairStates(normal, direction)

    def _rounds(
        self, p: StepProblem, states: PairStates, x: Array, t: Array, held: Array
    ) -> tuple[Array, Array, PairStates]:
        """Return where rounds lead from a point of a problem whose blocks in the factors are ``held`` (q, d, d)."""
        errors, last = p.errors(x, t), np.inf
        self._last = np.zeros_like, held
        for k in range(ROUNDS):
            residual, _ = p.violation(t, errors)
            if residual < REFINED or (residual < STEP_GOOD and residual > STALLED * last):
                break
            last = residual
            if k:
                states = halting(read_states(p, x, t, errors), states)
            laws = laws_of_step(p, states, across_slip(p, x, t, errors))
            D = laws.blocks()
            beyond = _beyond(p, D - held)
            self._last = beyond, D

            def solved(b: Array, beyond: Callable[[Array], Array] = beyond) -> Array:
                dx, spent = minimal_residuals(self.factor.solve, beyond, b, PRECISE, MOST)
                self.spent += spent
                return dx

            x, t = _led(p, laws, D, x, laws.imposed(t), solved)
            errors = p.errors(x, t)
        return x, t, states


class _Few:
    """Rows C of few pairs, and their transpose ``back``: products without what a sparse matrix takes to be made.

    Parameters
    ----------
    columns : (q, w) integer array
    values : (q, d, w) array
    size : int
        Number N of unknowns.
    """

    def __init__(self, columns: Array, values: Array, size: int) -> None:
        self.columns, self.values, self.shape = columns, values, (values.shape[0] * values.shape[1], size + 1)
        self.back = _Back(columns.ravel(), np.ascontiguousarray(values.transpose(0, 2, 1)), size + 1)

    def __matmul__(self, x: Array) -> Array:
        """Return C x of unknowns with a zero behind (N + 1,)."""
        return np.asarray(np.matmul(self.values, x[self.columns][:, :, None])).ravel()


@dataclass(frozen=True, eq=False)
class _Back:
    """The transpose of few rows."""

    at: Array
    values: Array
    size: int

    def __matmul__(self, t: Array) -> Array:
        """Return C' t (N + 1,) of forces (q, d)."""
        q, _, d = self.values.shape
        return np.bincount(self.at, np.matmul(self.values, t.reshape(q, d, 1)).ravel(), self.size)


def _led(
    p: StepProblem, laws: PairLaws, D: Array, x: Array, t: Array, solve: Callable[[Array], Array]
) -> tuple[Array, Array]:
    """Return where linear laws lead from a point whose forces obey their states."""
    errors = p.errors(x, t)
    stiff, soft = D[:, 0, 0], laws.soft_t[:, None]
    m_n, m_t = laws.misfit(errors.y_n, errors.y_t, t[:, 1:])
    n0, own = -m_n * stiff, -m_t / soft
    dx = solve(errors.r_u + p.pull(side_by_side(n0, own + laws.drag * n0[:, None])))
    v = p.opening(dx)
    v_n, v_t = v[:, 0], v[:, 1:]
    dt_n = n0 - stiff * (v_n - dot(laws.wide, v_t) if laws.opens else v_n)
    dt_t = own - laws.across(v_t) / soft + laws.drag * dt_n[:, None]
    return x + dx, t + side_by_side(dt_n, dt_t)


def _beyond(p: StepProblem, change: Array) -> Callable[[Array], Array]:
    """Return what multiplies with the matrix of changes of blocks (m, d, d)."""
    some, n = filled(change), len(p.b)
    columns, values = p.columns[some], p.values[some]
    local = np.matmul(values.transpose(0, 2, 1), np.matmul(change[some], values))
    at, padded = columns.ravel(), np.zeros(n + 1)

    def times(v: Array) -> Array:
        padded[:n] = v
        return np.bincount(at, np.matmul(local, padded[columns][:, :, None]).ravel(), n + 1)[:n]

    return times
