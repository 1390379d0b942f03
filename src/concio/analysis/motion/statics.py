r"""Equilibrium of bodies that have moved far: small displacements from where they stand, until nothing moves any more.

Where they stand the displacement to equilibrium is that of :mod:`concio.analysis.motion.small_displacements`; the
bodies are moved by it and everything is examined again, until it vanishes. Where a displacement controls the load, the
multiplier follows from it: x is piecewise linear in lambda, and the slope of the present piece is one more solve. The
displacement is that on which the load works, or that of a point.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from concio.analysis.motion.certified import Certificate
from concio.analysis.motion.joint_memory import after_equilibrium
from concio.analysis.motion.joint_step import JointAnswer
from concio.analysis.motion.resistance import Resistance
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.small_displacements import Look, SmallDisplacements
from concio.analysis.motion.state import Memory, MotionState
from concio.analysis.motion.step_pairs import relative
from concio.analysis.motion.tie_bars import settled_ties
from concio.contact.reference import Reference
from concio.kinematics.spins import turned_from
from concio.model.stages import ControlPoint
from concio.problem.contact_problem import Engine
from concio.problem.pair_state import PairStates
from concio.problem.tolerances import CERTIFIED
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.stepping.problem import StepProblem, StepSolution
from concio.solvers.stepping.solver import StepSolver

Array = np.ndarray

SAG = 1e-6
"""Depth over the median width of the bodies to which a body of mean weight sinks into a hard joint.

Joints of an arch add up: ten times as much costs its peak one or two hundredths."""

MOST = 80
"""Iterations after which no equilibrium was found."""

UNSOLVED = 3
"""Step problems that no method solves, after which no equilibrium was found either: each costs as much as a hundred."""

STILL = 1e-10
"""Displacement over the width of a body below which nothing moves any more."""

REPEATED = 3
"""Iterations more at most where nothing moves any more and the residual is not that of an equilibrium yet."""

CONTROLLED = 1e-10
"""Relative error of the displacement that controls the load in one iteration."""

ROUNDING = 1e-13
"""Error of that displacement over the width of a body that is none."""

REACHED = 1e-6
"""Relative error of that displacement where the iterations end."""

FAR = 0.5
"""Displacement in one equilibrium, over the width of a body, beyond which the structure moves away.

Joints that are open at first close before they press: so much more each.
"""

_NONE: Array = np.zeros(0, dtype=np.int64)


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
    unstable : bool
        Whether what is off the equilibrium grows away from it, though its displacement is controlled.
    layout : optional
        Of the contact pairs.
    """

    state: MotionState
    multiplier: float
    residual: float
    found: bool
    moved: Array
    force: Array
    pairs: int
    iterations: int
    unstable: bool = False
    layout: Any = None


class Statics(SmallDisplacements):
    """Finds equilibria of a reference.

    Parameters
    ----------
    reference, scheme, factors, live, control, sag, sign
        See :class:`concio.analysis.motion.small_displacements.SmallDisplacements`.
    engine : {"superlu", "pardiso"}, optional
    """

    def __init__(
        self,
        reference: Reference,
        scheme: Scheme,
        factors: Mapping[str, float],
        live: tuple[str, ...] = (),
        control: ControlPoint | None = None,
        engine: Engine | None = None,
        sag: float = SAG,
        sign: float = 1.0,
    ) -> None:
        super().__init__(reference, scheme, factors, live, control, sag, sign)
        self.solver = StepSolver(engine or reference.model.engine)
        self._unsolved = 0
        ends = np.array([(i.a, i.b) for i in reference.detection.interfaces], dtype=int).reshape(-1, 2)
        self.far = FAR * self.width + float(reference.rules.openings(*ends.T).sum())
        self.certificate = Certificate(reference, scheme, self.maker)

    def work_displacement(self, before: MotionState, found: Balanced) -> float:
        """Return the mean displacement on which the load worked between two equilibria [m]."""
        half = 0.5 * turned_from(before.rotation, found.state.rotation)
        turn = before.placement.moved(np.zeros_like(before.centre), half).turns
        return float(self.mean(self.unit(turn)) @ found.moved)

    def go_back(self, found: Balanced) -> None:
        """Take the layout of pairs in which an equilibrium was found: other ones may have been tried since."""
        search = self.maker.search
        if search.layout is not found.layout:
            search.layout = found.layout
            self.solver.new_layout()

    def balance(
        self, state: MotionState, multiplier: float, *, target: float | None = None, most: int = MOST,
        since: MotionState | None = None,
    ) -> Balanced:  # fmt: skip
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
        since : MotionState, optional
            The last equilibrium, where fixed bodies were moved after it: what they moved along joints has slipped,
            unless friction takes bodies along.
        """
        here, memory, moved = state, state.memory, np.zeros(self.frames.n)
        slid: Array = np.zeros((0, state.centre.shape[1] - 1))
        done, first, found, iteration = 0.0, self.controlled_at(state), None, 0
        resistance, self._unsolved = Resistance(self.frames.n), 0
        answer: Balanced | None = None
        repeated, unstable = 0, False
        for iteration in range(1, most + 1):
            look = self._looked(here, memory, slid, multiplier)
            if look.memory.key is not memory.key or iteration == 1:
                slid = self._carried(look, memory.key if iteration > 1 else _NONE, slid, since or state, here)
                look = self._looked(here, look.memory, slid, multiplier)
            memory = look.memory
            p = self.problem(look, multiplier, resistance.level)
            found = self._solved(p, *_guess(p, memory, found))
            if target is not None:
                multiplier, found = self._controlled(look, multiplier, found, target - done, resistance.level)
            share = resistance.share(iteration, found.x, controlled=target is not None)
            x, unstable = share * found.x, unstable or share < 0
            before, here = here, self.moved(here, x, look)
            done = done + float(look.measure @ x) if self.control is None else self.controlled_at(here) - first
            slid = slid + relative(look.data.columns, look.data.values, x)[:, 1:] + self.swung(look, before, here)
            moved = moved + x
            if float(np.abs(x).max(initial=0.0)) < STILL * self.width or self._unsolved > UNSOLVED:
                answer = self._judged(since or state, here, memory, slid, multiplier, found, moved, iteration)
                repeated += 1
                if answer.found or repeated > REPEATED or self._unsolved > UNSOLVED:
                    break
            else:
                answer = None
            resistance.adapt(iteration, x)
            if float(np.abs(moved).max()) > self.far + abs(target or 0.0):
                break
        assert found is not None
        answer = answer or self._judged(since or state, here, memory, slid, multiplier, found, moved, iteration)
        answer = replace(answer, unstable=unstable)
        if target is not None and abs(target - done) > REACHED * (abs(target) + STILL * self.width):
            return replace(answer, found=False)  # an equilibrium, but at another displacement
        return answer

    def _carried(self, look: Look, key: Array, slid: Array, origin: MotionState, here: MotionState) -> Array:
        """Return slips (m, d-1) by the names of a new layout: pairs without one before have what their points moved."""
        found = self.slipped(look, origin, here)
        if len(key):
            order = np.argsort(key, kind="stable")
            at = order[np.minimum(np.searchsorted(key, look.memory.key, sorter=order), len(order) - 1)]
            known = key[at] == look.memory.key
            found[known] = slid[at[known]]
        return found

    def _looked(self, state: MotionState, memory: Memory, slid: Array, multiplier: float) -> Look:
        """Return what is found where the bodies stand; the solver forgets what it kept of other pairs."""
        look = self.look(state, memory, slid, multiplier)
        if look.new:
            self.solver.new_layout()
        return look

    def _solved(self, p: StepProblem, states: PairStates, t: Array, x: Array | None = None) -> StepSolution:
        """Return the solution of a step problem, begun with displacements x (N,) or none; count it if it is none."""
        found = self.solver.step(p, states, np.zeros(self.frames.n) if x is None else x, t)
        self._unsolved += not found.residual <= CERTIFIED
        return found

    def _controlled(
        self, look: Look, multiplier: float, found: StepSolution, wanted: float, level: int
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
            found = self._solved(p, found.states, found.t, found.x)
        return multiplier, found

    def _judged(
        self,
        before: MotionState,
        state: MotionState,
        begun: Memory,
        slid: Array,
        multiplier: float,
        found: StepSolution,
        moved: Array,
        count: int,
    ) -> Balanced:
        """Return the point with its certificate: the equations where the bodies stand in the end, nothing moving."""
        look = self._looked(state, begun, slid, multiplier)
        m = len(look.memory.key)
        if len(found.t) == sum(len(part.columns) for part in look.parts) and m == len(begun.key):
            k = len(found.t) - 2 * len(self.maker.ties)
            residual = self.certificate.equilibrium(
                before, state, look.memory, slid, found.t[: k + len(self.maker.ties)],  # ties at rest do not swing
                self.acting(look, multiplier), self.factors_at(multiplier), self.bare, 1e-3 * self.width,
            )  # fmt: skip
            answer = JointAnswer(look.data.shift, found.t[:m], found.states.normal[:m], found.states.direction[:m])
            memory = after_equilibrium(self.maker.joints, look.memory, look.joint, look.data, answer)
            own = slice(k, k + len(self.maker.ties))
            tied = settled_ties(self.maker.ties, state.ties, look.parts[2], found.t[own, 0], found.states.normal[own])
        else:
            residual, memory, tied = np.inf, look.memory, state.ties
        placed = replace(state, memory=memory, ties=tied)
        good, layout = residual <= CERTIFIED, self.maker.search.layout
        return Balanced(placed, multiplier, residual, good, moved, found.t, m, count, layout=layout)


def _guess(p: StepProblem, memory: Memory, last: StepSolution | None) -> tuple[PairStates, Array]:
    """Return initial states and forces (pairs, d): those of the last iteration, or the states of the memory."""
    if last is not None and len(last.t) == p.pairs:
        return last.states, last.t
    return memory.states(p.pairs), np.zeros((p.pairs, p.dim))
