"""Patch tests and bending of elastic blocks in space."""

from __future__ import annotations

from validation_cases import solid_elements
from validation_cases.row import check


def test_rows() -> None:
    check(solid_elements.rows())
