"""The state of a motion at one time: placements, strains, velocities, and what joints and ties remember."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np

from concio.contact.attachments import Ties
from concio.contact.reference import Configuration, Reference
from concio.kinematics.placement import Placement
from concio.problem.pair_state import Normal, PairStates

Array = np.ndarray

NO_TIES = np.zeros(0, dtype=np.int8)


@dataclass(frozen=True, eq=False)
class Memory:
    """What contact pairs remember from step to step, by their keys.

    Parameters
    ----------
    key : (m,) integer array
        Names of the pairs, growing.
    contact : (m,) integer array
        State: codes of :class:`concio.problem.pair_state.Normal`.
    slip : (m, d-1) array
        Unit vector along which a pair slips, zero where it does not.
    force : (m, d) array
        Normal and friction forces of the last step [kN].
    stretch : (m, d-1) array
        Elastic part of the slip of compliant joints [m].
    crushing, raised : (m,) arrays
        Plastic approach, and opening by dilatancy [m].
    broken : (m,) boolean array
        Joints that have lost cohesion and tensile strength.
    slid : (m, d-1) array
        Total plastic slip so far, along the tangents [m].
    area : (m,) array
        On which the springs of compliant joints stand, zero before they were first examined [m2].
    sunk : (m,) array
        Normal deformation of these springs, negative where they are pressed [m].
    stored : (m,) array
        Their energy [kN m].
    """

    key: Array
    contact: Array
    slip: Array
    force: Array
    stretch: Array
    crushing: Array
    raised: Array
    broken: Array
    slid: Array
    area: Array
    sunk: Array
    stored: Array

    @classmethod
    def blank(cls, key: Array, dim: int = 2) -> Memory:
        """Return the memory of pairs that touch for the first time."""
        m = len(key)
        zero, along = np.zeros(m), np.zeros((m, dim - 1))
        return cls(
            key, np.full(m, int(Normal.CLOSED), dtype=np.int8), along, np.zeros((m, dim)), along.copy(), zero,
            zero.copy(), np.zeros(m, dtype=bool), along.copy(), zero.copy(), zero.copy(), zero.copy(),
        )  # fmt: skip

    def states(self, count: int, ties: Array = NO_TIES) -> PairStates:
        """Return the states of ``count`` pairs: the m remembered, others closed, ``ties`` the last (k,)."""
        normal = np.full(count, int(Normal.CLOSED), dtype=np.int8)
        direction = np.zeros((count, self.slip.shape[1]))
        normal[: len(self.key)], direction[: len(self.key)] = self.contact, self.slip
        normal[count - len(ties) :] = ties
        return PairStates(normal, direction)

    def handed(self, source: Array, target: Array, frame: Array, swapped: Array) -> Memory:
        """Return the memory in which pairs hand on what they remember to others that now stand for them.

        Parameters
        ----------
        source, target : (k,) integer arrays
        frame : (m, d, d) array
            Normal and tangents of all pairs.
        swapped : (k,) boolean array
            Whether side a of one is side b of the other.
        """
        blank, values = Memory.blank(self.key, self.force.shape[1]), {}
        turn = np.einsum("kij,klj->kil", frame[target], frame[source])
        turn = np.where(swapped, -1.0, 1.0)[:, None, None] * turn
        for f in fields(self):
            if f.name == "key":
                continue
            value, own = getattr(self, f.name).copy(), getattr(self, f.name)[source]
            if f.name == "force":
                own = np.einsum("kij,kj->ki", turn, own)
            elif value.ndim == 2:
                own = np.einsum("kij,kj->ki", turn[:, 1:, 1:], own)
            value[target], value[source] = own, getattr(blank, f.name)[source]
            values[f.name] = value
        return replace(self, **values)

    def carried_to(self, key: Array) -> Memory:
        """Return the memory of pairs with other keys, blank where a key is new."""
        fresh = Memory.blank(key, self.force.shape[1])
        if not len(self.key):
            return fresh
        order = np.argsort(self.key, kind="stable")
        place = np.minimum(np.searchsorted(self.key, key, sorter=order), len(order) - 1)
        at = order[place]
        known = self.key[at] == key
        values = {}
        for f in fields(self):
            if f.name == "key":
                continue
            value = getattr(fresh, f.name)
            value[known] = getattr(self, f.name)[at[known]]
            values[f.name] = value
        return replace(fresh, **values)


@dataclass(frozen=True, eq=False)
class TieMemory:
    """What ties remember.

    Parameters
    ----------
    sunk : (k,) array
        Minus the elastic elongation, that of the prestress included; positive where a tie is slack [m].
    plastic : (k,) array
        Elongation by yielding [m].
    broken : (k,) boolean array
    """

    sunk: Array
    plastic: Array
    broken: Array

    @classmethod
    def described(cls, ties: Ties) -> TieMemory:
        """Return the memory of ties as they were described."""
        return cls(-ties.prestress / ties.stiffness, np.zeros(len(ties)), np.zeros(len(ties), dtype=bool))

    def stored(self, ties: Ties) -> float:
        """Return the energy of the ties [kN m]."""
        held = np.where(self.broken, 0.0, np.minimum(self.sunk, 0.0))
        return 0.5 * float((ties.stiffness * held**2).sum())

    def grown(self, ties: Ties, sunk: Array, squeezed: Array) -> TieMemory:
        """Return the memory of ties stretched by -sunk (k,), ``squeezed`` (k,) of it by yielding [m]."""
        sunk, plastic = sunk + squeezed, self.plastic + squeezed
        elongation = plastic - sunk - ties.prestress / ties.stiffness
        return TieMemory(sunk, plastic, self.broken | (elongation >= ties.breaks))


@dataclass(frozen=True, eq=False)
class MotionState:
    """Where everything is and how fast it moves.

    Parameters
    ----------
    time : float
        [s].
    centre : (B, d) array
        Centroids [m].
    rotation : (B,) array in the plane, (B, 3, 3) in space
        [rad]; rotation matrices in space.
    velocity : (B, d) array
        Of the centroids [m/s].
    spin : (B,) array in the plane, (B, 3) in space
        [rad/s].
    strain : (nodes, d) array
        Displacements of nodes in the frames of their bodies [m].
    nodal : (nodes, d) array
        Velocities of nodes [m/s].
    memory : Memory
    ties : TieMemory
    described : (B, 2 d) array
        Least and largest coordinates of the corners of each body as it was described, at the end of a motion [m]; else
        empty. A motion that goes on is one of the same bodies.
    """

    time: float
    centre: Array
    rotation: Array
    velocity: Array
    spin: Array
    strain: Array
    nodal: Array
    memory: Memory
    ties: TieMemory
    described: Array = field(default_factory=lambda: np.zeros((0, 0)))

    @classmethod
    def at_rest(cls, reference: Reference) -> MotionState:
        """Return the state of bodies at rest where they were described, unstrained."""
        here, nodes = reference.at_rest().placement, np.zeros_like(reference.node_arm)
        memory = Memory.blank(np.zeros(0, dtype=np.int64), here.dim)
        return cls(
            0.0, here.centre, here.rotation, np.zeros_like(here.centre), here.no_spin, nodes, nodes.copy(), memory,
            TieMemory.described(Ties.of(reference)),
        )  # fmt: skip

    @cached_property
    def placement(self) -> Placement:
        """Where the frames of the bodies are."""
        return Placement(self.centre, self.rotation)

    def configuration(self, reference: Reference) -> Configuration:
        """Return where the bodies stand."""
        return Configuration(reference, self.placement, self.strain)
