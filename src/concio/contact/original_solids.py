"""Contact pairs of polyhedra written down once more: what certificates of motions in space are evaluated on.

Nothing here is what a solve kept. Of the search it takes the names of the pairs (a corner and a face, or two edges),
the sense in which two edges touch, and which of the points that coincide stands for the others. Corners, normals, gaps,
rows and laws are worked out again from the model. That bodies do not stand in each other is decided by separating axes
of their convex pieces, without any pair (:meth:`OriginalSolids.deepest`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from concio.contact.convex_bodies import ConvexBodies, pairs_of
from concio.contact.laws import RuleBook
from concio.contact.moving_solids import IN_JOINT, ON_FACE
from concio.contact.original_joints import OriginalJoints
from concio.contact.original_nodes import node_arms, node_columns, node_rows, nodes_belong
from concio.contact.reference import Reference
from concio.contact.rows import Rows
from concio.contact.separating_axes import Sides, every_axis
from concio.contact.slots import Slots
from concio.contact.solid_search import SolidLayout
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID
from concio.kinematics.frames import cross, norm
from concio.kinematics.placement import Placement

Array = np.ndarray

SLACK = 2e-9
"""How far beyond a face or an edge a pair may touch, over the size of the model."""

SAME = 2e-7
"""Distance along the joint over the size of the model below which a point stands for another."""

CHUNK = 4000
"""Pairs of convex pieces whose separating axes are worked out together; bounds the memory."""

SKEW = 2e-3
"""Sine of the angle between edges that cross."""


@dataclass(frozen=True, eq=False)
class _Named:
    """The pairs of a layout by their names.

    Parameters
    ----------
    slots : Slots
        With laws and openings as the model has them.
    faces : int
        How many of the pairs, the first ones, are corners on faces.
    lone : int
        How many are corners on faces or edges; those behind are points of joints.
    body : (m, 2) integer array
    rings : (g, s, 2) integer array
        Vertices at both ends of the sides of faces on which corners stand; a side that begins where it ends fills up.
    level : (g, 3) array
        First tangent of each of them as described.
    of_face : (g,) integer array
        Body of each of them.
    face : (faces,) integer array
        Which of them a pair stands on.
    corner : (faces,) integer array
    edges : (m - faces, 2, 2) integer array
        Vertices at both ends of the edges of either body.
    columns : (m, 12 + k) integer array
        Of rigid bodies, then of nodes.
    joints : OriginalJoints or None
    joint : (lone,) integer array
        Joint that stands for a pair, -1 for none.
    sound : bool
        Whether the points of joints are those of the patches.
    """

    slots: Slots
    faces: int
    lone: int
    body: Array
    rings: Array
    level: Array
    of_face: Array
    face: Array
    corner: Array
    edges: Array
    columns: Array
    joints: OriginalJoints | None
    joint: Array
    sound: bool


class OriginalSolids:
    """Writes the contact pairs of placed polyhedra.

    Parameters
    ----------
    reference : Reference
    """

    def __init__(self, reference: Reference) -> None:
        self.reference = reference
        disc, bodies = reference.disc, reference.model.polyhedra
        self.bodies = bodies
        own = [b.vertices - disc.centroids[i] for i, b in enumerate(bodies)]
        own = [np.vstack(both) for both in zip(own, node_arms(reference), strict=True)]
        self.arms = np.concatenate(own)
        count = [len(arms) for arms in own]
        self.owner = np.repeat(np.arange(len(bodies)), count)
        self.first = np.cumsum(count, dtype=np.intp) - count
        self._named: tuple[SolidLayout, _Named] | None = None
        self.rules = RuleBook(reference.model)
        self.rings, self.level = self._faces()

    def _faces(self) -> tuple[Array, Array]:
        """Return vertices at both ends of the sides of each face (f, s, 2), and its first tangent (f, 3)."""
        rings, level = [], []
        for first, body in zip(self.first, self.bodies, strict=True):
            for f in range(len(body.faces)):
                loops = [first + np.array(loop) for loop in body.loops_of(f)]
                rings.append(np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in loops]))
                level.append(_level(body.normals[f]))
        wide = max(len(ring) for ring in rings)
        filled = [np.concatenate([r, np.full((wide - len(r), 2), r[0, 0])]) for r in rings]
        return np.array(filled, dtype=int), np.array(level)

    def named(self, layout: SolidLayout) -> _Named:
        """Return the pairs that a layout names."""
        if self._named is None or self._named[0] is not layout:
            self._named = layout, self._read(layout)
        return self._named[1]

    def _read(self, layout: SolidLayout) -> _Named:
        """Read the names of the pairs of a layout."""
        solids, disc = self.reference.solids, self.reference.disc
        key = layout.slots.key
        sort, first, second = solids.features(key)
        faces, lone = int((sort == ON_FACE).sum()), int((sort != IN_JOINT).sum())
        corner, face, edges = first[:faces], second[:faces], np.column_stack([first, second])[faces:lone]
        of_face = solids.face_body[face]
        in_joint = solids.face_body[np.column_stack([first, second])[lone:]]
        body = np.concatenate([np.column_stack([of_face, self.owner[corner]]), solids.edge_body[edges], in_joint])
        law, opening = self.rules.find(body.min(axis=1), body.max(axis=1))
        own, at = np.unique(face, return_inverse=True)
        joints, joint = None, np.full(lone, -1)
        share, bonded = np.ones(len(key)), np.zeros(len(key), dtype=bool)
        if layout.toucher.joints is not None:
            joints = OriginalJoints(
                self.reference, layout.toucher.joints, self.rings, self.level, law[lone:], opening[lone:]
            )
            opening[lone:] -= joints.drawn
            bonded[lone:] = joints.bonded
            joint = self._joint_of(joints, corner, face, edges)
        law[:lone] += len(self.reference.model.laws)
        free = disc.shape_of[body] == RIGID
        columns = np.where(free[..., None], disc.offsets[body][..., None] + np.arange(6), disc.unknowns)
        slots = replace(
            layout.slots, body_a=body[:, 0], body_b=body[:, 1], law=law, opening=opening, share=share, bonded=bonded
        )
        columns = np.concatenate([columns.reshape(len(body), 12), *node_columns(self.reference, slots)], axis=1)
        return _Named(
            slots, faces, lone, body, self.rings[own], self.level[own], solids.face_body[own], at, corner,
            solids.edge[edges],
            columns, joints, joint, joints is None or joints.sound,
        )  # fmt: skip

    def _joint_of(self, joints: OriginalJoints, corner: Array, face: Array, edges: Array) -> Array:
        """Return the joint to whose two faces corners and faces (q,), or both edges (r, 2), belong; -1 for none."""
        solids, found = self.reference.solids, np.full(len(corner) + len(edges), -1)
        rings = self.rings[:, :, 0]
        for k, (a, b) in enumerate(joints.joints.face.tolist()):
            on = ((face == a) & np.isin(corner, rings[b])) | ((face == b) & np.isin(corner, rings[a]))
            along = [np.isin(solids.edge[edges[:, side]], rings[f]).all(axis=1) for side, f in ((0, a), (1, b))]
            found[np.concatenate([on, along[0] & along[1]])] = k
        return found

    def at(
        self, layout: SolidLayout, centre: Array, rotation: Array, velocity: Array, spin: Array, strain: Array
    ) -> tuple[Slots, Rows]:
        """Return the pairs and the rows of bodies that stand and move so.

        Parameters
        ----------
        layout : SolidLayout
            Whose pairs.
        centre : (B, 3) array
            [m].
        rotation : (B, 3, 3) array
        velocity : (B, 3) array
            Of the centroids [m/s].
        spin : (B, 3) array
            [rad/s].
        strain : (nodes, 3) array
            Of elastic bodies [m].
        """
        n, sign = self.named(layout), layout.toucher.sign
        place = self._placed(centre, rotation)
        corners = self._corners(n, place, rotation)
        crossings = _crossings(place[n.edges], sign)
        point, frame, gap, beyond = (np.concatenate(both) for both in zip(corners, crossings, strict=True))
        area = np.ones(len(gap))
        if n.joints is None:
            valid = self._standing(layout, n, point, frame[:, 0], beyond, np.zeros(0, dtype=bool))
        else:
            where = n.joints.at(place, centre, rotation)
            valid = self._standing(layout, n, point, frame[:, 0], beyond, where.stands)
            point, frame, gap, valid, area = (
                np.concatenate(both) for both in (
                    (point, where.point), (frame, where.frame), (gap, where.gap),
                    (valid, where.stands[n.joints.joints.of]), (area, where.area),
                )
            )  # fmt: skip
        values, imposed = self._rows(n, point, frame, centre, rotation, velocity, spin)
        of_nodes, strained = node_rows(n.slots, frame, rotation, strain)
        values = np.concatenate([values, *of_nodes], axis=2)
        if of_nodes:
            valid = valid & nodes_belong(self.reference, n.slots, point, gap, centre, rotation)
        turning = self._turning(n, place, point, frame, centre, velocity, spin, sign)
        return n.slots, Rows(
            n.columns, values, gap + strained + n.slots.opening, imposed, turning, valid, area, point, frame
        )

    def _placed(self, centre: Array, rotation: Array) -> Array:
        """Return where the vertices of all bodies are (v, 3) [m]."""
        return np.asarray(centre[self.owner] + np.matmul(rotation[self.owner], self.arms[:, :, None])[:, :, 0])

    def _corners(self, n: _Named, place: Array, rotation: Array) -> tuple[Array, Array, Array, Array]:
        """Return points, frames and gaps of corners over faces, and how far they lie beyond these and beside."""
        sides, at = place[n.rings], place[n.corner]
        from_first = sides - sides[:, :1, :1]
        area = cross(from_first[:, :, 0], from_first[:, :, 1]).sum(axis=1)
        normal = area / norm(area)[:, None]
        along = np.matmul(rotation[n.of_face], n.level[:, :, None])[:, :, 0]
        frame = np.stack([normal, along, cross(normal, along)], axis=1)
        flat = np.matmul(from_first, frame[:, None, 1:].transpose(0, 1, 3, 2))
        frame = frame[n.face]
        off = np.matmul(frame, (at - sides[n.face, 0, 0])[:, :, None])[:, :, 0]
        seen = flat[n.face] - off[:, None, None, 1:]
        return at, frame, off[:, 0], _beyond(seen) - self.reference.solids.beside[n.corner]

    def _standing(
        self, layout: SolidLayout, n: _Named, point: Array, normal: Array, beyond: Array, stands: Array
    ) -> Array:
        """Return the pairs that touch: those chosen that stand over each other, and those that no other stands for.

        Joints that stand, ``stands`` (j,), do so for the corners and edges of their faces.
        """
        size, old = self.reference.disc.size, layout.toucher.chosen[: n.lone]
        free = np.ones(n.lone, dtype=bool)
        own = np.flatnonzero(n.joint >= 0)
        free[own] = ~stands[n.joint[own]]
        chosen = old & (beyond <= SLACK * size) & free
        i, j = layout.toucher.near.T
        same = norm(cross(point[i] - point[j], normal[i])) <= SAME * size
        stood_for = np.zeros(n.lone, dtype=bool)
        for one, other in ((i, j), (j, i)):
            stood_for[other[same & chosen[one]]] = True
        missed = (beyond <= -SLACK * size) & ~chosen & ~stood_for & free
        return np.asarray(chosen | missed)

    def _rows(
        self, n: _Named, point: Array, frame: Array, centre: Array, rotation: Array, velocity: Array, spin: Array
    ) -> tuple[Array, Array]:
        """Return rows (m, 3, 12) of b minus a, and imposed velocities (m, 3)."""
        disc, axes = self.reference.disc, self.reference.spin_axes.axes
        assert axes is not None, "bodies in space"
        values, imposed = np.zeros((len(point), 3, 12)), np.zeros((len(point), 3))
        every = np.matmul(rotation, axes) / disc.reach[:, None, None]
        for k, sign in ((0, -1.0), (1, 1.0)):
            b = n.body[:, k]
            free = sign * (disc.shape_of[b] == RIGID)[:, None, None]
            arm = point - centre[b]
            values[:, :, 6 * k : 6 * k + 3] = free * frame
            values[:, :, 6 * k + 3 : 6 * k + 6] = free * np.matmul(cross(arm[:, None], frame), every[b])
            still = np.flatnonzero(disc.shape_of[b] == FIXED)
            moving = velocity[b[still]] + cross(spin[b[still]], arm[still])
            imposed[still] += sign * (frame[still] * moving[:, None]).sum(axis=2)
        return values, imposed

    def _turning(
        self, n: _Named, place: Array, point: Array, frame: Array, centre: Array, velocity: Array, spin: Array,
        sign: Array,
    ) -> Array:  # fmt: skip
        """Return what turning adds to the relative velocities of pairs (m, 3), per time [m/s2]."""
        if not spin.any():
            return np.zeros((len(point), 3))
        a, b, f, e = n.body[:, 0], n.body[:, 1], n.faces, slice(n.faces, n.lone)
        swung = [cross(spin[c], point - centre[c]) for c in (a, b)]
        slip = velocity[b] + swung[1] - velocity[a] - swung[0]
        seen = cross(spin[b], swung[1]) - cross(spin[a], swung[0])
        seen[:f] -= 2.0 * cross(spin[a[:f]], slip[:f])
        ends = place[n.edges]
        d_a, d_b = (ends[:, k, 1] - ends[:, k, 0] for k in (0, 1))
        grown = cross(cross(spin[a[e]], d_a), d_b) + cross(d_a, cross(spin[b[e]], d_b))
        rate, normal = (sign / norm(cross(d_a, d_b)))[:, None] * grown, frame[e, 0]
        rate = rate - (rate * normal).sum(axis=1, keepdims=True) * normal
        seen[e] += 2.0 * (rate * slip[e]).sum(axis=1, keepdims=True) * normal
        if n.joints is not None:
            main = n.body[n.lone :][np.arange(len(point) - n.lone), n.joints.joints.master[n.joints.joints.of]]
            seen[n.lone :] -= 2.0 * cross(spin[main], slip[n.lone :])
        return np.asarray(np.matmul(frame, seen[:, :, None])[:, :, 0])

    # -- what nobody found ---------------------------------------------------------------------------------------------

    def deepest(self, centre: Array, rotation: Array, strain: Array, share: float, more: float = 0.0) -> float:
        """Return how deep a body stands inside another one, over what it may; at most, where that is less than 1.

        Joints with a stiffness of their own, and joints that crush, are left out, as in the plane.

        Parameters
        ----------
        centre, rotation, strain : (B, 3), (B, 3, 3) and (nodes, 3) arrays
        share : float
            What it may over the narrower body's width, beside what the model was drawn with.
        more : float
            What it may beside [m].
        """
        disc, width = self.reference.disc, self.reference.surface.width
        pieces = self.pieces.placed(Placement(centre, rotation), disc.centroids)
        i, j = pairs_of(pieces, 0.0, disc.shape_of == FIXED)
        a, b = pieces.body[i], pieces.body[j]
        law, opening = self.rules.find(a, b)
        laws = self.reference.laws
        hard = ~((laws.normal[law] > 0) | np.isfinite(laws.cap[law]))
        i, j, a, b, opening = i[hard], j[hard], a[hard], b[hard], opening[hard]
        allowed = share * np.minimum(width[a], width[b]) + 2 * self.reference.tolerance + np.abs(opening) + more
        allowed += self._strained(strain)[a] + self._strained(strain)[b]
        low, high = pieces.boxes
        depth = np.minimum(high[i] - low[j], high[j] - low[i]).min(axis=1, initial=np.inf)
        for k in np.array_split(doubt := np.flatnonzero(depth > allowed), 1 + len(doubt) // CHUNK):
            if len(k):
                one, other = Sides.of(pieces, i[k]), Sides.of(pieces, j[k])
                depth[k] = np.minimum(depth[k], -every_axis(one, other)[1].max(axis=1))
        return float((np.maximum(depth, 0.0) / allowed).max(initial=0.0))

    def _strained(self, strain: Array) -> Array:
        """Return the largest displacement of a node of each body (B,) in its frame [m]."""
        found = np.zeros(len(self.bodies))
        np.maximum.at(found, self.reference.body_of_node, norm(strain))
        return found

    @cached_property
    def pieces(self) -> ConvexBodies:
        """The convex pieces of all bodies."""
        found = ConvexBodies.of(self.bodies)
        if found.left_out:
            msg = f"block '{self.bodies[found.left_out[0]].name}' falls into too many convex pieces: its motion cannot "
            raise InputError(msg + "be certified", hint="divide it into simpler blocks")
        return found


def _level(normal: Array) -> Array:
    """Return the first tangent of a face as described: horizontal, of a horizontal face along x."""
    level = np.hypot(normal[0], normal[1])
    if level > 1e-6:
        return np.asarray(np.array([-normal[1], normal[0], 0.0]) / level)
    along = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
    return np.asarray(along / np.linalg.norm(along))


def _beyond(sides: Array) -> Array:
    """Return how far the origin lies outside polygons with sides (k, s, 2, 2), negative inside [m]."""
    p, q = sides[:, :, 0], sides[:, :, 1]
    along = q - p
    size = (along**2).sum(axis=2)
    share = np.clip(-(p * along).sum(axis=2) / np.where(size > 0, size, 1.0), 0.0, 1.0)
    distance = norm(p + share[:, :, None] * along)
    distance = np.where(size > 0, distance, np.inf).min(axis=1, initial=np.inf)
    turn = np.arctan2(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0], (p * q).sum(axis=2))
    inside = np.abs(turn.sum(axis=1)) > np.pi
    return np.asarray(np.where(inside, -distance, distance))


def _crossings(ends: Array, sign: Array) -> tuple[Array, Array, Array, Array]:
    """Return points, frames, gaps of pairs of edges (k, 2, 2, 3), and how far beyond their ends they are nearest.

    The way from a point of the first edge to one of the second is along both and along the normal.
    """
    start, d = ends[:, :, 0], ends[:, :, 1] - ends[:, :, 0]
    d_a, d_b = d[:, 0], d[:, 1]
    both = cross(d_a, d_b)
    size, longs = norm(both), norm(d)
    skew = size > SKEW * longs.prod(axis=1)
    normal = np.where(skew, sign / np.where(skew, size, 1.0), 0.0)[:, None] * both
    way = np.where(skew[:, None, None], np.stack([d_a, -d_b, normal], axis=2), np.eye(3))
    s, u, gap = np.linalg.solve(way, (start[:, 1] - start[:, 0])[:, :, None])[:, :, 0].T
    beyond = np.maximum(np.maximum(-s, s - 1.0) * longs[:, 0], np.maximum(-u, u - 1.0) * longs[:, 1])
    along = d_a / longs[:, :1]
    frame = np.stack([normal, along, cross(normal, along)], axis=1)
    point = start[:, 0] + s[:, None] * d_a + (0.5 * gap)[:, None] * normal
    return point, frame, gap, np.where(skew, beyond, np.inf)


