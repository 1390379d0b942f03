r"""Algebra of second-order cones :math:`Q = \{x : x_0 \ge |x_t|\}` for many small vectors at once, arrays (m, d).

Jordan product, determinant, quadratic representation, and the scaling of Nesterov and Todd: the symmetric map P(w) with
P(w) eta = beta that takes a pair of inner points to each other. In the plane Q is a product of two half-lines and all
of this is division of numbers (:mod:`concio.solvers.algebra.half_lines`).

Reference: Alizadeh and Goldfarb, Second-order cone programming, Math. Programming 95 (2003), 3-51.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.problem.contact_problem import Array

SINGULAR = "a matrix is singular"


def times(A: Array, x: Array) -> Array:
    """Return the products of matrices (m, d, d) and vectors (m, d)."""
    if x.shape[1] != 2:
        return np.asarray(np.einsum("kij,kj->ki", A, x))  # half the time of a product of stacks
    result = A[:, :, 0] * x[:, :1]
    result += A[:, :, 1] * x[:, 1:]
    return np.asarray(result)


def product(a: Array, b: Array) -> Array:
    """Return the Jordan product, (a'b, a_0 b_t + b_0 a_t)."""
    result = np.empty_like(a)
    result[:, 0] = dotted(a, b)
    result[:, 1:] = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:]
    return result


def dotted(a: Array, b: Array) -> Array:
    """Return the products a'b (m,) of the rows of two arrays (m, s)."""
    return np.asarray(np.einsum("ki,ki->k", a, b))


def tangential_norm(a: Array) -> Array:
    """Return |a_t| (m,)."""
    norm: Array = np.hypot(a[:, 1], a[:, 2]) if a.shape[1] == 3 else np.linalg.norm(a[:, 1:], axis=1)
    return norm


def determinant(a: Array) -> Array:
    """Return (a_0 - |a_t|)(a_0 + |a_t|), positive inside, free of cancellation."""
    r = tangential_norm(a)
    inside: Array = (a[:, 0] - r) * (a[:, 0] + r)
    return inside


def clipped(a: Array, least: float, most: float) -> Array:
    """Return a with its eigenvalues a_0 - |a_t| and a_0 + |a_t| brought between two bounds."""
    r = tangential_norm(a)
    low, high = np.clip(a[:, 0] - r, least, most), np.clip(a[:, 0] + r, least, most)
    result = np.empty_like(a)
    result[:, 0] = 0.5 * (low + high)
    result[:, 1:] = (0.5 * (high - low) / np.where(r > 0, r, 1.0))[:, None] * a[:, 1:]
    return result


def inverses(H: Array) -> Array:
    """Return the inverses of matrices (m, d, d) with a regular tangential block; LinAlgError where there is none.

    In space the tangential block is inverted first: without dilatancy what it leaves of the normal entry is that entry.
    """
    if H.shape[1] == 2:
        return _of_two(H)
    if H.shape[1] != 3:
        return np.asarray(np.linalg.inv(H))
    T = _of_two(H[:, 1:, 1:])
    below = -(T[:, :, 0] * H[:, 1, 0, None] + T[:, :, 1] * H[:, 2, 0, None])
    beside = -(H[:, 0, 1, None] * T[:, 0, :] + H[:, 0, 2, None] * T[:, 1, :])
    left = H[:, 0, 0] + H[:, 0, 1] * below[:, 0] + H[:, 0, 2] * below[:, 1]
    if not left.all():
        raise np.linalg.LinAlgError(SINGULAR)
    D = np.empty(H.shape)
    D[:, 0, 0] = 1.0 / left
    D[:, 0, 1:] = beside * D[:, 0, :1]
    D[:, 1:, 0] = below * D[:, 0, :1]
    D[:, 1:, 1:] = T + below[:, :, None] * D[:, 0, None, 1:]
    return D


def _of_two(H: Array) -> Array:
    """Return the inverses of matrices (m, 2, 2)."""
    determinants = H[:, 0, 0] * H[:, 1, 1] - H[:, 0, 1] * H[:, 1, 0]
    if not determinants.all():
        raise np.linalg.LinAlgError(SINGULAR)
    D = np.empty(H.shape)
    D[:, 0, 0], D[:, 1, 1] = H[:, 1, 1] / determinants, H[:, 0, 0] / determinants
    D[:, 0, 1], D[:, 1, 0] = -H[:, 0, 1] / determinants, -H[:, 1, 0] / determinants
    return D


def divide(a: Array, r: Array) -> Array:
    """Return x with a o x = r, a inside the cone."""
    x = np.empty_like(r)
    x[:, 0] = (a[:, 0] * r[:, 0] - dotted(a[:, 1:], r[:, 1:])) / determinant(a)
    x[:, 1:] = (r[:, 1:] - x[:, :1] * a[:, 1:]) / a[:, :1]
    return x


def quadratic(w: Array) -> Array:
    """Return the quadratic representation 2 w w' - J (m, d, d) of w with determinant one."""
    P: Array = 2.0 * w[:, :, None] * w[:, None, :]
    P[:, 0, 0] -= 1.0
    for k in range(1, w.shape[1]):
        P[:, k, k] += 1.0
    return P


def mirrored(a: Array) -> Array:
    """Return J a = (a_0, -a_t)."""
    mirror: Array = -a
    mirror[:, 0] = a[:, 0]
    return mirror


def reach(x: Array, dx: Array, inside: Array | None = None) -> float:
    """Return the smallest step at which a row of x + step dx leaves the cone; inf where none does.

    With a and c the determinants of dx and x, it is the first positive root of a step^2 + 2 b step + c. The roots are
    real where x is inside the cone, and its inverse is (root - b) / c or -a / (b + root), whichever does not cancel.

    Parameters
    ----------
    x, dx : (m, d) arrays
    inside : (m,) array, optional
        Determinants of x, where they are known.
    """
    a, c = determinant(dx), np.maximum(determinant(x) if inside is None else inside, 0.0)
    b = x[:, 0] * dx[:, 0] - dotted(x[:, 1:], dx[:, 1:])
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.where(b < 0, (root - b) / c, -a / (b + root))
        fastest = float(np.fmax.reduce(most, initial=0.0))
        return 1.0 / fastest if fastest > 0 else np.inf


@dataclass(frozen=True, eq=False)
class Scaling:
    """Nesterov-Todd scaling of inner points beta, eta: W eta = W^-1 beta = point, M = W^-2.

    Parameters
    ----------
    beta, eta : (m, d) arrays
    W, inverse : (m, d, d) arrays
    M : (m, d, d) array
        d eta = q - M d beta in Newton's equations.
    point : (m, d) array
        lambda, the common image of both.
    inside : pair of (m,) arrays
        Determinants of beta and eta.
    """

    beta: Array
    eta: Array
    W: Array
    inverse: Array
    M: Array
    point: Array
    inside: tuple[Array, Array]

    @classmethod
    def of(cls, beta: Array, eta: Array) -> Scaling | None:
        """Return the scaling, or None where a point is not inside its cone."""
        of_beta, of_eta = determinant(beta), determinant(eta)
        if not (of_beta.min(initial=1.0) > 0 and of_eta.min(initial=1.0) > 0):
            return None
        inside = of_beta, of_eta
        of_beta, of_eta = np.sqrt(of_beta), np.sqrt(of_eta)
        b, e = beta / of_beta[:, None], eta / of_eta[:, None]
        w = (b + mirrored(e)) / np.sqrt(2.0 * (1.0 + dotted(b, e)))[:, None]
        h = w.copy()
        h[:, 0] += 1.0
        h /= np.sqrt(2.0 * h[:, :1])
        size = np.sqrt(of_beta / of_eta)[:, None, None]
        W, inverse = quadratic(h) * size, quadratic(mirrored(h)) / size
        return cls(beta, eta, W, inverse, quadratic(mirrored(w)) / size**2, times(W, eta), inside)

    @staticmethod
    def coordinates(x: Array) -> Array:
        """Return the coordinates of vectors (m, d) in which the cone is easiest: their own."""
        return x

    vector = coordinates

    @staticmethod
    def shifted(x: Array, by: float) -> Array:
        """Return x plus a multiple of the identity (1, 0)."""
        moved = x.copy()
        moved[:, 0] += by
        return moved

    @staticmethod
    def clipped(x: Array, least: float, most: float) -> Array:
        """Return x with its eigenvalues brought between two bounds."""
        return clipped(x, least, most)

    def along(self, d_beta: Array) -> Array:
        """Return M d beta."""
        return times(self.M, d_beta)

    def reach(self, d_beta: Array, d_eta: Array) -> float:
        """Return the smallest step at which beta or eta leaves its cone; inf where none does."""
        return min(*self.reaches(d_beta, d_eta))

    def reaches(self, d_beta: Array, d_eta: Array) -> tuple[float, float]:
        """Return the smallest steps at which beta and eta leave their cones; inf where none does."""
        of_beta, of_eta = self.inside
        return reach(self.beta, d_beta, of_beta), reach(self.eta, d_eta, of_eta)

    @cached_property
    def square(self) -> Array:
        """Lambda o lambda (m, d)."""
        return product(self.point, self.point)

    def second(self, d_eta: Array, d_beta: Array) -> Array:
        """Return (W d eta) o (W^-1 d beta), what the products of a full step are missed by."""
        return product(times(self.W, d_eta), times(self.inverse, d_beta))

    def corrector(self, r: Array) -> Array:
        """Return q of d eta = q - M d beta for lambda o (W d eta + W^-1 d beta) = r."""
        q: Array = times(self.inverse, divide(self.point, r))
        return q
