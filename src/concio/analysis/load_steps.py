"""What Coulomb friction is shown to carry as the load grows in steps: a certified lower bound, found quickly.

The dead load comes first, in one step; then the live load grows in steps, each solved with slip measured from the state
before (10, 11), so that friction has its history. A step that finds no certified state is halved, down to a share of
the associated bound. What was reached is carried, by forces that obey every law; that more is not carried is not shown.
The exact path (:mod:`concio.solvers.path.event_path`) follows every event and can show collapse, at a price that grows
with the square of the number of pairs; these are some ten load steps, whatever the size.

In space there are no exact paths. There the least multiplier that found no certified state is put on in one step
(:func:`in_one_step`): where the structure moves away, a motion proves that, and the two multipliers bracket collapse
under Coulomb friction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.representation import short_repr
from concio.solvers.interior import cone_run, engine
from concio.solvers.methods import find
from concio.solvers.path.near_forces import needed, solve_near
from concio.solvers.path.ray import solve_from_rest
from concio.solvers.path.state import LinearPath, PathState, state_of, step_problem

FIRST = 1 / 4
"""First step, as a share of the associated bound; steps of an eighth carry no more, and cost a quarter more."""

SMALLEST = 0.01
"""Step that is too small to be tried, as a share of the bound."""

START = (10.0,)
"""Starting points of the interior point: a step that needs others is halved instead."""

CONE_STARTS = 2
"""The same in space."""


@short_repr
@dataclass(frozen=True, eq=False)
class LoadSteps:
    """Certified states under a growing load.

    Parameters
    ----------
    multipliers : tuple of float
        Of the certified states, from 0 (dead load alone); empty where not even that was found.
    failed : float
        Least multiplier tried above the last of them without finding a certified state; ``nan`` where none was.
    state : PathState or None
        The last certified state.
    worst : float
        Largest certificate entry of all of them.
    solves : int
        Load steps tried.
    dead : Status
        Outcome of the dead load in one step.
    outcome : Status or None
        What comes of ``failed`` put on in one step (:func:`in_one_step`); None where that was not tried.
    """

    multipliers: tuple[float, ...]
    failed: float
    state: PathState | None
    worst: float
    solves: int
    dead: Status
    outcome: Status | None = None

    @property
    def carried(self) -> float:
        """Largest multiplier with a certified state; ``nan`` where there is none."""
        return self.multipliers[-1] if self.multipliers else float("nan")


def load_steps(
    dead: ContactProblem,
    live: Array,
    bound: float,
    *,
    progress: ProgressCallback | None = None,
    found: Callable[[float], None] | None = None,
) -> LoadSteps:
    """Grow the live load in certified steps.

    Parameters
    ----------
    dead : ContactProblem
        With its dead load.
    live : (N,) array
    bound : float
        Associated multiplier, finite and positive: no step goes beyond it.
    progress : callable, optional
    found : callable, optional
        Called with every multiplier that is shown to be carried.
    """
    first = solve_from_rest(dead, progress)
    if not first.solved:
        return LoadSteps((), float("nan"), None, float("nan"), 1, first.status)
    path = LinearPath(dead, live)
    state = state_of(path, 0.0, first.displacement, first.normal_force, first.friction_force)
    reached, failed, solves, worst = [0.0], float("nan"), 1, first.certificate.worst
    size, smallest = FIRST * bound, SMALLEST * bound
    while size > smallest:
        trial = reached[-1] + size
        if trial >= bound * (1 - 1e-9):  # at the bound itself every state is about to move
            failed = float(np.nanmin([failed, bound]))
            size *= 0.5
            continue
        solution = _step(step_problem(path, state, trial), state, progress)
        solves += 1
        if solution.status is Status.CANCELLED:
            break
        if not solution.solved:
            failed, size = trial, 0.5 * size
            continue
        if trial >= failed * (1 - 1e-9):
            failed = float("nan")
        elif trial + size >= failed * (1 - 1e-9) and 2 * smallest < size <= 4 * smallest:
            size *= 0.5  # there it failed already, and one half is left to try
        u, t_n, t_t = solution.displacement, solution.normal_force, solution.friction_force
        state = state_of(path, trial, u, t_n, t_t, before=state)
        reached.append(trial)
        worst = max(worst, solution.certificate.worst)
        if found is not None:
            found(trial)
    return LoadSteps(tuple(reached), failed, state, worst, solves, first.status)


def in_one_step(
    dead: ContactProblem, live: Array, steps: LoadSteps, *, progress: ProgressCallback | None = None
) -> LoadSteps:
    """Put on in one step the least load that the steps did not reach, by whatever it takes; return them with that.

    Parameters
    ----------
    dead : ContactProblem
        With its dead load.
    live : (N,) array
    steps : LoadSteps
        Their ``failed`` is a number.
    progress : callable, optional
    """
    answer = find("auto")(dead.with_loads(dead.f + steps.failed * live), progress=progress)
    return replace(steps, outcome=answer.status, solves=steps.solves + 1)


def _step(problem: ContactProblem, state: PathState, progress: ProgressCallback | None) -> Solution:
    near = (state.displacement, state.normal_force, state.friction_force)
    if problem.dim == 3 and not needed(problem):
        return cone_run.solve(problem, progress=progress, starts=CONE_STARTS, near=near)
    solution = solve_near(problem, *near, starts=START, progress=progress)
    if solution.solved or solution.status is Status.CANCELLED or not needed(problem):
        return solution
    if problem.dim == 3:
        return cone_run.solve(problem, progress=progress, starts=CONE_STARTS, near=near)
    return engine.solve(problem, homotopy=False, starts=START, progress=progress)
