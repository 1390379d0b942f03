r"""The same structure with a little more or less friction, solved, and carried over to its own.

Of a jammed structure (arches between walls without a base, friction near one) the plain iteration solves some friction
coefficients within seconds and stalls at others a few per cent away, although their states hardly differ. So where it
stalls, friction is changed by a few per cent, either way, until it does not; and the state found is carried back: it is
an answer to the structure with its own friction under slightly other loads and gaps, which fade away along a piecewise
linear path (:func:`concio.solvers.pivoting.covering.cover_point`). Where that path fails, the way is halved.

This is a search for a state, not a claim about any other friction than the structure's own: what it finds is judged by
the certificate of the problem itself.
"""

from __future__ import annotations

from concio.problem.contact_problem import ContactProblem
from concio.problem.limits_of_work import NEIGHBOUR_HALVINGS, NEIGHBOUR_PIVOTS, NEIGHBOURS_PIVOTS, NEIGHBOURS_WORK
from concio.problem.solution import ProgressCallback, Solution, Status, pair_states
from concio.solvers.algebra.scaled import scale
from concio.solvers.interior.run import Cancelled, Run, Start
from concio.solvers.pivoting import sparse_lemke

FACTORS = (0.98, 1.02, 0.95, 1.05)
"""Multiples of the friction coefficients that are tried, in this order."""

STARTS = (Start(10.0, 10.0), Start(100.0, 100.0))
"""Starts tried for each neighbour."""


def from_neighbours(run: Run, progress: ProgressCallback | None = None) -> Solution | None:
    """Solve neighbours in friction and carry their states over; return a certified solution or None.

    Parameters
    ----------
    run : Run
        Keeps count and trace.
    progress : callable, optional

    Raises
    ------
    Cancelled
        The callback asked to stop.
    """
    problem = run.scaled.problem
    if not problem.laws.friction.any():
        return None
    left = min(NEIGHBOURS_PIVOTS, NEIGHBOURS_WORK // problem.pairs)
    for factor in FACTORS:
        near = Run(scale(problem.with_friction(factor)), progress)
        found = None
        for start in STARTS:
            found = found or near.from_start(start)
        run.iterations += near.iterations
        run.history.extend(near.history)
        if found is None:
            continue
        answer, ways, pivots = _carry(problem, near.solution(found), factor, left, progress)
        left -= pivots
        reached = "solved" if answer else "lost on the way back"
        run.trace.append(f"friction times {factor:g}: solved; carried over in {ways} paths, {pivots} pivots: {reached}")
        if answer is not None or left <= 0:
            return answer
    return None


def _carry(
    problem: ContactProblem, near: Solution, factor: float, left: int, progress: ProgressCallback | None
) -> tuple[Solution | None, int, int]:
    """Carry the state of a neighbour to the friction of ``problem``; return the answer, the paths and the pivots."""
    to, ways, pivots, failures = 1.0, 0, 0, 0
    while failures <= NEIGHBOUR_HALVINGS and pivots < left:
        answer = sparse_lemke.solve(
            problem.with_friction(to) if to != 1.0 else problem,
            start_states=pair_states(problem.with_friction(factor), near),
            start=(near.displacement, near.normal_force, near.friction_force),
            limit=min(NEIGHBOUR_PIVOTS + problem.pairs // 10, left - pivots),
            tries=0,
            progress=progress,
        )
        if answer.status is Status.CANCELLED:
            raise Cancelled
        ways, pivots = ways + 1, pivots + answer.iterations
        if answer.solved:
            if to == 1.0:
                return answer, ways, pivots
            near, factor, to = answer, to, 1.0
        else:
            failures, to = failures + 1, 0.5 * (factor + to)
    return None, ways, pivots
