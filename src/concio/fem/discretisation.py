"""All bodies of a model meshed, with their unknowns numbered; identical bodies share one :class:`Shape`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from concio.errors import InputError
from concio.fem.interpolation import interpolated
from concio.fem.plane_shape import Plan, plane_shape
from concio.fem.shape import Shape
from concio.fem.solid import SolidShape
from concio.fem.solid_shape import solid_shape
from concio.kinematics.rigid import motions, rigid_operator
from concio.model.limits import LARGEST_REFINEMENT, LARGEST_UNKNOWNS
from concio.model.materials import Elastic, Rigid
from concio.model.model import Body, Model
from concio.model.polyhedron import Polyhedron
from concio.representation import short_repr

Array = np.ndarray

RIGID, FIXED = -1, -2
"""Shape numbers of bodies that have no mesh."""


@short_repr
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
        Unknowns of body b are ``offsets[b]:offsets[b+1]``: d components node by node for an elastic body; for a
        rigid body the displacement of its centroid and its rotation times ``reach[b]``; none for a fixed body.
    origins : (B, d) array
        First vertex of each body [m]; node coordinates of a shape are relative to it.
    centroids : (B, d) array
        [m].
    reach : (B,) array
        Radius of gyration of each body, which turns rotations into lengths [m].
    """

    model: Model
    shapes: tuple[Shape | SolidShape, ...]
    shape_of: Array
    offsets: Array
    origins: Array
    centroids: Array
    reach: Array

    def of_same_meshes(self, model: Model) -> Discretisation | None:
        """Return that of a model with the same bodies and loads or laws of its own; None where meshes are others."""
        old, elastic = self.model, {b.material for b in model.bodies if b.kind == "elastic"}
        keys = ("mesh_size", "refinement", "element", "plane")
        same = model.bodies is old.bodies and all(getattr(model, key) == getattr(old, key) for key in keys)
        stiff = all(_deforms_as(model.materials[name], old.materials.get(name)) for name in elastic)
        return replace(self, model=model) if same and stiff else None

    @property
    def unknowns(self) -> int:
        """Number of unknowns before supports are applied."""
        return int(self.offsets[-1])

    @property
    def dim(self) -> int:
        """Dimension d, 2 or 3."""
        return self.model.dim

    @property
    def size(self) -> float:
        """Longest side of the box around all bodies [m]."""
        return self.model.size

    def nodes(self, b: int) -> Array:
        """Node coordinates (n, d) of an elastic body; vertices of any other [m]."""
        if self.shape_of[b] < 0:
            return self.model.bodies[b].vertices
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
                counts.append(np.zeros(motions(self.dim), dtype=np.int64))
        n = self.unknowns
        if not values:
            return sp.csr_array((n, n))
        indptr = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
        return sp.csr_array((np.concatenate(values), np.concatenate(columns), indptr), shape=(n, n))

    def point_operator(self, b: int, point: Array) -> tuple[Array, Array]:
        """Return (unknowns (k,), coefficients (d, k)) giving the displacement of a point that moves with body b.

        Raises
        ------
        InputError
            The point lies outside the meshed body.
        """
        s, d = self.shape_of[b], self.dim
        if s == FIXED:
            return np.zeros(0, dtype=int), np.zeros((d, 0))
        if s == RIGID:
            own = self.offsets[b] + np.arange(motions(d))
            return own, rigid_operator(np.asarray(point) - self.centroids[b], self.reach[b])
        elements = self.shapes[s].elements
        local = np.asarray(point, dtype=float) - self.origins[b]
        distance = np.linalg.norm(elements.nodes - local, axis=1)
        size = float(np.ptp(elements.nodes, axis=0).max())
        nearest = int(np.argmin(distance))
        if distance[nearest] <= 1e-9 * size:
            nodes, weights = np.array([nearest]), np.ones(1)
        else:
            nodes, weights = interpolated(elements.nodes, elements.cells, local)
            if not len(nodes):
                name = self.model.bodies[b].name
                msg = f"the point ({', '.join(f'{v:g}' for v in point)}) lies outside the block"
                raise InputError(msg, where=f"block '{name}'", hint="give a point inside it or on its outline")
        dofs = self.offsets[b] + (d * nodes[:, None] + np.arange(d)).ravel()
        return dofs, np.kron(weights, np.eye(d))


def _deforms_as(new: Elastic | Rigid, old: Elastic | Rigid | None) -> bool:
    """Return whether two materials have the same stiffness."""
    return isinstance(new, Elastic) and isinstance(old, Elastic) and (new.E, new.nu) == (old.E, old.nu)


def discretise(model: Model, breaks: Mapping[int, Sequence[Any]] | None = None) -> Discretisation:
    """Mesh every body of a model.

    Parameters
    ----------
    model : Model
    breaks : mapping of body number to list
        Where interfaces lie on a body: in the plane for each edge where they begin or end [m from the edge's first
        vertex], in space a :class:`concio.fem.solid_mesh.Mark` each.

    Raises
    ------
    GeometryError, InputError
        A body cannot be meshed, or the mesh would be too large.
    """
    if not 1 <= model.refinement <= LARGEST_REFINEMENT:
        msg = f"refinement = {model.refinement} must lie between 1 and {LARGEST_REFINEMENT:,}"
        raise InputError(msg, hint="2 splits every element in two along each side")
    known: dict[tuple[object, ...], int] = {}
    shapes: list[Shape | SolidShape] = []
    count = len(model.bodies)
    shape_of = np.full(count, FIXED)
    sizes = np.zeros(count, dtype=np.int64)
    for b, body in enumerate(model.bodies):
        if body.kind == "fixed":
            continue
        if body.kind == "rigid":
            shape_of[b], sizes[b] = RIGID, motions(model.dim)
            continue
        size = _target_size(model, body)
        _check_size(_unknowns(model, body, size), f"block '{body.name}'")
        marks = breaks[b] if breaks and b in breaks else ()
        plan: Plan[Shape] | Plan[SolidShape] = (
            plane_shape(model, body, size, marks) if isinstance(body, Body) else solid_shape(model, body, size, marks)
        )
        key = plan.key
        if key not in known:
            known[key] = len(shapes)
            shapes.append(plan.build())
        shape_of[b] = known[key]
        sizes[b] = shapes[known[key]].unknowns
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    _check_size(float(offsets[-1]))
    centroids = np.array([b.centroid for b in model.bodies])
    reach = np.array([b.moments.radius_of_gyration for b in model.bodies])
    origins = np.array([b.vertices[0] for b in model.bodies])
    return Discretisation(model, tuple(shapes), shape_of, offsets, origins, centroids, reach)


def _check_size(unknowns: float, where: str | None = None) -> None:
    if not unknowns <= LARGEST_UNKNOWNS:
        msg = f"the mesh has {unknowns:,.0f} unknowns, more than {LARGEST_UNKNOWNS:,}"
        raise InputError(msg, where=where, hint="use larger elements or a smaller model")


def _unknowns(model: Model, body: Body | Polyhedron, size: float) -> float:
    """Return about how many unknowns the mesh of a body has, found without making it."""
    split = float(model.refinement)
    if isinstance(body, Body) and body.grid is not None:
        return float(model.dim * np.prod([float(len(lines)) * split for lines in body.grid]))
    count = body.volume / body.thickness * (split / size) ** model.dim
    if isinstance(body, Polyhedron):
        if body.grid is not None:
            count = max(count, float(np.prod(body.grid.shape[:3])) * split**3)
    else:  # a film thinner than its elements has them all along it
        around = float(np.hypot(*(body.vertices[body.following] - body.vertices).T).sum())
        count = max(count, around * split / size)
    return model.dim * count


def _target_size(model: Model, body: Body | Polyhedron) -> float:
    size = body.mesh_size or model.mesh_size
    if size is None:
        size = body.length / 2 if isinstance(body, Polyhedron) else float(np.ptp(body.vertices, axis=0).max()) / 4
    if not (0 < size < np.inf):
        msg = f"mesh size {size:g} must be positive and finite"
        raise InputError(msg, where=f"block '{body.name}'")
    return size
