"""Ties that break or begin to yield on a load path: the state in which the first of them does."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from concio.analysis.tie_forces import break_elongations
from concio.contact.assembly import Assembly
from concio.problem.limits_of_work import BREAK_STEPS
from concio.problem.solution import Solver
from concio.problem.tolerances import BREAK_LOCATED, BROKEN_TIE, SLACK_TIE
from concio.solvers.methods import find
from concio.solvers.path.path_state import CRUSHED, LinearPath, PathState
from concio.solvers.path.paths_apart import between
from concio.solvers.path.record import Event, Outcome
from concio.solvers.path.step_path import Locate, StepPath, follow_in_steps

Array = np.ndarray


def breaking(
    assembly: Assembly, start: Mapping[str, float], end: Mapping[str, float]
) -> Callable[[PathState], bool] | None:
    """Return a function that tells of a state of a stage whether a tie has broken; None where no tie can.

    Parameters
    ----------
    assembly : Assembly
    start, end : mapping
        Load factors at parameter 0 and 1.
    """
    if not np.isfinite(break_elongations(assembly)).any():
        return None
    return lambda state: bool((shares(assembly, state, start, end) >= 1 - BROKEN_TIE).any())


def shares(assembly: Assembly, state: PathState, start: Mapping[str, float], end: Mapping[str, float]) -> Array:
    """Return how far each tie (k,) is stretched, as a share of the elongation at which it breaks."""
    factors = {g: start[g] + state.parameter * (end[g] - start[g]) for g in start}
    found: Array = assembly.elongations(state.displacement, factors) / break_elongations(assembly)
    return found if state.broken is None else np.where(state.broken[assembly.ties], 0.0, found)


def tie_name(assembly: Assembly, pair: int) -> str:
    """Return the name of the tie that a pair stands for."""
    return assembly.model.ties[int(np.flatnonzero(assembly.ties == pair)[0])].name


def until_a_tie_breaks(
    assembly: Assembly,
    path: LinearPath,
    found: StepPath,
    start: Mapping[str, float],
    end: Mapping[str, float],
    *,
    solver: str,
    exact: bool,
) -> StepPath:
    """Return a stage of a path as far as all ties are intact, the state in which the first one breaks as its last.

    Parameters
    ----------
    assembly : Assembly
    path : LinearPath
    found : StepPath
        The stage as if ties never broke.
    start, end : mapping
        Load factors at parameter 0 and 1.
    solver : str
        Method of load steps.
    exact : bool
        Whether the path is linear between its states; else the state is found by a load step.
    """
    if not np.isfinite(break_elongations(assembly)).any():
        return found

    def share(state: PathState) -> Array:
        return shares(assembly, state, start, end)

    over = [i for i, state in enumerate(found.states) if (share(state) >= 1 - BROKEN_TIE).any()]
    if not over:
        return found
    last = over[0]
    kept, events = found.states[:last], tuple(e for e in found.events if e.step < last)
    if not last:  # it begins with a tie that has broken
        at, tie = found.states[0].parameter, int(assembly.ties[int(np.argmax(share(found.states[0])))])
        return StepPath(found.states[:1], (Event(at, at, tie, "breaks", 0, 0),), Outcome.BROKEN, found.direction)
    before, after = found.states[last - 1 : last + 1]
    a, b = share(before), share(after)
    part = float(np.min(np.where(b >= 1 - BROKEN_TIE, (1 - a) / np.where(b > a, b - a, 1.0), np.inf)))
    finite = any(e.step == last and e.kind in ("jumps", "restarts") for e in found.events)
    breaking = between(path, before, after, part) if exact and not finite else None
    if breaking is None and not finite:
        breaking = _located(path, before, after, share, find(solver))
    states = (*kept, breaking) if breaking is not None else kept
    tie = int(assembly.ties[int(np.argmax(share(states[-1])))])
    at = states[-1].parameter
    return StepPath(
        states, (*events, Event(at, at, tie, "breaks", 0, len(states) - 1)), Outcome.BROKEN, found.direction
    )


def _located(
    path: LinearPath, before: PathState, after: PathState, share: Callable[[PathState], Array], solver: Solver
) -> PathState | None:
    """Return the state between two, by load steps from the first, in which a tie reaches where it breaks; or None.

    Forces are not straight lines within a step: the load is looked for by bisection where secants do not close in.
    """
    low, high, best = before.parameter, after.parameter, None
    a, b = float(share(before).max()), float(share(after).max())
    for k in range(BREAK_STEPS):
        part = (1 - a) / (b - a) if k % 3 < 2 and b > a else 0.5
        parameter = low + min(max(part, 0.01), 0.99) * (high - low)
        step = follow_in_steps(path, before, until=parameter, steps=1, solver=solver)
        if step.outcome is not Outcome.REACHED or len(step.states) != 2:
            return best
        most = float(share(step.states[-1]).max())
        if most <= 1 + BREAK_LOCATED:
            best, low, a = step.states[-1], parameter, most
            if most >= 1 - BREAK_LOCATED:
                return best
        else:
            high, b = parameter, most
    return best


def begin_of_yield(assembly: Assembly, path: LinearPath, solver: Solver) -> Locate | None:
    """Return a function that finds between two states of a path in steps the one in which a tie begins to yield.

    None where no tie can.

    Parameters
    ----------
    assembly : Assembly
    path : LinearPath
    solver : callable
        Method of load steps.
    """
    ties, law = assembly.ties, path.problem.laws
    ties = ties[np.isfinite(law.cap[ties])]
    if not ties.size:
        return None

    def located(before: PathState, after: PathState) -> PathState | None:
        new = ties[(before.contact[ties] != CRUSHED) & (after.contact[ties] == CRUSHED)]
        if not new.size or before.parameter == after.parameter:
            return None

        def share(state: PathState) -> float:
            """Return the force of these ties as if they had not yielded, as a share of what they carry at most."""
            beyond = np.abs(state.offset - before.offset)[new] / np.maximum(law.normal_compliance[new], 1e-300)
            return float(((state.normal_force[new] + beyond) / law.cap[new]).max())

        return _first_yield(path, before, after, share, solver)

    return located


def _first_yield(
    path: LinearPath,
    before: PathState,
    after: PathState,
    share: Callable[[PathState], float],
    solver: Solver,
) -> PathState:
    """Return the first state between two, by load steps from the first, in which the share of a tie reaches one."""
    low, high, best = before.parameter, after.parameter, after
    a, b = share(before), share(after)
    start, begin = low, a
    for k in range(BREAK_STEPS):
        if b <= 1 + BREAK_LOCATED or abs(high - low) <= BREAK_LOCATED * abs(after.parameter - before.parameter):
            break
        aim = 1 + 0.5 * BREAK_LOCATED
        part = 0.5
        if k % 3 == 0 and b > a:
            part = (aim - a) / (b - a)
        elif k % 3 == 1 and a > begin:  # on from the states below: a tie that yields stretches faster
            part = (aim - a) / (a - begin) * (low - start) / (high - low)
        parameter = low + min(max(part, 0.001), 0.999) * (high - low)
        step = follow_in_steps(path, before, until=parameter, steps=1, solver=solver)
        if step.outcome is not Outcome.REACHED or len(step.states) != 2:
            break
        now = share(step.states[-1])
        if now >= 1 - SLACK_TIE:
            best, high, b = step.states[-1], parameter, now
        else:
            low, a = parameter, now
    return best
