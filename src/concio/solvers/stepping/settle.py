r"""States that do not hold are settled by one small problem of the pairs concerned, on the factor at hand.

With the pairs V taken out of the matrix, F_V = F - B' D_V B (B their rows), and all others in their states,

.. math:: y_V = y_V^0 + W (t_V - t_V^0), \qquad W = B F_V^{-1} B^T = G (1 - D_V G)^{-1}, \qquad G = B F^{-1} B^T,

which takes two solves a pair and no factorisation. What the small problem's answer violates elsewhere joins V, and so
on. The answer is then made exact in its states with the same factor, updated: F + B' (D' - D) B.
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.solvers.stepping.factor import StepFactor
from concio.solvers.stepping.problem import StepProblem
from concio.solvers.stepping.small import solve_small
from concio.solvers.stepping.states import Linear, read_states, solve_states

MOST = 120
"""Largest number of pairs of a small problem."""

ROUNDS = 12
"""Largest number of small problems."""

SETTLED = 1e-10
"""Violations of a joint law up to this are settled."""


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


def settle(
    p: StepProblem, factor: StepFactor, states: PairStates, x: Array, t: Array, D: Array
) -> tuple[Array, Array, PairStates, float, int]:
    """Settle the states of a step whose states, factorised, gave (x, t).

    Returns
    -------
    x : (N,) array
    t : (m, 2) array
    states : PairStates
    residual : float
    work : int
        Pairs that took part, summed over the rounds.
    """
    d, n = p.dim, len(p.b)
    chosen = np.zeros(0, dtype=int)
    Z = np.zeros((n, 0))
    x0, t0 = x, t
    linear = Linear.of(p, states)
    best, laws = p.residual(x, t)
    found = (x, t, states, best)
    work = 0
    for _ in range(ROUNDS):
        new = read_states(p, x, t)
        violated = (laws > SETTLED) & new.differ(states)
        violated[chosen] = False
        added = np.flatnonzero(violated)
        if not added.size:
            break
        if len(chosen) + len(added) > MOST:
            break
        rhs = np.zeros((n + 1, d * len(added)))
        for k, pair in enumerate(added.tolist()):
            for j in range(d):
                np.add.at(rhs[:, d * k + j], p.columns[pair], p.values[pair, j])
        Z = np.column_stack([Z, factor.solve(rhs[:n])])
        chosen = np.concatenate([chosen, added])
        work += len(chosen)
        values, columns = p.values[chosen], p.columns[chosen]
        padded = np.vstack([Z, np.zeros((1, Z.shape[1]))])
        G = np.einsum("vdw,vwk->vdk", values, padded[columns]).reshape(len(chosen) * d, -1)
        D_V = _diagonal(D[chosen])
        held = np.linalg.inv(np.eye(len(D_V)) - D_V @ G)
        W = G @ held
        soft = np.column_stack([p.a_n[chosen], *[p.a_t[chosen]] * (d - 1)]).ravel()
        W_c = W + np.diag(soft)
        y_n, y_t = p.relative(x0, t0)
        y = np.column_stack([y_n, y_t])[chosen].ravel()
        tau0 = t0[chosen].ravel()
        forces, _ = solve_small(
            W_c * (p.force / p.length),
            (y - W_c @ tau0) / p.length,
            p.cone[chosen].in_units(p.force),
            p.dilatancy[chosen],
        )
        if forces is None:
            break
        tau = forces.ravel() * p.force
        dx = Z @ (held @ (tau - tau0))
        x = x0 + dx
        moved = p.opening(dx)
        dt_n = -D[:, 0, 0] * (moved[:, 0] - linear.open_wide * moved[:, 1])
        dt_t = np.where(linear.stick, -moved[:, 1] / linear.soft_t, linear.drag * dt_n)
        t = t0 + np.column_stack([dt_n, dt_t])
        t[chosen] = tau.reshape(-1, d)
        _, laws = p.residual(x, t)
        small = read_states(p, x, t)
        normal, direction = states.normal.copy(), states.direction.copy()
        normal[chosen], direction[chosen] = small.normal[chosen], small.direction[chosen]
        now = PairStates(normal, direction)
        settled = Linear.of(p, now)
        D_now = settled.blocks(p)
        try:
            updated = UpdatedFactor(factor, values, columns, Z, G, _diagonal(D_now[chosen] - D[chosen]))
        except np.linalg.LinAlgError:
            break
        x1, t1, errors = solve_states(p, updated, settled, x, t, D_now)
        residual, laws1 = p.violation(t1, errors)
        if residual < found[3]:
            found = (x1, t1, now, residual)
        if residual < SETTLED:
            break
        laws = np.minimum(laws, laws1)
    return (*found, work)


def _diagonal(blocks: Array) -> Array:
    v, d, _ = blocks.shape
    full = np.zeros((v, d, v, d))
    full[np.arange(v), :, np.arange(v)] = blocks
    return full.reshape(v * d, v * d)
