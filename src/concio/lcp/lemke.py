r"""``lemke``: Lemke's method on a copositive form of the whole problem, rigid motions included.

The displacements are eliminated (:mod:`concio.lcp.reduction`), friction is written in the 4m form
(:mod:`concio.lcp.forms`), and rigid motions are treated as the number of pairs suggests: by the force method
(:mod:`concio.lcp.force_method`) on small problems, where it halves the pivots; split (:mod:`concio.lcp.split_motions`) on
larger ones, where the sparse basis pays. What fails in one is tried in the other. The states of the pairs are read off
and solved for once more on the original matrices, so that the answer does not carry the errors of the elimination.

Dense: time grows with the cube of the number of pairs. :mod:`concio.lcp.sparse_lemke` does not.

Parameters of :func:`solve`
---------------------------
form : {"4m", "3m"}, default "4m"
elimination : {"auto", "force-method", "split", "condensation"}, default "auto"
limit : int, optional
    Largest number of pivots of a run.
"""

from __future__ import annotations

from typing import Literal

from concio.contact.problem import ContactProblem
from concio.errors import MethodError
from concio.lcp.dense_solve import DenseRun, Elimination
from concio.lcp.forms import FormName, mixed_form
from concio.lcp.reduction import reduce
from concio.lcp.solution import ProgressCallback, Solution, Status

SMALL = 120
"""Number of pairs up to which the force method is tried first."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    form: FormName = "4m",
    elimination: Literal["auto"] | Elimination = "auto",
    limit: int | None = None,
) -> Solution:
    """Solve by Lemke's method; see the module for the parameters.

    Raises
    ------
    MethodError
        The problem is not plane or has a cap, or an option is unknown.
    """
    if elimination not in ("auto", "force-method", "split", "condensation"):
        msg = f"unknown elimination '{elimination}'"
        raise MethodError(msg, hint="auto, force-method, split or condensation")
    mixed = mixed_form(reduce(problem), form)
    run = DenseRun("lemke", progress, limit)
    plan: tuple[Elimination, ...]
    if elimination != "auto":
        plan = (elimination,)
    elif not mixed.motions:
        plan = ("condensation",)
    elif problem.pairs <= SMALL:
        plan = ("force-method", "split")
    else:
        plan = ("split",)
    for k, how in enumerate(plan):
        try:
            solution = run.attempt(mixed, how)
        except MethodError as error:
            if k + 1 == len(plan):
                raise
            run.trace.append(f"{how}: {error}.")
            continue
        if solution is not None and (solution.solved or solution.status is Status.CANCELLED):
            return solution
    return run.give_up(mixed)
