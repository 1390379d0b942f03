"""Where polyhedra touch: a corner of one on a face of another, an edge of one across an edge of another.

The corners of the common polygon of two faces are of these two sorts, and so are all other contacts of edges and
corners. A corner on a face has the face's normal, two edges have the direction at right angles to both. Gaps are exact
at each point. Tangents turn with the body whose face or edge it is, so that what pairs remember keeps its meaning.

Where features coincide, as at the corners of a stack, one point stands for all of them, and it stays the same as long
as it touches: points that take turns would make the compliance of a joint jump.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.face_joints import FaceJoints
from concio.contact.moving_solids import MovingSolids, PlacedSolids
from concio.contact.polygon_points import outside
from concio.kinematics.frames import cross, dot, norm
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import swept

Array = np.ndarray

PARALLEL = 2e-3
"""Sine of the angle between two edges below which they do not cross."""

SAME = 1e-7
"""Distance along the joint over the size of the model below which two points of one pair of bodies are one."""


@dataclass(frozen=True, eq=False)
class SolidTouch:
    """Contact points: corners on faces, then pairs of edges, then points of joints of faces; m in all.

    Parameters
    ----------
    point : (m, 3) array
    frame : (m, 3, 3) array
        Normal from body a to body b, and tangents, as rows.
    gap : (m,) array
        [m].
    valid : (m,) boolean array
        Whether the features stand over each other, and no other point stands for them.
    length : (j,) array
        Areas of joints of faces over those as described.
    """

    point: Array
    frame: Array
    gap: Array
    valid: Array
    length: Array

    @property
    def normal(self) -> Array:
        """Unit normals from body a to body b (m, 3)."""
        return np.asarray(self.frame[:, 0])


@dataclass(frozen=True, eq=False)
class SolidToucher:
    """What is needed of the candidates in every step, gathered once.

    Parameters
    ----------
    solids : MovingSolids
    corner, face : (q,) integer arrays
    edges : (r, 2) integer array
        Of body a, of body b.
    sign : (r,) array
        Of the normal along the cross product of the two edges.
    body_a, body_b : (q + r,) integer arrays
        Of corners on faces, a is the body of the face.
    slack : float
        How far beyond the boundary of a face, or the end of an edge, a point still stands over it, beside what its
        vertex has [m].
    same : float
        Distance along the joint below which points are one [m].
    near : (n, 2) integer array
        Points of one pair of bodies that may coincide.
    chosen : (m,) boolean array
        Points that were valid when last examined.
    joints : FaceJoints or None
        Whose points come last.
    joint : (q + r,) integer array
        Joint that a corner or a pair of edges belongs to, -1 for none: it touches where that joint is none.
    """

    solids: MovingSolids
    corner: Array
    face: Array
    edges: Array
    sign: Array
    body_a: Array
    body_b: Array
    slack: float
    same: float
    near: Array
    chosen: Array
    joints: FaceJoints | None
    joint: Array

    def touch(self, placed: PlacedSolids) -> SolidTouch:
        """Return the contact points of placed surfaces."""
        solids = self.solids
        point, normal = placed.start[self.corner], placed.normal[self.face]
        tangent = placed.tangent[self.face]
        away = point - placed.start[solids.face_start[self.face]]
        gap = dot(normal, away)
        frame = np.stack([normal, tangent, cross(normal, tangent)], axis=1)
        over = outside(solids.sides[self.face], dot(away, frame[:, 1]), dot(away, frame[:, 2]))
        over = over <= self.slack + solids.beside[self.corner]
        crossing = Crossing.of(placed.start[solids.edge[self.edges]], self.sign)
        touch = SolidTouch(
            np.concatenate([point, crossing.point]), np.concatenate([frame, crossing.frame]),
            np.concatenate([gap, crossing.gap]), np.concatenate([over, crossing.beyond <= self.slack]), np.zeros(0),
        )  # fmt: skip
        if self.joints is not None:
            touch = self._with_joints(touch, self.joints, placed)
        self._one_for_all(touch)
        return touch

    def _with_joints(self, touch: SolidTouch, joints: FaceJoints, placed: PlacedSolids) -> SolidTouch:
        """Return the contact points with those of joints, and without the corners and edges that these stand for."""
        point, frame, gap, stands, area = joints.touch(self.solids, placed)
        own = np.flatnonzero(self.joint >= 0)
        touch.valid[own[stands[self.joint[own]]]] = False
        return SolidTouch(
            np.concatenate([touch.point, point]), np.concatenate([touch.frame, frame]),
            np.concatenate([touch.gap, gap]), np.concatenate([touch.valid, stands[joints.of]]), area,
        )  # fmt: skip

    def _one_for_all(self, touch: SolidTouch) -> None:
        """Leave one of the points that coincide: that which was there before, else corners before edges."""
        valid = touch.valid
        if len(self.near):
            i, j = self.near.T
            both = valid[i] & valid[j]
            i, j = i[both], j[both]
            apart, normal = touch.point[i] - touch.point[j], touch.normal[i]
            close = norm(apart - dot(apart, normal)[:, None] * normal) <= self.same
            i, j = i[close], j[close]
            rank = np.where(self.chosen, 0, len(valid)) + np.arange(len(valid))
            valid[np.where(rank[i] > rank[j], i, j)] = False
        self.chosen[:] = valid

    def turning(self, touch: SolidTouch, placement: Placement, velocity: Array, spin: Array) -> Array:
        """Return the relative accelerations (m, 3) that turning adds, b seen from a [m/s2].

        Parameters
        ----------
        touch : SolidTouch
        placement : Placement
        velocity : (B, 3) array
            Of the centroids [m/s].
        spin : (B, 3) array
            [rad/s].
        """
        a, b, q = self.body_a, self.body_b, len(self.corner)
        w_a, w_b = spin[a], spin[b]
        swung_a, swung_b = swept(w_a, touch.point - placement.centre[a]), swept(w_b, touch.point - placement.centre[b])
        slip = velocity[b] + swung_b - velocity[a] - swung_a
        found = swept(w_b, swung_b) - swept(w_a, swung_a)
        found[:q] -= 2.0 * swept(w_a[:q], slip[:q])
        if len(self.edges):
            e = slice(q, q + len(self.edges))
            n = touch.normal[e]
            along = self.solids.edge[self.edges]
            turn = placement.turns
            d_a, d_b = (turn[body[e]].apply(self.solids.start[along[:, k, 1]] - self.solids.start[along[:, k, 0]])
                        for k, body in enumerate((a, b)))  # fmt: skip
            both = cross(d_a, d_b)
            grown = cross(swept(w_a[e], d_a), d_b) + cross(d_a, swept(w_b[e], d_b))
            rate = self.sign[:, None] * grown / norm(both)[:, None]
            rate -= dot(rate, n)[:, None] * n
            found[e] += 2.0 * dot(rate, slip[e])[:, None] * n
        if self.joints is not None:
            j = slice(q + len(self.edges), None)
            main = np.where(self.joints.master[self.joints.of, None] == 0, w_a[j], w_b[j])
            found[j] -= 2.0 * swept(main, slip[j])
        return np.asarray(found)


@dataclass(frozen=True, eq=False)
class Crossing:
    """Pairs of edges where they come nearest to each other.

    Parameters
    ----------
    point : (r, 3) array
        Between the two edges [m].
    frame : (r, 3, 3) array
        Normal, direction of the first edge, and what is at right angles to both.
    gap : (r,) array
        [m].
    beyond : (r,) array
        How far beyond the end of one of them that is; negative within both, infinite where they are parallel [m].
    """

    point: Array
    frame: Array
    gap: Array
    beyond: Array

    @classmethod
    def of(cls, ends: Array, sign: Array) -> Crossing:
        """Return the crossings of pairs of edges with ends (r, 2, 2, 3) [m], the normal along ``sign`` d_a x d_b."""
        p, d = ends[:, :, 0], ends[:, :, 1] - ends[:, :, 0]
        d_a, d_b, between = d[:, 0], d[:, 1], p[:, 1] - p[:, 0]
        long_a, long_b, both = norm(d_a), norm(d_b), cross(d_a, d_b)
        size = norm(both)
        skew = size > PARALLEL * long_a * long_b
        safe = np.where(skew, size, 1.0)
        s, u = (dot(cross(between, other), both) / safe**2 for other in (d_b, d_a))
        normal = (sign / safe)[:, None] * both
        gap = dot(normal, between)
        tangent = d_a / long_a[:, None]
        beyond = np.maximum(np.maximum(-s, s - 1.0) * long_a, np.maximum(-u, u - 1.0) * long_b)
        frame = np.stack([normal, tangent, cross(normal, tangent)], axis=1)
        point = p[:, 0] + s[:, None] * d_a + 0.5 * gap[:, None] * normal
        return cls(point, frame, gap, np.where(skew, beyond, np.inf))
