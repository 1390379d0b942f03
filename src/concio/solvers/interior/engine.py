"""Method ``interior-point``: starts tried in turn, each finished exactly; in the plane a homotopy for jammed states."""

from __future__ import annotations

from concio.problem.contact_problem import Array, ContactProblem, Engine
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.solvers.algebra.scaled import scale
from concio.solvers.interior.run import WEIGHTS, Cancelled, Run, at_rest, starts_for


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    engine: Engine | None = None,
    starts: int | None = None,
    homotopy: bool = True,
    near: tuple[Array, Array, Array] | None = None,
    newton: bool = True,
    least: bool = True,
) -> Solution:
    """Solve one load step of a problem of any dimension.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    engine : {"superlu", "pardiso"}, optional
        Sparse factorisation.
    starts : int, optional
        How many starts are tried in turn, at most; by default all.
    homotopy : bool
        Walk from associated flow where the plain iteration fails, in the plane.
    near : arrays, optional
        Displacements [m], t_n and t_t [kN] of a state from which Newton's method is tried first, then the interior
        point, in space.
    newton : bool
        Whether Newton's method is tried from there.
    least : bool
        Whether forces that equilibrium leaves open are the least, as they are reported; otherwise those in the middle
        of what the joint laws allow.

    Returns
    -------
    Solution
        SOLVED with its certificate, or GAVE_UP; this method proves no collapse.
    """
    rest = at_rest(problem)
    if rest is not None:
        return rest
    scaled = scale(problem.by(engine))
    run = Run(scaled, progress, least=least)
    try:
        found = None
        if near is not None and scaled.dim == 3:
            state = scaled.bring(*near)
            found = run.newton(*state, WEIGHTS[:1]) if newton else None
            found = found or run.from_near(*state)
        for start in starts_for(scaled)[:starts]:
            found = found or run.from_start(start)
        if found is None and homotopy and scaled.dim == 2 and scaled.rough.any():
            found = run.homotopy()
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return run.solution(found)
