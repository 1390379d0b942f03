"""Regular courses from a picture: bed joints, then the head joints of each course, by dynamic programming.

A joint is a narrow line that is darker or lighter than what is on both sides of it. Its strength at a place is a
second derivative across it, summed along the whole joint: noise of single pixels averages out, so that joints are found
that no eye sees in one row of pixels. Of all sets of joints with distances near the rough size of the unit the one with
the largest sum of strengths is taken. A joint that is missed makes two blocks one, which is too strong a wall; one too
many makes a block weaker. So doubtful joints are kept and reported.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy import ndimage

from concio.arguments import strict
from concio.errors import InputError
from concio.model.picture.photo import Photo
from concio.model.picture.tracing import TracedJoint, Tracing

Array = np.ndarray
SHORTEST, LONGEST = 0.2, 1.7
"""Shares of the rough size between which a unit may be; half units and closers stand in most bonds."""
DEAREST, AT_EDGE = 0.5, 0.8
"""What the oddest unit costs at most, in strengths of clear joints; and the share of a cost at an edge."""
ODD_UNIT, ODD_COURSE = 0.25, 0.6
"""What a unit, or a course, of half or twice the rough size costs, as a share of the strength of clear joints."""
PERIODS = (1, 2, 3, 4)
"""Courses after which a bond repeats its head joints."""
ALIKE = 0.05
"""Courses of a kind are alike from this correlation on."""
SHARED = 1.2
"""Weight of what the other courses of the same kind say of a head joint beside what its own course says."""
WIDTHS = (0.02, 0.04, 0.07, 0.11)
"""Widths of joints that are tried, as shares of the height of a unit."""
CLEAR, LEAST_SHARED = 6.0, 0.2
"""Where the joints of a course are clearer than this, in deviations of the noise, other courses count the less the
clearer they are, down to this share."""
SHORTEST_AT_EDGE = 0.1
"""Share of the rough size that a unit at an edge may have where its joint is clear."""
FULL, BEYOND = 12.0, 0.05
"""Strength of a joint that nobody doubts; what is beyond it counts little: it places a wide joint at its middle."""
LEAST_NOISE = 0.02
"""Noise is taken to be this share of the clearest joint at least: drawn pictures have none."""


@strict
def trace_courses(photo: Photo, unit: Sequence[float]) -> Tracing:
    """Return the blocks of regular masonry: a picture of the wall alone, its courses level.

    Parameters
    ----------
    photo : Photo
        Rectified, with its scale: its edges are those of the wall.
    unit : (length, height)
        Rough size of a unit with its joints [m].

    Returns
    -------
    Tracing
        Its joints have their strength in deviations of the noise, that of a head joint with what the other courses of
        its kind say at its place; the weakest come first.

    Raises
    ------
    InputError
        The unit is not positive, or larger than the picture.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.trace import Photo, trace_courses
    >>> grey = np.full((40, 120), 0.8)
    >>> grey[19:21] = grey[:20, 59:61] = grey[20:, 29:31] = grey[20:, 89:91] = 0.4
    >>> found = trace_courses(Photo(grey, 0.01), (0.6, 0.2))
    >>> len(found.outlines())
    5
    """
    length, height = (float(v) / photo.pixel for v in _checked(photo, unit))
    rows, columns = photo.grey.shape
    smooth = photo.grey - ndimage.uniform_filter(photo.grey, (max(3, int(height)), max(3, int(length))))
    wide, sign, beds = _beds(smooth, height)
    labels = np.zeros((rows, columns), dtype=np.int32)
    joints: list[TracedJoint] = []
    strength = _strength(smooth.mean(axis=1), wide) * sign
    noise = _noise(strength)
    for y in beds[1:-1]:
        joints.append(TracedJoint("bed", ((0.0, float(y)), (float(columns), float(y))), float(strength[y] / noise)))
    own = [_course(smooth, top, bottom, wide) * sign for top, bottom in pairwise(beds)]
    own = [profile / _noise(profile) for profile in own]
    for c, (score, shared) in enumerate(zip(own, _shared(own, wide), strict=True)):
        said = score + SHARED * _unclear(score) * shared
        heads = _best(said, length, ends=True)
        top, bottom = beds[c], beds[c + 1]
        labels[top:bottom] = labels.max() + np.searchsorted(heads[1:-1], np.arange(columns), side="right") + 1
        for x in heads[1:-1]:
            ends = ((float(x), float(top)), (float(x), float(bottom)))
            joints.append(TracedJoint("head", ends, float(said[max(0, x - 2) : x + 3].max())))
    told = [one.in_metres(photo) for one in joints]
    return Tracing(
        labels, photo, tuple(sorted(told, key=lambda one: one.strength)), _width(smooth * sign, beds) * photo.pixel
    )


def _course(smooth: Array, top: int, bottom: int, wide: float) -> Array:
    """Return how much each column of a course looks like a head joint."""
    inset = min(int(0.15 * (bottom - top)) + round(wide), (bottom - top) // 3)
    return _strength(smooth[top + inset : bottom - inset].mean(axis=0), wide)


def _unclear(score: Array) -> float:
    """Return the share of their weight that the other courses have in a course: all where its own joints are faint."""
    return float(np.clip(CLEAR / max(float(np.percentile(score, 98.0)), CLEAR), LEAST_SHARED, 1.0))


def _shared(own: list[Array], wide: float) -> list[Array]:
    """Return for each course what the other courses of its kind say, for the period of the bond that is clearest.

    Regular bonds repeat their head joints after some courses. Where these do not line up, the mean of the others has no
    clear joints, and says little.
    """
    best, told = ALIKE, [np.zeros_like(score) for score in own]
    for period in PERIODS:
        if len(own) < 2 * period:
            break
        means, alike = [], []
        for c, score in enumerate(own):
            others = [own[k] for k in range(c % period, len(own), period) if k != c]
            mean = ndimage.maximum_filter1d(np.mean(others, axis=0), max(1, round(wide)))
            mean = (mean - np.median(mean)) / max(_noise(mean), 1e-12)
            means.append(np.clip(mean, 0.0, 8.0))
            alike.append(float(np.corrcoef(np.clip(score, 0.0, 8.0), means[-1])[0, 1]))
        if float(np.mean(alike)) > best:
            best, told = float(np.mean(alike)), means
    return told


def _checked(photo: Photo, unit: Sequence[float]) -> tuple[float, float]:
    size = np.asarray(unit, dtype=float)
    fits = size.shape == (2,) and np.isfinite(size).all() and (size >= 4 * photo.pixel).all()
    if not fits or (size > np.array(photo.size)).any():
        msg = f"a unit of {list(unit)} m in a picture of {photo.size[0]:g} x {photo.size[1]:g} m"
        raise InputError(msg, hint="state length and height of a unit with its joints, in metres, above four pixels")
    return float(size[0]), float(size[1])


def _strength(profile: Array, wide: float) -> Array:
    """Return how much a profile (n,) is a narrow valley at each place: a second derivative."""
    sigma = max(0.5 * wide, 0.6)
    return np.asarray(sigma**2 * ndimage.gaussian_filter1d(profile, sigma, order=2, mode="nearest"))


def _noise(strength: Array) -> float:
    """Return the deviation of strengths where there is no joint, from the median of their sizes."""
    spread = 1.4826 * float(np.median(np.abs(strength - np.median(strength))))
    return max(spread, LEAST_NOISE * float(np.abs(strength).max()), 1e-12)


def _beds(smooth: Array, height: float) -> tuple[float, float, list[int]]:
    """Return width and sign of the joints and the rows of the bed joints with the edges, of all tried the clearest."""
    profile, best = smooth.mean(axis=1), (-np.inf, 1.0, 1.0, [0, len(smooth)])
    for share in WIDTHS:
        wide = max(1.0, share * height)
        for sign in (1.0, -1.0):
            across = sign * _strength(profile, wide)
            found = _best(across / _noise(across), height, ends=False)
            inner = found[1:-1]
            score = float(across[inner].mean() / _noise(across)) if inner else -np.inf
            best = max(best, (score, wide, sign, found))
    return best[1], best[2], best[3]


def _best(score: Array, size: float, *, ends: bool) -> list[int]:
    """Return the places of joints, with both edges: those whose scores less the cost of odd distances sum up highest.

    Parameters
    ----------
    score : (n,) array
        Strength at each place, in deviations of the noise.
    size : float
        Rough distance.
    ends : bool
        Whether a unit at an edge may be any part of a unit, as in a running bond.
    """
    n = len(score)
    share = SHORTEST if ends else 2.0 * SHORTEST
    low, high = max(2, int(share * size)), max(3, int(np.ceil(LONGEST * size)))
    least_at_edge = max(2, int(SHORTEST_AT_EDGE * size)) if ends else low
    total, before = np.full(n + 1, -np.inf), np.zeros(n + 1, dtype=int)
    total[0] = 0.0
    gain = np.append(np.clip(score, -2.0, FULL) + BEYOND * np.maximum(score - FULL, 0.0), 0.0)
    clear = max(float(np.percentile(gain[:-1], 99.0)), 1.0)
    odd = (np.log(np.arange(1, high + 1) / size) / np.log(2.0)) ** 2
    cost = np.minimum(ODD_UNIT * odd, DEAREST) * clear if ends else ODD_COURSE * odd * clear
    for at in range(least_at_edge, n + 1):
        if at < low and gain[at] < FULL:
            continue
        least, last = max(0, at - high), max(0, at - (least_at_edge if at == n else low))
        starts = np.arange(least, last + 1)
        own = cost[at - starts - 1]
        if ends and (least == 0 or at == n):  # a unit at an edge may be any part of one
            own = np.where((starts == 0) | (at == n), AT_EDGE * own, own)
        short = (at - starts < low) & (starts > 0) & (gain[starts] < FULL)
        value = np.where(short, -np.inf, total[least : last + 1] - own)
        k = int(np.argmax(value))
        total[at], before[at] = value[k] + gain[at], least + k
    found = [n]
    while found[-1] > 0:
        found.append(int(before[found[-1]]))
    return found[::-1]


def _width(valley: Array, beds: list[int]) -> float:
    """Return the width of the bed joints at half their depth [pixels]."""
    inner = beds[1:-1]
    if not inner:
        return 0.0
    reach = max(3, int(np.diff(beds).min()) // 2)
    rows = [valley[y - reach : y + reach].mean(axis=1) for y in inner if reach <= y <= len(valley) - reach]
    if not rows:
        return 0.0
    depth = -np.mean(rows, axis=0)
    depth = depth - np.median(depth)
    middle = reach - 3 + int(np.argmax(depth[max(0, reach - 3) : reach + 3]))
    half = 0.5 * depth[middle]
    left = next((k for k in range(middle, -1, -1) if depth[k] < half), 0)
    right = next((k for k in range(middle, len(depth)) if depth[k] < half), len(depth) - 1)
    return float(max(right - left - 1, 1))
