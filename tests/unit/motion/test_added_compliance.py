"""The compliance that steps of a motion add to hard joints: how much, for any mass and any step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from concio.analysis.motion.joints import RETURN, SOFT
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.stepper import Stepper
from concio.contact.reference import Reference
from motion_models import G, standing


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize("h", [1e-5, 1e-3, 1e-2])
def test_it_is_a_small_share_of_what_the_bodies_give_way(mass: float, h: float) -> None:
    """SOFT times the compliance of the free bodies over a step; never does it come back faster than RETURN."""
    model = standing()
    heavier = {name: replace(m, unit_weight=mass * m.unit_weight) for name, m in model.materials.items()}
    stepper = Stepper(Reference.of(replace(model, materials=heavier), G), Scheme())
    start = stepper.located(MotionState.at_rest(stepper.reference))
    maker, still = stepper.maker, (np.zeros_like(start.centre), np.zeros_like(start.spin))
    memory, rows, _ = maker.contacts(start.memory, start.placement, *still, start.strain)
    give, nothing = stepper._give(rows, h), np.zeros((len(memory.key), 2))
    assert (give > 0).all()
    data, step = maker.joints.pairs(rows, maker.slots, memory, nothing, h, G * h, give)
    assert (step.a_n > 0).all()
    np.testing.assert_allclose(data.a_n, np.minimum(SOFT * give, RETURN / h * step.a_n), rtol=1e-12)
    assert (data.a_n <= SOFT * give * (1 + 1e-12)).all()
