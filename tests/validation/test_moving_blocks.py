"""Flight, sliding, bouncing and pushing over, against closed forms; a wall at rest that stays at rest."""

from __future__ import annotations

import numpy as np
import pytest
from validation_cases import moving_blocks
from validation_cases.row import check

import concio
from samples import sample


@pytest.mark.long
def test_rows():
    check(moving_blocks.rows())


def resting_wall(units: int, courses: int, duration: float, step: float) -> None:
    wall = concio.running_bond_panel(
        courses=courses, blocks=units, block_size=(1.0, 0.5), thickness=1.0, block=concio.Rigid(20.0), friction=0.6,
        side_walls=False,
    )  # fmt: skip
    found = concio.dynamics(wall, duration=duration, step=step)
    height = 0.5 * courses
    moved = np.abs(found.shots.centre - found.shots.centre[0]).max()
    weight = float(found.reference.body_mass.sum()) * found.gravity
    assert found.certified
    assert moved < 1e-9 * height
    assert np.ptp(found.energy.total) < 1e-9 * weight * height


def test_a_small_wall_at_rest_stays_at_rest():
    resting_wall(4, 4, 1.0, 5e-3)


@pytest.mark.long
def test_a_wall_of_427_blocks_stays_at_rest():
    """For ten seconds; for a minute where all cases are drawn."""
    resting_wall(30, 14, sample(1.0, 10.0, 60.0), 1e-2)
