r"""The strength domain of a contact pair and the return map onto it, shared by every augmented method.

A pair may carry the forces of

.. math:: S = \{(t_n, t_t): -T \le t_n \le N, \; |t_t| \le c + \mu t_n\}

(a cone for plain Coulomb friction, truncated by tensile strength ``T`` and cap ``N``). Given a trial force ``w``,
the *return map* with flow parameter ``kappa`` gives the force ``t`` in ``S`` of

.. math::

    t_t = w_t - e\,w_t/|w_t|, \qquad t_n = \mathrm{clip}(w_n + \kappa\,e), \qquad e = (|w_t| - c - \mu t_n)_+

in closed form. ``e`` is the slip (times a stiffness), so ``kappa`` is the dilatancy:

* ``kappa = 0``: normal force first, then friction on the disc of that normal force. This is the map of the augmented
  Lagrangian of Alart and Curnier (Comput. Methods Appl. Mech. Engrg. 92, 1991, 353-375); it is no projection, its
  derivative is not symmetric: Coulomb friction has no energy.
* ``kappa = mu``: the Euclidean projection onto ``S``, which the bipotential of De Saxcé and Feng (Mech. Struct. Mach.
  19, 1991, 301-325) uses after shifting the gap by ``mu |y_t|``.
* ``mu = 0`` and a given ``c``: Tresca friction, a projection again.

Dimension 2 and 3 alike: tangential arrays are (m, d-1).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.contact_problem import Array


@dataclass(frozen=True, eq=False)
class Cone:
    """Strength domains of ``m`` pairs.

    Parameters
    ----------
    friction, cohesion : (m,) array
        mu and c.
    lower, upper : (m,) array
        -T and N, the least and the largest normal force.
    """

    friction: Array
    cohesion: Array
    lower: Array
    upper: Array

    def tresca(self, radius: Array) -> Cone:
        """Return the domains with the sliding strength held at ``radius`` (m,)."""
        return replace(self, friction=np.zeros_like(radius), cohesion=radius)

    def radius(self, t_n: Array) -> Array:
        """Sliding strength c + mu t_n, never below zero."""
        strength: Array = np.maximum(self.cohesion + self.friction * t_n, 0.0)
        return strength


def return_map(cone: Cone, w: Array, kappa: Array | float) -> Array:
    """Return the force of the trial force ``w``.

    Parameters
    ----------
    cone : Cone
    w : (m, d) array
        Trial force, normal component first.
    kappa : (m,) array or float
        Flow parameter: 0 Alart-Curnier, ``cone.friction`` Euclidean projection.
    """
    w_n, size = w[:, 0], np.linalg.norm(w[:, 1:], axis=1)
    t_n = np.clip(w_n, cone.lower, cone.upper)
    slips = size > cone.radius(t_n)
    flow = (w_n + kappa * (size - cone.cohesion)) / (1.0 + kappa * cone.friction)
    t_n = np.where(slips, np.clip(flow, cone.lower, cone.upper), t_n)
    factor = np.where(slips, cone.radius(t_n) / np.where(slips, size, 1.0), 1.0)
    return np.column_stack([t_n, factor[:, None] * w[:, 1:]])


def return_map_derivative(cone: Cone, w: Array, kappa: Array | float) -> Array:
    """Return an element of the generalised derivative of :func:`return_map`, shape (m, d, d)."""
    m, d = w.shape
    kappa = np.broadcast_to(np.asarray(kappa, dtype=float), (m,))
    w_n, size = w[:, 0], np.linalg.norm(w[:, 1:], axis=1)
    t_n = np.clip(w_n, cone.lower, cone.upper)
    slips = size > cone.radius(t_n)
    direction = w[:, 1:] / np.where(size > 0, size, 1.0)[:, None]
    scale = 1.0 / (1.0 + kappa * cone.friction)
    flow = (w_n + kappa * (size - cone.cohesion)) * scale
    free = np.where(slips, (flow > cone.lower) & (flow < cone.upper), (w_n > cone.lower) & (w_n < cone.upper))
    slides = np.where(slips, free * scale, 0.0)
    t_n = np.where(slips, np.clip(flow, cone.lower, cone.upper), t_n)
    jacobian = np.zeros((m, d, d))
    jacobian[:, 0, 0] = np.where(slips, slides, free)
    jacobian[:, 0, 1:] = (slides * kappa)[:, None] * direction
    jacobian[:, 1:, 0] = (slides * cone.friction)[:, None] * direction
    turn = np.where(slips, cone.radius(t_n) / np.where(slips, size, 1.0), 0.0)
    along = slides * kappa * cone.friction - turn
    jacobian[:, 1:, 1:] = along[:, None, None] * direction[:, :, None] * direction[:, None, :]
    jacobian[:, 1:, 1:] += np.where(slips, turn, 1.0)[:, None, None] * np.eye(d - 1)
    if d == 2:
        jacobian[:, 1, 1] = np.where(slips, slides * kappa * cone.friction, 1.0)
    return jacobian
