"""What a load path of a model consists of: steps, named events, curves of control points."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from concio.analysis.result import Result
from concio.arguments import closest
from concio.contact.assembly import Assembly
from concio.errors import InputError
from concio.model.stages import ControlPoint, Stage
from concio.problem.certificate import Certificate
from concio.problem.solution import Status, judge
from concio.problem.tolerances import CERTIFIED
from concio.representation import short_repr
from concio.solvers.path.record import Event, Outcome
from concio.solvers.path.state import LinearPath, PathState, path_kinematics, weakened

if TYPE_CHECKING:
    from concio.plot.path_accessor import PathPlots

Array = np.ndarray

MOST_STAGES = 8
"""More stages than this are counted in a short text."""

DUST = 1e-12
"""Motions below this share of the largest displacement of the path are rounding, and zero."""


@short_repr
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


@short_repr
@dataclass(frozen=True)
class NamedEvent:
    """A change of state with the joint it happens at.

    Parameters
    ----------
    stage, step : int
        Stage, and index of the step at which it happens.
    parameter : float
    kind : str
        "opens", "closes", "slips", "sticks", "crushes", "recovers", "breaks"; "jumps" and "restarts" are finite steps
        of the whole structure, named after the joint that moves most.
    bodies : (str, str)
    at : (x, y) or (x, y, z)
        [m].
    pair : int
    """

    stage: int
    step: int
    parameter: float
    kind: str
    bodies: tuple[str, str]
    at: tuple[float, ...]
    pair: int

    def __str__(self) -> str:
        a, b = self.bodies
        place = ", ".join(f"{x:.4g}" for x in self.at)
        return f"{self.parameter:.6g}: {a} | {b} {self.kind} at ({place})"


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

    def __repr__(self) -> str:
        size = f"{len(self.steps):,} states, {len(self.events):,} events"
        lines = [
            f"PathResult: {self.sentence}",
            f"  {self.assembly.model.title or 'model without a title'}: {size}, certified to {self.certificate:.1e}",
        ]
        for k, outcome in enumerate(self.outcomes[:MOST_STAGES]):
            name, values = self.load(k)
            lines.append(f"  stage '{self.stages[k].name}': {outcome.name}, {name} = {values.max():.6g} at most")
        if len(self.outcomes) > MOST_STAGES:
            lines.append(f"  ... and {len(self.outcomes) - MOST_STAGES} more stages")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        from concio.report.notebook import path_html

        return path_html(self)

    @property
    def complete(self) -> bool:
        """True when every stage reached its end."""
        return len(self.outcomes) == len(self.stages) and all(o is Outcome.REACHED for o in self.outcomes)

    @property
    def collapsed(self) -> bool:
        """True where the path ended in a collapse: the load grows no further, or a mechanism has formed."""
        return self.outcomes[-1] in (Outcome.LIMIT, Outcome.MECHANISM)

    @property
    def certified(self) -> bool:
        """True when every state of the path passes its check."""
        return bool(self.certificate <= CERTIFIED)

    @property
    def sentence(self) -> str:
        """How the path ended, and at which load, in one sentence."""
        if self.complete:
            whole = "The stage is" if len(self.stages) == 1 else f"All {len(self.stages)} stages are"
            return f"{whole} carried to the end."
        name, values = self.load()
        stage = self.stages[len(self.outcomes) - 1].name
        most = f"{name} = {float(values.max()):.6g}"
        if self.collapsed:
            return f"Collapses in stage '{stage}': it carries no more than {most}."
        if self.outcomes[-1] is Outcome.LOST:
            return f"Lost in stage '{stage}': at least {most} is carried, and what follows is not known."
        return f"Stopped in stage '{stage}', which was carried up to {most}."

    def load(self, stage: int = -1) -> tuple[str, Array]:
        """Return what changes in a stage, in words, and its value where the stage begins and at each of its steps.

        That is the load factor of the groups that change, where they change alike, else the share of the stage.
        """
        wanted = stage % len(self.outcomes)
        own = [i for i, step in enumerate(self.steps) if step.stage == wanted]
        own = [own[0] - 1, *own] if own and own[0] > 0 else own
        first, target = self.steps[own[0]].factors, {**self.steps[own[0]].factors, **self.stages[wanted].factors}
        changed = [g for g in first if target[g] != first[g]]
        if changed and len({(first[g], target[g]) for g in changed}) == 1:
            return " and ".join(changed), np.array([self.steps[i].factors[changed[0]] for i in own])
        share = [self.steps[i].parameter if self.steps[i].stage == wanted else 0.0 for i in own]
        return f"share of '{self.stages[wanted].name}'", np.array(share)

    @property
    def plot(self) -> PathPlots:
        """Figures by name: ``path.plot.curve()``; matplotlib is loaded here."""
        from concio.plot.path_accessor import PathPlots

        return PathPlots(self)

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
        u = np.array([functional @ self.steps[i].state.displacement + shift(self.steps[i].factors) for i in chosen])
        size = max((float(np.abs(s.state.displacement).max(initial=0.0)) for s in self.steps), default=0.0)
        return np.where(np.abs(u) <= DUST * size, 0.0, u), np.array(load)

    def result(self, step: int = -1) -> Result:
        """Return one step as a :class:`Result`, with its slips counted from the beginning of the path.

        Gaps are less what dilatancy opened with every slip on the way, so that a closed joint has none.
        The certificate, and with it the status, is that of the step, whose slip directions count from the step before.
        """
        chosen = self.steps[step]
        problem, state = self.assembly.problem(chosen.factors), chosen.state
        problem = weakened(problem, state.broken)
        judged = judge(problem, state.displacement, state.normal_force, state.friction_force, method="path")
        status = Status.SOLVED if chosen.certificate.certified else Status.GAVE_UP
        moved = path_kinematics(LinearPath(problem, np.zeros(problem.unknowns)), state)
        solution = replace(judged, kinematics=moved, certificate=chosen.certificate, status=status)
        return Result(self.assembly, dict(chosen.factors), solution, {"total": 0.0})


def control_functional(assembly: Assembly, point: ControlPoint) -> tuple[Array, Callable[[Mapping[str, float]], float]]:
    """Return the displacement of a control point as (functional (N,) of the free unknowns, part imposed by factors)."""
    names = [body.name for body in assembly.model.bodies]
    if point.body not in names:
        msg = f"there is no body called '{point.body}'"
        hint = closest(point.body, names, otherwise="see the names with 'concio check'")
        raise InputError(msg, where="control point", hint=hint)
    b, disc = names.index(point.body), assembly.disc
    size = float(np.linalg.norm(point.direction))
    if not size > 0:
        msg = f"direction {point.direction} has no length"
        raise InputError(msg, where="control point", hint="for example (1, 0)")
    unknowns, rows = disc.point_operator(b, np.array(point.at, dtype=float))
    whole = np.zeros(disc.unknowns)
    whole[unknowns] = np.array(point.direction) / size @ rows
    functional: Array = assembly.supported.T.T @ whole
    return functional, lambda factors: float(whole @ assembly.imposed(factors))


def named_event(assembly: Assembly, stage: int, first: int, event: Event) -> NamedEvent:
    """Return an event with the bodies of its joint and its place, without rounding noise.

    Parameters
    ----------
    assembly : Assembly
    stage : int
    first : int
        Index, among all steps of the path, of the step at which the stage begins.
    event : Event
    """
    pairs, bodies = assembly.pairs, assembly.model.bodies
    k = event.pair
    names = (bodies[int(pairs.body_a[k])].name, _other(assembly, k))
    size = float(np.abs(pairs.point).max(initial=0.0))
    place = tuple(float(v) if abs(v) > DUST * size else 0.0 for v in pairs.point[k])
    parameter = event.parameter if abs(event.parameter) > DUST else 0.0
    return NamedEvent(stage, first + event.step, parameter, event.kind, names, place, k)


def _other(assembly: Assembly, k: int) -> str:
    b = int(assembly.pairs.body_b[k])
    return assembly.model.bodies[b].name if b >= 0 else "fixed point"
