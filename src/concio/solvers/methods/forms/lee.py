r"""``lee``: rigid motions split into nonnegative parts (Stavroulakis et al. 1991; Lee 1994), solved by Lemke's method.

Six unknowns more for each free body than the force method, but a sparse and copositive matrix; see
:mod:`.split_motions`.

Parameters of :func:`solve`
---------------------------
form : {"4m", "3m"}, default "4m"
limit : int, optional
    Largest number of pivots.
"""

from __future__ import annotations

from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.methods.forms.dense_solve import DenseRun
from concio.solvers.methods.forms.forms import FormName, mixed_form
from concio.solvers.methods.forms.reduction import reduce


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    form: FormName = "4m",
    limit: int | None = None,
) -> Solution:
    """Solve with split rigid motions by Lemke's method.

    Raises
    ------
    MethodError
        The problem is not plane, or it has a cap.
    """
    mixed = mixed_form(reduce(problem), form)
    run = DenseRun("lee", progress, limit)
    return run.attempt(mixed, "split") or run.give_up(mixed)
