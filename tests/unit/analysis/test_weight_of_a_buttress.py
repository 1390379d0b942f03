"""The weight of a given buttress is a load of its own: the least one for a multiplier is proved, and bisected."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio import Body, JointLaw, Load, Model, Rigid
from samples import sample


def box(name: str, x0: float, x1: float, z0: float, z1: float, **more: str) -> Body:
    return Body(name, np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]]), **{"kind": "rigid", **more})


def buttressed(weight: float, width: float, height: float) -> Model:
    """Return a wall of 0.5 x 4 m that is pushed to the left, where a buttress stands, of so much per volume."""
    bodies = (box("ground", -3.0, 2.0, -0.5, 0.0, kind="fixed"), box("wall", 0.0, 0.5, 0.0, 4.0),
              box("buttress", -width, 0.0, 0.0, height))  # fmt: skip
    loads = (Load("weight", (0.0, -1.0), bodies=("wall",)),
             Load("weight", (0.0, -weight), bodies=("buttress",), group="buttress"),
             Load("weight", (-1.0, 0.0), bodies=("wall",), group="live"))  # fmt: skip
    return Model(bodies, {"block": Rigid(unit_weight=1.0)}, {"joint": JointLaw(friction=0.6)}, loads=loads)


@pytest.mark.long
@settings(max_examples=sample(3, 8, 30), deadline=None)
@given(st.floats(0.3, 1.5), st.floats(1.0, 3.5), st.floats(0.15, 0.5))
def test_the_least_weight_is_that_of_a_bisection(width: float, height: float, target: float) -> None:
    found = concio.limit(buttressed(1.0, width, height), path=False).least(target, load="buttress")
    assert 0.0 < found.amount == found.least
    assert found.reached == pytest.approx(target, rel=1e-9)

    def carried(weight: float) -> float:
        return concio.limit(buttressed(weight, width, height), path=False).associated.multiplier

    low, high = 0.0, 2.0 * found.amount
    while high - low > 1e-7 * found.amount:
        middle = (low + high) / 2
        low, high = (low, middle) if carried(middle) >= target else (middle, high)
    assert found.amount == pytest.approx(high, rel=1e-6)
