"""Pairs that lie between two others of one straight joint: rigid blocks do not need them.

Elastic blocks have contact at every node of a joint. In the plane, where two rigid blocks meet along a straight joint
without cohesion, tensile strength and cap, the rows of a pair between two others are a mean of theirs,
C_k = (1 - s) C_a + s C_b with 0 <= s <= 1.
A force of its cone is then the sum of forces of theirs, with the same work in every motion, and conversely; and where
it presses, its normal velocity vanishes and so do both of theirs, with one slip for all three. So the pairs at the ends
have the same associated limit, and the same collapse states of Coulomb friction: multipliers and motions. The mean is
checked in the rows themselves, not in coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from concio.contact.pairs import Pairs
from concio.problem.contact_problem import ContactProblem

Array = np.ndarray

MEAN = 1e-10
"""Largest difference of rows from the mean of two others, over their size, at which they are that mean."""

STEEPEST, ROUNDS = 700.0, 80
"""Largest exponent of a distribution along a joint, and halvings until it has its centre."""


@dataclass(frozen=True, eq=False)
class Ends:
    """Pairs at the ends of joints, and those between them.

    Parameters
    ----------
    needed : (m,) boolean array
        Pairs that are left: all in space.
    first, last : (m,) integer arrays
        The ends that each pair lies between; of one that is left, itself.
    share : (m,) array
        s, from 0 at the first to 1 at the last.
    """

    needed: Array
    first: Array
    last: Array
    share: Array

    def of(self, rows: Array) -> Ends:
        """Return the same of some pairs alone, whole joints each."""
        number = np.full(len(self.needed), -1)
        number[rows] = np.arange(len(rows))
        return Ends(self.needed[rows], number[self.first[rows]], number[self.last[rows]], self.share[rows])

    def spread(self, t_n: Array, t_t: Array) -> tuple[Array, Array]:
        """Return forces t_n (m,), t_t (m, 1) of all pairs with the resultants that ``t_n``, ``t_t`` of the ends have.

        Pressures are those of largest entropy, exponential along the joint, positive wherever the resultant lies
        between the ends; friction is in proportion to them.
        """
        if self.needed.all():
            return t_n, t_t
        inner = np.flatnonzero(~self.needed)
        size = len(self.needed)
        a, b = self.first[inner], self.last[inner]
        joint = np.full(size, -1)
        joint[a], joint[b], joint[inner] = a, a, a
        own = np.flatnonzero(joint >= 0)
        _, of = np.unique(joint[own], return_inverse=True)
        at = self.share[own].copy()
        at[np.isin(own, b)] = 1.0
        total, friction = np.bincount(of, t_n[own]), np.bincount(of, t_t[own, 0])
        pressed = total > 0
        centre = np.bincount(of, t_n[own] * at) / np.where(pressed, total, 1.0)
        low, high = np.full(total.size, -STEEPEST), np.full(total.size, STEEPEST)
        for _ in range(ROUNDS):
            middle = (low + high) / 2
            weight = np.exp(middle[of] * (at - (middle[of] > 0)))
            more = np.bincount(of, weight * at) < centre * np.bincount(of, weight)
            low, high = np.where(more, middle, low), np.where(more, high, middle)
        part = weight / np.bincount(of, weight)[of]
        off = centre - np.bincount(of, part * at)  # what the exponents leave goes to the ends
        ends = np.where(at == 1.0, off[of], np.where(at == 0.0, -off[of], 0.0))
        part += ends
        spread = pressed & (np.bincount(of, part < 0) == 0)  # a hinge at an end stays there
        chosen = spread[of]
        t_n, t_t = t_n.copy(), t_t.copy()
        t_n[own[chosen]] = (total[of] * part)[chosen]
        t_t[own[chosen], 0] = (friction[of] * part)[chosen]
        return t_n, t_t


def ends_of_joints(problem: ContactProblem, pairs: Pairs) -> Ends:
    """Return which pairs are needed of a problem of rigid blocks.

    Parameters
    ----------
    problem : ContactProblem
        Whose rows are those of ``pairs``.
    pairs : Pairs
    """
    every = np.arange(problem.pairs)
    needed, first, last, share = np.ones(every.size, dtype=bool), every.copy(), every.copy(), np.zeros(every.size)
    if problem.dim != 2 or not every.size:
        return Ends(needed, first, last, share)
    joint = _joints(problem, pairs)
    along = (pairs.point * pairs.tangents[:, 0]).sum(axis=1)
    order = np.lexsort((along, joint))
    starts = np.flatnonzero(np.diff(joint[order], prepend=-1))
    counts = np.diff(np.append(starts, order.size))
    a, b = np.empty_like(every), np.empty_like(every)
    a[order], b[order] = np.repeat(order[starts], counts), np.repeat(order[starts + counts - 1], counts)
    law = problem.laws
    plain = (law.cohesion == 0) & (law.tension == 0) & ~np.isfinite(law.cap)
    k = np.flatnonzero(plain & plain[a] & plain[b] & (every != a) & (every != b))
    rows = sp.csr_array(sp.hstack([problem.C_n @ problem.R, problem.C_t @ problem.R]))
    begin, span = rows[a[k]], rows[b[k]] - rows[a[k]]
    length = np.asarray(span.multiply(span).sum(axis=1)).ravel()
    s = np.asarray((rows[k] - begin).multiply(span).sum(axis=1)).ravel() / np.where(length > 0, length, 1.0)
    left = abs(rows[k] - begin - sp.diags_array(s) @ span).max(axis=1).toarray().ravel()
    size = abs(rows[k]).max(axis=1).toarray().ravel()
    mean = (left <= MEAN * size) & (s > 0.0) & (s < 1.0) & (length > 0)
    k, s = k[mean], s[mean]
    needed[k], first[k], last[k], share[k] = False, a[k], b[k], s
    return Ends(needed, first, last, share)


def _joints(problem: ContactProblem, pairs: Pairs) -> Array:
    """Return a number (m,) that pairs of two bodies on one straight joint with one friction have in common."""
    turned = np.round(pairs.normal, 6) + 0.0
    keys = np.column_stack([pairs.body_a, pairs.body_b, pairs.interface, turned, problem.laws.friction])
    _, number = np.unique(keys, axis=0, return_inverse=True)
    return np.asarray(number).ravel()
