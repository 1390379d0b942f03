r"""The small frictional problem of a few pairs, all others in their states: y = q + W t.

Newton's method goes from states to states, each a dense linear system, until they repeat themselves. Where it goes in
circles Lemke's method solves the copositive form with z = (p, b+, b-, l, r), t_n = p - T, t_t = b+ - b-, l the size of
the slip, r the crushing,

.. math::

    y_n - \tan\psi\, l + r \perp p, \quad y_t + l \perp b^+, \quad -y_t + l \perp b^-, \quad
    c + \mu t_n - b^+ - b^- \perp l, \quad N - t_n \perp r,

all non-negative. W is positive semidefinite, and then a solution exists and the method finds it.
"""

from __future__ import annotations

import numpy as np

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.problem.natural_map import read_states
from concio.problem.pair_state import PairStates
from concio.solvers.lcp.lemke_method import Outcome, lemke
from concio.solvers.lcp.linear_problem import LinearComplementarity

STATES = 12
"""Largest number of states that Newton's method goes through; most problems of steps need two or three."""

LEAST = 1e-100
"""Compliance of a pair below which it is none [m/kN]; displacements over it are still finite numbers."""

SHARE = 1e-11
"""Compliance added to rows that hold, over that of their pair: rigid blocks on many corners have no unique forces."""


def solve_small(W: Array, q: Array, cone: Cone, dilatancy: Array) -> Array | None:
    """Return the forces (v, 2) of v pairs, or None.

    Parameters
    ----------
    W : (2 v, 2 v) array
        Normal and tangential direction of each pair together.
    q : (2 v,) array
    cone : Cone
    dilatancy : (v,) array
    """
    found = by_states(W, q, cone, dilatancy)
    return by_pivoting(W, q, cone, dilatancy) if found is None else found


def by_states(W: Array, q: Array, cone: Cone, dilatancy: Array) -> Array | None:
    """Return the forces (v, 2) where states repeat themselves; None where they do not, or come round again."""
    own = W.diagonal().reshape(-1, 2)
    unit = np.where(own > LEAST, own, max(float(own.max(initial=0.0)), LEAST))
    t, seen, rigid = np.zeros((len(q) // 2, 2)), [b""], np.zeros(len(q) // 2)
    for _ in range(STATES):
        y = (q + W @ t.ravel()).reshape(-1, 2)
        y[:, 0] -= dilatancy * np.abs(y[:, 1])
        states = read_states(cone, y / unit, t, rigid)
        key = states.key()
        if key == seen[-1]:
            return t
        if key in seen:
            break
        seen.append(key)
        t = _in_states(states, W, q, cone, dilatancy)
        if not np.isfinite(t).all():
            break
    return None


def _in_states(states: PairStates, W: Array, q: Array, cone: Cone, dilatancy: Array) -> Array:
    """Return the forces (v, 2) of pairs in given states; not finite where there are none."""
    v, way, slips = len(states), states.direction[:, 0], states.slips
    closed = np.flatnonzero(states.closed)
    stick = np.flatnonzero(cone.rough & ~slips & (~states.open | (cone.spare > 0)))
    n, k = len(closed), len(closed) + len(stick)
    given = np.zeros((v, 2))
    given[:, 0] = np.where(states.closed, 0.0, np.where(states.crushed, np.minimum(cone.cap, 1e300), -cone.tension))
    given[:, 1] = np.where(slips, -way * cone.linear_strength(given[:, 0]), 0.0)
    free, held = np.zeros((2 * v, k)), np.zeros((k, 2 * v))
    free[2 * closed, np.arange(n)] = 1.0
    free[2 * closed + 1, np.arange(n)] = -(way * cone.friction)[closed]
    held[np.arange(n), 2 * closed] = 1.0
    held[np.arange(n), 2 * closed + 1] = -(way * dilatancy)[closed]
    free[2 * stick + 1, np.arange(n, k)] = held[np.arange(n, k), 2 * stick + 1] = 1.0
    share = SHARE * W.diagonal()[np.concatenate([2 * closed, 2 * stick + 1])]
    try:
        forces = np.linalg.solve(held @ W @ free + np.diag(share), -held @ (q + W @ given.ravel()))
    except np.linalg.LinAlgError:
        forces = np.full(k, np.nan)
    return given + (free @ forces).reshape(v, 2)


def by_pivoting(W: Array, q: Array, cone: Cone, dilatancy: Array) -> Array | None:
    """Return the forces (v, 2) that Lemke's method finds in the copositive form, or None."""
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
        return None
    forces = np.zeros((v, 2))
    forces[:, 0] = found.z[:v] - cone.tension
    forces[rough, 1] = found.z[plus] - found.z[minus]
    return forces
