r"""``del-piero``: the force method for contact forces whose tangential part does not depend on the normal one.

Without friction the only unknowns are the normal forces, and the problem is a convex quadratic programme: a symmetric
linear complementarity problem that Lemke's method always decides. Sliding strength that is given once for all (Tresca:
cohesion without friction) keeps the symmetry and is taken in the 4m form.

Coulomb friction is outside the method: it is refused, with the names of methods that take it.

G. Del Piero, *Resolution methods for framed structures with unilateral constraints* (in Italian), Institute of
Theoretical and Applied Mechanics, University of Udine, 1990, as cited by Ercolano.

Parameters of :func:`solve`
---------------------------
limit : int, optional
    Largest number of pivots.
"""

from __future__ import annotations

from concio.errors import MethodError
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import ProgressCallback, Solution
from concio.solvers.methods.forms.dense_solve import DenseRun
from concio.solvers.methods.forms.forms import mixed_form
from concio.solvers.methods.forms.reduction import reduce


def solve(
    problem: ContactProblem,
    *,
    progress: ProgressCallback | None = None,
    limit: int | None = None,
) -> Solution:
    """Solve a frictionless problem, or one with given sliding strengths.

    Raises
    ------
    MethodError
        There is Coulomb friction, the problem is not plane, or it has a cap.
    """
    if problem.laws.friction.any():
        msg = "del-piero takes no Coulomb friction: friction forces would depend on the normal ones"
        raise MethodError(msg, hint="use ercolano, lee, lemke or interior-point")
    reduction = reduce(problem)
    mixed = mixed_form(reduction, "4m" if reduction.rough.size else "normal")
    run = DenseRun("del-piero", progress, limit)
    try:
        solution = run.attempt(mixed, "force-method")
    except MethodError:  # normal forces alone do not hold the bodies
        solution = None
    return solution or run.attempt(mixed, "split") or run.give_up(mixed)
