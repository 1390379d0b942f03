r"""States that do not hold are settled by one small problem of the pairs concerned, on the factor at hand.

With the pairs V taken out of the matrix, F_V = F - B' D_V B (B their rows), and all others in their states,

.. math:: y_V = y_V^0 + W (t_V - t_V^0), \qquad W = B F_V^{-1} B^T = G (1 - D_V G)^{-1}, \qquad G = B F^{-1} B^T,

which takes two solves a pair and no factorisation. What the small problem's answer violates elsewhere joins V, and so
on. The answer is then made exact in its states with the same factor, updated: F + B' (D' - D) B.
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.limits_of_work import STEP_PAIRS, STEP_PROBLEMS
from concio.problem.pair_state import PairStates
from concio.problem.tolerances import STEP_SETTLED
from concio.solvers.stepping.factor import StepFactor
from concio.solvers.stepping.problem import StepProblem
from concio.solvers.stepping.small import solve_small
from concio.solvers.stepping.states import Linear, read_states, solve_states


class UpdatedFactor:
    """A factor of F + B' E B by that of F: Z = F^-1 B' and G = B Z are at hand, E is small."""

    def __init__(self, factor: StepFactor, values: Array, columns: Array, Z: Array, G: Array, E: Array) -> None:
        self.factor, self.values, self.columns, self.Z = factor, values, columns, Z
        self.inner = E @ np.linalg.inv(np.eye(len(E)) + G @ E)

    def solve(self, b: Array) -> Array:
        """Return the solution of (F + B' E B) x = b (N,)."""
        x = self.factor.solve(b)
        moved = np.matmul(self.values, np.append(x, 0.0)[self.columns][:, :, None])[:, :, 0].ravel()
        corrected: Array = x - self.Z @ (self.inner @ moved)
        return corrected


class PairsAsked:
    """The pairs V in question, their rows B, and how these respond: Z = F^-1 B' and G = B Z.

    Parameters
    ----------
    p : StepProblem
    factor : StepFactor
        Holds F, the matrix with all pairs in their states.
    D : (m, d, d) array
        Blocks of F.
    """

    def __init__(self, p: StepProblem, factor: StepFactor, D: Array) -> None:
        self.p, self.factor, self.D = p, factor, D
        self.number = np.zeros(0, dtype=int)
        self.values, self.columns = p.values[:0], p.columns[:0]
        self.Z, self.G = np.zeros((len(p.b), 0)), np.zeros((0, 0))

    def join(self, added: Array) -> None:
        """Take further pairs in: two solves each."""
        p, d, n = self.p, self.p.dim, len(self.p.b)
        rhs = np.zeros((n + 1, d * len(added)))
        for k, pair in enumerate(added.tolist()):
            for j in range(d):
                np.add.at(rhs[:, d * k + j], p.columns[pair], p.values[pair, j])
        self.Z = np.column_stack([self.Z, self.factor.solve(rhs[:n])])
        self.number = np.concatenate([self.number, added])
        self.values, self.columns = p.values[self.number], p.columns[self.number]
        padded = np.vstack([self.Z, np.zeros((1, self.Z.shape[1]))])
        self.G = np.einsum("vdw,vwk->vdk", self.values, padded[self.columns]).reshape(len(self.number) * d, -1)

    def decided(self, linear: Linear, x0: Array, t0: Array) -> tuple[Array, Array] | None:
        """Return x (N,) and t (m, d) with these pairs decided by the small problem, all others in their states.

        Parameters
        ----------
        linear : Linear
            The states that gave (x0, t0).
        x0, t0 : (N,), (m, d) arrays
        """
        p, d, V = self.p, self.p.dim, self.number
        D_V = _diagonal(self.D[V])
        held = np.linalg.inv(np.eye(len(D_V)) - D_V @ self.G)
        soft = np.column_stack([p.a_n[V], *[p.a_t[V]] * (d - 1)]).ravel()
        W = self.G @ held + np.diag(soft)
        y_n, y_t = p.relative(x0, t0)
        y = np.column_stack([y_n, y_t])[V].ravel()
        tau0 = t0[V].ravel()
        forces, _ = solve_small(
            W * (p.force / p.length), (y - W @ tau0) / p.length, p.cone[V].in_units(p.force), p.dilatancy[V]
        )
        if forces is None:
            return None
        tau = forces.ravel() * p.force
        dx = self.Z @ (held @ (tau - tau0))
        moved = p.opening(dx)
        dt_n = -self.D[:, 0, 0] * (moved[:, 0] - linear.open_wide * moved[:, 1])
        dt_t = np.where(linear.stick, -moved[:, 1] / linear.soft_t, linear.drag * dt_n)
        t = t0 + np.column_stack([dt_n, dt_t])
        t[V] = tau.reshape(-1, d)
        return x0 + dx, t

    def updated(self, D: Array) -> UpdatedFactor:
        """Return the factor with these pairs in other states, of blocks ``D`` (m, d, d); raises LinAlgError."""
        change = _diagonal(D[self.number] - self.D[self.number])
        return UpdatedFactor(self.factor, self.values, self.columns, self.Z, self.G, change)


def settle(
    p: StepProblem, factor: StepFactor, states: PairStates, x: Array, t: Array, D: Array
) -> tuple[Array, Array, PairStates, float]:
    """Settle the states of a step whose states, factorised, gave (x, t).

    Returns
    -------
    x : (N,) array
    t : (m, 2) array
    states : PairStates
    residual : float
    """
    x0, t0, linear = x, t, Linear.of(p, states)
    best, laws = p.residual(x, t)
    found = (x, t, states, best)
    asked = PairsAsked(p, factor, D)
    for _ in range(STEP_PROBLEMS):
        violated = (laws > STEP_SETTLED) & read_states(p, x, t).differ(states)
        violated[asked.number] = False
        added = np.flatnonzero(violated)
        if not added.size or len(asked.number) + len(added) > STEP_PAIRS:
            break
        asked.join(added)
        decided = asked.decided(linear, x0, t0)
        if decided is None:
            break
        x, t = decided
        _, laws = p.residual(x, t)
        small, V = read_states(p, x, t), asked.number
        normal, direction = states.normal.copy(), states.direction.copy()
        normal[V], direction[V] = small.normal[V], small.direction[V]
        now = PairStates(normal, direction)
        settled = Linear.of(p, now)
        D_now = settled.blocks(p)
        try:
            updated = asked.updated(D_now)
        except np.linalg.LinAlgError:
            break
        x1, t1, errors = solve_states(p, updated, settled, x, t, D_now)
        residual, laws1 = p.violation(t1, errors)
        if residual < found[3]:
            found = (x1, t1, now, residual)
        if residual < STEP_SETTLED:
            break
        laws = np.minimum(laws, laws1)
    return found


def _diagonal(blocks: Array) -> Array:
    v, d, _ = blocks.shape
    full = np.zeros((v, d, v, d))
    full[np.arange(v), :, np.arange(v)] = blocks
    return full.reshape(v * d, v * d)
