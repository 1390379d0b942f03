"""Where a structure has openings, returns and cross walls, read from the places of its blocks.

A *leaf* is a row of blocks that lie in one range along the push; in the plane, and along the push itself, all blocks of
a structure are one. At every height where blocks begin or end, what a leaf leaves free between two of its blocks is
part of an opening; pieces that lie above each other are one opening, and its *lines* are its two sides.

A *return*, or cross wall, is a range across the push in which much more of a straight line along the push lies in
blocks than elsewhere: the thickness of the facade there is that of a wall seen from its end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from concio.contact.separate import surroundings
from concio.model.model import Model

Array = np.ndarray

WIDE = 0.01
"""What is free between two blocks is an opening from this share of the length of the structure on."""

THIN = 1e-3
"""Ranges between edges of blocks below this share of the structure, by which drawings are out, are not examined."""

DEEPER = 1.5
"""Times the least that lies in blocks along the push from which on there is a return."""


@dataclass(frozen=True)
class Opening:
    """What a leaf leaves free between blocks.

    Parameters
    ----------
    sides : (float, float)
        Along the axis of the leaf [m].
    heights : (float, float)
        From where to where [m].
    """

    sides: tuple[float, float]
    heights: tuple[float, float]


def spans_along(model: Model, bodies: Sequence[int], axis: Array) -> Array:
    """Return where bodies begin and end along an axis, (n, 2) [m]."""
    return np.array([(s.min(), s.max()) for s in (np.asarray(model.bodies[i].vertices) @ axis for i in bodies)])


def returns_of(model: Model, bodies: Sequence[int], along: Array, across: Array) -> tuple[tuple[float, float], ...]:
    """Return the ranges across the push (from, to) [m] in which a return or cross wall stands.

    Parameters
    ----------
    model : Model
        In space.
    bodies : sequence of int
    along, across : (3,) arrays
        Horizontal unit vectors, with and across the push.
    """
    place, depth = spans_along(model, bodies, across), spans_along(model, bodies, along)
    edges = _edges(place)
    within = [(a, b, _covered(depth[(place[:, 0] < m) & (place[:, 1] > m)])) for a, b, m in _cells(edges)]
    filled = [(a, b, size) for a, b, size in within if size > 0]
    least, thin = min((size for _, _, size in filled), default=0.0), THIN * float(np.ptp(place))
    found: list[tuple[float, float]] = []
    for a, b, size in filled:
        if size <= DEEPER * least:
            continue
        if found and a - found[-1][1] <= thin:
            found[-1] = found[-1][0], b
        else:
            found.append((a, b))
    return tuple(found)


def leaves_of(model: Model, bodies: Sequence[int], along: Array, across: Array) -> tuple[tuple[int, ...], ...]:
    """Return the bodies of each wall across the push, those of cross walls that stand in its range among them.

    Parameters
    ----------
    model : Model
        In space.
    bodies : sequence of int
    along, across : (3,) arrays
    """
    place, depth = spans_along(model, bodies, across), spans_along(model, bodies, along)
    cross = returns_of(model, bodies, along, across)
    middle = place.mean(axis=1)
    own = ~np.array([any(a <= m <= b for a, b in cross) for m in middle], dtype=bool)
    ranges: list[list[float]] = []
    near = 1e-6 * surroundings(model).of(bodies)
    for low, high in sorted(map(tuple, depth[own])):
        if ranges and low < ranges[-1][1] - near:
            ranges[-1][1] = max(ranges[-1][1], high)
        else:
            ranges.append([low, high])
    return tuple(tuple(int(bodies[k]) for k in np.flatnonzero((depth[:, 0] < b) & (depth[:, 1] > a)).tolist())
                 for a, b in ranges)  # fmt: skip


def openings_of(model: Model, bodies: Sequence[int], axis: Array) -> tuple[Opening, ...]:
    """Return the openings of a leaf.

    Parameters
    ----------
    model : Model
    bodies : sequence of int
        Of the leaf.
    axis : (d,) array
        Horizontal unit vector along it.
    """
    up = np.zeros(model.dim)
    up[-1] = 1.0
    place, height = spans_along(model, bodies, axis), spans_along(model, bodies, up)
    wide, thin, tall = WIDE * float(np.ptp(place)), THIN * float(np.ptp(height)), WIDE * float(np.ptp(height))
    found: list[Opening] = []
    for low, high, middle in _cells(_edges(height)):
        row = place[(height[:, 0] < middle) & (height[:, 1] > middle)]
        for a, b in _free(row, wide):
            under = [o for o in found if low - o.heights[1] <= thin and o.sides[0] < b and o.sides[1] > a]
            sides = min([a, *(o.sides[0] for o in under)]), max([b, *(o.sides[1] for o in under)])
            found = [o for o in found if o not in under]
            found.append(Opening(sides, (min((o.heights[0] for o in under), default=low), high)))
    return tuple(o for o in found if o.heights[1] - o.heights[0] > tall)


def _edges(spans: Array) -> Array:
    """Return where anything begins or ends, in rising order, those within rounding once."""
    every = np.sort(spans.ravel())
    return np.asarray(every[np.diff(every, prepend=-np.inf) > 1e-6 * (float(np.ptp(every)) or 1.0)])


def _cells(edges: Array) -> list[tuple[float, float, float]]:
    """Return (from, to, middle) of the ranges between edges but for thin ones."""
    thin = THIN * float(np.ptp(edges)) if len(edges) else 0.0
    return [(float(a), float(b), float(a + b) / 2) for a, b in pairwise(edges) if b - a > thin]


def _covered(spans: Array) -> float:
    """Return the length that lies in at least one of some ranges (n, 2)."""
    total, reached = 0.0, -np.inf
    for low, high in sorted(map(tuple, spans)):
        total += max(high - max(low, reached), 0.0)
        reached = max(reached, high)
    return float(total)


def _free(spans: Array, wide: float) -> list[tuple[float, float]]:
    """Return what lies between ranges (n, 2) and in none of them, from a width on."""
    found, reached = [], np.inf
    for low, high in sorted(map(tuple, spans)):
        if low - reached > wide:
            found.append((float(reached), float(low)))
        reached = high if reached == np.inf else max(reached, high)
    return found
