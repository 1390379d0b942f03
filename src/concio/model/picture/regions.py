"""Stones between clear joints, and outlines between clicks by the cheapest way along a joint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy import ndimage
from scipy.sparse.csgraph import dijkstra

from concio.arguments import strict
from concio.errors import InputError
from concio.model.picture.photo import Photo
from concio.model.picture.tracing import TracedJoint, Tracing

Array = np.ndarray
SHALLOW = 0.35
"""A stone is begun at each place that is as far from joints as this share of the size of a stone: a few too many."""
SMALL = 0.04
"""Regions below this share of the area of a stone are joined to a neighbour."""
DIAGONAL = float(np.sqrt(2.0))
MARGIN = 12
"""How far the way between two clicks may run beside them, in pixels, at least."""


def joint_likeness(photo: Photo, wide: float) -> Array:
    """Return how much each pixel (rows, columns) looks like a joint, 0 to 1: valleys, or clearer ridges.

    Parameters
    ----------
    photo : Photo
    wide : float
        Width of the joints [pixels].
    """
    sigma = max(0.5 * wide, 0.7)
    xx, yy, xy = (ndimage.gaussian_filter(photo.grey, sigma, order=o) for o in ((0, 2), (2, 0), (1, 1)))
    middle, apart = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    dark, light = np.clip(middle + apart, 0.0, None), np.clip(apart - middle, 0.0, None)
    found = dark if np.percentile(dark, 98) >= np.percentile(light, 98) else light
    top = float(np.percentile(found, 99)) or 1e-12
    return np.clip(found / top, 0.0, 1.0)


@strict
def trace_regions(photo: Photo, unit: float, *, joint: float | None = None) -> Tracing:
    """Return the stones between clear joints: each place far from joints begins one, and takes what it reaches first.

    Parameters
    ----------
    photo : Photo
        Its edges are those of the wall.
    unit : float
        Rough size of a stone, the side of a square [m].
    joint : float, optional
        Rough width of the joints [m]; default a tenth of the unit.

    Raises
    ------
    InputError
        The sizes are not positive, or less than some pixels.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.trace import Photo, trace_regions
    >>> grey = np.full((60, 60), 0.8)
    >>> grey[28:32] = grey[:, 28:32] = 0.3
    >>> len(trace_regions(Photo(grey, 0.01), 0.3, joint=0.04).outlines())
    4
    """
    size, wide = unit / photo.pixel, (0.1 * unit if joint is None else joint) / photo.pixel
    if not (size >= 6 and 0 < wide < size):
        msg = f"stones of {unit:g} m in pixels of {photo.pixel:g} m"
        raise InputError(msg, hint="state a size of stones above six pixels, and joints that are narrower")
    like = joint_likeness(photo, wide)
    stone = like < _threshold(like)
    away = ndimage.gaussian_filter(ndimage.distance_transform_edt(stone), 0.1 * size)
    high = ndimage.maximum_filter(away, max(3, int(SHALLOW * size))) == away
    seeds, count = ndimage.label(high & (away > 0.1 * size))
    if not count:
        seeds, count = ndimage.label(np.ones_like(stone))
    labels = _reached_first(0.02 + like, seeds)
    labels = _without_islands(_without_small(labels, SMALL * size * size))
    return Tracing(labels, photo, _doubts(labels, like, photo), _mean_width(labels, like) * photo.pixel)


def _threshold(values: Array) -> float:
    """Return Otsu's threshold: the value that parts joints from stones with the least spread within both."""
    counts, edges = np.histogram(values, 128, (0.0, 1.0))
    share = counts / counts.sum()
    middle = 0.5 * (edges[1:] + edges[:-1])
    w = np.cumsum(share)
    m = np.cumsum(share * middle)
    between = (m[-1] * w - m) ** 2 / np.maximum(w * (1.0 - w), 1e-12)
    return float(middle[int(np.argmax(between))])


def _nearest(labels: Array) -> Array:
    """Return labels in which each pixel without one has that of the nearest pixel."""
    if (labels > 0).all() or not (labels > 0).any():
        return labels
    at = ndimage.distance_transform_edt(labels == 0, return_distances=False, return_indices=True)
    return np.asarray(labels[tuple(at)])


def _without_islands(labels: Array) -> Array:
    """Return labels in which a region with a single neighbour, which has it inside, belongs to that."""
    padded = np.pad(labels, 1)
    sides: dict[int, set[int]] = {}
    for a, b in ((padded[:-1], padded[1:]), (padded[:, :-1], padded[:, 1:])):
        for i, j in np.unique(np.stack([a[a != b], b[a != b]], axis=1), axis=0).tolist():
            sides.setdefault(i, set()).add(j)
            sides.setdefault(j, set()).add(i)
    found = labels.copy()
    for label, near in sides.items():
        if label and len(near) == 1 and 0 not in near:
            found[found == label] = next(iter(near))
    return found


def _without_small(labels: Array, least: float) -> Array:
    """Return labels in which small regions belong to what is nearest, numbered from 1."""
    numbers, counts = np.unique(labels, return_counts=True)
    small = np.isin(labels, numbers[counts < least])
    if not small.all():
        labels = _nearest(np.where(small, 0, labels))
    return np.unique(labels, return_inverse=True)[1].reshape(labels.shape).astype(np.int32) + 1


def _doubts(labels: Array, like: Array, photo: Photo) -> tuple[TracedJoint, ...]:
    """Return the boundary between each two regions with the mean likeness along it, the least clear first."""
    sums: dict[tuple[int, int], list[float]] = {}
    for axis in (0, 1):
        a, b = (labels[:-1], labels[1:]) if axis == 0 else (labels[:, :-1], labels[:, 1:])
        value = np.maximum(like[:-1], like[1:]) if axis == 0 else np.maximum(like[:, :-1], like[:, 1:])
        for r, c in np.argwhere(a != b).tolist():
            key = (min(int(a[r, c]), int(b[r, c])), max(int(a[r, c]), int(b[r, c])))
            s = sums.setdefault(key, [0.0, 0.0, np.inf, np.inf, -np.inf, -np.inf])
            s[0] += float(value[r, c])
            s[1] += 1.0
            s[2:] = [min(s[2], c), min(s[3], r), max(s[4], c), max(s[5], r)]
    joints = [
        TracedJoint("joint", ((s[2] + 0.5, s[3] + 0.5), (s[4] + 0.5, s[5] + 0.5)), s[0] / s[1]).in_metres(photo)
        for s in sums.values()
    ]
    return tuple(sorted(joints, key=lambda one: one.strength))


def _mean_width(labels: Array, like: Array) -> float:
    """Return the mean width of joints [pixels]: the area that looks like one over the length of the boundaries."""
    length = float((labels[:-1] != labels[1:]).sum() + (labels[:, :-1] != labels[:, 1:]).sum()) * 0.8
    return float((like > _threshold(like)).sum()) / length if length else 0.0


@strict
def wire(photo: Photo, a: Sequence[float], b: Sequence[float], *, joint: float | None = None) -> Array:
    """Return the way (k, 2) from one point to another along what looks most like a joint [m].

    Parameters
    ----------
    photo : Photo
    a, b : (x, y)
        [m].
    joint : float, optional
        Rough width of the joints [m]; default six pixels.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.trace import Photo, wire
    >>> grey = np.full((40, 60), 0.8)
    >>> grey[18:22] = 0.3
    >>> way = wire(Photo(grey, 0.01), (0.02, 0.2), (0.58, 0.2), joint=0.04)
    >>> bool(abs(way[:, 1] - 0.2).max() < 0.03)
    True
    """
    (x0, y0), (x1, y1) = np.floor(photo.pixels(np.array([a, b], dtype=float))).astype(int).tolist()
    rows, columns = photo.grey.shape
    reach = MARGIN + int(0.5 * np.hypot(x1 - x0, y1 - y0))
    left, top = max(0, min(x0, x1) - reach), max(0, min(y0, y1) - reach)
    part = photo.grey[top : min(rows, max(y0, y1) + reach + 1), left : min(columns, max(x0, x1) + reach + 1)]
    like = joint_likeness(Photo(part, photo.pixel), 6.0 if joint is None else joint / photo.pixel)
    path = _cheapest(1.0 / (0.03 + like), (_within(y0 - top, part.shape[0]), _within(x0 - left, part.shape[1])),
                     (_within(y1 - top, part.shape[0]), _within(x1 - left, part.shape[1])))  # fmt: skip
    return photo.metres(np.column_stack([path[:, 1] + left + 0.5, path[:, 0] + top + 0.5]))


def _within(k: int, count: int) -> int:
    return min(max(k, 0), count - 1)


def _cheapest(cost: Array, start: tuple[int, int], end: tuple[int, int]) -> Array:
    """Return the cheapest way (k, 2) of rows and columns over a grid of costs, with diagonal steps."""
    graph, number = _grid(cost)
    first, last = int(number[start]), int(number[end])
    found: Any = dijkstra(graph, directed=False, indices=[first], return_predecessors=True)
    before, way = found[1][0], [last]
    while way[-1] != first:
        way.append(int(before[way[-1]]))
    return np.column_stack(np.divmod(np.array(way[::-1]), cost.shape[1]))


def _reached_first(cost: Array, seeds: Array) -> Array:
    """Return for each pixel the number of the seed from which it is reached at the least cost."""
    graph, number = _grid(cost)
    begin = number[seeds > 0]
    found: Any = dijkstra(graph, directed=False, indices=begin, min_only=True, return_predecessors=True)
    return np.asarray(seeds.ravel()[np.maximum(found[2], 0)].reshape(cost.shape))


def _grid(cost: Array) -> tuple[Any, Array]:
    """Return the graph of neighbouring pixels with the cost of each step, and the number of each pixel."""
    h, w = cost.shape
    number = np.arange(h * w).reshape(h, w)
    pairs = [(number[:, :-1], number[:, 1:], 1.0), (number[:-1], number[1:], 1.0),
             (number[:-1, :-1], number[1:, 1:], DIAGONAL), (number[:-1, 1:], number[1:, :-1], DIAGONAL)]  # fmt: skip
    flat = cost.ravel()
    i = np.concatenate([p.ravel() for p, _, _ in pairs])
    j = np.concatenate([q.ravel() for _, q, _ in pairs])
    far = np.concatenate([np.full(p.size, s) for p, _, s in pairs])
    return sp.csr_array((far * 0.5 * (flat[i] + flat[j]), (i, j)), shape=(h * w, h * w)), number


@strict
def trace_outlines(photo: Photo, clicks: Sequence[Sequence[Sequence[float]]], *, joint: float | None = None) -> Tracing:
    """Return the stones around which was clicked: between clicks the outline follows the joint.

    Where outlines of neighbours leave a strip as narrow as a joint, it is shared out, so that they have one boundary.

    Parameters
    ----------
    photo : Photo
    clicks : sequence of sequences of points
        Some points on the joint around each stone, in order [m].
    joint : float, optional
        Rough width of the joints [m]; default six pixels.

    Raises
    ------
    InputError
        A stone has less than three clicks.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.trace import Photo, trace_outlines
    >>> grey = np.full((40, 60), 0.8)
    >>> grey[8:11] = grey[29:32] = grey[:, 8:11] = grey[:, 49:52] = 0.3
    >>> clicks = [(0.095, 0.095), (0.505, 0.095), (0.505, 0.305), (0.095, 0.305)]
    >>> len(trace_outlines(Photo(grey, 0.01), [clicks], joint=0.03).outlines())
    1
    """
    import shapely

    rows, columns = photo.grey.shape
    labels = np.zeros((rows, columns), dtype=np.int32)
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    for k, own in enumerate(clicks, 1):
        if len(own) < 3:
            msg = f"stone {k} has {len(own)} clicks"
            raise InputError(msg, hint="click at least three points around it")
        way = np.concatenate(
            [wire(photo, p, q, joint=joint)[:-1] for p, q in zip(own, [*own[1:], own[0]], strict=True)]
        )
        polygon = shapely.make_valid(shapely.Polygon(photo.pixels(way)))
        inside = shapely.contains_xy(polygon, x, y)
        labels[inside & (labels == 0)] = k
    wide = 6.0 if joint is None else joint / photo.pixel
    away, at = ndimage.distance_transform_edt(labels == 0, return_indices=True)
    return Tracing(np.where(away <= wide, labels[tuple(at)], 0), photo)
