r"""Let the structure go and see where it ends: at rest in a Coulomb state, or moving away without end.

Where no method finds a Coulomb state, this one follows what the structure would do in a medium that resists its motion
in proportion to the masses M, by implicit steps

.. math:: (K + e M)\, u_{k+1} = f + e M u_k + C^T t_{k+1}, \qquad \text{joint laws at } u_{k+1},

each of them a contact problem of its own, solved by interior point (or pivoting) and exact finish. K + e M holds every
body, so that a step has a solution whatever the friction, and small steps (large e) have it close by. Steps grow while
they succeed. What stands still is an equilibrium, made exact with the states it has; what settles into a steady
motion is a :class:`concio.lcp.solution.Departure`. Two beginnings are tried: from rest undeformed, and from the
deformed state that associated flow would jam in, as if formwork were lowered.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from concio.contact.problem import Array
from concio.lcp import sparse_lemke
from concio.lcp.departure import departure, verify_departure
from concio.lcp.engine import EXACT, STARTS, Run
from concio.lcp.exact_finish import Finished, finish, natural_residual, read_states
from concio.lcp.scaled import Scaled
from concio.lcp.solution import Departure

FIRST = 1e-2
"""Resistance e of the first step, scaled units."""

GROWTH = 10.0
"""Factor by which steps grow after two that succeeded, and shrink after one that failed."""

LEAST = 1e-8
"""Least resistance e."""

STEP = 1e-10
"""Natural-map residual up to which a step counts as solved."""

MOST = 60
"""Largest number of steps tried."""

TRIES = 3
"""Covers that pivoting tries for one step."""

WORK = 3_000_000
"""Largest number of pivots in one step times the number of pairs."""

COLD = 3000
"""Largest number of pairs for which the first step is tried by pivoting from nothing."""

FAILURES = 8
"""Largest number of steps that may fail."""


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
    e, good, failures, taken = FIRST, 0, 0, 0
    here: Finished | None = None
    shift = np.zeros_like(u)
    ended: Finished | Departure | None = None
    for _ in range(MOST):
        moved = _solve(run, s.step_from(u, e), shift, here)
        if moved is None:
            failures, good, e = failures + 1, 0, GROWTH * e
            if failures >= FAILURES:
                break
            continue
        here, shift, taken, good = moved, moved.u, taken + 1, good + 1
        new = replace(moved, u=u + shift)
        u = new.u
        rest = finish(s, new.u, new.t_n, new.t_t, rounds=6)
        if rest.error <= EXACT:
            ended = rest
        else:
            ended = _steady(s, e * shift, new) or departure(s, new.states, new.u, new.t_n, new.t_t)
        if ended is not None:
            break
        if good >= 2:
            e = max(e / GROWTH, LEAST)
    outcome = {Finished: "comes to rest", Departure: "moves away", type(None): "no end found"}[type(ended)]
    run.trace.append(f"release: {taken} steps of slow motion, {failures} failed, {outcome}")
    return ended


def associated_state(run: Run) -> Array:
    """Return the displacements (N,), scaled, at which associated flow holds the structure, or nearly so."""
    z = run.engine.start(STARTS[0])
    outcome = run.engine.run(z, theta=1.0, target=1e-6, watch=run.watch("associated flow"))
    run.iterations += outcome.iterations
    return z.u


def _steady(s: Scaled, a: Array, now: Finished) -> Departure | None:
    """Return the motion of the step just made, if it is a departure already."""
    R = s.problem.R
    u, t_n, t_t = s.restore(now.u, now.t_n, now.t_t)
    found = verify_departure(s.problem, s.acceleration(R @ (R.T @ a)), u, t_n, t_t[:, None])
    return found if found.certified else None


def _solve(run: Run, step: Scaled, shift: Array, here: Finished | None) -> Finished | None:
    """Solve one step: from the states of the last one by exact finish or pivoting, then from nothing."""
    if here is not None:
        for guess, states in ((shift, here.states), (0.0 * shift, None)):
            new = finish(step, guess, here.t_n, here.t_t, rounds=20, states=states)
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
    p = step.problem
    held = replace(
        p, K=sp.csr_array(step.K * (step.force / step.length)), f=step.f * step.force, R=sp.csc_array((p.unknowns, 0))
    )
    known: dict[str, Any] = {"tries": TRIES}
    if here is not None:
        u, t_n, t_t = step.restore(here.u, here.t_n, here.t_t)
        known = {"tries": 0, "start_states": here.states.codes(), "start": (u, t_n, t_t[:, None])}
    answer = sparse_lemke.solve(held, progress=run.progress, limit=min(p.pairs + 500, WORK // p.pairs), **known)
    run.iterations += answer.iterations
    if not answer.solved:
        return None
    u, t_n = answer.displacement / step.length, answer.normal_force / step.force + step.tension
    t_t = answer.friction_force[:, 0] / step.force
    error, _ = natural_residual(step, u, t_n, t_t)
    found = Finished(u, t_n, t_t, read_states(step, u, t_n, t_t), error, 0, np.zeros(0, dtype=int))
    return found if error <= STEP else None
