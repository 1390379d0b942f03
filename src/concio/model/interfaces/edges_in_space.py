"""Edges and corners in space that touch another body where no joint was made: every such place, with the bodies.

Two polyhedra that touch do so where an edge of one, its ends included, lies on a face or on an edge of the other. So of
every pair of bodies that come within reach of each other, edges are cut by faces and measured against edges. A place is
reported unless a joint of the same two bodies covers it, another near miss tells of it, or it is a corner or an edge
along an edge at which joints with other bodies connect the two (:mod:`concio.model.interfaces.meeting`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from concio.kinematics.boxes import boxes_meeting
from concio.kinematics.frames import cross, dot, norm, tangents
from concio.model.interfaces.faces import Faces, spread
from concio.model.interfaces.meeting import connected_at
from concio.model.interfaces.near import NearMiss
from concio.model.interfaces.near_space import touch_in_space
from concio.model.interfaces.patch import Patch
from concio.model.polyhedron import Polyhedron

Array = np.ndarray
PARALLEL = 1e-3
"""Edges turned against each other by less than this lie along each other [rad]."""


@dataclass(frozen=True, eq=False)
class _Places:
    """Where an edge of one body lies on the other, k in all."""

    pair: Array  # number of the pair of bodies
    at: Array  # (k, 3) [m]
    length: Array  # of the edge that lies there [m]
    gap: Array  # [m]
    blunt: Array  # whether it is a corner or an edge along an edge, which joints with others may connect

    def chosen(self, which: Array) -> _Places:
        return _Places(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def distinct(self, reach: Array) -> _Places:
        """Return the places without repetitions, of each the longest."""
        order = np.lexsort([self.blunt, -self.length])
        cell = np.round(self.at / (2 * reach[self.pair, None])).astype(np.int64)
        key = np.column_stack([self.pair, cell, self.blunt])[order]
        _, first = np.unique(key, axis=0, return_index=True)
        return self.chosen(np.sort(order[first]))

    @classmethod
    def together(cls, parts: Sequence[_Places]) -> _Places:
        return cls(*(np.concatenate([getattr(p, name) for p in parts]) for name in cls.__dataclass_fields__))


@dataclass(frozen=True, eq=False)
class _Edges:
    """All edges of all bodies: ends (e, 2, 3), boxes (e, 3), and edges of body b are ``of_body[b]:of_body[b + 1]``."""

    ends: Array
    low: Array
    high: Array
    of_body: Array

    @classmethod
    def of(cls, bodies: Sequence[Polyhedron]) -> _Edges:
        ends = np.concatenate([b.vertices[b.topology.edges] for b in bodies])
        count = [len(b.topology.edges) for b in bodies]
        return cls(ends, ends.min(1), ends.max(1), np.concatenate([[0], np.cumsum(count)]))


def find_touches(
    bodies: Sequence[Polyhedron], table: Faces, pairs: tuple[Array, Array], reach: Array, patches: Sequence[Patch],
    known: Sequence[NearMiss],
) -> list[NearMiss]:  # fmt: skip
    """Return where the given pairs of bodies touch without a joint, a near miss each place.

    Parameters
    ----------
    bodies : sequence of Polyhedron
    table : Faces
    pairs : (i, j)
        The pairs to look at, those with joints of their own as well where a body is not convex.
    reach : (pairs,) array
        How far apart the two bodies still touch [m].
    patches : sequence of Patch
        The joints that were made.
    known : sequence of NearMiss
        What was reported already; a place is not reported twice.
    """
    if not len(pairs[0]):
        return []
    edges = _Edges.of(bodies)
    low, high = (f.reduceat(v, table.of_body[:-1]) for f, v in ((np.minimum, table.low), (np.maximum, table.high)))
    i, j = pairs
    meet = ((low[i] <= high[j] + reach[:, None]) & (low[j] <= high[i] + reach[:, None])).all(1)
    own = np.flatnonzero(meet)
    if not len(own):
        return []
    around = [_near(edges, b[own], (low[a[own]], high[a[own]]), reach[own]) for a, b in ((j, i), (i, j))]
    faces = [_near(table, b[own], (low[a[own]], high[a[own]]), reach[own]) for a, b in ((j, i), (i, j))]
    places = _Places.together([
        _on_faces(table, edges, around[0], faces[1], reach[own]),
        _on_faces(table, edges, around[1], faces[0], reach[own]),
        _on_edges(edges, around[0], around[1], reach[own]),
    ])  # fmt: skip
    places = places.distinct(reach[own])
    if not len(places.pair):
        return []
    both = np.stack([i[own], j[own]], 1)[places.pair]
    near = 2 * reach[own][places.pair]
    joints = _Joints.of(patches)
    place, joint = joints.at(places.at, near)
    same = (joints.bodies[joint] == both[place]).all(1)
    covered = np.bincount(place[same], minlength=len(both)) > 0
    one = np.arange(len(bodies))
    fixed = np.array([b.kind == "fixed" for b in bodies])
    one[fixed] = int(np.argmax(fixed))  # fixed bodies are one: what stands on one of them stands on all
    idle = places.blunt & connected_at(one[both], place, one[joints.bodies[joint]], len(bodies))
    left = np.flatnonzero(~covered & ~idle)
    return _told(bodies, places.chosen(left), both[left], near[left], known)


def _near(items: _Edges | Faces, body: Array, box: tuple[Array, Array], reach: Array) -> tuple[Array, Array]:
    """Return the edges or faces of bodies (k,) that come near boxes (k, 3): their numbers, and of which of the k."""
    number, owner = spread(items.of_body[body], np.diff(items.of_body)[body])
    grown = reach[owner, None]
    some = ((items.low[number] <= box[1][owner] + grown) & (items.high[number] >= box[0][owner] - grown)).all(1)
    return number[some], owner[some]


def _crossed(first: tuple[Array, Array], second: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return every item of the first with every item of the second of the same owner; owners ascend in both."""
    begin = np.searchsorted(second[1], first[1])
    count = np.searchsorted(second[1], first[1], side="right") - begin
    index, source = spread(begin, count)
    return source, index


def _on_faces(
    table: Faces, edges: _Edges, along: tuple[Array, Array], across: tuple[Array, Array], reach: Array
) -> _Places:
    """Return where edges lie on the inside of faces."""
    source, index = _crossed(along, across)
    edge, face, pair = along[0][source], across[0][index], along[1][source]
    near = reach[pair]
    grown = near[:, None]
    some = ((edges.low[edge] <= table.high[face] + grown) & (edges.high[edge] >= table.low[face] - grown)).all(1)
    height = (edges.ends[edge] * table.normal[face][:, None]).sum(-1) - table.offset[face][:, None]
    some &= (height.min(1) <= near) & (height.max(1) >= -near)
    edge, face, pair, near, height = (v[some] for v in (edge, face, pair, near, height))
    rise = height[:, 1] - height[:, 0]
    level = np.abs(rise) <= 1e-12 * np.abs(height).max(1, initial=0.0)
    steep = np.where(level, 1.0, rise)
    ends = np.sort(np.stack([(-near - height[:, 0]) / steep, (near - height[:, 0]) / steep], 1), axis=1)
    ends = np.where(level[:, None], np.array([0.0, 1.0]), np.clip(ends, 0.0, 1.0))
    gap = np.where(height.min(1) * height.max(1) <= 0, 0.0, np.abs(height).min(1))
    start, way = edges.ends[edge, 0], edges.ends[edge, 1] - edges.ends[edge, 0]
    deep, doubtful = _clipped(table, face, start, way, ends, 2 * near)
    k = np.flatnonzero((deep[:, 0] <= deep[:, 1]) & ~doubtful)
    part, _ = _clipped(table, face[k], start[k], way[k], ends[k], np.zeros(len(k)))
    length = (part[:, 1] - part[:, 0]) * np.linalg.norm(way[k], axis=1)
    at = start[k] + part.mean(1)[:, None] * way[k]
    plain = _Places(pair[k], at, length, gap[k], np.zeros(len(k), dtype=bool))
    k = np.flatnonzero(doubtful)
    points = start[k, None] + ends[k, :, None] * way[k, None]
    other, at, length = _cut(table, face[k], points, near[k])
    k = k[other]
    return _Places.together([plain, _Places(pair[k], at, length, gap[k], np.zeros(len(k), dtype=bool))])


def _clipped(
    table: Faces, face: Array, start: Array, way: Array, ends: Array, margin: Array
) -> tuple[Array, Array]:
    """Return the parts (k, 2) of segments further than a margin inside convex faces, and which faces are not convex.

    Of a face that is not convex, or has holes, the part is returned as it was.
    """
    ring = table.first[face]
    point, owner = spread(table.rings[ring], np.diff(table.rings)[ring] - 1)
    every, bent = table.boundaries
    inward, doubtful = every[point], bent[face]
    deep = dot(start[owner] - table.points[point], inward) - margin[owner]
    rate = dot(way[owner], inward)
    level = np.abs(rate) <= 1e-12 * norm(way)[owner]
    share = -deep / np.where(level, 1.0, rate)
    low = np.where(level, np.where(deep >= 0, 0.0, 2.0), np.where(rate > 0, share, 0.0))
    high = np.where(level | (rate > 0), 1.0, share)
    found = ends.copy()
    if len(face):
        begin = np.searchsorted(owner, np.arange(len(face)))
        found[:, 0] = np.maximum(ends[:, 0], np.maximum.reduceat(low, begin))
        found[:, 1] = np.minimum(ends[:, 1], np.minimum.reduceat(high, begin))
    found[doubtful] = ends[doubtful]
    return found, doubtful


def _cut(table: Faces, face: Array, points: Array, near: Array) -> tuple[Array, Array, Array]:
    """Return what of segments (k, 2, 3) lies inside faces of any shape: of which each is, its middle and its length."""
    frame, origin = tangents(table.normal[face]), table.points[table.rings[table.first[face]]]
    flat = np.einsum("ked,kid->kei", points - origin[:, None], frame)
    lines = shapely.linestrings(flat)
    upright = np.linalg.norm(flat[:, 1] - flat[:, 0], axis=1) <= 1e-9 * near
    lines[upright] = shapely.points(flat[upright, 0])
    shapes = table.polygons(face, origin, frame)
    inside, k = shapely.get_parts(shapely.intersection(lines, shapes), return_index=True)
    middle = shapely.centroid(inside)
    some = shapely.distance(shapely.boundary(shapes[k]), middle) > 2 * near[k]  # not of what is empty: nan
    k, middle, length = k[some], middle[some], shapely.length(inside[some])
    return k, origin[k] + np.einsum("ki,kid->kd", shapely.get_coordinates(middle), frame[k]), length


def _on_edges(edges: _Edges, first: tuple[Array, Array], second: tuple[Array, Array], reach: Array) -> _Places:
    """Return where edges come near edges."""
    source, index = _crossed(first, second)
    p, q, pair = first[0][source], second[0][index], first[1][source]
    near = reach[pair]
    grown = near[:, None]
    some = ((edges.low[p] <= edges.high[q] + grown) & (edges.high[p] >= edges.low[q] - grown)).all(1)
    p, q, pair, near = (v[some] for v in (p, q, pair, near))
    a, b = edges.ends[p], edges.ends[q]
    u, v = a[:, 1] - a[:, 0], b[:, 1] - b[:, 0]
    s, t = _closest(a[:, 0], u, b[:, 0], v)
    at = a[:, 0] + s[:, None] * u
    gap = np.linalg.norm(b[:, 0] + t[:, None] * v - at, axis=1)
    lu, lv = np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1)
    along = np.linalg.norm(cross(u, v), axis=1) <= PARALLEL * lu * lv
    unit = u / lu[:, None]
    reached = np.sort(((b - a[:, :1]) * unit[:, None]).sum(-1), axis=1)
    lo, hi = np.maximum(reached[:, 0], 0.0), np.minimum(reached[:, 1], lu)
    shared = along & (hi - lo > 2 * near)
    at = np.where(shared[:, None], a[:, 0] + (0.5 * (lo + hi))[:, None] * unit, at)
    end = np.minimum(np.minimum(s, 1 - s) * lu, np.minimum(t, 1 - t) * lv) <= 2 * near
    k = np.flatnonzero(gap <= near)
    length = np.where(shared, hi - lo, 0.0)
    return _Places(pair[k], at[k], length[k], gap[k], (along | end)[k])


def _closest(a: Array, u: Array, b: Array, v: Array) -> tuple[Array, Array]:
    """Return where on segments a + s u and b + t v, with s and t from 0 to 1, they are nearest (k,)."""
    r = a - b
    uu, vv, uv, ur, vr = ((x * y).sum(1) for x, y in ((u, u), (v, v), (u, v), (u, r), (v, r)))
    apart = uu * vv - uv * uv
    safe = np.where(apart > 1e-12 * uu * vv, apart, 1.0)
    s = np.where(apart > 1e-12 * uu * vv, np.clip((uv * vr - vv * ur) / safe, 0.0, 1.0), 0.0)
    t = np.clip((uv * s + vr) / vv, 0.0, 1.0)
    s = np.clip((uv * t - ur) / uu, 0.0, 1.0)
    return s, t


@dataclass(frozen=True, eq=False)
class _Joints:
    """The joints that were made, as polygons in planes of their own."""

    bodies: Array  # (j, 2)
    low: Array
    high: Array
    normal: Array
    origin: Array
    frame: Array
    shape: Array

    @classmethod
    def of(cls, patches: Sequence[Patch]) -> _Joints:
        count = len(patches)
        bodies = np.array([(p.a, p.b) for p in patches], dtype=int).reshape(-1, 2)
        normal = np.array([p.normal for p in patches]).reshape(-1, 3)
        origin = np.array([p.polygon[0] for p in patches]).reshape(-1, 3)
        if not count:
            return cls(bodies, origin, origin, normal, origin, np.zeros((0, 2, 3)), np.zeros(0, dtype=object))
        rings = [len(p.polygon) for p in patches]
        points = np.concatenate([p.polygon for p in patches])
        owner = np.repeat(np.arange(count), rings)
        frame = tangents(normal)
        flat = np.einsum("kd,kid->ki", points - origin[owner], frame[owner])
        shape = shapely.polygons(shapely.linearrings(flat, indices=owner))
        for k, patch in enumerate(patches):
            if patch.holes:
                holes = [(hole - origin[k]) @ frame[k].T for hole in patch.holes]
                shape[k] = shapely.Polygon(shapely.get_coordinates(shape[k]), holes)
        begin = np.concatenate([[0], np.cumsum(rings)[:-1]])
        low, high = np.minimum.reduceat(points, begin), np.maximum.reduceat(points, begin)
        return cls(bodies, low, high, normal, origin, frame, shape)

    def at(self, at: Array, near: Array) -> tuple[Array, Array]:
        """Return which joints come within ``near`` (k,) of which points ``at`` (k, 3): numbers of both."""
        if not len(self.bodies) or not len(at):
            return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
        place, joint = boxes_meeting(at - near[:, None], at + near[:, None], self.low, self.high)
        arm = at[place] - self.origin[joint]
        beside = np.abs((arm * self.normal[joint]).sum(1)) <= near[place]
        place, joint, arm = place[beside], joint[beside], arm[beside]
        flat = shapely.points(np.einsum("kd,kid->ki", arm, self.frame[joint]))
        reached = shapely.dwithin(self.shape[joint], flat, near[place])
        return place[reached], joint[reached]


def _told(
    bodies: Sequence[Polyhedron], places: _Places, both: Array, near: Array, known: Sequence[NearMiss]
) -> list[NearMiss]:
    """Return a near miss for each place, the longest first of those that lie on each other, without those reported."""
    told: dict[tuple[int, int], list[tuple[Array, float]]] = {}
    for miss in (m for m in known if m.touches):
        told.setdefault(miss.bodies, []).append((miss.at, np.sqrt(miss.length)))
    found = []
    for k in np.lexsort([places.blunt, -places.length]).tolist():
        pair = (int(both[k, 0]), int(both[k, 1]))
        own = told.setdefault(pair, [])
        if any(np.linalg.norm(places.at[k] - x) <= r + near[k] for x, r in own):
            continue
        length = float(places.length[k]) if places.length[k] > 2 * near[k] else 0.0
        own.append((places.at[k], 0.5 * length))
        found.append(touch_in_space(bodies, pair, places.at[k], gap=float(places.gap[k]), length=length))
    return sorted(found, key=lambda miss: (miss.bodies, tuple(miss.at)))
