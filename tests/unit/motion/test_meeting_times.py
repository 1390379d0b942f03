"""When bodies that come nearer meet, and which of their pairs count."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis.motion.meetings import Meetings, first_meetings, time_until


def test_the_first_of_the_pairs_that_close_meets_first() -> None:
    gap, velocity = np.array([0.5, 0.3, 0.1, 0.01]), np.array([-1.0, -2.0, -0.1, -5.0])
    assert time_until(gap, velocity, np.array([True, True, True, False])) == pytest.approx(0.15)
    assert time_until(gap, velocity, np.array([True, False, True, False])) == pytest.approx(0.5)
    assert time_until(gap, velocity, np.array([True, True, True, True])) == pytest.approx(0.002)
    assert time_until(gap, velocity, np.zeros(4, dtype=bool)) == math.inf
    assert time_until(np.array([-0.2, 0.4]), np.array([-1.0, -2.0]), np.ones(2, dtype=bool)) == 0.0


@pytest.mark.parametrize("h", [0.01, 0.5])
def test_meetings_in_a_step_by_part(h: float) -> None:
    """Gaps at its middle, velocities at its beginning; what was touched, leaves, or rests does not count.

    Struck pairs go on with the velocity they had, others with the mean over the step.
    """
    begun = np.array([0.3, 0.2, 0.4, 0.2, 0.1, 0.2, -0.1, 0.3]) * h
    y0 = np.array([-1.0, -2.0, -1.0, 0.5, -1e-4, -2.0, -1.0, -2.0])
    end = np.array([-0.1, 0.0, 0.1, -0.1, -0.1, -0.2, -0.2, -0.1]) * h
    apart = np.array([True, True, True, True, True, False, True, True])
    struck = np.array([False, True, False, False, False, False, False, False])
    step = SimpleNamespace(gap=begun + 0.5 * h * y0, y0=np.column_stack([y0, y0]), struck=struck)
    part = np.array([0, 0, 1, 1, 1, 1, 1, 3])
    found = first_meetings(step, end, apart, 1e-3, h, part, 5)
    mean = (-0.1 - 0.3) * h / h
    wanted = [min(0.3 * h / -mean, 0.2 * h / 2.0), math.inf, math.inf, 0.3 * h / 0.4, math.inf]
    assert found == pytest.approx(wanted)


def test_steps_end_where_bodies_meet_and_go_back_to_the_grid() -> None:
    meetings = Meetings.of(3, 0.01)
    assert meetings.length(0.0, 0.5) == 0.5
    meetings.until = 2.0
    assert meetings.length(1.8, 0.5) == pytest.approx(0.2)
    assert meetings.length(1.4, 0.5) == 0.5, "further away than the step"
    assert meetings.length(1.996, 0.5) == 0.5, "less than half of the shortest step is left"
    assert meetings.length(1.994, 0.5) == pytest.approx(0.006)
    meetings.after(1.9, cut=True, left=0.001, h=0.5)
    assert meetings.until == pytest.approx(2.4)
    assert meetings.wanted == pytest.approx(0.01), "never shorter than the shortest"
    assert meetings.length(1.9, 0.5) == pytest.approx(0.01)
    assert meetings.located(np.array([0.1]), np.array([0, 0, 0]), 0.5) is None, "one after the other"
    meetings.after(1.9, cut=True, left=0.02, h=0.5)
    assert meetings.wanted == pytest.approx(0.05)
    meetings.after(1.9, cut=True, left=0.6, h=0.5)
    assert meetings.wanted is None
    meetings.after(3.0, cut=True, left=0.02, h=0.25)
    assert meetings.until == pytest.approx(3.25)
    meetings.after(3.1, cut=False, left=0.02, h=0.25)
    assert meetings.wanted is None


def test_each_part_locates_so_many_meetings_and_earns_more() -> None:
    """Two parts: bodies 0 and 1, and body 2; the first that meets pays, and nobody below the length of a short step."""
    part = np.array([0, 0, 1])
    meetings = Meetings.of(3, 0.01)
    assert meetings.located(np.array([0.3, 0.2]), part, 0.5) == pytest.approx(0.2)
    assert meetings.credit == pytest.approx([4.0, 4.0, 3.0])
    assert meetings.located(np.array([0.002, 0.2]), part, 0.5) == pytest.approx(0.01)
    assert meetings.credit == pytest.approx([3.0, 3.0, 3.04])
    assert meetings.located(np.array([0.6, 0.5]), part, 0.5) is None
    assert meetings.located(np.array([0.001, 0.001]), part, 0.025) is None
    for _ in range(3):
        assert meetings.located(np.array([0.3, 0.4]), part, 0.5) == pytest.approx(0.3)
    assert meetings.located(np.array([0.3, 0.4]), part, 0.5) == pytest.approx(0.4), "the first part has no more"
