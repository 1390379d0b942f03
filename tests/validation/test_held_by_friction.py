"""Ladders, wedges and blocks hung between plates against closed forms."""

from __future__ import annotations

from validation_cases import held_by_friction
from validation_cases.row import check


def test_rows() -> None:
    check(held_by_friction.rows())
