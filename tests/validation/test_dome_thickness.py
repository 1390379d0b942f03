"""Least thickness of hemispherical domes, against an independent program and the literature."""

from __future__ import annotations

import pytest
from validation_cases import dome_thickness
from validation_cases.row import check


@pytest.mark.long
def test_rows() -> None:
    check(dome_thickness.rows())
