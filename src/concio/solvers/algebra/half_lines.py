"""The second-order cone of the plane, a product of two half-lines: coordinates x_0 + x_1 and x_0 - x_1, each positive.

The same members as :class:`concio.solvers.algebra.second_order_cone.Scaling`; what is a matrix there is a number here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.problem.contact_problem import Array


@dataclass(frozen=True, eq=False)
class HalfLines:
    """The scaling of Nesterov and Todd of inner points.

    Parameters
    ----------
    beta, eta : (m, 2) arrays
        Coordinates of the points.
    """

    beta: Array
    eta: Array

    @classmethod
    def of(cls, beta: Array, eta: Array) -> HalfLines | None:
        """Return the scaling, or None where a point is not inside its cone."""
        return cls(beta, eta) if beta.min(initial=1.0) > 0 and eta.min(initial=1.0) > 0 else None

    @staticmethod
    def coordinates(x: Array) -> Array:
        """Return the coordinates of vectors (m, 2)."""
        parts = np.empty_like(x)
        np.add(x[:, 0], x[:, 1], out=parts[:, 0])
        np.subtract(x[:, 0], x[:, 1], out=parts[:, 1])
        return parts

    @staticmethod
    def vector(parts: Array) -> Array:
        """Return the vectors (m, 2) that have these coordinates."""
        x = HalfLines.coordinates(parts)
        x *= 0.5
        return x

    @staticmethod
    def shifted(x: Array, by: float) -> Array:
        """Return x plus a multiple of the identity, whose coordinates are (1, 1)."""
        return x + by

    @staticmethod
    def clipped(x: Array, least: float, most: float) -> Array:
        """Return x with its coordinates brought between two bounds."""
        return np.asarray(np.minimum(np.maximum(x, least), most))

    @cached_property
    def ratio(self) -> Array:
        """Coordinates of eta over those of beta (m, 2)."""
        return np.asarray(self.eta / self.beta)

    @property
    def M(self) -> Array:
        """Matrices (m, 2, 2) that take vectors of d beta to vectors of -d eta."""
        mean = self.vector(self.ratio)
        M = np.empty((len(mean), 2, 2))
        M[:, 0], M[:, 1] = mean, mean[:, ::-1]
        return M

    def along(self, d_beta: Array) -> Array:
        """Return M d beta."""
        return np.asarray(self.ratio * d_beta)

    @cached_property
    def square(self) -> Array:
        """Products of the coordinates (m, 2)."""
        return np.asarray(self.beta * self.eta)

    def second(self, d_eta: Array, d_beta: Array) -> Array:
        """Return what the products of a full step are missed by."""
        return np.asarray(d_eta * d_beta)

    def corrector(self, r: Array) -> Array:
        """Return q of d eta = q - M d beta for products that change by r."""
        return np.asarray(r / self.beta)

    def reach(self, d_beta: Array, d_eta: Array) -> float:
        """Return the smallest step at which a coordinate becomes zero; inf where none does."""
        falls = min(float((d_beta / self.beta).min(initial=0.0)), float((d_eta / self.eta).min(initial=0.0)))
        return -1.0 / falls if falls < 0 else np.inf
