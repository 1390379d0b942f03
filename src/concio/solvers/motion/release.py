r"""Let the structure go and see where it ends: at rest in a Coulomb state, or moving away without end.

Where no method finds a Coulomb state, this one follows what the structure would do in a medium that resists its motion
in proportion to the masses M, by implicit steps

.. math:: (K + e M)\, u_{k+1} = f + e M u_k + C^T t_{k+1}, \qquad \text{joint laws at } u_{k+1},

each of them a contact problem of its own, solved by interior point (or pivoting) and exact finish. K + e M holds every
body, so that a step has a solution whatever the friction, and small steps (large e) have it close by. Steps grow while
they succeed. What stands still is an equilibrium, made exact with the states it has; what settles into a steady
motion is a :class:`concio.problem.solution.Departure`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.problem.solution import Departure, ProgressCallback, Status
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.engine import STARTS, Cancelled, Run
from concio.solvers.motion.departure import departure, verify_departure
from concio.solvers.pivoting import sparse_lemke
from concio.solvers.states.reading import Finished, natural_residual, read_states
from concio.solvers.states.settle import Settler

FIRST = 3e-2
"""Resistance e of the first step, scaled units."""

GROWTH = 10.0
"""Largest factor by which steps grow after two that succeeded; where a step fails, the factor becomes its root."""

LEAST = 1e-9
"""Least resistance e."""

STEP = 1e-10
"""Natural-map residual up to which a step counts as solved."""

MOST = 120
"""Largest number of steps tried."""

TRIES = 3
"""Covers that pivoting tries for the first step."""

WORK = 3_000_000
"""Largest number of pivots in one step times the number of pairs."""

COLD = 3000
"""Largest number of pairs for which the first step is tried by pivoting from nothing."""

FAILURES = 30
"""Largest number of steps that may fail."""

SLOW = 1e-3
"""Natural-map residual without resistance from which on a crossover to rest is tried, and again at each hundredth."""


def release(run: Run, u: Array | None = None) -> Finished | Departure | None:
    """Follow the slow motion from ``u`` (N,), scaled, or from rest; return where it ends, or None.

    Parameters
    ----------
    run : Run
        Keeps count and trace.
    u : (N,) array, optional
        Displacements at the beginning.
    """
    s = run.scaled
    u = np.zeros(len(s.f)) if u is None else u
    e, growth, good, failures, taken, close = FIRST, GROWTH, 0, 0, 0, SLOW
    here: Finished | None = None
    shift = np.zeros_like(u)
    ended: Finished | Departure | None = None
    while taken + failures < MOST and failures < FAILURES:
        moved = _solve(run, s.step_from(u, e), shift, here)
        if moved is None:
            failures, good = failures + 1, 0
            e, growth = growth * e, max(np.sqrt(growth), 1.5)
            continue
        here, shift, taken, good = moved, moved.u, taken + 1, good + 1
        new = replace(moved, u=u + shift)
        u = new.u
        ended = _rest(run, new) or _steady(s, e * shift, new) or departure(s, new.states, u, new.t)
        error, _ = natural_residual(s, u, new.t)
        if ended is None and error < close:
            close, ended = 0.01 * error, _cross(run, s, new)
        if ended is not None:
            break
        if good >= 2:
            e, growth = max(e / growth, LEAST), min(growth * 1.2, GROWTH)
    outcome = {Finished: "comes to rest", Departure: "moves away", type(None): "no end found"}[type(ended)]
    run.trace.append(f"release: {taken} steps of slow motion, {failures} failed, {outcome}")
    return ended


def _rest(run: Run, now: Finished) -> Finished | None:
    """Return the certified equilibrium that the states of a step belong to, if there is one."""
    rest = run.settler.settle(run.scaled, now.u, now.t)
    return rest if rest.settled and run.certified(rest) else None


def _cross(run: Run, s: Scaled, now: Finished) -> Finished | None:
    """Pivot to an equilibrium from where the motion is about to stop.

    Friction on the way remembers: the place of rest may be one that a structure loaded in one step knows only nearly.
    """
    found = pivot_from(s, read_states(s, now.u, now.t), now, limit=_most(s), progress=run.progress)
    run.iterations += found[1]
    return found[0]


def _steady(s: Scaled, a: Array, now: Finished) -> Departure | None:
    """Return the motion of the step just made, if it is a departure already."""
    R = s.problem.R
    found = verify_departure(s.problem, s.acceleration(R @ (R.T @ a)), *s.restore(now.u, now.t))
    return found if found.certified else None


def _solve(run: Run, step: Scaled, shift: Array, here: Finished | None) -> Finished | None:
    """Solve one step: from the states of the last one by exact finish or pivoting, then from nothing."""
    if here is not None:
        settler = Settler(step)
        for guess, states in ((shift, here.states), (0.0 * shift, None)):
            new = settler.settle(step, guess, here.t, states)
            if new.error <= STEP:
                return new
        return _pivot(run, step, here) or _iterate(run, step)
    return _iterate(run, step) or (_pivot(run, step, None) if step.pairs <= COLD else None)


def _iterate(run: Run, step: Scaled) -> Finished | None:
    """Solve one step by interior point from nothing."""
    inner = Run(step, run.progress)
    found: Finished | None = None
    for start in STARTS:
        found = inner.plain(start)
        if found is None and inner.best is not None and inner.best.error <= STEP:
            found = inner.best
        if found is not None:
            break
    run.iterations += inner.iterations
    run.history.extend(inner.history)
    return found


def _pivot(run: Run, step: Scaled, here: Finished | None) -> Finished | None:
    """Solve one step by sparse pivoting, from the states of the last one or, at the beginning, from nothing."""
    states = None if here is None else here.states
    found, pivots = pivot_from(step, states, here, limit=_most(step), progress=run.progress)
    run.iterations += pivots
    return found if found is not None and found.error <= STEP else None


def _most(s: Scaled) -> int:
    """Return the largest number of pivots of one path."""
    return min(s.pairs + 500, WORK // s.pairs)


def pivot_from(
    s: Scaled,
    states: PairStates | None,
    point: Finished | None,
    *,
    limit: int,
    progress: ProgressCallback | None = None,
) -> tuple[Finished | None, int]:
    """Pivot from a point in given states, or from nothing; return the answer, scaled, or None, and the pivots made."""
    known: dict[str, Any] = {"tries": TRIES}
    if states is not None and point is not None:
        known = {"tries": 0, "start_states": states, "start": s.restore(point.u, point.t)}
    answer = sparse_lemke.pivot(s, progress=progress, limit=limit, **known)
    if answer.status is Status.CANCELLED:
        raise Cancelled
    if not answer.solved:
        return None, answer.iterations
    u, t = s.bring(answer.displacement, answer.normal_force, answer.friction_force)
    error, _ = natural_residual(s, u, t)
    return Finished(u, t, read_states(s, u, t), error, 0, np.zeros(0, dtype=int)), answer.iterations
