"""Rigid flat punch on a half-plane (Sadowsky 1928): integrated quantities and their order."""

from __future__ import annotations

from validation_cases import flat_punch
from validation_cases.row import check


def test_rows():
    check(flat_punch.rows())
