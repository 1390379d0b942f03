"""Rates along a path: what counts as none is a share of the largest rate of its kind, whatever their units."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import concio
from concio.problem.cone import Cone
from concio.solvers.lcp.linear_problem import LinearComplementarity
from concio.solvers.path.equations import PathEquations
from concio.solvers.path.path_state import CLOSED, CRUSHED, OPEN, STICK, LinearPath
from concio.solvers.path.rate_lcp import lemke
from concio.solvers.path.rates import Values, admissible, rates, values
from concio.solvers.path.scaling import ScaledPath
from lcp_oracles import infeasibility

N, M = 3, 2


def equations(lent: float = 0.0) -> SimpleNamespace:
    """Two pairs; the first unknowns are their openings, the third the slip of both."""
    cone = Cone(np.full(M, 0.5), np.array([2.0, 0.0]), np.array([1.0, 0.0]), np.array([10.0, np.inf]))
    return SimpleNamespace(
        data=SimpleNamespace(dilatancy=np.array([0.1, 0.0]), cone=cone), n=N, m=M, lent=np.full(M, lent),
        positions=lambda x, rate=False: (x[:M].copy(), np.full(M, x[2])),
    )  # fmt: skip


def direction(u: float = 1.0, t: float = 1.0) -> np.ndarray:
    """Openings 2 and -1, slip 3; normal forces 4 and -7, friction 1 and 5; and the rate of the load."""
    return np.concatenate([u * np.array([2.0, -1.0, 3.0]), t * np.array([4.0, -7.0, 1.0, 5.0]), [1.0]])


@pytest.mark.parametrize("u", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("t", [0.1, 1.0, 10.0])
def test_rates_of_pairs_and_what_counts_as_none(u: float, t: float) -> None:
    found, one = rates(equations(), direction(u, t)), rates(equations(), direction())
    assert found.opening == pytest.approx(u * np.array([2.0 - 0.3, -1.0]))
    assert found.slip == pytest.approx([3.0 * u] * 2)
    assert found.force == pytest.approx(t * np.array([4.0, -7.0]))
    assert found.plus == pytest.approx(t * np.array([0.5 * 4 + 1, -0.5 * 7 + 5]))
    assert found.minus == pytest.approx(t * np.array([0.5 * 4 - 1, -0.5 * 7 - 5]))
    assert found.still == pytest.approx(u * one.still, rel=1e-9, abs=0.0)
    assert found.calm == pytest.approx(t * one.calm, rel=1e-9, abs=0.0)
    assert one.still / one.calm == pytest.approx(3.0 / 7.0), "shares of the largest motion and of the largest force"


def test_creep_counts_where_nothing_moves_and_above_rounding() -> None:
    still = direction(u=0.0)
    creep = np.concatenate([[1e-3, -1e-30, 0.0], np.zeros(5)])
    found = rates(equations(), still, creep)
    assert found.creep_opening.tolist() == [1e-3, 0.0]
    assert rates(equations(), direction(), creep).creep_opening.tolist() == [0.0, 0.0]


def test_functionals_and_rows_of_pairs_are_those_of_the_original_equations() -> None:
    """In units of the problem, whatever moves; rows that replace others are those of the whole matrix."""
    law = concio.JointLaw(0.6, normal_stiffness=2e5, tangential_stiffness=7e4, dilatancy=0.2)
    model = concio.column(width=0.5, height=1.0, blocks=6, block="rigid", friction=law, horizontal=1.0)
    problem = concio.assemble(model).problem()
    m, rng = problem.pairs, np.random.default_rng(8)
    path = LinearPath(problem, rng.normal(size=len(problem.f)), rng.normal(size=m), rng.normal(size=(m, 1)))
    contact = np.array([OPEN, CLOSED, CRUSHED])[np.arange(m) % 3]
    sliding = np.array([-1, STICK, 1])[np.arange(m) // 3 % 3]
    scaled = ScaledPath.of(path)
    made = PathEquations(scaled, contact, sliding, np.eye(1, problem.unknowns + 2 * m + 1).ravel())
    u, t_n, t_t, tau = rng.normal(size=problem.unknowns), rng.normal(size=m), rng.normal(size=m), 1.7
    x = np.concatenate([u / scaled.length, t_n / scaled.force, t_t / scaled.force, [tau]])
    opening = problem.C_n @ u + problem.laws.normal_compliance * t_n + tau * path.gap_rate
    slip = problem.C_t @ u + problem.laws.tangential_compliance * t_t + tau * path.tangent_rate[:, 0]
    for k in range(m):
        assert made.opening_of(k) @ x == pytest.approx(opening[k] / scaled.length, rel=1e-9)
        assert made.slip_of(k) @ x == pytest.approx(slip[k] / scaled.length, rel=1e-9)
    assert made.positions(x, rate=True)[0] == pytest.approx(opening / scaled.length, rel=1e-9)
    assert made.positions(x, rate=True)[1] == pytest.approx(slip / scaled.length, rel=1e-9)
    whole = made.assemble().toarray()
    for k in range(m):
        for at, (columns, entries) in ((0, made.normal_row(k)), (m, made.tangential_row(k))):
            row = np.zeros(made.size)
            np.add.at(row, columns, entries)
            assert row == pytest.approx(whole[problem.unknowns + at + k], rel=1e-12, abs=0.0)
    given = made.right_hand_side(np.zeros(m), np.zeros(m), 2.5)
    assert given[-1] == 2.5
    assert given[: problem.unknowns] == pytest.approx(problem.f / scaled.force, rel=1e-14)
    assert [made._lent(row) for row in range(made.size)] == made._lent_to_all().tolist()
    assert (problem.laws.dilatancy > 0).all()
    assert len({*zip(contact.tolist(), sliding.tolist(), strict=True)}) == 9


def test_distances_from_the_bounds() -> None:
    x = np.concatenate([[0.3, 0.0, 0.2], [4.0, 6.0, 1.0, -2.0], [1.0]])
    found = values(equations(), x, np.array([0.1, 0.2]), np.array([0.01, 0.02]))
    assert found.gap == pytest.approx([0.3 + 0.01 - 0.1 * 0.1, 0.02])
    assert found.force == pytest.approx([5.0, 6.0])
    assert found.room.tolist() == [6.0, np.inf]
    assert found.plus == pytest.approx([2.0 + 2.0 + 1.0, 3.0 - 2.0])
    assert found.minus == pytest.approx([2.0 + 2.0 - 1.0, 3.0 + 2.0])
    assert found.gap_zero / found.force_zero == pytest.approx(0.3 / 6.0)


def test_states_wished_for_are_taken_where_the_point_allows_them() -> None:
    """Open where no force is left, crushed at the cap, closed where no gap is; a slip at the strength it goes against.

    Pairs without a force are beyond both, pairs far from their bounds keep what they have; open ones have no sense.
    """
    m = 8
    far, none = np.full(m, 5.0), np.zeros(m)
    at = {"gap": far.copy(), "force": far.copy(), "room": far.copy(), "plus": far.copy(), "minus": far.copy()}
    at["force"][0] = at["room"][1] = at["gap"][2] = at["plus"][3] = at["minus"][4] = at["plus"][5] = 1e-12
    made = SimpleNamespace(
        data=SimpleNamespace(cone=Cone(np.full(m, 0.5), none, none, np.full(m, 10.0))),
        contact=np.array([CLOSED, CLOSED, OPEN, CLOSED, CLOSED, CLOSED, CLOSED, OPEN], dtype=np.int8),
        sliding=np.array([STICK, STICK, 1, STICK, STICK, STICK, 1, 1], dtype=np.int8),
    )
    point = Values(**at, gap_zero=1e-9, force_zero=1e-9)
    wished = np.array([OPEN, CRUSHED, CLOSED, CLOSED, CLOSED, CLOSED, OPEN, CLOSED])
    contact, sliding = admissible(made, point, wished, np.array([1, 1, STICK, 1, -1, -1, -1, STICK]))
    assert contact.tolist() == [OPEN, CRUSHED, CLOSED, CLOSED, CLOSED, CLOSED, CLOSED, OPEN]
    assert sliding[2:].tolist() == [STICK, 1, -1, STICK, 1, 1]
    assert sliding[0] == 1


def test_directions_of_a_vertex_solve_their_complementarity_problem():
    """Or nothing does, which a vector proves; what only rounding resists has no finite rate."""
    rng = np.random.default_rng(5)
    for _ in range(40):
        n = int(rng.integers(1, 6))
        root = rng.standard_normal((n, int(rng.integers(1, n + 1))))
        skew = rng.standard_normal((n, n))
        problem = LinearComplementarity(root @ root.T + 0.3 * (skew - skew.T), rng.standard_normal(n))
        z = lemke(problem.M, problem.q)
        if z is None:
            assert infeasibility(problem) is not None
        else:
            assert problem.residual(z) < 1e-9 * max(1.0, np.abs(z).max())
    assert lemke(np.array([[1e-12]]), np.array([-1.0])) is None
    assert lemke(np.array([[1e-3]]), np.array([-1.0])) == pytest.approx([1e3])


def test_a_vertex_whose_states_form_a_mechanism_is_left_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What each critical pair answers is asked for only where the rate itself has an answer; the path goes on."""
    model = concio.column(width=0.5, height=1.0, blocks=2, block="rigid", friction=0.6, horizontal=1.0)
    refined, asked = PathEquations.refined, list[tuple[int, float]]()

    def told(self: PathEquations, b: np.ndarray, rounds: int = 8) -> tuple[np.ndarray, float]:
        x, residual = refined(self, b, rounds)
        if b.ndim == 2:
            residual = residual if solvable else 1.0
            asked.append((b.shape[1], residual))
        return x, residual

    monkeypatch.setattr(PathEquations, "refined", told)
    peaks = []
    for solvable in (True, False):
        asked.clear()
        peaks.append(concio.limit(model, path=True, search=False).path.peak)
        assert asked[0][0] == 1
        assert any(columns > 1 for columns, _ in asked) == solvable
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-9)
