"""Elastic strip pulled along a base: stick and slip zones by shear lag (Volkersen 1938)."""

from __future__ import annotations

import pytest
from validation_cases import strip_on_base
from validation_cases.row import check


def test_rows():
    check(strip_on_base.rows())


def test_dissipation_of_the_hard_joint():
    """By hand: tau times the integral of the slip tau x^2 / (2 EA) over l is F^3 / (6 EA tau)."""
    contacts = strip_on_base.pulled("hard").contacts
    lost = -float((contacts.friction_force * contacts.slip).sum())
    whole = strip_on_base.FORCE**3 / (6 * strip_on_base.EA * strip_on_base.TAU)
    assert lost == pytest.approx(whole, rel=0.01)
