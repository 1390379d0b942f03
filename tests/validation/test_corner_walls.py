"""Limit loads of walls with corners, against an independent program."""

from __future__ import annotations

from validation_cases import corner_walls
from validation_cases.row import check


def test_rows() -> None:
    check(corner_walls.rows())
