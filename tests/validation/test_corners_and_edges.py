"""Contacts at corners and along edges against statics by hand."""

from __future__ import annotations

from validation_cases import corners_and_edges
from validation_cases.row import check


def test_rows():
    check(corners_and_edges.rows())
