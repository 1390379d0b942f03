"""Where on a step of a mechanism a tie yields or breaks: that very configuration is looked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from concio.contact.face_points import Standing

if TYPE_CHECKING:
    from concio.analysis.seismic.sequence import Sequence, State

LOCATED, SHARP = 60, 1e-9
"""Trials at most for a configuration in which a tie yields or breaks, and how nearly its elongation is met."""


@dataclass(frozen=True, eq=False)
class TieEvent:
    """A configuration in which a tie yields or breaks, ``length`` [m] after the last."""

    q: Standing
    length: float
    tie: int
    breaks: bool


def tie_event(sequence: Sequence, last: State, q: Standing, length: float) -> TieEvent | None:
    """Return the first yielding or breaking of a tie within a step that leads to ``q``; None where there is none."""
    bars = [tie for tie, _, _ in sequence.ties]
    event = last.history.next_event(bars, last.elongation, sequence.elongations(q)) if bars else None
    if event is None:
        return None
    low, high, at = 0.0, length, q
    for _ in range(LOCATED):
        k, limit, _ = event
        slope = (sequence.elongations(at)[k] - last.elongation[k]) / high
        guess = (limit - last.elongation[k]) / slope
        middle = guess if low < guess < high else (low + high) / 2
        there = sequence.step(last, middle)
        if there is None:
            break
        reached = sequence.elongations(there)
        sooner = last.history.next_event(bars, last.elongation, reached)
        if sooner is None:
            low = middle
            if abs(reached[k] - limit) <= SHARP * abs(limit):
                return TieEvent(there, middle, k, event[2])
        else:
            high, at, event = middle, there, sooner
            if abs(reached[sooner[0]] - sooner[1]) <= SHARP * abs(sooner[1]):
                break
    return TieEvent(at, high, event[0], event[2])
