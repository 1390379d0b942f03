"""When bodies meet: a step in which something is hit ends where that happens, and the impact has a step of its own.

A step feels an impact up to half a step early or late. What pressed at the old corner of a rocking block in that time
presses at the new one, which is an error of the first order: of an arc that lasts a hundred steps, half a per cent or
so, of either sign. Steps that end where a gap closes leave of it the share that the least step has of a whole one.
Where much is hit all the time, as in a wall that rattles, that would cost a multiple; then most impacts are felt as
the step finds them. What a wall uses up counts for it alone: bodies that stand apart from it earn and spend their own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.analysis.motion.joint_step import JointStep
from concio.contact.slots import Slots

Array = np.ndarray

MOST = 4.0
"""Impacts of connected bodies that may be located one upon the other."""

EARNED = 0.04
"""Impacts of connected bodies located per step in the long run, at most: each costs three steps."""

PAST = 2.5
"""Length of the step of an impact over the time that is left until bodies meet: its middle lies behind that."""


@dataclass
class Meetings:
    """Where steps end because bodies meet.

    Parameters
    ----------
    least : float
        Shortest step [s].
    credit : (B,) array
        Impacts that may be located now, by body; of bodies that are connected the least counts.
    """

    least: float
    credit: Array
    wanted: float | None = None
    until: float = 0.0

    def length(self, time: float, h: float) -> float:
        """Return the length of the step from a time, given the one that is wanted without meetings [s]."""
        if self.wanted is not None:
            return self.wanted
        left = self.until - time
        return left if 0.5 * self.least < left < h else h

    @classmethod
    def of(cls, bodies: int, least: float) -> Meetings:
        """Return the meetings of a number of bodies at the beginning of a motion."""
        return cls(least, np.full(bodies, MOST))

    def located(self, meets: Array, part: Array, h: float) -> float | None:
        """Return the length of the step in place of one of length h in which bodies meet after a time; None: as it is.

        Parameters
        ----------
        meets : (P,) array
            Time until bodies of each connected part meet something; infinite where none do [s].
        part : (B,) integer array
            Of each body.
        h : float
            [s].
        """
        if self.wanted is not None:
            return None
        self.credit = np.minimum(self.credit + EARNED, MOST)
        credit = np.full(int(part.max(initial=-1)) + 1, np.inf)
        np.minimum.at(credit, part, self.credit)
        first = np.where(credit[: len(meets)] >= 1.0, meets, np.inf)  # parts without pairs meet nothing
        if not len(first) or first.min() >= h or h <= PAST * self.least:
            return None
        self.credit[part == first.argmin()] -= 1.0
        return max(float(first.min()), self.least)

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


def first_meetings(
    step: JointStep, end: Array, apart: Array, speed: float, h: float, part: Array, count: int
) -> Array:  # fmt: skip
    """Return the times (P,) until what was apart at the beginning of a step meets in it; infinite without [s].

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
    part : (m,) integer array
        Connected part to which each pair belongs.
    count : int
        Connected parts P, those without pairs counted.
    """
    begun = step.gap - 0.5 * h * step.y0[:, 0]
    found = apart & (begun > 0) & (step.y0[:, 0] < -speed) & (step.struck | (end < 0))
    mean = np.where(step.struck, step.y0[:, 0], (end - begun) / h)
    found &= mean < 0
    times = np.full(count, np.inf)
    np.minimum.at(times, part[found], np.maximum(begun[found], 0.0) / -mean[found])
    return times


class Parts:
    """Bodies that are connected by pairs that touch or may soon; fixed ones connect nothing.

    Parameters
    ----------
    fixed : (B,) boolean array
    """

    def __init__(self, fixed: Array) -> None:
        self.fixed = fixed
        self._known: tuple[Slots, Array, Array] | None = None

    def of(self, slots: Slots) -> tuple[Array, Array]:
        """Return the part of each body (B,) and of each pair (m,), counted from zero."""
        if self._known is None or self._known[0] is not slots:
            a, b, count = slots.body_a, slots.body_b, len(self.fixed)
            both = ~(self.fixed[a] | self.fixed[b])
            links = sp.coo_array((np.ones(both.sum()), (a[both], b[both])), shape=(count, count))
            _, part = sp.csgraph.connected_components(links, directed=False)
            self._known = slots, part, np.where(self.fixed[a], part[b], part[a])
        return self._known[1:]
