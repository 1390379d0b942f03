"""Points that move with bodies: ends of ties, supports, control points, points whose history is kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.arguments import closest
from concio.errors import InputError
from concio.fem.discretisation import RIGID
from concio.kinematics.frames import dot
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import motions, rigid_row, swept
from concio.kinematics.spins import SpinAxes
from concio.kinematics.turns import Turns
from concio.model.stages import ControlPoint

if TYPE_CHECKING:
    from concio.contact.reference import Reference
    from concio.model.model import Model

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
    arm : (k, d) array
        From the centroid, as described; the position itself of a point fixed in space [m].
    node : (k, w) integer array
        Nodes that carry a point of a meshed body, one past the last where there is none.
    weight : (k, w) array
    columns : (k, 3 + 2 w) integer array, in space (k, 6 + 3 w)
        Unknowns: rigid motion, then nodes; one past the last where there is none.
    reach : (k,) array
        [m].
    axes : SpinAxes
        Along which rotations of bodies are unknowns.
    """

    body: Array
    arm: Array
    node: Array
    weight: Array
    columns: Array
    reach: Array
    axes: SpinAxes

    @classmethod
    def of(cls, reference: Reference, bodies: Sequence[int], points: Array) -> MaterialPoints:
        """Return points (k, d) of bodies, given where the bodies were described [m].

        Raises
        ------
        InputError
            A point of a meshed body lies outside it.
        """
        disc, first_node, node_column = reference.disc, reference.first_node, reference.node_column
        k, n, nodes, d = len(bodies), disc.unknowns, len(node_column) - 1, disc.dim
        body = np.array(bodies, dtype=int).reshape(k)
        found: list[tuple[Array, Array]] = []
        for b, point in zip(body.tolist(), points, strict=True):
            if b == NOWHERE or disc.shape_of[b] < 0:
                found.append((np.zeros(0, dtype=int), np.zeros(0)))
                continue
            unknowns, rows = disc.point_operator(b, point)
            found.append((first_node[b] + (unknowns[::d] - disc.offsets[b]) // d, rows[0, ::d]))
        wide = max((len(v[0]) for v in found), default=0)
        node, weight = np.full((k, wide), nodes), np.zeros((k, wide))
        for i, (own, values) in enumerate(found):
            node[i, : len(own)], weight[i, : len(own)] = own, values
        at_body = np.where(body >= 0, body, 0)
        free = (body >= 0) & (disc.shape_of[at_body] == RIGID)
        first = np.where(free, disc.offsets[:-1][at_body], n)
        rigid = np.where(free[:, None], first[:, None] + np.arange(motions(d)), n)
        columns = np.concatenate([rigid, node_column[node].reshape(k, d * wide)], axis=1)
        centroid = np.where((body >= 0)[:, None], disc.centroids[at_body], 0.0)
        arm = np.asarray(points, dtype=float).reshape(k, d) - centroid
        return cls(body, arm, node, weight, columns, disc.reach[at_body], reference.spin_axes)

    def __len__(self) -> int:
        return len(self.body)

    def positions(self, placement: Placement, strain: Array) -> Array:
        """Return where the points are (k, d) [m], for strains (nodes, d) in the frames of bodies."""
        b, fast = np.maximum(self.body, 0), self.body >= 0
        inner = self.arm + self._mean(strain) if self.node.shape[1] else self.arm
        return np.where(fast[:, None], placement.points(b, inner), self.arm)

    def velocities(self, placement: Placement, velocity: Array, spin: Array, nodal: Array) -> Array:
        """Return the velocities of the points (k, d) [m/s], for those of centroids (B, d) and nodes (nodes, d)."""
        b, fast = np.maximum(self.body, 0), self.body >= 0
        rigid = velocity[b] + swept(spin[b], placement.turns[b].apply(self.arm))
        if self.node.shape[1]:
            meshed = (self.weight != 0).any(1, keepdims=True)
            rigid = np.where(meshed, self._mean(nodal), rigid)
        return np.where(fast[:, None], rigid, 0.0)

    def rows(self, direction: Array, turn: Turns) -> Array:
        """Return the displacements (k, 3 + 2 w) along unit directions (k, d), from the unknowns ``columns``."""
        body, d = np.maximum(self.body, 0), direction.shape[1]
        own = turn[body]
        rigid = rigid_row(direction, own.apply(self.arm), self.reach)
        if d == 3:
            rigid[:, d:] = self.axes.own(rigid[:, d:], body, turn)
        local = self.weight[:, :, None] * own.undo(direction)[:, None]
        return np.concatenate([rigid, local.reshape(len(rigid), -1)], axis=1)

    def _mean(self, nodal: Array) -> Array:
        """Return the means (k, d) of nodal vectors (nodes, d) that the points have."""
        padded = np.concatenate([nodal, np.zeros((1, nodal.shape[1]))])
        return np.asarray((self.weight[:, :, None] * padded[self.node]).sum(1))


AWAY = 1e-6
"""Share of the size of a model by which a point may lie outside the box around its body."""


def check_point(model: Model, point: ControlPoint, where: str) -> None:
    """Refuse a point that a model does not have.

    Raises
    ------
    InputError
        There is no such body, the numbers are not those of the plane or of space, the direction has no length, or the
        point lies outside the box around its body: what moves there is not the body.
    """
    body = next((b for b in model.bodies if b.name == point.body), None)
    if body is None:
        msg = f"there is no body called '{point.body}'"
        hint = closest(point.body, [b.name for b in model.bodies], otherwise="see the names with 'concio check'")
        raise InputError(msg, where=where, hint=hint)
    if len(point.at) != model.dim or not np.isfinite(np.array(point.at, dtype=float)).all():
        msg = f"the point {point.at} of '{point.body}' is not {model.dim} finite numbers"
        raise InputError(msg, where=where, hint="x and y, in space also z")
    if not 2 <= len(point.direction) <= model.dim:
        msg = f"direction {point.direction} is not {model.dim} numbers"
        raise InputError(msg, where=where, hint="for example (1, 0), in space (1, 0, 0)")
    if not 0 < float(np.linalg.norm(point.direction)) < np.inf:
        msg = f"direction {point.direction} has no length"
        raise InputError(msg, where=where, hint="for example (1, 0)")
    low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
    at, near = np.array(point.at, dtype=float), AWAY * model.size
    if (at < low - near).any() or (at > high + near).any():
        spans = ", ".join(f"{axis} from {a:.10g} to {b:.10g}" for axis, a, b in zip("xyz", low, high, strict=False))
        told = ", ".join(f"{x:.10g}" for x in at)
        msg = f"the point ({told}) m does not lie on '{point.body}'"
        raise InputError(msg, where=where, hint=f"it has {spans} m")


def direction_of(point: ControlPoint, dim: int) -> Array:
    """Return the unit vector (d,) along which a point is followed; in space one of the plane is horizontal."""
    along = np.zeros(dim)
    along[: len(point.direction)] = point.direction
    return np.asarray(along / np.linalg.norm(along))


@dataclass(frozen=True, eq=False)
class Followed:
    """p points whose displacements are followed, each along its own direction.

    Parameters
    ----------
    points : MaterialPoints
    start : (p, d) array
        Where they were described [m].
    direction : (p, d) array
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
            check_point(reference.model, point, "control point")
        place = np.array([p.at for p in wanted], dtype=float).reshape(-1, reference.model.dim)
        bodies = [names.index(p.body) for p in wanted]
        points = MaterialPoints.of(reference, bodies, place)
        along = np.array([direction_of(p, place.shape[1]) for p in wanted]).reshape(place.shape)
        return cls(points, place, along)

    def __len__(self) -> int:
        return len(self.start)

    def positions(self, centre: Array, rotation: Array, strain: Array) -> Array:
        """Return where the points are (p, d) [m], for placements (B, d), (B,) and strains (nodes, d)."""
        return self.points.positions(Placement(centre, rotation), strain)

    def displacement(self, centre: Array, rotation: Array, strain: Array) -> Array:
        """Return the displacements of the points along their directions (p,) [m]."""
        return dot(self.positions(centre, rotation, strain) - self.start, self.direction)

    def rate(self, n: int, turn: Turns) -> Array:
        """Return the sum of their displacements as a row (N,) of n unknowns, for rotations (B,)."""
        row = np.zeros(n + 1)
        np.add.at(row, self.points.columns, self.points.rows(self.direction, turn))
        return row[:n]
