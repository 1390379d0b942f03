"""Numbers of an assessment on which alpha_0 depends in another way to either side, where joints slide."""

from __future__ import annotations

import numpy as np

import concio

SITE = concio.Site(hazard={"SLV": {"a_g": 0.1, "F0": 2.5, "Tc": 0.3}})


def test_numbers_without_a_derivative_are_told():
    """A block that slides and tips at one alpha_0 depends on friction and on its shape: none of that was told."""
    block = concio.column(width=0.5, height=1.0, blocks=1, block="rigid", friction=0.5)
    found = concio.assess(block, site=SITE, direction="right").sensitivity()
    assert found is not None
    names = {row.name for row in found.rows} | {row.name for row in found.without}
    assert {"length of x", "length of y"} <= names
    for row in (*found.rows, *found.without):
        slides = row.kind == "friction" or row.name.startswith("length")
        known = np.isfinite([row.below, row.above]).all()
        assert known is not slides or row.one_sided, row.name
        assert slides or row.below == row.above == 0.0 or abs(row.below) < 1e-9
    assert "friction" in found.sentence
