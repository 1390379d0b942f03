"""Dry granite walls of Vasconcelos (2005) and Vasconcelos and Lourenço (2009): statics asserted, tests compared."""

from __future__ import annotations

import pytest
from validation_cases import granite_walls
from validation_cases.row import check


def test_rows():
    check(granite_walls.rows())


@pytest.mark.parametrize("n", granite_walls.PEAKS)
def test_no_measured_peak_lies_above_the_upper_bound(n):
    """The bound knows no crushing and no imperfection: a test above it would refute the model."""
    assert granite_walls.PEAKS[n] < granite_walls.bound(n)
