r"""The one linear problem left when the state of every pair is known, solved to the last digits.

Redundant pairs (three at a corner for two relative motions) make it singular; a tiny compliance makes it regular, and
iterative refinement against the rows without that compliance takes its effect out: the refinement converges because the
right-hand sides agree with the redundancy. What comes out is judged like every other answer.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from concio.problem.contact_problem import Array
from concio.problem.pair_state import Normal
from concio.problem.solution import Solution, judge
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.pivoting.pair_rows import PairSystem

ROUNDS = 40
"""Largest number of refinement steps."""


def state_matrix(system: PairSystem, normal: Array, sign: Array) -> tuple[sp.csr_array, Array]:
    """Return matrix and right-hand side of the states at z0 = 0, (N + 2 m, N + 2 m) and (N + 2 m,)."""
    n, m = system.n, system.m
    closed, stick = normal == Normal.CLOSED, sign == 0
    delta = system.delta
    slope = np.where(closed, -sign * system.dilatancy, 0.0)
    C_n, C_t = system.C[::2], system.C[1::2]
    rows_n = sp.diags_array(closed.astype(float)) @ C_n + sp.diags_array(slope) @ C_t
    rows_t = sp.diags_array(stick.astype(float)) @ C_t
    nn = np.where(closed, system.a[:, 0] + delta, 1.0)
    nt = slope * (system.a[:, 1] + delta)
    tn = np.where(stick, 0.0, sign * system.cone.friction)
    tt = np.where(stick, system.a[:, 1] + delta, 1.0)
    C_nt, C_tt = sp.csr_array(C_n.T), sp.csr_array(C_t.T)
    matrix = sp.block_array(
        [
            [system.K, -C_nt, -C_tt],
            [rows_n, sp.diags_array(nn), sp.diags_array(nt)],
            [rows_t, sp.diags_array(tn), sp.diags_array(tt)],
        ]
    )
    b_n, b_t = system.right_hand_side(normal, sign)
    assert matrix.shape[0] == n + 2 * m
    return sp.csr_array(matrix), np.concatenate([system.load + system.anchored, b_n, b_t])


def state_solution(
    system: PairSystem, normal: Array, sign: Array, *, hard: bool = False, swelling: float = 0.0
) -> Array:
    """Return u, (p, r) of each pair and z0 = 0, (N + 2 m + 1,), for given states.

    Parameters
    ----------
    hard : bool
        Take out the compliance of hard pairs (and the weak springs, where there are any) by refinement.
    swelling : float
        Approach forced on every closed pair, in units of the problem's own length.

    Raises
    ------
    SingularMatrixError
        The states leave a body loose.
    """
    n, m = system.n, system.m
    matrix, b = state_matrix(system, normal, sign)
    if swelling:
        b[n : n + m] += np.where(normal == Normal.CLOSED, swelling, 0.0)
    try:
        lu = splu(sp.csc_matrix(matrix))
    except RuntimeError as error:
        raise SingularMatrixError(str(error)) from error
    target = matrix
    if hard:
        held, springs, anchored = system.delta, system.K, system.anchored
        system.delta, system.K, system.anchored = 0.0, sp.csr_array(system.s.K), np.zeros(n)
        target, b = state_matrix(system, normal, sign)
        system.delta, system.K, system.anchored = held, springs, anchored
    x = lu.solve(b)
    if not np.isfinite(x).all() or np.abs(x).max(initial=0.0) > 1e13:
        msg = "the states leave a body loose"
        raise SingularMatrixError(msg)
    best, least = x, np.inf
    for _ in range(ROUNDS if hard else 2):
        rest = b - target @ x
        size = float(np.abs(rest).max(initial=0.0))
        if not size < least:
            break
        best, least = x, size
        if size == 0.0:
            break
        x = x + lu.solve(rest)
    t = np.column_stack([best[n : n + m], best[n + m :]])
    return np.concatenate([best[:n], t.ravel(), [0.0]])


def finish(system: PairSystem, normal: Array, sign: Array, *, method: str, **extra: Any) -> Solution:
    """Solve for the states without artificial compliance and judge the answer."""
    problem, s = system.problem, system.s
    v = state_solution(system, normal, sign, hard=True)
    p, r = v[system.n : -1].reshape(-1, 2).T
    p = np.maximum(np.where(normal == Normal.OPEN, 0.0, p), 0.0)
    strength = system.cone.linear_strength(p)
    r = np.clip(np.where(sign == 0, r, -sign * strength), -strength, strength)
    u, t_n, t_t = s.restore(v[: system.n], np.column_stack([p, r]))
    t_n = np.where(normal == Normal.OPEN, -problem.laws.tension, t_n)
    solution = judge(problem, u, t_n, t_t, method=method, **extra)
    if solution.solved:
        return solution
    for u_, t_n_, t_t_ in ((np.zeros_like(u), t_n, t_t), (u, np.zeros_like(t_n), np.zeros_like(t_t))):
        tried = judge(problem, u_, t_n_, t_t_, method=method, **extra)  # rigid bodies at rest, or nothing loaded
        if tried.solved:
            return tried
    return solution
