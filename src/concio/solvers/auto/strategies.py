"""What ``auto`` knows to do: a function for each strategy, which returns an answer or None where it decides nothing."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.solution import Departure, Mechanism, Solution, Status, failed, judge
from concio.solvers.auto.friction_neighbours import from_neighbours
from concio.solvers.interior.bonded_start import applies, from_sticking
from concio.solvers.interior.run import Cancelled, Run, starts_for
from concio.solvers.relaxation.free_motion import free_motion
from concio.solvers.relaxation.single_steps import at_once
from concio.solvers.relaxation.slow_motion import relax
from concio.solvers.states.state_reading import Finished
from concio.solvers.statics.existence import statically_admissible


@dataclass(frozen=True)
class Strategy:
    """One entry of the table of :mod:`concio.solvers.auto.chain`.

    Parameters
    ----------
    name : str
        What ``info["strategy"]`` says of an answer of its.
    decide : callable
        Takes the :class:`.Run`, returns an answer or None; raises :class:`.Cancelled` where the callback asks to stop.
    dimensions : tuple of int
        Where it is tried.
    """

    name: str
    decide: Callable[[Run], Solution | None]
    dimensions: tuple[int, ...] = (2, 3)


def first_answer(run: Run, table: Sequence[Strategy]) -> Solution:
    """Return what the first strategy of a table that decides says; UNDECIDED where none does.

    ``info["strategy"]`` names it, ``info["cost"]`` those tried, each with its processor time [s].
    """
    cost: list[tuple[str, float]] = []
    try:
        for strategy in (row for row in table if run.scaled.dim in row.dimensions):
            begin = time.process_time()
            answer = strategy.decide(run)
            cost.append((strategy.name, time.process_time() - begin))
            if answer is not None:
                return replace(answer, info={**answer.info, "strategy": strategy.name, "cost": tuple(cost)})
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    undecided = run.solution(None, Status.UNDECIDED, method="auto")
    name = "best point met" if undecided.solved else "none"  # certified, though no strategy took it for an answer
    return replace(undecided, info={**undecided.info, "strategy": name, "cost": tuple(cost)})


def sticking(run: Run) -> Solution | None:
    """Begin where all pairs stick: in the plane where few are likely to do anything else, in space in bonded joints."""
    if run.scaled.dim == 2:
        held = run.sticking()
        return None if held is None else run.solution(held, method="active-set")
    if not applies(run.scaled):
        return None
    near = from_sticking(run.scaled)
    if near is None:
        run.trace.append("all pairs stick: no answer near")
        return None
    plain, found = near
    run.trace.append(f"all pairs stick: {found.solves} linear solves, residual {found.error:.1e}")
    answer = judge(run.scaled.problem, *plain.restore(found.u, found.t), method="active-set")
    return merged(run, answer, "active-set") if answer.solved else None


def usual_starts(run: Run) -> Solution | None:
    """Interior point from the first two starts."""
    return _from(run, 0, 2)


def other_starts(run: Run) -> Solution | None:
    """Interior point from the starts that are left."""
    return _from(run, 2, None)


def best_point_met(run: Run) -> Solution | None:
    """Take the best point the starts met where it is certified: no motion is followed for digits nobody asks for."""
    met = None if run.best is None else run.solution(run.best, method="interior-point")
    return met if met is not None and met.solved else None


def neighbours(run: Run) -> Solution | None:
    """Solve with a little more or less friction and carry the state over."""
    answer = from_neighbours(run, run.progress)
    return None if answer is None else merged(run, answer, "interior-point + pivoting")


def statics(run: Run) -> Solution | None:
    """Decide by a linear programme: collapse with its mechanism, or equilibrium without motion; None for neither."""
    problem = run.scaled.problem
    state = statically_admissible(problem)
    if state.exists:
        run.trace.append("statically admissible forces exist")
        if run.scaled.deforms:  # which of them act follows from what gives way, not by a programme
            return None
        rest = judge(
            problem, np.zeros(problem.unknowns), state.normal_force, state.friction_force, method="linear-programme"
        )
        return merged(run, rest, "linear-programme") if rest.solved else None
    mechanism = state.mechanism
    if mechanism is None:
        run.trace.append("no statically admissible forces found, but no mechanism could be verified either")
        return None
    run.trace.append("no statically admissible forces: mechanism found and rechecked")
    return merged(run, failed(problem, Status.NO_EQUILIBRIUM, method="", mechanism=mechanism), "mechanism")


def moving_freely(run: Run) -> Solution | None:
    """Look whether the structure moves away as if nothing touched it."""
    return _ended(run, free_motion(run.scaled.problem))


def released_in_single_steps(run: Run) -> Solution | None:
    """Let the structure go, and look at what single long steps from rest show."""
    return _ended(run, at_once(run))


def released_at_rest(run: Run) -> Solution | None:
    """Let the structure go, undeformed: it comes to rest, or an unbounded motion is the answer."""
    return released(run, None)


def released_jammed(run: Run) -> Solution | None:
    """Let the structure go from the state in which associated flow holds it."""
    return released(run, run.associated_state())


def released(run: Run, u: Array | None, t: Array | None = None) -> Solution | None:
    """Follow the slow motion from displacements (N,) and forces (m, d), scaled; return where it ends, or None."""
    return _ended(run, relax(run, u, t))


def _from(run: Run, first: int, last: int | None) -> Solution | None:
    for start in starts_for(run.scaled)[first:last]:
        found = run.from_start(start)
        if found is not None:
            return run.solution(found)
    return None


def _ended(run: Run, ended: Finished | Departure | None) -> Solution | None:
    if isinstance(ended, Departure):
        return moves_away(run, ended)
    return None if ended is None else run.solution(ended)


def moves_away(run: Run, motion: Departure) -> Solution:
    """Return the verdict of a certified motion."""
    problem = run.scaled.problem
    top = float(np.abs(motion.acceleration).max())
    direction = motion.acceleration / top
    mechanism = Mechanism(direction, float(problem.f @ direction), motion.violation)
    answer = failed(problem, Status.COLLAPSES, method="", mechanism=mechanism, departure=motion)
    return merged(run, answer, "release")


def merged(run: Run, answer: Solution, method: str) -> Solution:
    """Return an answer of another method with this run's work and trace."""
    return replace(
        answer,
        method=method,
        iterations=run.iterations + answer.iterations,
        factorisations=run.scaled.factor.made + answer.factorisations,
        trace=tuple(run.trace),
        info={"history": tuple(run.history), **answer.info},
    )
