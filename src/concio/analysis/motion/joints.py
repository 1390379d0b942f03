r"""Joints in a step: from contact rows and what pairs remember to the pairs of a step problem, and back.

Hard pairs that are closed in the middle of the step obey their law in the relative velocity at its end,

.. math:: y = C v^+ + \tfrac{h}{2} \dot C v + e\,\min(C_n v, 0),

whose second term is what turning adds: without it the scheme would be of first order even where nothing hits anything.
Compliant pairs obey theirs at the position q + theta h v_theta. An impact is felt half a step late at most, when
something has sunk in by h |v| / 2 on average; :meth:`Joints.apart` moves that out of each other again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.lent_compliance import SHEAR_TO_NORMAL
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.springs import Springs, pressed, standing
from concio.analysis.motion.state import Memory
from concio.contact.moving.laws import LawTable
from concio.contact.moving.rows import Rows
from concio.contact.moving.slots import Slots
from concio.problem.cone import Cone

Array = np.ndarray

TOUCHING = 1e-9
"""Gaps up to this share of the size of the model are closed."""

SAG = 1e-5
"""Depth over the median width of the bodies to which a body of mean weight sinks into a hard joint.

That is the compliance lent to it: rigid blocks on many corners would otherwise carry themselves in infinitely many
ways, and rounding of their places would choose among them anew in every step."""

MOST_SAG = 20.0
"""Depth over that up to which a hard joint is sunk in by force; beyond, it was an impact felt late."""

SOFT = 2e-3
"""Compliance of a hard joint in one step over what its bodies give way under a force: impacts are so much softer."""

RETURN = 0.1
"""Share of what is sunk in more or less than the force wants that comes back in a step, at most."""

SWEEPS = 3
"""Times in a step that what has sunk in is moved apart."""

FALL = 2.0
"""A pair that carried force stays active until its gap exceeds this many times the distance fallen in a step."""


NOTHING = 1e-6
"""Share of what the loads do to a free body in a step below which turning adds nothing to a relative velocity.

Rounding of angular velocities would otherwise set redundant pairs against each other."""


@dataclass(frozen=True, eq=False)
class PairData:
    """Pairs of a step problem; see :class:`concio.solvers.stepping.problem.StepProblem`.

    ``shift`` (m, d) is what stands in the laws beside C v+: the gap, and minus the slip origin.
    """

    columns: Array
    values: Array
    shift: Array
    cone: Cone
    a_n: Array
    a_t: Array
    dilatancy: Array
    active: Array


@dataclass(frozen=True, eq=False)
class JointStep:
    """What is known of the joints before a step is solved.

    Parameters
    ----------
    springy : (m,) boolean array
        Pairs with a stiffness of their own.
    a_n, a_t : (m,) arrays
        Compliances, own or lent [m/kN].
    gap : (m,) array
        In the middle of the step, by constant velocities [m].
    y0 : (m, d) array
        Relative velocities at the beginning [m/s].
    bonded : (m,) boolean array
    springs : Springs or None
        Those of compliant joints.
    area : (m,) array
        On which they stand [m2].
    sunk, stored : (m,) arrays
        Their deformation and energy at the beginning [m], [kN m].
    overlap, drift : float
        What their energy grew by since the end of the last step: because common areas have changed, and because the
        gaps of turned bodies are not what straight motion makes them [kN m].
    """

    springy: Array
    a_n: Array
    a_t: Array
    gap: Array
    y0: Array
    bonded: Array
    springs: Springs | None
    area: Array
    sunk: Array
    stored: Array
    overlap: float = 0.0
    drift: float = 0.0


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
        Compliance lent to hard joints of rigid bodies [m/kN].
    yielding : (B,) array
        That lent on behalf of each elastic body, zero for others [m/kN].
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
        """Return compliances (m,) along normal and tangent [m/kN], lent ones too, and the springs of joints.

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
        s, laws, law = self.scheme, self.laws, slots.law
        m, theta, beta = len(law), s.theta, s.stiffness_damping
        gap = self.gaps(rows, memory)
        area = np.maximum(rows.area, self.least_area)
        zero = np.zeros(m)
        bonded = slots.bonded & ~memory.broken
        cone = self.strengths(slots, bonded, area)
        ground = standing(memory, area) if self.any_stiffness else zero
        a_n, a_t, springs = self.compliances(slots, ground, cone.tension)
        lasting = memory.force[:, 0] > 0
        turning = 0.5 * h * rows.turning
        turning[~(lasting & (np.abs(turning) > NOTHING * speed).any(axis=1))] = 0.0
        shift = rows.imposed + turning
        if s.restitution:
            shift[:, 0] += s.restitution * np.minimum(y0[:, 0], 0.0)
        settle = np.minimum(SOFT * give / np.where(a_n > 0, a_n, np.inf), RETURN / h)
        shift[:, 0] += settle * np.clip(gap, -MOST_SAG * self.sag, self.sag)
        shift[:, 1] += settle * memory.stretch
        soft_n, soft_t = settle * a_n, settle * a_t
        near = gap <= np.where(lasting, FALL * speed * h, self.touching)
        sunk = stored = zero
        overlap = drift = 0.0
        if springs is not None:
            kept = springs.stored(memory.sunk, memory.stretch)
            gap, sunk = pressed(springs, memory, gap, 0.5 * h * y0[:, 0])
            near = np.where(springs.normal, gap <= self.reach, near)
            overlap = float(kept[rows.valid & near].sum())
            stored = np.where(rows.valid & near, springs.stored(sunk, memory.stretch), 0.0)
            drift = float(stored.sum()) - overlap
            implicit = h * theta**2 + beta * theta
            at_theta = (gap + (h * (theta * (1 - theta) - 0.5) + beta * (1 - theta)) * y0[:, 0]) / implicit
            drawn = (memory.stretch + (h * theta + beta) * (1 - theta) * y0[:, 1]) / implicit
            shift[:, 0] = np.where(springs.normal, rows.imposed[:, 0] + at_theta, shift[:, 0])
            shift[:, 1] = np.where(springs.shear, rows.imposed[:, 1] + drawn, shift[:, 1])
            soft_n = np.where(springs.normal, a_n / implicit, soft_n)
            soft_t = np.where(springs.shear, a_t / implicit, soft_t)
        data = PairData(
            rows.columns, rows.values, shift, cone, soft_n, soft_t, laws.dilatancy[law], rows.valid & near
        )
        springy = np.zeros(m, dtype=bool) if springs is None else springs.normal
        return data, JointStep(
            springy, a_n, a_t, gap, y0, bonded, springs, ground, sunk, stored, overlap, drift
        )  # fmt: skip

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
        moved : (m,) array
            Tangential displacement since the last equilibrium [m].
        speed : float
            Distance within which pairs count as near [m].
        """
        laws, law, m = self.laws, slots.law, len(slots)
        gap = self.gaps(rows, memory)
        area = np.maximum(rows.area, self.least_area)
        bonded = slots.bonded & ~memory.broken
        cone = self.strengths(slots, bonded, area)
        a_n, a_t, springs = self.compliances(slots, area, cone.tension)
        data = PairData(
            rows.columns, rows.values, np.stack([gap, memory.stretch + moved], axis=1), cone, a_n, a_t,
            laws.dilatancy[law], rows.valid & (gap <= speed),
        )  # fmt: skip
        springy = np.zeros(m, dtype=bool) if springs is None else springs.normal
        zero = np.zeros(m)
        return data, JointStep(springy, a_n, a_t, gap, np.zeros((m, 2)), bonded, springs, area, zero, zero)

    def settled(
        self, memory: Memory, step: JointStep, data: PairData, y: Array, t: Array, contact: Array, slip: Array
    ) -> Memory:
        """Return what pairs remember of an equilibrium.

        Parameters
        ----------
        memory : Memory
            Of the last one.
        step, data : JointStep, PairData
        y : (m, d) array
            Gaps without compliance and stretches with the slip of this step [m].
        t : (m, d) array
        contact, slip : (m,) integer arrays
        """
        contact = np.where(data.active, contact, 0)
        touches = contact > 0
        stretch = np.where(touches, -step.a_t * t[:, 1], 0.0)
        slid = np.where(touches & (slip != 0), y[:, 1] - stretch, 0.0)
        crushing = memory.crushing
        if self.any_cap:
            depth = -(y[:, 0] + step.a_n * t[:, 0])
            crushing = crushing + np.where(contact == 2, np.maximum(depth, 0.0), 0.0)
        broken = memory.broken
        if self.any_bond and self.scheme.brittle:
            broken = broken | (step.bonded & ((contact == 0) | (slip != 0)))
        sunk = stored = np.zeros(len(t))
        if step.springs is not None:
            sunk = np.where(touches, -step.a_n * t[:, 0], np.maximum(y[:, 0], step.springs.longest))
            stored = np.where(touches, step.springs.stored(sunk, stretch), 0.0)
        return replace(
            memory, contact=contact, slip=slip, force=t, stretch=stretch, crushing=crushing,
            raised=memory.raised + data.dilatancy * np.abs(slid), broken=broken, slid=memory.slid + slid,
            area=step.area, sunk=sunk, stored=stored,
        )  # fmt: skip

    def remember(
        self, memory: Memory, step: JointStep, data: PairData, y: Array, t: Array, contact: Array, slip: Array, h: float
    ) -> tuple[Memory, dict[str, float]]:
        """Return what pairs remember after a step, and the energy they took by column [kN m].

        Parameters
        ----------
        memory : Memory
        step : JointStep
        data : PairData
        y : (m, d) array
            Mean relative velocities in the step [m/s].
        t : (m, d) array
            Forces [kN].
        contact, slip : (m,) integer arrays
            States.
        h : float
            [s].
        """
        contact = np.where(data.active, contact, 0)
        lost_n, lost_t = -h * t[:, 0] * y[:, 0], -h * t[:, 1] * y[:, 1]
        slid, stretch, damped = h * y[:, 1], memory.stretch, 0.0
        soft = step.a_t > 0
        hit = (contact > 0) & ~(memory.force[:, 0] > 0) & ~step.springy
        stuck = soft & (slip == 0) & (contact > 0) & ~hit
        grown = np.where(stuck, stretch + slid, np.where(soft & ~hit, -step.a_t * t[:, 1], 0.0))
        slid, stretch = slid - np.where(soft, grown - stretch, 0.0), grown
        slid = np.where((contact > 0) & (slip != 0), slid, 0.0)
        crushing, raised, crushed, squeezed = memory.crushing, memory.raised, 0.0, np.zeros(len(t))
        if data.dilatancy.any():
            lifted = data.dilatancy * np.abs(slid)
            raised, lost_n, lost_t = raised + lifted, lost_n + t[:, 0] * lifted, lost_t - t[:, 0] * lifted
        sunk = step.sunk + h * y[:, 0] - (raised - memory.raised)
        if self.any_cap:
            yields = np.where(step.springy, -step.a_n * data.cone.cap - sunk, -h * y[:, 0])
            squeezed = np.where(contact == 2, np.maximum(yields, 0.0), 0.0)
            crushing, crushed = crushing + squeezed, float((t[:, 0] * squeezed).sum())
        broken = memory.broken
        if self.any_bond and self.scheme.brittle:
            broken = broken | (step.bonded & ((contact == 0) | (slip != 0)))
        stored = step.stored
        if step.springs is not None:
            springs, active = step.springs.broken(broken), data.active
            away = np.maximum(sunk, self.reach)  # what touches nothing is not pressed
            sunk = np.where(active, sunk + squeezed, away)
            after, before = springs.parts(sunk, stretch), step.springs.parts(step.sunk, memory.stretch)
            stored = np.where(active, after[0] + after[1], 0.0)
            lost_n, lost_t = (
                lost - np.where(active, now - then, 0.0)
                for lost, now, then in zip((lost_n, lost_t), after, before, strict=True)
            )
            if self.scheme.stiffness_damping:
                stuck &= springs.shear
                damped = float(lost_n[springs.normal].sum() + lost_t[stuck].sum())
                lost_n, lost_t = np.where(springs.normal, 0.0, lost_n), np.where(stuck, 0.0, lost_t)
        new = replace(
            memory, contact=contact, slip=slip, force=t, stretch=stretch, crushing=crushing, raised=raised,
            broken=broken, slid=memory.slid + slid, area=step.area, sunk=sunk, stored=stored,
        )  # fmt: skip
        works = {
            "friction": float(lost_t.sum()),
            "impact": float(lost_n.sum()) - crushed,
            "damping": damped,
            "crushing": crushed,
            "overlap": step.overlap - float(memory.stored.sum()) if self.any_stiffness else 0.0,
            "drift": step.drift,
        }
        return new, works

    def apart(self, data: PairData, step: JointStep, end: Array, mass: Array, body_a: Array, body_b: Array) -> Array:
        """Return the displacement (N,) that moves apart what has sunk in, averaged over the pairs of each body.

        Parameters
        ----------
        data : PairData
        step : JointStep
        end : (m,) array
            Gaps at the end of the step [m].
        mass : (N,) array
            Mass of each unknown that may be moved; infinite where it may not.
        body_a, body_b : (m,) integer arrays
        """
        n = len(mass)
        moved = np.zeros(n + 1)
        sunk = np.flatnonzero(data.active & ~step.springy & (end < -MOST_SAG * self.sag))
        if not len(sunk):
            return moved[:n]
        columns, rows = data.columns[sunk], data.values[sunk, 0]
        inverse = np.append(1.0 / mass, 0.0)
        give = (rows**2 * inverse[columns]).sum(1)
        sunk, columns, rows, give = (v[give > 0] for v in (sunk, columns, rows, give))
        count = np.bincount(np.concatenate([body_a[sunk], body_b[sunk]]))
        shared = np.maximum(count[body_a[sunk]], count[body_b[sunk]])
        for _ in range(SWEEPS):
            gap = end[sunk] + (rows * moved[columns]).sum(1)
            push = np.maximum(-gap - 0.5 * MOST_SAG * self.sag, 0.0) / (give * shared)
            added = np.bincount(columns.ravel(), (rows * push[:, None]).ravel(), n + 1)
            moved += inverse * added
        return moved[:n]
