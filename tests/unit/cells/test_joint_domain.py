"""Tractions that a joint carries, against the joint law written out."""

from __future__ import annotations

import numpy as np
import pytest

from concio.analysis.continuum.joint_domain import joint_half_planes
from concio.model.materials import JointLaw


@pytest.mark.parametrize("law", [
    JointLaw(0.6), JointLaw(0.3, cohesion=5.0), JointLaw(0.8, cohesion=5.0, tensile_strength=2.0),
    JointLaw(0.5, cohesion=1.0, tensile_strength=0.5, compressive_strength=30.0),
    JointLaw(0.5, compressive_strength=8.0),
])  # fmt: skip
def test_tractions_are_carried_within_friction_tension_and_compression(law: JointLaw) -> None:
    m, g = joint_half_planes(law)
    s, t = (v.ravel() for v in np.meshgrid(np.linspace(-40.3, 6.2, 94), np.linspace(-30.1, 30.7, 122)))
    wanted = (np.abs(t) <= law.cohesion - law.friction * s) & (s <= law.tensile_strength)
    if law.compressive_strength is not None:
        wanted &= -s <= law.compressive_strength
    found = (np.column_stack([s, t]) @ m.T <= g).all(axis=1)
    assert wanted.any()
    assert not wanted.all()
    assert (found == wanted).all()
