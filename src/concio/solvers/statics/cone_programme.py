"""Second-order cone programmes of statics: the pairs, a point, and what its residuals are made of.

Forces t inside the cones in balance with e + lambda g, with multipliers z of the half-lines t_n >= 0, eta of the cones
beta = (c + mu t_n, t_t) and w of the caps t_n <= N; see :mod:`concio.solvers.statics.cone_interior`.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import blake2b

import numpy as np
import scipy.sparse as sp

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array, Engine
from concio.problem.products import product
from concio.problem.tolerances import SMOOTH
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.second_order_cone import dotted
from concio.solvers.statics.pivoted import Mixed

START = 3.0
"""Size of slacks and multipliers at the start, the largest load on a block being one."""

KEPT = 4
"""Programmes whose order is kept: those that follow each other differ in their strengths and loads alone."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of a cone programme.

    Parameters
    ----------
    C : (m d, r) CSR array
        Velocities of the pairs, d rows for each.
    cone : Cone
        Strengths of forces shifted so that t_n >= 0.
    bodies : (B+1,) integer array
        Motions of block k are ``bodies[k]:bodies[k+1]``.
    engine : {"superlu", "pardiso"}
    """

    C: sp.csr_array
    cone: Cone
    bodies: Array
    engine: Engine = "superlu"

    @property
    def count(self) -> int:
        """Number m of pairs."""
        return len(self.cone.cap)

    @property
    def dim(self) -> int:
        """Space dimension d."""
        return self.C.shape[0] // max(self.count, 1)


@dataclass
class Point:
    """A point of the iteration, or a direction from one.

    Parameters
    ----------
    t : (m, d) array
        Shifted forces.
    multiplier : float
    v : (r,) array
        Motion.
    z : (m,) array
        Multipliers of the half-lines.
    eta : (m, d) array
        Of the cones.
    w : (m,) array
        Of the caps.
    """

    t: Array
    multiplier: float
    v: Array
    z: Array
    eta: Array
    w: Array

    def moved(self, d: Point, primal: float, dual: float) -> Point:
        """Return the point after the shares ``primal`` and ``dual`` of a direction."""
        return Point(
            self.t + primal * d.t,
            self.multiplier + primal * d.multiplier,
            self.v + dual * d.v,
            self.z + dual * d.z,
            self.eta + dual * d.eta,
            self.w + dual * d.w,
        )


class Ordered:
    """What only the velocities of the pairs decide: the order of Newton's equations, condensed and as a whole.

    Parameters
    ----------
    pairs : Pairs
    """

    def __init__(self, pairs: Pairs) -> None:
        r = pairs.C.shape[1]
        self.pairs = pairs
        self.factor = BlockFactor(sp.csr_array((r, r)), pairs.C, pairs.count, pairs.bodies, pairs.engine)

    @cached_property
    def mixed(self) -> Mixed:
        """Newton's equations as a whole."""
        return Mixed(self.pairs.C, self.pairs.count)


_RECENT: OrderedDict[bytes, Ordered] = OrderedDict()


def _ordered(pairs: Pairs) -> Ordered:
    """Return the order of a programme, that of the last few as it was made."""
    digest = blake2b(f"{pairs.C.shape} {pairs.count} {pairs.engine}".encode())
    for part in (pairs.C.indptr, pairs.C.indices, pairs.C.data, pairs.bodies):
        digest.update(np.ascontiguousarray(part).view(np.uint8).data)
    key = digest.digest()
    made = _RECENT.pop(key, None) or Ordered(pairs)
    _RECENT[key] = made
    while len(_RECENT) > KEPT:
        _RECENT.popitem(last=False)
    return made


class ConeProgramme:
    """The pairs of one programme with the pattern of their equations, ordered once.

    Parameters
    ----------
    pairs : Pairs
    pivoting : bool
        Whether the system is solved as a whole, with pivoting, where the condensed matrix has lost its digits: on
        thousands of pairs each step then costs as much as some fifty others.

    Attributes
    ----------
    degenerate : bool
        Whether the condensed matrix has lost its digits: directions then come from the system as a whole.
    count : int
        Number of complementarity products.
    """

    def __init__(self, pairs: Pairs, *, pivoting: bool = True) -> None:
        self.pairs, self.pivoting = pairs, pivoting
        self.C, self.Ct = pairs.C, sp.csr_array(pairs.C.T)
        self.ordered = _ordered(pairs)
        self.factor = self.ordered.factor.afresh()
        cone = pairs.cone
        self.capped, self.rough = cone.capped, cone.rough
        self.cap = np.where(self.capped, cone.cap, 0.0)
        self.coulomb = self.rough & (cone.friction > SMOOTH)  # the others with friction have a constant strength
        self.mu = np.where(self.coulomb, cone.friction, 0.0)
        self.cone = replace(cone, friction=self.mu)
        self.tresca = self.rough & ~self.coulomb
        self.line = ~self.rough | (cone.cohesion > 0)  # where the cone itself does not keep t_n >= 0
        self.has_lines, self.has_caps = bool(self.line.any()), bool(self.capped.any())
        self.has_tresca, self.all_rough = bool(self.tresca.any()), bool(self.rough.all())
        self.degenerate = False
        self.count = max(int(self.line.sum()) + 2 * int(self.rough.sum()) + int(self.capped.sum()), 1)

    @property
    def mixed(self) -> Mixed:
        """Newton's equations as a whole, in the order of elimination with pivoting."""
        return self.ordered.mixed

    def rate(self, v: Array) -> Array:
        """Return C v (m, d)."""
        return product(self.C, v).reshape(self.pairs.count, self.pairs.dim)

    def pull(self, t: Array) -> Array:
        """Return C't (r,)."""
        return product(self.Ct, t.ravel())

    def strength(self, t: Array) -> Array:
        """Return beta (m, d); (1, 0) where there is no cone."""
        beta = t.copy()
        beta[:, 0] = self.cone.linear_strength(t[:, 0])
        if not self.all_rough:
            beta[~self.rough] = 0.0
            beta[~self.rough, 0] = 1.0
        return beta

    def pressed(self, z: Array, eta: Array, w: Array) -> Array:
        """Return G'z (m, d): the velocities that multipliers stand for."""
        rates = eta.copy() if self.all_rough else np.where(self.rough[:, None], eta, 0.0)
        rates[:, 0] *= self.mu
        if self.has_lines:
            rates[:, 0] += np.where(self.line, z, 0.0)
        if self.has_caps:
            rates[:, 0] -= np.where(self.capped, w, 0.0)
        return rates

    def gap(self, p: Point) -> float:
        """Return the sum of the complementarity products."""
        of_cones = dotted(self.strength(p.t), p.eta)
        total = float((of_cones if self.all_rough else of_cones[self.rough]).sum())
        if self.has_lines:
            total += float((p.t[:, 0] * p.z)[self.line].sum())
        if self.has_caps:
            total += float(((self.cap - p.t[:, 0]) * p.w)[self.capped].sum())
        return total

    def start(self, size: float = START) -> Point:
        """Return a point far outside."""
        m, d = self.pairs.count, self.pairs.dim
        t, eta = np.zeros((m, d)), np.zeros((m, d))
        t[:, 0] = np.where(self.capped, np.minimum(size, 0.5 * self.pairs.cone.cap), size)
        eta[:, 0] = size
        one = np.full(m, size)
        return Point(t, 0.0, np.zeros(self.C.shape[1]), one, eta, one.copy())
