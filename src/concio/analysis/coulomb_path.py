"""The Coulomb path of a limit load: dead load first, then the live load, event by event, to collapse and beyond.

Parts that touch only through fixed bodies are followed by themselves: the path ends where the first of them does.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.errors import SolverError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.parts import parts_of
from concio.problem.solution import ProgressCallback
from concio.solvers.path.path_state import LinearPath, PathState, at_rest
from concio.solvers.path.paths_apart import follow_parts, part_that_moves, path_of, put_together
from concio.solvers.path.ray import homogeneous, ray, restarted
from concio.solvers.path.record import EventPath, Outcome

FAR = 50.0
"""The path is followed to this multiple of the displacement at its first limit point."""


def coulomb_path(
    problem: ContactProblem, live: Array, *, progress: ProgressCallback | None = None
) -> tuple[EventPath, bool]:
    """Follow dead load, then live load, to collapse; return the path, and whether its peak is shown to be collapse.

    Parameters
    ----------
    problem : ContactProblem
        With its dead load.
    live : (N,) array
    progress : callable, optional

    Raises
    ------
    SolverError
        The path of the dead load itself comes to an end, which proves nothing about another history.
    """
    start, note = dead_state(problem, progress=progress)
    if start is None:
        msg = "the dead load is not reached on its own path"
        raise SolverError(msg, hint=note)
    return live_load_path(problem, live, start, progress=progress)


def dead_state(
    problem: ContactProblem, *, progress: ProgressCallback | None = None
) -> tuple[PathState | None, str]:
    """Return the state under the dead load grown from nothing; None, and why, where its path was lost."""
    weight = LinearPath(problem.with_loads(0.0 * problem.f), problem.f)
    rest = at_rest(weight.problem)
    if homogeneous(weight):
        end = _ray(weight, rest, progress)
        if end is not None:
            return restarted(end), ""
    found = follow_parts(weight, rest, until=1.0, progress=progress)
    if found.outcome is Outcome.REACHED:
        return restarted(found.end), ""
    if found.outcome is Outcome.CANCELLED:
        return None, "stopped on request before the dead load was reached"
    return None, (
        f"not begun: growing from nothing, the dead load itself is followed to {found.end.parameter:.4g} of its value "
        "only; that says nothing of another history"
    )


def _ray(weight: LinearPath, rest: PathState, progress: ProgressCallback | None) -> PathState | None:
    """Return the end of the straight path from rest, of each part by itself; None where one load step misses it."""
    parts = [part for part in parts_of(weight.problem) if part.unknowns.size]
    ends = []
    for part in parts:
        end = ray(path_of(weight, part), at_rest(part.problem), progress=progress)
        if end is None:
            return None
        ends.append(end)
    return replace(put_together(rest, parts, ends), parameter=1.0)


def live_load_path(
    problem: ContactProblem, live: Array, start: PathState, *, progress: ProgressCallback | None = None
) -> tuple[EventPath, bool]:
    """Follow the live load to collapse; return the path, and whether its peak is shown to be collapse.

    Under growing load the path goes as far as certified states go, over jumps; from there the displacement that the
    load works on is controlled, to see the structure move: of the part that has come to its end.

    Parameters
    ----------
    problem : ContactProblem
        With its dead load.
    live : (N,) array
    start : PathState
        State under the dead load, at parameter 0: :func:`dead_state`.
    progress : callable, optional
    """
    path = LinearPath(problem, live)
    growing = follow_parts(path, start, until=1e6, progress=progress)
    shown = growing.outcome is Outcome.LIMIT
    moving = part_that_moves(path, growing.direction)
    control = np.where(moving, live, 0.0) if (moving & (live != 0)).any() else live
    control = control / float(np.abs(control).sum())
    moved = float(control @ (growing.end.displacement - start.displacement))
    if growing.outcome not in (Outcome.LIMIT, Outcome.LOST) or not moved > 0:
        return growing, shown or growing.outcome is Outcome.MECHANISM
    until = float(control @ start.displacement) + FAR * moved
    looked = growing.outcome is Outcome.LOST
    falling = follow_parts(path, growing.end, until=until, control=control, progress=progress, looked=looked)
    whole = EventPath(
        growing.states + falling.states[1:],
        growing.events + tuple(replace(e, step=e.step + len(growing.states) - 1) for e in falling.events),
        falling.outcome,
        falling.direction,
        growing.factorisations + falling.factorisations,
    )
    higher = falling.peak > growing.peak * (1 + 1e-9)
    return whole, falling.outcome in (Outcome.REACHED, Outcome.MECHANISM) or (shown and not higher)
