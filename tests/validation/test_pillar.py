"""Pillar without tensile strength under an eccentric load: closed forms, uncracked and cracked."""

from __future__ import annotations

from dataclasses import replace

import pytest
from validation_cases import pillar
from validation_cases.row import check

import concio


@pytest.mark.long
def test_rows():
    check(pillar.rows())


def test_outside_the_section_it_overturns():
    """No equilibrium once the force leaves the section."""
    model = pillar.elastic(0.2, 5).model
    load = replace(model.loads[0], at=(0.301, 1.1))
    with pytest.raises(concio.NoEquilibriumError):
        concio.solve(replace(model, loads=(load,)))
