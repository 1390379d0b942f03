"""Linear equations of a state: what has an answer, what of it is determined, and which states may lend theirs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import concio
from concio.analysis.linearised_state import LinearisedState, _Equations
from concio.errors import InputError


def shared(seed: int, units: np.ndarray) -> np.ndarray:
    """Return equations of three displacements and four forces of which two act as one on everything."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(7, 7)) + 4.0 * np.eye(7)
    A[:, 6] = A[:, 5]  # forces 5 and 6 are one for every equation
    A[6] = A[5]  # so one equation has to repeat another
    return A / units


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("unit", [1.0, 1e6])
def test_equations_that_agree_are_answered_and_what_two_forces_share_is_open(seed: int, unit: float) -> None:
    """Against least squares, of displacements in m and forces in units of any size."""
    columns = np.array([*3 * [1e-3], *4 * [unit]])
    A = shared(seed, columns)
    rng = np.random.default_rng(100 + seed)
    x = rng.normal(size=7) * columns
    wanted = A @ x
    found = _Equations(sp.csr_array(A), columns, 3).answer(wanted)
    assert np.isnan(found).tolist() == [False] * 5 + [True] * 2
    assert found[:5] == pytest.approx(x[:5], rel=1e-7)
    against = wanted.copy()
    against[6] += 1e-3 * np.abs(wanted).max()  # the repeated equation wants something else
    with pytest.raises(InputError, match="do not determine"):
        _Equations(sp.csr_array(A), columns, 3).answer(against)


@pytest.mark.parametrize("seed", range(3))
def test_equations_that_determine_all_have_the_answer_of_a_dense_solve(seed: int) -> None:
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(9, 9)) * 10.0 ** rng.uniform(-4, 4, 9)[:, None]
    columns = np.array([*4 * [1e-4], *5 * [30.0]])
    A = A / columns
    wanted = A @ (columns * rng.normal(size=9))
    found = _Equations(sp.csr_array(A), columns, 4).answer(wanted)
    assert found / columns == pytest.approx(np.linalg.solve(A, wanted) / columns, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("size", [2.0**-40, 2.0**40])
def test_answers_are_in_proportion_and_contradictions_are_seen_at_any_size(size: float) -> None:
    """A factor of two changes no digit; one of many equations that contradicts is enough, however small all are."""
    columns = np.array([*3 * [1e-3], *4 * [20.0]])
    A = shared(1, columns)
    A[0, 3:], A[3, :3] = 0.0, 0.0  # as in a model: not every unknown stands in every equation
    equations = _Equations(sp.csr_array(A), columns, 3)
    wanted = A @ (columns * np.arange(1.0, 8.0))
    np.testing.assert_array_equal(equations.answer(size * wanted), size * equations.answer(wanted))
    np.testing.assert_array_equal(equations.answer(0.0 * wanted)[:5], np.zeros(5))
    wanted[6] += 1e-5 * np.abs(wanted).max()
    with pytest.raises(InputError, match="do not determine"):
        equations.answer(size * wanted)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_a_structure_that_can_move_has_no_derivative(turn: float) -> None:
    """One body is held by a spring in one direction only, which need not be that of an unknown; another is held."""
    c, s = np.cos(turn), np.sin(turn)
    R = np.array([[c, -s], [s, c]])
    A = np.zeros((4, 4))
    A[:2, :2] = R @ np.diag([1.0, 0.0]) @ R.T
    A[2:, 2:] = [[2.0, 1.0], [1.0, -3.0]]
    with pytest.raises(InputError, match="can move"):
        _Equations(sp.csr_array(A), np.ones(4), 3).answer(np.ones(4))
    A[:2, :2] += 0.5 * np.eye(2)
    found = _Equations(sp.csr_array(A), np.ones(4), 3).answer(np.ones(4))
    assert pytest.approx(np.linalg.solve(A, np.ones(4))) == found


def pillar(blocks: int, push: float = 0.0) -> concio.Model:
    return concio.column(width=0.5, height=2.0, blocks=blocks, unit_weight=20.0, horizontal=push)


def test_states_are_lent_by_a_certified_answer_with_the_same_joints_alone() -> None:
    """A model that falls has no states; one with other joints has others."""
    result = concio.solve(pillar(2, 0.02))
    here = replace(LinearisedState.of(result), about=np.ones(result.assembly.problem().pairs, dtype=bool))
    beside = concio.solve(pillar(2, 0.03))
    again = here.with_states_of(beside)
    of = LinearisedState.of(beside)
    for name in ("closed", "crushed", "sticks"):
        np.testing.assert_array_equal(getattr(again, name), getattr(of, name))
    falls = pillar(2, 0.02)
    falls = replace(falls, loads=(*falls.loads, concio.Load("weight", (2.0, 0.0))))
    for other in (concio.solve(falls, on_failure="return"), concio.solve(pillar(3))):
        with pytest.raises(InputError, match="no certified state with the same joints"):
            here.with_states_of(other)
