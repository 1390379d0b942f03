"""The laws of states in statics: pairs of the scaled problem, hard ones given a small compliance.

A compliance :data:`DELTA` added to hard pairs makes of each pair a block of stiffness D, and of the whole a matrix
K + C' D C of the engine's pattern; refinement against the equations as they stand takes the compliance out again
(:mod:`concio.solvers.states.given`).
"""

from __future__ import annotations

import numpy as np

from concio.problem.pair_state import PairStates
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.states.pair_laws import PairLaws, dot

DELTA = 1e-6
"""Compliance of closed pairs of mean area in the factorised matrix, scaled units."""


def laws_of(s: Scaled, states: PairStates) -> PairLaws:
    """Return the linear laws of the pairs of a scaled problem in the plane in given states."""
    cone, way = s.cone, states.direction
    grips = s.rough & (~states.open | (cone.cohesion > 0))
    stick = grips & (way == 0).all(axis=1)
    slip = np.where(grips[:, None], way, 0.0)
    drag, wide = -slip * cone.friction[:, None], slip * s.dilatancy[:, None]
    a_n, a_t = s.compliance.T
    delta = DELTA / s.share
    return PairLaws(
        closed=states.closed,
        stick=stick,
        drag=drag,
        pull=-slip * cone.cohesion[:, None],
        held=np.where(states.crushed, cone.cap, 0.0),
        wide=wide,
        soft_n=np.maximum(a_n - dot(wide * a_t[:, None], drag), delta),
        soft_t=np.maximum(a_t, delta),
        opens=bool(wide.any()),
        turns=None,
        direction=way,
        turn=np.zeros(s.pairs),
    )
