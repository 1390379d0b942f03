"""What to say when pivoting ends without a solution: a ray alone proves nothing, a mechanism does."""

from __future__ import annotations

from typing import Any

from concio.problem.contact_problem import Array, ContactProblem
from concio.problem.solution import Solution, Status, failed
from concio.solvers.statics.existence import find_mechanism
from concio.solvers.statics.mechanism import mechanism_from


def no_solution(
    problem: ContactProblem, method: str, *, velocity: Array | None = None, ray: bool = False, **extra: Any
) -> Solution:
    """Return NO_EQUILIBRIUM with a verified mechanism where there is one, UNDECIDED or GAVE_UP otherwise.

    Parameters
    ----------
    problem : ContactProblem
    method : str
    velocity : (N,) array, optional
        Direction of the displacements on the ray; tried as a mechanism before one is searched for.
    ray : bool
        A path ended on a ray, as against a limit or a failure.
    **extra
        Further fields of the solution.
    """
    mechanism = mechanism_from(problem, velocity) if velocity is not None else None
    mechanism = mechanism or find_mechanism(problem)
    trace = tuple(extra.pop("trace", ()))
    if mechanism is not None:
        return failed(
            problem, Status.NO_EQUILIBRIUM, method=method, mechanism=mechanism,
            trace=(*trace, "a mechanism shows that there is no equilibrium."), **extra,
        )  # fmt: skip
    status = Status.UNDECIDED if ray or velocity is not None else Status.GAVE_UP
    return failed(
        problem, status, method=method,
        trace=(*trace, "no mechanism excludes equilibrium: what pivoting found proves nothing."), **extra,
    )  # fmt: skip
