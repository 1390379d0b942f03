"""Lemke's method on random problems of classes it is known to decide."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from concio.solvers.lcp.lemke_method import Outcome, lemke
from concio.solvers.lcp.linear_problem import LinearComplementarity
from lcp_oracles import infeasibility
from samples import sample

small = st.integers(-4, 4).map(float)
sizes = st.integers(1, 7)


@st.composite
def square_and_vector(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    n = draw(sizes)
    return draw(arrays(float, (n, n), elements=small)), draw(arrays(float, n, elements=small))


def good(problem: LinearComplementarity, residual: float) -> bool:
    return residual <= 1e-9 * (1 + np.abs(problem.q).max() + np.abs(problem.M).max())


@settings(max_examples=sample(60, 150), deadline=None)
@given(square_and_vector(), st.sampled_from(["inverse", "product"]), st.sampled_from([1e-5, 1.0, 1e6]))
def test_p_matrices_are_solved(data: tuple[np.ndarray, np.ndarray], basis: str, unit: float) -> None:
    """L L' + skew + I/2 is a P-matrix: one solution for every q, in any units."""
    L, q = data
    problem = LinearComplementarity((L @ L.T + (L - L.T) + 0.5 * np.eye(len(q))) / unit, q * unit)
    result = lemke(problem, basis=basis)  # type: ignore[arg-type]
    assert result.outcome is Outcome.SOLVED
    assert problem.residual(result.z) <= 1e-9 * (1 + np.abs(problem.q).max())


@settings(max_examples=sample(60, 150), deadline=None)
@given(square_and_vector())
def test_copositive_plus_is_solved_or_infeasible(data: tuple[np.ndarray, np.ndarray]) -> None:
    """A A' + skew is positive semidefinite, hence copositive-plus: a ray proves that no feasible point exists."""
    A, q = data
    A = A[:, : max(1, len(q) // 2)]
    S = np.triu(np.outer(q, np.arange(len(q)) - 1.0))
    problem = LinearComplementarity(A @ A.T + S - S.T, q)
    result = lemke(problem)
    if result.outcome is Outcome.SOLVED:
        assert good(problem, result.residual)
    else:
        assert result.outcome is Outcome.RAY
        v = infeasibility(problem)
        assert v is not None
        assert problem.q @ v < 0
        assert (problem.M.T @ v).max() <= 1e-9


@settings(max_examples=sample(60, 150), deadline=None)
@given(st.integers(2, 6), st.integers(0, 10_000))
def test_degenerate_problems_end(n: int, seed: int) -> None:
    """Repeated rows and columns and zeros in q: ratios tie all along the path."""
    rng = np.random.default_rng(seed)
    A = rng.integers(-1, 2, (n, 2)).astype(float)
    rows = rng.integers(0, n, 2 * n)
    M = (A @ A.T)[np.ix_(rows, rows)]
    z = rng.integers(0, 2, 2 * n).astype(float)
    q = np.where(z > 0, 0.0, rng.integers(0, 2, 2 * n)) - M @ z  # feasible by construction
    problem = LinearComplementarity(M, q)
    result = lemke(problem, limit=5000)
    assert result.outcome is Outcome.SOLVED
    assert good(problem, result.residual)
