"""Bridges that were loaded to failure: what is computed of them, compared and not asserted."""

from __future__ import annotations

import pytest
from validation_cases import loaded_bridges

from samples import first


@pytest.mark.parametrize("name", first(1, ["Torksey", "Strathmashie"]))
def test_what_a_bridge_owes_to_the_soil_grows_with_its_pressure(name: str) -> None:
    loads = [loaded_bridges.bound(name, k, None) for k in (0.0, 1.0, 3.0)]
    assert loads == sorted(loads)
    assert loaded_bridges.bound(name, 1.0, 5000.0) < loads[1]


@pytest.mark.long
def test_every_bridge_has_a_bound_that_is_proved_and_is_compared() -> None:
    rows = loaded_bridges.rows()
    assert len(rows) == 4 * len(loaded_bridges.BRIDGES) + 4
    assert not any(r.asserted for r in rows)
    assert all(r.computed > 0 for r in rows)
