"""Loads on bodies that move: weights and point loads keep their direction, pressures turn with their edge.

Of a dead load on a rigid body the force stays and the moment turns: points at arms a with forces v have the moment
cos(phi) sum(a x v) - sin(phi) sum(a . v) after a rotation phi, and the second sum is the moment of the same forces
turned right. Follower loads are constant in the frame of their body.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from concio.contact.factors import load_factor
from concio.contact.loads import load_vectors
from concio.fem.discretisation import RIGID, Discretisation
from concio.kinematics.frames import turned_right
from concio.kinematics.turns import Turns
from concio.model.model import Load

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class GroupLoad:
    """Loads of one group, (N,) each on the unknowns of all bodies [kN].

    Parameters
    ----------
    dead : (N,) array
        Forces that keep their direction, where the bodies were described.
    across : (N,) array
        The same with every force turned right; only moments of rigid bodies are used.
    follower : (N,) array
        Forces that turn with their bodies.
    """

    dead: Array
    across: Array
    follower: Array


class MovingLoads:
    """Loads of all groups for any placement.

    Parameters
    ----------
    disc : Discretisation
    """

    def __init__(self, disc: Discretisation) -> None:
        loads = disc.model.loads
        dead = _vectors(disc, tuple(load for load in loads if load.kind != "pressure"))
        across = _vectors(
            disc, tuple(_turned(load) for load in loads if load.kind not in ("pressure", "weight", "body"))
        )
        follower = _vectors(disc, tuple(load for load in loads if load.kind == "pressure"))
        zero = np.zeros(disc.unknowns)
        names = tuple(dict.fromkeys(load.group for load in loads))
        self.groups = {g: GroupLoad(dead.get(g, zero), across.get(g, zero), follower.get(g, zero)) for g in names}
        self.followers = any(p.follower.any() for p in self.groups.values())
        """Whether any load turns with its body, and so has no potential."""
        self._across = any(p.across.any() for p in self.groups.values())
        rigid = np.flatnonzero(disc.shape_of == RIGID)
        self.rigid, self.reach = rigid, disc.reach[rigid]
        self.first = disc.offsets[rigid]
        meshed = np.flatnonzero(disc.shape_of >= 0)
        counts = np.diff(disc.offsets)[meshed] // 2
        self.body_of_node = np.repeat(meshed, counts)
        starts = [np.arange(disc.offsets[b], disc.offsets[b + 1], 2) for b in meshed]
        x = np.concatenate([*starts, np.zeros(0, dtype=int)]).astype(int)
        self.of_centre, self.of_node = self.first[:, None] + np.arange(2), x[:, None] + np.arange(2)
        """Unknowns of the centroids of rigid bodies (R, 2), and of the nodes of meshed ones (nodes, 2)."""

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
        f = dead.copy()
        t = turn[self.rigid]
        moment = self.first + 2
        if self._across:
            across = _sum(size, [p.across for p in parts])
            f[moment] = t.cosine * dead[moment] + t.sine * across[moment]
        else:
            f[moment] = t.cosine * dead[moment]
        follower = _sum(size, [p.follower for p in parts]) if self.followers else None
        if follower is not None:
            f[self.of_centre] += t.apply(follower[self.of_centre])
            f[moment] += follower[moment]
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
        f[self.first + 2] = follower[self.first + 2]
        f[self.of_node] = follower[self.of_node]
        return f

    def potential(self, factors: Mapping[str, float], moved: Array, rotation: Array, nodes: Array) -> float:
        """Return the potential of the dead loads, zero where the bodies were described [kN m].

        Parameters
        ----------
        factors : mapping of str to float
        moved : (B, 2) array
            Displacements of the centroids [m].
        rotation : (B,) array
            [rad].
        nodes : (nodes, 2) array
            Displacements of the nodes of meshed bodies [m].
        """
        if not self.groups:
            return 0.0
        size = [load_factor(factors, g) for g in self.groups]
        dead = _sum(size, [p.dead for p in self.groups.values()])
        across = _sum(size, [p.across for p in self.groups.values()])
        u, angle, x = moved[self.rigid], rotation[self.rigid], self.first
        work = float(dead[x] @ u[:, 0] + dead[x + 1] @ u[:, 1])
        work += float(dead[x + 2] @ (self.reach * np.sin(angle)) + across[x + 2] @ (self.reach * (1 - np.cos(angle))))
        if len(self.of_node):
            work += float((dead[self.of_node] * nodes).sum())
        return -work


def _sum(factors: list[float], vectors: list[Array]) -> Array:
    total: Array = factors[0] * vectors[0]
    for factor, vector in zip(factors[1:], vectors[1:], strict=True):
        total = total + factor * vector
    return total


def _vectors(disc: Discretisation, loads: tuple[Load, ...]) -> dict[str, Array]:
    return load_vectors(replace(disc, model=replace(disc.model, loads=loads))) if loads else {}


def _turned(load: Load) -> Load:
    x, y = turned_right(np.array(load.value, dtype=float))
    return replace(load, value=(float(x), float(y)))
