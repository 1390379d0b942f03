"""Dynamics of bodies that move far: rocking, sliding, impacts, earthquakes."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from concio.analysis.engine import by_its_engine
from concio.analysis.motion.dynamics_result import DynamicsResult, Ending
from concio.analysis.motion.ground import Ground, Motion
from concio.analysis.motion.history import Recorder
from concio.analysis.motion.interruption import Interruption
from concio.analysis.motion.joints import SAG
from concio.analysis.motion.observer import Observer
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Statics
from concio.analysis.motion.stepper import Stepper, StepReport, at_rest
from concio.arguments import strict
from concio.contact.moving.reference import Reference
from concio.errors import InputError
from concio.kinematics.rigid import swept
from concio.model.model import Model
from concio.model.stages import ControlPoint
from concio.problem.solution import Progress, ProgressCallback
from concio.problem.tolerances import CERTIFIED
from concio.solvers.algebra.sparse_factor import Engine
from concio.units import GRAVITY

Array = np.ndarray

STEP = 2e-3
"""Step where none is given and no record is finer [s]."""

SHOTS = 1000
"""Placements kept where nothing else is asked for."""

HALVINGS = 6
"""Times a step may be halved."""

SUNK = 1e-3
"""Penetration at an impact over the width of a body from which on the step is halved."""

OVERTURNED = np.deg2rad(60.0)
"""Rotation at which a block has overturned [rad]."""

AT_REST = 1e-12
"""Kinetic energy over the weight times the width of the bodies below which everything is at rest."""


@strict
@by_its_engine
def dynamics(
    model: Model,
    motion: Motion = None,
    duration: float | None = None,
    step: float | None = None,
    *,
    scale: float = 1.0,
    factors: Mapping[str, float] | None = None,
    gravity: float = GRAVITY,
    base: Literal["inertia", "moving"] = "inertia",
    start: Literal["equilibrium", "as described"] | MotionState = "equilibrium",
    velocities: Mapping[str, Sequence[float]] | None = None,
    restitution: float = 0.0,
    theta: float = 0.5,
    mass_damping: float = 0.0,
    stiffness_damping: float = 0.0,
    brittle: bool = True,
    adaptive: bool = True,
    every: float | None = None,
    points: Sequence[ControlPoint] = (),
    stop_overturned: bool = True,
    stop_at_rest: bool = False,
    engine: Engine | None = None,
    progress: ProgressCallback | None = None,
) -> DynamicsResult:
    """Compute the motion of a structure of blocks.

    Parameters
    ----------
    model : Model
        Plane; elastic, rigid and fixed bodies.
    motion : Signal, path, mapping, optional
        Motion of the ground along x (a record, a pulse, the name of a file), or by component: ``{"x": ..., "y": ...}``.
    duration : float, optional
        Time to compute [s]; default that of the ground motion.
    step : float, optional
        Largest step of time [s]; default 2 ms, or what a finer record wants.
    scale : float
        Factor of the ground motion.
    factors : mapping of str to float, optional
        Factors of load groups, constant in time; groups not named have 1.
    gravity : float
        Turns weights into masses [m/s2].
    base : {"inertia", "moving"}
        Whether the ground's acceleration acts on the bodies, which are seen from the ground, or the fixed bodies are
        moved.
    start : {"equilibrium", "as described"} or MotionState
        Equilibrium under the loads if there is one, the bodies as described, or a state of an earlier motion.
    velocities : mapping of body to (v_x, v_y, spin), optional
        Initial velocities [m/s, m/s, rad/s].
    restitution : float
        Share of the normal velocity that comes back from an impact of hard joints, 0 to 1.
    theta : float
        1/2 conserves energy; up to 1 damps high frequencies.
    mass_damping, stiffness_damping : float
        Rayleigh's alpha [1/s] and beta [s] of elastic bodies; beta also of joints of finite stiffness and of ties.
    brittle : bool
        Whether joints lose cohesion and tensile strength for good once either was used up.
    adaptive : bool
        Whether steps are halved where an impact would be felt late or an answer fails its check.
    every : float, optional
        Time between the placements that are kept [s]; default a thousandth of the duration.
    points : sequence of ControlPoint
        Points whose positions are kept at every step.
    stop_overturned, stop_at_rest : bool
        Whether to stop when a block has turned by 60 degrees, or when nothing moves any more after the ground motion.
    engine : {"superlu", "pardiso"}, optional
        What factorises linear systems; by default that of the model.
    progress : callable, optional
        Called after every step; true stops the motion, and what was computed is kept. So does Ctrl-C.

    Returns
    -------
    DynamicsResult

    Raises
    ------
    InputError
        The model or an argument cannot be used: a body without mass, a step larger than that of the record...
    """
    reference = Reference.of(model, gravity)
    _check_masses(reference)
    ground = Ground.of(motion, scale)
    duration = _positive(ground.duration if duration is None else duration, "duration")
    step = _step(step, ground, duration)
    if base not in ("inertia", "moving"):
        msg = f"base = '{base}' is not 'inertia' or 'moving'"
        raise InputError(msg)
    scheme = Scheme(theta, restitution, mass_damping, stiffness_damping, brittle)
    chosen = dict(factors or {})
    for group in chosen:
        if group not in reference.model.load_groups:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, hint="groups: " + ", ".join(reference.model.load_groups))
    stepper = Stepper(reference, scheme, engine)
    state, notes = _begin(reference, scheme, chosen, start, velocities, engine)
    run = _Run(reference, stepper, ground, base, chosen, scheme, tuple(points), duration, step, adaptive, progress)
    run.notes += [*ground.attention, *notes]
    ending = run.follow(state, _positive(every or duration / SHOTS, "every"), stop_overturned, stop_at_rest)
    return run.result(ending)


def _positive(value: float, name: str) -> float:
    if not 0 < value < np.inf:
        msg = f"{name} = {value:g} must be positive and finite"
        hint = "give the time to compute, or a ground motion" if name == "duration" else None
        raise InputError(msg, hint=hint)
    return float(value)


def _step(step: float | None, ground: Ground, duration: float) -> float:
    if step is None:
        return min(STEP, ground.sample, duration)
    step = _positive(step, "step")
    if step > ground.sample * (1 + 1e-9):
        msg = f"the step of {step:g} s is larger than that of the record, {ground.sample:g} s"
        raise InputError(msg, hint=f"take at most {ground.sample:g} s: what happens between samples would be lost")
    return min(step, duration)


def _check_masses(reference: Reference) -> None:
    without = [reference.model.bodies[b].name for b in reference.free.tolist() if not reference.body_mass[b] > 0]
    if without:
        msg = f"block '{without[0]}' has no mass" + (f", and {len(without) - 1} others" if without[1:] else "")
        raise InputError(msg, hint="give its material a unit_weight: mass is weight over gravity")


def _begin(
    reference: Reference,
    scheme: Scheme,
    factors: Mapping[str, float],
    start: str | MotionState,
    velocities: Mapping[str, Sequence[float]] | None,
    engine: Engine | None,
) -> tuple[MotionState, list[str]]:
    """Return the state at the beginning, and what there is to say about it."""
    notes: list[str] = []
    if isinstance(start, MotionState):
        if start.centre.shape != reference.disc.centroids.shape or len(start.strain) != len(reference.body_of_node):
            msg = "the state to start from belongs to another model"
            raise InputError(msg, hint="take the state of a motion of the same model")
        state = start
    elif start in ("equilibrium", "as described"):
        state = at_rest(reference)
        if start == "equilibrium":
            balanced = Statics(reference, scheme, factors, engine=engine, sag=SAG).balance(state, 0.0)
            if balanced.found:
                state = balanced.state
            else:
                notes.append("no equilibrium under the loads was found to begin with: the motion begins as described")
    else:
        msg = f"start = '{start}' is not 'equilibrium', 'as described' or a state"
        raise InputError(msg)
    if velocities:
        state = _thrown(reference, state, velocities)
    return state, notes


def _thrown(reference: Reference, state: MotionState, velocities: Mapping[str, Sequence[float]]) -> MotionState:
    """Return a state with other velocities of some bodies."""
    number = {b.name: i for i, b in enumerate(reference.model.bodies)}
    velocity, spin, nodal = state.velocity.copy(), state.spin.copy(), state.nodal.copy()
    for name, given in velocities.items():
        if name not in number or reference.model.bodies[number[name]].kind == "fixed":
            msg = f"there is no body called '{name}' that can move"
            raise InputError(msg, where="velocities", hint="see the names with 'concio check'")
        values = [float(v) for v in given]
        if len(values) not in (2, 3) or not np.isfinite(values).all():
            msg = f"the velocity of '{name}' is (v_x, v_y) or (v_x, v_y, spin), all finite"
            raise InputError(msg, where="velocities")
        b = number[name]
        velocity[b], spin[b] = values[:2], values[2] if len(values) == 3 else 0.0
        if reference.disc.shape_of[b] >= 0:
            own = np.flatnonzero(reference.body_of_node == b)
            placed = state.configuration(reference).nodes(b) - state.centre[b]
            nodal[own] = velocity[b] + swept(spin[b], placed)
    return replace(state, velocity=velocity, spin=spin, nodal=nodal)


@dataclass
class _Run:
    """A motion as it is computed."""

    reference: Reference
    stepper: Stepper
    ground: Ground
    base: str
    factors: dict[str, float]
    scheme: Scheme
    points: tuple[ControlPoint, ...]
    duration: float
    step: float
    adaptive: bool
    progress: ProgressCallback | None
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        maker = self.stepper.maker
        self.observer = Observer(self.reference, maker, self.stepper.frames, self.factors, self.points)
        self.recorder = Recorder()
        self.sums = dict.fromkeys(("friction", "impact", "damping", "crushing", "input", "overlap", "drift"), 0.0)
        self.seconds = 0.0
        self.begun = clock.perf_counter()
        self.state: MotionState | None = None

    def drive(self, time: float, h: float) -> Drive:
        """Return what is imposed in a step."""
        if self.base == "moving":
            moved = complex(*self.ground.displacement(np.array(time)))
            return Drive(np.zeros(2), self.ground.mean_velocity(time, time + h), self.factors, moved)
        return Drive(self.ground.mean_acceleration(time, time + h), np.zeros(2), self.factors)

    def follow(self, state: MotionState, every: float, stop_overturned: bool, stop_at_rest: bool) -> Ending:
        """Compute the motion and record it; return how it ended."""
        self.state = state = self.stepper.located(state)
        start, rotation0 = state.time, state.rotation.copy()
        end, shot = start + self.duration, start
        h, calm = self.step, 0
        weight = float(self.reference.body_mass.sum()) * self.reference.gravity * self.stepper.maker.width
        self._shoot(state)
        with Interruption() as interruption:
            while state.time < end - 1e-6 * self.step:
                h = min(h, end - state.time)
                made = self._attempt(state, h)
                if made is None:
                    return Ending.UNSOLVED
                state, report, used = made
                calm = calm + 1 if used >= h else 0
                h = min(self.step, 2 * used if calm >= 2 else used)
                self._keep(state, report)
                if state.time >= shot + every - 1e-9 * self.step:
                    shot = state.time
                    self._shoot(state)
                if stop_overturned and np.abs(state.rotation - rotation0).max() > OVERTURNED:
                    return Ending.OVERTURNED
                if stop_at_rest and state.time - start > self.ground.duration and self._rests(state, weight):
                    return Ending.AT_REST
                told = self.progress is not None and self.progress(self._told(state, start))
                if told or interruption.wanted:
                    return Ending.STOPPED
        return Ending.COMPLETE

    def _attempt(self, state: MotionState, h: float) -> tuple[MotionState, StepReport, float] | None:
        """Make a step, smaller where that is needed; None where none can be solved."""
        least = self.step / 2**HALVINGS
        while True:
            new, report = self.stepper.step(state, h, self.drive(state.time, h))
            solved = report.solution.residual <= CERTIFIED
            late = self.adaptive and report.struck > SUNK * self.stepper.maker.width
            if (solved and not late) or (solved and h <= least * 1.01):
                return new, report, h
            if not solved and (h <= least * 1.01 or not self.adaptive):
                return None
            h *= 0.5

    def _keep(self, state: MotionState, report: StepReport) -> None:
        self.state = state
        for name in self.sums:
            self.sums[name] += report.works[name]
        found = report.solution
        self.recorder.step(
            state.time, found.residual, found.how, found.factorisations, report.depth, self.observer.positions(state),
            self.observer.reactions(found.t, report.pairs, report.normal),
        )  # fmt: skip

    def _shoot(self, state: MotionState) -> None:
        opening, slip = self.observer.joint_motion(state)
        self.recorder.shot(state, opening, slip, self.observer.energies(state, self.sums))

    def _rests(self, state: MotionState, weight: float) -> bool:
        f = self.stepper.frames
        x = f.unknowns(state.velocity[:, 0] + 1j * state.velocity[:, 1], state.spin, state.nodal @ [1, 1j],
                       np.exp(1j * state.rotation))  # fmt: skip
        return f.kinetic_energy(x) <= AT_REST * weight

    def _told(self, state: MotionState, start: float) -> Progress:
        done = (state.time - start) / self.duration
        left = (clock.perf_counter() - self.begun) * (1 - done) / max(done, 1e-9)
        return Progress("dynamics", len(self.recorder.rows), 1.0 - done, f"{state.time:.3f} s, {_time_left(left)} left")

    def result(self, ending: Ending) -> DynamicsResult:
        """Return what was computed."""
        assert self.state is not None
        if self.recorder.shots[-1][0] is not self.state:
            self._shoot(self.state)
        self.seconds = clock.perf_counter() - self.begun
        shots, steps, energy = self.recorder.done(len(self.points), len(self.observer.names))
        return DynamicsResult(
            model=self.reference.model, gravity=self.reference.gravity, scheme=self.scheme, factors=self.factors,
            ending=ending, shots=shots, steps=steps, energy=energy, points=self.points,
            reactions_of=self.observer.names,
            joints=self.observer.joints, end=self.state, ground_time=steps.time,
            ground=self.ground.acceleration(steps.time), notes=tuple(self.notes), seconds=self.seconds,
            lent_compliance=self.stepper.maker.joints.lent if len(self.reference.rigid) else 0.0,
        )  # fmt: skip


def _time_left(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"
