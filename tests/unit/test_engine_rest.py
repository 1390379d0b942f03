"""A structure on which nothing acts rests, exactly; one that is pushed does not."""

import numpy as np
import pytest

import concio


@pytest.mark.parametrize("method", ["auto", "interior-point"])
def test_nothing_acts(method):
    model = concio.running_bond_panel(courses=2, blocks=2)
    result = concio.solve(model, method)
    assert result.solved
    assert not result.displacement.any()
    assert not result.contacts.normal_force.any()


def test_a_tie_with_prestress_acts():
    tie = concio.Tie("rod", "", (-1.0, 0.05), "c1-b1", (0.0, 0.05), stiffness=100.0, prestress=1.0)
    from dataclasses import replace

    model = concio.running_bond_panel(courses=1, blocks=1, unit_weight=100.0, side_walls=False)
    result = concio.solve(replace(model, ties=(tie,)), on_failure="return")
    assert not result.solved or np.abs(result.displacement).max() > 0
