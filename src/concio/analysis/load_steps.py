"""What Coulomb friction is shown to carry as the load grows in steps: a certified lower bound, found quickly.

The dead load comes first, in one step; then the live load grows in steps, each solved with slip measured from the state
before (10, 11), so that friction has its history. A step that finds no certified state is halved, down to a share of
the associated bound. What was reached is carried, by forces that obey every law; that more is not carried is not shown.
The exact path (:mod:`concio.solvers.path.event_path`) follows every event and can show collapse, at a price that grows
with the square of the number of pairs; these are some ten load steps, whatever the size.

In space there are no exact paths. There the least multiplier that found no certified state is applied in one step
(:func:`in_one_step`): where the structure moves away, a motion proves that, and the two multipliers bracket collapse
under Coulomb friction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from concio.problem.apart import own, solve_apart
from concio.problem.certificate import certify
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.parts import Part, connected_parts
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.problem.tolerances import CERTIFIED
from concio.representation import short_repr
from concio.solvers.interior import engine
from concio.solvers.methods import find
from concio.solvers.path.near_forces import needed, solve_near
from concio.solvers.path.path_state import LinearPath, PathState, state_of, step_problem
from concio.solvers.path.ray import homogeneous, solve_from_rest

FIRST = 1 / 4
"""First step, as a share of the associated bound; steps of an eighth carry no more, and cost a quarter more."""

SMALLEST = 0.01
"""Step that is too small to be tried, as a share of what is carried already, or of the bound where that is less."""

NOTHING = 1 / 8
"""Share of the bound below which what is carried already is not a measure of steps: they would shrink without bound."""

FAR = 1e6
"""Where there is no bound, loads grow to this multiple of the dead load."""

FURTHER = (1.0, 1e3, 1e6)
"""Times the last step that one further step of the same direction is certified at, to show that loads grow on."""

STARTS = {2: 1, 3: 0}
"""Starts of the interior point from far, by dimension: a step that needs more is halved instead (decision 0337)."""

LAST_STARTS = 4
"""Starts in the plane for a step that cannot be halved any more: what is carried must not end where rounding, the order
of the joints or a mirror image makes one start fail."""


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
        Outcome of ``failed`` applied in one step (:func:`in_one_step`); None where that was not tried.
    endless : float
        Where the associated bound is locked, the largest certificate entry of further steps in the direction of the
        last one, up to a million times as long; ``nan`` where that was not tried or is not certified.
    """

    multipliers: tuple[float, ...]
    failed: float
    state: PathState | None
    worst: float
    solves: int
    dead: Status
    outcome: Status | None = None
    endless: float = float("nan")

    @property
    def carried(self) -> float:
        """Largest multiplier with a certified state; ``nan`` where there is none."""
        return self.multipliers[-1] if self.multipliers else float("nan")


def load_steps(
    dead: ContactProblem,
    live: Array,
    bound: float,
    *,
    finest: float = 1.0,
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
        Associated multiplier, positive: no step goes beyond it. Where it is ``inf`` steps grow fourfold, up to
        :data:`FAR` times the dead load.
    finest : float
        Share of the usual least step that is tried as well.
    progress : callable, optional
    found : callable, optional
        Called with every multiplier that is shown to be carried.
    """
    first = solve_apart(dead, lambda part: solve_from_rest(part.problem, progress))
    if not first.solved:
        return LoadSteps((), float("nan"), None, float("nan"), 1, first.status)
    path = LinearPath(dead, live)
    state = state_of(path, 0.0, first.displacement, first.normal_force, first.friction_force)
    before, reached, failed, solves, worst = state, [0.0], float("nan"), 1, first.certificate.worst
    locked = not np.isfinite(bound)
    unit = unit_of_load(dead, live) if locked else bound
    size, curved = FIRST * unit, set[int]()
    while size > (smallest := finest * _smallest(reached[-1], failed if locked and failed == failed else unit)):
        trial = reached[-1] + size
        if trial >= bound * (1 - 1e-9):  # at the bound itself every state is about to move
            failed = float(np.nanmin([failed, bound]))
            size *= 0.5
            continue
        problem = step_problem(path, state, trial)
        solution = _step(problem, state, curved, progress)
        solves += 1
        if dead.dim == 2 and 0.5 * size <= smallest and solution.status is Status.GAVE_UP:
            solution, solves = _step(problem, state, curved, progress, LAST_STARTS), solves + 1
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
        before, state = state, state_of(path, trial, u, t_n, t_t, before=state)
        reached.append(trial)
        worst = max(worst, solution.certificate.worst)
        if found is not None:
            found(trial)
        if locked and trial > FAR * unit:
            break
        size *= 4.0 if locked and failed != failed else 1.0
    steps = LoadSteps(tuple(reached), failed, state, worst, solves, first.status)
    return replace(steps, endless=_endless(path, before, state)) if locked and failed != failed else steps


def by_scale(
    dead: ContactProblem, live: Array, *, progress: ProgressCallback | None = None
) -> LoadSteps | None:
    """Return what is known of every multiple of a load from one of them; None where multiples are not alike.

    Where nothing else acts on the parts of the load and nothing has a size of its own, an answer times any factor is
    the answer to the load times that factor, and the proof that there is none likewise.

    Parameters
    ----------
    dead : ContactProblem
        With its dead load.
    live : (N,) array
    progress : callable, optional
    """
    loaded = _loaded(dead, live)
    if dead.f[loaded].any() or not homogeneous(LinearPath(dead, live)):
        return None
    answer = find("auto")(dead.with_loads(dead.f + live), progress=progress)
    nan, worst = float("nan"), answer.certificate.worst
    if answer.solved:
        return LoadSteps((0.0, 1.0), nan, None, worst, 1, Status.SOLVED, endless=worst)
    failed = [one.bodies for one in answer.parts if one.status is not Status.SOLVED]
    if not all(loaded[dead.bodies[bodies]].any() for bodies in failed):
        return None  # what does not carry its dead load is another part
    return LoadSteps((0.0,), 1.0, None, 0.0, 1, Status.SOLVED, outcome=answer.status)


def unit_of_load(dead: ContactProblem, live: Array) -> float:
    """Return the multiplier at which the live load is as large as the dead one of its parts; 1 where that is none."""
    own = float(np.abs(dead.f[_loaded(dead, live)]).sum())
    return own / float(np.abs(live).sum()) if own > 0 else 1.0


def _loaded(dead: ContactProblem, live: Array) -> Array:
    """Return which unknowns (N,) are of connected parts on which the live load acts."""
    of_unknown = connected_parts(dead).of_unknown
    found: Array = np.isin(of_unknown, of_unknown[live != 0])
    return found


def _smallest(carried: float, bound: float) -> float:
    """Return the least step: the share of the bound, halved as often as what is carried is less than half of it."""
    halvings = int(np.log2(bound / max(carried, NOTHING * bound, 1e-300)))
    return SMALLEST * bound * 0.5 ** max(halvings, 0)


def _endless(path: LinearPath, before: PathState, after: PathState) -> float:
    """Return the largest certificate entry of further steps in the direction of the last one; nan if any fails.

    All equations are linear while no pair changes its state: what holds for a step a million times as long holds for
    those between, and its size is then that of a load without dead load, which holds at any multiple.
    """
    worst = 0.0
    for times in FURTHER:
        u, t_n, t_t = (
            y + times * (y - x)
            for x, y in (
                (before.displacement, after.displacement),
                (before.normal_force, after.normal_force),
                (before.friction_force, after.friction_force),
            )
        )
        far = after.parameter + times * (after.parameter - before.parameter)
        problem = step_problem(path, after, far)
        worst = max(worst, certify(problem, u, t_n, t_t, moved=path.moved(far)).worst)
    return worst if worst <= CERTIFIED else float("nan")


def in_one_step(
    dead: ContactProblem, live: Array, steps: LoadSteps, *, progress: ProgressCallback | None = None
) -> LoadSteps:
    """Apply in one step the least load that the steps did not reach, by whatever it takes; return them with that.

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


def _step(
    problem: ContactProblem,
    state: PathState,
    curved: set[int],
    progress: ProgressCallback | None,
    starts: int | None = None,
) -> Solution:
    """Return a load step from a state nearby, each connected part by itself.

    ``curved`` holds the first unknown of each part of which a step took the interior point in space: Newton's method
    does not reach the steps that follow, and is left out.
    """
    starts = starts or STARTS[problem.dim]
    return solve_apart(problem, lambda part: _part_step(part, state, curved, progress, starts))


def _part_step(
    part: Part, state: PathState, curved: set[int], progress: ProgressCallback | None, starts: int
) -> Solution:
    problem = part.problem
    u, t_n, t_t = own(part, state.displacement, state.normal_force, state.friction_force)
    near = u, t_n, t_t
    if problem.dim == 2 or needed(problem):
        solution = solve_near(problem, *near, starts=starts, progress=progress)
        if solution.solved or solution.status is Status.CANCELLED or not needed(problem):
            return solution
    first = int(part.unknowns[0]) if part.unknowns.size else -1
    solution = engine.solve(
        problem, homotopy=False, starts=starts, near=near, newton=first not in curved, progress=progress
    )
    if solution.solved and solution.iterations:
        curved.add(first)
    return solution
