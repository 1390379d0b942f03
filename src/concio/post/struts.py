r"""How forces flow through a body: struts and ties between the points where its joints and its loads push.

The resultants of a body's joints and what else acts on it (self-weight, loads, supports) are in balance. Between their
points of application a truss holds them: every two points joined by a bar with the force s, compression positive,

.. math:: \min \sum_{ij} l_{ij}\,(s_{ij}^+ + \beta\,s_{ij}^-), \qquad
          F_i + \sum_j s_{ij}\,\frac{p_i - p_j}{l_{ij}} = 0,

which is the lightest one (Michell), bars in tension counting :data:`TIE` times. A voussoir gets the chord of the line
of thrust, a lintel two struts to its ends and the tie its bending asks for: in equilibrium with the joints exactly, and
as good a picture of the stresses inside as strut-and-tie models of beams are, which is all that resultants can tell.
Points on one line hold no force across it; there the corners of the body are joined too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.optimize as so
import scipy.sparse as sp
import shapely

from concio.kinematics.frames import cross, turned_right
from concio.model.model import Body
from concio.representation import short_repr

Array = np.ndarray

TIE = 4.0
"""What tension costs over compression: stone does not like it."""

FLAT = 0.5
"""A load enters a body where it is at least this share as far off the chord of its joints as where it leaves."""

TOGETHER = 1e-4
"""Points nearer than this share of the body's size are one."""

NEAR = 16
"""Each point is joined to so many of the nearest others: bodies with more joints are long, and forces do not jump."""

LEFT = 1e3
"""What a unit of force that no bar holds costs over a bar as long as the body."""

LEFT_OVER = 1e-9
"""Share of a body's largest force that bars may leave."""

AT_ONCE = 20_000
"""Bars in one linear programme; bodies are independent, and many small programmes are quicker than one large."""


@short_repr
@dataclass(frozen=True, eq=False)
class Pushed:
    """Points of one body and the forces that act on it there, p in all.

    Parameters
    ----------
    point : (p, 2) array
        [m].
    force : (p, 2) array
        [kN].
    corners : (c, 2) array
        Of the body [m].
    """

    point: Array
    force: Array
    corners: Array


@short_repr
@dataclass(frozen=True, eq=False)
class Struts:
    """Bars in which forces flow, k in all.

    Parameters
    ----------
    lines : (k, 2, 2) array
        [m].
    force : (k,) array
        Compression positive [kN].
    body : (k,) integer array
        Which of the bodies given each belongs to.
    """

    lines: Array
    force: Array
    body: Array


def balanced(body: Body, point: Array, force: Array) -> Pushed:
    """Return the joints' forces on a body with the resultant of what else must act on it, where that enters the body.

    Where it enters too near the chord of the two joints that carry most, it acts where its line leaves the body.

    Parameters
    ----------
    body : Body
    point, force : (p, 2) arrays
        Of the joints.
    """
    centre = body.centroid
    rest = -force.sum(axis=0)
    size = float(rest @ rest)
    if not size > (1e-9 * float(np.abs(force).sum())) ** 2:
        return Pushed(point, force, body.outline)
    arm = point - centre
    moment = -float(cross(arm, force).sum())
    at = centre + moment / size * turned_right(rest)
    far = rest / np.sqrt(size) * float(np.ptp(body.outline, axis=0).sum())
    within = shapely.Polygon(body.outline, body.holes).intersection(shapely.LineString([at - far, at + far]))
    if not within.is_empty:
        ends = shapely.get_coordinates(within)
        enters, leaves = ends[np.argsort(ends @ far)][[0, -1]]
        at = enters if len(point) < 2 or _off(enters, point, force) > FLAT * _off(leaves, point, force) else leaves
    return Pushed(np.vstack([point, at]), np.vstack([force, rest]), body.outline)


def _off(place: Array, point: Array, force: Array) -> float:
    """Return how far a place is from the line through the points (p, 2) of the two largest forces (p, 2)."""
    a, b = point[np.argsort(np.linalg.norm(force, axis=1))[-2:]]
    along, across = b - a, place - a
    return abs(float(cross(along, across))) / (float(np.hypot(*along)) or 1.0)


def struts(bodies: Sequence[Pushed]) -> Struts:
    """Return the lightest truss of each body that holds its forces.

    Parameters
    ----------
    bodies : sequence of Pushed
    """
    joined = [_joined(body) for body in bodies]
    found = _solved(joined)
    for b, (_, left) in enumerate(found):
        if left > LEFT_OVER:
            pushed = bodies[b]
            more = np.vstack([pushed.point, pushed.corners]), np.vstack([pushed.force, 0.0 * pushed.corners])
            joined[b] = _joined(Pushed(*more, pushed.corners), near=len(more[0]))
            found[b] = _solved([joined[b]])[0]
    lines = [pushed.point[bars] for pushed, bars in joined]
    number = np.repeat(np.arange(len(bodies)), [len(bars) for _, bars in joined])
    return Struts(
        np.concatenate([np.zeros((0, 2, 2)), *lines]), np.concatenate([np.zeros(0), *(s for s, _ in found)]), number
    )


def _solved(joined: Sequence[tuple[Pushed, Array]]) -> list[tuple[Array, float]]:
    """Return the bar forces of each body, and the share of its largest force that they leave."""
    found = [(np.zeros(0), 0.0)] * len(joined)
    for group in _groups([len(bars) for _, bars in joined]):
        for b, one in zip(group, _lightest([joined[b] for b in group]), strict=True):
            found[b] = one
    return found


def _joined(body: Pushed, near: int = NEAR) -> tuple[Pushed, Array]:
    """Return a body with points that coincide made one, and the bars (k, 2) from each to the nearest others."""
    point, force = body.point, body.force
    size = float(np.ptp(point, axis=0).max(initial=0.0))
    kept: list[int] = []
    of = np.zeros(len(point), dtype=int)
    for i, p in enumerate(point):
        same = [k for k, j in enumerate(kept) if np.abs(point[j] - p).max() <= TOGETHER * size]
        of[i] = same[0] if same else len(kept)
        if not same:
            kept.append(i)
    summed = np.zeros((len(kept), 2))
    np.add.at(summed, of, force)
    point = point[kept]
    apart = np.linalg.norm(point[:, None] - point[None], axis=2)
    rank = np.argsort(np.argsort(apart, axis=1), axis=1)
    return Pushed(point, summed, body.corners), np.argwhere(np.triu((rank <= near) | (near >= rank.T), 1))


def _groups(bars: Sequence[int]) -> list[list[int]]:
    """Return bodies in groups whose numbers of bars add up to no more than one programme takes."""
    groups: list[list[int]] = []
    total = 0
    for b, count in enumerate(bars):
        if not count:
            continue
        if not groups or total + count > AT_ONCE:
            groups.append([])
            total = 0
        groups[-1].append(b)
        total += count
    return groups


def _lightest(bodies: Sequence[tuple[Pushed, Array]]) -> list[tuple[Array, float]]:
    """Return what :func:`_solved` does for a few bodies, by one linear programme of independent parts."""
    blocks, right, cost = [], [], []
    for pushed, bars in bodies:
        arm = pushed.point[bars[:, 0]] - pushed.point[bars[:, 1]]
        length = np.linalg.norm(arm, axis=1)
        k, size = np.arange(len(bars)), float(length.max())
        matrix = np.zeros((2 * len(pushed.point), len(bars)))
        for axis in (0, 1):
            matrix[2 * bars[:, 0] + axis, k] = arm[:, axis] / length
            matrix[2 * bars[:, 1] + axis, k] = -arm[:, axis] / length
        one = np.eye(len(matrix))
        unit = float(np.abs(pushed.force).max()) or 1.0  # forces that are all zero need no bars
        blocks.append(np.hstack([matrix, -matrix, one, -one]))
        right.append(-pushed.force.ravel() / unit)
        cost += [length / size, TIE * length / size, np.full(2 * len(matrix), LEFT)]
    programme: Any = so.linprog
    found = programme(np.concatenate(cost), A_eq=sp.block_diag(blocks, format="csc"), b_eq=np.concatenate(right))
    forces, at = [], 0
    for (pushed, bars), block in zip(bodies, blocks, strict=True):
        own = found.x[at : at + block.shape[1]]
        plus, minus = own[: 2 * len(bars)].reshape(2, -1)
        forces.append(((plus - minus) * float(np.abs(pushed.force).max()), float(own[2 * len(bars) :].max())))
        at += block.shape[1]
    return forces
