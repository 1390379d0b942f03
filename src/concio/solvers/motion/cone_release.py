r"""Let a structure in space go and see where it ends: at rest in a Coulomb state, or moving away without end.

The same slow motion in a resisting medium as in the plane (:mod:`concio.solvers.motion.release`); each step is a
contact problem of its own, solved by Newton's method from the step before, and by the interior point where that fails.
What stands still is an equilibrium, made exact; what settles into a steady motion is a
:class:`concio.problem.solution.Departure`.

Before that single steps are made from rest, each ten times longer than the last (:func:`at_once`). In the longest that
is solved the structure has moved far beyond what its joints give way, and mostly in the very motion that never ends:
that saves following all that happens on the way.
"""

from __future__ import annotations

from dataclasses import replace

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

LONG = 1e-5
"""Resistance e up to which a single step from rest is looked at as a motion that never ends."""

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
    e = FIRST
    last: Finished | None = None
    ended: Finished | Departure | None = None
    allowed = _allowed(s)
    while e >= LEAST and ended is None and s.factor.made < allowed:
        step = s.step_from(rest, e)
        found = None if last is None else _newton(step, (GROWTH * last.u, last.u), last.t)
        found = found or _inner(run, step, starts_for(step)[:1])
        if found is None:
            break
        ended = _rest(run, found) or (departure(s, found.u, found.t, e * found.u) if e <= LONG else None)
        e, last = e / GROWTH, found
    outcome = {Finished: "comes to rest", Departure: "moves away", type(None): "no end found"}[type(ended)]
    run.trace.append(f"release: single steps down to a resistance of {GROWTH * e:.0e}, {outcome}")
    return ended


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
    allowed = _allowed(s)
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
    """Return the count of factorisations beyond which no further step is made."""
    return s.factor.made + int(np.clip(WORK / (len(s.f) + s.pairs), LEAST_WORK, MOST_WORK))


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
