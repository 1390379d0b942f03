"""Factors of K + C' D C on one pattern, against dense algebra: every diagonal where it belongs, unsymmetric D."""

import numpy as np
import pytest
import scipy.sparse as sp

from concio.problem.contact_problem import Array
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.sparse_factor import Engine, SingularMatrixError

ENGINES: tuple[Engine, ...] = ("superlu", "pardiso")


def available(engine: Engine) -> Engine:
    """Skip where the engine is an extra that is not installed."""
    if engine == "pardiso":
        pytest.importorskip("pypardiso")
    return engine


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


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("d", [2, 3])
def test_block_factor_solves_with_unsymmetric_blocks(engine: Engine, d: int) -> None:
    rng = np.random.default_rng(d)
    K, C, ranges = blocks(rng, [6, 12, 6, 3, 9, 6, 6], 30, d)
    n = K.shape[0]
    factor = BlockFactor(K, C, 30, ranges, available(engine))
    for _ in range(2):
        D = rng.standard_normal((30, d, d)) * 0.3 + 2 * np.eye(d)
        added, b = rng.uniform(0.5, 2, n), rng.standard_normal(n)
        matrix = K.toarray() + C.T.toarray() @ sp.block_diag(list(D)).toarray() @ C.toarray() + np.diag(added)
        factor.factorise(D, added)
        np.testing.assert_allclose(factor.solve(b), np.linalg.solve(matrix, b), rtol=1e-10, atol=1e-12)
    assert factor.count == 2
    held = factor.with_diagonal(added)
    held.factorise(D, 0.5)
    wanted = np.linalg.solve(matrix + 0.5 * np.eye(n), b)
    np.testing.assert_allclose(held.solve(b), wanted, rtol=1e-10, atol=1e-12)
    assert (factor.count, held.count, factor.made, held.made) == (2, 1, 3, 3)


@pytest.mark.parametrize(("kinds", "together"), [([9, 12, 6, 9], 3), ([6, 6, 6, 6, 6], 6)])
def test_nodes_and_rigid_bodies_in_space_are_ordered_as_wholes(kinds: list[int], together: int) -> None:
    """In twos three displacements of a node are torn apart, which costs a third more time."""
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
