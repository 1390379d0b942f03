"""Arches of several rings pushed at large displacements, and what their verdicts say of joints that give way."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from test_bridge_assessment import placed, small

import concio
from concio.analysis.limit import dead_and_live
from concio.analysis.motion.push_result import PushEnding, PushResult
from concio.model.fill import Fill
from concio.solvers.statics.associated_limit import associated_limit
from concio.verdict.push_verdict import LENT

TOLD = re.compile(r"extended back to zero displacement, the falling part of the curve begins ([\d.]+) % above the peak")


def told(found: PushResult) -> float:
    """Return by how much the falling part of the curve begins above the peak, in per cent, as the verdict says."""
    (said,) = [m[1] for line in found.verdict.limits if (m := TOLD.search(line))]
    return float(said)


def test_a_peak_that_joints_delay_is_told_with_what_it_falls_short() -> None:
    """The falling part of a pillar's curve is nearly straight: a delay of a tenth of its capacity costs a tenth."""
    found = concio.push(concio.column(width=0.5, height=2.0, blocks=1, block="rigid"))
    assert LENT in found.verdict.limits
    late = np.where(found.displacement > 0, found.displacement + 0.1 * found.capacity, 0.0)
    assert told(replace(found, displacement=late)) == pytest.approx(10.0, rel=0.05)
    assert LENT in replace(found, by_load=True, displacement=late).verdict.limits


@pytest.mark.long
@pytest.mark.parametrize("k", [0.0, 1.0])
def test_an_arch_of_two_rings_is_followed_past_its_peak(k: float) -> None:
    """Between what Coulomb steps carry, but for joints that give way, and the associated bound; the soil is stiff."""
    fill = Fill(cover=0.3, unit_weight=20.0, passive=k, stiffness=2e5)
    model = placed(small(fill, ring=[0.1075, 0.1075], ring_friction=0.6, voussoirs=8), 0.7)
    bound = associated_limit(*dead_and_live(concio.assemble(model), "live")).multiplier
    steps = concio.limit(model, "live", path=False, steps=True, search=False)
    found = concio.push(model, until=0.003)
    assert found.certified
    assert found.ending is PushEnding.REACHED
    assert found.peak_passed
    assert steps.design <= found.peak * (1 + told(found) / 100)
    assert found.peak <= bound
