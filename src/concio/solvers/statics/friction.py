r"""The least friction that admits equilibrium, between two proofs.

All friction coefficients are multiplied by one factor. At a factor that holds there are forces within the cones that
balance the loads; at one that is too small a mechanism excludes them. Both are proofs
(:mod:`concio.solvers.statics.existence`), and the answer is the pair of them, never a guess: where a programme decides
neither way the search goes round it and, if it must, ends with the bounds further apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.limits_of_work import FRICTION_PROGRAMMES
from concio.problem.parts import parts_of
from concio.problem.tolerances import WIDE_BRACKET
from concio.representation import short_repr
from concio.solvers.statics.existence import StaticState, admissible_near, statically_admissible
from concio.solvers.statics.mechanism import absorbed_power

LARGEST = 1024.0
"""Factor beyond which no friction is looked for: what falls with it falls with any."""


@short_repr
@dataclass(frozen=True)
class FrictionBounds:
    """Smallest common factor of the friction coefficients at which admissible forces still exist, as two proofs.

    Parameters
    ----------
    factor : float
        Smallest factor shown to hold: forces in balance were found with it. 0 where no friction is needed; above 1
        where the structure does not hold with the friction it has; ``inf`` where none was shown to hold up to
        :data:`LARGEST`.
    below : float
        Largest factor shown to be too small, by a mechanism; ``-inf`` where none was.
    programmes : int
        Linear programmes solved.
    """

    factor: float
    below: float
    programmes: int

    @property
    def settled(self) -> bool:
        """True where the two bounds meet, to the tolerance asked for, or one of them is the end of the range."""
        if self.factor == 0.0:
            return True
        if np.isinf(self.factor):
            return self.below >= LARGEST
        return self.factor - self.below <= WIDE_BRACKET * self.factor


BELOW = 0.1
"""Share of the bracket by which a trial lies below an upper bound that Newton's step has not come under."""


APART = 16.0
"""Times as far from Newton's step lies the next trial where one next to it was undecided."""


CLOSE = 0.03
"""Gap of a programme of Newton's method, as a share of what its multiplier is away from one."""


NEARLY = 0.5
"""Its step, relative, below which the next factor is taken for the answer, and a trial made on either side of that."""


LARGE = 2000
"""Pairs from which on these trials lie :data:`APART` times as far: nearer ones are undecided there and take longer."""


NEWTON = 8
"""Largest number of its steps."""


class _Search:
    """Asks whether factors hold, and keeps the closest proofs either way."""

    def __init__(self, problem: ContactProblem) -> None:
        self.problem, self.programmes = problem, 0
        self.low, self.high = -np.inf, np.inf
        self.guess, self.thorough = np.nan, problem.dim == 2
        self.normal: Array | None = None
        self.whole = problem.dim == 3 and sum(part.unknowns.size > 0 for part in parts_of(problem)) == 1

    def by_all_means(self, factor: float) -> bool | None:
        """Ask, and where that decides nothing, ask with pivoting."""
        holds = self.ask(factor)
        if holds is None and not self.thorough:
            self.thorough = True
            holds = self.ask(factor)
            self.thorough = False
        return holds

    def ask(self, factor: float) -> bool | None:
        """Return True with forces, False with a mechanism, None with neither; the guess is the dual's next factor."""
        scaled = self.problem.with_friction(factor)
        self.programmes += 1
        if self.normal is None or self.thorough:
            state = statically_admissible(scaled, thorough=self.thorough)
            normal = state.normal_force
        else:
            state, normal = admissible_near(scaled, self.normal)
        return self._noted(factor, state, self._next(scaled, state.velocity, normal, factor))

    def _noted(self, factor: float, state: StaticState, following: float) -> bool | None:
        """Keep what a state proves; the guess is that of the largest factor that does not hold."""
        if state.exists:
            if factor < self.high:
                self.high, self.normal = factor, state.normal_force if self.whole else None
            return True
        if state.mechanism is None:
            return None
        if factor > self.low:
            self.low, self.guess = factor, following
        return False

    @property
    def settled(self) -> bool:
        """True where the proofs are as close as an answer asks for: closer ones are worth no dear programme."""
        return self.high - self.low <= WIDE_BRACKET * self.high < np.inf

    def newton(self, factor: float) -> float:
        """Return the factor to which Newton's method converges from one that holds, to a hundredth of a bracket.

        What grows with the friction is the largest multiplier of the load that the normal forces of the last factor
        that held do not balance. It is nearly linear, on either side of the answer. Both sides leave their proofs.
        """
        for _ in range(NEWTON):
            assert self.normal is not None
            scaled = self.problem.with_friction(factor)
            state, normal = admissible_near(scaled, self.normal, CLOSE)
            self.programmes += 1
            following = self._next(scaled, state.velocity, normal, factor)
            self._noted(factor, state, following)
            if not self.low < following < self.high or not following > 0.0:
                return np.nan
            if abs(following - factor) < NEARLY * following:
                return following
            factor = following
        return np.nan

    def _next(self, scaled: ContactProblem, v: Array, t_n: Array, factor: float) -> float:
        """Return the factor at which a motion (N,) would neither gain nor lose power: Newton's step."""
        problem = self.problem
        w_t = np.linalg.norm((problem.C_t @ v).reshape(problem.pairs, -1), axis=1)
        slope = float((t_n * problem.laws.friction * w_t).sum())
        short = float(scaled.f @ v) - absorbed_power(scaled, v)
        return factor + short / slope if slope > 0 else np.nan

    def bracket(self) -> bool:
        """Find one factor that holds, upwards from 1, and one that does not; return whether both were found."""
        factor = 1.0
        while factor <= LARGEST and not self.by_all_means(factor):
            factor *= 2.0
        if self.whole and np.isfinite(self.high):
            self.guess = self.newton(self.high)
        if not np.isfinite(self.low) and self.by_all_means(0.0):
            return False
        return bool(np.isfinite(self.high) and np.isfinite(self.low))

    def close_in(self, width: float) -> None:
        """Shrink the bracket: Newton's method from below, kept within it, and bisection; round what is undecided.

        Newton's step ends above the answer where what is missing is a concave function of the friction. Then the upper
        bound is close, and the next trial lies below it by a share of the bracket that shrinks while that proves right.
        Programmes pivot only where nothing else brings the proofs as close as an answer asks for.
        """
        shares = (0.5, 0.25, 0.75, 0.125, 0.875)
        undecided, short, step = 0, BELOW, 0.25 * width * (APART if self.whole and self.problem.pairs > LARGE else 1.0)
        while self.high - self.low > width and self.programmes < FRICTION_PROGRAMMES:
            beyond = False
            inside = np.isfinite(self.guess) and self.low < self.guess + step < self.high - step
            apart = step > 0.25 * width  # a trial next to Newton's step was undecided: one on either side is as close
            if inside and undecided <= apart:
                trial = max(self.guess + step, self.low + step)
            elif apart and not undecided and self.low < self.guess - step < self.high <= self.guess + 2.0 * step:
                trial = self.guess - step
            elif np.isfinite(self.guess) and self.guess + step >= self.high - step and not undecided:
                beyond = True
                trial = self.high - min(max(short, step / (self.high - self.low)), 0.5) * (self.high - self.low)
            else:
                trial = self.low + shares[undecided] * (self.high - self.low)
            holds = self.ask(trial)
            step *= APART if holds is None and not self.thorough else 1.0
            if beyond and holds is not None:
                short = min(4.0 * short, 0.5) if holds else max(0.1 * short, 1e-3)
            undecided = undecided + 1 if holds is None else 0
            if self.settled and step > 0.25 * width:
                break  # closer, programmes decide less and less
            if undecided == len(shares):
                if self.thorough:
                    break
                undecided, self.thorough = 0, True


def smallest_friction(problem: ContactProblem, *, tolerance: float = 1e-7) -> FrictionBounds:
    """Find the smallest friction that still admits equilibrium under the problem's loads (associated bound).

    What is left unbalanced falls to zero as friction grows, and its slope is known from the dual motion,
    -sum t_n mu |w_t|: Newton's method from below, within a bracket of proofs that bisection shrinks.

    Parameters
    ----------
    problem : ContactProblem
    tolerance : float
        Width of the final bracket.
    """
    search = _Search(problem)
    if search.bracket():
        search.close_in(tolerance * max(1.0, search.high))
    return FrictionBounds(search.high, search.low, search.programmes)
