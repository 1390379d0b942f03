r"""Velocities as unknowns, frames of elastic bodies, and the right-hand side of a step.

Unknowns of a rigid body are the velocity of its centroid and reach times its spin, in space along its principal axes
(:mod:`concio.kinematics.spins`), of a meshed one the velocities of its nodes in its own frame. The
frame turns with the rotation that fits the nodes best in mass; in it the strain d grows by what is left of their
velocities. An implicit stiffness acts on all of the velocity; the part of it that only turns the strained body along,
K J d omega, is taken out. Forces K d have no moment about the strained body:
what they have is taken out in proportion to mass and arm.
"""

from __future__ import annotations

import numpy as np

from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.contact.reference import Reference
from concio.kinematics.frames import cross, dot
from concio.kinematics.rigid import motions, swept
from concio.kinematics.spins import gyroscopic
from concio.kinematics.turns import Turns

Array = np.ndarray


class Frames:
    """Bodies of a reference as unknowns of a step.

    Parameters
    ----------
    reference : Reference
    scheme : Scheme
    """

    def __init__(self, reference: Reference, scheme: Scheme) -> None:
        self.reference, self.scheme = reference, scheme
        disc = reference.disc
        self.n, self.count = disc.unknowns, len(reference.model.bodies)
        self.rigid, self.meshed = reference.rigid, reference.meshed
        d = disc.dim
        self.axes, self.reach = reference.spin_axes, disc.reach[self.rigid][:, None]
        self.centres = disc.offsets[self.rigid][:, None] + np.arange(d)
        self.turns = disc.offsets[self.rigid][:, None] + np.arange(d, motions(d))
        self.nodes = reference.node_column[:-1]
        self.body, self.arm, self.mass = reference.body_of_node, reference.node_arm, reference.mass
        self.node_mass = reference.mass[self.nodes[:, 0]]
        self._weight = reference.resisting.mass[self.nodes[:, 0]]  # frames of bodies without mass move with their nodes
        total = np.bincount(self.body, self._weight, self.count) if len(self.body) else np.zeros(self.count)
        self._share = self._weight / total[self.body] if len(self.body) else self._weight

    @property
    def elastic(self) -> bool:
        """Whether any body deforms."""
        return len(self.nodes) > 0

    @property
    def places(self) -> Array:
        """Unknowns (k, d) that are displacements of centroids of rigid bodies and of nodes."""
        return np.concatenate([self.centres, self.nodes])

    # -- velocities ----------------------------------------------------------------------------------------------------

    def unknowns(
        self, velocity: Array, spin: Array, nodal: Array, turn: Turns, frames: Turns | None = None
    ) -> Array:
        """Return velocities of centroids (B, d), spins and velocities of nodes (nodes, d) as unknowns (N,).

        Nodes have theirs in ``frames``, if these stand elsewhere than rigid bodies.
        """
        x = np.empty(self.n)
        x[self.centres] = velocity[self.rigid]
        x[self.turns] = self.reach * self.axes.own(spin[self.rigid], self.rigid, turn)
        if self.elastic:
            x[self.nodes] = (frames or turn)[self.body].undo(nodal)
        return x

    def rigid_part(self, x: Array, velocity: Array, spin: Array, turn: Turns) -> tuple[Array, Array]:
        """Return velocities of centroids (B, d) and spins with those of rigid bodies taken from unknowns (N,).

        Spins are (B,) in the plane and (B, 3) in space, where ``turn`` says how the bodies stand.
        """
        velocity, spin = velocity.copy(), spin.copy()
        velocity[self.rigid] = x[self.centres]
        spin[self.rigid] = self.axes.outward(x[self.turns] / self.reach, self.rigid, turn)
        return velocity, spin

    def gyroscopic(self, x: Array) -> Array:
        """Return the gyroscopic forces (N,) on the rotations of rigid bodies with velocities x (N,) [kN]."""
        f = np.zeros(self.n)
        inertia = self.mass[self.turns] * self.reach**2
        f[self.turns] = gyroscopic(inertia, x[self.turns] / self.reach) / self.reach
        return f

    def nodal(self, x: Array, turn: Turns) -> Array:
        """Return the velocities of nodes (nodes, d) from unknowns (N,)."""
        return turn[self.body].apply(x[self.nodes])

    def mean(self, nodal: Array) -> Array:
        """Return means in mass (B, d) of nodal vectors (nodes, d)."""
        return np.stack([np.bincount(self.body, self._share * v, self.count) for v in nodal.T], axis=1)

    def fit(self, nodal: Array, place: Array) -> tuple[Array, Array]:
        """Return velocity of the frames' origins (B, d) and spin that fit nodal velocities best in mass.

        The spin is (B,) in the plane and (B, 3) in space.

        Parameters
        ----------
        nodal, place : (nodes, d) arrays
            Velocities, and positions from the origins.
        """
        middle, velocity = self.mean(place), self.mean(nodal)
        r, w = place - middle[self.body], nodal - velocity[self.body]
        spin = self._spun(r, self._weight[:, None] * w)
        return velocity - swept(spin, middle), spin

    def rate(self, nodal: Array, place: Array, turn: Turns) -> tuple[Array, Array, Array]:
        """Return the rate of strain (nodes, d) in the frames, and the frames' velocity and spin."""
        velocity, spin = self.fit(nodal, place)
        b = self.body
        return turn[b].undo(nodal - velocity[b] - swept(spin[b], place)), velocity, spin

    def _spun(self, arm: Array, momentum: Array) -> Array:
        """Return the spins, (B,) or (B, 3), with which nodes at arms have momenta, (nodes, d) each, about their mean.

        Bodies without nodes have none.
        """
        moment, square = self._sums(cross(arm, momentum)), self._sums(self._weight * dot(arm, arm))
        own = square > 0
        if arm.shape[1] == 2:
            return moment / np.where(own, square, 1.0)
        spin = np.zeros((self.count, 3))
        product = self._sums(self._weight[:, None, None] * arm[:, :, None] * arm[:, None])
        inertia = square[own, None, None] * np.eye(3) - product[own]
        spin[own] = np.linalg.solve(inertia, moment[own][:, :, None])[:, :, 0]
        return spin

    def _sums(self, nodal: Array) -> Array:
        """Return the sums (B, ...) over the nodes of each body of what nodes have (nodes, ...)."""
        flat = nodal.reshape(len(nodal), -1).T
        found = [np.bincount(self.body, one, self.count) for one in flat]
        return np.stack(found, axis=-1).reshape(self.count, *nodal.shape[1:])

    # -- forces --------------------------------------------------------------------------------------------------------

    def stiffness(self, strain: Array) -> Array:
        """Return K d (N,) of strains d (nodes, d)."""
        u = np.zeros(self.n)
        u[self.nodes] = strain
        return self.reference.matrices.stiffness(u)

    def strain_energy(self, strain: Array) -> float:
        """Return the energy stored in elastic bodies [kN m]."""
        if not self.elastic:
            return 0.0
        return 0.5 * float((self.stiffness(strain)[self.nodes] * strain).sum())

    def kinetic_energy(self, x: Array) -> float:
        """Return the kinetic energy of unknowns (N,) [kN m]."""
        return 0.5 * float(self.mass @ (x * x))

    def loads(self, drive: Drive, turn: Turns) -> Array:
        """Return the loads on the unknowns (N,) [kN]."""
        reference = self.reference
        return reference.loads.forces(drive.factors, turn) if reference.loads.groups else np.zeros(self.n)

    def ground(self, drive: Drive, turn: Turns) -> Array:
        """Return what bodies feel of the acceleration of the ground (N,) [kN]."""
        f = np.zeros(self.n)
        if drive.ground.any():
            f[self.centres] = -self.mass[self.centres] * drive.ground
            if self.elastic:
                local = turn[self.body].undo(np.broadcast_to(drive.ground, self.nodes.shape))
                f[self.nodes] = -self.node_mass[:, None] * local
        return f

    def internal(self, state: MotionState, h: float, strain: Array, x0: Array, x1: Array, turn: Turns) -> Array:
        """Return what elasticity and damping add to the right-hand side (N,) [kN].

        With the velocities of the end the elastic energy grows by the work of these forces exactly.

        Parameters
        ----------
        state : MotionState
            At the beginning.
        h : float
            [s].
        strain : (nodes, d) array
            In the middle of the step [m].
        x0, x1 : (N,) arrays
            Velocities at the beginning and at the end.
        turn : Turns
            Of all bodies in the middle.
        """
        s = self.scheme
        theta, d, grows = s.theta, state.strain, h * s.theta + s.stiffness_damping
        place = turn[self.body].apply(self.arm + strain)
        rate, _, _ = self.rate(self.nodal(x0, turn), place, turn)
        ends, _, spin = self.rate(self.nodal(x1, turn), place, turn)
        own = spin[self.body]
        turned = grows * theta * swept(own if own.ndim == 1 else turn[self.body].undo(own), strain)
        b = -self.stiffness(d + grows * (1 - theta) * rate - turned)
        b -= self.turned(self.stiffness(d + grows * ((1 - theta) * rate + theta * ends)), strain)
        if s.mass_damping:
            b[self.nodes] -= s.mass_damping * (1 - theta) * self.node_mass[:, None] * x0[self.nodes]
        return b

    def turned(self, force: Array, strain: Array) -> Array:
        """Return the forces (N,), in proportion to mass and arm, that undo the moment of ``force`` (N,)."""
        b, r = self.body, self.arm + strain
        r = r - self.mean(r)[b]
        share = self._spun(r, force[self.nodes])
        undone = np.zeros(self.n)
        undone[self.nodes] = -self._weight[:, None] * swept(share[b], r)
        return undone
