"""Points of joints of faces in motion written down once more, from polyhedra and patches as described.

Of the search come the names of the points, whose corner of the common polygon is whose, in which plane a joint lies,
and the weights that make points of corners: these are compared with the points that statics states on the patch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.face_joints import FaceJoints, stated_points
from concio.contact.reference import Reference
from concio.model.interfaces.detect import SLIVER_SHARE

Array = np.ndarray

SAME = 1e-9
"""Distance over the size of the model by which points of a patch may differ."""

STEEP = float(np.cos(np.deg2rad(45.0)))
"""Cosine of the angle between two faces beyond which they are no joint."""


@dataclass(frozen=True, eq=False)
class JointsWhere:
    """Points of joints where bodies stand: places, frames, gaps (p,), valid joints (j,), areas (p,) of points."""

    point: Array
    frame: Array
    gap: Array
    stands: Array
    area: Array


class OriginalJoints:
    """Writes the points of joints of faces.

    Parameters
    ----------
    reference : Reference
    joints : FaceJoints
        Those of a layout.
    rings : (f, s, 2) integer array
        Vertices at both ends of the sides of each face; a side that begins where it ends fills up.
    level : (f, 3) array
        First tangent of each face as described.
    law : (p,) integer array
        Of each point.
    opening : (p,) array
        What the law adds to gaps [m].
    """

    def __init__(
        self, reference: Reference, joints: FaceJoints, rings: Array, level: Array, law: Array, opening: Array
    ) -> None:
        model, solids = reference.model, reference.solids
        self.joints, self.rings, self.level, self.size = joints, rings, level, reference.disc.size
        self.body, laws = joints.body, list(model.laws.values())
        first = np.searchsorted(solids.face_body, np.arange(len(model.bodies)))
        named: dict[tuple[int, int], list[int]] = {}
        for k, patch in enumerate(reference.detection.patches):
            named.setdefault((int(first[patch.a]) + patch.face_a, int(first[patch.b]) + patch.face_b), []).append(k)
        arms, shares, drawn, bonded, wholes, least = [], [], [], [], [], []
        seen: dict[tuple[int, int], int] = {}
        self.sound = True
        for k, name in enumerate(map(tuple, joints.face.tolist())):
            patch = reference.detection.patches[named[name][seen.get(name, 0)]]
            seen[name] = seen.get(name, 0) + 1
            own = slice(joints.first[k], joints.first[k + 1])
            ring, tolerance = patch.polygon, reference.tolerance
            bodies = [model.polyhedra[patch.a], model.polyhedra[patch.b]]
            for x, side in zip(ring, joints.owner[own].tolist(), strict=True):
                body, face = bodies[side], (patch.face_a, patch.face_b)[side]
                normal, corner = body.normals[face], body.vertices[body.faces[face][0]]
                arms.append(x - normal * (normal @ (x - corner)) - body.centroid)
            mine = np.flatnonzero(joints.of == k)
            point, area = stated_points(patch, laws[law[mine[0]]], model.contact_points)
            weight = joints.weight[mine][:, own].toarray()
            self.sound &= len(point) == len(mine) and bool((np.abs(weight.sum(axis=1) - 1.0) < SAME).all())
            self.sound &= bool(len(point) == len(mine) and np.abs(weight @ ring - point).max() <= SAME * self.size)
            shares.append(area / patch.area)
            drawn.append(weight @ np.where(np.abs(patch.signed_gap) > tolerance, 0.0, patch.signed_gap))
            bonded.append((weight @ patch.gap <= tolerance) & (opening[mine] <= 0.0))
            wholes.append(patch.area)
            narrow = min(3.0 * body.volume / body.face_areas.sum() for body in bodies)
            least.append(SLIVER_SHARE * min(narrow**2, patch.area))
        self.arm, self.share, self.drawn = np.array(arms), np.concatenate(shares), np.concatenate(drawn)
        self.bonded, self.whole, self.least = np.concatenate(bonded), np.array(wholes), np.array(least)

    def at(self, place: Array, centre: Array, rotation: Array) -> JointsWhere:
        """Return the points of bodies that stand so.

        Parameters
        ----------
        place : (v, 3) array
            Vertices of all bodies [m].
        centre : (B, 3) array
            [m].
        rotation : (B, 3, 3) array
        """
        joints = self.joints
        of = np.repeat(np.arange(len(joints)), np.diff(joints.first))
        own, met = joints.body[of, joints.owner], joints.face[of, 1 - joints.owner]
        corner = centre[own] + np.einsum("vij,vj->vi", rotation[own], self.arm)
        corner, moved = _inside(corner, place[self.rings[met]])
        which = np.arange(len(joints))
        begin, normal = [], []
        for side in (0, 1):
            ring = place[self.rings[joints.face[which, side]]]
            begin.append(ring[:, 0, 0])
            normal.append(_outward(ring))
        master = joints.master[:, None]
        way = np.where(master == 0, normal[0], -normal[1])
        level = np.einsum("jik,jk->ji", rotation[joints.body[which, joints.master]],
                          self.level[joints.face[which, joints.master]])  # fmt: skip
        origin, other = np.where(master == 0, begin[0], begin[1]), np.where(master == 0, begin[1], begin[0])
        slope = np.where(master == 0, normal[1], normal[0])
        mean = normal[0] - normal[1]
        mean = mean / np.linalg.norm(mean, axis=1)[:, None]
        area = np.array([_area(moved[joints.first[k] : joints.first[k + 1]], mean[k]) for k in range(len(joints))])
        corner = corner - ((corner - origin[of]) * way[of]).sum(axis=1, keepdims=True) * way[of]
        against = -(normal[0] * normal[1]).sum(axis=1)
        stands = (area > self.least) & (against > STEEP)
        point = joints.weight @ corner
        of = joints.of
        steep = (slope * way).sum(axis=1)
        away = ((other[of] - point) * slope[of]).sum(axis=1) / np.where(stands, steep, 1.0)[of]  # along the normal
        gap = np.where(joints.master == 0, 1.0, -1.0)[of] * away
        frame = np.stack([way, level, np.cross(way, level)], axis=1)[of]
        share = self.share * self.whole[of] * (area / self.whole)[of]
        return JointsWhere(point + away[:, None] * way[of], frame, gap, stands, share)


def _outward(ring: Array) -> Array:
    """Return the unit normals (k, 3) of polygons with sides (k, s, 2, 3)."""
    from_first = ring - ring[:, :1, :1]
    area = np.cross(from_first[:, :, 0], from_first[:, :, 1]).sum(axis=1)
    return np.asarray(area / np.linalg.norm(area, axis=1)[:, None])


def _area(ring: Array, way: Array) -> float:
    """Return the area of a polygon (k, 3) about a direction [m2]."""
    return 0.5 * float(np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0) @ way)


def _inside(point: Array, ring: Array) -> tuple[Array, Array]:
    """Return the places nearest to points (v, 3), seen along the normal, in polygons with sides (v, s, 2, 3).

    The second are as far from the planes as the points.
    """
    normal, start = _outward(ring), ring[:, :, 0]
    above = ((point - start[:, 0]) * normal).sum(axis=1, keepdims=True) * normal
    flat = point - above
    p, along = start - flat[:, None], ring[:, :, 1] - start
    q = p + along
    turn = np.arctan2((np.cross(p, q) * normal[:, None]).sum(axis=2), (p * q).sum(axis=2)).sum(axis=1)
    size = (along**2).sum(axis=2)
    share = np.clip(-(p * along).sum(axis=2) / np.where(size > 0, size, 1.0), 0.0, 1.0)
    nearest = p + share[:, :, None] * along
    distance = np.where(size > 0, np.linalg.norm(nearest, axis=2), np.inf)
    pick = np.argmin(distance, axis=1)
    moved, over = flat + nearest[np.arange(len(flat)), pick], (np.abs(turn) > np.pi)[:, None]
    place = np.where(over, flat, moved)
    return place, place + above
