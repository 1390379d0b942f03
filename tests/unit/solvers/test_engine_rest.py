"""A structure on which nothing acts rests, exactly; one that is pushed does not."""

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
    assert result.sentence.startswith("In equilibrium")
    assert result.ties.tension == pytest.approx(0.2), "it slides until friction 1.0 of its weight of 0.2 kN holds"
    assert result.ties.elongation == pytest.approx((0.2 - 1.0) / 100.0)


def test_the_papers_sufficient_condition_is_reported():
    full = concio.solve(concio.running_bond_panel(courses=2, blocks=2, top_pressure=10.0))
    assert full.existence.holds
    assert full.summary()["sufficient_condition"]["margin"] == pytest.approx(full.existence.margin)
    hung = concio.solve(concio.running_bond_panel(courses=3, blocks=6, friction=0.6, base="none", top_pressure=10.0))
    assert hung.solved
    assert not hung.existence.holds  # walls on the sides alone carry nothing without friction
