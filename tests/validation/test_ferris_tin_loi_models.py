"""Walls of Ferris and Tin-Loi (2001) built as models of rigid and of elastic blocks."""

from __future__ import annotations

from validation_cases import ferris_tin_loi
from validation_cases.row import check


def test_rows():
    check(ferris_tin_loi.rows())
