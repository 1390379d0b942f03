"""Steps that end where bodies meet: what they cost, and that they come back to the grid of steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.analysis.motion.meetings import EARNED, MOST, Meetings
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.stepper import Stepper
from concio.contact.reference import Reference
from models import box, model_of, weight
from motion_models import G, standing


def followed(meets, count, h=1.0):
    """Return the lengths of the steps from 0, where something meets at certain times."""
    meetings, time, lengths = Meetings.of(1, h / 64), 0.0, []
    while time < count - 1e-9:
        length = meetings.length(time, h)
        ahead = min((m - time for m in meets if m > time + 1e-12), default=np.inf)
        cut = meetings.located(np.array([ahead]), np.array([0]), length)
        meetings.after(time, cut is not None, 0.0, length)
        lengths.append(length if cut is None else cut)
        time += lengths[-1]
    return lengths


def test_a_step_ends_where_bodies_meet_and_the_next_but_one_where_it_would_have():
    times = np.cumsum(followed([1.3], 4))
    assert times == pytest.approx([1.0, 1.3, 1.3 + 1 / 64, 2.0, 3.0, 4.0])


def test_no_more_impacts_are_located_than_steps_have_earned():
    """With one in every step, in the long run one in twenty-five is, and each makes three steps of one."""
    count = 400
    lengths = followed([k + 0.4 for k in range(count)], count)
    located = sum(abs(length - 0.4) < 1e-9 for length in lengths)
    assert located <= MOST + EARNED * len(lengths)
    assert len(lengths) <= count * (1 + 2.2 * EARNED) + 2 * MOST


def test_what_one_part_uses_up_counts_for_it_alone():
    """One part rattles in every step; the impacts of the other, one in fifty steps, are all located."""
    h, part = 1.0, np.array([0, 0, 1])
    meetings, time, found = Meetings.of(3, h / 64), 0.0, 0
    rattles = np.arange(600) + 0.4
    others = np.arange(7, 600, 50) + 0.7
    while time < 599.0:
        length = meetings.length(time, h)
        ahead = np.array([min(v[v > time + 1e-12], default=np.inf) - time for v in (rattles, others)])
        cut = meetings.located(ahead, part, length)
        found += cut is not None and abs(cut - ahead[1]) < 1e-9
        meetings.after(time, cut is not None, 0.0, length)
        time += length if cut is None else cut
    assert found == len(others)
    assert (meetings.credit[:2] < 1.1).all()
    assert meetings.credit[2] > 1.5


def test_blocks_on_one_floor_are_parts_of_their_own():
    """Until they may touch: a fixed body connects nothing."""
    near, far = box("near", 0.51, 0.9, 0.0, 1.0, kind="rigid", material="stone"), 8.0
    blocks = [box("block", 0.0, 0.5, 0.0, 1.0, kind="rigid", material="stone"), near]
    blocks.append(box("apart", far, far + 0.5, 0.0, 1.0, kind="rigid", material="stone"))
    model = model_of(box("floor", -30.0, 30.0, -1.0, 0.0, kind="fixed"), *blocks, law=0.5, loads=(weight(),))
    stepper = Stepper(Reference.of(model, G), Scheme())
    state = stepper.located(MotionState.at_rest(stepper.reference))
    _, report = stepper.step(state, 1e-3, Drive(np.zeros(2), np.zeros(2), {}))
    assert report.part[1] == report.part[2] != report.part[3]
    assert len(set(report.part.tolist())) == 3


def falling(gap: float, speed: float, h: float, rest_moves: float = 0.0, lifted: float = 0.0):
    """Return the report of a step in which a block falls on a floor on which another one rests and carries.

    ``rest_moves`` is how fast the other one moves down [m/s], ``lifted`` how high it stands [m].
    """
    model = model_of(
        box("floor", -3.0, 3.0, -1.0, 0.0, kind="fixed"),
        box("falls", 0.0, 1.0, gap, gap + 0.6, kind="rigid", material="stone"),
        box("rests", -2.0, -1.0, 0.0, 0.5, kind="rigid", material="stone"), law=0.5, loads=(weight(),),
    )  # fmt: skip
    stepper, drive = Stepper(Reference.of(model, G), Scheme()), Drive(np.zeros(2), np.zeros(2), {})
    start = stepper.located(MotionState.at_rest(stepper.reference))
    carries, _ = stepper.step(start, 1e-3, drive)
    assert (carries.memory.force[:, 0] > 0).any()
    velocity, centre = np.zeros((3, 2)), start.centre.copy()
    velocity[1:, 1], centre[2, 1] = (-speed, -rest_moves), centre[2, 1] + lifted
    carries = replace(carries, centre=centre, rotation=start.rotation, velocity=velocity, spin=np.zeros(3))
    new, report = stepper.step(carries, h, drive)
    return report, float(new.centre[1, 1]) - 0.3


def test_how_deep_a_step_takes_what_was_apart():
    """By hand: free fall to the end of a step whose middle is still above the floor, and no block that carried counts.

    Where the middle is below, the floor stops the block there.
    """
    h, v = 0.01, 1.0
    report, at = falling(0.008, v, h)
    deep = h * v + 0.5 * G * h**2 - 0.008
    assert report.struck == pytest.approx(deep, rel=1e-9)
    assert at == pytest.approx(-deep, rel=1e-9)
    assert report.depth < 1e-3 * deep, "it could carry nothing in this step"
    report, _ = falling(0.004, v, h)
    assert report.struck == report.depth == pytest.approx(0.5 * h * v - 0.004, rel=1e-6)
    report, _ = falling(0.5, v, h)
    assert report.struck == 0.0
    assert not np.isfinite(report.meets).any()


def test_what_carried_before_a_step_neither_strikes_nor_meets():
    """However fast it is, and wherever it stands."""
    report, _ = falling(0.5, 0.0, 0.01, rest_moves=0.1)
    assert report.depth == pytest.approx(0.5 * 0.01 * 0.1, rel=1e-2)
    assert report.struck == 0.0
    report, _ = falling(0.5, 0.0, 0.01, rest_moves=0.1, lifted=2e-4)
    assert report.struck == 0.0
    assert not np.isfinite(report.meets).any()


@pytest.mark.long
def test_shots_stay_on_the_grid_of_steps():
    """But for those right after an impact, kept placements are a step apart."""
    tilt = 0.5 * np.arctan(1 / 3)
    found = concio.dynamics(standing(tilt=tilt), duration=0.6, step=1e-3, start="as described", gravity=G, every=1e-9)
    steps = found.shots.time * 1e3
    off = np.abs(steps - np.round(steps)) > 1e-6
    assert 1 <= off.sum() <= 2 * MOST
    assert not off[-1]
