"""Block on an incline: slides at tan = mu or topples at tan = b / h, whichever comes first (statics, by hand)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.limit import coulomb_path, dead_and_live
from concio.solvers.statics.associated_limit import associated_limit
from concio.solvers.statics.existence import find_mechanism, statically_admissible
from path_helpers import energy_error, weight_then, worst_certificate
from rigid_walls import block_on_incline
from samples import first


@settings(max_examples=40, deadline=None)
@given(st.floats(0.05, 2.0), st.floats(0.1, 3.0), st.floats(0.1, 5.0))
def test_share_of_own_weight(mu, width, height):
    """Horizontal share of the weight on a flat base: the tangent of the tilt."""
    a = block_on_incline(width, height, 0.0)
    found = associated_limit(a.problem(mu, a.load(0, -1)), a.load(1, 0))
    assert found.multiplier == pytest.approx(min(mu, width / height), abs=1e-9)
    assert found.checked


@pytest.mark.parametrize(
    ("mu", "width", "height"), [(0.3, 1.0, 1.0), (0.9, 0.4, 1.0), (0.7, 0.2, 1.0), (0.5, 3.0, 0.5)]
)
def test_tilted_plane(mu, width, height):
    limit = min(mu, width / height)
    for factor, holds in ((1 - 1e-8, True), (1 + 1e-8, False)):
        a = block_on_incline(width, height, np.arctan(limit * factor))
        p = a.problem(mu, a.load(0, -1))
        assert statically_admissible(p).residual <= (1e-12 if holds else 1e-7)
        assert (find_mechanism(p) is None) is holds or not holds
    a = block_on_incline(width, height, np.arctan(limit * (1 + 1e-6)))
    assert find_mechanism(a.problem(mu, a.load(0, -1))) is not None


CASES = [(0.3, 1.0, 1.0), (0.9, 0.4, 1.0), (0.7, 0.2, 1.0), (0.5, 3.0, 0.5)]


@pytest.mark.parametrize(("mu", "width", "height"), CASES)
def test_load_path_of_a_rigid_block(mu, width, height):
    """The path under a growing share of the weight ends where statics say."""
    a = block_on_incline(width, height, 0.0)
    path, found = weight_then(a, mu, a.load(1, 0), until=10.0)
    assert found.peak == pytest.approx(min(mu, width / height), abs=1e-9)
    assert worst_certificate(path, found) <= 1e-9
    assert energy_error(path, found) <= 1e-9


@pytest.mark.parametrize(("mu", "width", "height"), first(2, CASES))
def test_load_path_of_an_elastic_block(mu, width, height):
    """An elastic block is not a weaker: it slides or turns about its last corner."""
    column = concio.column(
        width=width, height=height, blocks=1, friction=mu, unit_weight=20, mesh_size=min(width, height) / 2
    )
    model = replace(column, loads=(*column.loads, concio.Load("body", (20.0, 0.0), group="live")))
    found, shown = coulomb_path(*dead_and_live(concio.assemble(model), "live"))
    assert shown
    assert found.peak == pytest.approx(min(mu, width / height), abs=1e-9)
