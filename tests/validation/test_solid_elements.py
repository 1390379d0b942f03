"""Patch tests and bending of elastic blocks in space."""

from __future__ import annotations

import pytest
from validation_cases import solid_elements
from validation_cases.row import check


@pytest.mark.long
def test_rows() -> None:
    check(solid_elements.rows())
