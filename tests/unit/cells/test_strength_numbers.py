"""Stresses, rates and the least Coulomb multiplier of directions of strength, from answers that are known."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from concio.analysis.cells.strength import StrengthDomain, StrengthRay


def ray(multiplier: float, worst: float = 0.0, velocity: tuple[float, ...] | None = None, **more: Any) -> StrengthRay:
    mechanism = None if velocity is None else SimpleNamespace(velocity=np.array(velocity))
    associated = SimpleNamespace(
        multiplier=multiplier, upper=multiplier * 1.5, worst=worst, checked=worst < 1e-6, mechanism=mechanism
    )
    return StrengthRay(np.array([0.0, -2.0, 0.5]), np.array([1.0, -3.0, 0.0]), associated, **more)


def test_stress_is_the_base_and_a_multiple_of_the_direction() -> None:
    assert ray(4.0).stress == pytest.approx([1.0, -11.0, 2.0])
    assert ray(math.inf).stress.tolist() == [1.0, -math.inf, math.inf]


def test_the_coulomb_multiplier_is_the_least_that_is_known() -> None:
    state = SimpleNamespace(multiplier=3.0)
    assert math.isnan(ray(4.0).coulomb)
    assert ray(4.0, carried=2.5).coulomb == 2.5
    assert ray(4.0, collapse_state=state).coulomb == 3.0
    assert ray(4.0, carried=3.5, collapse_state=state).coulomb == 3.0
    assert ray(4.0, carried=2.0, collapse_state=state).coulomb == 2.0


def test_rates_have_a_largest_entry_of_one_and_the_worst_direction_is_told() -> None:
    rays = (ray(4.0, 1e-12, (9.0, 9.0, 0.2, -0.5, 0.0)), ray(2.0, 3e-9), ray(1.0, 2e-10, (7.0, 0.0, 0.0, 0.0)))
    found = StrengthDomain(SimpleNamespace(), np.zeros(3), rays, None)
    assert found.strain_rate(rays[0]) == pytest.approx([0.4, -1.0, 0.0])
    assert found.strain_rate(rays[1]) is None
    assert found.strain_rate(rays[2]) == pytest.approx([0.0, 0.0, 0.0])
    assert found.worst == 3e-9
    assert found.checked
    assert not StrengthDomain(SimpleNamespace(), np.zeros(3), (*rays, ray(1.0, 1e-3)), None).checked
    table = found.table()
    assert table["associated"].tolist() == [4.0, 2.0, 1.0]
    assert table["associated_upper"].tolist() == [6.0, 3.0, 1.5]
    assert table["direction_yy"].tolist() == [-2.0] * 3
    assert table["stress_yy"] == pytest.approx([-11.0, -7.0, -5.0])
    assert np.isnan(table["strain_rate_xx"]).tolist() == [False, True, False]
    assert table["worst_residual"].tolist() == [1e-12, 3e-9, 2e-10]
