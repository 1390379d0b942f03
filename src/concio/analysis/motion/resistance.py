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


class Resistance:
    """The level of resistance, and the last iterate that it follows from.

    Parameters
    ----------
    unknowns : int
    """

    def __init__(self, unknowns: int) -> None:
        self.level = USUAL
        self._last: Array = np.zeros(unknowns)

    def adapt(self, iteration: int, x: Array) -> None:
        """Take the displacement (N,) of an iteration into account, from the third on."""
        last, self._last = self._last, x
        along = float(x @ last)
        if iteration > 2 and along < -SWINGING * float(last @ last):
            self.level = min(self.level + 1, len(RESISTANCE) - 1)
        elif iteration > 2 and self.level and along > STEADY * float(last @ last) and along > STEADY * float(x @ x):
            self.level -= 1
