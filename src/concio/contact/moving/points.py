"""Points that move with bodies: ends of ties, supports, control points, points whose history is kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.arguments import closest
from concio.contact.moving.edges import as_complex, as_vectors, dot
from concio.errors import InputError
from concio.fem.discretisation import RIGID, Discretisation
from concio.model.stages import ControlPoint

if TYPE_CHECKING:
    from concio.contact.moving.reference import Reference

Array = np.ndarray

NOWHERE = -1
"""Body number of a point that is fixed in space."""


@dataclass(frozen=True, eq=False)
class MaterialPoints:
    """k points of bodies.

    Parameters
    ----------
    body : (k,) integer array
        ``NOWHERE`` for points fixed in space.
    arm : (k,) complex array
        From the centroid, as described; the position itself of a point fixed in space [m].
    node : (k, w) integer array
        Nodes that carry a point of a meshed body, one past the last where there is none.
    weight : (k, w) array
    columns : (k, 3 + 2 w) integer array
        Unknowns: rigid motion, then nodes; one past the last where there is none.
    reach : (k,) array
        [m].
    """

    body: Array
    arm: Array
    node: Array
    weight: Array
    columns: Array
    reach: Array

    @classmethod
    def of(
        cls, disc: Discretisation, bodies: Sequence[int], points: Array, first_node: Array, node_column: Array
    ) -> MaterialPoints:
        """Return points (k, 2) of bodies, given where the bodies were described [m].

        Raises
        ------
        InputError
            A point of a meshed body lies outside it.
        """
        k, n, nodes = len(bodies), disc.unknowns, len(node_column) - 1
        body = np.array(bodies, dtype=int).reshape(k)
        found: list[tuple[Array, Array]] = []
        for b, point in zip(body.tolist(), points, strict=True):
            if b == NOWHERE or disc.shape_of[b] < 0:
                found.append((np.zeros(0, dtype=int), np.zeros(0)))
                continue
            unknowns, rows = disc.point_operator(b, point)
            found.append((first_node[b] + (unknowns[::2] - disc.offsets[b]) // 2, rows[0, ::2]))
        wide = max((len(v[0]) for v in found), default=0)
        node, weight = np.full((k, wide), nodes), np.zeros((k, wide))
        for i, (own, values) in enumerate(found):
            node[i, : len(own)], weight[i, : len(own)] = own, values
        at_body = np.where(body >= 0, body, 0)
        free = (body >= 0) & (disc.shape_of[at_body] == RIGID)
        first = np.where(free, disc.offsets[:-1][at_body], n)
        rigid = np.where(free[:, None], first[:, None] + np.arange(3), n)
        columns = np.concatenate([rigid, node_column[node].reshape(k, 2 * wide)], axis=1)
        centroid = np.where((body >= 0)[:, None], disc.centroids[at_body], 0.0)
        arm = as_complex(np.asarray(points, dtype=float).reshape(k, 2) - centroid)
        return cls(body, arm, node, weight, columns, disc.reach[at_body])

    def __len__(self) -> int:
        return len(self.body)

    def positions(self, centre: Array, turn: Array, strain: Array) -> Array:
        """Return where the points are, complex (k,) [m]; ``strain`` complex (nodes + 1,), in the frames of bodies."""
        b, fast = np.maximum(self.body, 0), self.body >= 0
        inner = self.arm + (self.weight * strain[self.node]).sum(1) if self.node.shape[1] else self.arm
        return np.where(fast, centre[b] + turn[b] * inner, self.arm)

    def velocities(self, turn: Array, velocity: Array, spin: Array, nodal: Array) -> Array:
        """Return the velocities of the points, complex (k,) [m/s]; ``nodal`` (nodes + 1,) those of nodes."""
        b, fast = np.maximum(self.body, 0), self.body >= 0
        rigid = velocity[b] + 1j * spin[b] * turn[b] * self.arm
        if self.node.shape[1]:
            rigid = np.where(self.weight.any(1), (self.weight * nodal[self.node]).sum(1), rigid)
        return np.where(fast, rigid, 0.0)

    def rows(self, direction: Array, turn: Array) -> Array:
        """Return the displacements (k, 3 + 2 w) along unit directions, complex (k,), from the unknowns ``columns``."""
        b = np.maximum(self.body, 0)
        arm = turn[b] * self.arm
        values = np.zeros(self.columns.shape)
        values[:, 0], values[:, 1] = direction.real, direction.imag
        values[:, 2] = (arm.real * direction.imag - arm.imag * direction.real) / self.reach
        local = np.conj(turn[b]) * direction
        values[:, 3::2] = self.weight * local.real[:, None]
        values[:, 4::2] = self.weight * local.imag[:, None]
        return values

    def along(self, displacement: Array, direction: Array) -> Array:
        """Return the components of complex displacements along complex directions."""
        return dot(displacement, direction)


@dataclass(frozen=True, eq=False)
class Followed:
    """p points whose displacements are followed, each along its own direction.

    Parameters
    ----------
    points : MaterialPoints
    start : (p,) complex array
        Where they were described [m].
    direction : (p,) complex array
        Unit vectors.
    """

    points: MaterialPoints
    start: Array
    direction: Array

    @classmethod
    def of(cls, reference: Reference, *wanted: ControlPoint) -> Followed:
        """Return points of a reference.

        Raises
        ------
        InputError
            A body is not known, a direction has no length, or a point of a meshed body lies outside it.
        """
        names = [b.name for b in reference.model.bodies]
        for point in wanted:
            if point.body not in names:
                msg = f"there is no body called '{point.body}'"
                hint = closest(point.body, names, otherwise="see the names with 'concio check'")
                raise InputError(msg, where="control point", hint=hint)
            if not 0 < float(np.linalg.norm(point.direction)) < np.inf:
                msg = f"direction {point.direction} has no length"
                raise InputError(msg, where="control point", hint="for example (1, 0)")
        place = np.array([p.at for p in wanted], dtype=float).reshape(-1, 2)
        bodies = [names.index(p.body) for p in wanted]
        points = MaterialPoints.of(reference.disc, bodies, place, reference.first_node, reference.node_column)
        along = as_complex(np.array([p.direction for p in wanted], dtype=float).reshape(-1, 2))
        return cls(points, as_complex(place), along / np.abs(along))

    def __len__(self) -> int:
        return len(self.start)

    def positions(self, centre: Array, rotation: Array, strain: Array) -> Array:
        """Return where the points are (p, 2) [m], for placements (B, 2), (B,) and strains (nodes, 2)."""
        inner = np.append(as_complex(strain), 0.0)
        return as_vectors(self.points.positions(as_complex(centre), np.exp(1j * rotation), inner))

    def displacement(self, centre: Array, rotation: Array, strain: Array) -> Array:
        """Return the displacements of the points along their directions (p,) [m]."""
        here = as_complex(self.positions(centre, rotation, strain))
        return dot(here - self.start, self.direction)

    def rate(self, n: int, turn: Array) -> Array:
        """Return the sum of their displacements as a row (N,) of n unknowns, for complex rotations (B,)."""
        row = np.zeros(n + 1)
        np.add.at(row, self.points.columns, self.points.rows(self.direction, turn))
        return row[:n]
