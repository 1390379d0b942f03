r"""What pairs in given states obey, and the block of stiffness that makes of each.

.. math::

    \begin{cases}
    t_n = N & \text{open, or crushed} \\ y_n - w \cdot y_t = 0 & \text{closed}
    \end{cases} \qquad
    \begin{cases}
    y_t = 0 & \text{sticks} \\ t_t = d\, t_n + q & \text{slips, or has no strength}
    \end{cases}

with gap and slip y = x + C u + a t; the drag d and the pull q are friction and cohesion against the slip, w is the
opening of dilatant pairs. In space the friction of a pair that slips turns with its slip; it is linearised about the
direction e and the size that the point before suggests, which leaves a compliance across e:

.. math:: t_t = d\, t_n + q - s\,(1 - e e^T)\, y_t, \qquad s = \sigma / |y_t| .

Statics and steps in time read their states into these laws (:func:`concio.solvers.states.static_laws.laws_of`,
:func:`concio.solvers.stepping.states.laws_of_step`); they differ in the compliance that is added to hard pairs and in
how forces are shifted.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from concio.problem.contact_problem import Array


@dataclass(frozen=True, eq=False)
class PairLaws:
    """The linear law of each pair in its state: which rows hold, what friction goes with the normal force.

    Parameters
    ----------
    closed, stick : (m,) boolean arrays
        Pairs whose normal, whose tangential rows hold.
    drag, pull : (m, d-1) arrays
        t_t = drag t_n + pull where a pair slips, along its slip; zero where it sticks.
    held : (m,) array
        Normal force of pairs that are open or crushed.
    wide : (m, d-1) array
        Opening for each unit of slip.
    soft_n : (m,) array
        Compliance along the normal with what is added, less what comes back by opening; positive.
    soft_t : (m,) array
        Compliance along the tangents with what is added; one where a pair neither sticks nor turns its slip.
    opens : bool
        Whether any pair opens as it slips.
    turns : (m,) boolean array or None
        Pairs whose slip may turn; None in the plane, where none may.
    direction : (m, d-1) array
        Along which they slip.
    turn : (m,) array
        Compliance |y_t| / sigma across it.
    """

    closed: Array
    stick: Array
    drag: Array
    pull: Array
    held: Array
    wide: Array
    soft_n: Array
    soft_t: Array
    opens: bool
    turns: Array | None
    direction: Array
    turn: Array

    def across(self, v: Array) -> Array:
        """Return the part (m, d-1) of tangential vectors that springs resist: all that sticks, across what slips."""
        found: Array = np.where(self.stick[:, None], v, 0.0)
        k = self.turning
        if len(k):
            e, own = self.direction[k], v[k]
            found[k] = own - dot(e, own)[:, None] * e
        return found

    @cached_property
    def turning(self) -> Array:
        """Numbers of the pairs whose slip may turn: few, where most of thousands stick."""
        return np.zeros(0, dtype=np.intp) if self.turns is None else np.flatnonzero(self.turns)

    def imposed(self, t: Array) -> Array:
        """Return forces (m, d) with the components that the states prescribe set to what they prescribe."""
        t_n = np.where(self.closed, t[:, 0], self.held)
        return side_by_side(t_n, self.across(t[:, 1:]) + (self.drag * t_n[:, None] + self.pull))

    def misfit(self, y_n: Array, y_t: Array, t_t: Array) -> tuple[Array, Array]:
        """Return by how much the gaps (m,) and slips (m, d-1) that are held are missed; t_t (m, d-1): friction."""
        gap = y_n - dot(self.wide, y_t) if self.opens else y_n
        k = self.turning
        if len(k):
            y_t = y_t.copy()
            y_t[k] += self.turn[k, None] * t_t[k]
        return np.where(self.closed, gap, 0.0), self.across(y_t)

    def blocks(self) -> Array:
        """Return the stiffness D (m, d, d): forces change by -D times the displacements of the pair."""
        m, d = len(self.closed), 1 + self.drag.shape[1]
        d_nn = np.where(self.closed, 1.0 / self.soft_n, 0.0)
        d_tn = self.drag * d_nn[:, None]
        D = np.zeros((m, d, d))
        D[:, 0, 0], D[:, 1:, 0] = d_nn, d_tn
        stiff = np.where(self.stick, 1.0 / self.soft_t, 0.0)
        some = self.turning
        if len(some):
            stiff[some] = 1.0 / self.soft_t[some]
            e = self.direction[some]
            D[some, 1:, 1:] -= stiff[some, None, None] * e[:, :, None] * e[:, None, :]
        for k in range(1, d):
            D[:, k, k] += stiff
        if self.opens:
            D[:, 0, 1:] = -d_nn[:, None] * self.wide
            D[:, 1:, 1:] -= d_tn[:, :, None] * self.wide[:, None, :]
        return D


def dot(p: Array, q: Array) -> Array:
    """Return the scalar products (m,) of tangential vectors (m, d-1)."""
    first = p[:, 0] * q[:, 0]
    return np.asarray(first if p.shape[1] == 1 else first + p[:, 1] * q[:, 1])


def side_by_side(first: Array, others: Array) -> Array:
    """Return vectors (m, d) of normal (m,) and tangential (m, d-1) components."""
    both = np.empty((len(first), 1 + others.shape[1]))
    both[:, 0], both[:, 1:] = first, others
    return both
