r"""``klarbring``: condensation onto the contacts and the 3m form (23-25), for structures no body of which floats.

With a definite stiffness the displacements leave the problem, ``y = x + C K^{-1} f + F t``, and what remains is a
standard linear complementarity problem in the contact forces. Lemke's method solves its 3m form without trouble there.

A. Klarbring, *Contact problems with friction*, thesis, Linköping Institute of Technology, 1984.

Parameters of :func:`solve`
---------------------------
form : {"3m", "4m"}, default "3m"
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
    form: FormName = "3m",
    limit: int | None = None,
) -> Solution:
    """Solve by condensation and Lemke's method.

    Raises
    ------
    MethodError
        A body floats, the problem is not plane, or it has a cap.
    """
    mixed = mixed_form(reduce(problem), form)
    run = DenseRun("klarbring", progress, limit)
    return run.attempt(mixed, "condensation") or run.give_up(mixed)
