"""One step of slow motion: solved from the step before, or from nothing; and the state of rest close to one."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from concio.problem.limits_of_work import COLD_PAIRS, RELAXATION_WORK
from concio.problem.pair_state import PairStates
from concio.problem.solution import ProgressCallback, Status
from concio.problem.tolerances import EXACT, RELAXED
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.newton_finish import finish
from concio.solvers.interior.run import Cancelled, Run
from concio.solvers.pivoting import sparse_lemke
from concio.solvers.states.settle import Settler
from concio.solvers.states.state_reading import Finished, natural_residual, read_states

COVERS = 3
"""Covering vectors that pivoting tries for a first step."""

WORK, MOST_WORK, LEAST_WORK = 4e6, 3000, 300
"""Factorisations times unknowns and pairs in space after which no further step is made, and the factorisations that
are allowed at most and at least: what is undecided by then is reported so. Half a minute to a minute."""


def solve_step(run: Run, step: Scaled, here: Finished | None, longer: float) -> Finished | None:
    """Solve one step, so much longer than the last one: from the states of that, then from nothing.

    Plane problems are pivoted as well: from the states of the last step before the interior point, from nothing after.
    """
    if here is not None:
        return solve_near(step, here, (longer, 1.0, 0.0)) or _pivot(run, step, here) or solve_afresh(run, step)
    return solve_afresh(run, step) or (_pivot(run, step, None) if step.pairs <= COLD_PAIRS else None)


def solve_near(step: Scaled, here: Finished, multiples: Iterable[float]) -> Finished | None:
    """Solve a step from another one, its displacements guessed as multiples of that one's."""
    if step.dim == 2:
        settler = Settler(step)
        for guess, states in ((here.u, here.states), (0.0 * here.u, None)):
            new = settler.settle(step, guess, here.t, states)
            if new.error <= RELAXED:
                return new
        return None
    for multiple in multiples:
        new = finish(step, multiple * here.u, here.t, rounds=20)
        if new.error <= RELAXED:
            return new
    return None


def solve_afresh(run: Run, step: Scaled, further: Iterable[Any] = ()) -> Finished | None:
    """Solve a step by the interior point, from the usual starts and from further ones."""
    inner = type(run)(step, run.progress)
    found: Finished | None = None
    for found in inner.attempts(further):
        if found is None and inner.best is not None and inner.best.error <= RELAXED:
            found = inner.best
        if found is not None:
            break
    run.iterations += inner.iterations
    run.history.extend(inner.history)
    return found


def rest_near(run: Run, now: Finished) -> Finished | None:
    """Return the certified equilibrium next to a step, if there is one."""
    if run.scaled.dim == 2:
        rest = run.settler.settle(run.scaled, now.u, now.t)
        return rest if rest.settled and run.certified(rest) else None
    rest = finish(run.scaled, now.u, now.t, rounds=6)
    return rest if rest.error <= EXACT and run.certified(rest) else None


def pivot_to_rest(run: Run, now: Finished) -> Finished | None:
    """Pivot to an equilibrium from where the motion is about to stop (plane problems).

    Friction on the way remembers: the place of rest may be one that a structure loaded in one step knows only nearly.
    """
    s = run.scaled
    found, pivots = pivot_from(s, read_states(s, now.u, now.t), now, limit=_most_pivots(s), progress=run.progress)
    run.iterations += pivots
    return found


def allowed_factorisations(s: Scaled) -> float:
    """Return how many factorisations are made at most before the last step is begun."""
    return np.inf if s.dim == 2 else float(np.clip(WORK / (len(s.f) + s.pairs), LEAST_WORK, MOST_WORK))


def _pivot(run: Run, step: Scaled, here: Finished | None) -> Finished | None:
    """Solve a plane step by sparse pivoting, from the states of the last one or, at the beginning, from nothing."""
    if step.dim != 2:
        return None
    states = None if here is None else here.states
    found, pivots = pivot_from(step, states, here, limit=_most_pivots(step), progress=run.progress)
    run.iterations += pivots
    return found if found is not None and found.error <= RELAXED else None


def _most_pivots(s: Scaled) -> int:
    """Return the largest number of pivots of one path."""
    return min(s.pairs + 500, RELAXATION_WORK // s.pairs)


def pivot_from(
    s: Scaled,
    states: PairStates | None,
    point: Finished | None,
    *,
    limit: int,
    progress: ProgressCallback | None = None,
) -> tuple[Finished | None, int]:
    """Pivot from a point in given states, or from nothing; return the answer, scaled, or None, and the pivots made."""
    known: dict[str, Any] = {"tries": COVERS}
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
