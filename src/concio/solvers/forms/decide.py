r"""Solve a linear complementarity problem or prove that it has no solution.

Lemke's method decides only for some classes of matrices. Where it ends on a ray, it is tried again with other covering
vectors; then linear programming takes over:

* *infeasible*: no z >= 0 has M z + q >= 0 at all. Proof: v >= 0 with M'v <= 0 and q'v < 0, for then
  0 > q'v >= q'v + (M'v)'z = v'(M z + q) >= 0. The vector is returned and checked by plain products.
* *exhausted*: branching on z_i = 0 or w_i = 0, a linear programme at each node, every branch infeasible: feasible
  points exist, and none is complementary. Work grows like 2^n at worst, so the number of nodes is limited.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from scipy.optimize import linprog

from concio.problem.contact_problem import Array
from concio.solvers.forms.lemke_method import Outcome, lemke
from concio.solvers.forms.linear_problem import LinearComplementarity, is_sparse

ACCURATE = 1e-9
"""Residual below which a candidate counts as a solution, relative to 1 + max |q|."""


class Verdict(Enum):
    """What is known of a linear complementarity problem."""

    SOLVED = "solved"
    INFEASIBLE = "no solution: no z >= 0 has M z + q >= 0; a vector proves it"
    EXHAUSTED = "no solution: feasible points exist, and every complementary piece was excluded by linear programming"
    UNDECIDED = "neither solved nor excluded within the limits given"


@dataclass(frozen=True, eq=False)
class Decision:
    """Verdict and what proves it.

    Parameters
    ----------
    verdict : Verdict
    z : (n,) array or None
        The solution.
    proof : (n,) array or None
        v >= 0 with M'v <= 0, q'v < 0, scaled to largest entry 1.
    nodes : int
        Linear programmes solved while branching.
    """

    verdict: Verdict
    z: Array | None = None
    proof: Array | None = None
    nodes: int = 0


def decide(problem: LinearComplementarity, *, tries: int = 4, nodes: int = 2000) -> Decision:
    """Solve the problem or prove that it has no solution.

    Parameters
    ----------
    problem : LinearComplementarity
    tries : int
        Runs of Lemke's method with different covering vectors.
    nodes : int
        Largest number of linear programmes when branching.
    """
    n = problem.size
    rng = np.random.default_rng(1)
    good = ACCURATE * (1.0 + np.abs(problem.q).max(initial=0.0))
    for k in range(tries):
        cover = None if k == 0 else 10.0 ** rng.uniform(-2, 2, n)
        result = lemke(problem, cover=cover, seed=k)
        if result.outcome is Outcome.SOLVED and result.residual <= good:
            return Decision(Verdict.SOLVED, z=result.z)
    proof = infeasibility(problem)
    if proof is not None:
        return Decision(Verdict.INFEASIBLE, proof=proof)
    return _branch(problem, nodes, good)


def infeasibility(problem: LinearComplementarity) -> Array | None:
    """Return v >= 0 with M'v <= 0 and q'v < 0, checked; None where none was found."""
    solve: Any = linprog
    found = solve(problem.q, A_ub=problem.M.T, b_ub=np.zeros(problem.size), bounds=(0.0, 1.0), method="highs")
    if found.x is None or found.fun > -ACCURATE:
        return None
    v: Array = np.maximum(found.x, 0.0)
    v = v / v.max()
    excess = float((problem.M.T @ v).max(initial=0.0))
    power = float(problem.q @ v)
    return v if power < -ACCURATE and excess <= 1e-12 * max(1.0, -power) else None


def _branch(problem: LinearComplementarity, limit: int, good: float) -> Decision:
    """Depth-first search over complementary pieces, the worst violated pair first."""
    n = problem.size
    M = problem.M.toarray() if is_sparse(problem.M) else problem.M
    solve: Any = linprog
    count = 0
    stack: list[tuple[frozenset[int], frozenset[int]]] = [(frozenset(), frozenset())]
    while stack:
        if count >= limit:
            return Decision(Verdict.UNDECIDED, nodes=count)
        z_zero, w_zero = stack.pop()
        count += 1
        upper = np.full(n, np.inf)
        upper[list(z_zero)] = 0.0
        fixed = sorted(w_zero)
        cost = np.ones(n) if not fixed else M.sum(axis=0)
        cost = np.where(np.isfinite(cost), np.maximum(cost, 0.0), 0.0)  # bounded below on z >= 0
        found = solve(
            cost,
            A_ub=-M,
            b_ub=problem.q,
            A_eq=M[fixed] if fixed else None,
            b_eq=-problem.q[fixed] if fixed else None,
            bounds=np.column_stack([np.zeros(n), upper]),
            method="highs",
        )
        if found.status == 2:
            continue
        if found.x is None:
            return Decision(Verdict.UNDECIDED, nodes=count)
        z = np.maximum(found.x, 0.0)
        gap = np.minimum(z, problem.slack(z))
        gap[list(z_zero | w_zero)] = 0.0
        worst = int(np.argmax(gap))
        if gap[worst] <= good:
            if problem.residual(z) <= good:
                return Decision(Verdict.SOLVED, z=z, nodes=count)
            return Decision(Verdict.UNDECIDED, nodes=count)
        stack += [(z_zero | {worst}, w_zero), (z_zero, w_zero | {worst})]
    return Decision(Verdict.EXHAUSTED, nodes=count)
