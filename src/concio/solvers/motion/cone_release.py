r"""Let a structure in space go and see where it ends: at rest in a Coulomb state, or moving away without end.

The same slow motion in a resisting medium as in the plane (:mod:`concio.solvers.motion.release`); each step is a
contact problem of its own, solved by Newton's method from the step before, and by the interior point where that fails.
What stands still is an equilibrium, made exact; what settles into a steady motion is a
:class:`concio.problem.solution.Departure`.

Before that single steps are made from rest, each ten times longer than the last (:func:`at_once`). In the longest that
is solved the structure has moved far beyond what its joints give way, and mostly in the very motion that never ends:
that saves following all that happens on the way. A step that no start solves is passed over; from the longest solved
Newton's method goes on in smaller steps, for a motion that has settled grows with the step and changes no state.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.solution import Departure
from concio.problem.tolerances import EXACT
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.cone_run import STARTS, ConeRun, Start, starts_for
from concio.solvers.interior.newton_finish import finish
from concio.solvers.motion.cone_departure import departure
from concio.solvers.states.reading import Finished

FIRST = 1e-2
"""Resistance e of the first step, scaled units."""

GROWTH = 10.0
"""Largest factor by which steps grow after two that succeeded; where a step fails, the factor becomes its root."""

LEAST = 1e-9
"""Least resistance e."""

STEP = 1e-10
"""Natural-map residual up to which a step counts as solved."""

MOST = 80
"""Largest number of steps tried."""

LEAST_GROWTH = 1.1
"""Least factor between the resistances of single steps: where not even that succeeds, they end."""

SINGLE = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
"""Resistances of the single steps from rest that the interior point is asked for where Newton's method fails."""

FAR = Start(100.0, 1e3, 0.9)
"""A further start of the interior point for single steps, whose displacements are large."""

LONGEST = 1e-11
"""Least resistance of a single step."""

CHANGES = 0.1
"""Largest change of the motion from one single step to the next, relative, at which it is asked whether it ends."""

FAILURES = 12
"""Largest number of steps that may fail."""

WORK, MOST_WORK, LEAST_WORK = 4e6, 3000, 300
"""Factorisations times unknowns and pairs after which no further step is made, and the factorisations that are allowed
at most and at least: what is undecided by then is told so. Half a minute to a minute."""


def at_once(run: ConeRun) -> Finished | Departure | None:
    """Make single steps from rest, ever longer; return the rest or the motion without end that one shows, or None.

    Parameters
    ----------
    run : ConeRun
        Keeps count and trace.
    """
    s = run.scaled
    rest = np.zeros(len(s.f))
    allowed = s.factor.made + _allowed(s)
    single = _Single()
    for e in SINGLE:
        if single.ended is None and s.factor.made < allowed:
            step = s.step_from(rest, e)
            single.reached(run, e, single.guessed(step, e) or _inner(run, step, (*starts_for(step), FAR)))
    growth = GROWTH
    while single.last is not None and single.ended is None and growth > LEAST_GROWTH and s.factor.made < allowed:
        e = single.before / growth
        if e < LONGEST:
            break
        went_on = single.reached(run, e, single.guessed(s.step_from(rest, e), e))
        growth = min(growth**1.5, GROWTH) if went_on else np.sqrt(growth)
    ended = single.ended
    outcome = {Finished: "comes to rest", Departure: "moves away", type(None): "no end found"}[type(ended)]
    run.trace.append(f"release: single steps down to a resistance of {single.before:.0e}, {outcome}")
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
        Rest or motion without end.
    """

    before: float = np.inf
    last: Finished | None = None
    ended: Finished | Departure | None = None

    def guessed(self, step: Scaled, e: float) -> Finished | None:
        """Solve a longer step by Newton's method from this one: the motion goes on, or the structure stays."""
        if self.last is None:
            return None
        return _newton(step, (self.before / e * self.last.u, self.last.u), self.last.t)

    def reached(self, run: ConeRun, e: float, now: Finished | None) -> bool:
        """Look at a step solved with resistance e; once the motion changes little it is asked whether it ever ends."""
        if now is None:
            return False
        self.ended = _rest(run, now)
        if self.ended is None and self.last is not None:
            velocity, other = e * now.u, self.before * self.last.u
            if float(np.abs(velocity - other).max()) < CHANGES * float(np.abs(velocity).max()):
                self.ended = departure(run.scaled, now.u, now.t, velocity, e)
        self.before, self.last = e, now
        return True


def release(run: ConeRun, u: Array | None = None) -> Finished | Departure | None:
    """Follow the slow motion from ``u`` (N,), scaled, or from rest; return where it ends, or None.

    Parameters
    ----------
    run : ConeRun
        Keeps count and trace.
    u : (N,) array, optional
        Displacements at the beginning.
    """
    s = run.scaled
    u = np.zeros(len(s.f)) if u is None else u
    e, growth, good, failures, taken = FIRST, GROWTH, 0, 0, 0
    before = e
    here: Finished | None = None
    ended: Finished | Departure | None = None
    allowed = s.factor.made + _allowed(s)
    while taken + failures < MOST and failures < FAILURES and s.factor.made < allowed:
        moved = _solve(run, s.step_from(u, e), here, before / e)
        if moved is None:
            failures, good = failures + 1, 0
            e, growth = growth * e, max(np.sqrt(growth), 1.5)
            continue
        u = u + moved.u
        here, taken, good, before = moved, taken + 1, good + 1, e
        ended = _rest(run, replace(moved, u=u)) or departure(s, u, moved.t, e * moved.u)
        if ended is not None:
            break
        if good >= 2:
            e, growth = max(e / growth, LEAST), min(growth * 1.2, GROWTH)
    outcome = {Finished: "comes to rest", Departure: "moves away", type(None): "no end found"}[type(ended)]
    run.trace.append(f"release: {taken} steps of slow motion, {failures} failed, {outcome}")
    return ended


def _allowed(s: Scaled) -> int:
    """Return how many factorisations are made at most before the last step is begun."""
    return int(np.clip(WORK / (len(s.f) + s.pairs), LEAST_WORK, MOST_WORK))


def _rest(run: ConeRun, now: Finished) -> Finished | None:
    """Return the certified equilibrium next to a step, if there is one."""
    rest = finish(run.scaled, now.u, now.t, rounds=6)
    return rest if rest.error <= EXACT and run.certified(rest) else None


def _solve(run: ConeRun, step: Scaled, here: Finished | None, longer: float) -> Finished | None:
    """Solve one step, so much longer than the last one: by Newton's method from that, then from nothing."""
    found = None if here is None else _newton(step, (longer * here.u, here.u, 0.0 * here.u), here.t)
    return found or _inner(run, step, starts_for(step))


def _newton(step: Scaled, guesses: tuple[Array, ...], t: Array) -> Finished | None:
    """Solve a step by Newton's method from displacements guessed and forces known."""
    for guess in guesses:
        new = finish(step, guess, t, rounds=20)
        if new.error <= STEP:
            return new
    return None


def _inner(run: ConeRun, step: Scaled, starts: tuple[Start, ...]) -> Finished | None:
    """Solve a step by the interior point from starts in turn."""
    inner = ConeRun(step, run.progress)
    found: Finished | None = None
    for start in starts:
        found = inner.from_start(start)
        if found is None and inner.best is not None and inner.best.error <= STEP:
            found = inner.best
        if found is not None:
            break
    run.iterations += inner.iterations
    run.history.extend(inner.history)
    return found


def associated_state(run: ConeRun) -> Array:
    """Return the displacements (N,), scaled, at which associated flow holds the structure, or nearly so."""
    z = run.cones.start(STARTS[0].force, STARTS[0].length)
    outcome = run.cones.run(z, theta=1.0, target=1e-6, watch=run.watch("associated flow"))
    run.iterations += outcome.iterations
    return z.u
