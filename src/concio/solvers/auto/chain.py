"""Method ``auto``: a table of strategies, tried in a fixed order until one decides.

The order is fixed, so that the same problem always goes the same way. What is proven is not searched for again: the
first answer is the answer, be it an equilibrium, a mechanism or an unbounded motion. An answer is called solved by its
certificate alone, a collapse by its mechanism or its motion alone; everything else is undecided, with what was tried in
the solution's trace.

Every strategy of the table has a case that only it decides, solved through ``auto`` in the tests; what has none is not
in it (decision 0095). Pivoting from nothing and the exhaustive search, which proves that no Coulomb state exists, are
methods of their own; they know two ways of slipping only, and so does what carries the state of a neighbour in friction
over.
"""

from __future__ import annotations

from concio.problem.contact_problem import Array, ContactProblem, Engine
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.solvers.algebra.scaled import scale
from concio.solvers.auto.strategies import (
    Strategy,
    best_point_met,
    first_answer,
    moving_freely,
    neighbours,
    other_starts,
    released,
    released_at_rest,
    released_in_single_steps,
    released_jammed,
    statics,
    sticking,
    usual_starts,
)
from concio.solvers.interior.run import Cancelled, Run, at_rest
from concio.solvers.pivoting import sparse_lemke

PLANE, SPACE = (2,), (3,)

STRATEGIES: tuple[Strategy, ...] = (
    Strategy("all pairs stick", sticking),
    Strategy("interior-point", usual_starts),
    Strategy("statics", statics),
    Strategy("neighbours in friction", neighbours, PLANE),
    Strategy("interior-point, other starts", other_starts, SPACE),
    Strategy("best point met", best_point_met, SPACE),
    Strategy("free motion", moving_freely, SPACE),
    Strategy("release, single steps", released_in_single_steps, SPACE),
    Strategy("release", released_at_rest),
    Strategy("release, jammed", released_jammed, SPACE),
)
"""What is tried, in this order; ``info["strategy"]`` is the name of the one that decided."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    engine: Engine | None = None,
) -> Solution:
    """Solve one load step by whatever it takes.

    Parameters
    ----------
    problem : ContactProblem
    progress : callable, optional
    engine : {"superlu", "pardiso"}, optional

    Returns
    -------
    Solution
        SOLVED, NO_EQUILIBRIUM with its mechanism, COLLAPSES with its motion, or UNDECIDED with what was tried.
        ``info["strategy"]`` names the strategy that decided, ``info["cost"]`` those tried, each with its processor
        time [s].
    """
    problem = problem.by(engine)
    if not problem.pairs and problem.dim == 2:
        return sparse_lemke.solve(problem, progress=progress)  # linear, or a mechanism
    rest = at_rest(problem)
    if rest is not None:
        return rest
    return first_answer(Run(scale(problem), progress), STRATEGIES)


def let_go(
    problem: ContactProblem, u: Array, t_n: Array, t_t: Array, progress: ProgressCallback | None = None
) -> Solution:
    """Follow the slow motion from a given state: the answer where it comes to rest, or COLLAPSES, or UNDECIDED.

    Parameters
    ----------
    problem : ContactProblem
    u : (N,) array
        Displacements from which the structure is let go [m].
    t_n, t_t : (m,), (m,) or (m, d-1) arrays
        Its contact forces there [kN].
    progress : callable, optional
    """
    run = Run(scale(problem), progress)
    try:
        answer = released(run, *run.scaled.bring(u, t_n, t_t))
    except Cancelled:
        return run.solution(None, Status.CANCELLED)
    return answer or run.solution(None, Status.UNDECIDED, method="release")
