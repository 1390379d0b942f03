"""Least thickness of a semicircular arch under its own weight.

Sources: M. Milankovitch, Theorie der Druckkurven, Z. Math. Phys. 55 (1907); J. Heyman, The safety of masonry arches,
Int. J. Mech. Sci. 11 (1969); A. Cocchetti, G. Colasante, E. Rizzi, On the analysis of minimum thickness in circular
masonry arches, Appl. Mech. Rev. 64 (2011): t/R = 0.1075 for the true (eccentric) line of gravity, hinges at the
springings, at the crown and near 54.5 degrees from the crown. Sliding is excluded by a large friction.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from concio.solvers.statics.existence import find_mechanism, statically_admissible
from rigid_walls import semicircular_arch
from samples import sample

ROUGH = 20.0


def lumped_arch(voussoirs, thickness):
    """The same arch with the weight of each voussoir lumped on the centre line, as if it were a chain."""
    a = semicircular_arch(voussoirs, thickness)
    middle = np.pi * (np.arange(voussoirs) + 0.5) / voussoirs
    return replace(a, centres=np.column_stack([np.cos(middle), np.sin(middle)]))


def static_state(arch, voussoirs, thickness):
    a = arch(voussoirs, thickness)
    return statically_admissible(a.problem(ROUGH, a.load(0, -1)))


def least_thickness(voussoirs, low=0.09, high=0.12, tolerance=2e-7, arch=semicircular_arch):
    """Return (largest thickness shown to fall, least shown to stand): each end is a proof, never the lack of one."""
    assert static_state(arch, voussoirs, high).exists
    assert static_state(arch, voussoirs, low).mechanism is not None
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        state = static_state(arch, voussoirs, middle)
        assert state.decided
        low, high = (low, middle) if state.exists else (middle, high)
    return low, high


@pytest.mark.long  # the same arch next to its limit is below
def test_least_thickness_at_400_voussoirs():
    low, high = least_thickness(400)
    assert low == pytest.approx(0.107478, abs=1e-6)
    assert high == pytest.approx(0.107478, abs=1e-6)


@pytest.mark.parametrize(
    ("arch", "limit"), [pytest.param(lumped_arch, 0.10742643, marks=pytest.mark.long), (semicircular_arch, 0.10747795)]
)
def test_admissible_is_monotone_next_to_the_limit(arch, limit):
    """What left the programme unbalanced by 2e-8 was called "no" above thicknesses that were shown to stand."""
    for above in np.random.default_rng(0).uniform(1e-7, 3e-6, sample(4, 10)):
        assert static_state(arch, 400, limit + above).exists
    for below in (3e-7, 1e-6):
        fallen = static_state(arch, 400, limit - below)
        assert not fallen.exists
        assert fallen.mechanism is not None


def test_least_thickness_converges_to_milankovitch():
    """Fewer joints leave fewer places for hinges: thinner arches stand, and the limit is reached from below."""
    values = [least_thickness(n, low=0.05, high=0.2, tolerance=1e-6)[1] for n in (12, 28, 60)]
    assert values[0] < values[1] < values[2] < 0.10748
    assert values[2] == pytest.approx(0.1075, rel=5e-3)


def test_five_hinges_where_they_belong():
    """Symmetric mechanism: both springings, the crown, and the haunches near 54.5 degrees from the crown."""
    n = 180
    a = semicircular_arch(n, 0.1070)
    p = a.problem(ROUGH, a.load(0, -1))
    found = find_mechanism(p)
    assert found is not None
    opening = (p.C_n @ found.velocity).reshape(-1, 2)  # intrados, extrados of each joint
    joints = np.flatnonzero(opening.max(axis=1) > 1e-6)
    groups = np.split(joints, np.flatnonzero(np.diff(joints) > 2) + 1)
    assert len(groups) == 5
    from_crown = [abs(90.0 - 180.0 / n * g.mean()) for g in groups]
    assert from_crown == pytest.approx([90.0, 54.5, 0.0, 54.5, 90.0], abs=1.5)
    inside_opens = [bool(opening[g, 0].max() > opening[g, 1].max()) for g in groups]
    assert inside_opens == [True, False, True, False, True]  # thrust at the extrados where the intrados opens
