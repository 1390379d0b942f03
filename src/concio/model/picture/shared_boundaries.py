"""Shared boundaries of regions of pixels: each arc between two junctions is simplified once, for both its regions."""

from __future__ import annotations

from collections import defaultdict
from itertools import pairwise

import numpy as np

from concio.kinematics.frames import cross

Array = np.ndarray
Corner = tuple[int, int]


def shared_outlines(labels: Array, tolerance: float) -> dict[int, Array]:
    """Return the outer outline (n, 2) of each region, counter-clockwise seen with rows upwards [columns, rows].

    Parameters
    ----------
    labels : (rows, columns) integer array
        0 is outside.
    tolerance : float
        Largest distance of a simplified arc from that of the pixels [pixels].
    """
    padded = np.pad(np.asarray(labels), 1)
    after = _directed_edges(padded)
    junctions = _junctions(padded)
    arcs: dict[tuple[Corner, ...], Array] = {}
    found = {}
    for label in np.unique(labels[labels > 0]).tolist():
        ring = max(_rings(after[label]), key=lambda r: abs(_area(np.array(r))))
        pieces = [_simplified(piece, tolerance, arcs) for piece in _cut(ring, junctions)]
        points = np.concatenate([piece[:-1] for piece in pieces]).astype(float)
        keep = (np.abs(points - np.roll(points, 1, axis=0)) > 0).any(axis=1)
        points = points[keep] - 1.0
        found[label] = points if _area(points * [1, -1]) > 0 else points[::-1]
    return {label: ring for label, ring in found.items() if len(ring) > 2}


def _directed_edges(padded: Array) -> dict[int, dict[Corner, list[Corner]]]:
    """Return, for each label, where its boundary goes on from each corner, its pixels on the right."""
    after: dict[int, dict[Corner, list[Corner]]] = defaultdict(lambda: defaultdict(list))
    up, down = padded[:-1], padded[1:]
    for r, c in np.argwhere(up != down).tolist():  # the edge below pixel (r, c), from column c to c + 1 at row r + 1
        if up[r, c]:
            after[int(up[r, c])][c + 1, r + 1].append((c, r + 1))
        if down[r, c]:
            after[int(down[r, c])][c, r + 1].append((c + 1, r + 1))
    left, right = padded[:, :-1], padded[:, 1:]
    for r, c in np.argwhere(left != right).tolist():  # the edge right of pixel (r, c)
        if left[r, c]:
            after[int(left[r, c])][c + 1, r].append((c + 1, r + 1))
        if right[r, c]:
            after[int(right[r, c])][c + 1, r + 1].append((c + 1, r))
    return after


def _junctions(padded: Array) -> set[Corner]:
    """Return the corners at which three or more regions meet, or two meet crosswise."""
    four = np.stack([padded[:-1, :-1], padded[:-1, 1:], padded[1:, 1:], padded[1:, :-1]])
    kinds = (four != np.roll(four, 1, axis=0)).sum(axis=0)
    return {(c + 1, r + 1) for r, c in np.argwhere(kinds > 2).tolist()}


def _rings(after: dict[Corner, list[Corner]]) -> list[list[Corner]]:
    """Return the closed boundaries of one region; where it touches itself at a corner it turns to stay apart."""
    left = {corner: list(ends) for corner, ends in after.items()}
    rings = []
    for start in list(left):
        while left[start]:
            ring, at = [start], left[start].pop()
            while at != start:
                before = ring[-1]
                ring.append(at)
                ends = left[at]
                way = (at[0] - before[0], at[1] - before[1])
                right = (at[0] - way[1], at[1] + way[0])
                at = ends.pop(ends.index(right)) if right in ends else ends.pop()
            rings.append(ring)
    return rings


def _cut(ring: list[Corner], junctions: set[Corner]) -> list[list[Corner]]:
    """Return the arcs of a ring between junctions, each with both its ends; without any, of a cut ring."""
    cuts = [k for k, corner in enumerate(ring) if corner in junctions]
    if len(cuts) < 2:
        first = cuts[0] if cuts else ring.index(min(ring))
        turned = ring[first:] + ring[:first]
        far = max(range(len(turned)), key=lambda k: abs(turned[k][0] - turned[0][0]) + abs(turned[k][1] - turned[0][1]))
        return [turned[: far + 1], [*turned[far:], turned[0]]]
    turned = ring[cuts[0] :] + ring[: cuts[0]]
    marks = [k - cuts[0] for k in cuts] + [len(ring)]
    closed = [*turned, turned[0]]
    return [closed[a : b + 1] for a, b in pairwise(marks)]


def _simplified(arc: list[Corner], tolerance: float, known: dict[tuple[Corner, ...], Array]) -> Array:
    """Return an arc with fewer points; the arc of the neighbour, run backwards, gives the same points."""
    forward = tuple(arc)
    backward = forward[::-1]
    if backward in known:
        return known[backward][::-1]
    if forward not in known:
        known[forward] = _fewer(np.array(min(forward, backward)), tolerance)
        if min(forward, backward) != forward:
            known[forward] = known[forward][::-1]
    return known[forward]


def _fewer(points: Array, tolerance: float) -> Array:
    """Return the points (n, 2) that Douglas and Peucker's rule keeps; both ends stay."""
    keep, todo = {0, len(points) - 1}, [(0, len(points) - 1)]
    while todo:
        a, b = todo.pop()
        if b - a < 2:
            continue
        base, inner = points[b] - points[a], points[a + 1 : b] - points[a]
        long = float(np.hypot(*base))
        away = np.hypot(*inner.T) if long == 0 else np.abs(cross(base, inner)) / long
        k = int(np.argmax(away))
        if away[k] > tolerance:
            keep.add(a + 1 + k)
            todo += [(a, a + 1 + k), (a + 1 + k, b)]
    return np.asarray(points[sorted(keep)])


def _area(ring: Array) -> float:
    x, y = ring[:, 0].astype(float), ring[:, 1].astype(float)
    return float(0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum())
