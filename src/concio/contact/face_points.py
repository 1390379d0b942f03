"""Points of bodies on faces of others, where the bodies stand after any displacement, in the plane and in space.

A contact is a point of one body on a face of another. The point stays a point of its body, the face turns with its
own; where the point has slid beyond the face, contact stands at the edge of the face. Faces are taken for the
rectangles round them in the directions of their joint.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.contact.operators import operators, rigid_entries
from concio.contact.points import NOWHERE
from concio.kinematics.frames import dot
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import motions
from concio.problem.contact_problem import Laws

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class FacePoints:
    """Contacts between bodies where they were described, m in all.

    Parameters
    ----------
    a, b : (m,) integer arrays
        Bodies; ``NOWHERE`` does not move.
    face : (m,) integer array
        0 where the face belongs to ``a`` and the point to ``b``, 1 in the reverse case.
    point : (m, d) array
    normal : (m, d) array
        From a to b.
    tangents : (m, d-1, d) array
    low, high : (m, d-1) arrays
        Where the face begins and ends along its tangents, from the point [m].
    laws : Laws
        Without tensile strength.
    force : (m,) array
        Normal forces at the onset [kN].
    """

    a: Array
    b: Array
    face: Array
    point: Array
    normal: Array
    tangents: Array
    low: Array
    high: Array
    laws: Laws
    force: Array


@dataclass(frozen=True, eq=False)
class Standing:
    """Rigid bodies where they stand, with where they were described.

    Parameters
    ----------
    first : (B, d) array
        Centres where they were described [m].
    placement : Placement
    """

    first: Array
    placement: Placement

    @classmethod
    def at_rest(cls, centre: Array) -> Standing:
        """Return bodies of given centres (B, d) that have not moved."""
        return cls(centre, Placement.at_rest(centre))

    @property
    def centre(self) -> Array:
        """Centres (B, d) now [m]."""
        return self.placement.centre

    def carry(self, body: Array | int, point: Array) -> Array:
        """Return where points (m, d) of bodies (m,) are now [m]."""
        own = np.broadcast_to(np.asarray(body), point.shape[:-1])
        return np.where((own == NOWHERE)[:, None], point, self.placement.points(own, point - self.first[own]))

    def turned(self, body: Array, vector: Array) -> Array:
        """Return vectors (m, ..., d) turned with bodies (m,)."""
        still = (body == NOWHERE).reshape(-1, *(1,) * (vector.ndim - 1))
        return np.where(still, vector, self.placement.turns[body].apply(vector))

    def moved(self, velocity: Array, time: float) -> Standing:
        """Return them after screw motions of constant velocity (B, 3 or 6): exact about fixed axes."""
        d = self.centre.shape[1]
        spin = velocity[:, d:] * time
        return Standing(self.first, self.placement.screwed(velocity[:, :d] * time, spin[:, 0] if d == 2 else spin))


@dataclass(frozen=True, eq=False)
class Stated:
    """The contacts of a configuration: where they stand, how far they are open, how they move.

    Parameters
    ----------
    gap : (m,) array
        [m].
    drift : (m, d-1) array
        Place of b against a along the tangents [m].
    at : (m, d) array
    C_n, C_t : arrays (m, N), (m (d-1), N), CSR
        Velocities b - a from those of the bodies, rotations times the length given.
    """

    gap: Array
    drift: Array
    at: Array
    C_n: sp.csr_array
    C_t: sp.csr_array


def stated(contacts: FacePoints, q: Standing, length: float) -> Stated:
    """Return the contacts of bodies that stand so; ``length`` [m] turns rotations into displacements."""
    c = contacts
    whole = np.where(c.face == 0, c.a, c.b)
    other = np.where(c.face == 0, c.b, c.a)
    x = q.carry(other, c.point)
    origin = q.carry(whole, c.point)
    n, t = q.turned(whole, c.normal), q.turned(whole, c.tangents)
    slid = np.einsum("mkd,md->mk", t, x - origin)
    at = origin + np.einsum("mk,mkd->md", np.clip(slid, c.low, c.high), t)
    facing = q.turned(other, c.normal)
    sign = np.where(c.face == 0, 1.0, -1.0)
    gap = sign * dot(x - at, facing) / dot(n, facing)
    (m, d), B = at.shape, len(q.first)
    frame, entries = np.concatenate([n[:, None], t], axis=1), []
    for body, side in ((c.a, -1.0), (c.b, 1.0)):
        moves = np.flatnonzero(body != NOWHERE)
        b = body[moves]
        entries.append(rigid_entries(moves, frame[moves], at[moves] - q.centre[b], length, motions(d) * b, side))
    return Stated(gap, sign[:, None] * slid, at, *operators(entries, m, motions(d) * B, d))
