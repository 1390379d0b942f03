"""Contacts between macro-blocks, forces on them, and the contact problem of one configuration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from concio.analysis.seismic.linkage import Force
from concio.analysis.seismic.macro_blocks import GROUND, Mechanics
from concio.analysis.seismic.sliding_faces import face_ends, face_of
from concio.contact.assembly import Assembly
from concio.contact.face_points import FacePoints, Standing, Stated
from concio.contact.separate import surroundings
from concio.kinematics.frames import tangents
from concio.kinematics.rigid import motions, rigid_row
from concio.problem.contact_problem import ContactProblem, Laws

Array = np.ndarray


def contacts_of(assembly: Assembly, mechanics: Mechanics, normal_force: Array) -> FacePoints:
    """Return all contacts between different macro-blocks, and both ways of every support of one.

    Parameters
    ----------
    assembly : Assembly
    mechanics : Mechanics
    normal_force : (m,) array
        Of the pairs of the assembly, at the onset [kN].
    """
    pairs, bodies, d = assembly.pairs, assembly.model.bodies, assembly.model.dim
    size = surroundings(assembly.model).of(list(mechanics.of_body))
    macro = np.array([mechanics.of_body.get(i, GROUND) for i in range(len(bodies))])
    a, b = macro[pairs.body_a], macro[pairs.body_b]
    own = np.flatnonzero((a != b) & (pairs.interface >= 0) & (pairs.gap <= 1e-6 * size))
    face = np.array([face_of(assembly, int(k)) for k in own], dtype=int)
    low, high = np.full((len(own), d - 1), -np.inf), np.full((len(own), d - 1), np.inf)
    for i, k in enumerate(own):
        if d == 2:
            low[i], high[i] = face_ends(assembly, macro, int(k), int(face[i]))
            continue
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
    return FacePoints(
        join([a[own], [GROUND] * len(held)]).astype(int), join([b[own], [j.b for j, _ in held]]).astype(int),
        join([face, [0] * len(held)]).astype(int),
        join([pairs.point[own], np.array([j.point for j, _ in held]).reshape(-1, d)]),
        join([pairs.normal[own], normal]), join([pairs.tangents[own], tangents(normal).reshape(-1, d - 1, d)]),
        join([low, -endless]), join([high, endless]),
        Laws(*(join([getattr(laws, k), getattr(free, k)]) for k in Laws.__dataclass_fields__)),
        join([normal_force[own], np.zeros(len(held))]),
    )  # fmt: skip


def on_blocks(q: Standing, forces: tuple[Force, ...], length: float) -> Array:
    """Return forces of constant direction on the unknowns (N,) of macro-blocks where they stand [kN]."""
    G, d = q.centre.shape
    total = np.zeros((G, motions(d)))
    for f in forces:
        at = q.carry(np.array([f.block]), f.point[None])[0]
        total[f.block] += rigid_row(f.force, at - q.centre[f.block], length)
    return total.ravel()


def problem_of(contacts: FacePoints, state: Stated, closed: Array, load: Array) -> ContactProblem:
    """Return the contact problem of rigid macro-blocks whose ``closed`` (k,) contacts count, under a load (N,)."""
    N, d = len(load), contacts.point.shape[1]
    rows = (closed[:, None] * (d - 1) + np.arange(d - 1)).ravel()
    return ContactProblem(
        K=sp.csr_array((N, N)), f=load, C_n=sp.csr_array(state.C_n[closed]), C_t=sp.csr_array(state.C_t[rows]),
        gap=np.zeros(len(closed)), laws=contacts.laws[closed], R=sp.csc_array(sp.eye_array(N)),
        bodies=np.arange(0, N + 1, motions(d)),
    )  # fmt: skip
