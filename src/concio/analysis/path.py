"""Load paths of a model: stages of load groups, followed event by event or in steps.

Friction depends on history: self-weight first, then vertical load, then horizontal load or a settlement. A *stage*
carries the factors of some load groups from where they are to new values, in proportion; all groups begin at zero.
Within a stage slip is measured from the last converged state (10, 11).

``method="events"`` follows the exact polygon (:mod:`concio.solvers.path.event_path`), over jumps where the structure
snaps, and goes over to steps when there are more events than asked for; the notes of the result tell both.
``method="steps"`` takes load steps with the solver named, halving a step that fails or that changes too many states
at once. Models in space are followed in steps: where a slip turns, a path has no corners.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from concio.analysis.entry_point import entry_point
from concio.analysis.lent_compliance import SHEAR_TO_NORMAL, lent_assembly
from concio.analysis.path_breaks import marked, released, without_gone
from concio.analysis.path_result import NamedEvent, PathResult, PathStep, control_functional, named_event
from concio.analysis.path_ties import begin_of_yield, breaking, tie_name, until_a_tie_breaks
from concio.arguments import closest, strict
from concio.contact.assembly import PRESTRESS, Assembly
from concio.contact.factors import load_factor
from concio.display import counted
from concio.errors import InputError, SolverError
from concio.model.model import Model
from concio.model.stages import ControlPoint, Stage
from concio.problem.solution import Progress, ProgressCallback
from concio.solvers.methods import find
from concio.solvers.path.path_state import LinearPath, PathState, at_rest, elastic_energy
from concio.solvers.path.paths_apart import follow_parts
from concio.solvers.path.proof import certify_between, obstacles_moved
from concio.solvers.path.record import EventPath, Outcome
from concio.solvers.path.step_path import StepPath, follow_in_steps

__all__ = ["ControlPoint", "NamedEvent", "PathResult", "PathStep", "Stage", "control_functional", "run_path"]

Array = np.ndarray


@strict
@entry_point
def run_path(
    model: Model | Assembly,
    stages: Sequence[Stage] = (),
    *,
    method: Literal["events", "steps"] | None = None,
    solver: str = "auto",
    restart: tuple[PathResult, int] | None = None,
    max_events: int = 20_000,
    brittle: bool = False,
    progress: ProgressCallback | None = None,
) -> PathResult:
    """Follow a load path through its stages.

    Parameters
    ----------
    model : Model or Assembly
    stages : sequence of Stage
        By default those that come with the model. The prestress of ties grows with the first of them, unless one names
        the factor "prestress".
    method : {"events", "steps"}, optional
        By default events in the plane, steps in space.
    solver : str
        Method of the start of event paths, and of load steps that are not found from the states of the step before.
    restart : (PathResult, int), optional
        Begin at a step of an earlier path of the same model instead of at rest.
    max_events : int
        Corners of a stage after which it goes on in steps.
    brittle : bool
        Whether joints lose tensile strength and cohesion for good in the step after either was used up; otherwise they
        are ductile. Only with ``method="steps"``.
    progress : callable, optional

    Raises
    ------
    InputError
        No stages, or a stage names a load group or body that does not exist.
    SolverError
        A stage could not even be begun.

    Examples
    --------
    The weight acts first. Then a horizontal share of it grows, until the block slides where it reaches the
    friction:

    >>> import concio
    >>> block = concio.column(width=1.0, height=0.5, blocks=1, block="rigid", friction=0.4, horizontal=1.0)
    >>> path = concio.run_path(block, [concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 1.0})])
    >>> round(path.peak(), 6)
    0.4
    >>> path.sentence
    "Collapses in stage 'push': it carries no more than live = 0.4 of 1."
    """
    assembly = lent_assembly(model)
    stages = stages or assembly.model.stages
    if not stages:
        msg = "a load path needs at least one stage"
        raise InputError(msg, hint="for example Stage('weight', {'dead': 1.0})")
    method = method or ("events" if assembly.model.dim == 2 else "steps")
    if method == "events" and assembly.model.dim != 2:
        msg = "paths event by event are for models in the plane; the model is in space"
        raise InputError(msg, hint="follow it in steps: method='steps', or --method steps")
    if brittle and method == "events":
        msg = "joints that break are followed in steps only"
        raise InputError(msg, hint="follow it in steps: method='steps', or --method steps")
    factors = at_zero(assembly)
    state: PathState | None = None
    if restart is not None:
        earlier = restart[0].steps[restart[1]]
        factors, state = dict(earlier.factors), earlier.state
    stages = with_prestress(factors, stages)
    rough = assembly.pairs.interface >= 0
    steps: list[PathStep] = []
    events: list[NamedEvent] = []
    outcomes: list[Outcome] = []
    notes: list[str] = []
    if lent := assembly.lent_compliance:
        notes.append(
            f"hard joints between rigid blocks were given a compliance of {lent:.3g} m/kN, {SHEAR_TO_NORMAL:g} times "
            "as much along the joint: without it their forces are not determined"
        )
    how = _How(assembly, method, solver, max_events, brittle, progress, notes)
    direction = np.zeros(assembly.supported.T.shape[1])
    for number, stage in enumerate(stages):
        target = _target(assembly, factors, stage)
        path = _linear(assembly, factors, target)
        start = then = assembly.problem(factors)
        state = _at_rest(path) if state is None else replace(state, parameter=0.0)
        part = replace(how, progress=_of_all(progress, number, len(stages)))
        found = _past_breaks(part, path, state, stage, (factors, target))
        first = len(steps)
        for before, after in zip((found.states[0], *found.states), found.states, strict=False):
            if after is found.states[0] and steps:
                first -= 1
                continue
            at = {g: factors[g] + after.parameter * (target[g] - factors[g]) for g in factors}
            now = assembly.problem(at, like=then)
            certificate = certify_between(then, now, before, after, moved=obstacles_moved(start, now, rough))
            then, stored = now, elastic_energy(now, after)
            steps.append(PathStep(number, after.parameter, at, after, certificate, stored))
        events.extend(named_event(assembly, number, first, event) for event in found.events)
        outcomes.append(found.outcome)
        direction = found.direction
        state = found.states[-1]
        factors = dict(steps[-1].factors)
        if found.outcome is not Outcome.REACHED:
            notes.append(f"stage '{stage.name}' ended at {state.parameter:.6g} of its load. {found.outcome.value}")
            break
    return PathResult(
        assembly, tuple(stages), tuple(steps), tuple(events), tuple(outcomes), tuple(notes), direction
    )  # fmt: skip


def _of_all(progress: ProgressCallback | None, number: int, count: int) -> ProgressCallback | None:
    """Return a callback of one stage that tells the share of all stages; what is left stands in place of a residual."""
    if progress is None:
        return None
    most = 0.0

    def told(note: Progress) -> bool | None:
        nonlocal most
        most = max(most, min(note.share, 1.0))  # a share that is not known changes nothing
        return progress(replace(note, method="path", residual=1.0 - (number + most) / count))

    return told


@dataclass(frozen=True, eq=False)
class _How:
    """How stages are followed, see :func:`run_path`; ``notes`` grows."""

    assembly: Assembly
    method: str
    solver: str
    max_events: int
    brittle: bool
    progress: ProgressCallback | None
    notes: list[str]


Ends = tuple[Mapping[str, float], Mapping[str, float]]
"""Load factors at both ends of a stage."""


def _past_breaks(how: _How, path: LinearPath, state: PathState, stage: Stage, ends: Ends) -> StepPath:
    """Follow one stage, and go on without each tie that breaks as far as there is an equilibrium without it."""
    assembly = how.assembly
    control = None if stage.control is None else control_functional(assembly, stage.control)[0]
    until = None if control is None else float(control @ state.displacement) + stage.until
    whole: StepPath | None = None
    while True:
        left = without_gone(path, state, assembly.ties)
        found = _walk(how, left, state, stage, ends, (control, until))
        whole = found if whole is None else whole.followed_by(found)
        if found.outcome is not Outcome.BROKEN:
            return whole
        last = marked(assembly, whole.states[-1], whole.events[-1].pair)
        whole = replace(whole, states=(*whole.states[:-1], last))
        after = released(without_gone(path, last, assembly.ties), last, control, find(how.solver))
        if after is None:
            return whole
        name = tie_name(assembly, whole.events[-1].pair)
        fell = "" if control is None else f", where the load falls to {after.parameter:.6g} of the stage's"
        told = f"stage '{stage.name}': tie '{name}' breaks at {last.parameter:.6g}{fell}"
        how.notes.append(f"{told}; the path goes on without it")
        whole = replace(whole, states=(*whole.states, after))
        state = after


def _walk(
    how: _How,
    path: LinearPath,
    state: PathState,
    stage: Stage,
    ends: Ends,
    controlled: tuple[Array | None, float | None],
) -> StepPath:
    """Follow one stage, by events and where there are too many on in steps; ``ends`` are its load factors.

    ``controlled`` is the functional that is controlled, with the value to reach; None for the load.
    """
    assembly, solver, progress = how.assembly, how.solver, how.progress
    control, until = controlled[0], 1.0 if controlled[1] is None else controlled[1]
    if how.method == "steps":
        if control is not None:
            msg = f"stage '{stage.name}' is controlled by a displacement, which steps cannot follow"
            raise InputError(msg, hint="use method='events'")
        found = follow_in_steps(
            path, state, until=until, steps=stage.steps, solver=find(solver), brittle=how.brittle,
            locate=begin_of_yield(assembly, path, find(solver)), progress=progress,
        )  # fmt: skip
        return until_a_tie_breaks(assembly, path, found, *ends, solver=solver, exact=False)
    stop = breaking(assembly, *ends)
    exact = follow_parts(
        path, state, until=until, control=control, max_events=how.max_events, progress=progress, stop=stop
    )
    found = StepPath(exact.states, exact.events, exact.outcome, exact.direction)
    found = until_a_tie_breaks(assembly, path, found, *ends, solver=solver, exact=True)
    how.notes.extend(_finite_steps(stage, exact))
    if control is not None or found.outcome is not Outcome.TOO_MANY:
        return found
    how.notes.append(
        f"stage '{stage.name}': after {len(exact.events)} events, at {exact.end.parameter:.6g} of its load the path "
        f"was continued in {stage.steps} steps"
    )
    rest = follow_in_steps(
        path, exact.end, until=until, steps=stage.steps, solver=find(solver),
        locate=begin_of_yield(assembly, path, find(solver)), progress=progress,
    )  # fmt: skip
    rest = until_a_tie_breaks(assembly, path, rest, *ends, solver=solver, exact=False)
    return replace(found, states=exact.states).followed_by(rest)


def _finite_steps(stage: Stage, exact: EventPath) -> list[str]:
    """Return the notes on jumps and restarts of a stage."""
    restarts = [e.parameter for e in exact.events if e.kind == "restarts"]
    jumps = [e.parameter for e in exact.jumps]
    found = []
    if jumps:
        found.append(
            f"stage '{stage.name}': {_counted_at(jumps, 'jump')}: no state follows on the one before, and the path "
            "goes on from the state in equilibrium found under a slightly larger load"
        )
    if restarts:
        found.append(
            f"stage '{stage.name}': {_counted_at(restarts, 'finite step')}, where no rates were found that continue "
            "the path"
        )
    return found


def _counted_at(where: list[float], word: str) -> str:
    return f"{counted(len(where), word)}, {'the first ' * (len(where) > 1)}at {where[0]:.6g}"


def _target(assembly: Assembly, factors: Mapping[str, float], stage: Stage) -> dict[str, float]:
    for group in stage.factors:
        if group not in factors:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, where=f"stage '{stage.name}'", hint=closest(group, assembly.groups, names="groups"))
    return {**factors, **{g: float(v) for g, v in stage.factors.items()}}


def at_zero(assembly: Assembly) -> dict[str, float]:
    """Return the factors before anything acts: 0 for each load group, and for the prestress of ties if there is any."""
    stretched = (PRESTRESS,) if assembly.prestress.any() else ()
    return dict.fromkeys((*assembly.groups, *stretched), 0.0)


def with_prestress(factors: Mapping[str, float], stages: Sequence[Stage]) -> tuple[Stage, ...]:
    """Return the stages, the first of which puts on the prestress of ties unless a stage names it or it acts already.

    Parameters
    ----------
    factors : mapping of str to float
        Where the path begins.
    stages : sequence of Stage
    """
    if load_factor(factors, PRESTRESS) or any(PRESTRESS in stage.factors for stage in stages):
        return tuple(stages)
    first = replace(stages[0], factors={**stages[0].factors, PRESTRESS: 1.0})
    return (first, *stages[1:])


def _linear(assembly: Assembly, start: Mapping[str, float], end: Mapping[str, float]) -> LinearPath:
    """Return the path of a stage: everything a problem holds is linear in the load factors."""
    a, b = assembly.problem(start), assembly.problem(end)
    return LinearPath(a, b.f - a.f, b.gap - a.gap, a.slip_origin - b.slip_origin, b.load - a.load)


def _at_rest(path: LinearPath) -> PathState:
    """Return the state before any load: pairs without a gap touch, nothing carries force."""
    problem = path.problem
    if (problem.gap < 0).any() or np.abs(problem.f).any():
        deep = float(np.maximum(-problem.gap, 0.0).max(initial=0.0))
        msg = f"the path does not begin at rest: before anything acts, joints overlap by up to {deep:.3g} m"
        raise SolverError(msg, hint="move the blocks apart, or solve one load step, which overlaps may begin")
    return at_rest(problem)
