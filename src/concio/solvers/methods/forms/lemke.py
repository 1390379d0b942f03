r"""``lemke``: Lemke's method on a copositive form of the whole problem, rigid motions included.

The displacements are eliminated (:mod:`.reduction`), and rigid motions treated as the number of pairs suggests: by
the force method (:mod:`.force_method`) on small problems, where it halves the pivots; split (:mod:`.split_motions`)
on larger ones, where the sparse basis pays. Friction is written in the 3m form first, which has fewer unknowns, then
in the copositive 4m form (:mod:`.forms`), each under a cover that lets friction do no work along a ray: the cover
matters more than the form (``docs/research/covers-under-which-friction-does-no-work.md``). The states of the pairs
are read off and solved for once more on the original matrices, so that the answer does not carry the errors of the
elimination.

Dense: time grows with the cube of the number of pairs. :mod:`concio.solvers.pivoting.sparse_lemke` does not.

Parameters of :func:`solve`
---------------------------
form : {"auto", "3m", "4m"}, default "auto"
    "auto": 3m, then 4m.
elimination : {"auto", "force-method", "split", "condensation"}, default "auto"
limit : int, optional
    Largest number of pivots of a run.
"""

from __future__ import annotations

from typing import Literal

from concio.errors import MethodError
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import ProgressCallback, Solution, Status
from concio.solvers.methods.forms.dense_solve import DenseRun, Elimination
from concio.solvers.methods.forms.forms import FormName, mixed_form
from concio.solvers.methods.forms.reduction import reduce

SMALL = 120
"""Number of pairs up to which the force method is tried first."""


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    form: Literal["auto", "3m", "4m"] = "auto",
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
    if form not in ("auto", "3m", "4m"):
        msg = f"there is no form '{form}'"
        raise MethodError(msg, hint="auto, 3m or 4m")
    forms: tuple[FormName, ...] = ("3m", "4m") if form == "auto" else (form,)
    reduction = reduce(problem)
    run = DenseRun("lemke", progress, limit)
    plan: tuple[Elimination, ...]
    if elimination != "auto":
        plan = (elimination,)
    elif not problem.rigid_motions:
        plan = ("condensation",)
    else:
        plan = ("force-method", "split") if problem.pairs <= SMALL else ("split",)
    refused: MethodError | None = None
    tried = False
    for how in plan:
        for name in forms:
            mixed = mixed_form(reduction, name)
            try:
                solution = run.attempt(mixed, how)
            except MethodError as error:
                refused = error
                run.trace.append(f"{how}: {error}.")
                break
            tried = True
            if solution is not None and (solution.solved or solution.status is Status.CANCELLED):
                return solution
            if run.velocity is not None and how == "split":
                verdict = run.give_up(mixed)
                if verdict.status is Status.NO_EQUILIBRIUM:
                    return verdict
    if refused is not None and not tried:
        raise refused
    return run.give_up(mixed)
