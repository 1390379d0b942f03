"""Macro-blocks where they stand after a large displacement, and the contacts between them there.

A contact is a point of one macro-block on a face of another. The point stays a point of its block, the face turns with
its own; where the point has slid beyond the face, contact stands at the edge of the face. Faces are taken for the
rectangles round them in the directions of their joint.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from concio.analysis.seismic.linkage import Force
from concio.analysis.seismic.macro_blocks import GROUND, Mechanics, face_of
from concio.contact.assembly import Assembly
from concio.kinematics.frames import cross, tangents
from concio.kinematics.rigid import motions, plane_rotation, rigid_row, rotation_matrix
from concio.problem.contact_problem import ContactProblem, Laws

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Contacts:
    """Contacts between macro-blocks, m in all.

    Parameters
    ----------
    a, b : (m,) integer arrays
        Macro-blocks; ``GROUND`` does not move.
    face : (m,) integer array
        0 where the face belongs to ``a`` and the point to ``b``, 1 the other way round.
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
class Placed:
    """Where macro-blocks stand.

    Parameters
    ----------
    first, centre : (G, d) arrays
        Centres at rest and now [m].
    turn : (G, d, d) array
        Rotations from rest.
    """

    first: Array
    centre: Array
    turn: Array

    @classmethod
    def at_rest(cls, mechanics: Mechanics) -> Placed:
        """Return macro-blocks that have not moved."""
        centre = np.array([b.centre for b in mechanics.blocks])
        return cls(centre, centre, np.tile(np.eye(centre.shape[1]), (len(centre), 1, 1)))

    def carry(self, block: Array | int, point: Array) -> Array:
        """Return where points (m, d) of macro-blocks (m,) are now [m]."""
        block = np.broadcast_to(np.asarray(block), point.shape[:-1])
        arm = np.einsum("mij,mj->mi", self.turn[block], point - self.first[block])
        return np.where((block == GROUND)[:, None], point, self.centre[block] + arm)

    def turned(self, block: Array, vector: Array) -> Array:
        """Return vectors (m, ..., d) turned with macro-blocks (m,)."""
        turn = np.where((block == GROUND)[:, None, None], np.eye(vector.shape[-1]), self.turn[block])
        found: Array = np.einsum("mij,m...j->m...i", turn, vector)
        return found

    def moved(self, velocity: Array, time: float) -> Placed:
        """Return them after screw motions of constant velocity (G, 3 or 6) in space: exact about fixed axes."""
        d = self.centre.shape[1]
        shift, spin = velocity[:, :d] * time, velocity[:, d:] * time
        if d == 2:
            turn = plane_rotation(spin[:, 0])
            swept = _plane_mean(spin[:, 0], shift)
        else:
            turn = rotation_matrix(spin)
            angle = np.linalg.norm(spin, axis=1)[:, None]
            across = cross(spin, shift)
            versine = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2
            small = angle < 1e-4
            safe = np.where(small, 1.0, angle)
            third = np.where(small, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
            swept = shift + versine * across + third * cross(spin, across)
        return replace(self, centre=self.centre + swept, turn=np.einsum("gij,gjk->gik", turn, self.turn))


def _plane_mean(angle: Array, shift: Array) -> Array:
    """Return the displacements (G, 2) of centres that turn with their velocities by angles (G,)."""
    sine = np.sinc(angle / np.pi)
    half = 0.5 * angle * np.sinc(angle / (2 * np.pi)) ** 2
    x, y = shift.T
    return np.column_stack([sine * x - half * y, half * x + sine * y])


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
        Velocities b - a from those of the macro-blocks, rotations times the length of the mechanism.
    """

    gap: Array
    drift: Array
    at: Array
    C_n: sp.csr_array
    C_t: sp.csr_array


def contacts_of(assembly: Assembly, mechanics: Mechanics, normal_force: Array) -> Contacts:
    """Return all contacts between different macro-blocks, and both ways of every support of one.

    Parameters
    ----------
    assembly : Assembly
    mechanics : Mechanics
    normal_force : (m,) array
        Of the pairs of the assembly, at the onset [kN].
    """
    pairs, bodies, d = assembly.pairs, assembly.model.bodies, assembly.model.dim
    size = assembly.model.size
    a = np.array([mechanics.of_body.get(int(i), GROUND) for i in pairs.body_a])
    b = np.array([mechanics.of_body.get(int(i), GROUND) for i in pairs.body_b])
    own = np.flatnonzero((a != b) & (pairs.interface >= 0) & (pairs.gap <= 1e-6 * size))
    face = np.array([face_of(assembly, int(k)) for k in own], dtype=int)
    low, high = np.full((len(own), d - 1), -np.inf), np.full((len(own), d - 1), np.inf)
    for i, k in enumerate(own):
        body = bodies[int(pairs.body_b[k] if face[i] else pairs.body_a[k])]
        arm = np.asarray(body.vertices) - pairs.point[k]
        arm = arm[np.abs(arm @ pairs.normal[k]) <= 1e-5 * size]
        if len(arm) >= d:
            along = arm @ pairs.tangents[k].T
            low[i], high[i] = np.minimum(along.min(0), 0.0), np.maximum(along.max(0), 0.0)
    laws = replace(assembly.laws, tension=np.zeros(len(pairs)))[own]
    held = [(j, sign) for j in mechanics.joints if j.kind == "roller" and j.pulls for sign in (1.0, -1.0)]
    normal = np.array([sign * j.normal for j, sign in held]).reshape(-1, d)
    free = Laws.coulomb(0.0, len(held))
    endless = np.full((len(held), d - 1), np.inf)
    join = np.concatenate
    return Contacts(
        join([a[own], [GROUND] * len(held)]).astype(int), join([b[own], [j.b for j, _ in held]]).astype(int),
        join([face, [0] * len(held)]).astype(int),
        join([pairs.point[own], np.array([j.point for j, _ in held]).reshape(-1, d)]),
        join([pairs.normal[own], normal]), join([pairs.tangents[own], tangents(normal).reshape(-1, d - 1, d)]),
        join([low, -endless]), join([high, endless]),
        Laws(*(join([getattr(laws, k), getattr(free, k)]) for k in Laws.__dataclass_fields__)),
        join([normal_force[own], np.zeros(len(held))]),
    )  # fmt: skip


def stated(contacts: Contacts, q: Placed, length: float) -> Stated:
    """Return the contacts of a configuration; ``length`` [m] turns rotations into displacements."""
    c = contacts
    whole = np.where(c.face == 0, c.a, c.b)
    other = np.where(c.face == 0, c.b, c.a)
    x = q.carry(other, c.point)
    origin = q.carry(whole, c.point)
    n, t = q.turned(whole, c.normal), q.turned(whole, c.tangents)
    along = np.clip(np.einsum("mkd,md->mk", t, x - origin), c.low, c.high)
    at = origin + np.einsum("mk,mkd->md", along, t)
    facing = q.turned(other, c.normal)
    sign = np.where(c.face == 0, 1.0, -1.0)
    gap = sign * ((x - at) * facing).sum(1) / (n * facing).sum(1)
    drift = sign[:, None] * np.einsum("mkd,md->mk", t, x - origin)
    d = at.shape[1]
    m, N, width = len(at), motions(d) * len(q.centre), motions(d)
    row, column, value = [], [], []
    for block, side in ((c.a, -1.0), (c.b, 1.0)):
        moves = np.flatnonzero(block != GROUND)
        arm = at[moves] - q.centre[block[moves]]
        for k in range(d):
            direction = n[moves] if k == 0 else t[moves, k - 1]
            row.append(np.repeat(moves * d + k, width))
            column.append((width * block[moves][:, None] + np.arange(width)).ravel())
            value.append(side * rigid_row(direction, arm, length).ravel())
    every = sp.csr_array(
        (np.concatenate(value), (np.concatenate(row), np.concatenate(column))), shape=(m * d, N)
    )  # fmt: skip
    tangential = np.setdiff1d(np.arange(m * d), np.arange(0, m * d, d))
    return Stated(gap, drift, at, sp.csr_array(every[::d]), sp.csr_array(every[tangential]))


def on_blocks(q: Placed, forces: tuple[Force, ...], length: float) -> Array:
    """Return forces of constant direction on the unknowns (N,) of macro-blocks where they stand [kN]."""
    G, d = q.centre.shape
    total = np.zeros((G, motions(d)))
    for f in forces:
        at = q.carry(np.array([f.block]), f.point[None])[0]
        total[f.block] += rigid_row(f.force, at - q.centre[f.block], length)
    return total.ravel()


def problem_of(contacts: Contacts, state: Stated, closed: Array, load: Array) -> ContactProblem:
    """Return the contact problem of rigid macro-blocks whose ``closed`` (k,) contacts count, under a load (N,)."""
    N, d = len(load), contacts.point.shape[1]
    rows = (closed[:, None] * (d - 1) + np.arange(d - 1)).ravel()
    return ContactProblem(
        K=sp.csr_array((N, N)), f=load, C_n=sp.csr_array(state.C_n[closed]), C_t=sp.csr_array(state.C_t[rows]),
        gap=np.zeros(len(closed)), laws=contacts.laws[closed], R=sp.csc_array(sp.eye_array(N)),
        bodies=np.arange(0, N + 1, motions(d)),
    )  # fmt: skip
