"""The part of the road on which uniform load is least favourable to a vehicle at its position.

Codes put the uniform load of a traffic model only where it is unfavourable. Of a mechanism that part is known: the road
that it moves down. Of a part the mechanism is known: that of the limit load. One after the other, each limit load is at
or below the last. Nothing says that the end is the least of all, so the search starts from several parts and keeps the
least that it met.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from concio.analysis.bridges.sweep import Standing

Array = np.ndarray

Part = tuple[tuple[float, float], ...]
"""From where to where on the road uniform load stands [m], from left to right."""

MOST = 12
"""Largest number of limit loads from one start."""
DOWN = 1e-6
"""Powers below this share of the largest are none."""


def least_favourable(
    starts: Iterable[Part], at: Callable[[Part], Standing | None], pieces: Array, loads: Array
) -> Standing | None:
    """Return the least standing over parts of the road; None where no part brings load to the masonry.

    Parameters
    ----------
    starts : iterable of Part
        Parts from which the search goes on.
    at : callable
        Gives the standing with uniform load on a part.
    pieces : (E, 2) array
        Pieces of the road that are loaded as a whole or not, from left to right [m].
    loads : (E, N) array
        Load of the structure under a uniform load on each.
    """
    known: dict[Part, Standing | None] = {}
    for start in starts:
        part: Part | None = start
        for _ in range(MOST):
            if part is None or part in known:
                break
            known[part] = found = at(part)
            motion = None if found is None else found.limit.mechanism
            part = None if motion is None else moved_down(pieces, loads @ motion.velocity)
    found_all = [s for s in known.values() if s is not None]
    return min(found_all, key=lambda s: s.multiplier, default=None)


def moved_down(pieces: Array, power: Array) -> Part:
    """Return the pieces of positive power, those that touch as one."""
    found: list[tuple[float, float]] = []
    down = power > DOWN * np.abs(power).max(initial=0.0)
    for low, high in pieces[down].tolist():
        if found and found[-1][1] == low:
            found[-1] = found[-1][0], high
        else:
            found.append((low, high))
    return tuple(found)
