"""Flight, tops, wobbling, impacts, pushes and rest in space against closed forms."""

from __future__ import annotations

import pytest
from validation_cases import motion_in_space
from validation_cases.row import check


@pytest.mark.long
def test_rows():
    check(motion_in_space.rows())


def test_a_cube_that_hits_with_a_corner_is_left_as_impulses_say():
    assert motion_in_space.corner(0.3, 0.5, (2.5, -1.3, -1.5)) < 1e-9


@pytest.mark.long
def test_a_wall_of_300_bricks_stays_at_rest():
    """Of the three hundred bricks none moves or sinks."""
    whole = motion_in_space.wall(15, 19)
    moved, energy = motion_in_space.resting(whole, 1.0, 1e-2)
    assert len(whole.bodies) - 1 == 15 * 19 + 7
    assert moved < 1e-9
    assert energy < 1e-9


