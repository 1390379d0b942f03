r"""Single long steps of slow motion from rest, each ten times longer than the last, to see where the structure goes.

In the longest that is solved the structure has moved far beyond what its joints give way, and mostly in the very motion
that never ends: that saves following all that happens on the way (:mod:`concio.solvers.relaxation.slow_motion`). A step
that no start solves is passed over; from the longest solved Newton's method goes on in smaller steps, for a motion that
has become steady grows with the step and changes no state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.solution import Departure
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.run import Run, Start
from concio.solvers.relaxation.slow_motion import ENDS, GROWTH, hardly_changed
from concio.solvers.relaxation.slow_step import allowed_factorisations, rest_near, solve_afresh, solve_near
from concio.solvers.relaxation.unbounded_motion import unbounded_motion
from concio.solvers.states.state_reading import Finished

LEAST_GROWTH = 1.1
"""Least factor between the resistances of single steps: where not even that succeeds, they end."""

SINGLE = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
"""Resistances of the single steps from rest that the interior point is asked for where Newton's method fails."""

FAR = Start(100.0, 1e3, 0.9)
"""A further start of the interior point for single steps, whose displacements are large."""

LONGEST = 1e-11
"""Least resistance of a single step."""


def at_once(run: Run) -> Finished | Departure | None:
    """Make single steps from rest, ever longer; return the rest or the unbounded motion that one shows, or None.

    Parameters
    ----------
    run : Run
        Keeps count and trace.
    """
    s = run.scaled
    rest = np.zeros(len(s.f))
    allowed = s.factor.made + allowed_factorisations(s)
    single = _Single()
    for e in SINGLE:
        if single.ended is None and s.factor.made < allowed:
            step = s.step_from(rest, e)
            single.reached(run, e, single.guessed(step, e) or solve_afresh(run, step, (FAR,)))
    growth = GROWTH
    while single.last is not None and single.ended is None and growth > LEAST_GROWTH and s.factor.made < allowed:
        e = single.before / growth
        if e < LONGEST:
            break
        went_on = single.reached(run, e, single.guessed(s.step_from(rest, e), e))
        growth = min(growth**1.5, GROWTH) if went_on else np.sqrt(growth)
    ended = single.ended
    run.trace.append(f"release: single steps down to a resistance of {single.before:.0e}, {ENDS[type(ended)]}")
    return ended


@dataclass
class _Single:
    """The longest single step from rest solved so far, and what it showed.

    Parameters
    ----------
    before : float
        Its resistance.
    last : Finished, optional
    ended : Finished or Departure, optional
        Rest or unbounded motion.
    """

    before: float = np.inf
    last: Finished | None = None
    ended: Finished | Departure | None = None

    def guessed(self, step: Scaled, e: float) -> Finished | None:
        """Solve a longer step by Newton's method from this one: the motion goes on, or the structure stays."""
        if self.last is None:
            return None
        return solve_near(step, self.last, (self.before / e, 1.0))

    def reached(self, run: Run, e: float, now: Finished | None) -> bool:
        """Look at a step solved with resistance e; once the motion changes little it is asked whether it ever ends."""
        if now is None:
            return False
        self.ended = rest_near(run, now)
        if self.ended is None and self.last is not None:
            velocity = e * now.u
            if hardly_changed(velocity, self.before * self.last.u):
                self.ended = unbounded_motion(run.scaled, now, velocity, e)
        self.before, self.last = e, now
        return True
