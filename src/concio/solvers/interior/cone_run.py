"""Method ``interior-point`` in space: round cones, starts tried in turn, each brought to an exact answer or left."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.problem.tolerances import EXACT
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.algebra.sparse_factor import Engine
from concio.solvers.interior.cone_iteration import ConeIteration, ConePoint
from concio.solvers.interior.engine import Cancelled, Run, at_rest
from concio.solvers.interior.newton_finish import STALE, finish
from concio.solvers.states.reading import Finished

TARGETS = (1e-6, 1e-8, 1e-10)
"""Merits at which the exact finish is tried; a deeper point tells states apart that the one before does not."""

MOST = 100
"""Largest number of iterations to each target."""

NEAR = 1e-5
"""Merit of a run that stopped by itself at which the exact finish is worth trying."""

WEIGHTS = (1.0, 0.1, 10.0)
"""Weights of lengths against forces tried in the exact finish."""


@dataclass(frozen=True)
class Start:
    """A starting point and how boldly the iteration goes from there.

    Parameters
    ----------
    force, length : float
        Size of forces and of gaps and slips, scaled units.
    share : float
        Share of the step to the boundary that is taken.
    """

    force: float
    length: float
    share: float = 0.99

    def __str__(self) -> str:
        return f"{self.force:g}/{self.length:g}" + ("" if self.share == 0.99 else f" with steps of {self.share:g}")


STARTS = (Start(10.0, 100.0), Start(100.0, 100.0), Start(10.0, 10.0), Start(10.0, 10.0, 0.7))
"""Starts in the order tried: gaps far outside halve the iterations between hard joints, short steps come through where
others jam."""

SOFT_STARTS = (STARTS[2], STARTS[0], STARTS[1], STARTS[3])
"""The same where every joint gives way: from nearby a quarter less iterations, and not half of them in large walls."""


def starts_for(scaled: Scaled) -> tuple[Start, ...]:
    """Return the starts in the order to try on a problem."""
    return SOFT_STARTS if bool((scaled.compliance[:, 0] > 0).all()) else STARTS


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    engine: Engine | None = None,
    starts: int = len(STARTS),
    near: tuple[Array, Array, Array] | None = None,
) -> Solution:
    """Solve one load step of a problem of any dimension.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    engine : {"superlu", "pardiso"}, optional
        Sparse factorisation.
    starts : int
        How many starts are tried in turn, at most.
    near : arrays, optional
        Displacements [m], t_n and t_t [kN] of a state from which Newton's method is tried first.

    Returns
    -------
    Solution
        SOLVED with its certificate, or GAVE_UP; this method proves no collapse.
    """
    rest = at_rest(problem)
    if rest is not None:
        return rest
    run = ConeRun(scale(problem, engine), progress)
    try:
        found = None if near is None else run.settle(*run.scaled.bring(*near), WEIGHTS[:1])
        for start in starts_for(run.scaled)[:starts]:
            found = found or run.from_start(start)
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return run.solution(found)


class ConeRun(Run):
    """One run on one problem of any dimension: keeps count of work and the trace of what was tried.

    Parameters
    ----------
    scaled : Scaled
    progress : callable or None
    """

    def __init__(self, scaled: Scaled, progress: ProgressCallback | None = None) -> None:
        super().__init__(scaled, progress)
        self.cones = ConeIteration(scaled)

    def from_start(self, start: Start) -> Finished | None:
        """Iterate from a start; return the exact answer or None. Without pairs there is nothing to iterate."""
        if not self.scaled.problem.pairs:
            return self.settle(self.scaled.glued, np.zeros((0, self.scaled.problem.dim)))
        z = self.cones.start(start.force, start.length)
        return self.approach(z, f"interior point from {start}", start.share)

    def attempts(self, further: Iterable[Any] = ()) -> Iterator[Finished | None]:
        """Return what the interior point finds from each start in turn, and from further ones."""
        return (self.from_start(start) for start in (*starts_for(self.scaled), *further))

    def associated_state(self) -> Array:
        """Return the displacements (N,), scaled, at which associated flow holds the structure, or nearly so."""
        z = self.cones.start(STARTS[0].force, STARTS[0].length)
        outcome = self.cones.run(z, theta=1.0, target=1e-6, watch=self.watch("associated flow"))
        self.iterations += outcome.iterations
        return z.u

    def approach(self, z: ConePoint, stage: str, share: float) -> Finished | None:
        """Iterate to ever smaller targets, trying the exact finish at each, until it succeeds or nothing moves."""
        for target in TARGETS:
            outcome = self.cones.run(z, target=target, most=MOST, share=share, watch=self.watch(stage))
            self.iterations += outcome.iterations
            self.trace.append(
                f"{stage}: {outcome.iterations} iterations, residual {outcome.merit:.1e}"
                + ("" if outcome.converged else ", stopped")
            )
            if outcome.converged or outcome.merit < NEAR:
                last = target == TARGETS[-1] or not outcome.converged
                found = self.settle(z.u, z.t, WEIGHTS if last else WEIGHTS[:1], 20 if last else 6)
                if found is not None:
                    return found
            if not outcome.converged:
                break
        return None

    def settle(
        self, u: Array, t: Array, weights: tuple[float, ...] = WEIGHTS, rounds: int = 20, patience: int = STALE
    ) -> Finished | None:
        """Exact finish of a point by Newton's method; return it if its certificate holds, None if not."""
        for weight in weights:
            found = finish(self.scaled, u, t, rho=weight, rounds=rounds, patience=patience)
            settled = found.error <= EXACT
            exact = settled and self.certified(found)
            left = f", {len(found.undecided)} pairs undecided" if not settled else "" if exact else ", runs off"
            self.trace.append(f"exact finish: {found.solves} linear solves, residual {found.error:.1e}{left}")
            if (exact or not settled) and (self.best is None or found.error < self.best.error):
                self.best = found
            if exact:
                return found
        return None
