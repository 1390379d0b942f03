"""Method ``auto`` in space: a table of strategies, tried in a fixed order until one decides.

1. where joints carry tension: all pairs stick, which is one linear problem, and those whose strength that exceeds are
   let go by Newton's method;
2. interior point with round cones and exact finish, from the usual start and from one further out;
3. a cone programme: either a mechanism, rechecked, proves that there is no equilibrium, or there are statically
   admissible forces; where no body has to move under them (rigid blocks), they are the answer;
4. interior point from the other starts;
5. the best point that the starts met, where its certificate holds although Newton's method did not end;
6. free motion: the bodies move away under their loads as if nothing touched them;
7. release, single steps: the structure is let go, and ever longer steps from rest show where it goes;
8. release: it is followed in slow motion, from rest and from the state in which associated flow jams; it comes to rest,
   which is an equilibrium, or settles into a motion without end, which is the answer.

What was tried is the solution's trace. Words are those of the plane (:mod:`concio.solvers.auto.strategies`). Pivoting
and the exhaustive search, which prove that no Coulomb state exists, know two ways of slipping only and have no place
here.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import Departure, ProgressCallback, Solution
from concio.solvers.algebra.scaled import scale
from concio.solvers.algebra.sparse_factor import Engine
from concio.solvers.auto.strategies import Strategy, first_answer, moves_away, statics, sticking, where_it_ends
from concio.solvers.interior.run import Run, at_rest, starts_for
from concio.solvers.relaxation.free_motion import free_motion
from concio.solvers.relaxation.single_steps import at_once
from concio.solvers.relaxation.slow_motion import relax
from concio.solvers.states.reading import Finished


def usual_starts(run: Run) -> Solution | None:
    """Interior point from the first two starts."""
    return _from(run, 0, 2)


def other_starts(run: Run) -> Solution | None:
    """Interior point from the starts that are left."""
    return _from(run, 2, None)


def best_point_met(run: Run) -> Solution | None:
    """Take the best point the starts met where it is certified: no motion is followed for digits nobody asks for."""
    met = None if run.best is None else run.solution(run.best, method="interior-point")
    return met if met is not None and met.solved else None


def moving_freely(run: Run) -> Solution | None:
    """Look whether the structure moves away as if nothing touched it."""
    return _judged(run, free_motion(run.scaled.problem))


def released_in_single_steps(run: Run) -> Solution | None:
    """Let the structure go, and look at what single long steps from rest show."""
    return _judged(run, at_once(run))


def released_at_rest(run: Run) -> Solution | None:
    """Let the structure go, undeformed."""
    return _released(run, np.zeros(len(run.scaled.f)))


def released_jammed(run: Run) -> Solution | None:
    """Let the structure go from the state in which associated flow holds it."""
    return _released(run, run.associated_state())


STRATEGIES: tuple[Strategy, ...] = (
    Strategy("all pairs stick", sticking),
    Strategy("interior-point", usual_starts),
    Strategy("mechanism", statics),
    Strategy("interior-point, other starts", other_starts),
    Strategy("best point met", best_point_met),
    Strategy("free motion", moving_freely),
    Strategy("release, single steps", released_in_single_steps),
    Strategy("release", released_at_rest),
    Strategy("release, jammed", released_jammed),
)
"""What is tried, in this order; the name of the one that decided is ``info["strategy"]``."""


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
    """
    rest = at_rest(problem)
    if rest is not None:
        return rest
    return first_answer(Run(scale(problem, engine), progress), STRATEGIES)


def let_go(problem: ContactProblem, u: Array, progress: ProgressCallback | None = None) -> Solution:
    """Follow the slow motion from displacements u (N,) [m]: rest, COLLAPSES or UNDECIDED, as in the plane."""
    run = Run(scale(problem), progress)
    return where_it_ends(run, partial(_released, run), u)


def _from(run: Run, first: int, last: int | None) -> Solution | None:
    for start in starts_for(run.scaled)[first:last]:
        found = run.from_start(start)
        if found is not None:
            return run.solution(found)
    return None


def _released(run: Run, u: Array) -> Solution | None:
    return _judged(run, relax(run, u))


def _judged(run: Run, ended: Finished | Departure | None) -> Solution | None:
    if isinstance(ended, Departure):
        return moves_away(run, ended)
    return None if ended is None else run.solution(ended)
