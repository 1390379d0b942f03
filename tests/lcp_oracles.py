"""Linear complementarity problems solved or shown to be infeasible, without trusting the method under test."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from scipy.optimize import linprog

from concio.solvers.lcp.lemke_method import Outcome, lemke
from concio.solvers.lcp.linear_problem import LinearComplementarity


def infeasibility(problem: LinearComplementarity) -> np.ndarray | None:
    """Return v >= 0 with M'v <= 0 and q'v < 0, which no z >= 0 with M z + q >= 0 admits; None where there is none."""
    found = linprog(problem.q, A_ub=problem.M.T, b_ub=np.zeros(problem.size), bounds=(0.0, 1.0), method="highs")
    if found.x is None or found.fun > -1e-9:
        return None
    v = np.maximum(found.x, 0.0)
    return v / v.max()


def solution(problem: LinearComplementarity, tries: int = 4) -> np.ndarray | None:
    """Return a solution: by trying all 2^n pieces of a small problem, else by Lemke's method under several covers."""
    if problem.size <= 6:
        return next((z for z in pieces(problem) if problem.residual(z) <= 1e-12), None)
    rng = np.random.default_rng(1)
    for k in range(tries):
        cover = None if k == 0 else 10.0 ** rng.uniform(-2, 2, problem.size)
        result = lemke(problem, cover=cover, seed=k)
        if result.outcome is Outcome.SOLVED and problem.residual(result.z) <= 1e-9 * (1 + np.abs(problem.q).max()):
            return result.z
    return None


def pieces(problem: LinearComplementarity) -> Iterator[np.ndarray]:
    """Yield the z of every piece that has one: w_i = 0 for the i chosen, z_i = 0 for the others."""
    for chosen in product((False, True), repeat=problem.size):
        pick, z = np.flatnonzero(chosen), np.zeros(problem.size)
        block = problem.M[np.ix_(pick, pick)]
        if pick.size and np.linalg.matrix_rank(block) < pick.size:
            continue
        z[pick] = np.linalg.solve(block, -problem.q[pick])
        yield z
