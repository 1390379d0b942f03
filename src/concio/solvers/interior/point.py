"""A point of the interior point, and what the linear equations leave there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.half_lines import HalfLines
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.second_order_cone import Scaling

CONE: dict[int, type[HalfLines] | type[Scaling]] = {2: HalfLines, 3: Scaling}
"""The algebra of the cone by dimension, and with it the coordinates of beta, eta and their products."""


@dataclass(frozen=True, eq=False)
class Point:
    """A point strictly inside every cone, or a direction.

    Parameters
    ----------
    u : (N,) array
    t : (m, d) array
        Shifted forces, normal first.
    y_n : (m,) array
        Gaps.
    eta : (m, d) array
        Bound on the size of slip, and slip, in the coordinates of the cone (:data:`CONE`).
    p : (m,) array
        Crushing of capped pairs; anything elsewhere.
    """

    u: Array
    t: Array
    y_n: Array
    eta: Array
    p: Array

    def moved(self, d: Point, step: float) -> Point:
        """Return the point a step further along d."""
        return Point(
            self.u + step * d.u,
            self.t + step * d.t,
            self.y_n + step * d.y_n,
            self.eta + step * d.eta,
            self.p + step * d.p,
        )


@dataclass(frozen=True, eq=False)
class Residuals:
    """What Newton's equations have to bring to zero, and the sizes it is measured by.

    Parameters
    ----------
    u, n, t : (N,), (m,), (m, d-1) arrays
        Equilibrium, gap and slip.
    beta : (m, d) array
        c + mu t_n and t_t, (1, 0) where a pair is smooth, in the coordinates of the cone.
    room : (m,) array
        What is left to the cap, N - t_n; one where there is none.
    total : float
        Sum of all complementarity products.
    typical : float
        Mean force times the mean of the gaps and slips of a pair, at least 1 each.
    force, length : float
        Largest normal force and displacement, at least one.
    """

    u: Array
    n: Array
    t: Array
    beta: Array
    room: Array
    total: float
    typical: float
    force: float
    length: float

    @classmethod
    def of(cls, s: Scaled, z: Point, dilatancy: Array) -> Residuals:
        """Return the residuals at a point, for a dilatancy (m,)."""
        smooth, capped, t_n = ~s.rough if s.any_smooth else None, s.cone.capped, z.t[:, 0]
        beta, eta, y = z.t.copy(), CONE[s.dim].vector(z.eta), s.position(z.u, z.t)
        beta[:, 0] = s.cone.linear_strength(t_n)
        n = y[:, 0] - dilatancy * eta[:, 0] - z.y_n
        t = y[:, 1:] - eta[:, 1:]
        typical = max(1.0, float(t_n.mean())) * max(1.0, float((z.y_n + eta[:, 0]).mean()))
        room = np.ones(s.pairs)
        total = float(t_n @ z.y_n)
        if s.any_capped:
            n[capped] += z.p[capped]
            room[capped] = s.cone.cap[capped] - t_n[capped]
            total += float(room[capped] @ z.p[capped])
        if smooth is not None:
            t[smooth] = 0.0
            beta[smooth] = 0.0
        total += float(np.einsum("kd,kd->", beta, eta))
        if smooth is not None:
            beta[smooth, 0] = 1.0
        force, length = max(1.0, float(t_n.max(initial=0.0))), max(1.0, float(np.abs(z.u).max(initial=0.0)))
        return cls(s.imbalance(z.u, z.t), n, t, CONE[s.dim].coordinates(beta), room, total, typical, force, length)

    @property
    def worst(self) -> float:
        """Largest entry, forces over the largest force, lengths over the largest displacement."""
        return max(
            float(np.abs(self.u).max(initial=0.0)) / self.force,
            float(np.abs(self.n).max(initial=0.0)) / self.length,
            float(np.abs(self.t).max(initial=0.0)) / self.length,
        )
