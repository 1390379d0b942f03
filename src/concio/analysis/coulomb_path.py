"""The Coulomb path of a limit load: dead load first, then the live load, event by event, to collapse and beyond."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.errors import SolverError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback
from concio.solvers.path.event_path import follow
from concio.solvers.path.ray import homogeneous, ray, restarted
from concio.solvers.path.record import EventPath, Outcome
from concio.solvers.path.state import LinearPath, PathState, at_rest

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
        end = ray(weight, rest, progress=progress)
        if end is not None:
            return restarted(end), ""
    found = follow(weight, rest, until=1.0, progress=progress)
    if found.outcome is Outcome.REACHED:
        return restarted(found.end), ""
    if found.outcome is Outcome.CANCELLED:
        return None, "stopped on request before the dead load was reached"
    return None, (
        f"not begun: growing from nothing, the dead load itself is followed to {found.end.parameter:.4g} of its value "
        "only; that says nothing of another history"
    )


def live_load_path(
    problem: ContactProblem, live: Array, start: PathState, *, progress: ProgressCallback | None = None
) -> tuple[EventPath, bool]:
    """Follow the live load to collapse; return the path, and whether its peak is shown to be collapse.

    Under growing load the path goes as far as certified states go, over jumps; from there the displacement that the
    load works on is controlled, to see the structure move.

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
    growing = follow(path, start, until=1e6, progress=progress)
    shown = growing.outcome is Outcome.LIMIT
    control = live / float(np.abs(live).sum())
    moved = float(control @ (growing.end.displacement - start.displacement))
    if growing.outcome not in (Outcome.LIMIT, Outcome.LOST) or not moved > 0:
        return growing, shown or growing.outcome is Outcome.MECHANISM
    until = float(control @ start.displacement) + FAR * moved
    falling = follow(path, growing.end, until=until, control=control, progress=progress)
    whole = EventPath(
        growing.states + falling.states[1:],
        growing.events + tuple(replace(e, step=e.step + len(growing.states) - 1) for e in falling.events),
        falling.outcome,
        falling.direction,
        growing.factorisations + falling.factorisations,
    )
    higher = falling.peak > growing.peak * (1 + 1e-9)
    return whole, falling.outcome in (Outcome.REACHED, Outcome.MECHANISM) or (shown and not higher)
