r"""Coulomb friction as linear complementarity: the 3m, the 4m and the frictionless form, rigid motions still free.

All are mixed problems  w = M z + N alpha + q,  0 = E z + e,  0 <= z _|_ w >= 0:

* **3m** (Ercolano, Klarbring): z = (p, s+, y-), w = (y_n, y+, s-), with t_t = s+ - mu p - c', y_t = y+ - y-,
  s- = 2 (mu p + c') - s+  (16, 18, 30). Small, but not copositive: Lemke's method may end on a ray without cause.
* **4m** (Stewart and Trinkle 1996; Anitescu and Potra 1997): z = (p, b+, b-, l), w = (y_n, y_t + l, l - y_t,
  c' + mu p - b+ - b-), with t_t = b+ - b- and l the size of the slip. Copositive without dilatancy:
  z'M z = t'F t + mu l'p >= 0.
* **normal**: z = p, w = y_n, tangential forces given; symmetric.

Dilatancy takes tan(psi) |y_t| off the gap: |y_t| = y_t + 2 y- in the first form, l in the second.

References
----------
D. E. Stewart, J. C. Trinkle, *Int. J. Numer. Methods Engrg.* 39 (1996) 2673-2691. M. Anitescu, F. A. Potra, *Nonlinear
Dynamics* 14 (1997) 231-247.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import Array
from concio.solvers.methods.forms.reduction import Reduction

FormName = Literal["3m", "4m", "normal"]


@dataclass(frozen=True, eq=False)
class MixedForm:
    """Mixed complementarity problem w = M z + N alpha + q, 0 = E z + e.

    Parameters
    ----------
    name : str
    reduction : Reduction
    M : (n, n) array
    N : (n, r) array
    q : (n,) array
    E : (r, n) array
    e : (r,) array
    T, t0 : (m + k, n) and (m + k,) arrays
        Component forces are t = T z + t0.
    """

    name: str
    reduction: Reduction
    M: Array
    N: Array
    q: Array
    E: Array
    e: Array
    T: Array
    t0: Array

    @property
    def size(self) -> int:
        """Number n of complementary pairs."""
        return int(self.q.size)

    @property
    def motions(self) -> int:
        """Number r of rigid motions."""
        return int(self.e.size)

    def forces(self, z: Array) -> Array:
        """Return the component forces t (m + k,)."""
        t: Array = self.T @ z + self.t0
        return t

    def cover(self) -> Array:
        """Return a covering vector (n,) with which friction never does positive work along a ray.

        The cover shifts gaps, slips and sliding strengths. Friction then does the work dt_t dy_t <= 0 if, in the 3m
        form, the gap is shifted by more than mu times the slip. Where the force method shifts p (strength against
        pulling), the sliding strength must be shifted by more than mu times as much: true of the 4m form, and of s- in
        the 3m form; s+ is not a row of that form, so the argument has a hole there. All in the problem's own units.
        """
        d = np.ones(self.size)
        m, k, mu = self.reduction.pairs, self.reduction.rough.size, self.reduction.mu
        if self.name == "4m":
            d[-k:] += 2.0 * mu if k else 0.0
        elif self.name == "3m" and k:
            d[self.reduction.rough] += mu
            d[m + k :] += 4.0 * mu
        return d

    def components(self, z: Array, w: Array) -> Array:
        """Return gaps and slips (m + k,) of a solution: y_n without dilatancy, y_t."""
        m, k = self.reduction.pairs, self.reduction.rough.size
        y_n = w[:m].copy()
        if self.name == "normal":
            return y_n
        if self.name == "3m":
            y_t, size = w[m : m + k] - z[m + k :], w[m : m + k] + z[m + k :]
        else:
            y_t, size = 0.5 * (w[m : m + k] - w[m + k : m + 2 * k]), z[m + 2 * k :]
        y_n[self.reduction.rough] += self.reduction.dilatancy * size
        return np.concatenate([y_n, y_t])


def mixed_form(reduction: Reduction, name: FormName) -> MixedForm:
    """Write a reduction in the form called ``name``.

    Parameters
    ----------
    reduction : Reduction
    name : {"3m", "4m", "normal"}

    Raises
    ------
    MethodError
        There is no form of that name.
    """
    m, k = reduction.pairs, reduction.rough.size
    mu, c = np.diag(reduction.mu), reduction.cohesion
    pick = np.zeros((k, m))
    pick[np.arange(k), reduction.rough] = 1.0
    mu_p = mu @ pick  # (k, m): friction times p
    I, Z = np.eye(k), np.zeros((k, k))
    Zm, Zk = np.zeros((m, k)), np.zeros((k, m))
    if name not in ("normal", "3m", "4m"):
        msg = f"there is no form '{name}'"
        raise MethodError(msg, hint="3m or 4m")
    if name == "normal":
        T, t0 = np.vstack([np.eye(m), Zk]), np.zeros(m + k)
        rows, extra, q_extra = np.hstack([np.eye(m), Zm]), np.zeros((m, m)), np.zeros(m)
    elif name == "3m":
        T, t0 = np.block([[np.eye(m), Zm, Zm], [-mu_p, I, Z]]), np.concatenate([np.zeros(m), -c])
        open_ = -(pick.T * reduction.dilatancy)  # of y_t into the gap
        rows = np.block([[np.eye(m), open_], [Zk, I], [Zk, Z]])
        extra = np.block([[np.zeros((m, m)), Zm, 2 * open_], [Zk, Z, I], [2 * mu_p, -I, Z]])
        q_extra = np.concatenate([np.zeros(m + k), 2 * c])
    else:
        T, t0 = np.block([[np.eye(m), Zm, Zm, Zm], [Zk, I, -I, Z]]), np.zeros(m + k)
        rows = np.block([[np.eye(m), Zm], [Zk, I], [Zk, -I], [Zk, Z]])
        open_ = -(pick.T * reduction.dilatancy)
        extra = np.block(
            [[np.zeros((m, m)), Zm, Zm, open_], [Zk, Z, Z, I], [Zk, Z, Z, I], [mu_p, -I, -I, Z]],
        )
        q_extra = np.concatenate([np.zeros(m + 2 * k), c])
    M = rows @ reduction.F @ T + extra
    q = rows @ (reduction.y0 + reduction.F @ t0) + q_extra
    E, e = reduction.G.T @ T, reduction.e0 + reduction.G.T @ t0
    return MixedForm(name, reduction, M, rows @ reduction.G, q, E, e, T, t0)
