"""Limit loads of walls with corners, against an independent program."""

from __future__ import annotations

import pytest
from validation_cases import corner_walls
from validation_cases.row import check


@pytest.mark.long  # test_space_generators and test_collapse_in_space have corners
def test_rows() -> None:
    check(corner_walls.rows())
