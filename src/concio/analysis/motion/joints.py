r"""Joints in a step: from contact rows and what pairs remember to the pairs of a step problem.

Hard pairs that are closed in the middle of the step obey their law in the relative velocity at its end,

.. math:: y = C v^+ + \tfrac{h}{2} \dot C v + e\,C_n v,

whose second term is what turning adds to pairs that carried force before: without it the scheme would be of first order
even where nothing hits anything. The third term is that of pairs that are hit: they were apart, come nearer, and are
closed in the middle of the step. What is as near as joints give way is hit at the same instant.
Compliant pairs obey theirs at the position q + theta h v_theta. An impact is felt half a step late at most, when
something has sunk in by h |v| / 2 on average; :mod:`concio.analysis.motion.sunk` moves that out of each other again.
What pairs remember of a step is in :mod:`concio.analysis.motion.joint_memory`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.analysis.lent_compliance import SHEAR_TO_NORMAL
from concio.analysis.motion.joint_step import JointStep, PairData
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.springs import Springs, pressed, standing
from concio.analysis.motion.state import Memory
from concio.contact.laws import LawTable
from concio.contact.rows import Rows
from concio.contact.slots import Slots
from concio.kinematics.frames import norm
from concio.problem.cone import Cone

Array = np.ndarray

TOUCHING = 1e-9
"""Gaps up to this share of the size of the model are closed."""

SAG = 1e-5
"""Depth over the median width of the bodies to which a body of mean weight sinks into a hard joint.

That is the compliance added to it: rigid blocks on many corners would otherwise carry themselves in infinitely many
ways, and rounding of their places would choose among them again in every step."""

MOST_SAG = 20.0
"""Depth over that up to which a hard joint is sunk in by force; beyond, it was an impact felt late."""

PRESSED = 2.0
"""The same over the depth that a force and the added compliance explain, where that is more."""

SOFT = 2e-3
"""Compliance of a hard joint in one step over what its bodies give way under a force; of an impact it is taken back."""

RETURN = 0.1
"""Share of what is sunk in more or less than the force implies that comes back in a step, at most."""

FALL = 2.0
"""A pair that carried force stays active until its gap exceeds this many times the distance fallen in a step."""

NOTHING = 1e-6
"""Share of what the loads do to a free body in a step below which turning adds nothing to a relative velocity.

Rounding of angular velocities would otherwise set redundant pairs against each other."""

HIT = 1e-2
"""Share of what the loads do to a free body in a step from which on a velocity hits something.

What is slower came to be within a hundredth of a step, and a step does not resolve when. Walls that are shaken rattle
so in every second step, and an impact takes two to four solutions more."""


class Joints:
    """Joint laws in steps.

    Parameters
    ----------
    laws : LawTable
    scheme : Scheme
    size, width : float
        Of the model and, median, of its bodies [m].
    reach : float
        Compliant pairs further apart than this are left out [m].
    lent : float
        Compliance added to hard joints of rigid bodies [m/kN].
    yielding : (B,) array
        That added on behalf of each elastic body, zero for others [m/kN].
    """

    def __init__(
        self,
        laws: LawTable,
        scheme: Scheme,
        size: float,
        width: float,
        reach: float,
        lent: float,
        yielding: Array,
    ) -> None:
        self.laws, self.scheme, self.lent, self.yielding = laws, scheme, lent, yielding
        self.touching, self.sag, self.reach = TOUCHING * size, SAG * width, reach
        self.least_area = 1e-9 * width
        self.any_stiffness = bool(laws.normal.any() or laws.tangential.any())
        self.any_bond = bool(laws.cohesion.any())
        self.any_cap = bool(np.isfinite(laws.cap).any())
        self._dry: tuple[Slots, Cone] | None = None
        self._lent: tuple[Slots, Array, Array] | None = None

    def strengths(self, slots: Slots, bonded: Array, area: Array) -> Cone:
        """Return the strength domains of slots (m,), of which those ``bonded`` have cohesion, on areas (m,) [m2]."""
        laws, law, zero = self.laws, slots.law, np.zeros(len(slots))
        if self.any_bond or self.any_cap:
            cohesion = np.where(bonded, laws.cohesion[law] * area, 0.0) if self.any_bond else zero
            tension = np.where(bonded, laws.tension[law] * area, 0.0) if self.any_bond else zero
            cap = laws.cap[law] * area if self.any_cap else np.full(len(slots), np.inf)
            return Cone(laws.friction[law], cohesion, tension, cap)
        if self._dry is None or self._dry[0] is not slots:
            self._dry = slots, Cone(laws.friction[law], zero, zero, np.full(len(slots), np.inf))
        return self._dry[1]

    def compliances(self, slots: Slots, area: Array, tension: Array) -> tuple[Array, Array, Springs | None]:
        """Return compliances (m,) along normal and tangent [m/kN], with added ones, and the springs of joints.

        Parameters
        ----------
        slots : Slots
        area : (m,) array
            On which springs stand [m2].
        tension : (m,) array
            Tensile strength [kN].
        """
        law = slots.law
        if self._lent is None or self._lent[0] is not slots:
            both = self.yielding[slots.body_a] + self.yielding[slots.body_b]
            both = np.where(both > 0, both, self.lent)
            self._lent = slots, both, SHEAR_TO_NORMAL * both
        _, a_n, a_t = self._lent
        if not self.any_stiffness:
            return a_n, a_t, None
        own_n, own_t = self.laws.normal[law] / area, self.laws.tangential[law] / area
        normal = own_n > 0
        a_n, a_t = np.where(normal, own_n, a_n), np.where(own_t > 0, own_t, a_t)
        return a_n, a_t, Springs(normal, normal | (own_t > 0), a_n, a_t, a_n * tension)

    def gaps(self, rows: Rows, memory: Memory) -> Array:
        """Return the gaps (m,) after what was crushed and what dilated [m]."""
        gap: Array = rows.gap + memory.crushing - memory.raised
        return gap

    def pairs(
        self, rows: Rows, slots: Slots, memory: Memory, y0: Array, h: float, speed: float, give: Array
    ) -> tuple[PairData, JointStep]:
        """Return the pairs of a step of length h.

        Parameters
        ----------
        rows : Rows
        slots : Slots
        memory : Memory
            With the keys of the slots.
        y0 : (m, d) array
            Relative velocities at the beginning [m/s].
        h : float
            [s].
        speed : float
            What the loads do to a free body in the step [m/s].
        give : (m,) array
            Velocity that a unit normal force gives a pair of free bodies in the step [m/s/kN].
        """
        zero = np.zeros(len(slots))
        gap, area, bonded, cone = self._here(rows, slots, memory)
        ground = standing(memory, area) if self.any_stiffness else zero
        a_n, a_t, springs = self.compliances(slots, ground, cone.tension)
        lasting = memory.force[:, 0] != 0  # pressed, or held by a bond
        shift = rows.imposed + turning_velocity(rows, lasting, h, speed)
        near = gap <= np.where(lasting, FALL * speed * h, self.touching)
        settle = np.minimum(SOFT * give / np.where(a_n > 0, a_n, np.inf), RETURN / h)
        struck = self._struck(rows, gap, y0, lasting, springs, h, speed)
        if struck.any():
            near |= struck
            shift[struck, 0] += self.scheme.restitution * y0[struck, 0]
        else:
            drawn = np.maximum(self.sag, -PRESSED * a_n * memory.force[:, 0])
            shift[:, 0] += settle * np.clip(gap, -self.pressed(a_n, memory.force[:, 0]), drawn)
            shift[:, 1:] += settle[:, None] * memory.stretch
        data = PairData(
            rows.columns, rows.values, shift, cone, settle * a_n, settle * a_t, self.laws.dilatancy[slots.law],
            rows.valid & near,
        )  # fmt: skip
        none = np.zeros(len(slots), dtype=bool)
        step = JointStep(none, a_n, a_t, gap, y0, bonded, None, ground, zero, zero, struck)
        return (data, step) if springs is None else self._sprung(rows, memory, springs, data, step, h)

    def resting(
        self, rows: Rows, slots: Slots, memory: Memory, moved: Array, speed: float
    ) -> tuple[PairData, JointStep]:
        """Return the pairs of an equilibrium: laws in gaps and slips, unknowns being displacements from here.

        Parameters
        ----------
        rows : Rows
        slots : Slots
        memory : Memory
            Of the last equilibrium.
        moved : (m, d-1) array
            Tangential displacement since the last equilibrium [m].
        speed : float
            Distance within which pairs count as near, beside what they are open at first [m].
        """
        zero = np.zeros(len(slots))
        gap, area, bonded, cone = self._here(rows, slots, memory)
        a_n, a_t, springs = self.compliances(slots, area, cone.tension)
        data = PairData(
            rows.columns, rows.values, np.column_stack([gap, memory.stretch + moved]), cone, a_n, a_t,
            self.laws.dilatancy[slots.law], rows.valid & (gap <= speed + np.maximum(slots.opening, 0.0)),
        )  # fmt: skip
        springy = np.zeros(len(slots), dtype=bool) if springs is None else springs.normal
        at_rest = np.zeros_like(rows.imposed)
        return data, JointStep(
            springy, a_n, a_t, gap, at_rest, bonded, springs, area, zero, zero, np.zeros(len(slots), dtype=bool)
        )

    def pressed(self, a_n: Array, force: Array) -> Array:
        """Return depths (m,) up to which hard joints of compliance a_n are sunk in by force: more under tall stacks."""
        return np.asarray(np.maximum(MOST_SAG * self.sag, PRESSED * a_n * force))

    def _struck(
        self, rows: Rows, gap: Array, y0: Array, lasting: Array, springs: Springs | None, h: float, speed: float
    ) -> Array:
        """Return which hard pairs (m,) are hit in a step.

        Where one is, those are too that come as near by the end of the step as joints may be sunk in by force: what
        meets at one instant is not distinguished by how far joints have given way.
        """
        closing = rows.valid & ~lasting & (y0[:, 0] < 0)
        if springs is not None:
            closing &= ~springs.normal
        if not (closing & (gap <= self.touching) & (y0[:, 0] < -HIT * speed)).any():
            return np.zeros(len(gap), dtype=bool)
        near = (gap <= self.touching) | (gap + 0.5 * h * y0[:, 0] <= MOST_SAG * self.sag)
        return np.asarray(closing & near)

    def _here(self, rows: Rows, slots: Slots, memory: Memory) -> tuple[Array, Array, Array, Cone]:
        """Return gaps (m,) [m], areas (m,) [m2], which pairs are bonded (m,), and strengths where bodies stand."""
        area = np.maximum(rows.area, self.least_area)
        bonded = slots.bonded & ~memory.broken
        return self.gaps(rows, memory), area, bonded, self.strengths(slots, bonded, area)

    def _sprung(
        self, rows: Rows, memory: Memory, springs: Springs, data: PairData, step: JointStep, h: float
    ) -> tuple[PairData, JointStep]:
        """Return the pairs of a step where those with a stiffness of their own obey their springs."""
        theta, beta, y0 = self.scheme.theta, self.scheme.stiffness_damping, step.y0
        kept = springs.stored(memory.sunk, memory.stretch)
        gap, sunk = pressed(springs, memory, step.gap, 0.5 * h * y0[:, 0])
        active = rows.valid & np.where(springs.normal, gap <= self.reach, data.active)
        overlap = float(kept[active].sum())
        stored = np.where(active, springs.stored(sunk, memory.stretch), 0.0)
        implicit = h * theta**2 + beta * theta
        at_theta = (gap + (h * (theta * (1 - theta) - 0.5) + beta * (1 - theta)) * y0[:, 0]) / implicit
        drawn = (memory.stretch + (h * theta + beta) * (1 - theta) * y0[:, 1:]) / implicit
        shift = np.column_stack(
            [
                np.where(springs.normal, rows.imposed[:, 0] + at_theta, data.shift[:, 0]),
                np.where(springs.shear[:, None], rows.imposed[:, 1:] + drawn, data.shift[:, 1:]),
            ]
        )
        a_n = np.where(springs.normal, step.a_n / implicit, data.a_n)
        a_t = np.where(springs.shear, step.a_t / implicit, data.a_t)
        return replace(data, shift=shift, a_n=a_n, a_t=a_t, active=active), replace(
            step, springy=springs.normal, gap=gap, springs=springs, sunk=sunk, stored=stored, overlap=overlap,
            drift=float(stored.sum()) - overlap,
        )  # fmt: skip


def turning_velocity(rows: Rows, lasting: Array, h: float, speed: float) -> Array:
    """Return what turning adds to the relative velocities (m, d) of pairs that carried force before [m/s]."""
    turning: Array = 0.5 * h * rows.turning
    turning[~(lasting & (norm(turning) > NOTHING * speed))] = 0.0  # whichever way tangents point
    return turning
