"""A semicircular arch at falling friction, and with vertical joints."""

from __future__ import annotations

import pytest
from validation_cases import arch_and_friction
from validation_cases.row import check


@pytest.mark.long
def test_what_was_published() -> None:
    check(arch_and_friction.rows())


def test_vertical_joints_need_more_thickness_than_radial_ones() -> None:
    assert arch_and_friction.stands(arch_and_friction.radial(0.108, 1.0, 60))
    assert not arch_and_friction.stands(arch_and_friction.vertical(0.107, 60))
