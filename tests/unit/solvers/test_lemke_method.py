"""Lemke's method on standard and generalised problems: small textbook problems, a corpus, and how it ends."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

from concio.errors import InputError
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.lcp.lemke_basis import Columns, ExplicitInverse, ProductForm
from concio.solvers.lcp.lemke_method import Outcome, equilibrate, lemke
from concio.solvers.lcp.linear_problem import GeneralisedComplementarity, LinearComplementarity
from lcp_oracles import infeasibility, solution

CORPUS = Path(os.environ.get("CONCIO_LCP_CORPUS", Path(__file__).parents[4] / "shared" / "data" / "lcp_corpus"))


def _numbers(path: Path) -> list[float]:
    found: list[float] = []
    for line in path.read_text().splitlines():
        try:
            found += [float(word) for word in line.split()]
        except ValueError:
            break  # remarks follow
    return found


def read_corpus(path: Path) -> LinearComplementarity:
    """Read a problem of the corpus, dense (0) or by sparse blocks (1)."""
    data = _numbers(path)
    n, kind = int(data[0]), int(data[1])
    q = np.array(data[-n:])
    if kind == 0:
        return LinearComplementarity(np.array(data[6 : 6 + n * n]).reshape(n, n), np.array(data[6 + n * n :][:n]))
    at = 2

    def take(count: int) -> list[int]:
        nonlocal at
        part = [int(v) for v in data[at : at + count]]
        at += count
        return part

    blocks, _, _, across, down = take(5)[:5] if data[3] == n else (0, 0, 0, 0, 0)
    assert blocks, f"{path.name}: block header not understood"
    ends_r, ends_c = take(across), take(down)
    filled1, filled2 = take(2)
    starts, places = take(filled1), take(filled2)
    rows, cols = [0, *ends_r], [0, *ends_c]
    M = np.zeros((n, n))
    for row in range(across):
        for k in range(starts[row], starts[row + 1] if row + 1 < filled1 else starts[-1]):
            at += 1  # number of the block
            r, c = slice(rows[row], rows[row + 1]), slice(cols[places[k]], cols[places[k] + 1])
            shape = (r.stop - r.start, c.stop - c.start)
            M[r, c] = np.array(data[at : at + shape[0] * shape[1]]).reshape(shape, order="F")
            at += shape[0] * shape[1]
    return LinearComplementarity(M, q)


FILES = sorted(CORPUS.glob("*.dat")) if CORPUS.is_dir() else []


@pytest.mark.skipif(not FILES, reason="LCP corpus not found: set CONCIO_LCP_CORPUS to its directory")
@pytest.mark.parametrize("path", FILES, ids=[p.stem for p in FILES])
def test_corpus_is_solved_or_excluded_by_proof(path: Path) -> None:
    problem = read_corpus(path)
    if solution(problem) is not None:
        return
    v = infeasibility(problem)
    assert v is not None
    assert (v >= 0).all()
    assert (problem.M.T @ v).max() <= 1e-12
    assert problem.q @ v < -1e-9


def murty(n: int) -> LinearComplementarity:
    """Murty's matrix: 1 on the diagonal, 2 below; q = -e takes 2^n pivots with the cover e."""
    return LinearComplementarity(np.eye(n) + 2 * np.tril(np.ones((n, n)), -1), -np.ones(n))


@pytest.mark.parametrize("basis", ["inverse", "product"])
@pytest.mark.parametrize("n", [1, 3, 8])
def test_murty_problem_has_its_known_solution(n: int, basis: str) -> None:
    result = lemke(murty(n), basis=basis)  # type: ignore[arg-type]
    assert result.outcome is Outcome.SOLVED
    np.testing.assert_allclose(result.z, np.r_[1.0, np.zeros(n - 1)], atol=1e-12)


def test_refactorisation_does_not_change_the_path() -> None:
    runs = [lemke(murty(9), refresh=k) for k in (1, 7, 1000)]
    assert len({r.pivots for r in runs}) == 1
    assert runs[0].factorisations > runs[1].factorisations > runs[2].factorisations


def test_ray_is_returned_as_data() -> None:
    problem = LinearComplementarity(np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([1.0, -1.0]))  # -z1 - 1 >= 0: never
    result = lemke(problem)
    assert result.outcome is Outcome.RAY
    ray = result.ray
    assert ray is not None
    for s in (0.0, 1.0, 7.0):
        z, w, z0 = ray.z + s * ray.dz, ray.w + s * ray.dw, ray.z0 + s * ray.dz0
        np.testing.assert_allclose(w, problem.M @ z + problem.q + z0 * np.ones(2), atol=1e-12)
        assert min(z.min(), w.min(), z0) >= -1e-12
    assert infeasibility(problem) is not None


def test_ray_without_proof_is_not_taken_for_one() -> None:
    """Bimatrix game (Cottle, Pang, Stone, example 4.4.23): Lemke's cover e ends on a ray, and there is a solution."""
    A, B = np.array([[10.0, 30.0], [20.0, 15.0]]), np.array([[10.0, 20.0], [30.0, 15.0]])
    problem = LinearComplementarity(np.block([[np.zeros((2, 2)), A], [B, np.zeros((2, 2))]]), -np.ones(4))
    assert lemke(problem).outcome is Outcome.RAY
    found = solution(problem)
    assert found is not None
    assert problem.residual(found) < 1e-12


def test_no_solution_where_feasible_points_are_not_complementary() -> None:
    """w1 = 1 with M = [[0, 0], [1, 0]]; w2 = z1 - 1 >= 0 needs z1 >= 1, and w1 > 0 forbids it."""
    problem = LinearComplementarity(np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([1.0, -1.0]))
    assert infeasibility(problem) is None
    assert solution(problem) is None


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("basis", [ExplicitInverse, ProductForm])
@pytest.mark.parametrize(
    "matrix", [np.ones((3, 3)), sp.csr_array(np.ones((3, 3))), sp.csr_array(np.diag([1.0, 1.0, 0.0]))]
)
def test_a_singular_basis_is_told_by_an_error_alone(basis: type, matrix: np.ndarray | sp.csr_array) -> None:
    """Dense and sparse; nothing is printed beside what follows from it."""
    with pytest.raises(SingularMatrixError):
        basis(Columns(matrix, np.ones(3)), np.arange(3, 6))


def test_limit_and_cancel_end_the_run() -> None:
    L = np.random.default_rng(0).normal(size=(150, 150))
    problem = LinearComplementarity(L @ L.T + L - L.T, L[0])
    assert lemke(problem, limit=20).outcome is Outcome.LIMIT
    calls: list[int] = []
    result = lemke(problem, progress=lambda p: calls.append(p.iteration) is None)
    assert result.outcome is Outcome.CANCELLED
    assert calls == [64]


def test_scaling_is_by_powers_of_two_and_undone_exactly() -> None:
    rng = np.random.default_rng(3)
    M = rng.uniform(0.1, 1, (6, 6)) * 10.0 ** rng.integers(-6, 7, (6, 1)) * 10.0 ** rng.integers(-6, 7, (1, 6))
    r, c, scaled = equilibrate(M)
    np.testing.assert_array_equal(scaled / r[:, None] / c, M)
    assert np.abs(scaled).max() < 4.0
    assert np.abs(scaled).max(axis=0).min() > 0.1
    sparse = equilibrate(sp.csr_array(M))[2]
    np.testing.assert_array_equal(sparse.toarray(), scaled)


def test_bad_input_is_refused() -> None:
    with pytest.raises(InputError, match="M has shape"):
        LinearComplementarity(np.eye(2), np.zeros(3))
    with pytest.raises(InputError, match="not finite"):
        LinearComplementarity(np.array([[np.nan]]), np.zeros(1))
    with pytest.raises(InputError, match="positive"):
        lemke(murty(2), cover=np.zeros(2))
    with pytest.raises(InputError, match="unknown basis"):
        lemke(murty(2), basis="tableau")  # type: ignore[arg-type]


def test_generalised_problem_measures_a_candidate() -> None:
    problem = GeneralisedComplementarity(
        np.array([[1.0, 1.0], [-1.0, -2.0]]), np.array([[0.0, 0.0], [0.0, 1.0]]), np.array([3.0, -4.0])
    )  # t1 + t2 = 3, y2 = t1 + 2 t2 - 4
    assert problem.residual(np.array([2.0, 1.0]), np.zeros(2)) == 0.0
    assert problem.residual(np.array([2.0, 1.0]), np.array([0.0, 0.5])) == 0.5  # t2 y2 > 0
    assert problem.residual(np.array([3.0, 0.0]), np.array([0.0, 0.25])) == 1.25  # y2 should be -1
