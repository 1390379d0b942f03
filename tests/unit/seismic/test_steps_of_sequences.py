"""The state of a displaced mechanism: which contacts stay is what their own velocities and forces say."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.seismic.macro_contacts import contacts_of
from concio.analysis.seismic.sequence import Sequence
from concio.analysis.seismic.tie_history import TieHistory
from seismic_walls import overturning, site


@pytest.mark.parametrize(("friction", "slides"), [(0.8, False), (0.02, True)])
def test_contacts_that_press_and_do_not_slide_stay(friction: float, slides: bool) -> None:
    """A wall that turns over keeps its toe; one that slides on all of its foot keeps nothing."""
    worst = concio.assess(overturning(2, friction=friction), site=site(), direction="left", levels=["SLV"]).worst
    assert worst is not None
    linkage = worst.linkage
    contacts = contacts_of(worst.assembly, worst.mechanics, worst.found.normal_force)
    sequence = Sequence(worst.mechanics, contacts, linkage.dead, linkage.push, linkage.ties, linkage.control)
    state = sequence.state(sequence.at_rest(), np.ones(len(contacts.point)), TieHistory.none(0))
    assert state is not None
    assert state.multiplier == pytest.approx(worst.multiplier, rel=1e-6)
    block, point, along = sequence.control
    centre = sequence.at_rest().centre[block]
    vx, vy, turn = state.velocity[block]
    arm = np.asarray(point) - centre
    assert np.array([vx - turn * arm[1], vy + turn * arm[0]]) @ along == pytest.approx(1.0)  # the control point
    arms = contacts.point - centre  # one macro-block on the ground
    speed = np.hypot(vx - turn * arms[:, 1], vy + turn * arms[:, 0])
    assert len(worst.mechanics.blocks) == 1
    presses = state.normal_force > 1e-9 * state.normal_force.max()
    np.testing.assert_array_equal(state.stays, presses & (speed < 1e-8))
    assert state.stays.any() != slides
    assert presses.any()
