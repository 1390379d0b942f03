"""Cylinder on a flat base (Hertz 1882): half-width, largest pressure, growth with the load."""

from __future__ import annotations

import numpy as np
import pytest
from validation_cases import hertz
from validation_cases.row import check

import concio


@pytest.mark.long  # the same cylinder, coarser, is below
def test_rows():
    check(hertz.rows())


@pytest.mark.long  # the row of the second method
def test_chords_converge():
    errors = [abs(hertz.half_width(hertz.pressed(n)) / hertz.half_width(hertz.pressed(16)) - 1) for n in (4, 8)]
    assert errors[1] < errors[0]


def test_second_method():
    result = hertz.pressed(4)
    other = concio.solve(result.model, method="lemke")
    gap = np.abs(other.displacement - result.displacement).max()
    assert gap <= 1e-8 * np.abs(result.displacement).max()
