r"""What a joint point may carry, as sums of rays: :math:`F = F_0 + \sum p_j r_j`, p >= 0, some sums of p bounded.

The strength domain -T <= p <= N, |s| <= c + mu p is a cone cut off at p = -T, where the disc |s| <= e = c - mu T is
left: F = -T n + sum s_i u_i + sum p_i (n + mu u_i) with sum s_i <= e and sum p_i <= N + T. In the plane the u_i are the
two directions of the joint, and this is the domain itself. In space they are those of a polygon inside or round a
circle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from concio.kinematics.frames import cross as turned
from concio.proof.verify import strength, vector

Side = Literal["inside", "outside"]
Vector = list[Fraction]

AROUND = 12
"""Directions round a circle that are spread evenly."""
NEAR = 1e-3
"""Angle between the directions beside that in which a joint slides or is pulled [rad]."""
WITHIN = 1e-12
"""Share by which a polygon is drawn inwards or outwards, so that rounding leaves it on its side of the circle."""


@dataclass(frozen=True)
class Ray:
    """A force that a joint may carry any share of, and the sums in which that share counts."""

    joint: int
    force: Vector
    sums: tuple[int, ...] = ()


@dataclass(frozen=True)
class JointRays:
    """Rays of one joint point.

    Parameters
    ----------
    base : vector
        Force where every share is 0.
    rays : list of (force, sums)
        With the sums of this joint in which the share counts; a force of nothing is the slack of a sum.
    most : list of Fraction
        What each sum is equal to.
    """

    base: Vector
    rays: list[tuple[Vector, tuple[int, ...]]]
    most: list[Fraction]


def joint_rays(
    joint: Mapping[str, Any], side: Side, toward: Sequence[float] | np.ndarray | None, wider: Fraction = Fraction(0)
) -> JointRays:
    """Return the rays of a joint point; in space inside or round its cone, more of them near a direction.

    Parameters
    ----------
    joint : mapping
        Of :func:`concio.proof.statement.statement`.
    side : {"inside", "outside"}
    toward : (d,) vector, optional
    wider : Fraction
        Share by which friction is taken larger than it is.
    """
    n = vector(joint["normal"])
    mu, cohesion, tension, cap = strength(dict(joint))
    nothing = [Fraction(0)] * len(n)
    if tension < 0:  # held both ways
        return JointRays(nothing, [(n, ()), ([-x for x in n], ())], [])
    left = max(cohesion - mu * tension, Fraction(0))
    mu *= 1 + wider
    around = _around(n, side, toward) if mu or left else []
    cone = [[p + mu * q for p, q in zip(n, u, strict=True)] for u in around] if mu else [n]
    rays: list[tuple[Vector, tuple[int, ...]]] = []
    most: list[Fraction] = []
    if left:
        rays += [(u, (0,)) for u in [*around, nothing]]
        most.append(left)
    bounded = (len(most),) if cap >= 0 else ()
    rays += [(ray, bounded) for ray in cone]
    if bounded:
        rays.append((nothing, bounded))
        most.append(cap + tension)
    return JointRays([-tension * x for x in n], rays, most)


def _around(n: Vector, side: Side, toward: Sequence[float] | np.ndarray | None) -> list[Vector]:
    """Return directions at right angles to n and as long: two in the plane, in space the corners of a polygon."""
    if len(n) == 2:
        return [[-s * n[1], s * n[0]] for s in (Fraction(1), Fraction(-1))]
    t1, t2 = _tangents(n)
    angles = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    if toward is not None and np.any(toward):
        a, b = (float(np.dot([float(x) for x in t], toward)) for t in (t1, t2))
        near = np.arctan2(b, a) + NEAR * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
        angles = np.sort(np.concatenate([angles, near]) % (2 * np.pi))
    radius = np.full(len(angles), 1.0 - WITHIN)
    if side == "outside":  # corners of the polygon of tangents at these angles
        half = np.diff(np.append(angles, angles[0] + 2.0 * np.pi)) / 2.0
        angles, radius = angles + half, (1.0 + WITHIN) / np.cos(half)
    return [
        [Fraction(float(c)) * x + Fraction(float(s)) * y for x, y in zip(t1, t2, strict=True)]
        for c, s in zip(radius * np.cos(angles), radius * np.sin(angles), strict=True)
    ]


def _tangents(n: Vector) -> tuple[Vector, Vector]:
    """Return two vectors at right angles to n and to each other to rounding, as long as n, with short fractions."""
    normal = np.array([float(x) for x in n])
    first = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = first - (first @ normal) / (normal @ normal) * normal
    first *= np.linalg.norm(normal) / np.linalg.norm(first)
    second = turned(normal, first) / np.linalg.norm(normal)
    return [Fraction(float(x)) for x in first], [Fraction(float(x)) for x in second]
