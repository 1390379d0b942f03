"""Least thickness of a semicircular arch (Milankovitch 1907; Heyman 1969), built by the generator."""

from __future__ import annotations

import pytest
from validation_cases import semicircular_arch
from validation_cases.row import check

from samples import sample


@pytest.mark.long
def test_rows():
    check(semicircular_arch.rows())


def test_more_voussoirs_more_thickness():
    values = [semicircular_arch.least(n) for n in (8, 12, sample(30, 100))]
    assert values[0] < values[1] < values[2] < 0.1075
