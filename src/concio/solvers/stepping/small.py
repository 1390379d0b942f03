r"""The small frictional problem of a few pairs, all others in their states: y = q + W t, solved by Lemke's method.

In the copositive form with z = (p, b+, b-, l, r), t_n = p - T, t_t = b+ - b-, l the size of the slip, r the crushing,

.. math::

    y_n - \tan\psi\, l + r \perp p, \quad y_t + l \perp b^+, \quad -y_t + l \perp b^-, \quad
    c + \mu t_n - b^+ - b^- \perp l, \quad N - t_n \perp r,

all non-negative. W is positive semidefinite, and then a solution exists and the method finds it.
"""

from __future__ import annotations

import numpy as np

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.solvers.lcp.lemke_method import Outcome, lemke
from concio.solvers.lcp.linear_problem import LinearComplementarity


def solve_small(W: Array, q: Array, cone: Cone, dilatancy: Array) -> tuple[Array | None, int]:
    """Return the forces (v, 2) of v pairs, or None, and the pivots made.

    Parameters
    ----------
    W : (2 v, 2 v) array
        Normal and tangential direction of each pair together.
    q : (2 v,) array
    cone : Cone
    dilatancy : (v,) array
    """
    n = np.arange(0, len(q), 2)
    v = len(n)
    t = n + 1
    rough, capped = np.flatnonzero(cone.rough), np.flatnonzero(cone.capped)
    f, c = len(rough), len(capped)
    shift = q - W[:, n] @ cone.tension
    size = v + 3 * f + c
    M, q0 = np.zeros((size, size)), np.zeros(size)
    plus, minus, slip = (slice(v + k * f, v + (k + 1) * f) for k in range(3))
    crush = slice(v + 3 * f, size)
    T = t[rough]
    M[:v, :v], M[:v, plus], M[:v, minus] = W[np.ix_(n, n)], W[np.ix_(n, T)], -W[np.ix_(n, T)]
    M[plus, :v], M[plus, plus], M[plus, minus] = W[np.ix_(T, n)], W[np.ix_(T, T)], -W[np.ix_(T, T)]
    M[minus] = -M[plus]
    eye = np.eye(f)
    M[plus, slip] = M[minus, slip] = eye
    M[slip, plus] = M[slip, minus] = -eye
    M[slip, rough] = cone.friction[rough][:, None] * eye
    M[rough, slip] = -dilatancy[rough][:, None] * eye
    M[capped, crush] = np.eye(c)
    M[crush, capped] = -np.eye(c)
    q0[:v], q0[plus], q0[minus] = shift[n], shift[T], -shift[T]
    q0[slip] = cone.linear_strength(-cone.tension)[rough]
    q0[crush] = (cone.cap + cone.tension)[capped]
    found = lemke(LinearComplementarity(M, q0))
    if found.outcome is not Outcome.SOLVED:
        return None, found.pivots
    forces = np.zeros((v, 2))
    forces[:, 0] = found.z[:v] - cone.tension
    forces[rough, 1] = found.z[plus] - found.z[minus]
    return forces, found.pivots
