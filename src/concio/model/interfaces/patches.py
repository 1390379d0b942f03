"""Interfaces between blocks in space: the common polygons of faces that face each other.

Two faces of two bodies form a *patch* where their outward normals are opposite within an angle and their distance along
the mean normal n from a to b,

    g = n . (x_b - x_a),

is not below minus the tolerance and the faces come near each other anywhere: within a thousandth of the smaller body's
size, or within the reach given, beyond which the patch is then cut off. g is linear over the patch, an initial gap
where it exceeds the tolerance. The faces are cut in their mean plane as polygons, so that faces which are not convex,
have holes, or meet in several pieces need no cases of their own; each piece is a patch.

Nothing is dropped in silence: see :class:`concio.model.interfaces.detect.Detection`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from concio.kinematics.boxes import meeting_boxes
from concio.kinematics.frames import cross, turned_left
from concio.model.interfaces.detect import (
    FACING_ANGLE,
    NEAR_ANGLE,
    NEAR_SHARE,
    SLIVER_SHARE,
    Detection,
    check_distances,
    touching,
)
from concio.model.interfaces.edges_in_space import find_touches
from concio.model.interfaces.faces import FacePairs, Faces, facing_faces
from concio.model.interfaces.near import MissKind, NearMiss
from concio.model.interfaces.near_space import find_overlaps_in_space, miss_in_space
from concio.model.interfaces.patch import Patch
from concio.model.overlay import common
from concio.model.polyhedron import Polyhedron

Array = np.ndarray


def detect_patches(
    bodies: Sequence[Polyhedron], *, tolerance: float, reach: float | None = None, facing_angle: float = FACING_ANGLE
) -> Detection:
    """Return the patches between polyhedra, with near misses and overlaps.

    Parameters
    ----------
    bodies : sequence of Polyhedron
        Pairs of two fixed bodies are skipped.
    tolerance : float
        Faces closer than this touch, and overlap by up to this without being an overlap [m].
    reach : float, optional
        Faces further apart than the tolerance but within the reach become patches with an initial gap; 0 joins only
        what touches [m]. By default faces that come nearer than a thousandth of the smaller body's size anywhere are
        joined over all of their common area.
    facing_angle : float
        Largest angle between faces that are joined [rad].

    Raises
    ------
    InputError
        Tolerance not positive, or a reach that is negative or not finite.
    """
    check_distances(tolerance, reach)
    table = Faces.of(bodies)
    size = sizes(bodies)
    fixed = np.array([b.kind == "fixed" for b in bodies])
    touch = touching(size, tolerance, reach)
    low, high = (f.reduceat(v, table.of_body[:-1]) for f, v in ((np.minimum, table.low), (np.maximum, table.high)))
    around = 0.5 * np.maximum(NEAR_SHARE * size, 2 * touch)[:, None]
    i, j = meeting_boxes(low - around, high + around)
    some = ~(fixed[i] & fixed[j])
    i, j = i[some], j[some]
    smaller = np.minimum(size[i], size[j])
    reached = np.minimum(touch[i], touch[j])
    near = np.maximum(NEAR_SHARE * smaller, 2 * reached)
    pairs = facing_faces(table, (i, j), near, max(facing_angle, NEAR_ANGLE))

    least = np.minimum(tolerance, SLIVER_SHARE * np.minimum(*size[table.body[pairs.faces]].T))
    common = _Common.of(table, pairs, least)
    small = np.minimum(*size[table.body[pairs.faces]].T)[common.pair]
    thin = SLIVER_SHARE * small
    within = np.minimum(*touch[table.body[pairs.faces]].T)[common.pair]
    limit = np.maximum(NEAR_SHARE * small, 2 * within)
    turned = pairs.angle[common.pair] > facing_angle
    whole = (common.g_min <= within) & (reach is None)
    clipped = common.clipped(pairs, table, -tolerance, np.where(whole, np.inf, within), least)
    width = common.width()
    faces_each_other = (width >= thin) & (common.g_max >= -tolerance) & (common.g_min <= limit)
    own_width = np.zeros(len(common.pair))
    np.maximum.at(own_width, clipped.source, clipped.width())
    kept = (clipped.width() >= thin[clipped.source]) & ~turned[clipped.source]
    patches = clipped.patches(pairs, table, np.flatnonzero(kept), tolerance, least)
    joined = {(p.a, p.b) for p in patches}

    area = np.zeros(len(common.pair))
    np.add.at(area, clipped.source[kept], clipped.area[kept])
    has = np.zeros(len(common.pair), dtype=bool)
    has[clipped.source[kept]] = True
    partial = has & (common.area - area > np.maximum(thin * np.sqrt(common.area), 0.01 * common.area))
    touches = own_width > least[common.pair]
    sliver = ~has & ~turned & touches & ~(faces_each_other & (common.g_max > within))
    angle = ~has & ~sliver & faces_each_other & (common.g_min <= within)
    apart = ~has & ~turned & faces_each_other & (common.g_min > within)
    misses: list[NearMiss] = []
    for k in np.flatnonzero(partial | sliver | angle | apart).tolist():
        kind: MissKind = "partial" if partial[k] else "sliver" if sliver[k] else "angle" if angle[k] else "gap"
        p = common.pair[k]
        a, b = pairs.faces[p]
        misses.append(
            miss_in_space(
                kind, bodies, (int(table.body[a]), int(table.body[b])), (int(table.number[a]), int(table.number[b])),
                common.middle(pairs, table, k), gap=float(common.g_max[k] if kind == "partial" else common.g_min[k]),
                area=float(common.area[k]), joined=float(area[k]), width=float(own_width[k]),
                angle=float(pairs.angle[p]), within=float(within[k]),
            )
        )  # fmt: skip
    rest = np.array([(p, q) not in joined for p, q in zip(i.tolist(), j.tolist(), strict=True)], dtype=bool)
    convex = np.array([b.convex for b in bodies])
    doubtful = rest | ~(convex[i] & convex[j])
    overlaps = find_overlaps_in_space(bodies, (i[doubtful], j[doubtful]), tolerance)
    lapped = {o.bodies for o in overlaps}
    free = doubtful & np.array([(p, q) not in lapped for p, q in zip(i.tolist(), j.tolist(), strict=True)], dtype=bool)
    misses += find_touches(bodies, table, (i[free], j[free]), reached[free], patches, misses)
    misses = _without_hidden(misses, joined, bodies)
    return Detection(tuple(patches), tuple(misses), tuple(overlaps))


def sizes(bodies: Sequence[Polyhedron]) -> Array:
    """Return the side of a cube of the volume of each body (n,) [m]."""
    groups: dict[object, list[int]] = {}
    for k, body in enumerate(bodies):
        groups.setdefault((body.faces, body.holes), []).append(k)
    found = np.zeros(len(bodies))
    for members in groups.values():
        top = bodies[members[0]].topology
        points = np.stack([bodies[k].vertices for k in members])
        points = points - points[:, :1]
        near, p, q = (points[:, index] for index in top.corners)
        found[members] = (near * cross(p - near, q - near)).sum((1, 2)) / 6
    return np.cbrt(found)


def _without_hidden(
    misses: list[NearMiss], joined: set[tuple[int, int]], bodies: Sequence[Polyhedron]
) -> list[NearMiss]:
    """Return the misses without gaps between bodies that have another body between them."""
    kept = []
    between: dict[int, set[int]] = {}
    for a, b in joined:
        between.setdefault(a, set()).add(b)
        between.setdefault(b, set()).add(a)
    for miss in misses:
        a, b = miss.bodies
        shared = between.get(a, set()) & between.get(b, set())
        if miss.kind == "gap" and any(
            bool((bodies[c].normals @ miss.at - bodies[c].offsets <= miss.gap).all())
            for c in shared
        ):
            continue
        kept.append(miss)
    return kept


@dataclass(frozen=True, eq=False)
class _Common:
    """Pieces of the common areas of pairs of faces, in the coordinates of their mean planes; c in all."""

    pair: Array
    source: Array
    shape: Array  # shapely polygons
    area: Array
    g_min: Array
    g_max: Array

    @classmethod
    def of(cls, table: Faces, pairs: FacePairs, least: Array) -> _Common:
        """Return the pieces of the common area of each pair that are wider than ``least`` (p,) [m]."""
        first = table.polygons(pairs.faces[:, 0], pairs.origin, pairs.frame)
        second = table.polygons(pairs.faces[:, 1], pairs.origin, pairs.frame)
        box_a, box_b = shapely.bounds(first), shapely.bounds(second)
        low, high = np.maximum(box_a[:, :2], box_b[:, :2]), np.minimum(box_a[:, 2:], box_b[:, 2:])
        meet = np.flatnonzero((high - low > least[:, None]).all(1))
        boxes = _are_boxes(first[meet], box_a[meet]) & _are_boxes(second[meet], box_b[meet])
        plain, other = meet[boxes], meet[~boxes]  # rectangles along the axes of their plane need no cutting
        parts, index = shapely.get_parts(common(first[other], second[other]), return_index=True)
        both = shapely.box(*low[plain].T, *high[plain].T)
        pair = np.concatenate([plain, other[index]])
        return cls.described(table, pairs, np.concatenate([both, parts]), pair, pair, least)

    @classmethod
    def described(
        cls, table: Faces, pairs: FacePairs, parts: Array, pair: Array, source: Array, least: Array
    ) -> _Common:
        """Return pieces with their areas and gaps; lines, points and what is thinner than ``least`` (p,) go."""
        area, around = shapely.area(parts), shapely.length(parts)
        some = 2 * area > least[pair] * around
        parts, pair, source, area = parts[some], pair[some], source[some], area[some]
        flat, owner = shapely.get_coordinates(parts, return_index=True)
        at = pairs.on_first(table, pair[owner], flat)
        gap = pairs.height(table, 1, pair[owner], at)
        g_min, g_max = np.full(len(parts), np.inf), np.full(len(parts), -np.inf)
        np.minimum.at(g_min, owner, gap)
        np.maximum.at(g_max, owner, gap)
        return cls(pair, source, parts, area, g_min, g_max)

    def width(self) -> Array:
        """Mean width (c,) of each piece, twice its area over its perimeter [m]."""
        around = shapely.length(self.shape)
        return np.asarray(np.divide(2 * self.area, around, out=np.zeros_like(self.area), where=around > 0))

    def clipped(self, pairs: FacePairs, table: Faces, low: float, high: Array, least: Array) -> _Common:
        """Return the pieces where the gap lies between ``low`` and ``high`` (c,), and where each comes from."""
        most = np.minimum(high, self.g_max + (self.g_max - self.g_min))
        whole = (self.g_min >= low) & (self.g_max <= most)
        cut = np.flatnonzero(~whole & (self.g_min <= most) & (self.g_max >= low))
        shapes, pair, source = [self.shape[whole]], [self.pair[whole]], [np.flatnonzero(whole)]
        for k in cut.tolist():
            p = int(self.pair[k])
            probe = pairs.on_first(table, np.full(3, p), np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
            g0, g1, g2 = pairs.height(table, 1, np.full(3, p), probe)
            slope = np.array([g1 - g0, g2 - g0])
            band = _band(self.shape[k], slope, g0, low, float(most[k]))
            parts = shapely.get_parts(common(self.shape[[k]], band))
            shapes.append(parts)
            pair.append(np.full(len(parts), p))
            source.append(np.full(len(parts), k))
        return _Common.described(
            table, pairs, np.concatenate(shapes), np.concatenate(pair), np.concatenate(source), least
        )

    def middle(self, pairs: FacePairs, table: Faces, k: int) -> Array:
        """Return a point of the first face in piece k (3,) [m]."""
        inside = shapely.point_on_surface(self.shape[k])
        at = pairs.on_first(table, self.pair[[k]], np.array([[inside.x, inside.y]]))
        found: Array = at[0]
        return found

    def patches(
        self, pairs: FacePairs, table: Faces, chosen: Array, tolerance: float, least: Array
    ) -> list[Patch]:
        """Return chosen pieces as patches, in order of bodies and faces."""
        pair = self.pair[chosen]
        a, b = pairs.faces[pair].T
        order = np.lexsort([table.number[b], table.number[a], table.body[b], table.body[a]])
        chosen, pair = chosen[order], pair[order]
        shapes = shapely.orient_polygons(self.shape[chosen])
        flat, ring_ends, part_ends = _ragged(shapes)
        ring_of = np.repeat(np.arange(len(ring_ends) - 1), np.diff(ring_ends))
        part_of = np.repeat(np.arange(len(chosen)), np.diff(part_ends))
        keep = _kept_vertices(flat, ring_ends, least[pair[part_of]])
        flat, ring_of = flat[keep], ring_of[keep]
        owner = part_of[ring_of]
        at = pairs.on_first(table, pair[owner], flat)
        signed = pairs.height(table, 1, pair[owner], at)
        gap = np.where(signed <= tolerance, 0.0, signed)
        begin = np.searchsorted(ring_of, np.arange(len(ring_ends)))
        for array in (at, gap, signed, pairs.normal):
            array.setflags(write=False)
        found = []
        area = self.area[chosen].tolist()
        faces = pairs.faces[pair]
        columns = (table.body[faces].tolist(), table.number[faces].tolist(), part_ends[:-1].tolist(),
                   part_ends[1:].tolist(), pair.tolist(), area)  # fmt: skip
        starts = begin.tolist()
        for (i, j), (f, g), r0, r1, p, size in zip(*columns, strict=True):
            ring = slice(starts[r0], starts[r0 + 1])
            holes = tuple(at[starts[r] : starts[r + 1]] for r in range(r0 + 1, r1))
            found.append(Patch(i, j, f, g, at[ring], pairs.normal[p], gap[ring], signed[ring], size, holes))
        return found


def _are_boxes(shapes: Array, box: Array) -> Array:
    """Return which polygons are rectangles along the axes, given their bounds (n, 4)."""
    size = (box[:, 2:] - box[:, :2]).max(1, initial=0.0)
    full = (box[:, 2] - box[:, 0]) * (box[:, 3] - box[:, 1])
    found: Array = (shapely.get_num_coordinates(shapes) == 5) & (full - shapely.area(shapes) <= 1e-14 * size * size)
    return found


def _ragged(shapes: Array) -> tuple[Array, Array, Array]:
    """Return coordinates (without closing repetitions), ends of rings, and rings of each polygon."""
    if not len(shapes):
        return np.zeros((0, 2)), np.zeros(1, dtype=int), np.zeros(1, dtype=int)
    _, flat, (rings, parts) = shapely.to_ragged_array(shapes)
    inner = np.ones(len(flat), dtype=bool)
    inner[rings[1:] - 1] = False
    return np.asarray(flat)[inner], rings - np.arange(len(rings)), np.asarray(parts)


def _kept_vertices(flat: Array, rings: Array, least: Array) -> Array:
    """Return which vertices stay without those nearer than ``least`` (rings,) to the next or on straight sides."""
    keep = np.ones(len(flat), dtype=bool)
    count = np.diff(rings)
    ring = np.repeat(np.arange(len(count)), count)
    last = rings[1:][ring] - 1
    number = np.arange(len(flat))
    ahead = np.where(number == last, rings[:-1][ring], number + 1)
    behind = np.where(number == rings[:-1][ring], last, number - 1)
    along, back = flat[ahead] - flat, flat - flat[behind]
    turn = cross(back, along)
    base = np.linalg.norm(flat[ahead] - flat[behind], axis=1)
    near = least[ring]
    suspect = (np.linalg.norm(along, axis=1) <= near) | (np.abs(turn) <= 0.1 * near * base)
    for r in np.unique(ring[suspect]).tolist():
        members, tolerance = list(range(rings[r], rings[r + 1])), float(least[r])
        k, idle = 0, 0
        while len(members) > 3 and idle < len(members):
            p, v, q = members[k - 1], members[k], members[(k + 1) % len(members)]
            e, d = flat[q] - flat[p], flat[v] - flat[p]
            length = float(np.hypot(*e))
            off = abs(float(cross(e, d))) / length if length > 0 else 0.0
            if off <= 0.1 * tolerance or float(np.hypot(*d)) <= tolerance:
                keep[v] = False
                del members[k]
                k, idle = max(k - 1, 0) % len(members), 0
            else:
                k, idle = (k + 1) % len(members), idle + 1
    return keep


def _band(shape: shapely.Polygon, slope: Array, start: float, least: float, most: float) -> shapely.Polygon:
    """Return the strip of the plane where ``start + slope . x`` lies between two values, as far as a shape reaches."""
    steep = float(np.hypot(*slope))
    across = slope / steep
    along = turned_left(across)
    corners = shapely.get_coordinates(shape)
    s = corners @ along
    reach = float(np.ptp(corners, axis=0).sum()) + 1.0
    lo, hi = (least - start) / steep, (most - start) / steep
    s0, s1 = float(s.min()) - reach, float(s.max()) + reach
    ends = [across * d + along * e for d, e in ((lo, s0), (lo, s1), (hi, s1), (hi, s0))]
    return shapely.Polygon(ends)
