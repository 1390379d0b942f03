"""Response of a cell along a path of macroscopic strains and stresses, joints opening, closing and slipping.

In each stage every component is either driven in strain or given in stress; what a stage does not name stays as it was,
and at first all stresses are zero. Strains that are driven move the pairs across the cell's edges, those that are not
are unknowns under their given stress (:meth:`concio.analysis.cells.periodic_cell.PeriodicCell.problem`); between two
changes of state everything is linear, and the path is followed from event to event by
:mod:`concio.solvers.path.event_path`, like any load path of a wall.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from concio.analysis.cells.cell_path_result import CellPath, CellStep
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.analysis.entry_point import entry_point
from concio.analysis.lent_compliance import SHEAR_TO_NORMAL, with_compliance
from concio.analysis.path_result import NamedEvent, named_event
from concio.arguments import strict
from concio.contact.assembly import Assembly
from concio.contact.macroscopic_strain import COMPONENTS
from concio.display import counted
from concio.errors import InputError
from concio.model.model import Model
from concio.model.stages import Stage
from concio.problem.certificate import Certificate
from concio.problem.contact_problem import ContactProblem, Laws
from concio.problem.solution import ProgressCallback
from concio.solvers.methods import find
from concio.solvers.path.event_path import follow
from concio.solvers.path.path_state import LinearPath, PathState, at_rest, elastic_energy
from concio.solvers.path.proof import certify_between
from concio.solvers.path.record import Outcome
from concio.solvers.path.step_path import StepPath, follow_in_steps

Array = np.ndarray

LEAST = 1e-6
"""Certificates measure forces and displacements by no less than this share of the largest of the path."""

UNKNOWN = Certificate(*([np.inf] * 5))


@dataclass(frozen=True, eq=False)
class Drive:
    """What acts on a cell: which components are given in strain, and the given values.

    Parameters
    ----------
    strain : (3,) array of bool
        Whether a component is driven in strain; the others are given in stress.
    values : (3,) array
        Strains, or stresses [kN/m2].
    """

    strain: Array
    values: Array


@strict
@entry_point
def strain_path(
    cell: Model | Assembly | PeriodicCell,
    stages: Sequence[Stage | Mapping[str, float]] | Mapping[str, float] = (),
    *,
    method: Literal["events", "steps"] = "events",
    solver: str = "auto",
    max_events: int = 20_000,
    progress: ProgressCallback | None = None,
) -> CellPath:
    """Follow the response of a periodic cell to macroscopic strains and stresses, event by event.

    Parameters
    ----------
    cell : Model or Assembly
        With periods.
    stages : sequence of mapping or Stage
        What is reached at the end of each stage: ``[{"stress yy": -100.0}, {"strain xy": 1e-3}]`` [kN/m2], with
        components xx, yy, xy; the strain xy is the engineering shear. Components that a stage does not name keep what
        they had, a given stress or a given strain. By default the stages of the model.
    method : {"events", "steps"}
        Exact, or in load steps (:attr:`Stage.steps` of them).
    solver : str
        Of the load steps, also where the events were more than ``max_events``.
    max_events : int
        Corners of a stage after which it goes on in steps.
    progress : callable, optional

    Returns
    -------
    CellPath

    Raises
    ------
    InputError
        The model is not a cell, a stage names what is not a component, or a strain is imposed on rigid blocks with hard
        joints, whose forces it does not determine.

    Examples
    --------
    Running bond is pressed with 100 kN/m2 and sheared until it slides. :func:`concio.strength` gives the same shear
    stress:

    >>> import concio
    >>> law = concio.JointLaw(0.6, normal_stiffness=10e6, tangential_stiffness=4e6)
    >>> cell = concio.cell(bond="running", block_size=(0.25, 0.125), friction=law)
    >>> path = concio.strain_path(cell, [{"stress yy": -100.0}, {"strain xy": 1e-3}])
    >>> round(float(path.stress[-1, 2]), 6)
    37.5
    """
    own = PeriodicCell.of(cell)
    listed = (stages,) if isinstance(stages, Mapping | Stage) else stages or own.model.stages
    asked = [_stage(s, k) for k, s in enumerate(listed, 1)]
    if not asked:
        msg = "a path needs at least one stage"
        raise InputError(msg, hint="for example strain_path(cell, [{'strain xx': 1e-4}])")
    if method not in ("events", "steps"):
        msg = f"method = {method!r} is not one of events, steps"
        raise InputError(msg)
    drive = Drive(np.zeros(3, dtype=bool), np.zeros(3))
    strain, lent, laws = np.zeros(3), 0.0, own.assembly.laws
    state: PathState | None = None
    steps: list[CellStep] = []
    given: list[Array] = []
    events: list[NamedEvent] = []
    outcomes: list[Outcome] = []
    notes: list[str] = []
    for number, stage in enumerate(asked):
        stress = _given(drive, steps[-1].stress) if steps else np.zeros(3)
        drive = _driven(drive, stage)
        path, compliance = _linear(own, drive, strain, stress, laws if lent else None)
        compliance = compliance or lent
        if compliance and not lent:
            notes.append(
                f"hard joints between rigid blocks were given a compliance of {compliance:.3g} m/kN, "
                f"{SHEAR_TO_NORMAL:g} times as much along the joint: without it their forces are not determined"
            )
        lent, laws = compliance, path.problem.laws
        loose = ~drive.strain
        state = at_rest(path.problem) if state is None else _with_strains(state, strain[loose] * own.size)
        found = _walk(path, state, stage, method, solver, max_events, progress, notes)
        first = len(steps) - 1 if steps else 0
        for after in found.states:
            if after is found.states[0] and steps:
                continue
            here = strain.copy()
            moved = after.parameter * (drive.values - strain)
            here[drive.strain] += moved[drive.strain]
            here[loose] = after.displacement[path.problem.unknowns - int(loose.sum()) :] / own.size
            forces = own.stress(after.normal_force, after.friction_force[:, 0])
            base = _with_strains(after, np.zeros(0), int(loose.sum()))
            stored = elastic_energy(path.problem, after)
            steps.append(CellStep(number, after.parameter, here, forces, base, UNKNOWN, stored))
            asked_for = stress + after.parameter * (drive.values - stress)
            given.append(np.where(loose, asked_for, forces))
        events.extend(named_event(own.assembly, number, first, event) for event in found.events)
        outcomes.append(found.outcome)
        strain, state = steps[-1].strain, steps[-1].state
        if found.outcome is not Outcome.REACHED:
            at = found.states[-1].parameter
            notes.append(f"stage '{stage.name}' ended at {at:.6g} of its stage. {found.outcome.value}")
            break
    certified = _certified(own, laws, steps, given)
    return CellPath(own, tuple(asked), certified, tuple(events), tuple(outcomes), tuple(notes))


def _certified(
    cell: PeriodicCell, laws: Laws, steps: Sequence[CellStep], given: Sequence[Array]
) -> tuple[CellStep, ...]:
    """Return the steps with their certificates.

    Each state is put into the cell's own problem with all strains imposed as they came out, slip measured from the
    state before; stresses that were given, ``given`` (3,) of each step, have to come out of its contact forces, by the
    same force as the balance of bodies. Displacements are measured by the largest of the bodies or of the cell's edges.
    Where joints have opened and hardly any force is left, or the cell has come back to rest, the path is the measure
    (:data:`LEAST`).
    """
    held = replace(cell.problem(free=(False, False, False)), laws=laws)
    sizes = [_force(step) for step in steps]
    lengths = [
        max(float(np.abs(step.state.displacement).max(initial=0.0)), float(np.abs(step.strain).max()) * cell.size)
        for step in steps
    ]
    force, length = (max(values, default=0.0) or 1.0 for values in (sizes, lengths))
    done, before = [], steps[0]
    for step, wanted, size, moved in zip(steps, given, sizes, lengths, strict=True):
        then, now = (_held(cell, held, one.strain) for one in (before, step))
        load = max(size, LEAST * force)
        found = certify_between(
            then, now, before.state, step.state, total_load=load, moved=max(moved, LEAST * length)
        )  # fmt: skip
        off = float(np.abs(step.stress - wanted).max()) * cell.volume / cell.size / load
        done.append(replace(step, certificate=replace(found, equilibrium=max(found.equilibrium, off))))
        before = step
    return tuple(done)


def _force(step: CellStep) -> float:
    """Return the largest contact force of a step [kN]."""
    state = step.state
    return float(max(np.abs(state.normal_force).max(initial=0.0), np.abs(state.friction_force).max(initial=0.0)))


def _held(cell: PeriodicCell, held: ContactProblem, strain: Array) -> ContactProblem:
    """Return the problem of the cell with all strains (3,) imposed; ``held`` is that without any."""
    normal, tangential = cell.columns
    return replace(held, gap=held.gap + normal @ strain, slip_origin=held.slip_origin - (tangential @ strain)[:, None])


def _stage(given: object, number: int) -> Stage:
    """Return a stage whose factors are numbers for strains and stresses."""
    if not isinstance(given, Stage):
        if not isinstance(given, Mapping):
            msg = f"stage {number} is {given!r}, no table of strains and stresses"
            raise InputError(msg, hint="for example {'stress yy': -100.0}")
        words = ", ".join(f"{name} = {value:g}" for name, value in given.items())
        given = Stage(f"{number}: {words}", dict(given))
    where = f"stage '{given.name}'"
    if given.control is not None:
        msg = "a cell has no control point"
        raise InputError(msg, where=where, hint="drive a strain instead")
    known = [f"{kind} {c}" for kind in ("strain", "stress") for c in COMPONENTS]
    for name, value in given.factors.items():
        if name not in known:
            msg = f"'{name}' is neither a strain nor a stress"
            raise InputError(msg, where=where, hint="one of " + ", ".join(known))
        if not np.isfinite(value):
            msg = f"{name} = {value} is not finite"
            raise InputError(msg, where=where)
    for c in COMPONENTS:
        if f"strain {c}" in given.factors and f"stress {c}" in given.factors:
            msg = f"both strain {c} and stress {c} are given"
            raise InputError(msg, where=where, hint="one follows from the other: leave one out")
    if not given.factors:
        msg = "nothing is asked for"
        raise InputError(msg, where=where, hint="for example {'strain xx': 1e-4}")
    return given


def _driven(before: Drive, stage: Stage) -> Drive:
    """Return what acts at the end of a stage."""
    strain, values = before.strain.copy(), before.values.copy()
    for name, value in stage.factors.items():
        kind, _, c = name.partition(" ")
        k = COMPONENTS.index(c)
        strain[k], values[k] = kind == "strain", float(value)
    return Drive(strain, values)


def _given(drive: Drive, stress: Array) -> Array:
    """Return the present stress (3,) without rounding: as given where it is given, else as it came out."""
    dust = 1e-12 * float(np.abs(stress).max())
    found: Array = np.where(drive.strain, np.where(np.abs(stress) > dust, stress, 0.0), drive.values)
    return found


def _linear(
    cell: PeriodicCell, drive: Drive, strain: Array, stress: Array, laws: Laws | None
) -> tuple[LinearPath, float]:
    """Return the path from the present strain and stress to what acts at the end of a stage, and the compliance added.

    ``laws`` are those to which compliance was given before, the same in all stages; then none is given again.

    Raises
    ------
    InputError
        A strain is driven, and rigid blocks on hard joints leave open which forces answer.
    """
    loose = ~drive.strain
    problem = cell.problem(stress=stress, strain=strain, free=loose.tolist())
    end = cell.problem(stress=drive.values, strain=drive.values, free=loose.tolist())
    live = end.f - problem.f
    if laws is None:
        path_problem, compliance = with_compliance(problem, live if live.any() else np.ones_like(live))
    else:
        path_problem, compliance = replace(problem, laws=laws), 0.0
    if (compliance or laws is not None) and drive.strain.any():
        msg = "the blocks are rigid and joints hard: a strain does not determine the forces"
        raise InputError(msg, hint="give the joints stiffness, make the blocks elastic, or give stresses alone")
    return (
        LinearPath(path_problem, live, end.gap - problem.gap, problem.slip_origin - end.slip_origin),
        compliance,
    )


def _with_strains(state: PathState, strains: Sequence[float] | Array, drop: int = 0) -> PathState:
    """Return a state with strains as further unknowns, after ``drop`` of them were taken away."""
    u = state.displacement[: state.displacement.size - drop]
    return replace(state, displacement=np.concatenate([u, strains]), parameter=state.parameter if drop else 0.0)


def _walk(
    path: LinearPath,
    state: PathState,
    stage: Stage,
    method: str,
    solver: str,
    max_events: int,
    progress: ProgressCallback | None,
    notes: list[str],
) -> StepPath:
    """Follow one stage, by events and where there are too many on in steps."""
    if method == "steps":
        return follow_in_steps(path, state, until=1.0, steps=stage.steps, solver=find(solver), progress=progress)
    exact = follow(path, state, until=1.0, max_events=max_events, progress=progress)
    jumps = [e.parameter for e in exact.jumps]
    restarts = [e.parameter for e in exact.events if e.kind == "restarts"]
    for word, where in (("jump", jumps), ("finite step", restarts)):
        if where:
            notes.append(f"stage '{stage.name}': {counted(len(where), word)}, the first at {where[0]:.6g} of its stage")
    if exact.outcome is not Outcome.TOO_MANY:
        return StepPath(exact.states, exact.events, exact.outcome, exact.direction)
    notes.append(f"stage '{stage.name}': after {len(exact.events)} events continued in {stage.steps} steps")
    rest = follow_in_steps(path, exact.end, until=1.0, steps=stage.steps, solver=find(solver), progress=progress)
    later = tuple(replace(e, step=e.step + len(exact.states) - 1) for e in rest.events)
    return StepPath(exact.states + rest.states[1:], exact.events + later, rest.outcome, rest.direction)
