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

SLOW = 0.3
"""Share of the last iteration, gone once more, from which on the rest of them is made at once."""

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
        self._plain = True

    def adapt(self, iteration: int, x: Array) -> None:
        """Take the displacement (N,) of an iteration into account, from the third on."""
        last, self._last, self._before = self._last, x, self.level
        along = float(x @ last)
        if iteration > 2 and along < -SWINGING * float(last @ last):
            self.level = min(self.level + 1, len(RESISTANCE) - 1)
        elif iteration > 2 and self.level and along > STEADY * float(last @ last) and along > STEADY * float(x @ x):
            self.level -= 1

    def share(self, iteration: int, x: Array, *, controlled: bool) -> float:
        """Return the share of the displacement (N,) of an iteration to make: 1, or what two of one ratio r lead to.

        Where resistance and turning loads leave a ratio r to the iterations in one direction, the equilibrium lies at
        1 / (1 - r) times the second (Aitken's extrapolation, which does not ask whether a sequence converges). That is
        far ahead where they creep. A block that stands on its corner is unstable sideways: what it is off grows in each
        iteration, r > 1, and the equilibrium lies behind; it is gone back to where a displacement is controlled. A
        resistance that was made q times smaller between them accounts for q of r, and takes the place of the 1.
        """
        last, plain, self._plain = self._last, self._plain, True
        size, before, along = float(x @ x), float(last @ last), float(x @ last)
        if iteration < 3 or not before > 0 or along < ALIKE * np.sqrt(size * before):
            return 1.0
        ratio, smaller = np.sqrt(size / before), RESISTANCE[self._before] / RESISTANCE[self.level]
        away = ratio > GROWING * smaller
        if (away and controlled) or (plain and smaller == 1.0 and SLOW < ratio < STEADY):
            self._plain = away
            return float(1.0 / (smaller - ratio))
        return 1.0
