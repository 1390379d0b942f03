"""What a load path of a model consists of: steps, named events, curves of control points."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from concio.analysis.collapse_sensitivity import collapse_sensitivity
from concio.analysis.path_loads import GroupLoad, loads_of_stage
from concio.analysis.result import Result
from concio.contact.assembly import Assembly
from concio.contact.points import check_point, direction_of
from concio.model.self_weight import weight_groups, weightless
from concio.model.stages import ControlPoint, Stage
from concio.problem.certificate import Certificate
from concio.problem.solution import Status, judge
from concio.problem.tolerances import CERTIFIED
from concio.read_only import read_only
from concio.representation import short_repr
from concio.solvers.path.path_state import LinearPath, PathState, path_kinematics, weakened
from concio.solvers.path.record import Event, Outcome
from concio.verdict.path_verdict import path_lines, path_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.analysis.sensitivity import Sensitivity
    from concio.plot.path_accessor import PathPlots
    from concio.post.path_tables import PathTables

Array = np.ndarray

TIE_EVENTS = {"opens": "slackens", "closes": "tightens", "crushes": "yields", "recovers": "unloads"}
"""What a pair does is called where it stands for a tie."""

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
        "opens", "closes", "slips", "sticks", "crushes", "recovers", "breaks"; of ties "slackens", "tightens", "yields",
        "unloads", "breaks"; "jumps" and "restarts" are finite steps
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
@read_only
class PathResult(Shown):
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
        return "\n".join(path_lines(self))

    @property
    def complete(self) -> bool:
        """True when every stage reached its end: its loads in full, and the motion of its control point."""
        walked = len(self.outcomes) == len(self.stages) and all(o is Outcome.REACHED for o in self.outcomes)
        return walked and not self.short

    @property
    def short(self) -> tuple[int, ...]:
        """Stages that moved their control point as far as asked without reaching the loads asked for."""
        reached = (k for k, outcome in enumerate(self.outcomes) if outcome is Outcome.REACHED)
        return tuple(k for k in reached if not all(load.applied for load in self.group_loads(k)))

    @property
    def collapsed(self) -> bool:
        """True where the path ended in a collapse: the load grows no further, or a mechanism has formed."""
        return self.outcomes[-1] in (Outcome.LIMIT, Outcome.MECHANISM)

    @property
    def certified(self) -> bool:
        """True when every state of the path passes its check."""
        return bool(self.certificate <= CERTIFIED)

    @cached_property
    def verdict(self) -> Verdict:
        """The answer with its question: the stages asked for, what was reached of them, what proves and limits it."""
        return path_verdict(self)

    def sensitivity(self) -> Sensitivity | None:
        """Return what the load factor at collapse depends on; None where it has no derivatives.

        See :func:`concio.analysis.collapse_sensitivity.collapse_sensitivity`.
        """
        return collapse_sensitivity(self)

    @property
    def sentence(self) -> str:
        """How the path ended, at which load, and what of the question is left open."""
        return self.verdict.sentence

    def group_loads(self, stage: int = -1) -> tuple[GroupLoad, ...]:
        """Return what a stage that was begun asked of each load group it changes, and what was reached of it."""
        return loads_of_stage(self.stages, self.steps, stage % len(self.outcomes))

    @property
    def broken_ties(self) -> tuple[tuple[str, float], ...]:
        """The ties that break on the path, in order, with how far each is stretched there [m]."""
        return self._broken_before(len(self.steps))

    def _broken_before(self, step: int) -> tuple[tuple[str, float], ...]:
        """Return the ties that break in steps before one, with how far each is stretched there [m]."""
        own, found = self.assembly.ties.tolist(), []
        for event in self.events:
            if event.kind == "breaks" and event.pair in own and event.step < step:
                at, k = self.steps[event.step], own.index(event.pair)
                far = self.assembly.elongations(at.state.displacement, at.factors)
                found.append((self.assembly.model.ties[k].name, float(far[k])))
        return tuple(found)

    @property
    def never_applied(self) -> tuple[str, ...]:
        """Load groups that act in no state of the path, and that no stage asks for."""
        asked = {g for stage in self.stages for g, v in stage.factors.items() if v}
        acted = {g for step in self.steps for g, v in step.factors.items() if v}
        return tuple(g for g in self.assembly.groups if g not in asked | acted)

    @property
    def weightless_stages(self) -> tuple[int, ...]:
        """Stages that were begun and end with loads but without any self-weight, though the model has some."""
        groups = weight_groups(self.assembly.model)
        ends = {step.stage: step.factors for step in self.steps}
        without = (k for k, factors in ends.items() if set(weightless(self.assembly.model, factors)) == set(groups))
        return tuple(without) if groups else ()

    def load(self, stage: int = -1) -> tuple[str, Array]:
        """Return what changes in a stage, in words, and its value where the stage begins and at each of its steps.

        That is the load factor of the groups that change, where they change alike, else the share of the stage.
        """
        wanted = stage % len(self.outcomes)
        own = [i for i, step in enumerate(self.steps) if step.stage == wanted]
        own = own or [sum(step.stage < wanted for step in self.steps)]  # it ended where it began
        own = [own[0] - 1, *own] if own[0] > 0 else own
        own = [i for i in own if i < len(self.steps)]
        first, target = self.steps[own[0]].factors, {**self.steps[own[0]].factors, **self.stages[wanted].factors}
        changed = [g for g in first if target[g] != first[g]]
        if changed and len({(first[g], target[g]) for g in changed}) == 1:
            return " and ".join(changed), np.array([self.steps[i].factors[changed[0]] for i in own])
        share = [self.steps[i].parameter if self.steps[i].stage == wanted else 0.0 for i in own]
        return f"share of '{self.stages[wanted].name}'", np.array(share)

    @property
    def plot(self) -> PathPlots:
        """Figures by name: ``path.plot.curve()``; matplotlib is loaded here."""
        plots: PathPlots = view(self, "plot")
        return plots

    @property
    def tables(self) -> PathTables:
        """Tables by name, as dicts of arrays: ``pandas.DataFrame(path.tables.curve())``."""
        tables: PathTables = view(self, "tables")
        return tables

    @property
    def certificate(self) -> float:
        """Worst certificate entry of all steps."""
        return max((s.certificate.worst for s in self.steps), default=0.0)

    @cached_property
    def energy_error(self) -> float:
        """Largest |work - stored - dissipated| of all steps, relative to the energy exchanged.

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
        """Return (displacement of the point [m], parameter) at every step, of one stage from its start or of all.

        Examples
        --------
        A pillar of 2 m and 5 GPa is shortened by 0.04 mm under a pressure of 100 kN/m2:

        >>> import concio
        >>> stone = concio.Elastic(E="5 GPa", nu=0.0)
        >>> pillar = concio.column(width=0.5, height=2.0, blocks=4, block=stone, top_pressure=100.0)
        >>> path = concio.run_path(pillar, [concio.Stage("press", {"top": 1.0})])
        >>> head = concio.ControlPoint("b04", at=(0.0, 2.0), direction=(0.0, -1.0))
        >>> displacement, parameter = path.curve(head)
        >>> round(1e3 * float(displacement[-1]), 6), float(parameter[-1])
        (0.04, 1.0)
        """
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

        Examples
        --------
        >>> import concio
        >>> block = concio.column(width=1.0, height=0.5, blocks=1, block="rigid", unit_weight=20.0, horizontal=0.3)
        >>> path = concio.run_path(block, [concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 1.0})])
        >>> [round(float(force), 6) for force in path.result().reactions["ground"]]
        [-3.0, 10.0]
        """
        chosen = self.steps[step]
        problem, state = self.assembly.problem(chosen.factors), chosen.state
        problem = weakened(problem, state.broken)
        judged = judge(problem, state.displacement, state.normal_force, state.friction_force, method="path")
        status = Status.SOLVED if chosen.certificate.certified else Status.GAVE_UP
        moved = path_kinematics(LinearPath(problem, np.zeros(problem.unknowns)), state)
        solution = replace(judged, kinematics=moved, certificate=chosen.certificate, status=status)
        gone = self._broken_before(range(len(self.steps))[step])
        return Result(self.assembly, dict(chosen.factors), solution, {"total": 0.0}, broken_ties=gone)


def control_functional(assembly: Assembly, point: ControlPoint) -> tuple[Array, Callable[[Mapping[str, float]], float]]:
    """Return the displacement of a control point as (functional (N,) of the free unknowns, part imposed by factors)."""
    names = [body.name for body in assembly.model.bodies]
    check_point(assembly.model, point, "control point")
    b, disc = names.index(point.body), assembly.disc
    unknowns, rows = disc.point_operator(b, np.array(point.at, dtype=float))
    whole = np.zeros(disc.unknowns)
    whole[unknowns] = direction_of(point, assembly.model.dim) @ rows
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
    kind = TIE_EVENTS.get(event.kind, event.kind) if pairs.interface[k] < 0 else event.kind
    size = float(np.abs(pairs.point).max(initial=0.0))
    place = tuple(float(v) if abs(v) > DUST * size else 0.0 for v in pairs.point[k])
    parameter = event.parameter if abs(event.parameter) > DUST else 0.0
    return NamedEvent(stage, first + event.step, parameter, kind, names, place, k)


def _other(assembly: Assembly, k: int) -> str:
    b = int(assembly.pairs.body_b[k])
    return assembly.model.bodies[b].name if b >= 0 else "fixed point"
