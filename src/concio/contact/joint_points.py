r"""Contact points along a joint between two sides that are not meshed, and the share of its length each stands for.

*Hard joints* have one at each end, *compliant* ones five with Simpson's weights. *Crushing* joints need more: on a
joint of width w whose pressure is at most p, a force at the distance d from one edge is carried up to 2 d p, by a strip
of the width 2 d at the edge (for d below w/2). Points equally far from each other see that strip only where it is much
wider than their distance: 9 of them carry 0.67 to 1.24 times as much for d/w between 0.1 and 0.02.

So the shares c_i grow from the edge inwards by one ratio r. A number of full shares, C = c_0 + ... + c_k, carries
exactly C p, and is exact where :math:`\sum c_i d_i = C^2/2`. Between two full shares less is carried, by at most
:math:`(r-1)^2/4r` (where the share begun is filled to 1/(1+r)). The points are moved outwards by half of that,

.. math:: \sum_{i \le k} c_i d_i = \tfrac{1}{2} C^2 (1 - \varepsilon), \qquad \varepsilon = \frac{(r-1)^2}{8 r},

so that the strength is at most :math:`\varepsilon` above or below; the innermost point stands where second moments are
exact, which costs another half of that. The first point is the edge itself, or no hinge would lie there, and the second
has the same share, with which the strength is exact where both are full. There the rule ends: of forces nearer
to the edge than the first share, c_0 of the length, the strength is too large, by at most c_0 of that of the whole
joint.
"""

from __future__ import annotations

from functools import cache

import numpy as np

Array = np.ndarray

EDGE = 0.02
"""Share of the length of a crushing joint that the point at its edge stands for; more with few points: :func:`edge`."""

HARD, COMPLIANT, CRUSHING = 2, 5, 20
"""Points along a joint in the plane."""

LEAST_GRADED = 8
"""Fewer points are not graded: their shares would grow too fast."""


def points_along(compressive_strength: float | None, normal_stiffness: float | None) -> int:
    """Return how many contact points a joint of two rigid sides in the plane gets under a law."""
    return CRUSHING if compressive_strength is not None else COMPLIANT if normal_stiffness is not None else HARD


@cache
def joint_rule(points: int) -> tuple[Array, Array]:
    """Return places (points,) along a joint of length 1, ends included, and their shares (points,), which sum to 1.

    Parameters
    ----------
    points : int
        2 (trapezium), an odd number (Simpson) or an even number from 8 on (graded towards the ends).
    """
    if points == HARD:
        return np.array([0.0, 1.0]), np.array([0.5, 0.5])
    if points % 2 == 0:
        return graded_rule(points)
    weights = np.ones(points)
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    return np.linspace(0.0, 1.0, points), weights / (3.0 * (points - 1))


@cache
def graded_rule(points: int) -> tuple[Array, Array]:
    """Return an even number of places on [0, 1] graded towards both ends, and their shares.

    Raises
    ------
    ValueError
        The number is odd or less than :data:`LEAST_GRADED`.
    """
    if points % 2 or points < LEAST_GRADED:
        msg = f"{points} points cannot be graded: an even number from {LEAST_GRADED} on can"
        raise ValueError(msg)
    x, share = graded_half(points // 2)
    return np.concatenate([0.5 * x, 1.0 - 0.5 * x[::-1]]), np.concatenate([0.5 * share, 0.5 * share[::-1]])


@cache
def graded_half(points: int) -> tuple[Array, Array]:
    """Return the same for one half of a joint, the edge at 0 and the middle at 1, where no point stands."""
    full = 4 * edge(2 * points) * _ratio(points) ** (np.arange(points) - 1.0)
    full[0], full[-1] = 2 * edge(2 * points), 1.0
    ratio = _ratio(points)
    moment = 0.5 * full**2 * (1 - (ratio - 1) ** 2 / (8 * ratio))
    moment[0] = 0.0
    share = np.diff(full, prepend=0.0)
    x = np.diff(moment, prepend=0.0) / share
    x[-1] = 1.0 - np.sqrt((1.0 / 3.0 - share[:-1] @ (1.0 - x[:-1]) ** 2) / share[-1])  # exact second moments
    return x, share


def edge(points: int) -> float:
    """Return the share of the length that the point at an edge stands for, of so many graded points."""
    return max(EDGE, 4.0 / points**2)


def graded_error(points: int) -> float:
    """Return the largest relative error of the strength of a crushing joint, to either side, of so many graded points.

    Of forces that act further from the edge than :func:`edge` of the length.
    """
    ratio = _ratio(points // 2)
    return 1.6 * (ratio - 1) ** 2 / (8 * ratio)


def _ratio(half: int) -> float:
    return float((0.25 / edge(2 * half)) ** (1 / (half - 2)))
