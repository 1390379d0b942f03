"""How far joints of blocks in space open while these rock."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from space_motions import blocks


def test_a_rocking_block_opens_its_joint_by_its_width_times_the_sine_of_its_angle():
    """31.5 mm in place of 47.7: corners that gape wider than the search looks were not counted."""
    model = blocks(((-0.15, -0.4, 0.0), (0.15, 0.3, 1.1)), friction=0.9)
    found = concio.dynamics(model, concio.Pulse("sine", amplitude=5.0, length=0.5), duration=0.6, step=8e-3)
    name, turned = found.largest_rotation
    assert name == "b0"
    assert turned > 0.1
    assert found.summary()["largest_opening"] == pytest.approx(0.3 * np.sin(turned), rel=1e-3)
