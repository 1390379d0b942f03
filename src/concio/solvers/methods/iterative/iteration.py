"""What every iterative method keeps while it works: residuals, work, counts; and how it says what it reached.

*Work* is counted in factorisations of ``K + C'C``: a factorisation is 1, a pair of triangular solves the share of
its floating-point operations (from the column counts of the factor), so that Newton methods and first-order methods
can be drawn on one axis, independently of the machine.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from concio.errors import MethodError
from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import Progress, ProgressCallback, Solution, Status, judge
from concio.problem.tolerances import CERTIFIED
from concio.solvers.algebra.block_factor import BlockFactor
from concio.solvers.algebra.scaled import Scaled
from concio.solvers.algebra.sparse_factor import SingularMatrixError

TINY = 1e-9
"""Loads and displacements below this, scaled, are none."""

GOAL = 1e-11
"""Residual at which the methods stop, a hundredth of what the certificate asks."""


class Stopped(Exception):
    """The run ends here: the progress callback asked for it, or a matrix was singular.

    Parameters
    ----------
    cancelled : bool
        Whether it was the callback.
    """

    def __init__(self, *, cancelled: bool) -> None:
        self.cancelled = cancelled
        super().__init__()


@dataclass
class Record:
    """The record of one run of a method.

    Parameters
    ----------
    method : str
    scaled : Scaled
        Its factor does the work.
    progress : callable, optional
    budget : int, optional
        Iterations after which a run with nested loops ends.
    """

    method: str
    scaled: Scaled
    progress: ProgressCallback | None = None
    history: list[float] = field(default_factory=list)
    work: list[float] = field(default_factory=list)
    trace: list[str] = field(default_factory=list)
    info: dict[str, Any] = field(default_factory=dict)
    factorisations: int = 1  # the glued structure
    best: tuple[float, Array, Array] | None = None
    budget: int | None = None
    _spent: float = 1.0
    _solve_share: float = 0.0

    def factorise(self, D: Array, diagonal: float) -> BlockFactor:
        """Factorise K + C' D C + diagonal for blocks D (m, d, d), count it, and return the factor.

        Raises
        ------
        Stopped
            The matrix is singular, or not finite.
        """
        factor = self.scaled.factor
        try:
            factor.factorise(D, diagonal)
        except SingularMatrixError as error:
            self.trace.append(f"a matrix could not be factorised ({error}).")
            raise Stopped(cancelled=False) from error
        self.factorisations += 1
        self._spent += 1.0
        if not self._solve_share:
            self._solve_share = factor.numeric.solve_share()
        return factor

    def solves(self, count: int = 1) -> None:
        """Count ``count`` pairs of triangular solves."""
        self._spent += count * self._solve_share

    def note(self, u: Array, t: Array, message: str = "") -> float:
        """Record the state after an iteration, keep it if it is the best so far, and return its residual.

        Raises
        ------
        Stopped
            The progress callback asked to stop, or the budget of iterations is used up.
        """
        residual = residual_of(self.scaled, u, t)
        residual = residual if np.isfinite(residual) else np.inf
        self.history.append(residual)
        self.work.append(self._spent)
        if self.best is None or residual < self.best[0]:
            self.best = (residual, u.copy(), t.copy())
        if self.progress and self.progress(Progress(self.method, len(self.history), residual, message)):
            raise Stopped(cancelled=True)
        if self.budget is not None and len(self.history) >= self.budget and residual > GOAL:
            self.trace.append(f"the {self.budget} iterations allowed are used up.")
            raise Stopped(cancelled=False)
        return residual

    def stalled(self, window: int, factor: float = 0.5) -> bool:
        """Whether the best residual of the last ``window`` iterations is not below ``factor`` times that before."""
        if len(self.history) <= 2 * window:
            return False
        return min(self.history[-window:]) > factor * min(self.history[:-window])


def residual_of(s: Scaled, u: Array, t: Array) -> float:
    """Bound on the certificate: imbalance over the load, natural map over the smaller of load and displacement."""
    load = s.problem.total_load / s.force or max(float(np.abs(t).max(initial=0.0)), TINY)
    size = max(float(np.abs(u).max(initial=0.0)), TINY if s.deforms else 1.0)
    imbalance = float(np.abs(s.imbalance(u, t)).max(initial=0.0))
    law = float(np.abs(s.natural_map(u, t)).max(initial=0.0))
    return max(imbalance / load, law / min(load, size, 1.0))


def require_positive(name: str, value: float, hint: str) -> None:
    """Refuse an option of a method that is not above zero.

    Parameters
    ----------
    name, value
        What the option is called in the message, and what was given.
    hint : str
        What to do.

    Raises
    ------
    MethodError
        ``value`` is zero, negative or not a number.
    """
    if not value > 0:
        msg = f"{name} {value} is not positive"
        raise MethodError(msg, hint=hint)


def answer(problem: ContactProblem, record: Record, *, cancelled: bool = False) -> Solution:
    """Judge the best state of a record; what is not certified is reported with the accuracy it reached."""
    scaled = record.scaled
    _, u, t = record.best if record.best is not None else (np.inf, scaled.glued, scaled.start)
    restored = scaled.restore(u, t)
    solution = _judge(problem, record, restored, cancelled=cancelled, accuracy=None)
    if not solution.solved and record.best is not None:
        # rigid bodies that do not move, bodies nothing loads: zero is the exact answer, rounding noise is not
        nothing = np.zeros_like(u), np.zeros_like(restored[1]), np.zeros_like(restored[2])
        for exact in ((nothing[0], *restored[1:]), (restored[0], *nothing[1:])):
            tried = _judge(problem, record, exact, cancelled=cancelled, accuracy=None)
            if tried.solved:
                return tried
            if not scaled.deforms and tried.certificate.worst < solution.certificate.worst:
                solution, restored = tried, exact
    if cancelled or solution.solved:
        return solution
    return _judge(problem, record, restored, cancelled=False, accuracy=solution.certificate.as_dict())


def _judge(
    problem: ContactProblem,
    record: Record,
    restored: tuple[Array, Array, Array],
    *,
    cancelled: bool,
    accuracy: dict[str, float] | None,
) -> Solution:
    trace = list(record.trace)
    info: dict[str, Any] = {**record.info, "history": list(record.history), "work": list(record.work)}
    if accuracy is not None:
        worst = accuracy["worst"]
        entry = max((k for k in accuracy if k != "worst"), key=lambda k: accuracy[k])
        info["accuracy"] = worst
        trace.append(
            f"stopped after {len(record.history)} iterations at an accuracy of {worst:.1e} "
            f"(worst entry: {entry.replace('_', ' ')}); {CERTIFIED:.0e} is required of an answer."
        )
    solution = judge(
        problem,
        *restored,
        method=record.method,
        failure=Status.CANCELLED if cancelled else Status.GAVE_UP,
        iterations=len(record.history),
        factorisations=record.factorisations,
        trace=tuple(trace),
        info=info,
    )
    if solution.solved:
        info["accuracy"] = solution.certificate.worst
    return solution
