"""Ties that yield and break in a motion: where they do, not at the end of a step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from motion_models import G, standing
from samples import sample

MASS = 20.0 * 0.4 * 0.2 / G


def pulled(stiffness, **options):
    """A low block without friction, pulled by a tie along its motion, at its centroid."""
    model = standing(0.4, 0.2, friction=0.0)
    rod = concio.Tie("rod", "block", (0.0, 0.1), "", (-3.0, 0.1), stiffness=stiffness, **options)
    return replace(model, ties=(rod,))


def thrown(model, speed, duration, step):
    found = concio.dynamics(
        model, duration=duration, step=step, start="as described", velocities={"block": (speed, 0.0)}, gravity=G,
        every=step,
    )  # fmt: skip
    assert found.certified
    return found


@pytest.mark.parametrize("seed", range(sample(2, 5, 12)))
def test_a_block_leaves_its_tie_with_what_it_has_when_that_breaks(seed):
    """v^2 = v0^2 - (omega b)^2, whatever part of a step is left when the elongation b is reached: second order."""
    rng = np.random.default_rng(seed)
    stiffness, speed = rng.uniform(20.0, 80.0), rng.uniform(0.5, 2.0)
    omega = np.sqrt(stiffness / MASS)
    breaks = rng.uniform(0.3, 0.8) * speed / omega
    wanted = np.sqrt(speed**2 - (omega * breaks) ** 2)
    model = pulled(stiffness, break_elongation=breaks)
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        found = thrown(model, speed, 2.0 * np.arcsin(omega * breaks / speed) / omega, step)
        errors.append(abs(found.end.velocity[1, 0] - wanted) / wanted)
        assert found.end.ties.broken.all()
        assert errors[-1] < 0.2 * (omega * step) ** 2 / (1.0 - (omega * breaks / speed) ** 2)
    assert errors[-1] < 1e-3


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 5, 12)))
def test_a_tie_that_yields_stops_a_block_where_energy_says(seed):
    """The elongation at rest: m v^2 / 2 = F (u - u_y / 2), F the yield force reached at u_y."""
    rng = np.random.default_rng(seed)
    stiffness, speed = rng.uniform(20.0, 80.0), rng.uniform(0.5, 2.0)
    omega = np.sqrt(stiffness / MASS)
    most = rng.uniform(0.3, 0.8) * speed * omega * MASS
    wanted = MASS * speed**2 / (2 * most) + most / (2 * stiffness)
    model = pulled(stiffness, yield_force=most)
    period = np.pi / omega + MASS * speed / most
    for step in (4e-3, 1e-3):
        found = thrown(model, speed, period, step)
        reached = (found.shots.centre[:, 1, 0] - found.shots.centre[0, 1, 0]).max()
        assert reached == pytest.approx(wanted, rel=0.5 * (omega * step) ** 2 + 1e-6)
        assert found.end.ties.plastic[0] == pytest.approx(wanted - most / stiffness, rel=0.01)


def test_a_step_that_is_cut_where_a_tie_breaks_goes_back_to_the_grid():
    model = pulled(40.0, break_elongation=0.0107)
    found = thrown(model, 1.0, 0.05, 2e-3)
    times = found.steps.time / 2e-3
    off = np.flatnonzero(np.abs(times - np.round(times)) > 1e-6)
    assert 1 <= len(off) <= 2
    assert np.abs(times[-5:] - np.round(times[-5:])).max() < 1e-6
