"""Method ``interior-point`` in the plane: interior point, exact finish, and a homotopy for jammed states."""

from __future__ import annotations

from concio.problem.contact_problem import ContactProblem, Engine
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.solvers.algebra.scaled import scale
from concio.solvers.algebra.scales import require_plane
from concio.solvers.interior.run import SIZES, Cancelled, Run, Start, at_rest


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    engine: Engine | None = None,
    homotopy: bool = True,
    starts: tuple[float, ...] = SIZES,
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
    scaled = scale(problem.by(engine))
    run = Run(scaled, progress)
    try:
        found = None
        for start in starts:
            found = found or run.from_start(Start(start, start))
        if found is None and homotopy and scaled.rough.any():
            found = run.homotopy()
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return run.solution(found)
