"""Corners in the plane that touch another body where no joint was made: every such place, with the bodies.

Two outlines that touch do so at a corner of one of them. So every corner is examined with the edges within its reach;
it is reported unless a joint of the same two bodies covers the place, another near miss tells of it, or it is a corner
on a corner at which joints with other bodies connect the two (:mod:`concio.model.interfaces.meeting`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from concio.model.interfaces.faces import spread
from concio.model.interfaces.facing import Edges, FacingPairs
from concio.model.interfaces.meeting import connected_at
from concio.model.interfaces.near import NearMiss
from concio.model.model import Array, Body


def find_corner_touches(
    bodies: Sequence[Body],
    edges: Edges,
    joints: FacingPairs,
    known: Sequence[NearMiss],
    overlapping: set[tuple[int, int]],
    reach: Array,
) -> list[NearMiss]:
    """Return the corners that lie on another body without a joint, a near miss each place.

    Parameters
    ----------
    bodies : sequence of Body
    edges : Edges
    joints : FacingPairs
        The joints that were made.
    known : sequence of NearMiss
        What was reported already; a corner at such a place is not reported again.
    overlapping : set of (int, int)
        Pairs of bodies that overlap, of which only that is reported.
    reach : (n,) array
        How far from each body another still touches it; the smaller of two counts [m].
    """
    lines = shapely.linestrings(np.stack([edges.start, edges.end], 1))
    corner = shapely.points(edges.start)
    c, e = shapely.STRtree(lines).query(corner, predicate="dwithin", distance=reach[edges.body])
    own, other = edges.body[c], edges.body[e]
    near = np.minimum(reach[own], reach[other])
    some = (own != other) & ~(edges.fixed[c] & edges.fixed[e])
    c, e, near = c[some], e[some], near[some]
    at, gap, end = _foot(edges, c, e)
    some = gap <= near
    some &= ~_covered(joints, len(bodies), edges.body[c], edges.body[e], at, 2 * near)
    c, e, near, at, gap, end = (v[some] for v in (c, e, near, at, gap, end))
    if not len(c):
        return []
    pair = np.sort(np.stack([edges.body[c], edges.body[e]], 1), axis=1)
    blunt = end <= 2 * near  # a corner on a corner
    place, joint = _joints_at(joints, at[blunt], 2 * near[blunt])
    idle = np.zeros(len(c), dtype=bool)
    one = np.arange(len(bodies))
    fixed = np.array([b.kind == "fixed" for b in bodies])
    one[fixed] = int(np.argmax(fixed))  # fixed bodies are one: what stands on one of them stands on all
    idle[blunt] = connected_at(one[pair[blunt]], place, one[joints.bodies[joint]], len(bodies))
    return _told(bodies, np.flatnonzero(~idle), pair, at, gap, near, known, overlapping)


def _foot(edges: Edges, c: Array, e: Array) -> tuple[Array, Array, Array]:
    """Return the nearest points (k, 2) of edges to corners, the distances (k,), and how far from an end they are."""
    start, along = edges.start[e], edges.end[e] - edges.start[e]
    arm = edges.start[c] - start
    length2 = (along * along).sum(1)
    share = np.clip((arm * along).sum(1) / length2, 0.0, 1.0)
    gap = np.hypot(*(arm - share[:, None] * along).T)
    return edges.start[c], gap, np.minimum(share, 1 - share) * np.sqrt(length2)


def _covered(joints: FacingPairs, count: int, a: Array, b: Array, at: Array, near: Array) -> Array:
    """Return at which places (k, 2) bodies a, b (k,) have a joint of their own."""
    code = joints.bodies[:, 0].astype(np.int64) * count + joints.bodies[:, 1]
    order = np.argsort(code, kind="stable")
    wanted = np.minimum(a, b).astype(np.int64) * count + np.maximum(a, b)
    first = np.searchsorted(code[order], wanted)
    number = np.searchsorted(code[order], wanted, side="right") - first
    index, owner = spread(first, number)
    joint = order[index]
    inside = _distance(joints, joint, at[owner]) <= near[owner]
    return np.asarray(np.bincount(owner[inside], minlength=len(at)) > 0)


def _distance(joints: FacingPairs, joint: Array, at: Array) -> Array:
    start, along = joints.a_lo[joint], joints.a_hi[joint] - joints.a_lo[joint]
    arm = at - start
    share = np.clip((arm * along).sum(1) / np.maximum((along * along).sum(1), 1e-300), 0.0, 1.0)
    return np.asarray(np.hypot(*(arm - share[:, None] * along).T))


def _joints_at(joints: FacingPairs, at: Array, near: Array) -> tuple[Array, Array]:
    """Return which joints come within ``near`` of which places: numbers of places and of joints."""
    if not len(at) or not len(joints.lo):
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    tree = shapely.STRtree(shapely.linestrings(np.stack([joints.a_lo, joints.a_hi], 1)))
    place, joint = tree.query(shapely.points(at), predicate="dwithin", distance=near)
    return place, joint


def _told(
    bodies: Sequence[Body], which: Array, pair: Array, at: Array, gap: Array, near: Array,
    known: Sequence[NearMiss], overlapping: set[tuple[int, int]],
) -> list[NearMiss]:  # fmt: skip
    """Return a near miss for each place, without those reported already."""
    places: dict[tuple[int, int], list[tuple[Array, float]]] = {}
    for miss in (m for m in known if m.touches):
        places.setdefault(miss.bodies, []).append((miss.at, 0.5 * miss.length))
    found = []
    for k in which.tolist():
        both = (int(pair[k, 0]), int(pair[k, 1]))
        own = places.setdefault(both, [])
        if both in overlapping or any(np.hypot(*(at[k] - x)) <= r + 2 * near[k] for x, r in own):
            continue
        own.append((at[k], 0.0))
        a, b = (bodies[i] for i in both)
        found.append(
            NearMiss.of(
                "corner", a, b, both, at[k], gap=float(gap[k]), length=0.0, joined=0.0, angle=0.0,
                within=float(near[k]),
            )
        )  # fmt: skip
    return sorted(found, key=lambda miss: (miss.bodies, tuple(miss.at)))
