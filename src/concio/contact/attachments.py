"""Supports and ties of bodies that move, as pairs beside those of contact.

A support is a pair at each point it holds, glued along one direction or both; what it carries is its reaction. A tie is
a compliant pair along its present direction, whose gap closes when it is stretched: C_n u = -e as in statics.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.factors import load_factor
from concio.contact.points import NOWHERE, MaterialPoints
from concio.contact.supports import points_held
from concio.fem.discretisation import FIXED
from concio.kinematics.frames import dot, frames, norm
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import motions
from concio.kinematics.turns import Turns

if TYPE_CHECKING:
    from concio.contact.reference import Reference

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Held:
    """Points that supports hold.

    Parameters
    ----------
    points : MaterialPoints
        k of them; a point that is held along two of three axes is there twice.
    start : (k, d) array
        Where they were described [m].
    motion : (k, d) array
        Displacement imposed by a load factor of one [m].
    support : (k,) integer array
        Number in the model.
    group : tuple of str
        Load group of each point.
    normal : (k, d) array
        Direction held: an axis.
    pinned : (k,) boolean array
        Whether all directions are held.
    """

    points: MaterialPoints
    start: Array
    motion: Array
    support: Array
    group: tuple[str, ...]
    normal: Array
    pinned: Array

    def __len__(self) -> int:
        return len(self.start)

    @classmethod
    def of(cls, reference: Reference) -> Held:
        """Return the points that the supports of a model hold."""
        disc, model = reference.disc, reference.model
        number = {b.name: i for i, b in enumerate(model.bodies)}
        d = disc.dim
        bodies, places, moves, supports, groups, axes, pinned = [], [], [], [], [], [], []
        for i, support in enumerate(model.supports):
            b = number[support.body]
            if disc.shape_of[b] == FIXED:
                continue
            _, at, motion, held = points_held(disc, b, i)
            for axis in held[:1] if len(held) == d else held:
                bodies += [b] * len(at)
                places.append(at)
                moves.append(motion)
                supports += [i] * len(at)
                groups += [support.group] * len(at)
                axes += [axis] * len(at)
                pinned += [len(held) == d] * len(at)
        place = np.concatenate([*places, np.zeros((0, d))])
        points = MaterialPoints.of(reference, bodies, place)
        return cls(
            points, place, np.concatenate([*moves, np.zeros((0, d))]), np.array(supports, dtype=int), tuple(groups),
            np.eye(d)[axes].reshape(-1, d), np.array(pinned, dtype=bool),
        )  # fmt: skip

    def target(self, factors: Mapping[str, float]) -> Array:
        """Return where the points are wanted under load factors (k, d) [m]."""
        factor = np.array([load_factor(factors, g) for g in self.group])
        return np.asarray(self.start + factor[:, None] * self.motion)

    @property
    def ways(self) -> tuple[Array, ...]:
        """Directions, d of (k, d): the one held, and its tangents, held where a point is pinned."""
        return tuple(np.moveaxis(frames(self.normal), 1, 0))

    def values(self, turn: Turns) -> Array:
        """Return the rows (k, d, w) along the directions held."""
        return np.stack([self.points.rows(way, turn) for way in self.ways], axis=1)


@dataclass(frozen=True, eq=False)
class Ties:
    """Ties between points.

    Parameters
    ----------
    a, b : MaterialPoints
    length : (k,) array
        As described [m].
    stiffness, prestress : (k,) arrays
        [kN/m], [kN].
    most : (k,) array
        Tension at which they yield, inf where they do not [kN].
    breaks : (k,) array
        Elongation at which they break, inf where they do not [m].
    sign : (k,) array
        1 of bars, -1 of soil, which presses.
    """

    a: MaterialPoints
    b: MaterialPoints
    length: Array
    stiffness: Array
    prestress: Array
    most: Array
    breaks: Array
    sign: Array

    def __len__(self) -> int:
        return len(self.length)

    @classmethod
    def of(cls, reference: Reference) -> Ties:
        """Return the ties of a model."""
        ties, d = reference.model.ties, reference.model.dim
        number = {b.name: i for i, b in enumerate(reference.model.bodies)} | {"": NOWHERE}
        at_a = np.array([t.at_a for t in ties], dtype=float).reshape(-1, d)
        at_b = np.array([t.at_b for t in ties], dtype=float).reshape(-1, d)
        return cls(
            MaterialPoints.of(reference, [number[t.body_a] for t in ties], at_a),
            MaterialPoints.of(reference, [number[t.body_b] for t in ties], at_b), norm(at_b - at_a),
            np.array([t.stiffness for t in ties]), np.array([t.prestress for t in ties]),
            np.array([t.most for t in ties]),
            np.array([np.inf if t.break_elongation is None else t.break_elongation for t in ties]),
            np.array([t.sign for t in ties]),
        )  # fmt: skip

    @property
    def columns(self) -> Array:
        """Unknowns of the rows (k, w)."""
        return np.concatenate([self.a.columns, self.b.columns], axis=1)

    def span(self, placement: Placement, strain: Array) -> tuple[Array, Array]:
        """Return the vectors (k, d) from their first ends to their second ones, and their lengths (k,) [m]."""
        vector = self.b.positions(placement, strain) - self.a.positions(placement, strain)
        return vector, norm(vector)

    def rows(self, placement: Placement, strain: Array) -> tuple[Array, Array, Array, Array]:
        """Return the rows (k, d, w) of -elongation, those of swinging, the gaps (k,) and the lengths (k,) [m]."""
        span, length = self.span(placement, strain)
        direction = self.sign[:, None] * span / np.where(length > 0, length, 1.0)[:, None]
        turn = placement.turns
        row, *across = (
            np.concatenate([self.a.rows(way, turn), -self.b.rows(way, turn)], axis=1)
            for way in np.moveaxis(frames(direction), 1, 0)
        )
        gap = -self.prestress / self.stiffness - self.sign * (length - self.length)
        nothing = np.zeros_like(row)
        return np.stack([row, *(nothing for _ in across)], axis=1), np.stack([*across, nothing], axis=1), gap, length

    def turning(self, placement: Placement, strain: Array, tension: Array) -> tuple[Array, Array]:
        """Return unknowns (c,) and stiffness (c,) with which tight ties resist that rigid bodies turn [kN/m].

        Tension T at an arm r from the centroid has the moment r x T, which grows by r . T as the body turns away.
        """
        span, length = self.span(placement, strain)
        force = (self.sign * tension)[:, None] * span / np.where(length > 0, length, 1.0)[:, None]
        columns, stiffness = [], []
        for end, pull in ((self.a, force), (self.b, -force)):
            arm = placement.turns[np.maximum(end.body, 0)].apply(end.arm)
            own = np.maximum(dot(arm, pull), 0.0) / np.where(end.reach > 0, end.reach, 1.0) ** 2
            d = span.shape[1]
            for k in range(d, motions(d)):
                columns.append(end.columns[:, k])
                stiffness.append(own)
        return np.concatenate(columns), np.concatenate(stiffness)
