r"""Velocities as unknowns, frames of elastic bodies, and the right-hand side of a step.

Unknowns of a rigid body are (v_x, v_y, reach omega), of a meshed one the velocities of its nodes in its own frame. The
frame turns with the rotation that fits the nodes best in mass; in it the strain d grows by what is left of their
velocities. An implicit stiffness acts on all of the velocity; the part of it that only turns the strained body along,
K J d omega, is taken out with the angular velocity at the beginning. Forces K d have no moment about the strained body:
what they have is taken out in proportion to mass and arm.
"""

from __future__ import annotations

import numpy as np

from concio.analysis.motion.scheme import Drive, Scheme
from concio.analysis.motion.state import MotionState
from concio.contact.moving.edges import as_complex, dot
from concio.contact.moving.reference import Reference

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
        self.x, self.reach = disc.offsets[self.rigid], disc.reach[self.rigid]
        self.y, self.turn = self.x + 1, self.x + 2
        self.node_x = reference.node_column[:-1, 0]
        self.node_y = self.node_x + 1
        self.body = reference.body_of_node
        self.arm = as_complex(reference.node_arm)
        self.mass = reference.mass
        self.node_mass = reference.mass[self.node_x]
        body_mass = np.bincount(self.body, self.node_mass, self.count) if len(self.body) else np.zeros(self.count)
        self._share = self.node_mass / body_mass[self.body] if len(self.body) else self.node_mass

    @property
    def elastic(self) -> bool:
        """Whether any body deforms."""
        return len(self.node_x) > 0

    # -- velocities ----------------------------------------------------------------------------------------------------

    def unknowns(self, velocity: Array, spin: Array, nodal: Array, turn: Array) -> Array:
        """Return velocities, complex (B,), (B,) and complex (nodes,), as unknowns (N,)."""
        x = np.empty(self.n)
        v = velocity[self.rigid]
        x[self.x], x[self.y], x[self.turn] = v.real, v.imag, self.reach * spin[self.rigid]
        if self.elastic:
            local = np.conj(turn[self.body]) * nodal
            x[self.node_x], x[self.node_y] = local.real, local.imag
        return x

    def rigid_part(self, x: Array, velocity: Array, spin: Array) -> tuple[Array, Array]:
        """Return velocities of centroids (B,) and spins (B,) with those of rigid bodies taken from unknowns (N,)."""
        velocity, spin = velocity.copy(), spin.copy()
        velocity[self.rigid] = x[self.x] + 1j * x[self.y]
        spin[self.rigid] = x[self.turn] / self.reach
        return velocity, spin

    def nodal(self, x: Array, turn: Array) -> Array:
        """Return the velocities of nodes, complex (nodes,), from unknowns (N,)."""
        return np.asarray(turn[self.body] * (x[self.node_x] + 1j * x[self.node_y]))

    def mean(self, z: Array) -> Array:
        """Return means in mass (B,) of complex nodal values."""
        weighted = self._share * z
        re, im = np.bincount(self.body, weighted.real, self.count), np.bincount(self.body, weighted.imag, self.count)
        return np.asarray(re + 1j * im)

    def fit(self, nodal: Array, place: Array) -> tuple[Array, Array]:
        """Return velocity of the frames' origins, complex (B,), and spin (B,) that fit nodal velocities best in mass.

        Parameters
        ----------
        nodal, place : (nodes,) complex arrays
            Velocities, and positions from the origins.
        """
        middle, velocity = self.mean(place), self.mean(nodal)
        r, w = place - middle[self.body], nodal - velocity[self.body]
        inertia = np.bincount(self.body, self.node_mass * (r.real**2 + r.imag**2), self.count)
        moment = np.bincount(self.body, self.node_mass * (r.real * w.imag - r.imag * w.real), self.count)
        spin = moment / np.where(inertia > 0, inertia, 1.0)
        return velocity - 1j * spin * middle, spin

    def rate(self, nodal: Array, place: Array, turn: Array) -> tuple[Array, Array, Array]:
        """Return the rate of strain, complex (nodes,), in the frames, and the frames' velocity and spin."""
        velocity, spin = self.fit(nodal, place)
        b = self.body
        rate = np.conj(turn[b]) * (nodal - velocity[b] - 1j * spin[b] * place)
        return rate, velocity, spin

    # -- forces --------------------------------------------------------------------------------------------------------

    def stiffness(self, d: Array) -> Array:
        """Return K d (N,) of complex strains (nodes,)."""
        u = np.zeros(self.n)
        u[self.node_x], u[self.node_y] = d.real, d.imag
        return self.reference.matrices.stiffness(u)

    def strain_energy(self, d: Array) -> float:
        """Return the energy stored in elastic bodies [kN m]."""
        if not self.elastic:
            return 0.0
        force = self.stiffness(d)
        return 0.5 * float(force[self.node_x] @ d.real + force[self.node_y] @ d.imag)

    def kinetic_energy(self, x: Array) -> float:
        """Return the kinetic energy of unknowns (N,) [kN m]."""
        return 0.5 * float(self.mass @ (x * x))

    def loads(self, drive: Drive, turn: Array) -> Array:
        """Return the loads on the unknowns (N,) [kN]."""
        reference = self.reference
        return reference.loads.forces(drive.factors, turn) if reference.loads.groups else np.zeros(self.n)

    def ground(self, drive: Drive, turn: Array) -> Array:
        """Return what bodies feel of the acceleration of the ground (N,) [kN]."""
        f = np.zeros(self.n)
        ax, ay = drive.ground
        if ax or ay:
            f[self.x], f[self.y] = -self.mass[self.x] * ax, -self.mass[self.y] * ay
            if self.elastic:
                local = np.conj(turn[self.body]) * complex(ax, ay)
                f[self.node_x], f[self.node_y] = -self.node_mass * local.real, -self.node_mass * local.imag
        return f

    def internal(self, state: MotionState, h: float, rate: Array, strain: Array, spin: Array, x0: Array) -> Array:
        """Return what elasticity and damping add to the right-hand side (N,) [kN].

        Parameters
        ----------
        state : MotionState
        h : float
        rate, strain : (nodes,) complex arrays
            Rate of strain at the beginning, strain in the middle of the step.
        spin : (B,) array
        x0 : (N,) array
            Velocities at the beginning.
        """
        s = self.scheme
        theta, beta, d = s.theta, s.stiffness_damping, as_complex(state.strain)
        turned = (h * theta**2 + beta * theta) * 1j * spin[self.body] * strain
        b = -self.stiffness(d + (h * theta + beta) * (1 - theta) * rate - turned)
        b -= self.turned(self.stiffness(d + (h * theta + beta) * rate), strain)
        if s.mass_damping:
            for at in (self.node_x, self.node_y):
                b[at] -= s.mass_damping * (1 - theta) * self.node_mass * x0[at]
        return b

    def turned(self, force: Array, strain: Array) -> Array:
        """Return the forces (N,), in proportion to mass and arm, that undo the moment of ``force`` (N,)."""
        b, f, r = self.body, force[self.node_x] + 1j * force[self.node_y], self.arm + strain
        r = r - self.mean(r)[b]
        moment = np.bincount(b, r.real * f.imag - r.imag * f.real, self.count)
        inertia = np.bincount(b, self.node_mass * dot(r, r), self.count)
        share = (moment / np.where(inertia > 0, inertia, 1.0))[b] * self.node_mass * 1j * r
        undone = np.zeros(self.n)
        undone[self.node_x], undone[self.node_y] = -share.real, -share.imag
        return undone
