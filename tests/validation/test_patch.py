"""Uniform compression and pure bending through joints, against strength of materials."""

from __future__ import annotations

from validation_cases import patch
from validation_cases.row import check


def test_rows():
    check(patch.rows())
