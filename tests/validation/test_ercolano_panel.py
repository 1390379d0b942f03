"""Ercolano's panel: reference settlements and thrust by two other programs."""

from __future__ import annotations

import numpy as np
import pytest
from validation_cases import ercolano_panel
from validation_cases.row import check


def test_rows():
    check(ercolano_panel.rows())


def test_symmetry():
    """A mirror-symmetric panel gives a mirror-symmetric answer."""
    left, right = (
        ercolano_panel.panel("dry, mu 1.0, full base").reactions[f"{side} wall"] for side in ("left", "right")
    )
    assert left[0] == pytest.approx(-right[0], rel=1e-9)
    assert left[1] == pytest.approx(right[1], rel=1e-8)


@pytest.mark.parametrize("name", ercolano_panel.CASES)
def test_friction_never_does_positive_work(name):
    contacts = ercolano_panel.panel(name).contacts
    power = contacts.friction_force * contacts.slip
    assert power.max() <= 1e-12 * np.abs(power).max()
