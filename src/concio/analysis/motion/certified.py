"""Certificates of equilibria and of steps of a motion, on equations that are written down once more.

Contact pairs are those of :class:`concio.contact.original.OriginalContacts`; supports and ties are placed here
from the model. Of the solution come only its answer: placements, velocities, forces, what joints remember of the step
before, how far pairs have slid, and of an impact the restitution and the forces from which added compliance counts.
How far pairs have slid is compared with what their material points moved.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from concio.analysis.motion.certified_turns import angle, back, driven, forth, on
from concio.analysis.motion.joint_step import JointStep, PairData
from concio.analysis.motion.joints import Joints
from concio.analysis.motion.scheme import RETURN, Drive, Scheme
from concio.analysis.motion.state import Memory, MotionState
from concio.analysis.motion.step_pairs import PairMaker, assembled, no_pairs, relative
from concio.analysis.motion.tie_bars import TieStep
from concio.analysis.motion.velocities import Frames
from concio.contact.laws import LawTable
from concio.contact.original import OriginalContacts
from concio.contact.original_solids import OriginalSolids
from concio.contact.points import MaterialPoints
from concio.contact.reference import Reference
from concio.contact.rows import Rows
from concio.contact.slots import Slots
from concio.kinematics.frames import turned_left
from concio.kinematics.rigid import motions
from concio.kinematics.turns import Turns
from concio.problem.cone import Cone
from concio.solvers.stepping.matrix import StepMatrix

Array = np.ndarray

BENT = 4.0
"""Error of a slip over rotation times displacement since the last equilibrium: what is known to second order."""

PATH = 1e-2
"""Error of a slip over what the centroids of the two bodies moved since then.

Iterations sum it along the tangents that they pass: of bodies that turn together it is known to the third order."""

ROUNDING = 1e-8
"""Error of a slip over the width of a body that is rounding of the iterations."""

PLACES = 8.0
"""Roundings of a place that a gap has."""

HIDDEN = 1e-4
"""Depth over the narrower body's width to which a corner may stand in another body in an equilibrium."""

THROUGH = 0.1
"""The same in a motion, where impacts are felt late: beyond it, edges stand behind each other."""

LOOKED = 1e-2
"""Distance over the width of a body that corners move between two looks for hidden ones."""


@dataclass(frozen=True, eq=False)
class Returned:
    """What an impact says of its law.

    Parameters
    ----------
    share : float
        Of the restitution, 0 to 1.
    force : (pairs, d) array or None
        From which the compliance added to joints counts [kN].
    hard : bool
        Whether what that compliance still does to the impact is nothing.
    """

    share: float = 1.0
    force: Array | None = None
    hard: bool = True


class Certificate:
    """Evaluates answers on the original equations.

    Parameters
    ----------
    reference : Reference
    scheme : Scheme
    maker : PairMaker
        Whose layout names the pairs.
    """

    def __init__(self, reference: Reference, scheme: Scheme, maker: PairMaker) -> None:
        self.reference, self.scheme, self.maker = reference, scheme, maker
        plane = reference.disc.dim == 2
        self.original: Any = OriginalContacts(reference) if plane else OriginalSolids(reference)
        self.frames = Frames(reference, scheme)
        old = maker.joints
        self.joints = Joints(
            LawTable.of(reference.model), scheme, reference.disc.size, maker.width, old.reach, old.lent, old.yielding
        )
        self._inverse_mass = np.append(1.0 / np.where(reference.mass > 0, reference.mass, np.inf), 0.0)
        self._looked: Array | None = None

    # -- equilibria ----------------------------------------------------------------------------------------------------

    def equilibrium(
        self, before: MotionState, state: MotionState, memory: Memory, slid: Array, t: Array,
        acting: Array, factors: dict[str, float], matrix: StepMatrix, length: float,
    ) -> float:  # fmt: skip
        """Return the worst relative violation of any equation of an equilibrium.

        Parameters
        ----------
        before, state : MotionState
            Of the last equilibrium, and of this one.
        memory : Memory
            Of the last equilibrium, by the keys of the pairs.
        slid : (m,) array
            Tangential displacement of the pairs since then [m].
        t : (pairs, d) array
            Forces of contact, supports and ties [kN].
        acting : (N,) array
            Loads, and forces of the strains, where the bodies stand [kN].
        factors : mapping of str to float
            Of the loads that move supports.
        matrix : StepMatrix
            Of which only the size counts: nothing moves.
        length : float
            By which gaps and slips are measured [m].
        """
        still, none = np.zeros_like(state.centre), np.zeros_like(state.spin)
        layout = self.maker.search.layout
        assert layout is not None
        slots, rows = self.original.at(layout, state.centre, state.rotation, still, none, state.strain)
        data, _ = self.joints.resting(rows, slots, memory, slid, self.maker.search.skin)
        ties, _ = self.ties(state, state.centre, state.rotation, state.strain)
        supports = self.supports(state, factors)
        force = float(np.abs(acting).sum()) or 1.0
        p = assembled(matrix, acting, (data, supports, ties), force, length)
        if p.pairs != len(t) or not self.original.named(layout).sound:
            return float("inf")
        residual = p.residual(np.zeros(self.frames.n), t)[0]
        wrong = self._slips(slots, rows, before, state, slid, t[: len(slots), 0] > 0)
        sunk = self.joints.lent * float(t[: len(slots), 0].max(initial=0.0))  # as far as added compliance explains it
        if self.original.deepest(state.centre, state.rotation, state.strain, HIDDEN, sunk) > 1.0:
            return float("inf")
        return max(residual, wrong)

    def _slips(
        self, slots: Slots, rows: Rows, before: MotionState, state: MotionState, slid: Array, carries: Array
    ) -> float:
        """Return by how much slips differ from what material points moved, over the width of a body."""
        if not carries.any():
            return 0.0
        disp = self._moved(slots, rows, before, state)
        went = np.linalg.norm(state.centre - before.centre, axis=1)
        far = np.maximum(went[slots.body_a], went[slots.body_b])
        along = (rows.frame[:, 1:] * disp[:, None]).sum(axis=2)
        turn = angle(before.rotation, state.rotation)
        most = np.maximum(turn[slots.body_a], turn[slots.body_b])
        bound = BENT * most * np.linalg.norm(disp, axis=1) + PATH * far + ROUNDING * self.maker.width
        elastic = self.reference.disc.shape_of >= 0
        bends = elastic[slots.body_a] | elastic[slots.body_b]
        bound += np.where(bends, most**2 * self.maker.width, 0.0)  # nodes follow a rotation along its tangent
        return float(np.maximum(np.linalg.norm(slid - along, axis=1) - bound, 0.0)[carries].max()) / self.maker.width

    def _moved(self, slots: Slots, rows: Rows, before: MotionState, state: MotionState) -> Array:
        """Return the displacement (m, d) of b over a at the points that touch, since another state [m]."""
        total = np.zeros_like(rows.point)
        moved = self._nodes(state) - self._nodes(before)
        for sign, body, side in ((-1.0, slots.body_a, slots.side_a), (1.0, slots.body_b, slots.side_b)):
            arm = forth(back(rows.point - state.centre[body], state.rotation[body]), before.rotation[body])
            step = rows.point - before.centre[body] - arm
            if side is not None:
                padded = np.vstack([moved, np.zeros((1, moved.shape[1]))])
                mean = (side.weight[:, :, None] * padded[side.node]).sum(axis=1)
                step = np.where(side.meshed[:, None], mean, step)
            total += sign * step
        return total

    def _nodes(self, state: MotionState) -> Array:
        """Return where the nodes of elastic bodies are (nodes, d) [m]."""
        b = self.reference.body_of_node
        return np.asarray(state.centre[b] + forth(self.reference.node_arm + state.strain, state.rotation[b]))

    # -- steps of a motion ---------------------------------------------------------------------------------------------

    def step(
        self, state: MotionState, new: MotionState, memory: Memory, t: Array, h: float, drive: Drive,
        returned: Returned, matrix: StepMatrix,
    ) -> float:  # fmt: skip
        """Return the worst relative violation of any equation of a step.

        Parameters
        ----------
        state, new : MotionState
            At its beginning and its end.
        memory : Memory
            At its beginning, by the keys of the pairs.
        t : (pairs, d) array
            Mean forces of contact, supports and ties [kN].
        h : float
            [s].
        drive : Drive
        returned : Returned
        matrix : StepMatrix
            Masses over the step, and stiffness.
        """
        layout, f = self.maker.search.layout, self.frames
        assert layout is not None
        velocity, spin = driven(self.reference, state, h, drive)
        centre, rotation = state.centre + 0.5 * h * velocity, on(state.rotation, 0.5 * h * spin)
        turn = Turns.of(rotation)
        strain, nodal = state.strain, state.nodal
        if f.elastic:
            rate, _, _ = f.rate(nodal, turn[f.body].apply(f.arm + strain), turn)
            strain = strain + 0.5 * h * rate
        x0 = f.unknowns(velocity, spin, nodal, turn)
        after = turn if centre.shape[1] == 2 else Turns.of(new.rotation)
        x = f.unknowns(new.velocity, new.spin, new.nodal, after, turn)
        acting = f.loads(drive, turn) + f.ground(drive, turn)
        b = f.mass * x0 / h + acting
        if centre.shape[1] == 3:
            b = b + f.gyroscopic(self.scheme.theta * x + (1 - self.scheme.theta) * x0)
        if f.elastic:
            b = b + f.internal(state, h, strain, x0, x, turn)
        force, speed = measures(self.reference, acting, x0, h)
        slots, rows = self.original.at(layout, centre, rotation, velocity, spin, strain)
        if not self.original.named(layout).sound:
            return float("inf")
        y0 = relative(rows.columns, rows.values, x0) + rows.imposed
        give = h * (rows.values[:, 0] ** 2 * self._inverse_mass[rows.columns]).sum(axis=1)
        data, joint = self.joints.pairs(rows, slots, memory, y0, h, speed, give)
        data = self._returned(data, joint, returned)
        parts = [data, self._held(state, centre, rotation, h, drive)]
        if len(self.maker.ties):
            tie, gap = self.ties(state, centre, rotation, strain)
            y0_tie = relative(tie.columns, tie.values, x0)[:, 0]
            parts.append(TieStep.of(self.maker.ties, state.ties, tie, gap, y0_tie, h, self.scheme).data)
        p = assembled(matrix, b, parts, force, speed)
        if p.pairs != len(t):
            return float("inf")
        errors = p.errors(x, t)
        laws = p.violation(t, errors)[1] - self._rounding(centre, h, p.pairs, joint) / speed
        residual = max(float(np.abs(errors.r_u).max(initial=0.0)) / force, float(laws.max(initial=0.0)))
        return float("inf") if self._hidden(new, h) else residual

    def _rounding(self, centre: Array, h: float, pairs: int, joint: JointStep) -> Array:
        """Return what rounding of places adds to the relative velocities in the laws of pairs (m,) [m/s].

        Springs and ties want gaps over the step times theta squared, hard joints and supports a share of gaps over it.
        """
        theta, beta, m = self.scheme.theta, self.scheme.stiffness_damping, len(joint.gap)
        place = PLACES * np.finfo(float).eps * (self.reference.disc.size + float(np.abs(centre).max(initial=0.0)))
        rate = np.full(pairs, RETURN / h)
        implicit = 1.0 / (h * theta**2 + beta * theta)
        if joint.springs is not None:
            rate[:m][joint.springs.normal | joint.springs.shear] = implicit
        rate[m + len(self.maker.held) :] = implicit
        return np.asarray(place * rate)

    def _returned(self, data: PairData, joint: JointStep, returned: Returned) -> PairData:
        """Return the pairs of a step with what an impact says of restitution and added compliance."""
        if not joint.impact:
            return data
        shift, struck = data.shift.copy(), joint.struck
        shift[struck, 0] -= (1.0 - returned.share) * self.scheme.restitution * joint.y0[struck, 0]
        if returned.force is not None:
            springs, t = joint.springs, returned.force[: len(shift)]
            hard_n, hard_t = (True, True) if springs is None else (~springs.normal, ~springs.shear)
            shift[:, 0] -= np.where(hard_n, data.a_n, 0.0) * t[:, 0]
            shift[:, 1:] -= np.where(hard_t, data.a_t, 0.0)[:, None] * t[:, 1:]
        return replace(data, shift=shift)

    def _hidden(self, state: MotionState, h: float) -> bool:
        """Return whether a corner stands deep in another body; looked for when corners have moved."""
        size = float(self.reference.surface.width.max())
        place = np.column_stack([state.centre, state.rotation.reshape(len(state.centre), -1) * size])
        if self._looked is not None and np.abs(place - self._looked).max() < LOOKED * self.maker.width:
            return False
        moving = 2.0 * h * float(np.abs(state.velocity).max(initial=0.0))
        if self.original.deepest(state.centre, state.rotation, state.strain, THROUGH, moving) > 1.0:
            return True
        self._looked = place
        return False

    # -- supports and ties ---------------------------------------------------------------------------------------------

    def supports(self, state: MotionState, factors: dict[str, float]) -> PairData:
        """Return the pairs of supports where bodies stand."""
        if not len(self.maker.held):
            return no_pairs(self.reference.disc.dim)
        off = self._place(self.maker.held.points, state.centre, state.rotation, state.strain)
        return self._glued(state.rotation, off - self.maker.held.target(factors))

    def _held(self, state: MotionState, centre: Array, rotation: Array, h: float, drive: Drive) -> PairData:
        """Return the pairs of supports of a step, in velocities."""
        if not len(self.maker.held):
            return no_pairs(self.reference.disc.dim)
        here = self._place(self.maker.held.points, state.centre, state.rotation, state.strain)
        off = here - self.maker.held.target(drive.factors) - drive.moved
        return self._glued(rotation, RETURN / h * off - drive.velocity)

    def _glued(self, rotation: Array, off: Array) -> PairData:
        """Return the pairs of supports that are off by (k, d)."""
        held, k = self.maker.held, len(self.maker.held)
        ways = _axes(held.normal)
        zero, inf = np.zeros(k), np.full(k, np.inf)
        return PairData(
            held.points.columns, np.stack([_rows(held.points, way, rotation) for way in ways], axis=1),
            np.column_stack([(off * way).sum(axis=1) for way in ways]),
            Cone(zero, np.where(held.pinned, np.inf, 0.0), inf, inf), zero, zero, zero, np.ones(k, dtype=bool),
        )  # fmt: skip

    def ties(self, state: MotionState, centre: Array, rotation: Array, strain: Array) -> tuple[PairData, Array]:
        """Return the pairs of ties in displacements where bodies stand, and their gaps (k,) [m]."""
        ties, k = self.maker.ties, len(self.maker.ties)
        if not k:
            return no_pairs(self.reference.disc.dim), np.zeros(0)
        span = self._place(ties.b, centre, rotation, strain) - self._place(ties.a, centre, rotation, strain)
        length = np.linalg.norm(span, axis=1)
        way = (ties.sign / np.where(length > 0, length, 1.0))[:, None] * span  # soil presses
        values = np.concatenate([_rows(ties.a, way, rotation), -_rows(ties.b, way, rotation)], axis=1)
        gap = ties.sign * (ties.length - length) - ties.prestress / ties.stiffness + state.ties.plastic
        zero, nothing = np.zeros(k), [np.zeros_like(values)] * (span.shape[1] - 1)
        return PairData(
            ties.columns, np.stack([values, *nothing], axis=1), np.column_stack([gap, *[zero] * len(nothing)]),
            Cone(zero, zero, zero, ties.most), 1.0 / ties.stiffness, zero, zero, ~state.ties.broken,
        ), gap  # fmt: skip

    def _place(self, points: MaterialPoints, centre: Array, rotation: Array, strain: Array) -> Array:
        """Return where points are (k, d) [m]."""
        arm, body = points.arm, np.maximum(points.body, 0)
        if points.node.shape[1]:
            padded = np.vstack([strain, np.zeros((1, strain.shape[1]))])
            arm = arm + (points.weight[:, :, None] * padded[points.node]).sum(axis=1)
        return np.where((points.body >= 0)[:, None], centre[body] + forth(arm, rotation[body]), arm)


def measures(reference: Reference, acting: Array, x0: Array, h: float) -> tuple[float, float]:
    """Return the force and the velocity by which residuals of a step are measured: loads, and what they do in it."""
    force = reference.strength(acting)
    if not force:
        force = float(np.abs(reference.mass * x0).sum()) / h or 1.0
    return force, h * force / float(reference.body_mass.sum())


def _rows(points: MaterialPoints, way: Array, rotation: Array) -> Array:
    """Return the displacements (k, w) of points along directions (k, d) from their unknowns."""
    body, d = np.maximum(points.body, 0), way.shape[1]
    arm, local = forth(points.arm, rotation[body]), back(way, rotation[body])
    values = np.zeros(points.columns.shape)
    values[:, :d] = way
    if d == 2:
        values[:, 2] = (arm[:, 0] * way[:, 1] - arm[:, 1] * way[:, 0]) / points.reach
    else:
        assert points.axes.axes is not None, "bodies in space"
        own = np.matmul(rotation[body], points.axes.axes[body])
        values[:, 3:6] = np.einsum("kij,ki->kj", own, np.cross(arm, way)) / points.reach[:, None]
    values[:, motions(d) :] = (points.weight[:, :, None] * local[:, None, :]).reshape(len(body), -1)
    return values


def _axes(first: Array) -> tuple[Array, ...]:
    """Return the axis (k, d) along which a support holds and the others, right-handed."""
    if first.shape[1] == 2:
        return first, turned_left(first)
    others = {0: ((0, 1, 0), (0, 0, 1)), 1: ((-1, 0, 0), (0, 0, 1)), 2: ((1, 0, 0), (0, 1, 0))}
    pick = [others[int(axis)] for axis in np.abs(first).argmax(axis=1)]
    return first, *np.moveaxis(np.array(pick, dtype=float).reshape(-1, 2, 3), 1, 0)
