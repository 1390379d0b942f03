"""Factors by dense fronts: against dense algebra, whatever the graph, the scaling and the right-hand sides."""

import numpy as np
import pytest
import scipy.sparse as sp

from concio.problem.contact_problem import Array
from concio.solvers.algebra import sparse_factor
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.front_factor import FrontFactor, FrontPlan
from concio.solvers.algebra.second_order_cone import inverses
from concio.solvers.algebra.sparse_factor import OrderedFactor, Pattern, SingularMatrixError

BODY = 6


def edges(nodes: int, shape: str, rng: np.random.Generator) -> Array:
    """Edges of a graph: a chain, a ring, a grid, a random one in pieces, or none."""
    one = np.arange(nodes)
    if shape == "chain":
        return np.column_stack([one[:-1], one[1:]])
    if shape == "ring":
        return np.column_stack([one, (one + 1) % nodes])
    if shape == "grid":
        wide = int(np.sqrt(nodes))
        return np.array([(i, j) for i in one for j in (i + 1, i + wide) if j < nodes and (j % wide or j != i + 1)])
    if shape == "pieces":
        return rng.integers(0, nodes // 2, (2 * nodes, 2)) + (nodes // 2) * rng.integers(0, 2, (2 * nodes, 1))
    return np.zeros((0, 2), dtype=int)


def matrix(nodes: int, shape: str, rng: np.random.Generator, *, skew: float) -> Array:
    """A matrix of stiffness type on a graph, ``skew`` of it not symmetric."""
    A = 0.1 * np.eye(nodes * BODY)
    for i, j in edges(nodes, shape, rng):
        both = np.r_[BODY * i : BODY * (i + 1), BODY * j : BODY * (j + 1)]
        L = rng.standard_normal((2 * BODY, 2 * BODY)) * (i != j)
        A[np.ix_(both, both)] += L @ L.T + skew * (L - L.T)
    return A


def entries(A: Array) -> sp.csc_array:
    """The matrix in compressed columns, its pattern whole nodes."""
    nodes = len(A) // BODY
    met = np.abs(A).reshape(nodes, BODY, nodes, BODY).sum(axis=(1, 3)) > 0
    row, column = np.nonzero(np.kron(met, np.ones((BODY, BODY))))
    order = np.lexsort((row, column))
    indptr = np.searchsorted(column[order], np.arange(len(A) + 1))
    return sp.csc_array((A[row[order], column[order]], row[order], indptr), shape=A.shape)


@pytest.mark.parametrize("shape", ["chain", "ring", "grid", "pieces", "none"])
@pytest.mark.parametrize("skew", [0.0, 0.7])
def test_fronts_solve_as_dense_algebra_does(shape: str, skew: float) -> None:
    rng = np.random.default_rng(len(shape))
    A = matrix(49, shape, rng, skew=skew)
    K = entries(A)
    factor = FrontFactor(FrontPlan(K.indptr, K.indices, BODY))
    for times in (1.0, 3.0):  # one plan, other numbers
        factor.factorise(times * K.data)
        b = rng.standard_normal((len(A), 3))
        wanted = np.linalg.solve(times * A, b)
        assert factor.solve(b) == pytest.approx(wanted, rel=1e-9, abs=1e-11 * np.abs(wanted).max())
        assert factor.solve(b[:, 0]) == pytest.approx(wanted[:, 0], rel=1e-9, abs=1e-11 * np.abs(wanted).max())


def test_fronts_lose_no_digits_where_stiffnesses_span_many_powers_of_ten() -> None:
    """A symmetric matrix with rows and columns times 1e-9 to 1e9: the same digits of each unknown by its scale."""
    rng = np.random.default_rng(5)
    A = matrix(36, "grid", rng, skew=0.0)
    scale = 10.0 ** rng.integers(-9, 10, len(A))
    wanted = rng.standard_normal(len(A))
    K = entries(scale[:, None] * A * scale)
    factor = FrontFactor(FrontPlan(K.indptr, K.indices, BODY))
    factor.factorise(K.data)
    found = scale * factor.solve(scale * (A @ wanted))
    assert found == pytest.approx(wanted, abs=1e-9)


def test_a_singular_front_is_told() -> None:
    A = matrix(9, "chain", np.random.default_rng(1), skew=0.3)
    K = entries(A)
    factor = FrontFactor(FrontPlan(K.indptr, K.indices, BODY))
    with pytest.raises(ZeroDivisionError):
        factor.factorise(0.0 * K.data)


def test_large_structures_of_rigid_blocks_in_space_are_factorised_by_fronts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The engine's two ways give the same, and a singular matrix is told in one way."""
    rng = np.random.default_rng(2)
    A = matrix(400, "grid", rng, skew=0.5)
    K = entries(A).tocoo()
    b, found = rng.standard_normal(len(A)), []
    for fronts in (10**9, 1):
        monkeypatch.setattr(sparse_factor, "FRONTS", fronts)
        pattern = Pattern.of(K.row, K.col, len(A), group=BODY)
        assert (pattern.fronts is not None) == (fronts == 1)
        factor = OrderedFactor(pattern, 0.0)
        data = np.bincount(pattern.slot, weights=K.data, minlength=pattern.nnz)
        factor.factorise(data)
        found.append(factor.solve(b))
        assert A @ found[-1] == pytest.approx(b, abs=1e-9)
        assert 0 < factor.solve_share() < 0.5
        with pytest.raises(SingularMatrixError):
            factor.factorise(0.0 * data)
    assert found[1] == pytest.approx(found[0], rel=1e-9, abs=1e-12)


def test_bodies_that_do_not_move_do_not_divide_the_others() -> None:
    """A wall on a fixed floor is ordered by blocks, not by halves of them."""
    rng = np.random.default_rng(4)
    C = sp.csr_array(np.kron(np.eye(80, 81, k=0)[:, :80] + np.eye(80, k=-1), np.ones((3, BODY))))
    C.data = rng.standard_normal(C.nnz)
    n = C.shape[1]
    floor = BlockFactor(sp.csr_array((n, n)), C, 80, np.concatenate([[0, 0], BODY * np.arange(1, 81), [n]]))
    plain = BlockFactor(sp.csr_array((n, n)), C, 80, BODY * np.arange(81))
    assert np.array_equal(floor.pattern.order, plain.pattern.order)


def test_inverses_in_space() -> None:
    """Of matrices with a regular tangential block, with and without dilatancy; others are refused."""
    rng = np.random.default_rng(6)
    H = rng.standard_normal((200, 3, 3)) + 3.0 * np.eye(3)
    H[:100, 0, 1:] = 0.0  # no dilatancy
    H[:, 0, 0] *= 10.0 ** rng.integers(-6, 6, 200)
    assert np.matmul(inverses(H), H) == pytest.approx(np.broadcast_to(np.eye(3), H.shape), abs=1e-8)
    for fault in ((0, 0), (1, 1)):
        K = H[:100].copy()
        K[7, fault[0], :] = 0.0
        K[7, :, fault[1]] = 0.0
        with pytest.raises(np.linalg.LinAlgError):
            inverses(K)
