r"""The linear equations of a plane contact problem whose pairs are in given states.

.. math::

    K u - C^T t = f, \qquad
    \begin{cases}
    p = 0 & \text{open} \\ y_n - \sigma \tan\psi\, y_t = 0 & \text{closed} \\ p = N & \text{crushed}
    \end{cases} \qquad
    \begin{cases}
    y_t = 0 & \text{sticks} \\ t_t = -\sigma (c + \mu p) & \text{slips, } \sigma = \pm 1 \\ t_t = 0 & \text{no strength}
    \end{cases}

with gap and slip y = x + C u + a t. A compliance :data:`DELTA` added to hard pairs makes of each pair a block of
stiffness D, and of the whole a matrix K + C' D C of the engine's pattern; refinement against the equations as they
stand takes the compliance out again (:mod:`concio.solvers.states.given`).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import PairStates
from concio.solvers.algebra.scaled import Scaled

DELTA = 1e-6
"""Compliance of closed pairs of mean area in the factorised matrix, scaled units."""


class StateEquations:
    """What each pair obeys in its state, as residuals and as a block of stiffness.

    Parameters
    ----------
    s : Scaled
    states : PairStates
    """

    def __init__(self, s: Scaled, states: PairStates) -> None:
        self.s, self.states = s, states
        sign = states.direction[:, 0]
        grips = s.rough & (~states.open | (s.cone.cohesion > 0))
        self.closed = states.closed
        self.stick = grips & (sign == 0)
        slip = np.where(grips, sign, 0.0)
        self.drag = -slip * s.cone.friction  # slipping: t_t = drag p + least
        self.least = -slip * s.cone.cohesion
        self.wide = slip * s.dilatancy

    def impose(self, t: Array) -> Array:
        """Return forces (m, 2) with the components that the states prescribe set to what they prescribe."""
        p = np.where(self.states.crushed, self.s.cone.cap, np.where(self.states.open, 0.0, t[:, 0]))
        return np.column_stack([p, np.where(self.stick, t[:, 1], self.drag * p + self.least)])

    def misfit(self, u: Array, t: Array) -> Array:
        """Return by how much the gaps and slips that the states hold at zero are missed, (m, 2)."""
        y = self.s.position(u, t)
        return np.column_stack(
            [np.where(self.closed, y[:, 0] - self.wide * y[:, 1], 0.0), np.where(self.stick, y[:, 1], 0.0)]
        )

    @cached_property
    def blocks(self) -> Array:
        """Stiffness D of each pair (m, 2, 2), compliance DELTA added: forces change by -D times its displacements."""
        s, delta = self.s, DELTA / self.s.share
        a_n, a_t = s.compliance.T
        d_n = np.where(self.closed, 1.0 / np.maximum(a_n - self.wide * a_t * self.drag, delta), 0.0)
        d_t = np.where(self.stick, 1.0 / np.maximum(a_t, delta), 0.0)
        D = np.empty((s.pairs, 2, 2))
        D[:, 0, 0], D[:, 0, 1] = d_n, -d_n * self.wide
        D[:, 1, 0], D[:, 1, 1] = self.drag * d_n, d_t - self.drag * d_n * self.wide
        return D
