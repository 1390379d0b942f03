r"""Equilibrium of bodies that have moved far: small displacements from where they stand, until nothing moves any more.

From a configuration q the displacement x to equilibrium is that of

.. math:: (K + \varepsilon M)\, x = f(q) + \lambda\, \ell(q) - K d + C(q)^T t,

with the joint laws in gaps and slips; the bodies are moved by x and everything is looked at anew, until x vanishes.
epsilon M resists motion, and vanishes with x: it holds what nothing else holds and lets what swings come to rest. Where
a displacement controls the load, lambda follows from it: x is piecewise linear in lambda, and the slope of the present
piece is one more solve. The displacement is that on which the load works, or that of a point.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from concio.analysis.motion.frames import Frames
from concio.analysis.motion.joints import JointStep, PairData
from concio.analysis.motion.pairs import PairMaker, assembled, relative
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import Memory, MotionState
from concio.analysis.motion.tie_bars import settled_ties
from concio.contact.factors import load_factor
from concio.contact.moving.edges import as_complex, as_vectors, dot
from concio.contact.moving.points import Followed
from concio.contact.moving.reference import Reference
from concio.model.stages import ControlPoint
from concio.problem.tolerances import CERTIFIED
from concio.solvers.algebra.sparse_factor import Engine, SingularMatrixError
from concio.solvers.stepping.matrix import StepMatrix
from concio.solvers.stepping.problem import StepProblem, StepSolution, StepStates
from concio.solvers.stepping.solver import StepSolver

Array = np.ndarray

RESISTANCE = (2e-6, 6e-5, 2e-3, 6e-2, 2.0, 6.0, 20.0, 60.0, 200.0, 600.0)
"""epsilon over gravity by the width of a body: :data:`USUAL`, larger ones where iterations swing to and fro, smaller
ones where each moves as far as the last.

What hangs by a tie and turns with the load is stiffer than the rows of the first order know: with the first alone the
iterations swing about the equilibrium and lose two to fifteen hundredths of their size each time."""

USUAL = 4
"""The resistance to begin with, in :data:`RESISTANCE`."""

STEADY = 0.9
"""Share of the last iteration, gone once more, from which on the resistance is made smaller.

Blocks that can all slide under nearly the same load part slowly: what the sag of their joints tilts them by decides
which one goes, and that is a millionth of their weights."""

SWINGING = 0.6
"""Share of the last iteration, turned back, from which on the resistance is made larger."""

SAG = 1e-6
"""Depth over the median width of the bodies to which a body of mean weight sinks into a hard joint.

Joints of an arch add up: ten times as much costs its peak one or two hundredths."""

MOST = 80
"""Iterations after which no equilibrium was found."""

UNSOLVED = 3
"""Step problems that no method solves, after which no equilibrium was found either: each costs as much as a hundred."""

STILL = 1e-10
"""Displacement over the width of a body below which nothing moves any more."""

CONTROLLED = 1e-10
"""Relative error of the displacement that controls the load in one iteration."""

ROUNDING = 1e-13
"""Error of that displacement over the width of a body that is none."""

REACHED = 1e-6
"""Relative error of that displacement where the iterations end."""

FAR = 0.5
"""Displacement in one equilibrium, over the width of a body, beyond which the structure moves away."""


@dataclass(frozen=True, eq=False)
class Balanced:
    """A point of equilibrium, or the last one tried.

    Parameters
    ----------
    state : MotionState
        With zero velocities.
    multiplier : float
        lambda.
    residual : float
        Worst relative violation of any equation in the final configuration, without resistance.
    found : bool
        Whether that certifies an equilibrium.
    moved : (N,) array
        Displacement of the unknowns from where the iterations began.
    force : (pairs, d) array
        Contact forces [kN]; further those of supports and of ties.
    pairs : int
        Contact pairs.
    iterations : int
    """

    state: MotionState
    multiplier: float
    residual: float
    found: bool
    moved: Array
    force: Array
    pairs: int
    iterations: int


@dataclass(frozen=True, eq=False)
class _Look:
    """What is found where the bodies stand."""

    turn: Array
    strain: Array
    memory: Memory
    data: PairData
    joint: JointStep
    dead: Array
    live: Array
    measure: Array
    internal: Array
    parts: tuple[PairData, PairData, PairData, PairData]
    turning: Array
    point: Array
    normal: Array


class Statics:
    """Finds equilibria of a reference.

    Parameters
    ----------
    reference : Reference
    scheme : Scheme
    factors : mapping of str to float
        Load factors; groups not named have 1.
    live : tuple of str
        Groups that the multiplier scales on top of their factors.
    push : (2,) array
        Share of the weights that the multiplier lets act along this direction, where no group is live.
    control : ControlPoint, optional
        Whose displacement controls the load; otherwise the mean displacement on which the load works.
    engine : {"superlu", "pardiso"}, optional
    sag : float
        Depth over the width of the bodies to which hard joints are sunk in.
    """

    def __init__(
        self,
        reference: Reference,
        scheme: Scheme,
        factors: Mapping[str, float],
        live: tuple[str, ...] = (),
        push: Array | None = None,
        control: ControlPoint | None = None,
        engine: Engine | None = None,
        sag: float = SAG,
    ) -> None:
        self.reference, self.scheme, self.factors, self.live, self.push = reference, scheme, dict(factors), live, push
        self.frames = Frames(reference, scheme)
        self.maker = PairMaker(reference, scheme, sag)
        self.solver = StepSolver(engine)
        self._unsolved = 0
        self.control = None if control is None else Followed.of(reference, control)
        self.width = self.maker.width
        self.gravity = reference.gravity
        self.no_spin = np.zeros(len(reference.model.bodies))
        self.no_velocity = self.no_spin.astype(complex)
        self._matrices = [self._stiffness(share * self.gravity / self.width) for share in RESISTANCE]
        self._bare = self._stiffness(0.0)

    def _stiffness(self, resistance: float) -> StepMatrix:
        matrices, n = self.reference.matrices, self.frames.n
        rows, columns, values = matrices.entries(resistance, 1.0)
        A = sp.csr_array((values, (rows, columns)), shape=(n, n))
        A.sum_duplicates()
        return StepMatrix(A)

    def look(self, state: MotionState, memory: Memory, moved: Array, multiplier: float) -> _Look:
        """Return pairs and forces where the bodies stand."""
        f, maker = self.frames, self.maker
        centre, turn = as_complex(state.centre), np.exp(1j * state.rotation)
        strain = as_complex(state.strain)
        memory, rows, new = maker.contacts(memory, centre, turn, self.no_velocity, self.no_spin, strain)
        if new:
            self.solver.new_layout()
        slid = moved if len(moved) == len(memory.key) else np.zeros(len(memory.key))
        data, joint = maker.joints.resting(rows, maker.slots, memory, slid, maker.search.skin)
        factors = self._factors(multiplier)
        off = maker.off_support(centre, turn, strain, factors) if len(maker.held) else np.zeros(0, dtype=complex)
        dead = f.loads(Drive(np.zeros(2), np.zeros(2), {**self.factors, **dict.fromkeys(self.live, 0.0)}), turn)
        unit = self.unit(turn)
        internal = np.zeros(f.n)
        if f.elastic:
            internal = -f.stiffness(strain) - f.turned(f.stiffness(strain), strain)
        supports = maker.supports(turn, off)
        ties, gap, swings = maker.tie_pairs(centre, turn, strain, state.ties)
        turning = np.zeros(0)
        if len(maker.ties):
            turning = maker.tie_turning(centre, turn, strain, state.ties, gap, f.n)
        measure = self._mean(unit) if self.control is None else self.control.rate(f.n, turn)
        return _Look(
            turn,
            strain,
            memory,
            data,
            joint,
            dead,
            unit,
            measure,
            internal,
            (data, supports, ties, swings),
            turning,
            rows.point,
            rows.normal,
        )

    def work_displacement(self, before: MotionState, found: Balanced) -> float:
        """Return the mean displacement on which the load worked between two equilibria [m]."""
        turn = np.exp(0.5j * (before.rotation + found.state.rotation))
        return float(self._mean(self.unit(turn)) @ found.moved)

    def _mean(self, unit: Array) -> Array:
        """Return the rate of the displacement on which a load works: its work over its size (N,)."""
        f = self.frames
        at = np.concatenate([f.x, f.node_x])
        size = float(np.hypot(unit[at], unit[at + 1]).sum())
        return unit / size if size > 0 else unit

    def _factors(self, multiplier: float) -> dict[str, float]:
        return {**self.factors, **{g: multiplier * load_factor(self.factors, g) for g in self.live}}

    def unit(self, turn: Array) -> Array:
        """Return the load of a multiplier of one (N,) [kN]."""
        f = self.frames
        if self.live:
            groups = self.reference.loads.groups
            only = {g: (load_factor(self.factors, g) if g in self.live else 0.0) for g in groups}
            return f.loads(Drive(np.zeros(2), np.zeros(2), only), turn)
        if self.push is None:
            return np.zeros(f.n)
        return f.ground(Drive(-self.gravity * self.push, np.zeros(2), {}), turn)

    def problem(self, look: _Look, multiplier: float, level: int = USUAL, bare: bool = False) -> StepProblem:
        """Return the problem of the displacements to equilibrium at a multiplier, with a level of resistance."""
        b = look.dead + multiplier * look.live + look.internal
        force = float(np.abs(look.dead + multiplier * look.live).sum()) or 1.0
        matrix = self._bare if bare else self._matrices[level]
        if look.turning.any() and not bare:
            matrix = StepMatrix(matrix.sparse + sp.diags_array(look.turning, format="csr"))
        return assembled(matrix, b, look.parts, force, 1e-3 * self.width)

    def balance(
        self, state: MotionState, multiplier: float, *, target: float | None = None, most: int = MOST
    ) -> Balanced:
        """Return the equilibrium reached from a state.

        Parameters
        ----------
        state : MotionState
        multiplier : float
            lambda, or where it is first looked for.
        target : float, optional
            By how much the controlled displacement is to grow [m]; without it, the multiplier is given.
        most : int
            Iterations at most.
        """
        f, begun = self.frames, state.memory
        here, moved = state, np.zeros(f.n)
        slid: Array = np.zeros(0)
        contact = slip = None
        t_last: Array | None = None
        done, found, iterations, first = 0.0, None, 0, self._at(state)
        level, last, self._unsolved = USUAL, np.zeros(f.n), 0
        for iteration in range(1, most + 1):
            look = self.look(here, begun, slid, multiplier)
            begun, m = look.memory, len(look.memory.key)
            slid = slid if len(slid) == m else np.zeros(m)
            p = self.problem(look, multiplier, level)
            count = p.pairs
            states = StepStates(np.ones(count, dtype=np.int8), np.zeros(count, dtype=np.int8))
            if contact is not None and slip is not None and len(contact) == count:
                states = StepStates(contact, slip)
            else:
                states.contact[:m], states.slip[:m] = begun.contact, begun.slip
            t = t_last if t_last is not None and len(t_last) == count else np.zeros((count, 2))
            found = self._solved(p, states, np.zeros(f.n), t)
            if target is not None:
                multiplier, found = self._controlled(look, multiplier, found, target - done, level)
            x = found.x
            contact, slip, t_last = found.states.contact, found.states.slip, found.t
            before, here = here, self._moved(here, x, look)
            done = done + float(look.measure @ x) if self.control is None else self._at(here) - first
            slid = slid + relative(look.data.columns, look.data.values, x)[:, 1] + self._swung(look, before, here)
            moved = moved + x
            size = float(np.abs(x).max(initial=0.0))
            iterations = iteration
            if size < STILL * self.width or self._unsolved > UNSOLVED:
                break
            along = float(x @ last)
            if iteration > 2 and along < -SWINGING * float(last @ last):
                level = min(level + 1, len(RESISTANCE) - 1)
            elif iteration > 2 and level and along > STEADY * float(last @ last) and along > STEADY * float(x @ x):
                level -= 1
            last = x
            if float(np.abs(moved).max()) > FAR * self.width + abs(target or 0.0):
                break
        assert found is not None
        answer = self._judged(here, begun, slid, multiplier, found, moved, iterations)
        if target is not None and abs(target - done) > REACHED * (abs(target) + STILL * self.width):
            return replace(answer, found=False)  # an equilibrium, but at another displacement
        return answer

    def _solved(self, p: StepProblem, states: StepStates, x: Array, t: Array) -> StepSolution:
        """Return the solution of a step problem, and count it if it is none."""
        found = self.solver.solve(p, states, x, t)
        self._unsolved += not found.residual <= CERTIFIED
        return found

    def _controlled(
        self, look: _Look, multiplier: float, found: StepSolution, wanted: float, level: int
    ) -> tuple[float, StepSolution]:
        """Return multiplier and solution at which the controlled displacement is the one wanted."""
        live, measure = look.live, look.measure
        size = ROUNDING * self.width * float(np.abs(measure).sum())
        low, high = -np.inf, np.inf
        p = self.problem(look, multiplier, level)
        for _ in range(40):
            error = wanted - float(measure @ found.x)
            if abs(error) <= CONTROLLED * abs(wanted) + size or self._unsolved > UNSOLVED:
                break
            low, high = (multiplier, high) if error > 0 else (low, multiplier)
            try:
                slope = float(measure @ self.solver.response(p, found.states, live))
            except SingularMatrixError:
                break
            trial = multiplier + error / slope if slope > 0 else np.nan
            if not low < trial < high:
                trial = 0.5 * (low + high)
            if not np.isfinite(trial) or trial in (low, high):
                break
            multiplier = trial
            p = self.problem(look, multiplier, level)
            found = self._solved(p, found.states, found.x, found.t)
        return multiplier, found

    def _moved(self, state: MotionState, x: Array, look: _Look) -> MotionState:
        """Return the state after a displacement x (N,) of the unknowns."""
        f = self.frames
        u, w = f.rigid_part(x, self.no_velocity, self.no_spin)
        strain = look.strain
        if f.elastic:
            place = look.turn[f.body] * (f.arm + strain)
            rate, v, spin = f.rate(f.nodal(x, look.turn), place, look.turn)
            u[f.meshed], w[f.meshed] = v[f.meshed], spin[f.meshed]
            strain = strain + rate
        return replace(
            state,
            centre=as_vectors(as_complex(state.centre) + u),
            rotation=state.rotation + w,
            strain=as_vectors(strain),
        )

    def _at(self, state: MotionState) -> float:
        """Return the displacement of the point that controls the load [m]."""
        if self.control is None:
            return 0.0
        return float(self.control.displacement(state.centre, state.rotation, state.strain).sum())

    def _swung(self, look: _Look, before: MotionState, after: MotionState) -> Array:
        """Return what finite rotations add to the slips of an iteration, known to first order by the rows (m,)."""
        w = after.rotation - before.rotation
        if not w.any():
            return np.zeros(len(look.memory.key))
        slots, point, centre = self.maker.slots, as_complex(look.point), as_complex(before.centre)
        beyond = np.exp(1j * w) - 1.0 - 1j * w
        a, b = slots.body_a, slots.body_b
        moved = beyond[b] * (point - centre[b]) - beyond[a] * (point - centre[a])
        return dot(1j * as_complex(look.normal), moved)

    def _judged(
        self,
        state: MotionState,
        begun: Memory,
        slid: Array,
        multiplier: float,
        found: StepSolution,
        moved: Array,
        count: int,
    ) -> Balanced:
        """Return the point with its certificate: the equations where the bodies stand in the end, nothing moving."""
        look = self.look(state, begun, slid, multiplier)
        m = len(look.memory.key)
        if len(found.t) == sum(len(part.columns) for part in look.parts) and m == len(begun.key):
            p = self.problem(look, multiplier, bare=True)
            k = len(found.t) - 2 * len(self.maker.ties)
            t = found.t.copy()
            t[k + len(self.maker.ties) :] = 0.0  # ties at rest do not swing
            residual, _ = p.residual(np.zeros(self.frames.n), t)
            contact, slip = found.states.contact[:m], found.states.slip[:m]
            memory = self.maker.joints.settled(
                look.memory, look.joint, look.data, look.data.shift, found.t[:m], contact, slip
            )
            own = slice(k, k + len(self.maker.ties))
            tied = settled_ties(self.maker.ties, state.ties, look.parts[2], t[own, 0], found.states.contact[own])
        else:
            residual, memory, tied = np.inf, look.memory, state.ties
        placed = replace(state, memory=memory, ties=tied)
        return Balanced(placed, multiplier, residual, residual <= CERTIFIED, moved, found.t, m, count)
