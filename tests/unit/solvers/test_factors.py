"""Factors of K + C' D C on one pattern, against dense algebra: every diagonal where it belongs, unsymmetric D."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import concio
from concio.problem.contact_problem import Array, Engine
from concio.solvers.algebra import sparse_factor
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.scaled import LOOSE, scale
from concio.solvers.algebra.sparse_factor import OrderedFactor, Pattern, SingularMatrixError
from concio.solvers.methods import find
from concio.solvers.stepping.step_factor import StepFactor

FACTORS = ("band", "superlu", "pardiso")


def asked(factor: str, monkeypatch: pytest.MonkeyPatch) -> Engine:
    """Return the engine that factorises this way; skip where it is an extra that is not installed."""
    if factor == "pardiso":
        pytest.importorskip("pypardiso")
        return "pardiso"
    if factor == "superlu":
        monkeypatch.setattr(sparse_factor, "NARROW", -1)
    return "superlu"


def gram(a: Array) -> Array:
    """Return a a'."""
    product: Array = a @ a.T
    return product


def blocks(rng: np.random.Generator, kinds: list[int], pairs: int, d: int) -> tuple[sp.csr_array, sp.csr_array, Array]:
    """Return K and C of bodies with ``kinds`` unknowns, pairs between random ones of them, and the body ranges."""
    ranges = np.concatenate([[0], np.cumsum(kinds)])
    C = np.zeros((pairs * d, int(ranges[-1])))
    for k in range(pairs):
        for body in rng.choice(len(kinds), size=2, replace=False):
            unknowns = np.arange(ranges[body], ranges[body + 1])
            met = unknowns if len(unknowns) <= 6 else rng.choice(unknowns, size=d, replace=False)
            C[k * d : (k + 1) * d, met] = rng.standard_normal((d, len(met))) * (rng.random((d, len(met))) > 0.3)
    dense = [np.zeros((n, n)) if n <= 6 else gram(rng.standard_normal((n, n - 3))) for n in kinds]
    return sp.csr_array(sp.block_diag(dense)), sp.csr_array(C), ranges


@pytest.mark.parametrize("by", FACTORS)
@pytest.mark.parametrize("d", [2, 3])
def test_block_factor_solves_with_unsymmetric_blocks(by: str, d: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(d)
    K, C, ranges = blocks(rng, [6, 12, 6, 3, 9, 6, 6], 30, d)
    n = K.shape[0]
    spread = sp.random_array((n, n), density=0.05, rng=rng)
    mass = sp.csr_array(sp.block_diag([np.ones((3, 3))] * (n // 3)) + spread + spread.T)
    factor = BlockFactor(K, C, 30, ranges, asked(by, monkeypatch), added=mass)
    assert (factor.pattern.width is not None) == (by == "band")
    for _ in range(2):
        D = rng.standard_normal((30, d, d)) * 0.3 + 2 * np.eye(d)
        added, b = rng.uniform(0.5, 2, n), rng.standard_normal(n)
        matrix = K.toarray() + C.T.toarray() @ sp.block_diag(list(D)).toarray() @ C.toarray() + np.diag(added)
        factor.factorise(D, added)
        np.testing.assert_allclose(factor.solve(b), np.linalg.solve(matrix, b), rtol=1e-10, atol=1e-12)
        several = rng.standard_normal((n, 5))
        np.testing.assert_allclose(factor.solve(several), np.linalg.solve(matrix, several), rtol=1e-10, atol=1e-12)
    assert factor.count == 2
    held, bare = factor.with_added(0.1 * mass), matrix - np.diag(added)
    held.factorise(D, 0.5)
    wanted = np.linalg.solve(bare + 0.1 * mass.toarray() + 0.5 * np.eye(n), b)
    np.testing.assert_allclose(held.solve(b), wanted, rtol=1e-9, atol=1e-11)
    assert (factor.count, held.count, factor.made, held.made) == (2, 1, 3, 3)
    held.factorise(D, 0.2 * mass)
    np.testing.assert_allclose(held.solve(b), np.linalg.solve(bare + 0.3 * mass.toarray(), b), rtol=1e-9, atol=1e-11)
    assert held.may_add(3.0 * mass)
    assert not held.may_add(sp.csr_array(sp.eye_array(n)))


@pytest.mark.parametrize(("kinds", "together"), [([9, 12, 6, 9], 3), ([6, 6, 6, 6, 6], 6)])
def test_nodes_and_rigid_bodies_in_space_are_ordered_as_wholes(
    kinds: list[int], together: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In twos three displacements of a node are torn apart, which costs a third more time."""
    monkeypatch.setattr(sparse_factor, "NARROW", -1)
    K, C, ranges = blocks(np.random.default_rng(5), kinds, 12, 3)
    order = BlockFactor(K, C, 12, ranges).pattern.order.reshape(-1, together)
    assert (order == order[:, :1] // together * together + np.arange(together)).all()


def test_pairs_between_the_same_rigid_bodies_are_one_clique() -> None:
    rng = np.random.default_rng(1)
    C = np.zeros((15, 12))
    C[:, :] = rng.standard_normal((15, 12)) * (rng.random((15, 12)) > 0.3)
    factor = BlockFactor(sp.csr_array((12, 12)), sp.csr_array(C), 5, np.array([0, 6, 12]))
    assert [clique.pairs.shape for clique in factor.cliques] == [(1, 5)]


def test_values_that_are_not_finite_are_refused() -> None:
    factor = BlockFactor(sp.csr_array((6, 6)), sp.csr_array(np.ones((3, 6))), 1, np.array([0, 6]))
    with pytest.raises(SingularMatrixError):
        factor.factorise(np.full((1, 3, 3), np.nan), 1.0)


def ordered(matrix: sp.coo_array) -> tuple[OrderedFactor, Array]:
    """Return the factor of a matrix, not yet made, and its entries as the factor wants them."""
    pattern = Pattern.of(matrix.row, matrix.col, matrix.shape[0], "superlu")
    return OrderedFactor(pattern), np.bincount(pattern.slot, weights=matrix.data, minlength=pattern.nnz)


def test_slender_structures_are_bands_however_long_and_large_walls_are_not() -> None:
    """A chain numbered at random is a band of one; the graph of a square wall has none."""
    rng = np.random.default_rng(3)
    n = 20_000
    name = rng.permutation(n)
    one, other = name[:-1], name[1:]
    values = rng.uniform(-1.0, 0.0, n - 1)
    row, column = np.concatenate([name, one, other]), np.concatenate([name, other, one])
    chain = sp.coo_array((np.concatenate([np.full(n, 2.1), values, 0.5 * values]), (row, column)), shape=(n, n))
    factor, data = ordered(chain)
    assert factor.pattern.width == 1
    factor.factorise(data)
    b = rng.standard_normal(n)
    np.testing.assert_allclose(chain @ factor.solve(b), b, rtol=1e-12, atol=1e-12)
    side = 150
    line = sp.diags_array([1.0, 1.0], offsets=[-1, 1], shape=(side, side))
    wall = sp.coo_array(sp.kronsum(line, line) + 5.0 * sp.eye_array(side**2))
    assert ordered(wall)[0].pattern.width is None


def test_a_singular_band_is_told() -> None:
    factor, data = ordered(sp.coo_array(np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])))
    assert factor.pattern.width is not None
    with pytest.raises(SingularMatrixError, match="singular"):
        factor.factorise(data)


def test_two_solves_of_one_problem_share_the_order_and_no_factors() -> None:
    problem = concio.assemble(concio.column(width=0.5, height=1.0, blocks=3, friction=0.6, top_pressure=10.0)).problem()
    one, other = scale(problem), scale(problem)
    assert one.factor.pattern is other.factor.pattern
    assert one.factor.numeric is not other.factor.numeric
    other.factor.factorise(2.0 * other.factor.D, 1.0)
    assert (one.factor.made, other.factor.made, one.factor.has(one.factor.D, LOOSE)) == (1, 2, True)
    loaded = scale(problem.with_loads(2.0 * problem.f))
    assert loaded.factor.pattern is one.factor.pattern, "loads do not change the matrices"
    apart = scale(replace(problem, C_n=problem.C_n.copy()))
    assert apart.factor.pattern is not one.factor.pattern


def test_a_problem_whose_matrices_are_changed_is_solved_as_it_is_now() -> None:
    problem = concio.assemble(concio.running_bond_panel(courses=3, blocks=3, top_pressure=10.0)).problem()
    before = find("interior-point")(problem)
    problem.K.data *= 2.0
    after = find("interior-point")(problem)
    assert (before.solved, after.solved) == (True, True)
    np.testing.assert_allclose(2.0 * after.displacement, before.displacement, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("n", [12, 60])
def test_a_step_factor_adds_pairs_and_springs_where_they_belong(n: int) -> None:
    """Small systems are inverted, larger ones factored; every third pair has a column less."""
    rng = np.random.default_rng(n)
    m, w = 2 * n, 4
    A = sp.diags_array([np.full(n - 1, -1.0), np.full(n, 5.0), np.full(n - 1, -1.0)], offsets=[-1, 0, 1]).tocsr()
    columns = np.array([rng.choice(n, w, replace=False) for _ in range(m)])
    columns[::3, -1] = n
    values, D = rng.normal(size=(m, 2, w)), rng.normal(size=(m, 2, 2)) + 3.0 * np.eye(2)
    values[::3, :, -1] = 0.0
    springs = rng.uniform(1.0, 2.0, n)
    dense = A.toarray() + np.diag(springs)
    for k in range(m):
        rows = np.zeros((2, n + 1))
        rows[:, columns[k]] = values[k]
        dense += rows[:, :n].T @ D[k] @ rows[:, :n]
    factor = StepFactor(A, columns)
    factor.take(A, values)
    factor.factorise(D, springs)
    b = rng.normal(size=n)
    assert factor.solve(b) == pytest.approx(np.linalg.solve(dense, b), rel=1e-8)


@pytest.mark.parametrize("by", FACTORS)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_one_entry_that_is_not_finite_is_enough_to_refuse_a_matrix(
    by: str, value: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(7)
    K, C, ranges = blocks(rng, [6, 12, 6, 3, 9], 20, 2)
    factor = BlockFactor(K, C, 20, ranges, asked(by, monkeypatch))
    D = rng.standard_normal((20, 2, 2)) * 0.3 + 2 * np.eye(2)
    added = np.ones(K.shape[0])
    factor.factorise(D, added)
    added[5] = value
    with pytest.raises(SingularMatrixError, match="not finite"):
        factor.factorise(D, added)
