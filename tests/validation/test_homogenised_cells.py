"""Homogenised cells: closed forms, larger cells, and an independent periodic computation."""

from __future__ import annotations

from validation_cases import homogenised_cells
from validation_cases.row import check


def test_rows():
    check(homogenised_cells.rows())
