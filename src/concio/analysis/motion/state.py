"""The state of a motion at one time: placements, strains, velocities, and what the joints remember."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from concio.contact.moving.reference import Configuration, Reference
from concio.kinematics.placement import Placement

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Memory:
    """What contact pairs remember from step to step, by their keys.

    Parameters
    ----------
    key : (m,) integer array
        Names of the pairs, growing.
    contact, slip : (m,) integer arrays
        State: 0 open, 1 closed, 2 crushed; sign of the slip.
    force : (m, d) array
        Normal and friction forces of the last step [kN].
    stretch : (m,) array
        Elastic part of the slip of compliant joints [m].
    crushing, raised : (m,) arrays
        Plastic approach, and opening by dilatancy [m].
    broken : (m,) boolean array
        Joints that have lost cohesion and tensile strength.
    slid : (m,) array
        Total plastic slip so far, signed [m].
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

    @classmethod
    def blank(cls, key: Array, dim: int = 2) -> Memory:
        """Return the memory of pairs that touch for the first time."""
        m = len(key)
        zero = np.zeros(m)
        return cls(
            key, np.ones(m, dtype=np.int8), np.zeros(m, dtype=np.int8), np.zeros((m, dim)), zero, zero.copy(),
            zero.copy(), np.zeros(m, dtype=bool), zero.copy(),
        )  # fmt: skip

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
class MotionState:
    """Where everything is and how fast it moves.

    Parameters
    ----------
    time : float
        [s].
    centre : (B, d) array
        Centroids [m].
    rotation : (B,) array
        [rad]
    velocity : (B, d) array
        Of the centroids [m/s].
    spin : (B,) array
        [rad/s].
    strain : (nodes, d) array
        Displacements of nodes in the frames of their bodies [m].
    nodal : (nodes, d) array
        Velocities of nodes [m/s].
    memory : Memory
    """

    time: float
    centre: Array
    rotation: Array
    velocity: Array
    spin: Array
    strain: Array
    nodal: Array
    memory: Memory

    def configuration(self, reference: Reference) -> Configuration:
        """Return where the bodies stand."""
        return Configuration(reference, Placement(self.centre, self.rotation), self.strain)
