"""Load paths of a model: stages of load groups, followed event by event or in steps.

Friction depends on history: own weight first, then vertical load, then horizontal load or a settlement. A *stage*
carries the factors of some load groups from where they are to new values, in proportion; all groups begin at zero.
Within a stage slip is measured from the last converged state (10, 11).

``method="events"`` follows the exact polygon (:mod:`concio.lcp.event_path`) and goes over to steps, saying so, when
there are more events than asked for, or where it finds no way on though small load steps find one without a jump.
``method="steps"`` takes load steps with the solver named, halving a step that fails or that changes too many states
at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from concio.analysis.lent_compliance import SHEAR_TO_NORMAL, assembly_with_compliance
from concio.analysis.result import Result
from concio.contact.assembly import Assembly, assemble
from concio.errors import InputError, SolverError
from concio.lcp.certificate import Certificate
from concio.lcp.event_path import follow
from concio.lcp.methods import find
from concio.lcp.path_record import Event, Outcome
from concio.lcp.path_state import OPEN, LinearPath, PathState, certify_step, elastic_energy, step_problem, weakened
from concio.lcp.solution import ProgressCallback, Status, judge
from concio.lcp.step_path import StepPath, follow_in_steps
from concio.model.model import Model
from concio.model.stages import ControlPoint, Stage

__all__ = ["ControlPoint", "NamedEvent", "PathResult", "PathStep", "Stage", "control_functional", "run_path"]

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class PathStep:
    """One point of the path.

    Parameters
    ----------
    stage : int
    parameter : float
        0 at the beginning of the stage, 1 where its factors are reached.
    factors : mapping
        Load factors.
    state : PathState
    certificate : Certificate
        Of the step from the point before.
    stored : float
        Energy stored in bodies and compliant joints [kN m].
    """

    stage: int
    parameter: float
    factors: Mapping[str, float]
    state: PathState
    certificate: Certificate
    stored: float


@dataclass(frozen=True)
class NamedEvent:
    """A change of state with the joint it happens at.

    Parameters
    ----------
    stage, step : int
        Stage, and index of the step at which it happens.
    parameter : float
    kind : str
        "opens", "closes", "slips", "sticks", "crushes", "recovers", "breaks".
    bodies : (str, str)
    at : (x, y)
        [m].
    pair : int
    """

    stage: int
    step: int
    parameter: float
    kind: str
    bodies: tuple[str, str]
    at: tuple[float, float]
    pair: int

    def __str__(self) -> str:
        a, b = self.bodies
        return f"{self.parameter:.6g}: {a} | {b} {self.kind} at ({self.at[0]:.4g}, {self.at[1]:.4g})"


@dataclass(frozen=True, eq=False)
class PathResult:
    """A load path with every step and every event.

    Parameters
    ----------
    assembly : Assembly
    stages : tuple of Stage
    steps : tuple of PathStep
    events : tuple of NamedEvent
    outcomes : tuple of Outcome
        How each stage ended; stages after one that did not reach its end were not begun.
    notes : tuple of str
        What the program did that was not asked for, such as going over to steps.
    direction : (N,) array
        Last rate of displacement, largest entry 1: the mechanism where the path ended in one.
    """

    assembly: Assembly
    stages: tuple[Stage, ...]
    steps: tuple[PathStep, ...]
    events: tuple[NamedEvent, ...]
    outcomes: tuple[Outcome, ...]
    notes: tuple[str, ...]
    direction: Array

    @property
    def complete(self) -> bool:
        """True when every stage reached its end."""
        return len(self.outcomes) == len(self.stages) and all(o is Outcome.REACHED for o in self.outcomes)

    @property
    def certificate(self) -> float:
        """Worst certificate entry of all steps."""
        return max((s.certificate.worst for s in self.steps), default=0.0)

    @cached_property
    def energy_error(self) -> float:
        """Largest |work - stored - dissipated| of all steps, relative to the energy turned over.

        That is the largest of work, stored energy and |f| . |u|: a settlement lifts and lowers weights whose work
        nearly cancels that of the moving support.
        """
        gap = max(abs(s.state.work - s.state.dissipation - s.stored) for s in self.steps)
        sizes = [abs(s.state.work) + s.stored for s in self.steps]
        sizes += [float(np.abs(self.assembly.problem(s.factors).f) @ np.abs(s.state.displacement)) for s in self.steps]
        return gap / max(sizes) if max(sizes) else 0.0

    def peak(self, stage: int = -1) -> float:
        """Return the largest parameter met in a stage: 0 where it ended as it began."""
        wanted = stage % len(self.outcomes)
        return max((s.parameter for s in self.steps if s.stage == wanted), default=0.0)

    def curve(self, point: ControlPoint, stage: int | None = None) -> tuple[Array, Array]:
        """Return (displacement of the point [m], parameter) at every step, of one stage from its start or of all."""
        functional, shift = control_functional(self.assembly, point)
        chosen = list(range(len(self.steps)))
        if stage is not None:
            chosen = [i for i in chosen if self.steps[i].stage == stage % len(self.outcomes)]
        load = [self.steps[i].parameter for i in chosen]
        if stage is not None and chosen and chosen[0] > 0:
            chosen, load = [chosen[0] - 1, *chosen], [0.0, *load]
        u = [functional @ self.steps[i].state.displacement + shift(self.steps[i].factors) for i in chosen]
        return np.array(u), np.array(load)

    def result(self, step: int = -1) -> Result:
        """Return one step as a :class:`Result`, with its slips counted from the beginning of the path.

        The certificate, and with it the status, is that of the step, whose slip directions count from the step before.
        """
        chosen = self.steps[step]
        problem, state = self.assembly.problem(chosen.factors), chosen.state
        problem = weakened(problem, state.broken)
        judged = judge(problem, state.displacement, state.normal_force, state.friction, method="path")
        status = Status.SOLVED if chosen.certificate.certified else Status.GAVE_UP
        solution = replace(judged, certificate=chosen.certificate, status=status)
        return Result(self.assembly, dict(chosen.factors), solution, {"total": 0.0})


def control_functional(assembly: Assembly, point: ControlPoint) -> tuple[Array, Callable[[Mapping[str, float]], float]]:
    """Return the displacement of a control point as (functional (N,) of the free unknowns, part imposed by factors)."""
    names = [body.name for body in assembly.model.bodies]
    if point.body not in names:
        msg = f"there is no body called '{point.body}'"
        raise InputError(msg, where="control point", hint="see the names with 'concio check'")
    b, disc = names.index(point.body), assembly.disc
    size = float(np.hypot(*point.direction))
    if not size > 0:
        msg = f"direction {point.direction} has no length"
        raise InputError(msg, where="control point", hint="for example (1, 0)")
    unknowns, rows = disc.point_operator(b, np.array(point.at, dtype=float))
    whole = np.zeros(disc.unknowns)
    whole[unknowns] = np.array(point.direction) / size @ rows
    functional: Array = assembly.supported.T.T @ whole
    return functional, lambda factors: float(whole @ assembly.imposed(factors))


def run_path(
    model: Model | Assembly,
    stages: Sequence[Stage] = (),
    *,
    method: Literal["events", "steps"] = "events",
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
        By default those that come with the model.
    method : {"events", "steps"}
    solver : str
        Method of the load steps and of the start of event paths.
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
    """
    stages = stages or (model.model if isinstance(model, Assembly) else model).stages
    if not stages:
        msg = "a load path needs at least one stage"
        raise InputError(msg, hint="for example Stage('weight', {'dead': 1.0})")
    if brittle and method != "steps":
        msg = "joints that break are followed in steps only"
        raise InputError(msg, hint="use method='steps'")
    assembly, lent = assembly_with_compliance(model if isinstance(model, Assembly) else assemble(model))
    factors = dict.fromkeys(assembly.groups, 0.0)
    state: PathState | None = None
    if restart is not None:
        earlier = restart[0].steps[restart[1]]
        factors, state = dict(earlier.factors), earlier.state
    steps: list[PathStep] = []
    events: list[NamedEvent] = []
    outcomes: list[Outcome] = []
    notes: list[str] = []
    if lent:
        notes.append(
            f"hard joints between rigid blocks were lent a compliance of {lent:.3g} m/kN, {SHEAR_TO_NORMAL:g} times as "
            "much along the joint: without it their forces are not determined"
        )
    direction = np.zeros(assembly.supported.T.shape[1])
    for number, stage in enumerate(stages):
        target = _target(assembly, factors, stage)
        path = _linear(assembly, factors, target)
        state = _at_rest(path) if state is None else replace(state, parameter=0.0)
        found = _walk(assembly, path, state, stage, method, solver, max_events, brittle, progress, notes)
        first = len(steps)
        for before, after in zip((found.states[0], *found.states), found.states, strict=False):
            if after is found.states[0] and steps:
                first -= 1
                continue
            at = {g: factors[g] + after.parameter * (target[g] - factors[g]) for g in factors}
            certificate = certify_step(path, before, after)
            stored = elastic_energy(path.problem, after)
            steps.append(PathStep(number, after.parameter, at, after, certificate, stored))
        events.extend(_named(assembly, number, first, event) for event in found.events)
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


def _walk(
    assembly: Assembly,
    path: LinearPath,
    state: PathState,
    stage: Stage,
    method: str,
    solver: str,
    max_events: int,
    brittle: bool,
    progress: ProgressCallback | None,
    notes: list[str],
) -> StepPath:
    """Follow one stage, by events and where there are too many on in steps."""
    control, until = None, 1.0
    if stage.control is not None:
        control, _ = control_functional(assembly, stage.control)
        until = float(control @ state.displacement) + stage.until
    if method == "steps":
        if control is not None:
            msg = f"stage '{stage.name}' is controlled by a displacement, which steps cannot follow"
            raise InputError(msg, hint="use method='events'")
        return follow_in_steps(
            path, state, until=until, steps=stage.steps, solver=find(solver), brittle=brittle, progress=progress
        )
    exact = follow(path, state, until=until, control=control, max_events=max_events, progress=progress)
    found = StepPath(exact.states, exact.events, exact.outcome, exact.direction)
    if control is not None:
        return found
    ended = exact.outcome in (Outcome.LIMIT, Outcome.LOST)
    if exact.outcome is not Outcome.TOO_MANY and not (ended and _goes_on(path, exact.end, solver)):
        return found
    why = ", where no state of the critical pairs continues it but a load step does," if ended else ""
    notes.append(
        f"stage '{stage.name}': after {len(exact.events)} events, at {exact.end.parameter:.6g} of its load{why} the "
        f"path was continued in {stage.steps} steps"
    )
    rest = follow_in_steps(path, exact.end, until=until, steps=stage.steps, solver=find(solver), progress=progress)
    moved = tuple(replace(e, step=e.step + len(exact.states) - 1) for e in rest.events)
    return StepPath(exact.states + rest.states[1:], exact.events + moved, rest.outcome, rest.direction)


def _goes_on(path: LinearPath, end: PathState, solver: str) -> bool:
    """Tell whether small load steps lead on from a point, their displacements shrinking with the step: no jump."""
    moved = []
    for share in (1e-3, 1e-4):
        parameter = end.parameter + share * (1.0 - end.parameter)
        solution = find(solver)(step_problem(path, end, parameter))
        if not solution.solved:
            return False
        moved.append(float(np.abs(solution.displacement - end.displacement).max()))
    return moved[1] <= 0.5 * moved[0]


def _target(assembly: Assembly, factors: Mapping[str, float], stage: Stage) -> dict[str, float]:
    for group in stage.factors:
        if group not in factors:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, where=f"stage '{stage.name}'", hint="groups: " + ", ".join(assembly.groups))
    return {**factors, **{g: float(v) for g, v in stage.factors.items()}}


def _linear(assembly: Assembly, start: Mapping[str, float], end: Mapping[str, float]) -> LinearPath:
    """Return the path of a stage: everything a problem holds is linear in the load factors."""
    a, b = assembly.problem(start), assembly.problem(end)
    return LinearPath(a, b.f - a.f, b.gap - a.gap, (a.slip_origin - b.slip_origin)[:, 0])


def _at_rest(path: LinearPath) -> PathState:
    """Return the state before any load: pairs without a gap touch, nothing carries force."""
    problem = path.problem
    if (problem.gap < 0).any() or np.abs(problem.f).any():
        msg = "the path does not begin at rest: loads or overlaps are there before the first stage"
        raise SolverError(msg, hint="give every load and imposed displacement a load group")
    zero = np.zeros(problem.pairs)
    contact = np.where(problem.gap > 0, OPEN, 1).astype(np.int8)
    return PathState(0.0, np.zeros(problem.unknowns), zero, zero, contact, zero.astype(np.int8), zero, zero)


def _named(assembly: Assembly, stage: int, first: int, event: Event) -> NamedEvent:
    pairs, bodies = assembly.pairs, assembly.model.bodies
    k = event.pair
    names = (bodies[int(pairs.body_a[k])].name, _other(assembly, k))
    at = (float(pairs.point[k, 0]), float(pairs.point[k, 1]))
    return NamedEvent(stage, first + event.step, event.parameter, event.kind, names, at, k)


def _other(assembly: Assembly, k: int) -> str:
    b = int(assembly.pairs.body_b[k])
    return assembly.model.bodies[b].name if b >= 0 else "fixed point"
