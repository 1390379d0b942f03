"""Method ``interior-point``: interior point on the Coulomb problem, exact finish, and a homotopy for jammed states."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from concio.problem.certificate import certify
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.pair_state import PairStates
from concio.problem.solution import Progress, ProgressCallback, Solution, Status, judge
from concio.solvers.algebra.scaled import Scaled, require_plane, scale
from concio.solvers.algebra.sparse_factor import Engine
from concio.solvers.interior.homotopy import walk
from concio.solvers.interior.interior_point import EARLY, START, InteriorPoint
from concio.solvers.interior.iterate import Iterate
from concio.solvers.states.reading import Finished, read_states
from concio.solvers.states.settle import ROUNDS, TOGETHER, Settler

NAME = "interior-point"

AT_REST = 1e-6
"""Largest scaled displacement that is tried as zero; elastic bodies under load move by about one."""

TARGETS = (1e-6, 1e-8, 1e-10)
"""Relative residuals at which the exact finish is tried."""

STARTS = (10.0, 100.0, 1000.0)
"""Sizes of the starting points that are tried in turn; jammed structures want the larger."""


class Cancelled(Exception):
    """Raised inside a run when the callback asks to stop."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    engine: Engine | None = None,
    homotopy: bool = True,
    starts: tuple[float, ...] = STARTS,
) -> Solution:
    """Solve one load step.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    engine : {"superlu", "pardiso"}, optional
        Sparse factorisation.
    homotopy : bool
        Walk from associated flow where the plain iteration fails.
    starts : tuple of float
        Sizes of the starting points tried in turn.

    Returns
    -------
    Solution
        SOLVED with its certificate, or GAVE_UP; this method proves no collapse.
    """
    rest = at_rest(problem)
    if rest is not None:
        return rest
    require_plane(problem)
    scaled = scale(problem, engine)
    run = Run(scaled, progress)
    try:
        found = None
        for start in starts:
            found = found or run.plain(start)
        if found is None and homotopy and scaled.rough.any():
            found = run.homotopy()
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return run.solution(found)


def at_rest(problem: ContactProblem) -> Solution | None:
    """Return the answer without motion and forces where nothing acts: no load, no pushed support, no slip origin."""
    if problem.f.any() or (problem.gap < 0).any() or problem.slip_origin.any():
        return None
    m = problem.pairs
    rest = judge(problem, np.zeros(problem.unknowns), np.zeros(m), np.zeros((m, problem.dim - 1)), method=NAME)
    return replace(rest, trace=("nothing acts on the structure: it rests",)) if rest.solved else None


class EarlyFinish:
    """Tells when the exact finish is worth trying before the iteration has converged: its states hardly change.

    Parameters
    ----------
    s : Scaled
    """

    FLIPS: ClassVar = 2
    """Factorisations that such a try may cost beyond the first."""
    LARGE: ClassVar = 500
    """Pairs from which on such a try decides pairs in question. On few pairs iterations cost no more than deciding, and
    of several answers they end in the middle: the symmetric one of a symmetric structure."""
    FEW: ClassVar = 0.02
    SHARE: ClassVar = 0.01
    """Shares of the pairs that may differ: up to as many as are decided together, and however many there are."""
    CLOSE: ClassVar = 0.1
    """Residual from which on states mean something."""
    AGAIN: ClassVar = 0.5
    """Share of the changes at the last try at which it is tried again."""

    def __init__(self, s: Scaled) -> None:
        self.s = s
        self.rounds = ROUNDS if s.pairs >= self.LARGE else 0
        self.states: PairStates | None = None
        self.fewer = max(min(TOGETHER, self.FEW * s.pairs), self.SHARE * s.pairs)

    def worth_trying(self, z: Iterate, residual: float) -> bool:
        """Note the states of a point; return whether few enough differ from those of the point before."""
        if self.fewer < 0:
            return False
        before = self.states
        self.states = read_states(self.s, z.u, z.t) if residual < self.CLOSE else None
        if before is None or self.states is None:
            return False
        changed = int(self.states.differ(before).sum())
        if changed > self.fewer:
            return False
        self.states, self.fewer = None, self.AGAIN * changed if changed else -1.0
        return True


class Run:
    """One run on one problem: keeps count of work and the trace of what was tried.

    Parameters
    ----------
    scaled : Scaled
    progress : callable or None
    """

    def __init__(self, scaled: Scaled, progress: ProgressCallback | None = None) -> None:
        self.scaled, self.progress = scaled, progress
        self.iterations = 0
        self.trace: list[str] = []
        self.history: list[float] = []
        self.best: Finished | None = None
        self.judged: tuple[Finished, Solution] | None = None

    @cached_property
    def engine(self) -> InteriorPoint:
        """The iteration on plane problems."""
        return InteriorPoint(self.scaled)

    @cached_property
    def settler(self) -> Settler:
        """What settles states of plane problems."""
        return Settler(self.scaled)

    def tell(self, stage: str) -> None:
        """Call back with the last residual; raise :class:`Cancelled` where the callback asks to stop."""
        if self.progress is not None and self.progress(Progress(NAME, len(self.history), self.history[-1], stage)):
            raise Cancelled

    def watch(self, stage: str) -> Any:
        """Return the callback of a stage."""

        def report(iteration: int, residual: float) -> bool:
            self.history.append(residual)
            self.tell(stage)
            return False

        return report

    def plain(self, start: float = START, most: int = 80) -> Finished | None:
        """Iterate from the standard start of a size; return the exact answer or None."""
        z = self.engine.start(start)
        return self.close_in(z, f"interior point from {start:g}", 0.0, most)

    def attempts(self, further: Iterable[Any] = ()) -> Iterator[Finished | None]:
        """Return what the interior point finds from each start in turn, and from further ones."""
        return (self.plain(start) for start in (*STARTS, *further))

    def close_in(self, z: Iterate, stage: str, theta: float = 0.0, most: int = 80) -> Finished | None:
        """Iterate to ever smaller targets, trying the exact finish at each, until it succeeds or nothing moves."""
        found, targets, early = None, list(TARGETS), EarlyFinish(self.scaled)
        while targets and found is None:
            z, outcome = self.engine.run(
                z, theta=theta, target=targets[0], most=most, watch=self.watch(stage), ready=early.worth_trying
            )
            self.iterations += outcome.iterations
            most -= outcome.iterations
            handed = outcome.why == EARLY
            self.trace.append(
                f"{stage}: {outcome.iterations} iterations, residual {outcome.residual:.1e}"
                + ("" if outcome.converged else f", {EARLY}" if handed else ", stopped")
            )
            if outcome.converged or handed or outcome.residual < 1e-5:
                found = self.finish(z.u, z.t, early.rounds, early.FLIPS) if handed else self.finish(z.u, z.t)
            if outcome.converged:
                del targets[0]
            elif not handed:
                break
        return found

    def homotopy(self) -> Finished | None:
        """Walk from associated flow; return the exact answer or None."""
        z, path = walk(self.engine, watch=self.watch("dilatancy homotopy"))
        self.iterations += path.iterations
        self.trace.append(
            f"dilatancy homotopy: {path.iterations} iterations, "
            + (f"stopped at theta = {path.theta:.3g}" if path.theta > 0 else "reached Coulomb friction")
        )
        return self.close_in(z, "interior point from there") if path.theta == 0 else None

    def finish(self, u: Array, t: Array, rounds: int = ROUNDS, flips: int = ROUNDS) -> Finished | None:
        """Exact finish of a point; return it if exact, None (and keep the best) if not.

        The finish measures against the largest force and displacement of the point itself. A point that runs off has
        them as large as it likes; it is exact only where the certificate, which measures against the load, says so.
        """
        if self.history:
            self.tell("exact finish")
        found = self.settler.settle(self.scaled, u, t, rounds=rounds, flips=flips)
        exact = found.settled and self.certified(found)
        left = f", {len(found.undecided)} pairs undecided" if not found.settled else ", runs off" if not exact else ""
        self.trace.append(f"exact finish: {found.solves} linear solves, residual {found.error:.1e}{left}")
        if (exact or not found.settled) and (self.best is None or found.error < self.best.error):
            self.best = found
        return found if exact else None

    def certified(self, found: Finished) -> bool:
        """Return whether a point is an equilibrium by its certificate."""
        self.judged = found, self.solution(found)
        return self.judged[1].solved

    def solution(self, found: Finished | None, failure: Status = Status.GAVE_UP, method: str = NAME) -> Solution:
        """Return the judged solution of what was found, or of the best point met."""
        s = self.scaled
        point = found or self.best
        work: dict[str, Any] = {
            "iterations": self.iterations,
            "factorisations": s.factor.made,
            "trace": tuple(self.trace),
            "info": {"history": tuple(self.history), "engine": s.factor.engine, "ordering": s.factor.ordering},
        }
        if self.judged is not None and self.judged[0] is point and self.judged[1].solved:
            return replace(self.judged[1], method=method, **work)
        if point is None:
            u, t = np.zeros(len(s.f)), s.unstressed
        else:
            u, t = point.u, point.t
        small = float(np.abs(u).max(initial=0.0)) < AT_REST
        u, t_n, t_t = s.restore(u, t)
        rest = np.zeros_like(u)
        if small and certify(s.problem, rest, t_n, t_t).certified:
            u = rest  # nothing moves: rounding must not be measured against itself
        return judge(
            s.problem,
            u,
            t_n,
            t_t,
            method=method,
            failure=failure,
            **work,
        )
