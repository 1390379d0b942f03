r"""Taking an added compliance out of an answer: the limit of stiff joints, reached exactly.

A problem whose joints are hard between bodies that do not deform is solved with a small compliance an added to them
(:mod:`concio.analysis.lent_compliance`), which tells what each pair does. With these states the equations are linear,

.. math:: (M + a D)\, x = b,

and what is wanted is the limit of x as a goes to zero, where M alone is singular: its forces are not unique. Repeated
solves with residuals of M,  x <- x + (M + a D)^{-1} (b - M x),  converge to that limit, an error of the order a times
smaller with each, and never bring in forces that balance themselves. Forces are eliminated as in the engine,
K + C'(aD)^{-1}C, one factorisation for all. Of blocks that begin where they are joined and are not moved the
displacements are in proportion to a and the forces do not depend on it: where the solves do not converge, no motion
with the forces as they are is the other candidate.

Hard pairs to which nothing was given, those of bodies that deform, take part with the least compliance added: it only
has to be small beside that of their bodies, and is gone in the limit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.apart import merged, restricted
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.error_units import measure
from concio.problem.parts import parts_of
from concio.problem.solution import Solution, judge, pair_states
from concio.problem.tolerances import AT_BOUND
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.scales import compliances, interleaved
from concio.solvers.algebra.sparse_factor import SingularMatrixError

ROUNDS = 12
"""Largest number of repeated solves."""

NOTHING = 1e-6
"""Where all displacements fall below this share of those that the compliance allowed, nothing moves unless a support
does."""

LOOSE = 1e-12
"""Stiffness, relative to the added one, of the springs that keep what nothing holds where it is."""


def without_compliance(hard: ContactProblem, lent: ContactProblem, answer: Solution) -> tuple[Solution, Array]:
    """Return the limit that a solution belongs to, part by part, each judged by its hard problem.

    Parameters
    ----------
    hard : ContactProblem
    lent : ContactProblem
        The same with compliance added to some pairs.
    answer : Solution
        A certified solution of ``lent``: its states are imposed.

    Returns
    -------
    Solution
        Of parts whose limit is not certified, or that were given nothing, the answer as it is.
    (m,) boolean array
        Pairs of parts whose answer is that of ``lent``.
    """
    left = np.zeros(hard.pairs, dtype=bool)
    stiff, soft = parts_of(hard), parts_of(lent)
    found = []
    for part, softer in zip(stiff, soft, strict=True):
        own = answer if len(stiff) == 1 else restricted(softer, answer)
        limit = _limit(part.problem, softer.problem, own)
        left[part.pairs] = limit is None
        found.append(own if limit is None else limit)
    if len(stiff) == 1:
        return found[0], left
    whole = merged(hard, stiff, found)
    return replace(whole, trace=answer.trace, info=answer.info, method=answer.method), left


def _limit(hard: ContactProblem, lent: ContactProblem, answer: Solution) -> Solution | None:
    """Return the limit of one part; None where it is not certified."""
    still = np.zeros_like(answer.displacement)
    u, t_n, t_t = still, answer.normal_force, answer.friction_force
    try:
        if still.size:  # else supports hold every block
            u, t_n, t_t = _States(hard, lent, answer).limit(answer)
    except SingularMatrixError:
        return None
    small = float(np.abs(u).max(initial=0.0)) <= NOTHING * float(np.abs(answer.displacement).max(initial=0.0))
    candidates = [(still if small else u, t_n, t_t), (still, answer.normal_force, answer.friction_force)]
    if small and (hard.gap.any() or hard.slip_origin.any()):  # else rounding would be measured against itself
        candidates.insert(0, (u, t_n, t_t))
    for forces in candidates:
        found = judge(
            hard, *forces, method=answer.method, iterations=answer.iterations,
            factorisations=answer.factorisations + 1, trace=answer.trace, info=answer.info,
        )  # fmt: skip
        if found.solved:
            return found
    return None


class _States:
    """The linear equations of the states of an answer; t is (m, d), normal force first."""

    def __init__(self, hard: ContactProblem, lent: ContactProblem, answer: Solution) -> None:
        self.hard, cone = hard, hard.cone
        states = pair_states(lent, answer)
        units = measure(lent, answer.displacement, answer.normal_force, answer.friction_force)
        force = units.pair_force
        self.open, self.closed, self.crushed, self.direction = (
            states.open, states.closed, states.crushed, states.direction,
        )  # fmt: skip
        self.stick = cone.rough & ~states.slips & (cone.strength(answer.normal_force) > AT_BOUND * force)
        self.C = interleaved(hard)
        self.a = compliances(hard)
        self.added = compliances(lent) - self.a
        if (self.added > 0).any():  # not so in a part that was given nothing, beside one that was
            self.added[self.a + self.added == 0] = self.added[self.added > 0].min()
        self._blocks()

    def _blocks(self) -> None:
        """Put together what t is, given position y = x + C u + a t: t = -D y + constant, D (m, d, d)."""
        m, d, law = self.hard.pairs, self.hard.dim, self.hard.laws
        soft = self.a + self.added
        D = np.zeros((m, d, d))
        lift = law.dilatancy[:, None] * self.direction  # a slipping pair: gap less dilatancy times slip is zero
        drag = -law.friction[:, None] * self.direction
        normal = soft[:, 0] - (lift * drag * soft[:, 1:]).sum(axis=1)
        stiff = np.where(self.closed & (normal > 0), 1.0 / np.where(normal > 0, normal, 1.0), 0.0)
        D[:, 0, 0] = stiff
        D[:, 0, 1:] = -stiff[:, None] * lift
        D[:, 1:, 0] = stiff[:, None] * drag
        D[:, 1:, 1:] = -stiff[:, None, None] * drag[:, :, None] * lift[:, None, :]
        for k in range(1, d):
            sticks = self.stick & (soft[:, k] > 0)
            D[sticks, k, k] = 1.0 / soft[sticks, k]
        self.D = D

    def limit(self, answer: Solution) -> tuple[Array, Array, Array]:
        hard = self.hard
        m, d = hard.pairs, hard.dim
        u = answer.displacement.copy()
        t = self.bound(np.column_stack([answer.normal_force, answer.friction_force.reshape(m, d - 1)]))
        springs = LOOSE * (float(np.abs(self.D).max(initial=0.0)) or float(abs(hard.K).max()) or 1.0)
        factor = BlockFactor(hard.K, self.C, m, hard.bodies, hard.engine)
        factor.factorise(self.D, springs)
        force, length = (float(np.abs(v).max(initial=0.0)) or 1.0 for v in (t, u))
        best, error = (u, t), np.inf
        for _ in range(ROUNDS):
            r_u, r_t = self.residuals(u, t)
            worst = max(float(np.abs(r_u).max(initial=0.0)) / force, float(np.abs(r_t).max(initial=0.0)) / length)
            if not np.isfinite(worst):
                break
            if worst < error:
                best, error = (u, t), worst
            push = np.einsum("kij,kj->ki", self.D, r_t)
            du = factor.solve(-r_u - self.C.T @ push.ravel())
            moved = (self.C @ du).reshape(m, d)
            u, t = u + du, self.bound(t - push - np.einsum("kij,kj->ki", self.D, moved))
        return best[0], best[1][:, 0], best[1][:, 1:]

    def bound(self, t: Array) -> Array:
        """Return forces with the values that the states prescribe."""
        cone = self.hard.cone
        t_n = np.where(self.open, -cone.tension, np.where(self.crushed, cone.cap, t[:, 0]))
        t_t = np.where(self.stick[:, None], t[:, 1:], -self.direction * cone.strength(t_n)[:, None])
        return np.column_stack([t_n, t_t])

    def residuals(self, u: Array, t: Array) -> tuple[Array, Array]:
        """Return K u - f - C't (N,) and the position that states forbid (m, d), by the hard problem's equations."""
        hard, m, d = self.hard, self.hard.pairs, self.hard.dim
        y = (self.C @ u).reshape(m, d) + self.a * t
        y[:, 0] += hard.gap
        y[:, 1:] -= hard.slip_origin
        lifted = y[:, 0] - hard.laws.dilatancy * (self.direction * y[:, 1:]).sum(axis=1)
        y[:, 0] = np.where(self.closed, lifted, 0.0)
        y[:, 1:] = np.where(self.stick[:, None], y[:, 1:], 0.0)
        elastic = hard.K @ u
        elastic = elastic - hard.R @ (hard.R.T @ elastic)
        return elastic - hard.f - self.C.T @ t.ravel(), y
