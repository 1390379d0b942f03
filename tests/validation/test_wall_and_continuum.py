"""Walls of blocks beside their continuum: exact cases, halved blocks, the paper's panel."""

from __future__ import annotations

import numpy as np
import pytest
from validation_cases import wall_and_continuum
from validation_cases.row import check


@pytest.mark.long
def test_rows():
    check(wall_and_continuum.rows())


@pytest.mark.long  # test_prandtls_strip_footing_is_enclosed of tests/unit sees the same
def test_bounds_are_on_their_sides():
    low, high = wall_and_continuum.strip()
    assert low < (2 + np.pi) / np.cos(np.pi / 24)
    assert high > 2 + np.pi


@pytest.mark.long
def test_an_arch_has_a_size_and_a_thrust_that_moduli_do_not_have():
    found = wall_and_continuum.panel()
    blocks, bonded, _ = found.elastic.settlements
    assert blocks > 8 * bonded
    assert found.elastic.blocks.reactions["left wall"][0] > 20 * found.elastic.continuum.reactions["left wall"][0]
    assert np.isinf(found.strength.blocks.associated.multiplier)
    assert wall_and_continuum.panel(2).elastic.settlements[0] > 2 * blocks


@pytest.mark.long  # bounds on their sides are seen by the test below
def test_limit_loads_come_down_to_the_continuum():
    load = wall_and_continuum.pushed().associated
    assert (np.diff(load) < 0).all()
    assert load[-1] > wall_and_continuum.pushed().bracket[1]
