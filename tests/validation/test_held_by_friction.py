"""Ladders, wedges and blocks hung between plates against closed forms."""

from __future__ import annotations

import pytest
from validation_cases import held_by_friction
from validation_cases.row import check


@pytest.mark.long  # test_departure and test_engine jam blocks between walls
def test_rows() -> None:
    check(held_by_friction.rows())
