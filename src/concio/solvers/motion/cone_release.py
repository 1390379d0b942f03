r"""Let a structure in space go and see where it ends: at rest in a Coulomb state, or moving away without end.

The same slow motion in a resisting medium as in the plane (:mod:`concio.solvers.motion.release`); each step is a
contact problem of its own, solved by Newton's method from the step before, and by the interior point where that fails.
What stands still is an equilibrium, made exact; what settles into a steady motion is a
:class:`concio.problem.solution.Departure`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.solution import Departure
from concio.problem.tolerances import EXACT
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.cone_run import STARTS, ConeRun
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

FAILURES = 12
"""Largest number of steps that may fail."""


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
    here: Finished | None = None
    ended: Finished | Departure | None = None
    while taken + failures < MOST and failures < FAILURES:
        moved = _solve(run, s.step_from(u, e), here)
        if moved is None:
            failures, good = failures + 1, 0
            e, growth = growth * e, max(np.sqrt(growth), 1.5)
            continue
        u = u + moved.u
        here, taken, good = moved, taken + 1, good + 1
        ended = _rest(run, replace(moved, u=u)) or departure(s, u, moved.t, e * moved.u)
        if ended is not None:
            break
        if good >= 2:
            e, growth = max(e / growth, LEAST), min(growth * 1.2, GROWTH)
    outcome = {Finished: "comes to rest", Departure: "moves away", type(None): "no end found"}[type(ended)]
    run.trace.append(f"release: {taken} steps of slow motion, {failures} failed, {outcome}")
    return ended


def _rest(run: ConeRun, now: Finished) -> Finished | None:
    """Return the certified equilibrium next to a step, if there is one."""
    rest = finish(run.scaled, now.u, now.t, rounds=6)
    return rest if rest.error <= EXACT and run.certified(rest) else None


def _solve(run: ConeRun, step: Scaled, here: Finished | None) -> Finished | None:
    """Solve one step: by Newton's method from the last one, then from nothing."""
    if here is not None:
        for guess in (here.u, 0.0 * here.u):
            new = finish(step, guess, here.t, rounds=20)
            if new.error <= STEP:
                return new
    inner = ConeRun(step, run.progress)
    found: Finished | None = None
    for start in STARTS:
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
