"""Loads on bodies that move: weights and point loads keep their direction, pressures turn with their face.

Of a dead load on a rigid body the force stays and the moment turns: forces v at arms a have the moment that is the
antisymmetric part of R S after a rotation R, with the tensor S = sum(a v'), and the potential -tr((R - 1) S). Follower
loads are constant in the frame of their body.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from concio.contact.applied import applied_forces
from concio.contact.factors import load_factor
from concio.contact.loads import load_vectors
from concio.fem.discretisation import RIGID, Discretisation
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import motions
from concio.kinematics.spins import SpinAxes
from concio.kinematics.turns import Turns
from concio.model.model import Load

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class GroupLoad:
    """Loads of one group, (N,) each on the unknowns of all bodies as described [kN].

    Parameters
    ----------
    dead : (N,) array
        Forces that keep their direction, where the bodies were described.
    arms : (R, d, d) array
        S of the dead forces on rigid bodies [kN m].
    follower : (N,) array
        Forces that turn with their bodies; of rigid bodies the moments along their own axes.
    """

    dead: Array
    arms: Array
    follower: Array


class MovingLoads:
    """Loads of all groups for any placement, on the unknowns of bodies that move.

    Parameters
    ----------
    disc : Discretisation
    axes : SpinAxes
        Along which rotations of rigid bodies are unknowns.
    """

    def __init__(self, disc: Discretisation, axes: SpinAxes) -> None:
        loads, d = disc.model.loads, disc.dim
        rigid = np.flatnonzero(disc.shape_of == RIGID)
        self.axes, self.rigid, self.reach = axes, rigid, disc.reach[rigid]
        first = disc.offsets[rigid][:, None]
        meshed = np.flatnonzero(disc.shape_of >= 0)
        self.body_of_node = np.repeat(meshed, np.diff(disc.offsets)[meshed] // d)
        starts = [np.arange(disc.offsets[b], disc.offsets[b + 1], d) for b in meshed]
        x = np.concatenate([*starts, np.zeros(0, dtype=int)]).astype(int)
        self.of_centre, self.of_node = first + np.arange(d), x[:, None] + np.arange(d)
        """Unknowns of the centroids of rigid bodies (R, d), and of the nodes of meshed ones (nodes, d)."""
        self.of_turn = first + np.arange(d, motions(d))
        """Unknowns of the rotations of rigid bodies (R, 1 or 3)."""
        dead = _vectors(disc, tuple(load for load in loads if load.kind != "pressure"))
        follower = _vectors(disc, tuple(load for load in loads if load.kind == "pressure"))
        described = Turns.of(Placement.at_rest(disc.centroids).rotation)
        for vector in follower.values():
            moment = vector[self.of_turn]
            vector[self.of_turn] = axes.own(moment if d == 3 else moment[:, 0], rigid, described)
        arms = self._arms(disc)
        zero, none = np.zeros(disc.unknowns), np.zeros((len(rigid), d, d))
        names = tuple(dict.fromkeys(load.group for load in loads))
        self.groups = {g: GroupLoad(dead.get(g, zero), arms.get(g, none), follower.get(g, zero)) for g in names}
        self.followers = any(p.follower.any() for p in self.groups.values())
        """Whether any load turns with its body, and so has no potential."""
        self._leverage = bool(arms)

    def _arms(self, disc: Discretisation) -> dict[str, Array]:
        """Return S of the dead loads of each group that has any away from centroids."""
        model = disc.model
        found: dict[str, Array] = {}
        number = np.full(len(model.bodies), -1)
        number[self.rigid] = np.arange(len(self.rigid))
        dead = [k for k, load in enumerate(model.loads) if load.kind not in ("pressure", "weight", "body")]
        for f in applied_forces(model, dead):
            if number[f.body] >= 0:
                zero = np.zeros((len(self.rigid), disc.dim, disc.dim))
                arm = f.point - disc.centroids[f.body]
                found.setdefault(model.loads[f.load].group, zero)[number[f.body]] += np.outer(arm, f.force)
        return found

    def forces(self, factors: Mapping[str, float], turn: Turns) -> Array:
        """Return the forces (N,) on the unknowns under load factors, for rotations of the bodies.

        Parameters
        ----------
        factors : mapping of str to float
            Groups not named have factor 1.
        turn : Turns
            Of all bodies.
        """
        size = [load_factor(factors, g) for g in self.groups]
        parts = list(self.groups.values())
        dead = _sum(size, [p.dead for p in parts])
        f, t = dead.copy(), turn[self.rigid]
        f[self.of_turn] = 0.0
        if self._leverage:
            arms = _sum(size, [p.arms for p in parts])
            turned = np.swapaxes(t.apply(np.swapaxes(arms, 1, 2)), 1, 2)
            f[self.of_turn] = self.axes.own(_axial(turned), self.rigid, turn) / self.reach[:, None]
        follower = _sum(size, [p.follower for p in parts]) if self.followers else None
        if follower is not None:
            f[self.of_centre] += t.apply(follower[self.of_centre])
            f[self.of_turn] += follower[self.of_turn]
        if len(self.of_node):
            f[self.of_node] = turn[self.body_of_node].undo(dead[self.of_node])
            if follower is not None:
                f[self.of_node] += follower[self.of_node]
        return f

    def following(self, factors: Mapping[str, float], turn: Turns) -> Array:
        """Return the part (N,) of the forces that turns with its bodies: it has no potential [kN]."""
        f = np.zeros(len(next(iter(self.groups.values())).dead)) if self.groups else np.zeros(0)
        if not self.followers:
            return f
        follower = _sum([load_factor(factors, g) for g in self.groups], [p.follower for p in self.groups.values()])
        f[self.of_centre] = turn[self.rigid].apply(follower[self.of_centre])
        f[self.of_turn] = follower[self.of_turn]
        f[self.of_node] = follower[self.of_node]
        return f

    def potential(self, factors: Mapping[str, float], moved: Array, turn: Turns, nodes: Array) -> float:
        """Return the potential of the dead loads, zero where the bodies were described [kN m].

        Parameters
        ----------
        factors : mapping of str to float
        moved : (B, d) array
            Displacements of the centroids [m].
        turn : Turns
            Of all bodies.
        nodes : (nodes, d) array
            Displacements of the nodes of meshed bodies [m].
        """
        if not self.groups:
            return 0.0
        size = [load_factor(factors, g) for g in self.groups]
        dead = _sum(size, [p.dead for p in self.groups.values()])
        work = float((dead[self.of_centre] * moved[self.rigid]).sum())
        if self._leverage:
            arms = np.swapaxes(_sum(size, [p.arms for p in self.groups.values()]), 1, 2)
            grown = turn[self.rigid].apply(arms) - arms
            work += float(np.trace(grown, axis1=1, axis2=2).sum())
        if len(self.of_node):
            work += float((dead[self.of_node] * nodes).sum())
        return -work


def _axial(tensor: Array) -> Array:
    """Return the moments of tensors sum(a v'): (k,) in the plane, (k, 3) in space."""
    off = tensor - np.swapaxes(tensor, 1, 2)
    return off[:, 0, 1] if tensor.shape[1] == 2 else np.stack([off[:, 1, 2], off[:, 2, 0], off[:, 0, 1]], axis=1)


def _sum(factors: list[float], vectors: list[Array]) -> Array:
    total: Array = factors[0] * vectors[0]
    for factor, vector in zip(factors[1:], vectors[1:], strict=True):
        total = total + factor * vector
    return total


def _vectors(disc: Discretisation, loads: tuple[Load, ...]) -> dict[str, Array]:
    return load_vectors(replace(disc, model=replace(disc.model, loads=loads))) if loads else {}
