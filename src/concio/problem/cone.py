r"""The joint law: the forces a contact pair may carry, and everything that follows from that set alone.

A pair carries forces of its *strength domain*

.. math:: S = \{(t_n, t_t): -T \le t_n \le N, \; |t_t| \le c + \mu t_n\},

Coulomb's cone, truncated by the tensile strength ``T`` and the cap ``N``. Every room that needs friction takes it from
here: the certificate, the engine, the programmes of statics, the iterative methods, load paths.

*Return map* with flow parameter ``kappa``: the force ``t`` in ``S`` of a trial force ``w``,

.. math::

    t_t = w_t - e\,w_t/|w_t|, \qquad t_n = \mathrm{clip}(w_n + \kappa\,e), \qquad e = (|w_t| - c - \mu t_n)_+

in closed form. ``e`` is the slip (times a stiffness), so ``kappa`` is the dilatancy:

* ``kappa = 0``: normal force first, then friction on the disc of that normal force. This is the map of the augmented
  Lagrangian of Alart and Curnier (Comput. Methods Appl. Mech. Engrg. 92, 1991, 353-375); it is not a projection, its
  derivative is not symmetric: Coulomb friction has no energy.
* ``kappa = mu``: the Euclidean projection onto ``S``, which the bipotential of De Saxcé and Feng (Mech. Struct. Mach.
  19, 1991, 301-325) uses after shifting the gap by ``mu |y_t|``.
* ``mu = 0`` and a given ``c``: Tresca friction, a projection again.

*Support function*: in a motion with relative velocity ``w`` no force of ``S`` takes more power than

.. math:: h = c|w_t| + T (w_n - \mu|w_t|)^+ + N (w_n - \mu|w_t|)^-,

since ``-t.w <= (c + mu t_n)|w_t| - t_n w_n`` (:mod:`concio.solvers.statics.existence`).

Dimension 2 and 3 alike: tangential arrays are (m, d-1).
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from concio.problem.tolerances import SMOOTH
from concio.representation import short_repr

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
class Cone:
    """Strength domains of ``m`` pairs.

    Parameters
    ----------
    friction : (m,) array
        mu >= 0.
    cohesion : (m,) array
        c >= mu T [kN].
    tension : (m,) array
        T >= 0 [kN].
    cap : (m,) array
        N, ``inf`` where there is none [kN].
    """

    friction: Array
    cohesion: Array
    tension: Array
    cap: Array

    def __getitem__(self, pick: Array | slice) -> Cone:
        return Cone(self.friction[pick], self.cohesion[pick], self.tension[pick], self.cap[pick])

    def followed_by(self, other: Cone) -> Cone:
        """Return these domains and, behind them, those of other pairs."""
        both = (np.concatenate([getattr(self, f.name), getattr(other, f.name)]) for f in fields(self))
        return Cone(*both)

    # -- what a pair can do -----------------------------------------------------------------------------------------

    @cached_property
    def rough(self) -> Array:
        """Pairs that can carry friction at all, (m,) booleans; coefficients below ``SMOOTH`` count as none."""
        rough: Array = (self.friction > SMOOTH) | (self.cohesion > 0)
        return rough

    @cached_property
    def plain(self) -> bool:
        """Whether every pair has friction only: no strength without compression, no cap."""
        return not (self.cohesion.any() or self.tension.any() or self.capped.any())

    @cached_property
    def capped(self) -> Array:
        """Pairs with a cap, (m,) booleans."""
        capped: Array = np.isfinite(self.cap)
        return capped

    @cached_property
    def spare(self) -> Array:
        """Sliding strength c - mu T left to a pair that is pulled open, (m,) [kN]; zero where it is rounding."""
        left = self.cohesion - self.friction * self.tension
        return np.where(left > SMOOTH * self.cohesion, left, 0.0)

    def strength(self, t_n: Array) -> Array:
        """Return the sliding strength c + mu t_n (m,) [kN], never below zero."""
        strength: Array = np.maximum(self.linear_strength(t_n), 0.0)
        return strength

    def linear_strength(self, t_n: Array, *, rate: bool = False) -> Array:
        """Return c + mu t_n (m,) [kN] even below zero, for iterates outside; with ``rate`` its rate, mu t_n."""
        share: Array = self.friction * t_n
        return share if rate else self.cohesion + share

    def excess(self, t_n: Array, t_t: Array) -> Array:
        """Return how far forces t_n (m,) and t_t (m, d-1) lie outside, (m,) [kN]: beyond strength, T or N."""
        beyond = [np.linalg.norm(t_t, axis=1) - self.strength(t_n), -(t_n + self.tension), t_n - self.cap]
        excess: Array = np.maximum(np.maximum.reduce(beyond), 0.0)
        return excess

    def opposing(self, t_n: Array, slip: Array) -> Array:
        """Return the friction forces (m, d-1) [kN] that oppose slips (m, d-1) of any size; zero without slip."""
        size = np.linalg.norm(slip, axis=1)
        opposing: Array = -(self.strength(t_n) / np.where(size > 0, size, 1.0))[:, None] * slip
        return opposing

    # -- return map ---------------------------------------------------------------------------------------------------

    def project(self, w: Array, flow: Array | float | None = None) -> Array:
        """Return the forces (m, d) of trial forces ``w`` (m, d), normal component first.

        Parameters
        ----------
        w : (m, d) array
        flow : (m,) array or float, optional
            Flow parameter kappa; by default mu, the Euclidean projection.
        """
        kappa = self.friction if flow is None else flow
        w_n, size = w[:, 0], np.linalg.norm(w[:, 1:], axis=1)
        t_n = np.clip(w_n, -self.tension, self.cap)
        slips = size > self.strength(t_n)
        flowing = (w_n + kappa * (size - self.cohesion)) / (1.0 + kappa * self.friction)
        t_n = np.where(slips, np.clip(flowing, -self.tension, self.cap), t_n)
        factor = np.where(slips, self.strength(t_n) / np.where(slips, size, 1.0), 1.0)
        return np.column_stack([t_n, factor[:, None] * w[:, 1:]])

    def derivative(self, w: Array, flow: Array | float | None = None) -> Array:
        """Return an element of the generalised derivative of :meth:`project`, shape (m, d, d)."""
        m, d = w.shape
        kappa = np.broadcast_to(np.asarray(self.friction if flow is None else flow, dtype=float), (m,))
        low, high = -self.tension, self.cap
        w_n, size = w[:, 0], np.linalg.norm(w[:, 1:], axis=1)
        t_n = np.clip(w_n, low, high)
        slips = size > self.strength(t_n)
        direction = w[:, 1:] / np.where(size > 0, size, 1.0)[:, None]
        scale = 1.0 / (1.0 + kappa * self.friction)
        flowing = (w_n + kappa * (size - self.cohesion)) * scale
        free = np.where(slips, (flowing > low) & (flowing < high), (w_n > low) & (w_n < high))
        slides = np.where(slips, free * scale, 0.0)
        t_n = np.where(slips, np.clip(flowing, low, high), t_n)
        jacobian = np.zeros((m, d, d))
        jacobian[:, 0, 0] = np.where(slips, slides, free)
        jacobian[:, 0, 1:] = (slides * kappa)[:, None] * direction
        jacobian[:, 1:, 0] = (slides * self.friction)[:, None] * direction
        turn = np.where(slips, self.strength(t_n) / np.where(slips, size, 1.0), 0.0)
        along = slides * kappa * self.friction - turn
        jacobian[:, 1:, 1:] = along[:, None, None] * direction[:, :, None] * direction[:, None, :]
        jacobian[:, 1:, 1:] += np.where(slips, turn, 1.0)[:, None, None] * np.eye(d - 1)
        if d == 2:
            jacobian[:, 1, 1] = np.where(slips, slides * kappa * self.friction, 1.0)
        return jacobian

    # -- power --------------------------------------------------------------------------------------------------------

    def lift(self, w_n: Array, speed: Array) -> Array:
        """Return w_n - mu |w_t| (m,): how much faster a pair opens than associated flow would open it."""
        lift: Array = w_n - self.friction * speed
        return lift

    def absorbed_power(self, w_n: Array, speed: Array) -> Array:
        """Return the support function h (m,), the most a pair can absorb at opening rate w_n and speed |w_t|.

        Where a pair without cap comes closer than associated flow lets it, h is infinite; what is returned leaves that
        share out, for the caller to measure as a violation.
        """
        lift = self.lift(w_n, speed)
        crush = np.where(self.capped, np.where(self.capped, self.cap, 0.0) * np.maximum(-lift, 0.0), 0.0)
        power: Array = self.cohesion * speed + self.tension * np.maximum(lift, 0.0) + crush
        return power

    # -- other cones --------------------------------------------------------------------------------------------------

    @cached_property
    def shifted(self) -> Cone:
        """The same domains read in p = t_n + T >= 0: no tension, cohesion c - mu T, cap N + T."""
        return Cone(self.friction, self.spare, np.zeros_like(self.tension), self.cap + self.tension)

    def in_units(self, force: float) -> Cone:
        """Return the domains with forces divided by ``force``."""
        return Cone(self.friction, self.cohesion / force, self.tension / force, self.cap / force)

    def tresca(self, strength: Array) -> Cone:
        """Return the domains with the sliding strength held at ``strength`` (m,)."""
        return replace(self, friction=np.zeros_like(strength), cohesion=strength)
