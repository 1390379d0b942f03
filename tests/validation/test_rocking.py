"""Rocking of a rigid block about its toe: lambda = tan(atan(b / h) - theta), statics of the displaced block by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from concio import rock
from concio.errors import InputError, NoEquilibriumError
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Body, Load, Model


def block(width=0.2, height=1.0, friction=0.6, tilt=0.0):
    c, s = np.cos(tilt), np.sin(tilt)
    turn = np.array([[c, s], [-s, c]])

    def rectangle(x0, x1, y0, y1):
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]) @ turn

    return Model(
        bodies=(
            Body("ground", rectangle(-3, 3, -1, 0), kind="fixed"),
            Body("pillar", rectangle(0, width, 0, height), kind="rigid"),
        ),
        materials={"block": Rigid(20.0)},
        laws={"joint": JointLaw(friction)},
    )


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_pillar_falls_from_a_fifth_to_zero(direction):
    found = rock(block(), direction=direction, step=0.004)
    assert found.multiplier[0] == pytest.approx(0.2, rel=2e-4)
    assert found.multiplier[-1] == pytest.approx(0.0, abs=1e-9)
    assert "fell to 0" in found.reason
    theta = -direction * found.rotation[:, 0]
    assert theta[0] == pytest.approx(0.0, abs=1e-4)
    assert (np.diff(theta) > 0).all()
    assert found.multiplier == pytest.approx(np.tan(np.arctan(0.2) - theta), abs=1e-8)
    toe = 0.2 if direction > 0 else 0.0
    assert found.centroid[-1, 0, 0] == pytest.approx(toe, abs=1e-5)  # the centroid is above the toe at zero


def test_step_size_does_not_matter_for_one_hinge():
    coarse, fine = (rock(block(), step=s) for s in (0.02, 0.005))
    for found in (coarse, fine):
        assert found.multiplier == pytest.approx(np.tan(np.arctan(0.2) + found.rotation[:, 0]), abs=1e-8)
    assert len(fine.multiplier) > 1.5 * len(coarse.multiplier)


def test_point_loads_count():
    """A load W on top of a pillar of weight W = 4 kN, 0.05 m from its axis towards its toe, is pushed with it."""
    plain = block()
    own, extra = Load("weight", (0.0, -1.0)), Load("point", (0.0, -4.0), bodies=("pillar",), at=(0.15, 1.0))
    loaded = rock(replace(plain, loads=(own, extra)))
    assert loaded.multiplier[0] == pytest.approx((4 * 0.1 + 4 * 0.05) / (4 * 0.5 + 4 * 1.0), rel=2e-3)


def test_elastic_blocks_are_refused():
    model = block()
    bodies = (model.bodies[0], Body("soft", model.bodies[1].outline))
    with pytest.raises(InputError, match="rigid"):
        rock(Model(bodies=bodies, materials={"block": Elastic(1e6)}, laws=model.laws))


def test_what_does_not_stand_is_refused():
    with pytest.raises(NoEquilibriumError, match="does not stand"):
        rock(block(tilt=0.3))
