"""Consistent nodal forces of the loads of a model, one vector for each load group."""

from __future__ import annotations

import numpy as np

from concio.contact.edge_loads import loaded_bodies, loaded_faces
from concio.contact.face_loads import add_face_load
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID, Discretisation
from concio.fem.edge_integral import edge_weights
from concio.kinematics.rigid import rigid_operator
from concio.model.model import Load

Array = np.ndarray

KINDS = ("weight", "pressure", "traction", "point", "body")


def load_vectors(disc: Discretisation) -> dict[str, Array]:
    """Return the nodal forces (N,) of each load group [kN].

    Raises
    ------
    InputError
        A load names a body that does not exist, or loads nothing.
    """
    vectors: dict[str, Array] = {}
    for load in disc.model.loads:
        f = vectors.setdefault(load.group, np.zeros(disc.unknowns))
        if not np.isfinite(load.value).all():
            msg = f"a {load.kind} load has a value that is not finite"
            raise InputError(msg, where=f"load group '{load.group}'")
        count = 1 if load.kind == "pressure" else disc.dim
        if load.kind in KINDS and len(load.value) != count:
            wanted = {1: "one value", 2: "two components", 3: "three components"}[count]
            msg = f"a {load.kind} load has {len(load.value)} values, it takes {wanted}"
            raise InputError(msg, where=f"load group '{load.group}'")
        if load.kind in ("weight", "body"):
            _volume(disc, load, loaded_bodies(disc.model, load), f)
        elif load.kind in ("pressure", "traction"):
            (_edges if disc.dim == 2 else add_face_load)(disc, load, f)
        elif load.kind == "point":
            _point(disc, load, loaded_bodies(disc.model, load), f)
        else:
            msg = f"unknown load kind '{load.kind}'"
            raise InputError(msg, hint="one of weight, pressure, traction, point, body")
    return vectors


def _volume(disc: Discretisation, load: Load, chosen: list[int], f: Array) -> None:
    vector = np.array(load.value, dtype=float)
    materials = [disc.model.materials[disc.model.bodies[b].material] for b in chosen]
    if load.kind == "weight" and not any(m.unit_weight for m in materials):
        msg = "a weight load acts on bodies without weight"
        raise InputError(msg, where=f"load group '{load.group}'", hint="give their material a unit_weight")
    for b, material in zip(chosen, materials, strict=True):
        body = disc.model.bodies[b]
        density = material.unit_weight if load.kind == "weight" else 1.0
        if not density:
            continue
        at = disc.offsets[b]
        if disc.shape_of[b] == RIGID:
            f[at : at + disc.dim] += density * body.volume * vector
        else:
            nodal = density * disc.shapes[disc.shape_of[b]].volume_weights
            f[at : disc.offsets[b + 1]] += np.outer(nodal, vector).ravel()


def _edges(disc: Discretisation, load: Load, f: Array) -> None:
    for face in loaded_faces(disc.model, load):
        if load.kind == "pressure":
            vector = load.value[0] * face.inward
        else:
            vector = np.array(load.value, dtype=float)
        thickness = disc.model.bodies[face.body].thickness
        for part in face.parts:
            _line_load(disc, face.body, face.edge, part, vector * thickness, f)


def _line_load(disc: Discretisation, b: int, edge: int, part: tuple[float, float], vector: Array, f: Array) -> None:
    """Add a uniform line load ``vector`` [kN/m] on part of an edge."""
    at = disc.offsets[b]
    if disc.shape_of[b] == RIGID:
        body = disc.model.outlines[b]
        p, q = body.vertices[edge], body.vertices[body.following[edge]]
        middle = p + (q - p) / np.linalg.norm(q - p) * (part[0] + part[1]) / 2
        rows = rigid_operator(middle - disc.centroids[b], disc.reach[b])
        f[at : at + 3] += rows.T @ vector * (part[1] - part[0])
        return
    nodes = disc.shapes[disc.shape_of[b]].edges[edge]
    weights = edge_weights(nodes.at, nodes.order, *part)
    np.add.at(f, at + 2 * nodes.nodes[:, None] + np.arange(2), np.outer(weights, vector))


def _point(disc: Discretisation, load: Load, chosen: list[int], f: Array) -> None:
    if load.at is None or len(load.bodies) != 1 or len(chosen) != 1:
        msg = "a point load needs one body and a point"
        raise InputError(msg, where=f"load group '{load.group}'", hint="name the block and give 'at'")
    if disc.shape_of[chosen[0]] == FIXED:
        return
    dofs, rows = disc.point_operator(chosen[0], np.array(load.at, dtype=float))
    np.add.at(f, dofs, rows.T @ np.array(load.value, dtype=float))


def place_forces(disc: Discretisation, body: Array, at: Array, force: Array) -> Array:
    """Return the nodal forces (N,) of forces (k, d) [kN] at points (k, d) of bodies (k,) that can move."""
    f = np.zeros(disc.unknowns)
    for b, point, vector in zip(body.tolist(), at, force, strict=True):
        dofs, rows = disc.point_operator(b, point)
        np.add.at(f, dofs, rows.T @ vector)
    return f
