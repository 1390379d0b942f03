"""Springs of compliant joints in a motion: how far they are pressed and sheared, and the energy they store.

A spring stands on both faces: while they stick to each other it keeps the area it stands on, however they shift by its
own shear. As faces slide over each other the common area changes, and with it what the springs store: that is neither
work of their forces nor lost in friction, and has a column of its own. How far a spring is pressed is remembered and
grows by the mean relative velocity of each step, so that the work of its force is what it stores, to rounding; what the
gap of the turned bodies differs from it comes back slowly, and counts as drift.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.motion.state import Memory
from concio.kinematics.frames import dot

Array = np.ndarray

SAME_AREA = 0.01
"""Relative change of the area two faces have in common up to which springs keep the area they stand on."""

RETURN = 0.1
"""Share of the difference between a spring and the gap that comes back in a step."""


@dataclass(frozen=True, eq=False)
class Springs:
    """The springs of m pairs.

    Parameters
    ----------
    normal, shear : (m,) boolean arrays
        Pairs with a stiffness of their own along normal, along tangent.
    a_n, a_t : (m,) arrays
        Compliances [m/kN].
    longest : (m,) array
        Deformation at the tensile strength [m].
    """

    normal: Array
    shear: Array
    a_n: Array
    a_t: Array
    longest: Array

    def parts(self, sunk: Array, stretch: Array) -> tuple[Array, Array]:
        """Return the energies (m,) of springs pressed by -sunk (m,) and sheared by stretch (m, d-1) [kN m]."""
        held: Array = np.where(self.normal, np.minimum(sunk, self.longest), 0.0)
        sheared: Array = np.where(self.shear[:, None], stretch, 0.0)
        soft_n, soft_t = np.where(self.normal, self.a_n, 1.0), np.where(self.shear, self.a_t, 1.0)
        return 0.5 * held**2 / soft_n, 0.5 * dot(sheared, sheared) / soft_t

    def stored(self, sunk: Array, stretch: Array) -> Array:
        """Return the energy (m,) of springs [kN m]."""
        along_n, along_t = self.parts(sunk, stretch)
        return np.asarray(along_n + along_t)

    def loaded(self, sunk: Array) -> Array:
        """Return which springs (m,) carry a force along the normal."""
        return np.asarray(self.normal & (sunk < self.longest))

    def broken(self, broken: Array) -> Springs:
        """Return the springs where those of some pairs (m,) carry no tension any more."""
        return replace(self, longest=np.where(broken, 0.0, self.longest))


def standing(memory: Memory, area: Array) -> Array:
    """Return the areas (m,) on which springs stand, given those the faces have in common now [m2]."""
    kept = np.abs(area - memory.area) <= SAME_AREA * memory.area
    return np.where(kept, memory.area, area)


def pressed(springs: Springs, memory: Memory, gap: Array, half: Array) -> tuple[Array, Array]:
    """Return the gaps (m,) that springs obey in the middle of a step, and their deformation (m,) at its beginning [m].

    Parameters
    ----------
    springs : Springs
    memory : Memory
    gap : (m,) array
        In the middle of the step, of the bodies where they stand [m].
    half : (m,) array
        What it grows by in half a step at the velocities of the beginning [m].
    """
    straight = memory.sunk + half
    gap = np.where(springs.loaded(memory.sunk), straight + RETURN * (gap - straight), gap)
    return gap, np.where(springs.normal, gap - half, 0.0)
