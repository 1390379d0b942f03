r"""``ercolano``: the force method with rigid coordinates of the paper (26-33), solved by Lemke's method.

Gaps of chosen contacts stand for the rigid motions, which leave the problem without adding unknowns: six fewer for each
free body than in the split form of Lee. The generalised problem (33) is brought to standard form through the
complementary basis of the isostatic structure (:mod:`.force_method`).

The paper's own variables are those of the 3m form, which is not copositive: Lemke's method often ends on a ray although
there is a solution. The default here is the 4m form; ``form="3m"`` is the paper's.

Parameters of :func:`solve`
---------------------------
form : {"4m", "3m"}, default "4m"
normal_only : bool, optional
    True takes normal gaps alone as rigid coordinates, as the paper does; by default where they serve.
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
    normal_only: bool | None = None,
    limit: int | None = None,
) -> Solution:
    """Solve by the force method with rigid coordinates and Lemke's method.

    Raises
    ------
    MethodError
        The contacts do not hold all rigid motions, the problem is not plane, or it has a cap.
    """
    mixed = mixed_form(reduce(problem), form)
    run = DenseRun("ercolano", progress, limit)
    return run.attempt(mixed, "force-method", normal_only=normal_only) or run.give_up(mixed)
