r"""Equilibrium of the bodies when the contact forces are a return map of the displacements.

With multipliers ``lam`` and augmentation ``rho`` (forces per length, one for each component) the contact forces are

.. math:: t(u) = P\bigl(r\,(\lambda/\rho - x - C u - s)\bigr), \qquad 1/r = 1/\rho + a,

``P`` the return map of :mod:`concio.problem.cone`, ``a`` the compliance of the joint, ``s`` a shift of the gap.
``lam = 0`` is the penalty method; ``lam = t(u)`` is the exact joint law. :func:`equilibrium` solves
``K u = f + C' t(u)`` by semismooth Newton steps; the matrix ``K + C' P' r C`` is regular as soon as closed pairs hold
each body, also where K is singular, and a vanishing proximal term covers bodies nothing holds.

Where ``P`` is a projection the equation is the gradient of a convex function (the augmented Lagrangian), and the line
search on that function makes the steps converge from anywhere. Coulomb friction proper has no such function; the
methods of this module's users reach it through a sequence of convex problems.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.methods.iterative.iteration import Record

LARGEST = 1e3
"""Augmentation beyond which multipliers are not helped by more, in multiples of the typical stiffness."""

UPDATES = 30
"""Largest number of updates of the multipliers for one convex problem."""

ROUNDING = 1e-8
"""Imbalance over the load below which steps that no longer help are rounding at work."""


@dataclass(frozen=True, eq=False)
class Augmented:
    """Contact forces as a function of displacements.

    Parameters
    ----------
    scaled : Scaled
    cone : Cone
        Strength domains; not always those of the problem (Tresca).
    rho : (m, d) array
        Augmentation.
    lam : (m, d) array
        Multipliers.
    flow : (m,) array
        Dilatancy of the return map; ``cone.friction`` makes it a projection.
    shift : (m,) array or float
        Added to the gap.
    fixed : (m, d) array or float
        Forces added to the return map (friction held while the normal problem is solved).
    anchor : (N,) array or float
    prox : float
        Weight of a proximal term ``prox/2 |u - anchor|^2``, for problems in between that need have no equilibrium.
    """

    scaled: Scaled
    cone: Cone
    rho: Array
    lam: Array
    flow: Array
    shift: Array | float = 0.0
    fixed: Array | float = 0.0
    anchor: Array | float = 0.0
    prox: float = 0.0

    @property
    def stiffness(self) -> Array:
        """The r of the module's formula, (m, d)."""
        r: Array = 1.0 / (1.0 / self.rho + self.scaled.compliance)
        return r

    def trial(self, u: Array) -> Array:
        """Trial force w (m, d)."""
        y = self.scaled.opening(u)
        y[:, 0] += self.shift
        w: Array = self.stiffness * (self.lam / self.rho - y)
        return w

    @property
    def kappa(self) -> Array:
        """Flow parameter of the return map, (m,)."""
        r = self.stiffness
        kappa: Array = self.flow * r[:, 0] / r[:, 1]
        return kappa

    def forces(self, u: Array) -> Array:
        """Contact forces t(u), (m, d)."""
        return self.cone.project(self.trial(u), self.kappa) + self.fixed

    def tangent(self, u: Array) -> Array:
        """P' r, the blocks (m, d, d) of K + C' P' r C."""
        blocks: Array = self.cone.derivative(self.trial(u), self.kappa) * self.stiffness[:, None, :]
        return blocks

    def imbalance(self, u: Array) -> Array:
        """K u - f - C' t(u), with the proximal force (N,)."""
        rest: Array = self.scaled.imbalance(u, self.forces(u)) + self.prox * (u - self.anchor)
        return rest

    def energy(self, u: Array) -> float:
        """Augmented Lagrangian, whose gradient is the imbalance."""
        s = self.scaled
        w = self.trial(u)
        t = self.cone.project(w, self.kappa)
        stored = ((t * (w - 0.5 * t)) / self.stiffness).sum()
        outer = s.f @ u + (s.pull(np.broadcast_to(self.fixed, t.shape)) @ u if np.ndim(self.fixed) else 0.0)
        return float(0.5 * u @ (s.K @ u) - outer + stored + 0.5 * self.prox * ((u - self.anchor) ** 2).sum())


def proximal(size: float) -> float:
    """Proximal weight for an imbalance of this size: vanishes with it."""
    return float(np.clip(1e-3 * size, 1e-10, 1e-3))


def equilibrium(law: Augmented, u: Array, record: Record, *, goal: float, limit: int) -> tuple[Array, bool]:
    """Solve K u = f + C' t(u) by semismooth Newton steps from ``u``.

    Parameters
    ----------
    law : Augmented
    u : (N,) array
    record : Record
        Each step is noted there.
    goal : float
        Imbalance over the load at which to stop.
    limit : int
        Newton steps.

    Returns
    -------
    u : (N,) array
    converged : bool
    """
    s = law.scaled
    load = s.problem.total_load / s.force or 1.0
    sizes: list[float] = []
    for _ in range(limit):
        rest = law.imbalance(u)
        size = float(np.abs(rest).max(initial=0.0)) / load
        if size <= goal or (size < ROUNDING and len(sizes) > 2 and size > 0.5 * min(sizes[-3:])):
            return u, True
        sizes.append(size)
        lu = record.factorise(law.tangent(u), law.prox + proximal(size))
        step = -lu.solve(rest)
        record.solves()
        if not np.isfinite(step).all():
            return u, False
        u = _line_search(law, u, step, rest)
        record.note(u, law.forces(u), "Newton")
    return u, bool(np.abs(law.imbalance(u)).max(initial=0.0) / load <= goal)


def _line_search(law: Augmented, u: Array, step: Array, rest: Array) -> Array:
    """Return the next displacement: Armijo on the energy."""
    value, slope = law.energy(u), float(rest @ step)
    rounding = 1e-14 * abs(value)
    length = 1.0
    for _ in range(30):
        if law.energy(u + length * step) <= value + 1e-4 * length * slope + rounding:
            break
        length *= 0.5
    return u + length * step


def multipliers(
    law: Augmented, u: Array, record: Record, *, goal: float
) -> tuple[Array, Array, Augmented]:
    """Solve the convex problem of a projection by the method of multipliers (nested Newton steps).

    Returns
    -------
    u : (N,) array
    t : (m, d) array
    law : Augmented
        The law with its last multipliers and augmentation, to start the next problem from.
    """
    before = np.inf
    t = law.forces(u)
    for _ in range(UPDATES):
        u, _ = equilibrium(law, u, record, goal=0.1 * goal, limit=50)
        t = law.forces(u) - law.fixed
        change = float((np.abs(t - law.lam) / law.rho).max(initial=0.0))
        law = replace(law, lam=t, rho=law.rho * (10.0 if change > 0.25 * before and law.rho.max() < LARGEST else 1.0))
        if change <= goal:
            break
        before = change
    return u, t + law.fixed, law
