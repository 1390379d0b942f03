r"""Steps in space at which Newton's method does not arrive: joints that give way more, counted from forces nearby.

Where hundreds of contacts slip at once, slips that turn send Newton's method in circles. With a compliance c added,
counted from forces t' of the answer before,

.. math:: y_n + c\,(t_n - t_n') , \qquad y_t + c\,(t_t - t_t'),

it arrives; and what it arrives at is the next t'. Where t = t' the compliance does nothing, so these proximal steps end
at answers of the step itself (R. T. Rockafellar, Monotone operators and the proximal point algorithm, 1976: certain
where laws are associated). The compliance becomes less with every answer, more where there is none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from concio.problem.contact_problem import Array
from concio.problem.limits_of_work import SOFTER_FACTORISATIONS
from concio.problem.tolerances import STEP_SETTLED
from concio.solvers.stepping.problem import StepProblem, StepSolution
from concio.solvers.stepping.states import read_states

FIRST = 0.03
"""Compliance added first, over the flexibility of a pair."""

LESS, MORE = 0.7, 2.5
"""By how much it changes after an answer, and where there was none."""

MOST = 100.0
"""Compliance over that flexibility beyond which the steps end."""

EVERY = 4
"""Answers after which the step itself is tried."""

Rounds = Callable[[StepProblem, StepSolution], StepSolution]
"""Newton's method on a problem, from the states, velocities and forces of a solution."""


def by_softer_joints(p: StepProblem, best: StepSolution, x: Array, t: Array, rounds: Rounds) -> StepSolution:
    """Return the best that is found of a step; its factorisations are those of all.

    Parameters
    ----------
    p : StepProblem
    best : StepSolution
        The best so far.
    x : (N,) array
    t : (m, d) array
        Velocities and forces of the first point; states are read from them.
    rounds : callable
        Raises nothing; returns the best that it meets.
    """
    at = replace(best, x=x, t=t, states=read_states(p, x, t))
    spent, answers, c = best.factorisations, 0, FIRST
    while spent < SOFTER_FACTORISATIONS and c < MOST:
        soft = rounds(_softer(p, c, at.t), at)
        spent += soft.factorisations
        if soft.residual >= STEP_SETTLED:
            c *= MORE
            continue
        at, c, answers = soft, LESS * c, answers + 1
        if answers % EVERY == 0:
            found = rounds(p, at)
            spent += found.factorisations
            if found.residual < best.residual:
                best = replace(found, how="softer joints")
            if best.residual < STEP_SETTLED:
                break
    return replace(best, factorisations=spent)


def _softer(p: StepProblem, c: float, force: Array) -> StepProblem:
    """Return a problem whose pairs give way by c times their flexibility more, counted from forces (m, d)."""
    own = c * p.flexibility
    more_n, more_t = own[:, 0], own[:, 1]
    softer = replace(
        p, a_n=p.a_n + more_n, a_t=p.a_t + more_t, gap=p.gap - more_n * force[:, 0],
        origin=p.origin + more_t[:, None] * force[:, 1:],
    )  # fmt: skip
    softer.share_rows(p)
    return softer
