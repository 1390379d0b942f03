"""Method ``interior-point`` in space: round cones, starts tried in turn."""

from __future__ import annotations

from concio.problem.contact_problem import Array, ContactProblem, Engine
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.solvers.algebra.scaled import scale
from concio.solvers.interior.run import STARTS, WEIGHTS, Cancelled, Run, at_rest, starts_for


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
    run = Run(scale(problem.by(engine)), progress)
    try:
        found = None if near is None else run.newton(*run.scaled.bring(*near), WEIGHTS[:1])
        for start in starts_for(run.scaled)[:starts]:
            found = found or run.from_start(start)
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return run.solution(found)
