"""The balance of energies: which are stored, lost and put in, and over what an error is told."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.motion.energy import NAMES, EnergyBalance
from concio.analysis.motion.step_pairs import PairMaker, relative
from motion_models import G, standing


def balance(rounding: float = 0.0, unit: float = 1.0, **changed: list[float]) -> EnergyBalance:
    values = {name: unit * np.array(changed.get(name, [0.0, 0.0, 0.0])) for name in NAMES}
    return EnergyBalance(values, rounding)


@pytest.mark.parametrize("name", NAMES)
def test_what_is_stored_or_lost_counts_as_much_as_what_is_put_in(name: str) -> None:
    sign = -1.0 if name in ("input", "overlap", "drift") else 1.0
    found = balance(**{name: [1.0, 4.0, 2.0]})
    assert found.total.tolist() == [sign * 1.0, sign * 4.0, sign * 2.0]
    assert found.error == pytest.approx(3.0 / (4.0 if name == "kinetic" else 3.0))


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_an_error_is_a_share_of_what_was_turned_over(unit: float) -> None:
    """A block falls and gives up 5 of 8 to friction; 0.02 of it are missing in the middle."""
    found = balance(
        unit=unit, kinetic=[0.0, 5.0, 3.0], potential=[8.0, 2.98, 0.0], friction=[0.0, 0.0, 5.0]
    )
    assert found.turned_over == pytest.approx(8.0 * unit)
    assert found.error == pytest.approx(0.02 / 8.0)
    assert found["friction"][-1] == 5.0 * unit


def test_free_flight_turns_over_its_kinetic_energy() -> None:
    found = balance(kinetic=[7.0, 7.0, 7.0])
    assert (found.turned_over, found.error) == (7.0, 0.0)


def test_below_rounding_nothing_moves() -> None:
    for size, still in ((1e-12, True), (3e-12, True), (4e-12, False)):
        found = balance(rounding=3e-12, potential=[0.0, size, 0.0])
        assert found.still == still
        assert found.scale == max(size, 3e-12)
        assert found.error == pytest.approx(size / max(size, 3e-12))
    assert balance().error == 0.0
    assert EnergyBalance({name: np.zeros(0) for name in NAMES}).error == 0.0


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_slip_is_remembered_step_by_step_in_the_sense_in_which_pairs_move(speed: float) -> None:
    """A block slides on: what its pairs remember is the way it went, seen as they see its velocity."""
    found = concio.dynamics(
        standing(height=0.4, friction=0.2), duration=8e-3, step=1e-3, gravity=G, velocities={"block": (speed, 0.0)}
    )
    end, maker = found.end, PairMaker(found.reference, found.scheme)
    _, rows, _ = maker.contacts(end.memory, end.placement, end.velocity, end.spin, end.strain)
    went = end.centre[1] - found.reference.disc.centroids[1]
    assert abs(went[0]) > 7e-3
    seen = relative(rows.columns, rows.values, np.array([went[0], went[1], 0.0]))
    assert end.memory.slid[:, 0] == pytest.approx(seen[:, 1], rel=1e-3)
    assert abs(seen[:, 1]) == pytest.approx(np.full(2, abs(went[0])), rel=1e-9)
