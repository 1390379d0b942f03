"""How far joints of blocks in the plane open, further than contact is looked for."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from models import weight

FLOOR = concio.Body("floor", ((-2.0, -0.5), (3.0, -0.5), (3.0, 0.0), (-2.0, 0.0)), kind="fixed")
LEFT, RIGHT = 0.3, 0.2
"""Widths of the feet of a bridge of 1 m."""


def on_the_floor(*ring: tuple[float, float]) -> concio.Model:
    """A rigid body on the floor, rough enough not to slide."""
    body = concio.Body("b", ring, kind="rigid")
    return concio.Model(
        (FLOOR, body), {"block": concio.Rigid(unit_weight=20.0)}, {"joint": concio.JointLaw(4.0)}, loads=(weight(),)
    )


def test_a_block_that_is_thrown_up_opens_its_joint_by_its_flight():
    """35 mm was said of 404."""
    block = on_the_floor((0.0, 0.0), (0.3, 0.0), (0.3, 1.1), (0.0, 1.1))
    found = concio.dynamics(block, velocities={"b": (0.0, 3.0, 0.0)}, duration=0.2, step=4e-3)
    assert found.summary()["largest_opening"] == pytest.approx(3.0 * 0.2 - 0.5 * 9.80665 * 0.2**2, rel=1e-4)


def test_each_foot_of_a_bridge_that_rocks_opens_by_its_distance_from_the_hinge():
    """33 mm was said of 80: the far ends of its two joints gape wider than the search looks."""
    inner = 1.0 - RIGHT
    bridge = on_the_floor(
        (0.0, 0.0), (LEFT, 0.0), (LEFT, 0.3), (inner, 0.3), (inner, 0.0), (1.0, 0.0), (1.0, 0.6), (0.0, 0.6)
    )
    found = concio.dynamics(bridge, concio.Pulse("sine", amplitude=30.0, length=0.3), duration=0.15, step=5e-3)
    _, turned = found.largest_rotation
    assert turned > 0.03
    assert found.shots.opening[-1] == pytest.approx(np.array([LEFT, 1.0]) * np.sin(turned), rel=1e-3)
