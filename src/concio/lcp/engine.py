"""Method ``interior-point``: interior point on the Coulomb problem, exact finish, and a homotopy for jammed states."""

from __future__ import annotations

from typing import Any

import numpy as np

from concio.contact.problem import ContactProblem
from concio.lcp.exact_finish import Finished, finish
from concio.lcp.homotopy import walk
from concio.lcp.interior_point import InteriorPoint
from concio.lcp.scaled import Scaled, scale
from concio.lcp.solution import Progress, ProgressCallback, Solution, Status, judge
from concio.lcp.sparse_factor import Engine

NAME = "interior-point"


class Cancelled(Exception):
    """Raised inside a run when the callback asks to stop."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    engine: Engine = "superlu",
    homotopy: bool = True,
    target: float = 1e-7,
    **options: Any,
) -> Solution:
    """Solve one load step.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    engine : {"superlu", "pardiso"}
        Sparse factorisation.
    homotopy : bool
        Walk from associated flow where the plain iteration fails.
    target : float
        Residual at which the interior point hands over to the exact finish, scaled units.

    Returns
    -------
    Solution
        SOLVED with its certificate, or GAVE_UP; this method proves no collapse.
    """
    scaled = scale(problem, engine)
    run = Run(scaled, progress, target)
    try:
        found = run.plain()
        if found is None and homotopy and scaled.rough.any():
            found = run.homotopy()
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return run.solution(found)


class Run:
    """One run on one problem: keeps count of work and the trace of what was tried.

    Parameters
    ----------
    scaled : Scaled
    progress : callable or None
    target : float
    """

    def __init__(self, scaled: Scaled, progress: ProgressCallback | None = None, target: float = 1e-7) -> None:
        self.scaled, self.progress, self.target = scaled, progress, target
        self.engine = InteriorPoint(scaled)
        self.iterations = 0
        self.trace: list[str] = []
        self.history: list[float] = []
        self.best: Finished | None = None

    def watch(self, stage: str) -> Any:
        """Return the callback of a stage."""

        def report(iteration: int, residual: float) -> bool:
            self.history.append(residual)
            if self.progress is not None and self.progress(Progress(NAME, len(self.history), residual, stage)):
                raise Cancelled
            return False

        return report

    def plain(self, most: int = 80) -> Finished | None:
        """Plain iteration from the standard start; return the exact answer or None."""
        z = self.engine.start()
        outcome = self.engine.run(z, target=self.target, most=most, watch=self.watch("interior point"))
        self.iterations += outcome.iterations
        self.trace.append(
            f"interior point: {outcome.iterations} iterations, residual {outcome.residual:.1e}"
            + ("" if outcome.converged else ", not converged")
        )
        return self.finish(z.u, z.t_n, z.t_t) if outcome.converged else None

    def homotopy(self) -> Finished | None:
        """Walk from associated flow; return the exact answer or None."""
        z, path = walk(self.engine, target=self.target, watch=self.watch("dilatancy homotopy"))
        self.iterations += path.iterations
        self.trace.append(
            f"dilatancy homotopy: {path.iterations} iterations, "
            + (f"stopped at theta = {path.theta:.3g}" if path.theta > 0 else "reached Coulomb friction")
        )
        return self.finish(z.u, z.t_n, z.t_t) if path.converged else None

    def finish(self, u: np.ndarray, t_n: np.ndarray, t_t: np.ndarray) -> Finished | None:
        """Exact finish of a point; return it if exact, None (and keep the best) if not."""
        found = finish(self.scaled, u, t_n, t_t)
        exact = found.error <= 1e-9
        self.trace.append(
            f"exact finish: {found.solves} linear solves, residual {found.error:.1e}"
            + ("" if exact else f", {len(found.undecided)} pairs undecided")
        )
        if self.best is None or found.error < self.best.error:
            self.best = found
        return found if exact else None

    def solution(self, found: Finished | None, failure: Status = Status.GAVE_UP, method: str = NAME) -> Solution:
        """Return the judged solution of what was found, or of the best point met."""
        s = self.scaled
        point = found or self.best
        if point is None:
            u, t_n, t_t = np.zeros(len(s.f)), s.tension.copy(), np.zeros(s.pairs)
        else:
            u, t_n, t_t = point.u, point.t_n, point.t_t
        u, t_n, t_t = s.restore(u, t_n, t_t)
        return judge(
            s.problem,
            u,
            t_n,
            t_t[:, None],
            method=method,
            failure=failure,
            iterations=self.iterations,
            factorisations=s.factor.count,
            trace=tuple(self.trace),
            info={"history": tuple(self.history), "engine": s.factor.engine, "ordering": s.factor.ordering},
        )
