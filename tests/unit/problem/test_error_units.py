"""The units of errors, from their definition, for parts of different loads, motions and compliances."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp

from concio.problem import error_units
from concio.problem.error_units import BEYOND, Measure, in_units, measure, rounding
from concio.problem.parts import Parts
from concio.problem.tolerances import BALANCE_ROUNDING, GRANTED

PARTS = Parts(3, np.array([0, 0, 1]), np.array([0, 0, 1, 2]))
"""Two bodies, of two unknowns and of one; two pairs of the first, one of the second, one of none."""
U = np.array([2e-3, -5e-3, 1e-4])
T_N, T_T = np.array([3.0, 0.0, -8.0, 6.0]), np.array([[-4.0, 0.0], [0.3, 0.4], [0.0, 0.0], [0.0, 7.0]])
SOFT_N, SOFT_T = np.array([0.0, 1e-4, 2e-3, 0.0]), np.array([1e-5, 0.0, 0.0, 2e-4])


def problem(f: list[float], load: object = 0.0) -> SimpleNamespace:
    laws = SimpleNamespace(normal_compliance=SOFT_N, tangential_compliance=SOFT_T, dilatancy=np.array([0.1, 0, 0, 0.2]))
    return SimpleNamespace(f=np.array(f), load=load, laws=laws, dim=3, pairs=4)


@pytest.fixture(autouse=True)
def _parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(error_units, "connected_parts", lambda problem: PARTS)


def test_forces_are_measured_by_the_loads_of_their_part_or_by_what_its_pairs_carry() -> None:
    assert measure(problem([3.0, -4.0, 11.0]), U, T_N, T_T).force.tolist() == [7.0, 11.0, 7.0]
    assert measure(problem([0.0, 0.0, 0.0]), U, T_N, T_T).force.tolist() == [4.0, 8.0, 7.0]
    assert measure(problem([0.0] * 3), U, 0.0 * T_N, 0.0 * T_T).force.tolist() == [1.0, 1.0, 1.0]
    assert measure(problem([3.0, -4.0, 11.0]), U, T_N, T_T, total_load=5.0).force.tolist() == [5.0] * 3
    assert measure(problem([3.0, -4.0, 11.0], 13.0), U, T_N, T_T).force.tolist() == [13.0] * 3
    own = measure(problem([3.0, -4.0, 11.0], np.array([1.0, -1.5, 0.0])), U, T_N, T_T)
    assert own.force.tolist() == [2.5, 11.0, 7.0]


def test_lengths_are_measured_by_what_moves_or_gives_way_in_their_part() -> None:
    found = measure(problem([3.0, -4.0, 11.0]), U, T_N, T_T)
    assert found.length == pytest.approx([5e-3, 2e-3 * 8.0, 2e-4 * 7.0])
    still = measure(problem([3.0, -4.0, 11.0]), 0.0 * U, T_N, T_T)
    assert still.length == pytest.approx([1e-5 * 4.0, 1.6e-2, 1.4e-3])
    moved = measure(problem([3.0, -4.0, 11.0]), U, T_N, T_T, moved=np.array([0.0, 0.03, 0.0, 1e-6]))
    assert moved.length == pytest.approx([0.03, 1.6e-2, 1.4e-3])


def test_a_pair_that_gives_way_is_measured_by_what_all_of_the_load_would_close() -> None:
    found = Measure(PARTS, np.array([7.0, 11.0, 0.5]), np.array([5e-3, 1.6e-2, 0.0]))
    assert found.node_force.tolist() == [7.0, 7.0, 11.0]
    assert found.pair_force.tolist() == [7.0, 7.0, 11.0, 0.5]
    assert found.pair_length.tolist() == [5e-3, 5e-3, 1.6e-2, 0.0]
    soft = np.array([0.0, 1e-4, 1e-3, 1e-3])
    assert found.length_of(soft) == pytest.approx([5e-3, 7e-4, 1.1e-2, 0.0])
    assert found.length_of(1e3 * soft) == pytest.approx([5e-3, 5e-3, 1.6e-2, 0.0])


def test_what_is_not_zero_counts_much_where_the_unit_is() -> None:
    found = in_units(np.array([0.0, 3.0, -4.0, 0.0, 1e-200, -1.0]), np.array([2.0, 2.0, 0.5, 0.0, 0.0, 0.0]))
    assert found.tolist() == [0.0, 1.5, -8.0, 0.0, BEYOND, -BEYOND]


def test_rounding_is_a_share_of_the_sizes_summed_and_of_the_units() -> None:
    """y_n = x + C_n u + a t, y_t = C_t u - slip + a t; entries of both signs, of which the sizes count."""
    p = problem([3.0, -4.0, 11.0])
    p.gap = np.array([-1e-3, 0.0, 2e-3, 0.0])
    p.slip_origin = np.array([[1e-3, 0.0], [0.0, 0.0], [0.0, -2e-3], [0.0, 0.0]])
    p.C_n = sp.csr_array(np.array([[1.0, -2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -3.0], [0.0, 0.0, 0.0]]))
    C_t = np.zeros((8, 3))
    C_t[0, 0], C_t[1, 1], C_t[4, 2] = 1.0, -1.0, 2.0
    p.C_t = sp.csr_array(C_t)
    large = Measure(PARTS, np.full(3, 1e30), np.full(3, 1e30))
    normal, along = rounding(p, U, T_N, T_T, large)
    slip = np.array([[2e-3 + 1e-3 + 4e-5, 5e-3], [0.0, 0.0], [2e-4, 2e-3], [0.0, 1.4e-3]])
    assert along / BALANCE_ROUNDING == pytest.approx(np.linalg.norm(slip, axis=1))
    wanted = np.array([1e-3 + 2e-3 + 1e-2, 5e-3, 2e-3 + 3e-4 + 1.6e-2, 0.0])
    wanted += np.array([0.1, 0.0, 0.0, 0.2]) * np.linalg.norm(slip, axis=1)
    assert normal / BALANCE_ROUNDING == pytest.approx(wanted)
    tiny = Measure(PARTS, np.full(3, 1e-30), np.array([1e-25, 2e-25, 3e-25]))
    normal, along = rounding(p, U, T_N, T_T, tiny)
    assert normal[[0, 2]] / GRANTED == pytest.approx([1e-25, 2e-33], rel=1e-12, abs=0.0)
    assert along[[0, 3]] / GRANTED == pytest.approx([1e-35, 2e-34], rel=1e-12, abs=0.0)
