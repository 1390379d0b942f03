"""From cracks to cause in space: a plane structure swept into space has the same cause."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio import Candidate, Measurement


@pytest.mark.long
def test_an_arch_swept_into_space_has_the_cause_of_its_section() -> None:
    law = concio.JointLaw(2.0, normal_stiffness=1e6, tangential_stiffness=1e6)
    plane = concio.arch(shape="flat", span=1.2, ring=0.3, voussoirs=4, skew=70, block="rigid", friction=law)
    found = []
    for model, place in ((plane, lambda x, z: (x, z)), (concio.extrude(plane, 0.5), lambda x, z: (x, 0.0, z))):
        up = place(0.0, 1.0)
        cracks = [
            Measurement("crown", "opening", 0.2e-3, 10e-3, ("v02", "v03"), at=place(0.0, 0.0)),
            Measurement("sinks", "level", 0.5e-3, -10e-3, body="v02", at=place(0.0, 0.3), direction=up),
            Measurement("closed", "closed", 0.2e-3, joint=("v01", "v02")),
        ]
        gives = Candidate("gives way", body="left abutment", direction=place(-1.0, 0.0), low=0.0)
        found.append(concio.diagnose(model, cracks, [gives], method="steps", steps=2, large=False))
    assert [[c.names for c in one.causes] for one in found] == [[("gives way",)]] * 2
    one, other = (f.best for f in found)
    assert other.motion[0] == pytest.approx(one.motion[0], rel=1e-3)
    np.testing.assert_allclose(other.predicted, one.predicted, atol=2e-5)
    assert other.certificate < 1e-9
