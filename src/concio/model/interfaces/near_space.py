"""Near misses, overlaps and touches of polyhedra: what to tell of blocks in space that are not put together properly.

Two convex bodies overlap where no plane keeps them apart; it is enough to try the planes of their faces and those along
one edge of each (separating axes). Bodies that are not convex are taken as convex pieces. Where one falls into too many
of them, points are tried that must lie in the other if they overlap: edges are cut by the planes of the other's faces,
and the middles of the pieces, of the faces and of the body are looked up in it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from concio.kinematics.frames import cross
from concio.model.convex_pieces import ConvexPiece
from concio.model.interfaces.near import MissKind, NearMiss, Overlap
from concio.model.polyhedron import Polyhedron
from concio.model.polyhedron_check import place

Array = np.ndarray


def miss_in_space(
    kind: MissKind, bodies: Sequence[Polyhedron], pair: tuple[int, int], faces: tuple[int, int], at: Array, *,
    gap: float, area: float, joined: float, width: float, angle: float, within: float,
) -> NearMiss:  # fmt: skip
    """Return a near miss of two faces with its sentence; its length is the common area [m2]."""
    a, b = bodies[pair[0]], bodies[pair[1]]
    who = f"'{a.name}' (face {faces[0] + 1}) and '{b.name}' (face {faces[1] + 1})"
    if kind == "gap":
        text = (
            f"{who} face each other over {area:.4g} m2 {place(at)} with a gap of {1e3 * gap:.4g} mm; no joint was made "
            "(if they touch raise gap_tolerance above it; gap_reach keeps it as an initial gap)"
        )
    elif kind == "angle":
        text = (
            f"{who} touch {place(at)} with faces turned by {np.rad2deg(angle):.3g} degrees; no joint was made (align "
            "the faces, or raise gap_tolerance)"
        )
    elif kind == "sliver":
        text = (
            f"{who} share a strip only {1e3 * width:.4g} mm wide {place(at)}; this sliver was dropped (align the "
            "edges, or widen the overlap if the contact is meant)"
        )
    else:
        text = (
            f"{who} face each other over {area:.4g} m2 {place(at)} but only {joined:.4g} m2 lie within "
            f"{1e3 * within:.4g} mm; the joint covers that part (the gap grows to {1e3 * gap:.4g} mm: raise gap_reach "
            "to keep the rest as an initial gap)"
        )
    return NearMiss(kind, a.name, b.name, pair, at, gap, area, angle, text)


def touch_in_space(
    bodies: Sequence[Polyhedron], pair: tuple[int, int], at: Array, *, gap: float, length: float
) -> NearMiss:
    """Return a near miss of two bodies that touch in a corner, or along an edge of a length [m]."""
    a, b = bodies[pair[0]].name, bodies[pair[1]].name
    how = f"along an edge of {length:.4g} m" if length else "in a corner"
    text = (
        f"'{a}' and '{b}' touch {place(at)} {how} only; no joint was made (give them a common face if it bears load)"
    )
    return NearMiss("edge" if length else "corner", a, b, pair, at, gap, length, 0.0, text)


def find_overlaps_in_space(
    bodies: Sequence[Polyhedron], pairs: tuple[Array, Array], tolerance: float
) -> list[Overlap]:
    """Return where two of the given pairs of bodies overlap deeper than the tolerance."""
    i, j = _meeting(bodies, pairs, tolerance)
    found = []
    for m, n in zip(i.tolist(), j.tolist(), strict=True):
        a, b = bodies[m], bodies[n]
        depth, at, volume = _depth(a, b, tolerance)
        if depth > tolerance:
            found.append(_overlap(a, b, (m, n), depth, at, volume))
    return found


def _depth(a: Polyhedron, b: Polyhedron, tolerance: float) -> tuple[float, Array, float]:
    """Return how deep two bodies overlap, where, and the volume they share."""
    if a.pieces is None or b.pieces is None:
        depth, at = _sampled_depth(a, b)
        inside = any((winding(q, p.vertices) > 0.9).all() for p, q in ((a, b), (b, a))) if depth > tolerance else False
        return depth, at, min(a.volume, b.volume) if inside else 0.0
    depth, at, volume = 0.0, a.centroid, 0.0
    for p in a.pieces:
        for q in b.pieces:
            own = _convex_depth(p, q)
            if own <= tolerance:
                continue
            shared, place_of_it = _common_volume(p, q)
            volume += shared
            if own > depth and shared > 0:
                depth, at = own, place_of_it
    return depth, at, volume


def _overlap(a: Polyhedron, b: Polyhedron, pair: tuple[int, int], depth: float, at: Array, volume: float) -> Overlap:
    small, large = (a, b) if a.volume <= b.volume else (b, a)
    names = f"'{a.name}' and '{b.name}'"
    shared = volume > 0.999 * large.volume
    same = shared or (
        a.vertices.shape == b.vertices.shape
        and np.abs(np.sort(a.vertices, axis=0) - np.sort(b.vertices, axis=0)).max() < 1e-6 * large.size
    )
    if same:
        text = f"{names} are the same block twice {place(at)} (delete one of them)"
    elif volume > 0.999 * small.volume:
        text = f"'{small.name}' lies inside '{large.name}' {place(at)} (delete it, or cut a hole for it)"
    else:
        much = f"by {volume:.4g} m3, " if volume else ""
        text = (
            f"{names} overlap {place(at)} {much}{1e3 * depth:.4g} mm deep (move or trim one of them; no joint is made "
            "where they overlap)"
        )
    return Overlap(a.name, b.name, pair, at, volume, depth, text)


def _meeting(bodies: Sequence[Polyhedron], pairs: tuple[Array, Array], tolerance: float) -> tuple[Array, Array]:
    """Return the pairs whose boxes overlap by more than the tolerance and which no plane of a face keeps apart."""
    i, j = pairs
    if not len(i):
        return i, j
    low = np.array([b.vertices.min(0) for b in bodies])
    high = np.array([b.vertices.max(0) for b in bodies])
    meet = (np.minimum(high[i], high[j]) - np.maximum(low[i], low[j]) > tolerance).all(1)
    i, j = i[meet], j[meet]
    sort, stacks = _stacked(bodies, np.unique(np.concatenate([i, j])))
    apart = np.zeros(len(i), dtype=bool)
    for a, b in ((i, j), (j, i)):
        for p, q in np.unique(np.column_stack([sort[a], sort[b]]), axis=0).tolist():
            own = np.flatnonzero((sort[a] == p) & (sort[b] == q))
            first, second = stacks[p], stacks[q]
            for part in np.array_split(own, max(1, len(own) * first.vertices.shape[1] // 400_000)):
                apart[part] |= first.keeps_apart(a[part], second, b[part], tolerance)
    return i[~apart], j[~apart]


class _Stack:
    """Bodies with equally many vertices and faces, as arrays."""

    def __init__(self, bodies: Sequence[Polyhedron], members: Array) -> None:
        self.row = {int(k): r for r, k in enumerate(members)}
        self.vertices = np.stack([bodies[k].vertices for k in members])
        self.normals = np.stack([bodies[k].normals for k in members])
        self.offsets = np.stack([bodies[k].offsets for k in members])
        self.convex = np.array([bodies[k].convex for k in members])
        edges = np.stack([bodies[k].topology.edges for k in members])
        middle = 0.5 * (self.vertices[np.arange(len(members))[:, None, None], edges]).sum(2)
        self.points = np.concatenate([self.vertices, middle], axis=1)  # vertices and middles of edges

    def rows(self, which: Array) -> Array:
        return np.array([self.row[k] for k in which.tolist()], dtype=int)

    def keeps_apart(self, own: Array, other: _Stack, others: Array, tolerance: float) -> Array:
        """Return for which pairs a plane of a face of the first has all of the second outside and the first inside."""
        mine, theirs = self.rows(own), other.rows(others)
        height = np.einsum("kfd,kvd->kfv", self.normals[mine], other.vertices[theirs])
        outside = height.min(2) - self.offsets[mine] >= -tolerance
        if not self.convex[mine].all():
            inner = np.einsum("kfd,kvd->kfv", self.normals[mine], self.vertices[mine]).max(2) - self.offsets[mine]
            outside &= inner <= tolerance
        return np.asarray(outside.any(1))


def _stacked(bodies: Sequence[Polyhedron], members: Array) -> tuple[Array, list[_Stack]]:
    """Return the stack (n,) of each body, and the stacks of those in ``members``."""
    known: dict[tuple[int, ...], list[int]] = {}
    for k in members.tolist():
        body = bodies[k]
        known.setdefault((len(body.vertices), len(body.faces), len(body.topology.edges)), []).append(k)
    sort = np.zeros(len(bodies), dtype=int)
    stacks = []
    for number, group in enumerate(known.values()):
        sort[group] = number
        stacks.append(_Stack(bodies, np.array(group)))
    return sort, stacks


def _convex_depth(a: ConvexPiece, b: ConvexPiece) -> float:
    """Return how deep two convex pieces overlap along the axis that separates them best."""
    axes = np.concatenate([a.normals, b.normals])
    common = _overlap_along(a, b, axes)
    if common <= 0:
        return common
    edges = (a.directions, b.directions)
    mixed = cross(edges[0][:, None], edges[1][None]).reshape(-1, 3)
    length = np.linalg.norm(mixed, axis=1)
    mixed = mixed[length > 1e-6] / length[length > 1e-6, None]
    return min(common, _overlap_along(a, b, mixed)) if len(mixed) else common


def _overlap_along(a: ConvexPiece, b: ConvexPiece, axes: Array) -> float:
    ha, hb = a.vertices @ axes.T, b.vertices @ axes.T
    return float(np.minimum(ha.max(0) - hb.min(0), hb.max(0) - ha.min(0)).min())


def _common_volume(a: ConvexPiece, b: ConvexPiece) -> tuple[float, Array]:
    """Return the volume of what two convex pieces share, and the middle of the largest ball in it."""
    from scipy.optimize import linprog  # loaded where it is needed: it takes long
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    planes = np.vstack([np.column_stack([piece.normals, -piece.offsets]) for piece in (a, b)])
    system = np.column_stack([planes[:, :3], np.ones(len(planes))])
    found = linprog([0.0, 0.0, 0.0, -1.0], A_ub=system, b_ub=-planes[:, 3], bounds=[(None, None)] * 3 + [(0, None)])
    if found.x is None or found.x[3] <= 0:
        return 0.0, a.vertices.mean(0)
    inside = np.array(found.x[:3])
    try:
        return float(ConvexHull(HalfspaceIntersection(planes, inside).intersections).volume), inside
    except QhullError:
        return 0.0, inside


def _sampled_depth(a: Polyhedron, b: Polyhedron) -> tuple[float, Array]:
    """Return the depth of the deepest point found of one body in the other, and that point."""
    best, where = 0.0, a.vertices[0]
    for first, second in ((a, b), (b, a)):
        p, q = first.topology.edges.T
        hp = first.vertices[p] @ second.normals.T - second.offsets
        hq = first.vertices[q] @ second.normals.T - second.offsets
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where((hp < 0) != (hq < 0), hp / (hp - hq), 1.0)
        marks = np.sort(np.column_stack([np.zeros(len(p)), share, np.ones(len(p))]), axis=1)
        middle = 0.5 * (marks[:, :-1] + marks[:, 1:])
        some = np.diff(marks, axis=1) > 1e-9
        edge = np.nonzero(some)[0]
        along = first.vertices[p[edge]] + middle[some][:, None] * (first.vertices[q[edge]] - first.vertices[p[edge]])
        cells, _ = first.triangles
        points = np.vstack([along, first.vertices[cells].mean(1), inner_point(first)[None]])
        inside = points[winding(second, points) > 0.9]
        if len(inside):
            depth = distance_to_surface(second, inside)
            k = int(np.argmax(depth))
            if depth[k] > best:
                best, where = float(depth[k]), inside[k]
    return best, where


def winding(body: Polyhedron, points: Array) -> Array:
    """Return the winding number (n,) of a body's surface round points (n, 3): 1 inside, 0 outside.

    The solid angle of each triangle after van Oosterom and Strackee (IEEE Trans. Biomed. Eng. 30, 1983).
    """
    cells, _ = body.triangles
    total = np.zeros(len(points))
    for part in np.array_split(np.arange(len(points)), max(1, len(points) * len(cells) // 2_000_000)):
        r = body.vertices[cells][None] - points[part][:, None, None]
        length = np.linalg.norm(r, axis=-1)
        r0, r1, r2 = np.moveaxis(r, 2, 0)
        l0, l1, l2 = np.moveaxis(length, 2, 0)
        volume = (r0 * cross(r1, r2)).sum(-1)
        below = l0 * l1 * l2 + (r0 * r1).sum(-1) * l2 + (r1 * r2).sum(-1) * l0 + (r2 * r0).sum(-1) * l1
        total[part] = 2 * np.arctan2(volume, below).sum(1) / (4 * np.pi)
    return total


def distance_to_surface(body: Polyhedron, points: Array) -> Array:
    """Return the distance (n,) of points (n, 3) from the surface of a body [m]."""
    cells, _ = body.triangles
    a, b, c = (body.vertices[cells[:, k]] for k in range(3))
    best = np.full(len(points), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        along = q - p
        arm = points[:, None] - p
        share = np.clip((arm * along).sum(-1) / (along * along).sum(-1), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(arm - share[..., None] * along, axis=-1).min(1))
    normal = cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    height = ((points[:, None] - a) * normal).sum(-1)
    foot = points[:, None] - height[..., None] * normal
    inside = np.ones(height.shape, dtype=bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (cross(q - p, foot - p) * normal).sum(-1) >= 0
    return np.asarray(np.minimum(best, np.where(inside, np.abs(height), np.inf).min(1)))


def inner_point(body: Polyhedron) -> Array:
    """Return a point well inside a body (3,) [m]."""
    if body.convex or winding(body, body.centroid[None])[0] > 0.5:
        return body.centroid
    cells, face = body.triangles
    middle = body.vertices[cells].mean(1)
    candidates = np.vstack([middle - share * body.size * body.normals[face] for share in (0.3, 0.1, 0.03, 0.01)])
    inside = candidates[winding(body, candidates) > 0.5]
    found: Array = inside[int(np.argmax(distance_to_surface(body, inside)))]
    return found
