"""Cantilever walls: Timoshenko's beam, overturning and sliding of dry stacks, first crack."""

from __future__ import annotations

from validation_cases import cantilever_wall
from validation_cases.row import check


def test_rows():
    check(cantilever_wall.rows())
