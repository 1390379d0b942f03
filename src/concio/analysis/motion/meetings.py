"""When bodies meet: a step in which something is hit ends where that happens, and the impact has a step of its own.

A step feels an impact up to half a step early or late. What pressed at the old corner of a rocking block in that time
presses at the new one, which is an error of the first order: of an arc that lasts a hundred steps, half a per cent or
so, of either sign. Steps that end where a gap closes leave of it the share that the least step has of a whole one.
Where much is hit all the time, as in a wall that rattles, that would cost a multiple; then most impacts are felt as
the step finds them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.analysis.motion.joint_step import JointStep

Array = np.ndarray

MOST = 4.0
"""Impacts that may be located one upon the other."""

EARNED = 0.04
"""Impacts located per step in the long run, at most: each costs three steps."""

PAST = 2.5
"""Length of the step of an impact over the time that is left until bodies meet: its middle lies behind that."""


@dataclass
class Meetings:
    """Where steps end because bodies meet.

    Parameters
    ----------
    least : float
        Shortest step [s].
    """

    least: float
    credit: float = MOST
    wanted: float | None = None
    until: float = 0.0

    def length(self, time: float, h: float) -> float:
        """Return the length of the step from a time, given the one that is wanted without meetings [s]."""
        if self.wanted is not None:
            return self.wanted
        left = self.until - time
        return left if 0.5 * self.least < left < h else h

    def located(self, meets: float, h: float) -> float | None:
        """Return the length of the step in place of one of length h in which bodies meet after a time; None: as it is.

        Parameters
        ----------
        meets : float
            Time until the first bodies meet; infinite where none do [s].
        h : float
            [s].
        """
        if self.wanted is not None:
            return None
        self.credit = min(self.credit + EARNED, MOST)
        if meets >= h or self.credit < 1.0 or h <= PAST * self.least:
            return None
        self.credit -= 1.0
        return max(meets, self.least)

    def after(self, time: float, cut: bool, left: float, h: float) -> None:
        """Note a step: from when it began, whether it was cut, the time left until bodies meet, its wanted length."""
        if cut:
            self.until = max(self.until, time + h) if time < self.until < time + h else time + h
            self.wanted = max(self.least, PAST * left) if left < h else None
        else:
            self.wanted = None


def time_until(gap: Array, velocity: Array, closing: Array) -> float:
    """Return the time until the first of the pairs that come nearer meets; infinite where none does [s]."""
    if not closing.any():
        return float("inf")
    return float((np.maximum(gap[closing], 0.0) / -velocity[closing]).min())


def first_meeting(step: JointStep, end: Array, apart: Array, speed: float, h: float) -> float:
    """Return the time until what was apart at the beginning of a step meets in it; infinite where nothing does [s].

    Parameters
    ----------
    step : JointStep
    end : (m,) array
        Gaps at the end of the step [m].
    apart : (m,) array of bool
        Hard pairs that carried nothing before.
    speed : float
        Velocity up to which what comes nearer rests rather than hits [m/s].
    h : float
        [s].
    """
    begun = step.gap - 0.5 * h * step.y0[:, 0]
    found = apart & (begun > 0) & (step.y0[:, 0] < -speed) & (step.struck | (end < 0))
    mean = np.where(step.struck, step.y0[:, 0], (end - begun) / h)
    return time_until(begun, mean, found & (mean < 0))
