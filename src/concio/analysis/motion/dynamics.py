"""Dynamics of bodies that move far: rocking, sliding, impacts, earthquakes."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from concio.analysis.entry_point import entry_point
from concio.analysis.motion.dynamics_result import DynamicsResult, Ending
from concio.analysis.motion.fate import Watch
from concio.analysis.motion.ground import Ground, Motion
from concio.analysis.motion.history import Recorder
from concio.analysis.motion.interruption import Interruption
from concio.analysis.motion.joints import SAG
from concio.analysis.motion.located import ties_give_way
from concio.analysis.motion.meetings import Meetings
from concio.analysis.motion.moved_supports import begun
from concio.analysis.motion.observer import Observer
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Statics
from concio.analysis.motion.stepper import Stepper, StepReport, at_rest
from concio.analysis.motion.tie_cuts import where_ties_give_way
from concio.arguments import strict
from concio.contact.moving.reference import Reference
from concio.errors import InputError
from concio.kinematics.rigid import swept
from concio.model.model import Model
from concio.model.stages import ControlPoint
from concio.problem.contact_problem import Engine
from concio.problem.solution import Progress, ProgressCallback
from concio.problem.tolerances import CERTIFIED
from concio.units import GRAVITY
from concio.verdict.dynamics_verdict import supports_short

Array = np.ndarray

STEP = 2e-3
"""Step where none is given and no record is finer [s]."""

SHOTS = 1000
"""Placements kept where nothing else is asked for."""

HALVINGS = 6
"""Times a step may be halved."""

SUNK = 1e-3
"""Penetration at an impact over the width of a body from which on the step is halved."""

LEAST_CUT = 1e-6
"""Step over that asked for below which it is not cut where a tie gives way."""

AFTER = 20.0
"""How long after the ground a motion is followed where no duration is given and it neither rests nor falls [s]."""


@strict
@entry_point
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
    stop_at_rest: bool | None = None,
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
        Time to compute [s]; by default until everything rests after the ground motion, or a block has fallen, at most
        20 s after it.
    step : float, optional
        Largest time step [s]; default 2 ms, or that of a finer record.
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
        Time between the placements that are kept [s]; default a thousandth of the duration, or of the time of the
        ground motion.
    points : sequence of ControlPoint
        Points whose positions are kept at every step.
    stop_overturned, stop_at_rest : bool
        Whether to stop when a block has turned by 60 degrees from where it was described or lost the support on which
        it stood, or when nothing moves any more after the ground motion: by default where no duration is given.
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

    Examples
    --------
    A block that slides at v = 1 m/s on a friction of mu = 0.5 stops after v^2 / (2 mu g) = 0.102 m:

    >>> import concio
    >>> block = concio.column(width=2.0, height=0.5, blocks=1, block="rigid", friction=0.5)
    >>> middle = concio.ControlPoint("b01", at=(0.0, 0.25))
    >>> motion = concio.dynamics(block, velocities={"b01": (1.0, 0.0, 0.0)}, points=(middle,), duration=0.25)
    >>> round(float(motion.point()[-1]), 3)
    0.102
    """
    reference = Reference.of(model, gravity)
    _check_masses(reference)
    ground = Ground.of(motion, scale)
    stated = None if duration is None else _positive(duration, "duration")
    shown = stated or _positive(ground.duration, "duration")
    step = _step(step, ground, shown)
    stop_at_rest = stated is None if stop_at_rest is None else stop_at_rest
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
    state, notes, stands = _begin(reference, scheme, chosen, start, velocities, engine)
    begun_at = state.time
    run = _Run(
        reference, stepper, ground, base, chosen, scheme, tuple(points), shown + (0.0 if stated else AFTER), step,
        adaptive, progress, stated, stands, engine,
    )  # fmt: skip
    run.notes += [*ground.attention, *notes]
    run.origin = reference.disc.centroids if isinstance(start, MotionState) else state.centre.copy()
    run.falls = start != "as described"
    every = _positive(every or shown / SHOTS, "every")
    ending = run.follow(state, every, stop_overturned, stop_at_rest)
    return run.result(ending, begun_at)


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
) -> tuple[MotionState, list[str], bool | None]:
    """Return the state at the beginning, what there is to say about it, and whether it is in equilibrium if asked."""
    notes: list[str] = []
    stands: bool | None = None
    if isinstance(start, MotionState):
        if start.centre.shape != reference.disc.centroids.shape or len(start.strain) != len(reference.body_of_node):
            msg = "the state to start from belongs to another model"
            raise InputError(msg, hint="take the state of a motion of the same model")
        state = start
    elif start in ("equilibrium", "as described"):
        state = at_rest(reference)
        if start == "equilibrium":
            balanced, share, last = begun(Statics(reference, scheme, factors, engine=engine, sag=SAG), state)
            stands, state = balanced.found, balanced.state if balanced.found else last
            if not stands and 0.0 < share < 1.0:
                notes.append(supports_short(share))
            elif not stands:
                notes.append("no equilibrium under the loads was found to begin with: the motion begins as described")
        elif any(s.moves for s in reference.model.supports):
            notes.append("fixed bodies stand as described: supports move them where a motion begins in equilibrium")
    else:
        msg = f"start = '{start}' is not 'equilibrium', 'as described' or a state"
        raise InputError(msg)
    if velocities:
        state = _thrown(reference, state, velocities)
    return state, notes, stands


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
    stated: float | None
    stands: bool | None
    engine: Engine | None
    falls: bool = True
    origin: Array = field(default_factory=lambda: np.zeros((0, 2)))
    fallen: list[str] = field(default_factory=list)
    rests: bool = False
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        maker = self.stepper.maker
        self.observer = Observer(self.reference, maker, self.stepper.frames, self.factors, self.points)
        self.recorder = Recorder()
        self.meetings = Meetings.of(len(self.reference.model.bodies), self.step / 2**HALVINGS)
        self.sums = dict.fromkeys(("friction", "impact", "damping", "crushing", "input", "overlap", "drift"), 0.0)
        self.seconds = 0.0
        self.begun = clock.perf_counter()
        self.state: MotionState | None = None

    def drive(self, time: float, h: float) -> Drive:
        """Return what is imposed in a step."""
        if self.base == "moving":
            moved = np.asarray(self.ground.displacement(np.array(time)), dtype=float).reshape(-1)
            return Drive(np.zeros(2), self.ground.mean_velocity(time, time + h), self.factors, moved)
        return Drive(self.ground.mean_acceleration(time, time + h), np.zeros(2), self.factors)

    def follow(self, state: MotionState, every: float, stop_overturned: bool, stop_at_rest: bool) -> Ending:
        """Compute the motion and record it; return how it ended."""
        self.state = state = self.stepper.located(state)
        start = state.time
        end, shot = start + self.duration, start
        h, calm = self.step, 0
        self.watch = Watch(self.observer, self.factors, self.scheme, self.origin, self.engine)
        self._shoot(state)
        with Interruption() as interruption:
            while state.time < end - 1e-6 * self.step:
                h = min(h, end - state.time)
                made = self._attempt(state, h)
                if made is None:
                    return Ending.UNSOLVED
                state, report, used = made
                if used:
                    calm = calm + 1 if used >= h else 0
                    h = min(self.step, 2 * used if calm >= 2 else used)
                self._keep(state, report)
                if state.time >= shot + every - 1e-9 * self.step:
                    shot = state.time
                    self._shoot(state)
                fell = self._fell(state)
                if stop_overturned and fell is not None:
                    return fell
                over = state.time - start > self.ground.duration
                if self.watch.calm(state) and over and stop_at_rest and self.watch.rests(state):
                    self.rests = True
                    return Ending.AT_REST
                told = self.progress is not None and self.progress(self._told(state, start))
                if told or interruption.wanted:
                    return Ending.STOPPED
        self.rests = self.watch.calm(state) and self.watch.rests(state)
        if not self.rests and not self.fallen and state.time - start >= self.ground.duration:
            self.fallen = self.watch.passed(state)
        return Ending.COMPLETE

    def _fell(self, state: MotionState) -> Ending | None:
        """Return how a motion ends in which a block has fallen, None where none has; note the first ones."""
        turned = self.watch.overturned(state)
        sunk = self.watch.sunk(state) if self.falls else []
        self.fallen = self.fallen or turned or sunk
        if turned:
            return Ending.OVERTURNED
        return Ending.FALLEN if sunk and (self.stands is not False or self.stated is None) else None

    def _attempt(self, state: MotionState, h: float) -> tuple[MotionState, StepReport, float] | None:
        """Make a step that ends where a tie gives way, if one does; see :meth:`_made`."""
        made = self._made(state, h)
        if made is None or not self.adaptive or not ties_give_way(state, made[0]):
            return made
        whole, ties = made[0].time - state.time, self.stepper.maker.ties

        def at(length: float) -> tuple[MotionState, StepReport]:
            return self.stepper.step(state, length, self.drive(state.time, length))

        cut = where_ties_give_way(ties, state, made[0], at, whole, LEAST_CUT * self.step)
        if cut is None or cut[1].solution.residual > CERTIFIED:
            return made
        self.meetings.until = max(self.meetings.until, state.time + whole)
        return *cut, 0.0

    def _made(self, state: MotionState, h: float) -> tuple[MotionState, StepReport, float] | None:
        """Make a step, smaller where that is needed; None where none can be solved.

        The third is its length, none where it ended or began with an impact that was located.
        """
        least = self.step / 2**HALVINGS
        meetings = self.meetings
        asked, h = h, meetings.length(state.time, h)
        planned = h != asked
        while True:
            new, report = self.stepper.step(state, h, self.drive(state.time, h))
            solved = report.solution.residual <= CERTIFIED
            late = self.adaptive and report.struck > SUNK * self.stepper.maker.width
            if solved and self.adaptive:
                cut = meetings.located(report.meets, report.part, h)
                if cut is not None:
                    to_it = self.stepper.step(state, cut, self.drive(state.time, cut))
                    if to_it[1].solution.residual <= CERTIFIED:
                        meetings.after(state.time, True, to_it[1].left, h)
                        return *to_it, 0.0
            if (solved and not late) or (solved and h <= least * 1.01):
                meetings.after(state.time, False, np.inf, h)
                return new, report, 0.0 if planned else h
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

    def _told(self, state: MotionState, start: float) -> Progress:
        done = (state.time - start) / self.duration
        left = (clock.perf_counter() - self.begun) * (1 - done) / max(done, 1e-9)
        return Progress("dynamics", len(self.recorder.rows), 1.0 - done, f"{state.time:.3f} s, {_time_left(left)} left")

    def result(self, ending: Ending, begun_at: float) -> DynamicsResult:
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
            asked=self.ground.words, begun=begun_at, stated=self.stated, stands=self.stands,
            fallen=tuple(self.fallen), rests=self.rests, ground_ends=begun_at + self.ground.duration,
        )  # fmt: skip


def _time_left(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"
