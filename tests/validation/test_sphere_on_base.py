"""Sphere pressed and pushed on a plane (Hertz, Cattaneo and Mindlin), an elastic cube that slides."""

from __future__ import annotations

import pytest
from validation_cases import sphere_on_base
from validation_cases.row import check


@pytest.mark.long
def test_rows() -> None:
    check(sphere_on_base.rows())
