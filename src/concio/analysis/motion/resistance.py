"""Resistance to motion in iterations to an equilibrium: larger where they swing, smaller where they creep.

It holds what nothing else holds, lets what swings come to rest, and vanishes with the displacement.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray

RESISTANCE = (2e-6, 6e-5, 2e-3, 6e-2, 2.0, 6.0, 20.0, 60.0, 200.0, 600.0)
"""epsilon over gravity by the width of a body: :data:`USUAL`, larger ones where iterations swing back and forth,
smaller ones where each moves as far as the last.

What hangs by a tie and turns with the load is stiffer than the rows of the first order know: with the first alone the
iterations swing about the equilibrium and lose two to fifteen hundredths of their size each time."""

USUAL = 4
"""The initial resistance, in :data:`RESISTANCE`."""

STEADY = 0.9
"""Share of the last iteration, gone once more, from which on the resistance is made smaller.

Blocks that can all slide under nearly the same load part slowly: what the sag of their joints tilts them by decides
which one goes, and that is a millionth of their weights."""

SWINGING = 0.6
"""Share of the last iteration, turned back, from which on the resistance is made larger."""


GROWING = 1.05
"""Times the last iteration from which on one in the same direction goes away from an equilibrium that is unstable."""

ALIKE = 0.99
"""Cosine between two iterations in the same direction."""


class Resistance:
    """The level of resistance, and the last iterate that it follows from.

    Parameters
    ----------
    unknowns : int
    """

    def __init__(self, unknowns: int) -> None:
        self.level = self._before = USUAL
        self._last: Array = np.zeros(unknowns)

    def adapt(self, iteration: int, x: Array) -> None:
        """Take the displacement (N,) of an iteration into account, from the third on."""
        last, self._last, self._before = self._last, x, self.level
        along = float(x @ last)
        if iteration > 2 and along < -SWINGING * float(last @ last):
            self.level = min(self.level + 1, len(RESISTANCE) - 1)
        elif iteration > 2 and self.level and along > STEADY * float(last @ last) and along > STEADY * float(x @ x):
            self.level -= 1

    def back(self, iteration: int, x: Array) -> float:
        """Return the share of the displacement (N,) of an iteration to make: 1, or a negative one.

        A block that stands on its corner is unstable sideways: what it is off grows in each iteration by one ratio,
        whatever resists, and the next one is off by more. Where two iterations show that ratio r, the equilibrium lies
        at -1 / (r - 1) times the second (Aitken's extrapolation, which does not ask whether a sequence converges). A
        resistance that was made q times smaller between them accounts for q of r, and takes the place of the 1.
        """
        last = self._last
        size, before, along = float(x @ x), float(last @ last), float(x @ last)
        if iteration < 3 or not before > 0 or along < ALIKE * np.sqrt(size * before):
            return 1.0
        ratio, smaller = np.sqrt(size / before), RESISTANCE[self._before] / RESISTANCE[self.level]
        return float(-1.0 / (ratio - smaller)) if ratio > GROWING * smaller else 1.0
