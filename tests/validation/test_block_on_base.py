"""Block that slides or topples, built by the generator."""

from __future__ import annotations

from validation_cases import block_on_base
from validation_cases.row import check


def test_rows():
    check(block_on_base.rows())
