"""Flat arch with spreading abutments: thrust of three hinges, by hand."""

from __future__ import annotations

import pytest
from validation_cases import flat_arch
from validation_cases.row import check


def test_rows():
    check(flat_arch.rows())


def test_thrust_does_not_depend_on_the_amount_of_spreading():
    small, large = (flat_arch.spread(d).reactions["left abutment"][0] for d in (1e-5, 1e-2))
    assert small == pytest.approx(large, rel=1e-9)
