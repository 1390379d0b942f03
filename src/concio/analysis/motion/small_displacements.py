r"""Small displacements from where bodies stand, by which an equilibrium is looked for.

From a configuration q the displacement x to equilibrium is that of

.. math:: (K + \varepsilon M)\, x = f(q) + \lambda\, \ell(q) - K d + C(q)^T t,

with the joint laws in gaps and slips. epsilon M resists motion
(:mod:`concio.analysis.motion.resistance`), and vanishes with x.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from concio.analysis.motion.joint_step import JointStep, PairData
from concio.analysis.motion.resistance import RESISTANCE
from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import Memory, MotionState
from concio.analysis.motion.step_pairs import PairMaker, assembled
from concio.analysis.motion.velocities import Frames
from concio.contact.factors import load_factor
from concio.contact.points import Followed
from concio.contact.reference import Reference
from concio.kinematics.frames import components, norm
from concio.kinematics.placement import Placement
from concio.kinematics.rigid import swept
from concio.kinematics.spins import turned_from
from concio.kinematics.turns import Turns
from concio.model.stages import ControlPoint
from concio.solvers.stepping.matrix import StepMatrix
from concio.solvers.stepping.problem import StepProblem

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Look:
    """What is found where the bodies stand.

    Parameters
    ----------
    turn : Turns
        Rotations of the bodies.
    strain : (nodes, d) array
        Displacements of nodes in the frames of their bodies [m].
    memory : Memory
        With the keys of the pairs found.
    new : bool
        Whether the pairs are others than those of the last look.
    data, joint : PairData, JointStep
        Of contact.
    dead, live : (N,) arrays
        Loads that stay, and those of a multiplier of one [kN].
    measure : (N,) array
        Rate of the displacement that controls the load.
    internal : (N,) array
        Forces of the strains [kN].
    parts : tuple of PairData
        Contact, supports, ties, swinging of ties.
    turning : (N,) array
        Stiffness with which ties resist that bodies turn [kN/m]; empty without ties.
    point : (m, d) array
        Of the contact pairs.
    frame : (m, d, d) array
        Normal and tangents of the contact pairs.
    """

    turn: Turns
    strain: Array
    memory: Memory
    new: bool
    data: PairData
    joint: JointStep
    dead: Array
    live: Array
    measure: Array
    internal: Array
    parts: tuple[PairData, PairData, PairData, PairData]
    turning: Array
    point: Array
    frame: Array


class SmallDisplacements:
    """The problem of small displacements of a reference under dead and live loads.

    Parameters
    ----------
    reference : Reference
    scheme : Scheme
    factors : mapping of str to float
        Load factors; groups not named have 1.
    live : tuple of str
        Groups that the multiplier scales on top of their factors.
    control : ControlPoint, optional
        Whose displacement controls the load; otherwise the mean displacement on which the load works.
    sag : float
        Depth over the width of the bodies to which hard joints are sunk in.
    sign : {1, -1}
        Of the live groups: -1 lets them grow the other way.
    """

    def __init__(
        self, reference: Reference, scheme: Scheme, factors: Mapping[str, float], live: tuple[str, ...],
        control: ControlPoint | None, sag: float, sign: float = 1.0,
    ) -> None:  # fmt: skip
        self.sign = sign
        self.reference, self.factors, self.live = reference, dict(factors), live
        self.frames = Frames(reference, scheme)
        self.maker = PairMaker(reference, scheme, sag)
        self.control = None if control is None else Followed.of(reference, control)
        self.width, self.gravity = self.maker.width, reference.gravity
        at_rest = reference.at_rest().placement
        self.no_spin, self.no_velocity = at_rest.no_spin, np.zeros_like(at_rest.centre)
        self.nowhere = np.zeros(reference.disc.dim)
        self._matrices = [self._stiffness(share * self.gravity / self.width) for share in RESISTANCE]
        self.bare = self._stiffness(0.0)

    def _stiffness(self, resistance: float) -> StepMatrix:
        matrices, n = self.reference.resisting, self.frames.n
        rows, columns, values = matrices.entries(resistance, 1.0)
        A = sp.csr_array((values, (rows, columns)), shape=(n, n))
        A.sum_duplicates()
        return StepMatrix(A)

    def look(self, state: MotionState, memory: Memory, moved: Array, multiplier: float) -> Look:
        """Return pairs and forces where the bodies stand."""
        f, maker = self.frames, self.maker
        here, strain = state.placement, state.strain
        turn = here.turns
        memory, rows, new = maker.contacts(memory, here, self.no_velocity, self.no_spin, strain)
        slid = moved if len(moved) == len(memory.key) else np.zeros((len(memory.key), self.nowhere.size - 1))
        data, joint = maker.joints.resting(rows, maker.slots, memory, slid, maker.search.skin)
        factors = self.factors_at(multiplier)
        off = maker.off_support(here, strain, factors) if len(maker.held) else np.zeros((0, f.reference.disc.dim))
        dead = f.loads(self._drive({**self.factors, **dict.fromkeys(self.live, 0.0)}), turn)
        unit = self.unit(turn)
        internal = -f.stiffness(strain) - f.turned(f.stiffness(strain), strain) if f.elastic else np.zeros(f.n)
        supports = maker.supports(turn, off)
        ties, gap, swings = maker.tie_pairs(here, strain, state.ties)
        turning = maker.tie_turning(here, strain, state.ties, gap, f.n) if len(maker.ties) else np.zeros(0)
        measure = self.mean(unit) if self.control is None else self.control.rate(f.n, turn)
        return Look(
            turn, strain, memory, new, data, joint, dead, unit, measure, internal, (data, supports, ties, swings),
            turning, rows.point, rows.frame,
        )  # fmt: skip

    def problem(self, look: Look, multiplier: float, level: int | None) -> StepProblem:
        """Return the problem of the displacements to equilibrium at a multiplier, at a level of resistance.

        Without a level nothing resists, and ties at rest do not swing: those are the equations themselves.
        """
        b = look.dead + multiplier * look.live + look.internal
        force = float(np.abs(look.dead + multiplier * look.live).sum()) or 1.0
        matrix = self.bare if level is None else self._matrices[level]
        if look.turning.any() and level is not None:
            matrix = StepMatrix(matrix.sparse + sp.diags_array(look.turning, format="csr"))
        return assembled(matrix, b, look.parts, force, 1e-3 * self.width)

    def moved(self, state: MotionState, x: Array, look: Look) -> MotionState:
        """Return the state after a displacement x (N,) of the unknowns."""
        f = self.frames
        u, w = f.rigid_part(x, self.no_velocity, self.no_spin, look.turn)
        strain = look.strain
        if f.elastic:
            place = look.turn[f.body].apply(f.arm + strain)
            rate, v, spin = f.rate(f.nodal(x, look.turn), place, look.turn)
            u[f.meshed], w[f.meshed] = v[f.meshed], spin[f.meshed]
            strain = strain + rate
        there = state.placement.moved(u, w)
        return replace(state, centre=there.centre, rotation=there.rotation, strain=strain)

    def swung(self, look: Look, before: MotionState, after: MotionState) -> Array:
        """Return what finite rotations add to the slips of an iteration, known to first order by the rows (m, d-1)."""
        w = turned_from(before.rotation, after.rotation)
        if not w.any():
            return np.zeros((len(look.memory.key), look.frame.shape[2] - 1))
        slots, turn = self.maker.slots, Placement.at_rest(before.centre).moved(self.no_velocity, w).turns
        moved = np.zeros_like(look.point)
        for body, sign in ((slots.body_b, 1.0), (slots.body_a, -1.0)):
            arm = look.point - before.centre[body]
            moved += sign * (turn[body].apply(arm) - arm - swept(w[body], arm))
        return components(moved, look.frame)[:, 1:]

    def slipped(self, look: Look, before: MotionState, after: MotionState) -> Array:
        """Return what bodies that were moved from one state to another have slipped along their joints (m, d-1) [m]."""
        slots, back = self.maker.slots, Turns.of(before.rotation)
        shift = np.zeros_like(look.point)
        for body, sign in ((slots.body_b, 1.0), (slots.body_a, -1.0)):
            arm = back[body].apply(look.turn[body].undo(look.point - after.centre[body]))
            shift += sign * (look.point - before.centre[body] - arm)
        return components(shift, look.frame)[:, 1:]

    def controlled_at(self, state: MotionState) -> float:
        """Return the displacement of the point that controls the load [m]."""
        if self.control is None:
            return 0.0
        return float(self.control.displacement(state.centre, state.rotation, state.strain).sum())

    def mean(self, unit: Array) -> Array:
        """Return the rate of the displacement on which a load works: its work over its size (N,)."""
        f = self.frames
        size = float(norm(unit[f.places]).sum())
        return unit / size if size > 0 else unit

    def _drive(self, factors: Mapping[str, float]) -> Drive:
        return Drive(self.nowhere, self.nowhere, factors, self.nowhere)

    def factors_at(self, multiplier: float) -> dict[str, float]:
        """Return the load factors at a multiplier."""
        return {**self.factors, **{g: self.sign * multiplier * load_factor(self.factors, g) for g in self.live}}

    def acting(self, look: Look, multiplier: float) -> Array:
        """Return the forces (N,) that act at a multiplier, from the load factors and weights themselves [kN].

        The certificate uses these, not the parts of which the iterations put them together.
        """
        loads = self.reference.loads
        total = look.internal + (loads.forces(self.factors_at(multiplier), look.turn) if loads.groups else 0.0)
        return np.asarray(total)

    def unit(self, turn: Turns) -> Array:
        """Return the load of a multiplier of one (N,) [kN]."""
        if not self.live:
            return np.zeros(self.frames.n)
        groups = self.reference.loads.groups
        only = {g: (self.sign * load_factor(self.factors, g) if g in self.live else 0.0) for g in groups}
        return self.frames.loads(self._drive(only), turn)
