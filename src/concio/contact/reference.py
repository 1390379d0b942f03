"""Reference and configuration: what bodies are made of, once, and where they stand, apart from it.

A :class:`Reference` holds meshes, stiffnesses, masses, loads and joint laws of a model as it was described. A
:class:`Configuration` adds to it where each body is (:class:`concio.kinematics.placement.Placement`) and how it is
strained in its own frame. Interfaces are looked for on the placed bodies, by the same detection as everywhere.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from concio.contact.detection import default_tolerance, detect_without_overlap
from concio.contact.edges import MovingEdges
from concio.contact.expansion import refuse_temperatures
from concio.contact.face_joints import face_joints, needs_area
from concio.contact.geometry import GEOMETRIES
from concio.contact.laws import LawTable, RuleBook
from concio.contact.macroscopic_strain import held_at_a_point
from concio.contact.matrices import BodyMatrices
from concio.contact.moving_loads import MovingLoads
from concio.contact.moving_solids import MovingSolids
from concio.contact.solid_sides import surface_nodes
from concio.contact.supports import apply_supports
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID, Discretisation, discretise
from concio.kinematics.placement import Placement
from concio.kinematics.spins import SpinAxes, rotation_vector
from concio.model.interfaces.detect import Detection, detect_interfaces
from concio.model.model import Body, Model, require_model
from concio.units import GRAVITY

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Reference:
    """What does not change while bodies move.

    Parameters
    ----------
    model : Model
    detection : Detection
        Interfaces as described.
    disc : Discretisation
    gravity : float
        Turns weights into masses [m/s2].
    """

    model: Model
    detection: Detection
    disc: Discretisation
    gravity: float = GRAVITY

    @classmethod
    def of(cls, model: Model, gravity: float = GRAVITY) -> Reference:
        """Return the reference of a model that is to move.

        Raises
        ------
        InputError
            Gravity is not positive; what is given is not a model; every body is fixed; a support is not usable.
        GeometryError
            Bodies overlap.
        """
        require_model(model)
        if not 0 < gravity < np.inf:
            msg = f"gravity = {gravity:g} must be positive and finite"
            raise InputError(msg, hint="9.81 m/s2 turns weights into masses")
        if not model.free_bodies:
            msg = "every body is fixed: there is nothing that could move"
            raise InputError(msg, hint="make the blocks elastic or rigid")
        refuse_in_space(model)
        if model.periods is not None:
            msg = "a periodic cell has no place of its own: it cannot move"
            raise InputError(msg, hint="take a wall of several blocks")
        refuse_temperatures(model, "a motion, or a push at large displacements,")
        reference = cls.described(model, gravity)
        refuse_elastic_joints(reference)
        apply_supports(reference.disc)  # what cannot be used is said before anything moves
        return reference

    @classmethod
    def described(cls, model: Model, gravity: float = GRAVITY, detection: Detection | None = None) -> Reference:
        """Return the reference of any model whose bodies do not overlap: in the plane, in space, a periodic cell.

        Its interfaces are found, unless they are given.

        Raises
        ------
        GeometryError
            Bodies overlap.
        """
        detection = detect_without_overlap(model) if detection is None else detection
        meshed = model if model.periods is None else held_at_a_point(model)
        return cls(model, detection, discretise(meshed, GEOMETRIES[model.dim].marks(model, detection)), gravity)

    @cached_property
    def free(self) -> Array:
        """Numbers of the bodies that have unknowns."""
        return np.flatnonzero(self.disc.shape_of != FIXED)

    @cached_property
    def rigid(self) -> Array:
        """Numbers of the rigid bodies that are not fixed."""
        return np.flatnonzero(self.disc.shape_of == RIGID)

    @cached_property
    def meshed(self) -> Array:
        """Numbers of the elastic bodies."""
        return np.flatnonzero(self.disc.shape_of >= 0)

    @cached_property
    def first_node(self) -> Array:
        """Number of the first node of each meshed body, counted through all of them (B,)."""
        counts = np.where(self.disc.shape_of >= 0, np.diff(self.disc.offsets) // self.disc.dim, 0)
        first: Array = np.concatenate([[0], np.cumsum(counts)])[:-1]
        return first

    @cached_property
    def body_of_node(self) -> Array:
        """Body of each node of the meshed bodies (nodes,)."""
        return np.repeat(self.meshed, np.diff(self.disc.offsets)[self.meshed] // self.disc.dim)

    @cached_property
    def node_arm(self) -> Array:
        """Positions (nodes, d) of the nodes of meshed bodies from their centroids, as described [m]."""
        arms = [self.disc.nodes(b) - self.disc.centroids[b] for b in self.meshed.tolist()]
        return np.concatenate([*arms, np.zeros((0, self.disc.dim))])

    def node_place(self, placement: Placement, strain: Array) -> Array:
        """Return where the nodes of meshed bodies are (nodes, d), for strains (nodes, d) [m]."""
        return placement.points(self.body_of_node, self.node_arm + strain)

    @cached_property
    def node_column(self) -> Array:
        """Unknowns (nodes + 1, d) of the nodes of meshed bodies; the last row stands for no node."""
        n, d = self.disc.unknowns, self.disc.dim
        columns = [np.arange(*self.disc.offsets[b : b + 2]).reshape(-1, d) for b in self.meshed.tolist()]
        return np.concatenate([*columns, np.full((1, d), n)]).astype(int)

    @cached_property
    def mass(self) -> Array:
        """Mass that goes with each unknown (N,) [t = kN s2/m]; zero where a body has no weight."""
        model, disc = self.model, self.disc
        mass = np.zeros(disc.unknowns)
        for b in self.free.tolist():
            body = model.bodies[b]
            density = model.materials[body.material].unit_weight / self.gravity
            own = slice(*disc.offsets[b : b + 2])
            if disc.shape_of[b] == RIGID:
                mass[own] = density * body.volume
                if disc.dim == 3:  # in the plane the moment of inertia over the square of the reach is the mass
                    mass[own][disc.dim :] = density * self._principal(b) / disc.reach[b] ** 2
                continue
            nodal = disc.shapes[disc.shape_of[b]].volume_weights
            if nodal.min() <= 0:  # corners of eight-node elements: share the volume equally
                nodal = np.full(nodal.size, nodal.sum() / nodal.size)
            mass[own] = density * np.repeat(nodal, disc.dim)
        return mass

    def _principal(self, b: int) -> Array:
        """Return the principal moments of inertia (3,) of a body in space of density one [m5]."""
        assert self.spin_axes.axes is not None, "bodies in space"
        axes = self.spin_axes.axes[b]
        return np.asarray(np.diagonal(axes.T @ self.model.bodies[b].moments.inertia @ axes))

    @cached_property
    def spin_axes(self) -> SpinAxes:
        """Axes along which the rotations of rigid bodies are unknowns."""
        return SpinAxes.of([body.moments.inertia for body in self.model.bodies])

    @cached_property
    def body_mass(self) -> Array:
        """Mass of each body (B,), zero for fixed ones [t]."""
        mass = np.zeros(len(self.model.bodies))
        for b in self.free.tolist():
            own = self.mass[slice(*self.disc.offsets[b : b + 2])]
            mass[b] = own[0] if self.disc.shape_of[b] == RIGID else own[:: self.disc.dim].sum()
        return mass

    def strength(self, forces: Array) -> float:
        """Return the sum of the sizes of forces (N,) on centroids and nodes, and of moments over the reach [kN].

        It does not depend on the axes of coordinates.
        """
        return float(np.sqrt(np.add.reduceat(forces**2, self._vectors)).sum()) if len(forces) else 0.0

    @cached_property
    def _vectors(self) -> Array:
        """Where among the unknowns forces, and moments, of bodies and nodes begin (k,)."""
        d, first = self.disc.dim, self.disc.offsets
        found = [np.zeros(0, dtype=int)]
        for b, (begin, end) in enumerate(itertools.pairwise(first.tolist())):
            rigid = self.disc.shape_of[b] == RIGID
            found.append(np.array([begin, begin + d]) if rigid else np.arange(begin, end, d))
        return np.concatenate(found)

    @cached_property
    def typical_mass(self) -> float:
        """Mean mass of the bodies that can move; where none has a weight, one that weighs as much as loads [t]."""
        mean = float(self.body_mass[self.free].mean())
        if mean > 0 or not self.loads.groups:
            return mean
        acting = sum(float(np.abs(force).sum()) for force in self.described_loads.values())
        return acting / (self.gravity * len(self.free))

    @cached_property
    def resisting(self) -> BodyMatrices:
        """Masses and stiffnesses, with the typical mass for bodies without weight: what resists in iterations."""
        mass = self.mass.copy()
        for b in self.free.tolist():
            own = slice(*self.disc.offsets[b : b + 2])
            if not self.body_mass[b] > 0:
                nodes = 1 if self.disc.shape_of[b] == RIGID else (own.stop - own.start) // self.disc.dim
                mass[own] = (self.typical_mass or 1.0) / nodes
        return BodyMatrices.of(self.disc, mass, np.zeros(self.disc.unknowns, dtype=bool))

    @cached_property
    def matrices(self) -> BodyMatrices:
        """Masses and stiffnesses."""
        return BodyMatrices.of(self.disc, self.mass, np.zeros(self.disc.unknowns, dtype=bool))

    @cached_property
    def edges(self) -> MovingEdges:
        """The outlines."""
        return MovingEdges.of(self.model.outlines)

    @cached_property
    def solids(self) -> MovingSolids:
        """The surfaces of polyhedra, with the joints of faces whose laws need areas."""
        solids = MovingSolids.of(self.model.polyhedra, surface_nodes(self.disc))
        return replace(
            solids, joints=face_joints(self.model, self.rules, self.detection.patches, solids, self.tolerance)
        )

    @property
    def surface(self) -> MovingEdges | MovingSolids:
        """Outlines or surfaces that move with their bodies."""
        return self.edges if self.disc.dim == 2 else self.solids

    @cached_property
    def joint_numbers(self) -> Mapping[tuple[int, int], int]:
        """Number of the first joint as described between two bodies, the lower number first."""
        found: dict[tuple[int, int], int] = {}
        for k, face in enumerate(self.detection.faces):
            found.setdefault((min(face.a, face.b), max(face.a, face.b)), k)
        return found

    @cached_property
    def laws(self) -> LawTable:
        """The joint laws."""
        return LawTable.of(self.model)

    @cached_property
    def rules(self) -> RuleBook:
        """Which law holds between which bodies."""
        return RuleBook(self.model)

    @cached_property
    def loads(self) -> MovingLoads:
        """The loads."""
        return MovingLoads(self.disc, self.spin_axes)

    @cached_property
    def described_loads(self) -> dict[str, Array]:
        """Forces of each load group (N,) where the bodies were described [kN]."""
        here, groups = self.at_rest().placement.turns, self.loads.groups
        return {group: self.loads.forces({g: float(g == group) for g in groups}, here) for group in groups}

    @cached_property
    def tolerance(self) -> float:
        """Distance within which edges as described touch [m]."""
        return default_tolerance(self.model)

    @cached_property
    def drawn(self) -> Mapping[tuple[int, int], tuple[float, float]]:
        """Joints as described, by their two edges, with the distances at both ends that count as none [m]."""
        edges = self.edges
        number = {(int(b), int(k)): e for e, (b, k) in enumerate(zip(edges.body, edges.number, strict=True))}
        found = {}
        for face in self.detection.segments:
            ends = tuple(float(g) if abs(g) <= self.tolerance else 0.0 for g in face.signed_gap)
            found[number[face.a, face.edge_a], number[face.b, face.edge_b]] = (ends[0], ends[1])
        return found

    def at_rest(self) -> Configuration:
        """Return the configuration in which the model was described."""
        return Configuration(self, Placement.at_rest(self.disc.centroids), np.zeros_like(self.node_arm))


def refuse_in_space(model: Model) -> None:
    """Refuse what motion in space does not compute: joints that dilate."""
    if model.dim == 2:
        return
    for name, law in model.laws.items():
        if law.dilatancy:
            msg = f"joint '{name}' dilates; in space joints of blocks that move do not"
            raise InputError(msg, hint="leave out dilatancy")


def refuse_elastic_joints(reference: Reference) -> None:
    """Refuse joints of elastic blocks that move in space whose laws need areas: nodes have none."""
    model, patches = reference.model, reference.detection.patches
    if model.dim == 2 or not len(reference.meshed) or not patches:
        return
    a, b = np.array([(p.a, p.b) for p in patches]).T
    law, laws = reference.rules.find(a, b)[0], list(model.laws.items())
    needs = np.array([needs_area(own) for _, own in laws])[law]
    elastic = reference.disc.shape_of >= 0
    for k in np.flatnonzero(needs & (elastic[a] | elastic[b])).tolist():
        block, name = model.bodies[a[k] if elastic[a[k]] else b[k]].name, laws[law[k]][0]
        msg = f"joint '{name}' of the elastic block '{block}' has stiffness, cohesion or strength; in space joints of "
        hint = 'give the joint a law with friction alone, or the block kind = "rigid"'
        raise InputError(msg + "elastic blocks that move have friction alone", hint=hint)


@dataclass(frozen=True, eq=False)
class Configuration:
    """Where the bodies of a reference stand.

    Parameters
    ----------
    reference : Reference
    placement : Placement
        Centroid and rotation of every body, fixed ones included.
    strain : (nodes, d) array
        Displacement of each node of the meshed bodies in the frame of its body, on top of the placement [m].
    """

    reference: Reference
    placement: Placement
    strain: Array

    def vertices(self, b: int) -> Array:
        """Return the vertices (n, d) of a body as described, moved with it [m]."""
        return self._placed(b, self.reference.model.bodies[b].vertices)

    def outline(self, b: int) -> Array:
        """Return the outline (n, 2) of a body, without its strains [m]."""
        return self._placed(b, self.reference.model.outlines[b].outline)

    def _placed(self, b: int, ring: Array) -> Array:
        arm = ring - self.reference.disc.centroids[b]
        return self.placement.points(np.full(len(arm), b), arm)

    def rings(self, b: int) -> tuple[Array, ...]:
        """Return outline and holes (n, 2) of a body where it stands, strains included [m]."""
        reference = self.reference
        rings = reference.model.outlines[b].rings
        if reference.disc.shape_of[b] < 0:
            return tuple(self._placed(b, ring) for ring in rings)
        nodes = self.nodes(b)
        sides = iter(reference.disc.shapes[reference.disc.shape_of[b]].edges)
        return tuple(nodes[np.concatenate([next(sides).nodes[:-1] for _ in ring])] for ring in rings)

    def bodies(self) -> tuple[Body, ...]:
        """Return the bodies where they stand, without their strains."""
        bodies = self.reference.model.outlines
        return tuple(
            replace(
                body, outline=self.outline(b), holes=tuple(self._placed(b, hole) for hole in body.holes), grid=None
            )
            for b, body in enumerate(bodies)
        )  # fmt: skip

    def detect(self) -> Detection:
        """Return the interfaces of the bodies where they stand."""
        model = self.reference.model
        return detect_interfaces(self.bodies(), tolerance=self.reference.tolerance, reach=model.gap_reach)

    def nodes(self, b: int) -> Array:
        """Return the nodes (n, 2) of a body, strains included; outline vertices of a rigid or fixed one [m]."""
        reference = self.reference
        if reference.disc.shape_of[b] < 0:
            return self.outline(b)
        first = reference.first_node[b]
        own = slice(first, first + len(reference.disc.nodes(b)))
        arm = reference.node_arm[own] + self.strain[own]
        return self.placement.points(np.full(len(arm), b), arm)

    def displacement(self) -> Array:
        """Return the displacements (N,) of all unknowns; rotations of rigid bodies as angles times reach."""
        reference, disc = self.reference, self.reference.disc
        u = np.zeros(disc.unknowns)
        moved = self.placement.centre - disc.centroids
        for b in reference.free.tolist():
            own = slice(*disc.offsets[b : b + 2])
            if disc.shape_of[b] == RIGID:
                turn = self.placement.rotation[b]
                u[own] = [*moved[b], *np.atleast_1d(turn if disc.dim == 2 else rotation_vector(turn)) * disc.reach[b]]
            else:
                u[own] = (self.nodes(b) - disc.nodes(b)).ravel()
        return u
