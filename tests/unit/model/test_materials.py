"""Materials and joint laws: units, ranges, and what every message names."""

from __future__ import annotations

import math

import pytest

from concio.errors import InputError
from concio.model.materials import Elastic, JointLaw, Rigid


def test_units_are_read():
    assert Elastic("2 GPa", 0.2, "20 kN/m3") == Elastic(2e6, 0.2, 20.0)
    assert Rigid("18 kN/m3").unit_weight == 18.0
    law = JointLaw(0.6, "0.1 MPa", normal_stiffness="10 MN/m3", compressive_strength="3 MPa")
    assert law.cohesion == pytest.approx(100.0)
    assert law.normal_stiffness == pytest.approx(1e4)
    assert law.compressive_strength == pytest.approx(3e3)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Elastic(0.0), "E = 0"),
        (lambda: Elastic(-5.0), "E = -5"),
        (lambda: Elastic(math.inf), "E = inf"),
        (lambda: Elastic(math.nan), "not a number"),
        (lambda: Elastic(1.0, 0.5), "nu = 0.5"),
        (lambda: Elastic(1.0, -1.0), "nu = -1"),
        (lambda: Elastic(1.0, 0.2, -1.0), "unit_weight = -1"),
        (lambda: Elastic("5 m"), "(?i)unit|stress"),
        (lambda: Rigid(-1.0), "unit_weight = -1"),
        (lambda: Rigid(math.inf), "unit_weight = inf"),
        (lambda: JointLaw(-0.1), "friction = -0.1"),
        (lambda: JointLaw(math.inf), "friction = inf"),
        (lambda: JointLaw(math.nan), "not a number"),
        (lambda: JointLaw(0.5, cohesion=-1.0), "cohesion = -1"),
        (lambda: JointLaw(0.5, cohesion=4.9, tensile_strength=10.0), "cohesion of at least.*5"),
        (lambda: JointLaw(0.5, dilatancy=0.6), "exceeds friction"),
        (lambda: JointLaw(0.5, normal_stiffness=0.0), "normal_stiffness = 0"),
        (lambda: JointLaw(0.5, compressive_strength=0.0), "compressive_strength = 0"),
    ],
)
def test_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_limits_that_are_allowed():
    JointLaw(0.0)
    JointLaw(0.5, dilatancy=0.5)
    JointLaw(0.5, cohesion=5.0, tensile_strength=10.0)
    JointLaw(0.0, tensile_strength=10.0)
    Elastic(1.0, -0.99)
    Elastic(1.0, 0.499)
