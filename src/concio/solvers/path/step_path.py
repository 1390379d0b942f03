"""Load paths in steps: one Coulomb problem for each step, slip measured from the last converged state (10, 11).

A step is first tried from a state nearby: in the plane the last one, in space that to which the last two lead in
proportion (:func:`extrapolated`).

Each step is solved part by part, in units of its own. It is halved where the solver finds no certified answer or where
more than ``CHANGES`` of the pairs of a connected part change state, and doubled again after an easy step, never beyond
the one asked for. A change that was seen at some load and did not come up to there in smaller steps is the step's, not
the load's (a slip per step that exceeds rounding only where the step is long): it is not sought again.

Brittle joints lose tensile strength and cohesion in the step after the one that uses either up. So that a loss is not
put off with the load growing meanwhile, the step after it is repeated at the same load until nothing more breaks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.problem.apart import own, solve_apart
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.parts import Part, connected_parts
from concio.problem.solution import Progress, ProgressCallback, Solution, Solver, Status, judge
from concio.read_only import read_only
from concio.solvers.path import near_forces
from concio.solvers.path.event_words import NORMAL
from concio.solvers.path.path_state import (
    OPEN,
    STICK,
    LinearPath,
    PathState,
    exceeded,
    state_of,
    step_problem,
)
from concio.solvers.path.record import Event, Outcome

CHANGES = 0.1
"""Share of the pairs that may change state in one step before it is halved."""

SMALLEST = 2.0**-12
"""Smallest step, as a share of the step asked for."""

NEAR = 2.0**-3
"""Share of the step asked for above which a step that nothing solves near the last state is halved, not solved from
nothing: of several equilibria that might end in another one."""


Locate = Callable[[PathState, PathState], PathState | None]
"""Returns of two states that a step joins the one between them in which the step is to end, or None."""


@dataclass(frozen=True, eq=False)
@read_only
class StepPath:
    """States, events, outcome and last direction of a path, whichever way it was followed.

    Parameters
    ----------
    states : tuple of PathState
    events : tuple of Event
    outcome : Outcome
    direction : (N,) array
    """

    states: tuple[PathState, ...]
    events: tuple[Event, ...]
    outcome: Outcome
    direction: Array

    def followed_by(self, rest: StepPath) -> StepPath:
        """Return this path with one that begins in its last state."""
        moved = tuple(replace(e, step=e.step + len(self.states) - 1) for e in rest.events)
        return StepPath(self.states + rest.states[1:], self.events + moved, rest.outcome, rest.direction)


def follow_in_steps(
    path: LinearPath,
    start: PathState,
    *,
    until: float,
    steps: int,
    solver: Solver,
    refine: bool = True,
    brittle: bool = False,
    locate: Locate | None = None,
    progress: ProgressCallback | None = None,
) -> StepPath:
    """Follow a path in load steps.

    Parameters
    ----------
    path : LinearPath
    start : PathState
    until : float
        Load parameter to reach.
    steps : int
        Initial number of steps, of equal size.
    solver : Solver
    refine : bool
        Whether steps are halved at many changes of state (a failed step always is).
    brittle : bool
        Whether pairs lose tensile strength and cohesion once these are used up.
    locate : callable, optional
        Returns of two states that a step joins the one between them in which the step is to end, or None.
    progress : callable, optional
    """
    states, events = [start], list[Event]()
    whole = (until - start.parameter) / steps
    size, outcome = whole, Outcome.REACHED
    breaking, nearby = False, dict[bytes, near_forces.Nearby]()
    seen = np.full(path.problem.pairs, np.inf)  # least way at which a refused step saw a pair change
    of_pair = connected_parts(path.problem).of_pair
    while breaking or abs(until - states[-1].parameter) > 1e-12 * max(1.0, abs(until)):
        before = states[-1]
        left = until - before.parameter
        size = np.sign(whole) * min(abs(size), abs(left)) if not breaking else size
        parameter = until if abs(size) >= abs(left) * (1 - 1e-12) else before.parameter + size
        parameter = before.parameter if breaking else parameter
        halved = abs(size) > NEAR * abs(whole) and not (breaking or _proportional(path, before))
        solution = _step(path, states, parameter, solver, nearby, near_only=halved)
        smallest = abs(size) <= SMALLEST * abs(whole)
        if not solution.solved:
            if not smallest and not breaking and not _proportional(path, before):
                size *= 0.5
                continue
            outcome = Outcome.LIMIT if solution.status in (Status.NO_EQUILIBRIUM, Status.COLLAPSES) else Outcome.LOST
            break
        after = state_of(
            path, parameter, solution.displacement, solution.normal_force, solution.friction_force, before=before
        )
        if locate is not None and (earlier := locate(before, after)) is not None:
            after, parameter = earlier, earlier.parameter
        changed = np.flatnonzero((before.contact != after.contact) | (_side(before) != _side(after)))
        here, there = (abs(p - start.parameter) for p in (before.parameter, parameter))
        sought = changed[here < seen[changed]]
        if refine and len(states) > 1 and _many(sought, of_pair) and not (smallest or breaking):
            seen[sought] = np.minimum(seen[sought], there)
            size *= 0.5
            continue
        seen[changed] = np.inf
        if brittle:
            after, lost = _broken(path, before, after)
            breaking = bool(lost.size)
            events += [Event(parameter, parameter, int(k), "breaks", 0, len(states)) for k in lost]
        events += [event for k in changed for event in _named(before, after, int(k), len(states))]
        states.append(after)
        if abs(size) < abs(whole):
            size *= 2.0
        gone = (parameter - start.parameter) / (until - start.parameter) if until != start.parameter else 1.0
        if progress is not None and progress(Progress("steps", len(states), solution.certificate.worst, share=gone)):
            outcome = Outcome.CANCELLED
            break
    last = states[-1].displacement - states[-2].displacement if len(states) > 1 else np.zeros(path.problem.unknowns)
    return StepPath(tuple(states), tuple(events), outcome, last / (float(np.abs(last).max(initial=0.0)) or 1.0))


def _step(
    path: LinearPath,
    states: list[PathState],
    parameter: float,
    solver: Solver,
    nearby: dict[bytes, near_forces.Nearby],
    *,
    near_only: bool,
) -> Solution:
    """Solve one step near the last state, keeping redundant forces near the last ones, or else from nothing.

    With ``near_only`` a step that is not solved near the last state is returned as it is, to be halved.
    """
    problem, last = step_problem(path, states[-1], parameter), _point(states[-1])
    begin = last if problem.dim == 2 else extrapolated(states, parameter)

    def of_part(part: Part) -> Solution:
        kept = nearby.setdefault(part.pairs.tobytes(), near_forces.Nearby())
        here, there = _own(part, last), _own(part, begin)
        return _near(part.problem, here, there, solver, kept, near_only=near_only)

    return solve_apart(problem, of_part)


def _own(part: Part, whole: near_forces.State) -> near_forces.State:
    """Return displacements and forces of one part."""
    u, t_n, t_t = own(part, *whole)
    return u, t_n, t_t


def _near(
    problem: ContactProblem,
    last: near_forces.State,
    begin: near_forces.State,
    solver: Solver,
    nearby: near_forces.Nearby,
    *,
    near_only: bool,
) -> Solution:
    """Solve the step of one connected part."""
    if not problem.unknowns:  # ties that are gone, and whatever lies between fixed bodies
        nothing = judge(problem, *(np.zeros_like(part) for part in last), method=near_forces.NAME)
        return nothing if nothing.solved else solver(problem)
    if not near_forces.needed(problem):
        return nearby.answer(problem, begin) or solver(problem)
    solution = near_forces.solve_near(problem, *last, nearby=nearby, begin=begin)
    return solution if solution.solved or near_only else solver(problem)


def _point(state: PathState) -> near_forces.State:
    """Return displacements and forces of a state."""
    return state.displacement, state.normal_force, state.friction_force


def extrapolated(states: Sequence[PathState], parameter: float) -> near_forces.State:
    """Return the displacements and forces to which the last two states lead; those of the last where there is one.

    Newton's method tells from them which pairs slip on, and which way: at the last state itself none does, slip being
    measured from there.

    Parameters
    ----------
    states : sequence of PathState
        Of one path, the last one last.
    parameter : float
        Load parameter to lead to.
    """
    last = _point(states[-1])
    change = states[-1].parameter - states[-2].parameter if len(states) > 1 else 0.0
    if change == 0.0:
        return last
    share = (parameter - states[-1].parameter) / change
    u, t_n, t_t = (b + share * (b - a) for a, b in zip(_point(states[-2]), last, strict=True))
    return u, t_n, t_t


def _many(changed: Array, of_pair: Array) -> bool:
    """Tell whether too many pairs of some connected part change state; ``of_pair`` (m,) is the part of each pair."""
    pairs = np.bincount(of_pair)
    return bool((np.bincount(of_pair[changed], minlength=pairs.size) > np.maximum(1.0, CHANGES * pairs)).any())


def _proportional(path: LinearPath, before: PathState) -> bool:
    """Tell whether all that acts from rest grows with the parameter: a small step fails where a large one does.

    So it is with joints that have no strength but friction, and nothing on the structure before.
    """
    p, law = path.problem, path.problem.laws
    acts = (p.f, p.gap, p.slip_origin, law.tension, law.cohesion, before.displacement, before.normal_force)
    return before.parameter == 0.0 and not any(part.any() for part in acts) and bool(np.isinf(law.cap).all())


def _broken(path: LinearPath, before: PathState, after: PathState) -> tuple[PathState, Array]:
    """Return the state with what it breaks marked as broken, and those pairs."""
    broken = exceeded(path, after)
    was = np.zeros(broken.size, dtype=bool) if before.broken is None else before.broken
    return replace(after, broken=broken), np.flatnonzero(broken & ~was)


def _side(state: PathState) -> Array:
    """Return the sign of the slip of plane pairs, in space 1 where a pair slips, whatever the direction (m,)."""
    return state.states.sign if state.slip.shape[1] == 1 else state.states.slips.astype(np.int8)


def _named(before: PathState, after: PathState, k: int, step: int) -> list[Event]:
    """Return what pair k did in a step: change its contact, begin to slip, stick."""
    found = []
    was, now = int(before.contact[k]), int(after.contact[k])
    if was != now:
        found.append(Event(after.parameter, after.parameter, k, NORMAL[was, now], 0, step))
    side = int(_side(after)[k])
    if now != OPEN and side != int(_side(before)[k]):
        kind = "sticks" if side == STICK else "slips"
        found.append(Event(after.parameter, after.parameter, k, kind, side, step))
    return found
