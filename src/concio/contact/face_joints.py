"""Joints of faces in motion: contact points over the common polygon of two faces, with the area each stands for.

Joints with stiffness, cohesion, tensile or compressive strength need areas, which corners and edges do not have. Each
patch as described gets the points that it has in statics (:mod:`concio.contact.patch_points`). A corner of its polygon
is a material point of one face, moved back into the other face where it has left it: as faces slide over each other,
corners of either body bound what they have in common. The points and their areas follow the corners linearly. So no
point stands where the two faces do not both reach, and a hinge lies on the boundary of one of them.

Corners and edges of the two faces are no contacts of their own while their joint stands.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp

from concio.contact.patch_points import CRUSHING, STIFF, corner_points, spread_points
from concio.contact.polygon_points import nearest_inside, polygon_weights
from concio.kinematics.frames import cross, dot, norm
from concio.model.interfaces.detect import SLIVER_SHARE
from concio.model.interfaces.patch import Patch

if TYPE_CHECKING:
    from concio.contact.laws import RuleBook
    from concio.contact.moving_solids import MovingSolids, PlacedSolids
    from concio.model.materials import JointLaw
    from concio.model.model import Model
    from concio.model.polyhedron import Polyhedron

Array = np.ndarray

FACING = float(np.cos(np.deg2rad(45.0)))
"""Cosine of the angle between two faces up to which they are a joint."""

NEAR = 1e-6
"""Distance over the size of a patch within which its corner is a corner of a body."""


@dataclass(frozen=True, eq=False)
class FaceJoints:
    """Joints of faces, j in all, with v corners and p points.

    Parameters
    ----------
    face, body : (j, 2) integer arrays
        Of bodies a and b.
    master : (j,) integer array
        Whose plane the joint lies in: 0 that of a, 1 that of b.
    first : (j + 1,) integer array
        Corners of joint k are ``first[k]:first[k + 1]``, counter-clockwise about the normal from a to b.
    owner : (v,) integer array
        Whose material point a corner is, 0 or 1.
    flat : (v, 2) array
        Along the tangents of that face, from its first corner [m].
    of : (p,) integer array
        Joint of each point.
    number : (p,) integer array
        Of a point among those of its two faces.
    weight : (p, v) CSR array
        Points as means of corners.
    share : (p,) array
        Area over that of the corners' polygon as described [-], times ``whole`` [m2].
    drawn : (p,) array
        Distance as drawn that counts as none [m].
    bonded : (p,) boolean array
    whole : (j,) array
        Area as described [m2].
    least : (j,) array
        Area below which a joint is none [m2].
    """

    face: Array
    body: Array
    master: Array
    first: Array
    owner: Array
    flat: Array
    of: Array
    number: Array
    weight: sp.csr_array
    share: Array
    drawn: Array
    bonded: Array
    whole: Array
    least: Array

    def __len__(self) -> int:
        return len(self.face)

    @property
    def joint(self) -> Array:
        """Joint of each corner (v,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.first))

    def picked(self, which: Array) -> FaceJoints:
        """Return some of the joints, of a mask (j,)."""
        if which.all():
            return self
        renumbered = np.cumsum(which) - 1
        corners, points = which[self.joint], which[self.of]
        first = np.concatenate([[0], np.cumsum(np.diff(self.first)[which])])
        return FaceJoints(
            self.face[which], self.body[which], self.master[which], first, self.owner[corners], self.flat[corners],
            renumbered[self.of[points]], self.number[points], self.weight[points][:, corners], self.share[points],
            self.drawn[points], self.bonded[points], self.whole[which], self.least[which],
        )  # fmt: skip

    def touch(self, solids: MovingSolids, placed: PlacedSolids) -> tuple[Array, Array, Array, Array, Array]:
        """Return points (p, 3), frames (p, 3, 3), gaps (p,), valid joints (j,) and their areas over those as described.

        Gaps are along the normal of the master's face; a point lies on the other one. Areas are those seen along the
        mean of both normals.
        """
        joint, other = self.joint, 1 - self.owner
        corners = _on_plane(solids, placed, self.face[joint, self.owner], self.flat)
        met = self.face[joint, other]
        start, tangent, normal = placed.start[solids.face_start[met]], placed.tangent[met], placed.normal[met]
        away, across = corners - start, cross(normal, tangent)
        at = np.stack([dot(away, tangent), dot(away, across)], axis=1)
        at = nearest_inside(solids.sides[met], at)
        corners = start + at[:, :1] * tangent + at[:, 1:] * across
        own = corners + dot(away, normal)[:, None] * normal
        which = np.arange(len(self))
        main, minor = self.face[which, self.master], self.face[which, 1 - self.master]
        sign = np.where(self.master == 0, 1.0, -1.0)
        way, level, begin = sign[:, None] * placed.normal[main], placed.tangent[main], solids.face_start[main]
        below, facing = placed.normal[minor], -dot(placed.normal[main], placed.normal[minor])
        ahead = placed.start[begin][joint]
        between = way - sign[:, None] * below
        area = self._areas(own, between / norm(between)[:, None])
        corners = corners - dot(corners - ahead, way[joint])[:, None] * way[joint]
        valid = (area > self.least) & (facing > FACING)
        point = self.weight @ corners
        of, safe = self.of, np.where(facing > FACING, facing, 1.0)
        from_minor = dot(placed.start[solids.face_start[minor]][of] - point, below[of])
        gap = -from_minor / safe[of]
        n = way[of]
        frame = np.stack([n, level[of], cross(n, level[of])], axis=1)
        return point + (sign[of] * gap)[:, None] * n, frame, gap, valid, area / self.whole

    def _areas(self, corners: Array, way: Array) -> Array:
        """Return the areas (j,) of polygons with corners (v, 3) about directions (j, 3) [m2]."""
        ahead = np.arange(len(corners)) + 1
        ahead[self.first[1:] - 1] = self.first[:-1]
        near = corners[self.first[:-1]][self.joint]
        twice = dot(cross(corners - near, corners[ahead] - near), way[self.joint])
        return np.asarray(0.5 * np.add.reduceat(twice, self.first[:-1]))

    def covers(self, solids: MovingSolids, corner: Array, face: Array, edges: Array) -> Array:
        """Return the joint that corners on faces (q,), then pairs of edges (r, 2), belong to (q + r,), -1 for none."""
        vertices, own_edges = solids.rings, solids.face_edges
        on, crossing = [], []
        for k, (a, b) in enumerate(self.face.tolist()):
            for g, f in ((b, a), (a, b)):
                on.append(np.column_stack([vertices[g] * len(solids.normal) + f, np.full(len(vertices[g]), k)]))
            both = (own_edges[a][:, None] * len(solids.edge) + own_edges[b]).ravel()
            crossing.append(np.column_stack([both, np.full(len(both), k)]))
        return np.concatenate(
            [_looked_up(on, corner.astype(np.int64) * len(solids.normal) + face),
             _looked_up(crossing, edges[:, 0].astype(np.int64) * len(solids.edge) + edges[:, 1])]
        )  # fmt: skip


def face_joints(
    model: Model, rules: RuleBook, patches: Sequence[Patch], solids: MovingSolids, tolerance: float
) -> FaceJoints | None:  # fmt: skip
    """Return the joints of the patches of a model whose laws need areas; None where there are none."""
    laws = list(model.laws.values())
    needs = np.array([needs_area(law) for law in laws])
    if not needs.any() or not patches:
        return None
    a, b = np.array([(p.a, p.b) for p in patches]).T
    law, opening = rules.find(a, b)
    pick = np.flatnonzero(needs[law]).tolist()
    if not pick:
        return None
    faces = [np.searchsorted(solids.face_body, np.arange(len(model.bodies)))[i] for i in (a, b)]
    parts: list[FaceJoints] = []
    count: dict[tuple[int, int], int] = {}
    for k in pick:
        patch, name = patches[k], (int(faces[0][k] + patches[k].face_a), int(faces[1][k] + patches[k].face_b))
        one = _joint(patch, name, laws[law[k]], tolerance, float(opening[k]), model.contact_points, solids,
                     model.polyhedra)  # fmt: skip
        parts.append(replace(one, number=one.number + count.get(name, 0)))
        count[name] = count.get(name, 0) + len(one.number)
    corners = np.array([len(p.owner) for p in parts])

    def joined(name: str) -> Array:
        return np.concatenate([getattr(p, name) for p in parts])

    return FaceJoints(
        joined("face"), joined("body"), joined("master"), np.concatenate([[0], np.cumsum(corners)]), joined("owner"),
        joined("flat"), np.repeat(np.arange(len(parts)), [len(p.of) for p in parts]), joined("number"),
        sp.csr_array(sp.block_diag([p.weight for p in parts])), joined("share"), joined("drawn"), joined("bonded"),
        joined("whole"), joined("least"),
    )  # fmt: skip


def needs_area(law: JointLaw) -> bool:
    """Return whether a law has what goes with areas: stiffness, cohesion, tensile or compressive strength."""
    soft = law.normal_stiffness is not None or law.tangential_stiffness is not None
    return bool(soft or law.cohesion or law.tensile_strength or law.compressive_strength is not None)


def stated_points(patch: Patch, law: JointLaw, contact_points: str | int) -> tuple[Array, Array]:
    """Return the contact points (m, 3) of a patch of two rigid blocks, and their areas (m,): those of statics."""
    crushes, soft = law.compressive_strength is not None, law.normal_stiffness is not None
    n = 0 if contact_points == "corners" else CRUSHING if crushes else STIFF if soft else 0
    if contact_points not in ("auto", "corners"):
        n = int(contact_points)
    if n:
        return spread_points(patch, n, graded=crushes)
    point, area, _ = corner_points([patch])
    return point, area


def _joint(
    patch: Patch, name: tuple[int, int], law: JointLaw, tolerance: float, opening: float, points: str | int,
    solids: MovingSolids, bodies: Sequence[Polyhedron],
) -> FaceJoints:  # fmt: skip
    """Return one joint."""
    ring, size = patch.polygon, patch.size
    sides = list(zip(name, (bodies[patch.a].centroid, bodies[patch.b].centroid), strict=True))
    near = [np.array([norm(solids.start[solids.rings[f]] + centre - x).min() for x in ring]) <= NEAR * size + tolerance
            for f, centre in sides]  # fmt: skip
    owner = np.where(near[1], 1, 0)
    if near[0].all() and not near[1].all():
        owner[:] = 0
    master = 1 if near[0].all() and not near[1].all() else 0
    flat = np.empty((len(ring), 2))
    for side, (f, centre) in enumerate(sides):
        away = ring - centre - solids.start[solids.face_start[f]]
        ways = np.stack([solids.tangent[f], cross(solids.normal[f], solids.tangent[f])])
        flat[owner == side] = (away @ ways.T)[owner == side]
    point, area = stated_points(patch, law, points)
    frame = patch.frame
    weight = polygon_weights((ring - ring[0]) @ frame.T, (point - ring[0]) @ frame.T)
    signed = np.where(np.abs(patch.signed_gap) <= tolerance, patch.signed_gap, 0.0)
    closed = (weight @ patch.gap <= tolerance) & (opening <= 0)
    zero, narrow = np.zeros(len(point), dtype=int), float(solids.width[[patch.a, patch.b]].min())
    return FaceJoints(
        np.array([name]), np.array([[patch.a, patch.b]]), np.array([master]), np.array([0, len(ring)]), owner, flat,
        zero, np.arange(len(point)), sp.csr_array(weight), area, weight @ signed, closed, np.array([patch.area]),
        np.array([SLIVER_SHARE * min(narrow**2, patch.area)]),
    )  # fmt: skip


def _on_plane(solids: MovingSolids, placed: PlacedSolids, face: Array, flat: Array) -> Array:
    """Return places (v, 3) of points given along the tangents of faces (v,)."""
    tangent, normal = placed.tangent[face], placed.normal[face]
    across = cross(normal, tangent)
    return np.asarray(placed.start[solids.face_start[face]] + flat[:, :1] * tangent + flat[:, 1:] * across)


def _looked_up(known: list[Array], key: Array) -> Array:
    """Return the second column of the rows whose first one is a key (n,), -1 where there is none."""
    table = np.concatenate([*known, np.zeros((0, 2), dtype=int)])
    table = table[np.argsort(table[:, 0], kind="stable")]
    if not len(table) or not len(key):
        return np.full(len(key), -1)
    at = np.minimum(np.searchsorted(table[:, 0], key), len(table) - 1)
    return np.where(table[at, 0] == key, table[at, 1], -1)
