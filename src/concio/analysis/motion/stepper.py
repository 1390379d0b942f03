r"""One step of Moreau and Jean's scheme: velocities jump, positions follow, every contact law holds exactly.

With q the configuration, predicted half a step ahead at :math:`q_m = q + h v / 2`,

.. math::

    M (v^+ - v) = h \bigl[ f(q_m) - K d_\theta \bigr] + h C(q_m)^T t, \qquad q^+ = q + h v_\theta, \qquad
    v_\theta = \theta v^+ + (1 - \theta) v,

with the joint laws of :mod:`concio.analysis.motion.joints` between y = C v+ + ... and t. That is
one :class:`concio.solvers.stepping.problem.StepProblem` for v+ with the matrix M/h + theta^2 h K, which in the frames
of the bodies stays the same as they turn. Supports are pairs glued in both directions, ties compliant pairs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from concio.analysis.motion.certified import Certificate, Returned, measures
from concio.analysis.motion.impacts import Impact
from concio.analysis.motion.joint_memory import after_step
from concio.analysis.motion.joint_step import JointAnswer, PairData
from concio.analysis.motion.meetings import Parts, first_meetings, time_until
from concio.analysis.motion.scheme import RETURN, Drive, Scheme
from concio.analysis.motion.state import Memory, MotionState, TieMemory
from concio.analysis.motion.step_pairs import PairMaker, assembled, relative
from concio.analysis.motion.sunk import moved_apart
from concio.analysis.motion.tie_bars import TieStep
from concio.analysis.motion.velocities import Frames
from concio.contact.reference import Reference
from concio.contact.rows import Rows
from concio.kinematics.placement import Placement
from concio.kinematics.turns import Turns
from concio.problem.contact_problem import Engine
from concio.problem.tolerances import CERTIFIED
from concio.solvers.stepping.matrix import StepMatrix
from concio.solvers.stepping.problem import StepSolution
from concio.solvers.stepping.solver import LARGE, StepSolver

Array = np.ndarray

SWINGS = 25
"""Times at most that gyroscopic moments, and forces of elastic bodies that turn, are worked out again in a step.

Each takes off what the body turns in it."""

SWUNG = 1e-14
"""Change of these forces over the loads that is rounding."""

SETTLED = 1e-11
"""The same where it no longer shrinks: forces of elastic bodies are differences of larger ones."""


@dataclass(frozen=True, eq=False)
class StepReport:
    """What a step did.

    Parameters
    ----------
    solution : StepSolution
    pairs : int
        Contact pairs; the solution's further ones are those of supports and ties.
    works : mapping of str to float
        Energy of the step: dissipated by friction, impact, damping, crushing; input; drift [kN m].
    depth : float
        Deepest penetration of hard pairs at its end, before they are moved apart [m].
    struck : float
        Deepest penetration at its end of what was apart at its beginning [m].
    frame : (pairs, d, d) array
        Normal from body a to body b, and tangents.
    meets : (P,) array
        Time from its beginning until what was apart meets, by connected part; infinite where nothing does [s].
    part : (B,) integer array
        Connected part of each body.
    left : float
        Time from its end until what was apart meets; infinite where nothing does [s].
    """

    solution: StepSolution
    pairs: int
    works: dict[str, float]
    depth: float
    struck: float
    frame: Array
    meets: Array
    part: Array
    left: float


class Stepper:
    """Makes steps of a reference.

    Parameters
    ----------
    reference : Reference
    scheme : Scheme
    engine : {"superlu", "pardiso"}, optional
    """

    def __init__(self, reference: Reference, scheme: Scheme, engine: Engine | None = None) -> None:
        self.reference, self.scheme = reference, scheme
        disc = reference.disc
        self.frames = Frames(reference, scheme)
        self.maker = PairMaker(reference, scheme)
        self.certificate = Certificate(reference, scheme, self.maker)
        self.solver = StepSolver(engine or reference.model.engine, large=LARGE)
        self.fixed = np.flatnonzero(disc.shape_of == -2)
        self.turns = disc.dim == 3
        self.parts = Parts(disc.shape_of == -2)
        self._movable = np.full(disc.unknowns, np.inf)
        for b in np.setdiff1d(reference.rigid, self.maker.held.points.body).tolist():
            own = slice(*disc.offsets[b : b + 2])
            self._movable[own] = reference.mass[own]
        self._inverse_mass = np.append(1.0 / np.where(reference.mass > 0, reference.mass, np.inf), 0.0)
        self._matrices: dict[float, StepMatrix] = {}
        self._gained: tuple[float, Array] | None = None

    def matrix(self, h: float) -> StepMatrix:
        """Return M/h + theta^2 h K with damping (N, N)."""
        if h not in self._matrices:
            s, f, n = self.scheme, self.frames, self.frames.n
            matrices = self.reference.matrices
            rows, columns, values = matrices.entries(1.0 / h, h * s.theta**2 + s.stiffness_damping * s.theta)
            if s.mass_damping:
                values[f.nodes] += s.mass_damping * s.theta * f.node_mass[:, None]
            A = sp.csr_array((values, (rows, columns)), shape=(n, n))
            A.sum_duplicates()
            if len(self._matrices) > 20:
                self._matrices.clear()
            self._matrices[h] = StepMatrix(A)
        return self._matrices[h]

    def located(self, state: MotionState) -> MotionState:
        """Return a state whose joints are those found where its bodies stand."""
        still = np.zeros_like(state.centre), np.zeros_like(state.spin)
        memory, _, new = self.maker.contacts(state.memory, state.placement, *still, state.strain)
        if new:
            self.solver.new_layout()
        return replace(state, memory=memory)

    def step(self, state: MotionState, h: float, drive: Drive) -> tuple[MotionState, StepReport]:
        """Return the state after a step of length h, and what the step did."""
        f = self.frames
        velocity, spin, strain, nodal = state.velocity, state.spin, state.strain, state.nodal
        if len(self.fixed):
            velocity, spin = velocity.copy(), spin.copy()
            velocity[self.fixed] = drive.speeds(state.centre[self.fixed], h)
            spin[self.fixed] = drive.spin
        middle = state.placement.moved(0.5 * h * velocity, 0.5 * h * spin)
        turn = middle.turns
        if f.elastic:
            rate, _, _ = f.rate(nodal, turn[f.body].apply(f.arm + strain), turn)
            strain = strain + 0.5 * h * rate
        x0 = f.unknowns(velocity, spin, nodal, turn)
        loads, ground = f.loads(drive, turn), f.ground(drive, turn)
        b = f.mass * x0 / h + loads + ground
        inner = self._inner(state, h, strain, x0, x0, turn)
        if self.turns:
            inner = inner + self._swing(b + inner, x0, h)
        b = b + inner
        force, speed = measures(self.reference, loads + ground, x0, h)
        maker = self.maker
        memory, rows, layout_is_new = maker.contacts(state.memory, middle, velocity, spin, strain)
        if layout_is_new:
            self.solver.new_layout()
        slots = maker.slots
        y0 = relative(rows.columns, rows.values, x0) + rows.imposed
        data, joint = maker.joints.pairs(rows, slots, memory, y0, h, speed, self._give(rows, h))
        held = self._held(state, turn, h, drive)
        ties = self._ties(state, middle, strain, x0, h)
        parts = [data, held] if ties is None else [data, held, ties.data]
        problem = assembled(self.matrix(h), b, parts, force, speed)
        m, count = len(memory.key), problem.pairs
        k = m + len(maker.held)
        states = memory.states(count) if ties is None else memory.states(count, ties.states())
        t0 = np.zeros((count, problem.dim))
        t0[:m] = memory.force
        self.solver.begin()
        found = self.solver.step(problem, states, self._guess(state, x0, h), t0)
        returned: Returned | None = None
        change = np.inf
        for _ in range(SWINGS):
            if joint.impact:
                hit = Impact(self.solver, problem, joint, self.scheme, x0, rows.imposed)
                found, returned = hit.answer(found, returned)
            if found.residual > CERTIFIED or not (self.turns or f.elastic):
                break
            again = self._inner(state, h, strain, x0, found.x, turn)
            if self.turns:
                again = again + f.gyroscopic(self.scheme.theta * found.x + (1 - self.scheme.theta) * x0)
            before, change = change, float(np.abs(again - inner).max(initial=0.0))
            if change <= SWUNG * force or before <= change <= SETTLED * force:
                break
            problem, inner = replace(problem, b=problem.b + again - inner), again
            if not joint.impact:
                found = self.solver.step_again(problem, found)
        found = replace(found, how=self.solver.solved_by)
        theta = self.scheme.theta
        x = theta * found.x + (1 - theta) * x0
        y = relative(rows.columns, rows.values, x) + rows.imposed
        memory_before = memory
        answer = JointAnswer(y, found.t[:m], found.states.normal[:m], found.states.direction[:m])
        memory, works = after_step(maker.joints, memory, joint, data, answer, h)
        works["input"] = h * float(ground @ x) - h * float((found.t[:m] * rows.imposed).sum())
        if len(maker.held):
            works["input"] += h * float((found.t[m:k] * relative(held.columns, held.values, x)).sum())
        works["damping"] += self._damping(x, found.x - x0, turn, strain, h)
        tied = state.ties
        if ties is not None:
            rate = relative(ties.data.columns, ties.data.values, x)[:, 0]
            tied, lost, yielded = ties.remember(rate, found.t[k:, 0], found.states.normal[k:], h)
            works["damping" if self.scheme.stiffness_damping else "impact"] += lost
            works["crushing"] += yielded
            works["drift"] += ties.drift
        end = joint.gap + h * y[:, 0] - 0.5 * h * joint.y0[:, 0] + memory.crushing - memory_before.crushing
        parting = relative(rows.columns, rows.values, found.x) + rows.imposed
        resting = np.where(h * parting[:, 0] > -RETURN * end, np.maximum(end, 0.0), end)  # others leave by themselves
        pressed = maker.joints.pressed(joint.a_n, np.minimum(memory_before.force[:, 0], found.t[:m, 0]))
        apart = moved_apart(data, joint, resting, pressed, self._movable, slots.body_a, slots.body_b)
        works["drift"] -= float(loads @ apart)
        if self.reference.loads.followers:
            works["input"] += float(self.reference.loads.following(drive.factors, turn) @ (h * x + apart))
        if maker.joints.any_stiffness:
            works["overlap"] += float(memory_before.stored.sum()) - float(state.memory.stored.sum())
        new = self._moved(state, found.x, x, apart, turn, strain, h, velocity, spin, memory, tied)
        found = self._certified(found, state, new, memory_before, h, drive, returned or Returned())
        gained = (found.x - x0) / h if self._gained is None or not joint.impact else self._gained[1]
        self._gained = new.time, gained
        hard = rows.valid & ~joint.springy
        depth = float(np.maximum(-end[hard & data.active], 0.0).max(initial=0.0))
        hit = hard & (memory_before.force[:, 0] == 0) & (joint.gap > 0.5 * h * joint.y0[:, 0] - maker.joints.sag)
        struck = float(np.maximum(-end[hit], 0.0).max(initial=0.0))
        free = hard & (memory_before.force[:, 0] == 0)
        part, part_of_pair = self.parts.of(slots)
        meets = first_meetings(joint, end, free, speed, h, part_of_pair, 1 + int(part.max(initial=-1)))
        nearing = free & ~joint.struck & (parting[:, 0] < -speed)
        left = time_until(end, parting[:, 0], nearing)
        return new, StepReport(found, m, works, depth, struck, rows.frame, meets, part, left)

    def _guess(self, state: MotionState, x0: Array, h: float) -> Array:
        """Return velocities (N,) at the end of a step as if they went on as in the last one without impact."""
        if not self.turns or self._gained is None or self._gained[0] != state.time:
            return x0
        return np.asarray(x0 + h * self._gained[1])

    def _inner(
        self, state: MotionState, h: float, strain: Array, x0: Array, x1: Array, turn: Turns
    ) -> Array:
        """Return what elasticity adds to the right-hand side (N,), with velocities x1 at the end."""
        f = self.frames
        return f.internal(state, h, strain, x0, x1, turn) if f.elastic else np.zeros(f.n)

    def _swing(self, b: Array, x0: Array, h: float) -> Array:
        """Return the gyroscopic forces (N,) of bodies that nothing touches, under right-hand sides b (N,)."""
        f, theta = self.frames, self.scheme.theta
        x, swing = x0, f.gyroscopic(x0)
        for _ in range(SWINGS):
            x = h * (b + swing) / f.mass
            again = f.gyroscopic(theta * x + (1 - theta) * x0)
            change, swing = float(np.abs(again - swing).max(initial=0.0)), again
            if change <= np.finfo(float).eps * float(np.abs(again).max(initial=0.0)):
                break
        return swing

    def _certified(
        self, found: StepSolution, state: MotionState, new: MotionState, memory: Memory, h: float, drive: Drive,
        returned: Returned,
    ) -> StepSolution:  # fmt: skip
        """Return the solution of a step with the residual of its original equations, where that is the larger one."""
        if found.residual > CERTIFIED:
            return found
        certificate = self.certificate.step(state, new, memory, found.t, h, drive, returned, self.matrix(h))
        return replace(found, residual=max(found.residual, certificate))

    def _give(self, rows: Rows, h: float) -> Array:
        """Return the velocity that a unit normal force gives each pair of free bodies in a step (m,) [m/s/kN]."""
        flexible: Array = h * (rows.values[:, 0] ** 2 * self._inverse_mass[rows.columns]).sum(axis=1)
        return flexible

    def _held(self, state: MotionState, turn: Turns, h: float, drive: Drive) -> PairData:
        """Return the pairs of supports."""
        maker = self.maker
        if not len(maker.held):
            return maker.nothing
        drift = maker.off_support(state.placement, state.strain, drive.factors) - drive.moved
        return maker.supports(turn, RETURN / h * drift - drive.velocity)

    def _ties(
        self, state: MotionState, middle: Placement, strain: Array, x0: Array, h: float
    ) -> TieStep | None:
        """Return the ties of a step whose bodies stand so in its middle; None where there are none."""
        if not len(self.maker.ties):
            return None
        data, gap, _ = self.maker.tie_pairs(middle, strain, state.ties)
        y0 = relative(data.columns, data.values, x0)[:, 0]
        return TieStep.of(self.maker.ties, state.ties, data, gap, y0, h, self.scheme)

    def _damping(self, x: Array, jump: Array, turn: Turns, strain: Array, h: float) -> float:
        """Return what Rayleigh's damping took, and what theta above one half did of kinetic energy [kN m]."""
        f, s = self.frames, self.scheme
        lost = (2 * s.theta - 1) * f.kinetic_energy(jump)
        if not f.elastic:
            return lost
        if s.theta > 0.5:
            rate, _, _ = f.rate(f.nodal(x, turn), turn[f.body].apply(f.arm + strain), turn)
            lost += (2 * s.theta - 1) * f.strain_energy(h * rate)
        if s.stiffness_damping:
            rate, _, _ = f.rate(f.nodal(x, turn), turn[f.body].apply(f.arm + strain), turn)
            lost += 2.0 * h * s.stiffness_damping * f.strain_energy(rate)
        if s.mass_damping:
            lost += h * s.mass_damping * float(f.node_mass @ (x[f.nodes] ** 2).sum(axis=1))
        return lost

    def _moved(
        self, state: MotionState, x1: Array, x: Array, apart: Array, turn: Turns, strain: Array, h: float,
        velocity: Array, spin: Array, memory: Memory, ties: TieMemory,
    ) -> MotionState:  # fmt: skip
        """Return the state that velocities x in the step and x1 at its end, and displacements ``apart``, lead to."""
        f = self.frames
        v_mean, w_mean = f.rigid_part(x + apart / h, velocity, spin, state.placement.turns)
        new_strain, nodal = state.strain, state.nodal
        if f.elastic:
            place = turn[f.body].apply(f.arm + strain)
            rate, v, w = f.rate(f.nodal(x, turn), place, turn)
            v_mean[f.meshed], w_mean[f.meshed] = v[f.meshed], w[f.meshed]
            new_strain = new_strain + h * rate
            nodal = f.nodal(x1, turn)
        there = state.placement.moved(h * v_mean, h * w_mean)
        v_end, w_end = f.rigid_part(x1, velocity, spin, there.turns)
        if f.elastic:
            v, w = f.fit(nodal, place)
            v_end[f.meshed], w_end[f.meshed] = v[f.meshed], w[f.meshed]
        return MotionState(
            state.time + h, there.centre, there.rotation, v_end, w_end, new_strain, nodal, memory, ties
        )  # fmt: skip

