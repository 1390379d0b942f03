"""Method ``auto``: a table of strategies, tried in a fixed order until one decides.

The order is fixed, so that the same problem always goes the same way. What is proven is not searched for again: the
first answer is the answer, be it an equilibrium, a mechanism or a motion without end. An answer is called solved by its
certificate alone, a collapse by its mechanism or its motion alone; everything else is undecided, with what was tried in
the solution's trace.

Every strategy of the table has a case that only it decides, solved through ``auto`` in the tests; what has none is not
in it (decision 0095). Pivoting from nothing and the exhaustive search, which proves that no Coulomb state exists, are
methods of their own.
"""

from __future__ import annotations

from functools import partial

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.algebra.scaled import scale
from concio.solvers.algebra.sparse_factor import Engine
from concio.solvers.auto.strategies import (
    Strategy,
    first_answer,
    let_go_at_rest,
    neighbours,
    released,
    statics,
    usual_starts,
    where_it_ends,
)
from concio.solvers.interior.run import Run, at_rest
from concio.solvers.pivoting import sparse_lemke

STRATEGIES: tuple[Strategy, ...] = (
    Strategy("interior-point", usual_starts),
    Strategy("statics", statics),
    Strategy("neighbours in friction", neighbours),
    Strategy("release", let_go_at_rest),
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
    if not problem.pairs:
        return sparse_lemke.solve(problem, progress=progress)  # linear, or a mechanism
    rest = at_rest(problem)
    if rest is not None:
        return rest
    return first_answer(Run(scale(problem, engine), progress), STRATEGIES)


def let_go(problem: ContactProblem, u: Array, progress: ProgressCallback | None = None) -> Solution:
    """Follow the slow motion from given displacements: the answer where it comes to rest, or COLLAPSES, or UNDECIDED.

    Parameters
    ----------
    problem : ContactProblem
    u : (N,) array
        Displacements from which the structure is let go [m].
    progress : callable, optional
    """
    run = Run(scale(problem), progress)
    return where_it_ends(run, partial(released, run), u)
