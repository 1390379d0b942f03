"""The interior point of the statics against HiGHS, and what it leaves to be rechecked."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import linprog

from concio.solvers.algebra.normal_equations import NormalEquations, rebalance
from concio.solvers.statics import linear_interior
from concio.solvers.statics.highs import minimise
from concio.solvers.statics.linear_interior import solve_interior
from concio.solvers.statics.programme import optimise
from rigid_walls import running_bond


def programme(seed: int):
    """A programme with an answer, by construction: x and y complementary, a free column, some upper bounds."""
    rng = np.random.default_rng(seed)
    rows, n = 9, 24
    A = sp.random_array((rows, n), density=0.4, rng=rng).toarray() - 0.2 * np.eye(rows, n)
    upper = np.where(rng.random(n) < 0.3, rng.uniform(0.5, 3.0, n), np.inf)
    lower = np.where(rng.random(n) < 0.3, -rng.uniform(0.0, 2.0, n), 0.0)
    lower[-1], upper[-1] = -np.inf, np.inf
    inside = np.where(np.isfinite(lower), lower, 0.0) + 0.4 * np.minimum(np.where(np.isfinite(upper), upper, 1.0), 1.0)
    x = np.where(rng.random(n) < 0.5, inside, np.where(np.isfinite(lower), lower, rng.normal(size=n)))
    reduced = np.where(x == lower, rng.random(n), 0.0)
    y = rng.normal(size=rows)
    return A.T @ y + reduced, (sp.csc_array(A), A @ x), np.column_stack([lower, upper]), x


@pytest.mark.parametrize("seed", range(12))
def test_against_a_programme_whose_answer_is_known(seed):
    cost, equations, bounds, x = programme(seed)
    found = solve_interior(cost, equations, bounds)
    assert found is not None
    assert found.close
    assert cost @ found.x == pytest.approx(cost @ x, abs=1e-9 * (1 + abs(cost @ x)))
    other = linprog(cost, A_eq=equations[0], b_eq=equations[1], bounds=bounds, method="highs")
    assert cost @ found.x == pytest.approx(other.fun, abs=1e-9 * (1 + abs(other.fun)))
    assert np.abs(equations[0] @ found.x - equations[1]).max() <= 1e-6
    balanced = rebalance(equations[0], found.x, -equations[1], bounds)
    assert np.abs(equations[0] @ balanced - equations[1]).max() <= 1e-13
    assert (balanced >= bounds[:, 0]).all()
    assert (balanced <= bounds[:, 1]).all()
    # weak duality, with the reduced costs of y alone
    reduced = cost - equations[0].T @ found.y
    held = np.isfinite(bounds).any(axis=1)
    low = np.where(np.isfinite(bounds[:, 0]), bounds[:, 0], 0.0) * np.maximum(reduced, 0)
    high = np.where(np.isfinite(bounds[:, 1]), bounds[:, 1], 0.0) * np.minimum(reduced, 0)
    assert equations[1] @ found.y + (low + high)[held].sum() == pytest.approx(cost @ x, abs=1e-9 * (1 + abs(cost @ x)))


@pytest.mark.parametrize("power", [-40, 40])
def test_the_unit_of_the_loads_changes_no_digit(power):
    """Right sides, bounds and answers in units 2^40 times smaller or larger: the same steps, the same bits."""
    cost, equations, bounds, _ = programme(3)
    A, b = equations
    b = np.where(np.arange(len(b)) == 1, 0.0, b)  # a row without load, as most have
    A = sp.csc_array(sp.hstack([A, sp.eye_array(len(b)), -sp.eye_array(len(b))]))
    cost = np.concatenate([cost, np.full(2 * len(b), 30.0)])
    bounds = np.vstack([bounds, np.tile([0.0, np.inf], (2 * len(b), 1))])
    bounds[bounds[:, 0] > -np.inf, 0] = 0.0
    here, there = (solve_interior(cost, (A, unit * b), unit * bounds) for unit in (1.0, 2.0**power))
    assert here is not None
    assert there is not None
    assert here.close
    assert there.iterations == here.iterations
    assert (there.x == 2.0**power * here.x).all()
    assert (there.y == here.y).all()


@pytest.mark.parametrize("method", ["interior", "highs"])
def test_inequalities_and_fixed_columns(method):
    """Maximise x0 + x1 with x0 + x2 = 2, x1 = 0.25 fixed, x0 + x1 <= 1."""
    cost, equations = np.array([-1.0, -1.0, 0.0]), (sp.csc_array([[1.0, 0.0, 1.0]]), np.array([2.0]))
    bounds = np.array([[0.0, np.inf], [0.25, 0.25], [0.0, np.inf]])
    caps = sp.csc_array([[1.0, 1.0, 0.0]]), np.array([1.0])
    found = optimise(cost, equations, bounds, caps, method=method)
    assert found.status == 0
    assert found.x == pytest.approx([0.75, 0.25, 1.25], abs=1e-9)
    assert found.marginals == pytest.approx([0.0], abs=1e-9)


def test_what_has_no_answer_gets_none():
    contradiction = sp.csc_array([[1.0], [1.0]]), np.array([1.0, 2.0])
    bounds = np.array([[0.0, np.inf]])
    found = solve_interior(np.array([1.0]), contradiction, bounds)
    assert found is None or not found.close
    assert optimise(np.array([1.0]), contradiction, bounds, method="interior").status == 4
    assert optimise(np.array([1.0]), contradiction, bounds).status == 2


@pytest.mark.parametrize("seed", range(2))
def test_more_iterations_never_return_a_worse_point(seed, monkeypatch):
    """Equations that contradict each other a little: where the iteration runs off, the best point met is kept."""
    cost, (A, b), bounds, _ = programme(seed)
    equations = sp.csc_array(sp.vstack([A, A[[0]]])), np.append(b, b[0] + 0.3)
    worst = []
    for most in range(0, 48, 4):
        monkeypatch.setattr(linear_interior, "PROGRAMME_ITERATIONS", most)
        found = solve_interior(cost, equations, bounds)
        worst.append(max(found.primal, found.dual, found.gap))
    assert min(worst) > linear_interior.PROGRAMME_ENOUGH
    assert worst == sorted(worst, reverse=True)


def test_normal_equations_are_those_of_springs():
    a = running_bond(5, 4)
    p = a.problem(0.6, a.load(0, -1))
    A = sp.csc_array(p.C.T)
    theta = np.random.default_rng(1).uniform(0.1, 10.0, A.shape[1])
    normal = NormalEquations(A)
    normal.factorise(theta)
    g = p.f
    x = np.empty_like(g)
    x[normal.order] = normal.solve(g[normal.order])
    assert (A * theta) @ (A.T @ x) == pytest.approx(g, abs=1e-10)


def test_normal_equations_are_those_of_the_weights():
    rng = np.random.default_rng(4)
    A = sp.csc_array(sp.random_array((9, 24), density=0.4, rng=rng) + sp.csc_array(np.eye(9, 24)))
    theta, g = 10.0 ** rng.uniform(-2, 2, 24), rng.normal(size=9)
    normal = NormalEquations(A)
    normal.factorise(theta)
    x = np.zeros(9)
    x[normal.order] = normal.solve(g[normal.order])
    assert (A @ (theta * (A.T @ x))) == pytest.approx(g, abs=1e-8)


def test_where_highs_ends_with_an_error_both_its_methods_are_asked_again_for_a_digit_less(monkeypatch):
    asked = []

    def fails_at_ten_digits(*arguments):
        *_, algorithm, tolerance = arguments
        asked.append((algorithm, tolerance))
        return (4, np.zeros(0), np.zeros(0), "Solve error") if tolerance < 1e-9 else minimise(*arguments)

    monkeypatch.setattr("concio.solvers.statics.programme.minimise", fails_at_ten_digits)
    cost, equations, bounds, x = programme(0)
    found = optimise(cost, equations, bounds, method="highs")
    assert found.status == 0
    assert cost @ found.x == pytest.approx(cost @ x, rel=1e-7)
    assert asked == [("simplex", 1e-10), ("ipm", 1e-10), ("simplex", 1e-9)]


@pytest.mark.parametrize("algorithm", ["simplex", "ipm"])
@pytest.mark.parametrize("seed", range(30))
def test_highs_says_what_scipy_says_of_it(seed: int, algorithm: str) -> None:
    """Random programmes with bounds and rows on both sides, some infeasible and some unbounded."""
    rng = np.random.default_rng(seed)
    m, n = int(rng.integers(1, 6)), int(rng.integers(1, 9))
    matrix = sp.csc_array(sp.random_array((m, n), density=0.6, rng=rng))
    b = matrix @ rng.random(n) if seed % 3 else rng.normal(size=m)
    rows = np.column_stack([np.where(rng.random(m) < 0.5, b, -np.inf), b])
    bounds = np.column_stack([np.where(rng.random(n) < 0.8, 0.0, -np.inf), np.where(rng.random(n) < 0.5, 1.0, np.inf)])
    cost = rng.normal(size=n)
    status, x, y, said = minimise(cost, matrix, rows, bounds, algorithm, 1e-10)
    equal, dense = rows[:, 0] == rows[:, 1], matrix.toarray()
    other = linprog(cost, dense[~equal], b[~equal], dense[equal], b[equal], bounds, method="highs-ds")
    assert said
    assert status == other.status
    if status:
        assert not x.size
        assert not y.size
        return
    assert cost @ x == pytest.approx(other.fun, abs=1e-8)
    reduced = cost - matrix.T @ y
    assert np.all(reduced[~np.isfinite(bounds[:, 1])] > -1e-8)
    assert np.all(y[~equal] < 1e-8)


def test_what_highs_does_not_take_has_no_answer() -> None:
    one = sp.csc_array(np.ones((1, 1)))
    status, x, y, _ = minimise(np.ones(1), one, np.array([[np.nan, np.nan]]), np.array([[0.0, 1.0]]), "simplex", 1e-9)
    assert (status, x.size, y.size) == (4, 0, 0)
