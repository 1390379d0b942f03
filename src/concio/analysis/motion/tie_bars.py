"""Ties in a motion and in a push: elastic until they yield, for good, or break, for good.

As with the springs of joints, how far a tie is stretched is remembered and grows with the velocities of each step, so
that the work of its force is what it stores.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.motion.joint_step import PairData
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.springs import RETURN
from concio.analysis.motion.state import TieMemory
from concio.contact.attachments import Ties
from concio.problem.pair_state import Normal

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class TieStep:
    """Ties in a step of a motion.

    Parameters
    ----------
    ties : Ties
    memory : TieMemory
        At its beginning.
    data : PairData
        In terms of velocities.
    drift : float
        What their energy grew by since the last step because they turn [kN m].
    """

    ties: Ties
    memory: TieMemory
    data: PairData
    drift: float

    @classmethod
    def of(
        cls, ties: Ties, memory: TieMemory, data: PairData, gap: Array, y0: Array, h: float, scheme: Scheme
    ) -> TieStep:
        """Return the ties of a step of length h [s].

        Parameters
        ----------
        ties : Ties
        memory : TieMemory
        data : PairData
            In terms of displacements.
        gap : (k,) array
            Of the ties where the bodies stand in the middle of the step [m].
        y0 : (k,) array
            Velocity at which it grows at the beginning [m/s].
        h : float
        scheme : Scheme
        """
        theta, beta, half = scheme.theta, scheme.stiffness_damping, 0.5 * h * y0
        straight = memory.sunk + half
        gap = np.where(memory.sunk < 0, straight + RETURN * (gap - straight), gap)
        begun = replace(memory, sunk=gap - half)
        implicit = h * theta**2 + beta * theta
        shift = (gap + (h * (theta * (1 - theta) - 0.5) + beta * (1 - theta)) * y0) / implicit
        shifts = np.zeros_like(data.shift)
        shifts[:, 0] = shift
        data = replace(data, shift=shifts, a_n=data.a_n / implicit)
        return cls(ties, begun, data, begun.stored(ties) - memory.stored(ties))

    def states(self) -> Array:
        """Return the states (k,) in which the ties are at the start: open where slack, closed where tight."""
        return np.where(self.memory.sunk < 0, Normal.CLOSED, Normal.OPEN).astype(np.int8)

    def remember(self, y: Array, t: Array, contact: Array, h: float) -> tuple[TieMemory, float, float]:
        """Return what ties remember after the step, and the energies lost and taken by yielding [kN m].

        Parameters
        ----------
        y : (k,) array
            Mean velocities at which gaps grow [m/s].
        t : (k,) array
            Tensions [kN].
        contact : (k,) integer array
            States; crushed where a tie yields.
        h : float
            [s].
        """
        ties, sunk = self.ties, self.memory.sunk + h * y
        squeezed = np.where(contact == Normal.CRUSHED, np.maximum(-ties.most / ties.stiffness - sunk, 0.0), 0.0)
        after = self.memory.grown(ties, sunk, squeezed)
        yielded = float((t * squeezed).sum())
        change = after.stored(ties) - self.memory.stored(ties)
        return after, float((-h * t * y).sum()) - change - yielded, yielded


def settled_ties(ties: Ties, memory: TieMemory, data: PairData, t: Array, contact: Array) -> TieMemory:
    """Return what ties remember of an equilibrium.

    Parameters
    ----------
    ties : Ties
    memory : TieMemory
        Of the last one.
    data : PairData
        Where the bodies stand.
    t : (k,) array
        Tensions [kN].
    contact : (k,) integer array
        States.
    """
    gap = data.shift[:, 0]
    squeezed = np.where(contact == Normal.CRUSHED, np.maximum(-gap - t / ties.stiffness, 0.0), 0.0)
    return memory.grown(ties, gap, squeezed)
