"""All bodies of a model meshed, with their unknowns numbered; identical bodies share one :class:`Shape`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from concio.errors import InputError
from concio.fem.body import Shape
from concio.fem.constitutive import constitutive_matrix
from concio.fem.elements import build
from concio.fem.mesh import mesh_body
from concio.kinematics.frames import cross
from concio.kinematics.rigid import rigid_operator
from concio.model.materials import Elastic
from concio.model.model import Body, Model

Array = np.ndarray

RIGID, FIXED = -1, -2
"""Shape numbers of bodies that have no mesh."""

LARGEST = 20_000_000
"""Largest number of unknowns concio accepts."""


@dataclass(frozen=True, eq=False)
class Discretisation:
    """Meshed bodies and the numbering of their unknowns.

    Parameters
    ----------
    model : Model
    shapes : tuple of Shape
        One for each distinct elastic body.
    shape_of : (B,) integer array
        Shape of each body of the model; ``RIGID`` or ``FIXED`` where there is none.
    offsets : (B+1,) integer array
        Unknowns of body b are ``offsets[b]:offsets[b+1]``: (x, y) node by node for an elastic body; for a rigid body
        the displacement of its centroid and its rotation times ``reach[b]``; none for a fixed body.
    origins : (B, 2) array
        First vertex of each body [m]; node coordinates of a shape are relative to it.
    centroids : (B, 2) array
        [m].
    reach : (B,) array
        Radius of gyration of each body, which turns rotations into lengths [m].
    """

    model: Model
    shapes: tuple[Shape, ...]
    shape_of: Array
    offsets: Array
    origins: Array
    centroids: Array
    reach: Array

    @property
    def unknowns(self) -> int:
        """Number of unknowns before supports are applied."""
        return int(self.offsets[-1])

    @cached_property
    def size(self) -> float:
        """Longer side of the box around all bodies [m]; it does not depend on where the origin is."""
        corners = np.array([(b.outline.min(0), b.outline.max(0)) for b in self.model.bodies])
        return float((corners[:, 1].max(0) - corners[:, 0].min(0)).max())

    def nodes(self, b: int) -> Array:
        """Node coordinates (n, 2) of an elastic body; outline vertices of any other [m]."""
        if self.shape_of[b] < 0:
            return self.model.bodies[b].outline
        points: Array = self.shapes[self.shape_of[b]].elements.nodes + self.origins[b]
        return points

    def stiffness(self) -> sp.csr_array:
        """Block-diagonal stiffness of all bodies (N, N) [kN/m]; rows of rigid bodies are empty."""
        counts, columns, values = [], [], []
        for b, s in enumerate(self.shape_of):
            if s >= 0:
                K = self.shapes[s].K
                counts.append(np.diff(K.indptr))
                columns.append(K.indices.astype(np.int64) + self.offsets[b])
                values.append(K.data)
            elif s == RIGID:
                counts.append(np.zeros(3, dtype=np.int64))
        n = self.unknowns
        if not values:
            return sp.csr_array((n, n))
        indptr = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
        return sp.csr_array((np.concatenate(values), np.concatenate(columns), indptr), shape=(n, n))

    def point_operator(self, b: int, point: Array) -> tuple[Array, Array]:
        """Return (unknowns (k,), coefficients (2, k)) giving the displacement of a point that moves with body b.

        Raises
        ------
        InputError
            The point lies outside the meshed body.
        """
        s = self.shape_of[b]
        if s == FIXED:
            return np.zeros(0, dtype=int), np.zeros((2, 0))
        if s == RIGID:
            return self.offsets[b] + np.arange(3), rigid_operator(np.asarray(point) - self.centroids[b], self.reach[b])
        elements = self.shapes[s].elements
        local = np.asarray(point, dtype=float) - self.origins[b]
        distance = np.linalg.norm(elements.nodes - local, axis=1)
        size = float(np.ptp(elements.nodes, axis=0).max())
        nearest = int(np.argmin(distance))
        if distance[nearest] <= 1e-9 * size:
            nodes, weights = np.array([nearest]), np.ones(1)
        else:
            nodes, weights = _interpolate(elements.nodes, elements.cells, local, size)
            if not len(nodes):
                name = self.model.bodies[b].name
                msg = f"the point ({point[0]:g}, {point[1]:g}) lies outside the block"
                raise InputError(msg, where=f"block '{name}'", hint="give a point inside it or on its outline")
        dofs = self.offsets[b] + (2 * nodes[:, None] + np.arange(2)).ravel()
        rows = np.zeros((2, 2 * len(nodes)))
        rows[0, 0::2] = rows[1, 1::2] = weights
        return dofs, rows


def _interpolate(nodes: Array, cells: Array, point: Array, size: float) -> tuple[Array, Array]:
    """Return corner nodes and linear weights of a point, by splitting elements into triangles."""
    triangles = cells if cells.shape[1] == 3 else np.vstack([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    a, b, c = (nodes[triangles[:, i]] for i in range(3))
    det = cross(b - a, c - a)
    beta, gamma = cross(point - a, c - a) / det, cross(b - a, point - a) / det
    weights = np.column_stack([1 - beta - gamma, beta, gamma])
    best = int(np.argmax(weights.min(axis=1)))
    if weights[best].min() < -1e-6:
        return np.zeros(0, dtype=int), np.zeros(0)
    return triangles[best], weights[best]


def discretise(model: Model, breaks: Mapping[int, Sequence[Array]] | None = None) -> Discretisation:
    """Mesh every body of a model.

    Parameters
    ----------
    model : Model
    breaks : mapping of body number to list of arrays
        For each edge of a body, where interfaces begin or end [m from the edge's first vertex].

    Raises
    ------
    GeometryError, InputError
        A body cannot be meshed, or the mesh would be too large.
    """
    known: dict[tuple[object, ...], int] = {}
    shapes: list[Shape] = []
    count = len(model.bodies)
    shape_of = np.full(count, FIXED)
    sizes = np.zeros(count, dtype=np.int64)
    for b, body in enumerate(model.bodies):
        if body.kind == "fixed":
            continue
        if body.kind == "rigid":
            shape_of[b], sizes[b] = RIGID, 3
            continue
        cuts = list(breaks[b]) if breaks and b in breaks else [np.zeros(0)] * len(body.outline)
        size = _target_size(model, body)
        key = _key(body, size, cuts)
        if key not in known:
            if body.grid is None:
                _check_size(2 * body.area * (model.refinement / size) ** 2, f"block '{body.name}'")
            known[key] = len(shapes)
            shapes.append(_shape(model, body, size, cuts))
        shape_of[b] = known[key]
        sizes[b] = shapes[known[key]].unknowns
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    _check_size(float(offsets[-1]))
    centroids = np.array([b.centroid for b in model.bodies])
    reach = np.array([b.moments.radius_of_gyration for b in model.bodies])
    origins = np.array([b.outline[0] for b in model.bodies])
    return Discretisation(model, tuple(shapes), shape_of, offsets, origins, centroids, reach)


def _check_size(unknowns: float, where: str | None = None) -> None:
    if unknowns > LARGEST:
        msg = f"the mesh has {unknowns:,.0f} unknowns, more than {LARGEST:,}"
        raise InputError(msg, where=where, hint="use larger elements or a smaller model")


def _target_size(model: Model, body: Body) -> float:
    size = body.mesh_size or model.mesh_size
    if size is None:
        size = float(np.ptp(body.outline, axis=0).max()) / 4
    if not (0 < size < np.inf):
        msg = f"mesh size {size:g} must be positive and finite"
        raise InputError(msg, where=f"block '{body.name}'")
    return size


def _key(body: Body, size: float, cuts: list[Array]) -> tuple[object, ...]:
    unit = 1e-9 * float(np.ptp(body.outline, axis=0).max())

    def rounded(values: Array) -> bytes:
        return np.round(values / unit).astype(np.int64).tobytes()

    origin = body.outline[0]
    grid = (
        None if body.grid is None else tuple(rounded(np.asarray(g) - o) for g, o in zip(body.grid, origin, strict=True))
    )
    pieces = tuple(rounded(c) for c in cuts) if body.grid is None else ()
    return (rounded(body.outline - origin), body.material, body.thickness, grid, round(size / unit), pieces)


def _shape(model: Model, body: Body, size: float, cuts: list[Array]) -> Shape:
    material = model.materials[body.material]
    if not isinstance(material, Elastic):
        msg = f"material '{body.material}' is not elastic"
        raise InputError(msg, where=f"block '{body.name}'")
    D = constitutive_matrix(material, model.plane)
    points, cells = mesh_body(body, size, model.refinement, cuts)
    elements = build(points - body.outline[0], cells, model.element, D)
    return Shape(body.outline - body.outline[0], elements, D, body.thickness)
