r"""The contact problem as a piecewise linear system: one row for each force of each pair, chosen by the pair's state.

Unknowns: u, the forces p, r of each pair, and the homotopy parameter z0. In units of their own, with the tension shift
(p = t_n + T) and a *cover* (terms in z0 that vanish with it),

=====================  ==============================================================  =================
row                    equation                                                        belongs to
=====================  ==============================================================  =================
equilibrium            K u - C'(p, r) + z0 (C'(P, Q) + l) = f - C_n' T                 every node
closed                 y_n = x + C_n u + a_n (p - z0 P) - sigma tan(psi) y_t + z0 g = 0         normal CLOSED
open, crushed          p = 0,    p = N + T + z0 X                                      OPEN, CRUSHED
stick                  y_t = C_t u - s + a_t (r - z0 Q) + z0 h = 0                          sigma = 0
slip +, slip -         r + sigma (c' + mu p + z0 c) = 0                                sigma = +1, -1
=====================  ==============================================================  =================

so that (P, Q) shifts the strength domain of a pair (a prestress), g and h shift its gap and slip, and l is a load. Each
state keeps some slacks positive: p and N - p when closed, y_n when open, -y_n when crushed, the two distances to
slipping when it sticks, sigma y_t when it slips. Where a slack reaches zero, the pair passes to the neighbouring state,
in which the row it gives up becomes the slack. That exchange of one row is a complementary pivot.

A pair that is open and has no strength left (c' = 0) is free tangentially; a pair without friction always is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.problem.pair_state import Normal
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.scales import require_plane
from concio.solvers.algebra.updated_factor import Row

COMPLIANCE = 1e-5
"""Compliance given to hard pairs along the path: redundant corner pairs are singular without. The finish removes it."""


@dataclass(frozen=True, eq=False)
class Cover:
    """Terms in z0, (m,): prestress P, Q, gap g, slip h, cohesion c and cap X of each pair; load l (N,)."""

    P: Array
    Q: Array
    g: Array
    h: Array
    c: Array
    X: Array
    load: Array

    @classmethod
    def none(cls, m: int, n: int) -> Cover:
        """Return the cover that is zero."""
        P, Q, g, h, c, X = np.zeros((6, m))
        return cls(P, Q, g, h, c, X, np.zeros(n))


class PairSystem:
    """Rows and slacks of a plane contact problem.

    Parameters
    ----------
    scaled : Scaled
        Its normal forces are shifted by the tensile strength, p = t_n + T.
    proximal : float
        Springs to the ground on every unknown, in units of the typical stiffness; 0 unless bodies hang on nothing.
    ground : bool
        Add a pair for each rigid motion, whose friction on the ground has no strength but what a cover gives it.

    Raises
    ------
    MethodError
        The problem is not plane.
    """

    def __init__(self, scaled: Scaled, proximal: float = 0.0, *, ground: bool = False) -> None:
        require_plane(scaled.problem)
        self.problem, self.s = scaled.problem, scaled
        s, self.m, self.n = scaled, scaled.pairs, scaled.f.size
        m, n = self.m, self.n
        self.cone = s.cone
        self.dilatancy = s.dilatancy
        self.frictionless = ~s.rough
        self.a, self.x, self.load = s.compliance, s.x, s.f
        self.size = n + 2 * m + 1
        self.K = sp.csr_array(s.K + proximal * sp.eye_array(n)) if proximal else s.K
        self.proximal, self.anchored = proximal, np.zeros(n)
        self.C = s.C.copy()
        self.C.sort_indices()
        self.delta = COMPLIANCE
        self.ground = 0
        if ground:
            self._add_ground()
        self.cover = Cover.none(self.m, self.n)

    def _add_ground(self) -> None:
        """Add the pairs that hold the rigid motions: no normal direction, the motion itself as tangent."""
        R = sp.csr_array(sp.csc_array(self.problem.R).T)
        r = R.shape[0]
        held = sp.vstack([sp.csr_array((r, self.n)), R])
        order = np.column_stack([np.arange(r), r + np.arange(r)]).ravel()
        self.C = sp.csr_array(sp.vstack([self.C, sp.csr_array(held)[order]]))
        self.C.sort_indices()
        none = np.zeros(r)
        self.cone = self.cone.followed_by(Cone(none, none, none, np.full(r, np.inf)))
        self.dilatancy = np.concatenate([self.dilatancy, none])
        self.frictionless = np.concatenate([self.frictionless, np.zeros(r, dtype=bool)])
        self.a = np.vstack([self.a, np.zeros((r, 2))])
        self.x = np.vstack([self.x, np.column_stack([np.ones(r), none])])
        self.m, self.ground = self.m + r, r
        self.size += 2 * r

    @property
    def weak(self) -> Array:
        """Pairs that have no sliding strength left when open, (m,) booleans."""
        return np.asarray((self.cone.cohesion == 0.0) & (self.cover.c == 0.0))

    def equilibrium_rows(self) -> list[Row]:
        """Return the N rows of equilibrium."""
        n, cover = self.n, self.cover
        prestress = np.column_stack([cover.P, cover.Q]).ravel()
        block = sp.csr_array(sp.hstack([self.K, -self.C.T, sp.csr_array((self.C.T @ prestress + cover.load)[:, None])]))
        return [_row(block, i) for i in range(n)]

    def normal_row(self, k: int, state: int, sigma: float) -> Row:
        """Return the row of pair k in normal state ``state``; ``sigma`` is the sign of its slip."""
        n, last = self.n, self.size - 1
        p = n + 2 * k
        if state == Normal.OPEN:
            return np.array([p]), np.array([1.0])
        if state == Normal.CRUSHED:
            return np.array([p, last]), np.array([1.0, -self.cover.X[k]])
        columns, values = _row(self.C, 2 * k)
        cover = self.cover
        z0 = cover.g[k] - (self.a[k, 0] + self.delta) * cover.P[k]
        parts = [columns, np.array([p])], [values, np.array([self.a[k, 0] + self.delta])]
        slope = -sigma * self.dilatancy[k]
        if slope:
            along, by = _row(self.C, 2 * k + 1)
            parts[0].extend([along, np.array([p + 1])])
            parts[1].extend([slope * by, np.array([slope * (self.a[k, 1] + self.delta)])])
            z0 += slope * (cover.h[k] - (self.a[k, 1] + self.delta) * cover.Q[k])
        return np.concatenate([*parts[0], [last]]), np.concatenate([*parts[1], [z0]])

    def tangential_row(self, k: int, sigma: int) -> Row:
        """Return the row of pair k that slips with the sign ``sigma``, or sticks (0)."""
        n, last = self.n, self.size - 1
        p = n + 2 * k
        if sigma == 0:
            columns, values = _row(self.C, 2 * k + 1)
            soft = self.a[k, 1] + self.delta
            return (
                np.concatenate([columns, [p + 1, last]]),
                np.concatenate([values, [soft, self.cover.h[k] - soft * self.cover.Q[k]]]),
            )
        return np.array([p + 1, p, last]), np.array([1.0, sigma * self.cone.friction[k], sigma * self.cover.c[k]])

    def right_hand_side(self, normal: Array, sign: Array) -> tuple[Array, Array]:
        """Return the right-hand sides of the rows of all pairs in these states, (m,) and (m,)."""
        closed = -self.x[:, 0] + sign * self.dilatancy * self.x[:, 1]
        b_n = np.where(normal == Normal.CLOSED, closed, np.where(normal == Normal.CRUSHED, self.cone.cap, 0.0))
        b_t = np.where(sign == 0, -self.x[:, 1], -sign * self.cone.cohesion)
        return b_n, b_t

    def slacks(self, v: Array, sign: Array, *, rate: bool = False) -> dict[str, Array]:
        """Return every quantity a slack is made of, each (m,), for unknowns ``v`` (or their rates)."""
        n, z0, cover = self.n, v[-1], self.cover
        t = v[n:-1].reshape(-1, 2)
        p, r = t[:, 0], t[:, 1]
        y = (self.C @ v[:n]).reshape(-1, 2) + (self.a + self.delta) * (t - z0 * np.column_stack([cover.P, cover.Q]))
        constant = 0.0 if rate else 1.0
        y_t = y[:, 1] + constant * self.x[:, 1] + z0 * cover.h
        y_n = y[:, 0] + constant * self.x[:, 0] + z0 * cover.g - sign * self.dilatancy * y_t
        strength = self.cone.linear_strength(p, rate=rate) + z0 * cover.c
        room = np.zeros(self.m) if rate else self.cone.cap
        return {
            "p": p,
            "y_n": y_n,
            "y_t": y_t,
            "room": room + z0 * cover.X - p,
            "plus": strength + r,
            "minus": strength - r,
        }


def _row(matrix: sp.csr_array, i: int) -> Row:
    part = slice(matrix.indptr[i], matrix.indptr[i + 1])
    return matrix.indices[part].astype(np.int64), matrix.data[part].copy()
