"""Dynamics of bodies that move far: rocking, sliding, impacts, earthquakes."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from concio.analysis.entry_point import entry_point
from concio.analysis.motion.continued import check_ground
from concio.analysis.motion.dynamics_asked import check_base, check_length, check_masses, positive, step_asked, thrown
from concio.analysis.motion.dynamics_result import DynamicsResult, Ending
from concio.analysis.motion.ground_motion import Ground, Motion
from concio.analysis.motion.history import Recorder
from concio.analysis.motion.interruption import Interruption
from concio.analysis.motion.mover import Mover, Row, shifted
from concio.analysis.motion.near_origin import Near
from concio.analysis.motion.not_begun import proof_at_rest
from concio.analysis.motion.observer import Observer
from concio.analysis.motion.pace import Pace
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.start_on_moved_supports import first_state
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.step_pairs import PairMaker
from concio.analysis.motion.structures import Structure, near_now, structures_of, together
from concio.analysis.motion.velocities import Frames
from concio.arguments import strict
from concio.contact.reference import Reference
from concio.errors import InputError
from concio.fem.discretisation import FIXED
from concio.model.model import Model
from concio.model.stages import ControlPoint
from concio.problem.contact_problem import Engine
from concio.problem.solution import Progress, ProgressCallback
from concio.units import GRAVITY

Array = np.ndarray

SHOTS = 1000
"""Placements kept where nothing else is asked for."""

STAY = "fixed bodies stand as described: supports move them where a motion begins in equilibrium"
"""What is said of supports that move where a motion begins as described."""

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
        Elastic, rigid and fixed bodies; in space on joints that do not dilate, those of elastic bodies with friction
        alone.
    motion : Signal, path, mapping, optional
        Motion of the ground along x (a record, a pulse, the name of a file), or by component: ``{"x": ..., "y": ...}``,
        in space also "z", which is vertical there. "rz", in space also "rx" and "ry", turn a base that moves about the
        origin of coordinates, by the displacement of their signals in rad.
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
        Equilibrium under the loads if there is one, the bodies as described, or a state of an earlier motion: its
        time goes on, and that of the motion of the ground with it.
    velocities : mapping of body to (v_x, v_y, spin), optional
        Initial velocities [m/s, m/s, rad/s]; in space (v_x, v_y, v_z) or with (w_x, w_y, w_z) behind.
    restitution : float
        Coefficient of restitution of impacts of hard joints, 0 to 1.
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
        Whether to stop when a block has turned by 60 degrees from where it was described, lost the support on which
        it stood, or fallen below everything there is, or when nothing moves any more after the ground motion: by
        default where no duration is given.
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
    near = Near.of(model)
    reference = Reference.of(near.model, gravity)
    check_masses(reference)
    ground = Ground.of(motion, scale, model.dim, -near.origin)
    stated = None if duration is None else positive(duration, "duration")
    if stated is None and not ground.duration > 0:
        msg = "the ground does not move, and no duration is given"
        hint = "give a record or a pulse ([motion] in a model file, --pulse), or a duration to follow the bodies for"
        raise InputError(msg, hint=hint)
    left = max(ground.duration - (start.time if isinstance(start, MotionState) else 0.0), 0.0)
    shown = stated or left or AFTER
    step = step_asked(step, ground, shown)
    check_length(shown, step)
    stop_at_rest = stated is None if stop_at_rest is None else stop_at_rest
    check_base(reference, base, turning=ground.turning)
    scheme = Scheme(theta, restitution, mass_damping, stiffness_damping, brittle)
    chosen = dict(factors or {})
    for group in chosen:
        if group not in reference.model.load_groups:
            msg = f"there is no load group '{group}'"
            raise InputError(msg, hint="groups: " + ", ".join(reference.model.load_groups))
    run = _Run(
        reference, ground, base, chosen, scheme, near.points(points), stated or left + AFTER, step,
        adaptive, progress, stated, engine,
    )  # fmt: skip
    run.notes += ground.attention
    run.begin(near.state(start) if isinstance(start, MotionState) else start, velocities)
    every = positive(every or shown / SHOTS, "every")
    return near.told(run.result(run.follow(every, stop_overturned, stop_at_rest)), points)


@dataclass
class _Run:
    """A motion as it is computed."""

    reference: Reference
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
    engine: Engine | None
    stands: bool | None = None
    refuted: str = ""
    falls: bool = True
    fallen: list[str] = field(default_factory=list)
    rests: bool = False
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        frames, maker = Frames(self.reference, self.scheme), PairMaker(self.reference, self.scheme)
        self.observer = Observer(self.reference, maker, frames, self.factors, self.points)
        self.pace = Pace(self.reference, maker.search.skin)
        self.recorder = Recorder()
        self.sums = dict.fromkeys(("friction", "impact", "damping", "crushing", "input", "overlap", "drift"), 0.0)
        self.seconds = 0.0
        self.begun = clock.perf_counter()

    def begin(self, start: str | MotionState, velocities: Mapping[str, Sequence[float]] | None) -> None:
        """Begin in equilibrium, as described or at a state, with other velocities of some bodies."""
        reference = self.reference
        structures, state = structures_of(reference), MotionState.at_rest(reference)
        if isinstance(start, MotionState):
            if start.centre.shape != reference.disc.centroids.shape or len(start.strain) != len(reference.body_of_node):
                msg = "the state to start from belongs to another model"
                raise InputError(msg, hint="take the state of a motion of the same model")
            state = start
            self.notes += check_ground(reference, state, self.ground, self.base, self.step)
        elif start == "equilibrium":
            structures, state = self._balanced(structures, state)
        elif start != "as described":
            msg = f"start = '{start}' is not 'equilibrium', 'as described' or a state"
            raise InputError(msg)
        elif any(s.moves for s in reference.model.supports):
            self.notes.append(STAY)
        if velocities:
            state = thrown(reference, state, velocities)
        self.falls = start != "as described"
        self.origin = reference.disc.centroids if isinstance(start, MotionState) else state.centre.copy()
        self.started, self.place = state.time, state.placement
        self.movers: list[Mover] = []
        self._move(near_now(structures, state) if len(structures) > 1 else structures, state)

    def _balanced(
        self, structures: list[Structure], state: MotionState
    ) -> tuple[list[Structure], MotionState]:
        """Return the structures and their equilibria under the loads, as far as there are any."""
        while True:
            found = [first_state(one, self.scheme, self.factors, self.engine) for one in structures]
            whole = together(structures, [one[0] for one in found], state)
            apart = near_now(structures, whole) if len(structures) > 1 else structures
            if len(apart) == len(structures):
                break
            structures = apart
        self.stands = all(one[1] for one in found)
        if not self.stands:
            self.refuted = proof_at_rest(self.reference.model, self.factors)
        self.notes += dict.fromkeys(one[2] for one in found if one[2])
        return structures, whole

    def _move(self, structures: list[Structure], state: MotionState) -> None:
        """Let structures move on from a state of the whole."""
        known = {id(mover.structure): mover for mover in self.movers}
        self.movers = []
        for one in structures:
            mover = known.get(id(one))
            if mover is None:
                mover = Mover(one, self.scheme, self.factors, self.step, self.drive, self.adaptive, self.engine)
                mover.begin(one.part(state), self.origin[one.bodies])
            self.movers.append(mover)
        self.state = self._whole(state, state.time)

    def _whole(self, state: MotionState, time: float) -> MotionState:
        """Return the state of the whole at a time, ``state`` being one before."""
        if len(self.movers) == 1 and self.movers[0].structure.alone:
            return self.movers[0].state
        if self.base == "moving":  # fixed bodies that belong to no structure
            there = self.ground.carried(self.place, self.started, time)
            fixed = self.reference.disc.shape_of == FIXED
            centre, rotation = state.centre.copy(), state.rotation.copy()
            centre[fixed], rotation[fixed] = there.centre[fixed], there.rotation[fixed]
            state = replace(state, centre=centre, rotation=rotation)
        states = [shifted(mover.state, time) for mover in self.movers]
        return together([mover.structure for mover in self.movers], states, state)

    def drive(self, time: float, h: float) -> Drive:
        """Return what is imposed in a step."""
        if self.base == "moving":
            return self.ground.base(time, h, self.factors)
        acceleration = self.ground.mean_acceleration(time, time + h)
        return Drive(acceleration, np.zeros_like(acceleration), self.factors)

    def follow(self, every: float, stop_overturned: bool, stop_at_rest: bool) -> Ending:
        """Compute the motion and record it; return how it ended."""
        start = shot = self.started
        end = start + self.duration
        self._shoot()
        with Interruption() as interruption:
            while self.state.time < end - 1e-6 * self.step:
                if not self._advance(end):
                    return Ending.UNSOLVED
                if self.state.time >= shot + every - 1e-9 * self.step:
                    shot = self.state.time
                    self._shoot()
                fell = self._fell()
                if stop_overturned and fell is not None:
                    return fell
                over = self.state.time > self.ground.duration
                if all([m.watch.calm(m.state) for m in self.movers]) and over and stop_at_rest and self._still():
                    self.rests = True
                    return Ending.AT_REST
                told = self.progress is not None and self.progress(self._told(start))
                if told or interruption.wanted:
                    return Ending.STOPPED
        self.rests = all([m.watch.calm(m.state) for m in self.movers]) and self._still()
        if not self.rests and not self.fallen and self.state.time >= self.ground.duration:
            self.fallen = [words for m in self.movers for words in m.watch.passed(m.state)]
        return Ending.COMPLETE

    def _advance(self, end: float) -> bool:
        """Make a step of one structure, or those of all to the next time that they have in common, and keep it."""
        done = (self.state.time - self.started) / self.step
        to = min(self.started + (np.floor(done + 1e-6) + 1.0) * self.step, end)
        if len(self.movers) == 1:
            rows = [self.movers[0].once(to)]
            to = self.movers[0].state.time
        else:
            to = min(to, self.state.time + self.pace.longest(self.state, self.step))
            rows = [mover.advance(to) for mover in self.movers]
        found = [row for row in rows if row is not None]
        if len(found) < len(rows):
            return False
        self.state = self._whole(self.state, to)
        self._keep(found)
        if len(self.movers) > 1:
            structures = [mover.structure for mover in self.movers]
            apart = near_now(structures, self.state)
            if [id(one) for one in apart] != [id(one) for one in structures]:
                self._move(apart, self.state)
        return True

    def _still(self) -> bool:
        """Return whether there are equilibria where all structures stand."""
        return all([mover.watch.rests(mover.state) for mover in self.movers])

    def _fell(self) -> Ending | None:
        """Return how a motion ends in which a block has fallen, None where none has; note the first ones."""
        turned = [words for m in self.movers for words in m.watch.overturned(m.state)]
        sunk = [words for m in self.movers for words in m.watch.sunk(m.state)] if self.falls else []
        lost = [words for m in self.movers for words in m.watch.lost(m.state)]
        self.fallen = self.fallen or turned or sunk or lost
        if turned:
            return Ending.OVERTURNED
        if lost:
            return Ending.FALLEN
        return Ending.FALLEN if sunk and (self.stands is not False or self.stated is None) else None

    def _keep(self, rows: Sequence[Row]) -> None:
        """Keep what the structures did."""
        for name in self.sums:
            self.sums[name] += sum(row.works[name] for row in rows)
        worst = max(rows, key=lambda row: row.residual)
        reactions = np.zeros((len(self.observer.names), self.reference.disc.dim))
        for mover, row in zip(self.movers, rows, strict=True):
            np.add.at(reactions, self.observer.rows_of(mover.observer, mover.structure), row.reactions)
        self.recorder.step(
            self.state.time, worst.residual, worst.how, sum(row.factorisations for row in rows),
            max(row.depth for row in rows), self.observer.positions(self.state), reactions,
        )  # fmt: skip

    def _shoot(self) -> None:
        (opening, slip), energy = np.zeros((2, len(self.observer.joints))), dict(self.sums)
        for mover in self.movers:
            own = self.observer.joints_of(mover.observer, mover.structure)
            first = own >= 0  # of several joints between two bodies in space
            opening[own[first]], slip[own[first]] = (v[first] for v in mover.observer.joint_motion(mover.state))
            for name, value in mover.observer.energies(mover.state, {}).items():
                energy[name] = energy.get(name, 0.0) + value
        self.recorder.shot(self.state, opening, slip, energy)

    def _told(self, start: float) -> Progress:
        done = (self.state.time - start) / self.duration
        left = (clock.perf_counter() - self.begun) * (1 - done) / max(done, 1e-9)
        more = f"{left:.0f} s" if left < 100 else f"{left / 60:.0f} min"
        return Progress("dynamics", len(self.recorder.rows), 1.0 - done, f"{self.state.time:.3f} s, {more} left")

    def result(self, ending: Ending) -> DynamicsResult:
        """Return what was computed."""
        if self.recorder.shots[-1][0] is not self.state:
            self._shoot()
        self.seconds = clock.perf_counter() - self.begun
        shots, steps, energy = self.recorder.done(self.reference, len(self.points), len(self.observer.names))
        return DynamicsResult(
            model=self.reference.model, gravity=self.reference.gravity, scheme=self.scheme, factors=self.factors,
            ending=ending, shots=shots, steps=steps, energy=energy, points=self.points,
            reactions_of=self.observer.names, joints=self.observer.joints, end=self.state, ground_time=steps.time,
            ground=self.ground.acceleration(steps.time), seconds=self.seconds,
            notes=(*self.notes, *(mover.outran for mover in self.movers if mover.outran)),
            lent_compliance=max(mover.lent for mover in self.movers), asked=self.ground.words,
            begun=self.started, stated=self.stated, stands=self.stands, refuted=self.refuted,
            fallen=tuple(self.fallen), rests=self.rests, ground_ends=max(self.started, self.ground.duration),
            structures=tuple(tuple(mover.structure.bodies.tolist()) for mover in self.movers),
        )  # fmt: skip
