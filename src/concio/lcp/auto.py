"""Method ``auto``: the engine first, proof of collapse where it fails, pivoting where the problem is small.

The order is fixed, so that the same problem always goes the same way: interior point with exact finish; if that fails, a
mechanism is looked for; if there is none (forces that balance the loads exist), the dilatancy homotopy; then Lemke's
method where the problem is small enough. What was tried is the solution's trace.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from concio.contact.problem import ContactProblem
from concio.lcp import methods
from concio.lcp.engine import STARTS, Cancelled, Run
from concio.lcp.existence import find_mechanism
from concio.lcp.scaled import scale
from concio.lcp.solution import ProgressCallback, Solution, Status, failed
from concio.lcp.sparse_factor import Engine

PIVOTING = 800
"""Largest number of pairs for which Lemke's method is tried."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    engine: Engine = "superlu",
    pivoting: bool = True,
    **options: Any,
) -> Solution:
    """Solve one load step by whatever it takes.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    engine : {"superlu", "pardiso"}
    pivoting : bool
        Try Lemke's method last, where there are at most ``PIVOTING`` pairs.

    Returns
    -------
    Solution
        SOLVED, NO_EQUILIBRIUM with its mechanism, or UNDECIDED with what was tried.
    """
    run = Run(scale(problem, engine), progress)
    try:
        found = run.plain(STARTS[0])
        if found is not None:
            return run.solution(found)
        mechanism = find_mechanism(problem)
        if mechanism is not None:
            run.trace.append("mechanism found and rechecked")
            return failed(
                problem,
                Status.NO_EQUILIBRIUM,
                method="mechanism",
                mechanism=mechanism,
                iterations=run.iterations,
                factorisations=run.scaled.factor.count,
                trace=tuple(run.trace),
            )
        run.trace.append("no mechanism: statically admissible forces exist")
        for start in STARTS[1:]:
            found = found or run.plain(start)
        found = found or run.homotopy()
        if found is not None:
            return run.solution(found)
        if pivoting and problem.pairs <= PIVOTING:
            answer = methods.find("lemke")(problem, progress=progress)
            if answer.solved:
                return replace(answer, trace=(*run.trace, *answer.trace))
            run.trace.append(f"lemke: {answer.status.name.lower()}")
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return run.solution(None, Status.UNDECIDED, method="auto")
