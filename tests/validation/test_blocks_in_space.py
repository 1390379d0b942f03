"""Rigid blocks in space against closed forms, and walls extruded against the plane."""

from __future__ import annotations

import pytest
from validation_cases import blocks_in_space
from validation_cases.row import check


@pytest.mark.long  # test_cone_statics and test_extrusion have closed forms and walls of the plane
def test_rows() -> None:
    check(blocks_in_space.rows())
