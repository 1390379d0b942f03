"""A run of the interior point: starts tried in turn, each brought to an exact answer or left, and what was tried."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from concio.problem.certificate import certify
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.pair_state import PairStates
from concio.problem.solution import Progress, ProgressCallback, Solution, Status, judge
from concio.problem.tolerances import EXACT, RESTING
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.interior.homotopy import walk
from concio.solvers.interior.interior_point import EARLY, SHARE, InteriorPoint
from concio.solvers.interior.newton_finish import STALE, finish
from concio.solvers.interior.point import Point
from concio.solvers.states.settle import ROUNDS, TOGETHER, Settler
from concio.solvers.states.state_reading import Finished, read_states

NAME = "interior-point"

TARGETS = (1e-6, 1e-8, 1e-10)
"""Merits at which the exact finish is tried; a deeper point tells states apart that the one before does not."""

MOST = {2: 80, 3: 120}
"""Largest number of iterations from a start, by dimension."""

NEAR = 1e-5
"""Merit of a run that stopped by itself at which the exact finish is worth trying."""

WEIGHTS = (1.0, 0.1, 10.0)
"""Weights of lengths against forces tried in Newton's exact finish."""


class Cancelled(Exception):
    """Raised inside a run when the callback asks to stop."""


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
    share: float = SHARE

    def __str__(self) -> str:
        size = f"{self.force:g}" if self.force == self.length else f"{self.force:g}/{self.length:g}"
        return size + ("" if self.share == SHARE else f" with steps of {self.share:g}")


SIZES = (10.0, 100.0, 1000.0)
"""Sizes of the starting points that are tried in turn in the plane; jammed structures want the larger."""

STARTS = (Start(10.0, 100.0), Start(100.0, 100.0), Start(10.0, 10.0), Start(10.0, 10.0, 0.7))
"""Starts in space in the order tried: gaps far outside halve the iterations between hard joints, short steps come
through where others jam."""

SOFT_STARTS = (STARTS[2], STARTS[0], STARTS[1], STARTS[3])
"""The same where every joint gives way: from nearby a quarter less iterations, and not half of them in large walls."""


def starts_for(scaled: Scaled) -> tuple[Start, ...]:
    """Return the starts in the order to try on a problem."""
    if scaled.dim == 2:
        return tuple(Start(size, size) for size in SIZES)
    return SOFT_STARTS if bool((scaled.compliance[:, 0] > 0).all()) else STARTS


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

    def worth_trying(self, z: Point, residual: float) -> bool:
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
    """One run on one problem of any dimension: keeps count of work and the trace of what was tried.

    Parameters
    ----------
    scaled : Scaled
    progress : callable or None
    least : bool
        Whether forces that equilibrium leaves open are the least; otherwise those at which the iteration ended, in the
        middle of what the joint laws allow.
    """

    def __init__(self, scaled: Scaled, progress: ProgressCallback | None = None, *, least: bool = True) -> None:
        self.scaled, self.progress, self.least = scaled, progress, least
        self.iterations = 0
        self.trace: list[str] = []
        self.history: list[float] = []
        self.best: Finished | None = None
        self.judged: tuple[Finished, Solution] | None = None
        self.engine = InteriorPoint(scaled)

    @cached_property
    def settler(self) -> Settler:
        """The active set of plane problems."""
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

    def from_start(self, start: Start) -> Finished | None:
        """Iterate from a start; return the exact answer or None. Without pairs there is nothing to iterate."""
        if not self.scaled.pairs:
            return self.finish(self.scaled.glued, np.zeros((0, self.scaled.dim)))
        z = self.engine.start(start.force, start.length)
        return self.close_in(z, f"interior point from {start}", start.share)

    def from_near(self, u: Array, t: Array) -> Finished | None:
        """Iterate from a state nearby, displacements (N,) and forces (m, d) scaled; return the exact answer or None."""
        return self.close_in(self.engine.near(u, t), "interior point from nearby", patient=False)

    def attempts(self, further: Iterable[Start] = ()) -> Iterator[Finished | None]:
        """Return what the interior point finds from each start in turn, and from further ones."""
        return (self.from_start(start) for start in (*starts_for(self.scaled), *further))

    def close_in(self, z: Point, stage: str, share: float = SHARE, *, patient: bool = True) -> Finished | None:
        """Iterate to ever smaller targets, trying the exact finish at each, until it succeeds or nothing moves."""
        found, targets, early = None, list(TARGETS), EarlyFinish(self.scaled)
        most, ready = MOST[self.scaled.dim], early.worth_trying if self.scaled.dim == 2 else None
        while targets and found is None:
            z, outcome = self.engine.run(
                z, target=targets[0], most=most, share=share, patient=patient, watch=self.watch(stage), ready=ready
            )
            self.iterations += outcome.iterations
            most -= outcome.iterations
            handed = outcome.why == EARLY
            self.trace.append(
                f"{stage}: {outcome.iterations} iterations, residual {outcome.residual:.1e}"
                + ("" if outcome.converged else f", {EARLY}" if handed else ", stopped")
            )
            if handed:
                found = self.settle(z.u, z.t, early.rounds, early.FLIPS)
            elif outcome.converged or outcome.residual < NEAR:
                found = self.finish(z.u, z.t, last=len(targets) == 1 or not outcome.converged)
            if outcome.converged:
                del targets[0]
            elif not handed:
                break
        return found

    def sticking(self) -> Finished | None:
        """Return the exact answer of a plane problem near the state in which every pair sticks; None where none is."""
        if not self.scaled.deforms:
            return None
        found = self.settler.from_sticking(self.scaled)
        if found is None:
            return None
        self.watch("all pairs stick at first")(0, found.error)
        self.trace.append("all pairs stick at first: those that are contradicted change together")
        return self._judged(found, settled=True)

    def homotopy(self) -> Finished | None:
        """Walk from associated flow; return the exact answer or None."""
        z, path = walk(self.engine, watch=self.watch("dilatancy homotopy"))
        self.iterations += path.iterations
        self.trace.append(
            f"dilatancy homotopy: {path.iterations} iterations, "
            + (f"stopped at theta = {path.theta:.3g}" if path.theta > 0 else "reached Coulomb friction")
        )
        return self.close_in(z, "interior point from there") if path.theta == 0 else None

    def associated_state(self) -> Array:
        """Return the displacements (N,), scaled, at which associated flow holds the structure, or nearly so."""
        z = self.engine.start(STARTS[0].force, STARTS[0].length)
        z, outcome = self.engine.run(z, theta=1.0, target=1e-6, watch=self.watch("associated flow"))
        self.iterations += outcome.iterations
        return z.u

    def finish(self, u: Array, t: Array, *, last: bool = True) -> Finished | None:
        """Exact finish of a point: by the active set in the plane, by Newton's method in space.

        Newton's method takes its time where it is the ``last`` try.
        """
        if self.scaled.dim == 2:
            return self.settle(u, t)
        return self.newton(u, t, WEIGHTS if last else WEIGHTS[:1], 20 if last else 6)

    def settle(self, u: Array, t: Array, rounds: int = ROUNDS, flips: int = ROUNDS) -> Finished | None:
        """Exact finish of a plane point by the active set; return it if its certificate holds, None if not."""
        if self.history:
            self.tell("exact finish")
        found = self.settler.settle(self.scaled, u, t, rounds=rounds, flips=flips, least=self.least)
        return self._judged(found, settled=found.settled)

    def newton(
        self, u: Array, t: Array, weights: tuple[float, ...] = WEIGHTS, rounds: int = 20, patience: int = STALE
    ) -> Finished | None:
        """Exact finish of a point by Newton's method; return it if its certificate holds, None if not."""
        for weight in weights:
            found = finish(self.scaled, u, t, rho=weight, rounds=rounds, patience=patience, least=self.least)
            if self._judged(found, settled=found.error <= EXACT) is not None:
                return found
        return None

    def _judged(self, found: Finished, *, settled: bool) -> Finished | None:
        """Return a point if it is exact, None (and keep the best) if not.

        The finish measures against the largest force and displacement of the point itself. A point that runs off has
        them as large as it likes; it is exact only where the certificate, which measures against the load, says so.
        """
        exact = settled and self.certified(found)
        left = f", {len(found.undecided)} pairs undecided" if not settled else ", runs off" if not exact else ""
        self.trace.append(f"exact finish: {found.solves} linear solves, residual {found.error:.1e}{left}")
        if (exact or not settled) and (self.best is None or found.error < self.best.error):
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
        small = float(np.abs(u).max(initial=0.0)) < RESTING
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
