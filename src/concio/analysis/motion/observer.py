"""What is examined while bodies move: points, reactions, openings of joints, energies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from concio.analysis.motion.state import MotionState
from concio.analysis.motion.step_pairs import PairMaker
from concio.analysis.motion.structures import Structure
from concio.analysis.motion.velocities import Frames
from concio.contact.points import MaterialPoints, check_point
from concio.contact.reference import Reference
from concio.contact.rows import Rows
from concio.contact.slots import KINDS
from concio.contact.solid_search import SolidLayout
from concio.fem.discretisation import FIXED
from concio.kinematics.frames import dot, norm
from concio.kinematics.placement import Placement
from concio.model.interfaces.patch import Patch
from concio.model.stages import ControlPoint

Array = np.ndarray


class Observer:
    """Looks at states of a reference.

    Parameters
    ----------
    reference : Reference
    maker : PairMaker
        Of the motion.
    frames : Frames
    factors : mapping of str to float
    points : sequence of ControlPoint

    Raises
    ------
    InputError
        A point is on no body.
    """

    def __init__(
        self,
        reference: Reference,
        maker: PairMaker,
        frames: Frames,
        factors: Mapping[str, float],
        points: Sequence[ControlPoint] = (),
    ) -> None:
        self.reference, self.maker, self.frames, self.factors = reference, maker, frames, factors
        model = reference.model
        number = {b.name: i for i, b in enumerate(model.bodies)}
        for point in points:
            check_point(model, point, "point")
        place = np.array([p.at for p in points], dtype=float).reshape(-1, reference.disc.dim)
        bodies = [number[p.body] for p in points]
        self.points = MaterialPoints.of(reference, bodies, place)
        self.fixed = np.flatnonzero(reference.disc.shape_of == FIXED)
        held = sorted({int(i) for i in maker.held.support})
        self.names = (*(model.bodies[b].name for b in self.fixed), *(model.supports[i].name for i in held))
        self._row = np.full(len(model.bodies) + 1, -1)
        self._row[self.fixed] = np.arange(len(self.fixed))
        self._held_row = {i: len(self.fixed) + k for k, i in enumerate(held)}
        self.joints = tuple((model.bodies[f.a].name, model.bodies[f.b].name) for f in reference.detection.faces)
        plane = reference.disc.dim == 2
        self._joint = {key: k for k, key in enumerate(reference.drawn)} if plane else dict(reference.joint_numbers)
        self._corners = _JointCorners(reference)
        self._reacting: tuple[Array, Array, Array, Array] | None = None
        self._known: tuple[Array, Array, Array] | None = None
        self._among: tuple[Observer, Array] | None = None
        self.rest = reference.disc.centroids
        self.node_rest = frames.arm + self.rest[frames.body]

    def positions(self, state: MotionState) -> Array:
        """Return where the points are (p, d) [m]."""
        if not len(self.points):
            return np.zeros((0, self.reference.disc.dim))
        return self.points.positions(state.placement, state.strain)

    def reactions(self, force: Array, pairs: int, frame: Array) -> Array:
        """Return the force of each fixed body and support on the structure (r, d) [kN].

        Parameters
        ----------
        force : (k, d) array
            Forces of all pairs: contact, supports, ties [kN].
        pairs : int
            Number of contact pairs.
        frame : (pairs, d, d) array
            Normal and tangents of the pairs.
        """
        count, d = len(self.names), self.reference.disc.dim
        total = np.zeros((count, d))
        if len(self.fixed) and pairs:
            near, row, sign = self._of_fixed()
            along = np.einsum("kd,kdc->kc", force[near] * sign, frame[near])
            for axis in range(d):
                total[:, axis] = np.bincount(row, along[:, axis], count)
        held = self.maker.held
        for k in range(len(held)):
            total[self._held_row[int(held.support[k])]] += force[pairs + k] @ np.stack([way[k] for way in held.ways])
        return total

    def _of_fixed(self) -> tuple[Array, Array, Array]:
        """Return the slots (k,) of fixed bodies, their rows among the reactions (k,), and signs of forces (k, 1)."""
        slots = self.maker.slots
        if self._reacting is None or self._reacting[0] is not slots.key:
            row_a, row_b = self._row[slots.body_a], self._row[slots.body_b]
            a, b = np.flatnonzero(row_a >= 0), np.flatnonzero(row_b >= 0)
            sign = np.concatenate([np.ones(len(a)), -np.ones(len(b))])[:, None]
            self._reacting = slots.key, np.concatenate([a, b]), np.concatenate([row_a[a], row_b[b]]), sign
        return self._reacting[1:]

    def rows_of(self, part: Observer, structure: Structure) -> Array:
        """Return the rows (r,) of the reactions of a structure, which a part of these observes, among all."""
        fixed = self._row[structure.bodies[part.fixed]]
        held = [self._held_row[int(structure.supports[i])] for i in part._held_row]
        return np.concatenate([fixed, np.array(held, dtype=int)])

    def joints_of(self, part: Observer, structure: Structure) -> Array:
        """Return the numbers (f,) of the joints of a structure, which a part of these observes, among all."""
        if part._among is None or part._among[0] is not self:
            number = np.full(len(part.joints), -1)
            sides = structure.features[0] if self.reference.disc.dim == 2 else structure.bodies
            for (a, b), k in part._joint.items():
                number[k] = self._joint[int(sides[a]), int(sides[b])]
            part._among = self, number
        return part._among[1]

    def rows(self, state: MotionState) -> Rows:
        """Return the contact rows where the bodies stand, in the present layout."""
        still = np.zeros_like(state.centre), np.zeros_like(state.spin)
        return self.maker.search.rows(state.placement, *still, state.strain, turning=False)

    def joint_motion(self, state: MotionState) -> tuple[Array, Array]:
        """Return the largest opening and the plastic slip of each joint that was there in the beginning (f,) [m]."""
        opening, slip = np.zeros(len(self.joints)), np.zeros(len(self.joints))
        search, layout = self.maker.search, self.maker.search.layout
        np.maximum.at(opening, self._corners.joint, self._corners.openings(state.placement))
        if not len(self.joints) or layout is None:
            return opening, slip
        own, number = self._joints_of_slots()
        if self.frames.elastic:
            rows = self.rows(state)
            gap, valid = rows.gap, rows.valid
        else:
            gap, valid = layout.maker.gaps(search.touch(state.placement))
        if self.reference.disc.dim == 3:
            gap = np.where(valid, gap, 0.0)
        np.maximum.at(opening, number, np.maximum(gap[own], 0.0))
        memory = state.memory
        if memory.key is self.maker.slots.key:
            slid = memory.slid[own, 0] if memory.slid.shape[1] == 1 else norm(memory.slid[own])
            order = np.argsort(np.abs(slid), kind="stable")
            slip[number[order]] = slid[order]
        return opening, slip

    def _joints_of_slots(self) -> tuple[Array, Array]:
        """Return the slots of joints that were there in the beginning, and the numbers of these joints."""
        slots, layout = self.maker.slots, self.maker.search.layout
        if isinstance(layout, SolidLayout):
            own = np.flatnonzero(layout.joint >= 0)
            return own, layout.joint[own]
        if self._known is None or self._known[0] is not slots.key:
            count = len(self.reference.edges.body)
            own = np.flatnonzero(slots.bonded)
            edges = [divmod(int(k) // KINDS, count) for k in slots.key[own]]
            number = np.array([self._joint.get((a, b), -1) for a, b in edges], dtype=int)
            self._known = slots.key, own[number >= 0], number[number >= 0]
        return self._known[1], self._known[2]

    def energies(self, state: MotionState, sums: Mapping[str, float]) -> dict[str, float]:
        """Return the energies of a state, with the sums collected so far [kN m]."""
        f, reference = self.frames, self.reference
        here, strain = state.placement, state.strain
        x = f.unknowns(state.velocity, state.spin, state.nodal, here.turns)
        nodes = reference.node_place(here, strain) - self.node_rest if f.elastic else strain
        potential = reference.loads.potential(self.factors, here.centre - self.rest, here.turns, nodes)
        stored = f.strain_energy(strain) + self._springs(state)
        return {"kinetic": f.kinetic_energy(x), "strain": stored, "potential": potential, **sums}

    def _springs(self, state: MotionState) -> float:
        """Return the energy of joints of finite stiffness and of ties [kN m]."""
        return state.ties.stored(self.maker.ties) + float(state.memory.stored.sum())


class _JointCorners:
    """Corners of the joints as described between bodies that are not meshed: what gapes wide has no slots."""

    def __init__(self, reference: Reference) -> None:
        disc, numbers = reference.disc, reference.joint_numbers
        faces = [(k, f) for k, f in enumerate(reference.detection.faces) if max(disc.shape_of[[f.a, f.b]]) < 0]
        corners = [f.polygon if isinstance(f, Patch) else np.stack([f.start, f.end]) for _, f in faces]
        number = [numbers[f.a, f.b] if isinstance(f, Patch) else k for k, f in faces]
        count = [len(at) for at in corners]
        self.joint = np.repeat(number, count).astype(int)
        """Number (k,) of the joint; in space of the first one between the two bodies."""
        self._a, self._b = (np.repeat([getattr(f, side) for _, f in faces], count).astype(int) for side in "ab")
        self._at = np.concatenate(corners) if faces else np.zeros((0, disc.dim))
        self._gap = np.concatenate([f.gap for _, f in faces]) if faces else np.zeros(0)
        self._normal = np.repeat(np.array([f.normal for _, f in faces]).reshape(-1, disc.dim), count, axis=0)
        self._rest = disc.centroids

    def openings(self, placement: Placement) -> Array:
        """Return how far the corners (k,) are open, along the normal that turns with the first body [m]."""
        a, b = self._a, self._b
        on_a, on_b = (placement.points(body, self._at - self._rest[body]) for body in (a, b))
        opened = dot(on_b - on_a, placement.turns[a].apply(self._normal)) + self._gap
        return np.asarray(np.maximum(opened, 0.0))
