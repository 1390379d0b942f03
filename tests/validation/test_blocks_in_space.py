"""Rigid blocks in space against closed forms, and walls extruded against the plane."""

from __future__ import annotations

from validation_cases import blocks_in_space
from validation_cases.row import check


def test_rows() -> None:
    check(blocks_in_space.rows())
