"""Interfaces between blocks, found from their outlines alone.

Two edges of two bodies form an interface where they *face* each other: outward normals opposite within an angle,
distance within the tolerance (or, where the user asks for pairs with an initial gap, within the reach), and a common
length above the sliver threshold. The common length is measured on the mean direction ``t`` of the two edges; with the
mean normal ``n`` from a to b, the gap

    g(s) = n . (x_b(s) - x_a(s))

is linear along the common length, and the interface is the part of it that does not overlap (``g >= -tolerance``) of
edges that come near each other anywhere: within :data:`REACH_SHARE` of the smaller body's size. A gap that is there at
first is a gap of the interface, so a block on a tilted foot stands where it comes to rest, whatever the tilt. A reach
given in metres cuts interfaces off where the gap exceeds it. T-joints, partial contact, wedge-shaped gaps and edges
split by vertices need no cases of their own.

Nothing is dropped in silence. What nearly was an interface and what overlaps is in the report of
:class:`Detection`: slivers, edges a little too far apart or at too large an angle, joints of which only a part touches,
corners that touch another body without a joint, and areas covered twice.

All candidate pairs come from a bulk query of an R-tree of edges (shapely) and are judged together in numpy; there is no
Python loop over pairs of edges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from concio.errors import InputError
from concio.model.interfaces.corners import find_corner_touches
from concio.model.interfaces.facing import Edges, FacingPairs, facing_pairs
from concio.model.interfaces.near import MissKind, NearMiss, Overlap, find_overlaps, size_of_bodies
from concio.model.interfaces.point_contact import PointContact
from concio.model.interfaces.sight import visible_parts
from concio.model.linked import linked, pairs_within
from concio.model.model import Array, Body
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.model.interfaces.patch import Patch

FACING_ANGLE = np.deg2rad(20.0)
"""Edges turned against each other by more than this are not joined; they touch with a corner [rad]."""
NEAR_ANGLE = np.deg2rad(20.0)
"""Edges that touch and are turned by less than this are reported as a near miss, where they are not joined [rad]."""
SLIVER_SHARE = 1e-3
"""A common length below this share of the smaller body's size (root of its area) is a sliver."""
REACH_SHARE = 1e-3
"""Faces that come as near as this share of the smaller body's size touch, where no reach is given."""
NEAR_SHARE = 0.05
"""Facing edges within this share of the smaller body's size are reported when they are not joined."""


@short_repr
@dataclass(frozen=True, eq=False, slots=True)
class Interface:
    """The common segment of two edges that face each other.

    Parameters
    ----------
    a, b : int
        Indices of the bodies, ``a < b``.
    edge_a, edge_b : int
        Indices of the edges; edge k of an outline goes from vertex k to vertex k + 1.
    start, end : (2,) arrays
        Ends of the segment on the edge of ``a`` [m]; from start to end runs the tangent ``(-n_y, n_x)``.
    normal : (2,) array
        Unit normal from a to b.
    gap : (2,) array
        Initial gap at start and end, zero or positive [m]; zero wherever the edges are within the tolerance.
    signed_gap : (2,) array
        Distance as drawn, negative where the edges overlap (by at most the tolerance) [m].
    length : float
        Length of the segment [m].
    shift : (x, y)
        Where the image of ``b`` stands that ``a`` touches, from ``b`` itself; not zero across an edge of a periodic
        cell, where ``a`` may be ``b`` [m].
    """

    a: int
    b: int
    edge_a: int
    edge_b: int
    start: Array
    end: Array
    normal: Array
    gap: Array
    signed_gap: Array
    length: float
    shift: tuple[float, float] = (0.0, 0.0)

    dim: ClassVar[int] = 2

    @property
    def size(self) -> float:
        """Length [m]."""
        return self.length

    @property
    def width(self) -> float:
        """Length [m]; what a motion is large beside."""
        return self.length


@short_repr
@dataclass(frozen=True)
class Detection:
    """Interfaces found, and a report of everything that came close or is wrong.

    Parameters
    ----------
    interfaces : tuple of Interface, in space of Patch, then of PointContact
        In order of the bodies a, b and of their edges or faces; after them the contacts at corners and along edges.
    near_misses : tuple of NearMiss
        Every place where bodies come near each other or touch without a joint, or have one of a part only: with the
        bodies, the place and a sentence.
    overlaps : tuple of Overlap
    """

    interfaces: tuple[Interface | Patch | PointContact, ...]
    near_misses: tuple[NearMiss, ...] = ()
    overlaps: tuple[Overlap, ...] = ()

    @property
    def segments(self) -> tuple[Interface, ...]:
        """The interfaces of a plane model; none in space."""
        return tuple(i for i in self.interfaces if isinstance(i, Interface))

    @property
    def patches(self) -> tuple[Patch, ...]:
        """The interfaces of a model in space; none in the plane."""
        return tuple(i for i in self.interfaces if not isinstance(i, Interface | PointContact))

    @property
    def faces(self) -> tuple[Interface | Patch, ...]:
        """The interfaces with a length or an area: segments or patches."""
        return tuple(i for i in self.interfaces if not isinstance(i, PointContact))

    @property
    def point_contacts(self) -> tuple[PointContact, ...]:
        """The contacts at corners and along edges, which have no area."""
        return tuple(i for i in self.interfaces if isinstance(i, PointContact))

    @property
    def not_made(self) -> tuple[NearMiss, ...]:
        """The places where two bodies touch and no joint was made: a verdict holds for the joints that were made."""
        return tuple(m for m in self.near_misses if m.touches and not m.made)

    def report(self) -> tuple[str, ...]:
        """Return one sentence for each overlap and each near miss, overlaps first."""
        return tuple(o.sentence for o in self.overlaps) + tuple(m.sentence for m in self.near_misses)


def default_tolerance(bodies: Sequence[Body]) -> float:
    """Return 1e-6 of the longer side of the box around all bodies [m]."""
    corners = np.array([(b.outline.min(0), b.outline.max(0)) for b in bodies])
    return 1e-6 * float((corners[:, 1].max(0) - corners[:, 0].min(0)).max())


def check_distances(tolerance: float, reach: float | None) -> None:
    """Raise InputError where the tolerance is not positive, or a reach is negative or not finite [m]."""
    if not (0 < tolerance < np.inf):
        msg = f"gap tolerance = {tolerance:g} must be positive"
        raise InputError(msg, hint="give about a hundredth of the thinnest joint, in m")
    if reach is not None and not (0 <= reach < np.inf):
        msg = f"gap reach = {reach:g} must be zero or positive"
        raise InputError(msg, hint="give the largest initial gap that should become a joint, in m")


def detect_interfaces(
    bodies: Sequence[Body],
    *,
    tolerance: float,
    reach: float | None = None,
    facing_angle: float = FACING_ANGLE,
    sliver: float | None = None,
) -> Detection:
    """Return the interfaces between the outlines of ``bodies``, with near misses and overlaps.

    Parameters
    ----------
    bodies : sequence of Body
        Pairs of two fixed bodies are skipped.
    tolerance : float
        Edges closer than this touch, and overlap by up to this without being an overlap [m].
    reach : float, optional
        Edges further apart than the tolerance but within the reach become interfaces with an initial gap, if no other
        body stands between them; 0 joins only what touches [m]. By default edges that come nearer than
        :data:`REACH_SHARE` of the smaller body's size anywhere are joined over all of their common length.
    facing_angle : float
        Largest angle between edges that are joined [rad].
    sliver : float, optional
        Shortest interface [m]; by default :data:`SLIVER_SHARE` of the smaller body's size. A shorter piece is kept
        where it continues another piece between the same two bodies.

    Raises
    ------
    InputError
        Tolerance not positive, or a reach that is negative or not finite.
    """
    check_distances(tolerance, reach)
    edges = Edges.of(bodies)
    size = size_of_bodies(bodies)
    touch = touching(size, tolerance, reach)
    near = np.maximum(NEAR_SHARE * size, 2 * touch)

    shortest = np.minimum(tolerance, SLIVER_SHARE * size)
    pairs = facing_pairs(edges, near, shortest, max(facing_angle, NEAR_ANGLE))
    pairs = pairs.chosen(~((pairs.g_max < -tolerance) | (pairs.g_min > near[pairs.bodies].min(1))))
    thin = SLIVER_SHARE * size[pairs.bodies].min(1) if sliver is None else sliver
    thin = np.broadcast_to(np.asarray(thin, dtype=float), len(pairs.lo))
    within = touch[pairs.bodies].min(1)

    faces = pairs.angle <= facing_angle
    whole = (faces & (pairs.g_min <= within)) if reach is None else np.zeros(len(faces), dtype=bool)
    joined = pairs.clipped(-tolerance, np.where(whole, np.inf, within))
    length = joined.hi - joined.lo
    candidate = faces & (length > np.minimum(tolerance, thin))
    long = candidate & (length >= thin)
    short = candidate & ~long
    kept = long | (short & _continues(joined, long, short, tolerance, thin))
    table = visible_parts(bodies, joined.chosen(kept), tolerance, thin[kept])
    interfaces = _interfaces(table, edges, tolerance)

    misses = _near_misses(bodies, pairs, joined, kept, thin, tolerance, within, facing_angle)
    overlaps = find_overlaps(bodies, tolerance)
    touches = find_corner_touches(bodies, edges, table, misses, {o.bodies for o in overlaps}, touch)
    return Detection(tuple(interfaces), tuple(misses + touches), tuple(overlaps))


def touching(size: Array, tolerance: float, reach: float | None) -> Array:
    """Return how far from each body of a size (n,) another still touches it; of two bodies the smaller counts [m]."""
    return np.maximum(tolerance, REACH_SHARE * size if reach is None else np.full(len(size), reach))


def _continues(pairs: FacingPairs, long: Array, short: Array, tolerance: float, thin: Array) -> Array:
    """Return which short pieces continue others of the same two bodies into a chain that is long enough (p,)."""
    result = np.zeros(len(long), dtype=bool)
    if not short.any():
        return result
    key = pairs.bodies[:, 0] * (pairs.bodies.max() + 1) + pairs.bodies[:, 1]
    members = np.flatnonzero((long | short) & np.isin(key, np.unique(key[short])))
    count = len(members)
    ends = np.concatenate([pairs.a_lo[members], pairs.a_hi[members]])
    near = pairs_within(ends, 2 * tolerance) % count
    near = near[key[members[near[:, 0]]] == key[members[near[:, 1]]]]
    chain = linked(near, count)
    total = np.bincount(chain, (pairs.hi - pairs.lo)[members])
    result[members] = short[members] & (total[chain] >= thin[members])
    return result


def _interfaces(table: FacingPairs, edges: Edges, tolerance: float) -> list[Interface]:
    """Return the pairs as interfaces, ordered by bodies and edges."""
    numbers = edges.number[table.edges]
    order = np.lexsort([table.lo, numbers[:, 1], numbers[:, 0], table.bodies[:, 1], table.bodies[:, 0]])
    table, numbers = table.chosen(order), numbers[order]
    signed = np.stack([table.g_lo, table.g_hi], 1)
    gap = np.where(signed <= tolerance, 0.0, signed)
    normal, length = table.normal, np.hypot(*(table.a_hi - table.a_lo).T)
    for array in (table.a_lo, table.a_hi, normal, gap, signed):
        array.setflags(write=False)
    columns = (table.bodies.tolist(), numbers.tolist(), table.a_lo, table.a_hi, normal, gap, signed, length.tolist())
    return [
        Interface(ab[0], ab[1], e[0], e[1], p, q, n, g, s, l) for ab, e, p, q, n, g, s, l in zip(*columns, strict=True)
    ]


def _near_misses(
    bodies: Sequence[Body],
    pairs: FacingPairs,
    joined: FacingPairs,
    kept: Array,
    thin: Array,
    tolerance: float,
    within: Array,
    facing_angle: float,
) -> list[NearMiss]:
    """Return what nearly was an interface, edge by edge."""
    raw, length = pairs.hi - pairs.lo, joined.hi - joined.lo
    wide = raw >= thin
    faces = pairs.angle <= facing_angle
    touches = length > np.minimum(tolerance, thin)
    partial = kept & (raw - length > np.maximum(thin, 0.01 * raw))
    sliver = faces & touches & ~kept & ~(wide & (pairs.g_max > within))
    turned = ~kept & ~sliver & wide & (pairs.g_min <= within) & (pairs.g_max >= -tolerance)
    apart = ~kept & faces & wide & (pairs.g_min > within)
    chosen = np.flatnonzero(partial | sliver | turned | apart)
    if not len(chosen):
        return []
    # drop what another body hides: it is not near in any sense a mason would use
    hidden = np.zeros(len(raw), dtype=bool)
    far = chosen[apart[chosen]]
    if len(far):
        seen = visible_parts(bodies, pairs.chosen(far), tolerance, thin[far])
        hidden[far] = ~np.isin(far, far[np.flatnonzero(np.isin(_key(pairs.edges[far]), _key(seen.edges)))])
    result = []
    for k in chosen[~hidden[chosen]]:
        kind: MissKind = "partial" if partial[k] else "sliver" if sliver[k] else "angle" if turned[k] else "gap"
        a, b = (bodies[q] for q in pairs.bodies[k])
        at = 0.5 * (pairs.a_lo[k] + pairs.a_hi[k])
        result.append(
            NearMiss.of(
                kind, a, b, (int(pairs.bodies[k, 0]), int(pairs.bodies[k, 1])), at,
                gap=float(pairs.g_max[k] if kind == "partial" else pairs.g_min[k]), length=float(raw[k]),
                joined=float(max(length[k], 0.0)), angle=float(pairs.angle[k]), within=float(within[k]),
            )
        )  # fmt: skip
    return result


def _key(edges: Array) -> Array:
    result: Array = edges[:, 0].astype(np.int64) * (np.int64(1) << 32) + edges[:, 1]
    return result
