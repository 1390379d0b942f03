"""Given states solved to the last digits, on the factor at hand where it is near enough.

The factor need not be that of the states: at the end of the interior point its last one is nearly so, and from one step
of a motion to the next only a few pairs change. Pairs whose block is another one are updated; what remains of the
difference, and the compliance added to hard pairs, refinement takes out. Redundant pairs (corners) and loose bodies do
no harm: their equations are consistent, and refinement converges to the answer nearest to where it began.
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.block_factor import times_springs
from concio.solvers.algebra.factor import Springs
from concio.solvers.algebra.scaled import LOOSE, Scaled
from concio.solvers.algebra.updated_blocks import UpdatedBlocks
from concio.solvers.states.pair_laws import PairLaws, side_by_side
from concio.solvers.states.state_reading import sizes

REFINED = 1e-14
"""Relative residual at which refinement of an answer stops; before where it no longer halves the residual."""

TRIED = 1e-12
"""The same where states are only tried."""

ROUNDS = 40
"""Largest number of refinements."""

STUCK = 1e-11
"""Residual from which on refinement that stops on a factor of other states is repeated on one of their own."""

OTHER = 1e-3
"""Difference of two blocks, on a scale from free (0) to hard (1), from which on a pair is updated."""


class GivenStates:
    """Solves for given states of one structure, again and again; its factor lives as long as K and C do.

    Parameters
    ----------
    s : Scaled
    """

    def __init__(self, s: Scaled) -> None:
        self.blocks = UpdatedBlocks(s.factor, s.C, s.f.size, s.dim)
        self.solves = 0

    def refined(
        self,
        s: Scaled,
        laws: PairLaws,
        u: Array,
        t: Array,
        anchor: Array | None = None,
        *,
        springs: Springs = LOOSE,
        own: bool = False,
        columns: Array | None = None,
        accuracy: float = REFINED,
    ) -> tuple[Array, Array, float]:
        """Solve the equations of the states, starting refinement from (u, t).

        Parameters
        ----------
        s : Scaled
            The structure under the loads, gaps and slip origins of this step.
        laws : PairLaws
            Of its pairs in their states.
        u, t : (N,), (m, 2) arrays
        anchor : (N,) array, optional
            Where the springs are relaxed; default u.
        springs : (N,) array, float or (N, N) CSR array
            Stiffness that ties unknowns to ``anchor``: what nothing holds stays there, and what is held feels less than
            the rounding of equilibrium.
        own : bool
            Whether the factor must be that of these very states, so that of all forces the states allow the answer
            takes those nearest to ``t`` in the norm of tractions.
        columns : (k,) integer array, optional
            Pairs whose columns are wanted afterwards (:meth:`.UpdatedBlocks.flexibility`).
        accuracy : float
            Residual at which refinement stops.

        Returns
        -------
        u, t : arrays
        residual : float
            Largest residual of the linear equations of these states.

        Raises
        ------
        SingularMatrixError
            The matrix of these states cannot be factorised.
        """
        self.solves += 1
        anchor = u if anchor is None else anchor
        columns = np.zeros(0, dtype=int) if columns is None else columns
        D = laws.blocks()
        fresh = self._prepare(D, springs, columns, OTHER if not own else 0.0)
        best = self._refine(s, laws, u, t, anchor, springs, accuracy)
        if not fresh and best[2] > STUCK:
            self._prepare(D, springs, columns, None)
            best = self._refine(s, laws, *best[:2], anchor, springs, accuracy)
        return best

    def _prepare(self, D: Array, springs: Springs, columns: Array, least: float | None) -> bool:
        """Bring the factor near to the states; return whether it is that of these very states, and not updated.

        Pairs whose blocks differ by more than ``least`` are updated where there is room for them; None: factorise.
        """
        blocks = self.blocks
        held = blocks.factor.D
        if held is not None and least is not None and blocks.has(springs):
            same = np.array_equal(held, D)
            other = columns if same else np.union1d(np.flatnonzero(difference(held, D) > least), columns)
            if blocks.room_for(other):
                blocks.change(other, D[other])
                return bool(np.array_equal(held, D))
        blocks.factorise(D, springs)
        blocks.change(columns, D[columns])
        return True

    def _refine(
        self, s: Scaled, laws: PairLaws, u: Array, t: Array, anchor: Array, springs: Springs, accuracy: float
    ) -> tuple[Array, Array, float]:
        D = self.blocks.D
        assert D is not None
        t = laws.imposed(t)
        best, late = (u, t, np.inf), 0
        for _ in range(ROUNDS):
            missing = -s.imbalance(u, t) - times_springs(springs, u - anchor)
            y = s.position(u, t)
            misfit = side_by_side(*laws.misfit(y[:, 0], y[:, 1:], t[:, 1:]))
            force, length = sizes(u, t)
            residual = max(
                float(np.abs(missing).max(initial=0.0)) / force, float(np.abs(misfit).max(initial=0.0)) / length
            )
            late = late + 1 if residual > 0.5 * best[2] else 0
            if residual < best[2]:
                best = (u, t, residual)
            if not residual > accuracy or residual > 1e3 * best[2] or late >= 3:
                break
            push = times(D, misfit)
            du = self.blocks.solve(missing - s.pull(push))
            u, t = u + du, laws.imposed(t - push - times(D, s.along(du)))
        return best


def times(D: Array, y: Array) -> Array:
    """Return D y for blocks D (m, 2, 2) and y (m, 2)."""
    product = D[:, :, 0] * y[:, :1]
    product += D[:, :, 1] * y[:, 1:]
    return np.asarray(product)


def difference(D: Array, other: Array) -> Array:
    """Return how different two sets of blocks (m, 2, 2) are, (m,): that of D (1 + D)^-1, which goes from 0 to 1."""
    return np.asarray(np.abs(_flexible(D) - _flexible(other)).max(axis=0, initial=0.0))


def _flexible(D: Array) -> Array:
    """Return the entries of (1 + D)^-1 of blocks (m, 2, 2), (4, m)."""
    a, b, c, d = D[:, 0, 0] + 1.0, D[:, 0, 1], D[:, 1, 0], D[:, 1, 1] + 1.0
    return np.asarray(np.array([d, -b, -c, a]) / (a * d - b * c))
