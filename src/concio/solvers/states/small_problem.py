r"""A few undecided pairs, all others in their states: one small linear complementarity problem.

The pairs in question are held shut and stuck by springs of compliance ``SOFT`` relaxed under their present forces
(proximal point: what the springs change vanishes as the forces settle). With openings, crushing and slips
``z = (y_n, p, y^+, y^-)`` imposed on them the forces become, all others eliminated on the factor at hand,

.. math:: t = t_b + S e, \qquad e_n = y_n - p + \tan\psi\,(y^+ + y^-), \quad e_t = y^+ - y^-, \qquad
          S = D - D W D ,

S symmetric but for the friction of the others, W the flexibility of the structure at the pairs, D = 1/(a + SOFT). The
law of each pair is then

.. math:: 0 \le z \perp \bigl(t_n,\; N - t_n,\; c + \mu t_n + t_t,\; c + \mu t_n - t_t\bigr) \ge 0 .

Lemke's method decides few of these problems by theory and nearly all in practice; several covering vectors are tried.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.problem.pair_state import Normal, PairStates
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.updated_blocks import block_diagonal
from concio.solvers.lcp.lemke_method import Outcome, lemke
from concio.solvers.lcp.linear_problem import LinearComplementarity
from concio.solvers.states.given import GivenStates
from concio.solvers.states.static_laws import laws_of

SOFT = 1e-4
"""Compliance that holds undecided pairs of mean area, scaled units."""

COVERS = 6
"""Number of covering vectors tried."""

MOVED = 1e-12
"""Openings and slips above this share of the largest, or of one, count."""


@dataclass(frozen=True, eq=False)
class Decided:
    """A point at which some pairs obey their laws, all others being held in their states.

    Parameters
    ----------
    states : PairStates
    u, t : (N,), (m, 2) arrays
        Displacements of the structure with these pairs held by springs, and forces near the answer.
    pivots : int
    """

    states: PairStates
    u: Array
    t: Array
    pivots: int


def decide(
    given: GivenStates,
    s: Scaled,
    states: PairStates,
    pick: Array,
    u: Array,
    t: Array,
    anchor: Array,
    *,
    springs: Array | float,
) -> Decided | None:
    """Find states in which the pairs picked obey their laws; None where Lemke's method finds none.

    Parameters
    ----------
    given : GivenStates
        Its factor at hand is used.
    s : Scaled
    states : PairStates
        What all other pairs are held in.
    pick : (k,) integer array
    u, t : (N,), (m, 2) arrays
        The present point.
    anchor : (N,) array
    springs : (N,) array or float
    """
    normal, sign = states.normal.copy(), states.sign.copy()
    normal[pick], sign[pick] = Normal.CLOSED, 0
    soft = np.zeros((s.pairs, 1))
    soft[pick, 0] = SOFT / s.share[pick]
    held = replace(s, compliance=s.compliance + soft, x=s.x - soft * t)
    laws = laws_of(held, PairStates.plane(normal, sign))
    u, t, _ = given.refined(held, laws, u, t, anchor, springs=springs, columns=pick)
    D = block_diagonal(laws.blocks()[pick])
    S = D - D @ given.blocks.flexibility(pick) @ D
    answer = _lemke(s.cone[pick], s.dilatancy[pick], t[pick], S)
    if answer is None:
        return None
    z, pivots = answer
    opened, crushed, plus, minus = z.reshape(4, -1)
    least = MOVED * max(1.0, float(z.max(initial=0.0)))
    normal[pick] = np.where(opened > least, Normal.OPEN, np.where(crushed > least, Normal.CRUSHED, Normal.CLOSED))
    sign[pick] = np.where(plus - minus > least, 1, np.where(minus - plus > least, -1, 0))
    e = np.column_stack([opened - crushed + s.dilatancy[pick] * (plus + minus), plus - minus])
    t = t.copy()
    t[pick] += (S @ e.ravel()).reshape(-1, 2)
    return Decided(PairStates.plane(normal, sign), u, t, pivots)


def _lemke(cone: Cone, dilatancy: Array, t: Array, S: Array) -> tuple[Array, int] | None:
    """Return z (4 k,) and the pivots for pairs of a cone whose forces are t + S e, (k, 2); None without a solution."""
    k, mu = len(t), cone.friction
    n, s = 2 * np.arange(k), 2 * np.arange(k) + 1
    impose = np.zeros((2 * k, 4 * k))  # e of z
    each = np.arange(k)
    impose[n, each], impose[n, k + each] = 1.0, -1.0
    impose[n, 2 * k + each], impose[n, 3 * k + each] = dilatancy, dilatancy
    impose[s, 2 * k + each], impose[s, 3 * k + each] = 1.0, -1.0
    read = np.zeros((4 * k, 2 * k))  # slacks of t
    read[each, n], read[k + each, n] = 1.0, -1.0
    for row, side in ((2 * k + each, 1.0), (3 * k + each, -1.0)):
        read[row, n], read[row, s] = mu, side
    strength = cone.cohesion
    start = np.concatenate([np.zeros(k), np.where(cone.capped, cone.cap, 0.0), strength, strength]) + read @ t.ravel()
    use = np.flatnonzero(np.concatenate([np.ones(k, dtype=bool), cone.capped, cone.rough, cone.rough]))
    matrix = (read @ S @ impose)[np.ix_(use, use)]
    problem = LinearComplementarity(matrix, start[use])
    pivots = 0
    for number in range(COVERS):
        cover = np.random.default_rng(number).uniform(0.5, 2.0, use.size) if number else None
        found = lemke(problem, cover=cover, limit=20 * use.size + 50)
        pivots += found.pivots
        if found.outcome is Outcome.SOLVED:
            z = np.zeros(4 * k)
            z[use] = found.z
            return z, pivots
    return None
