"""One load step of a model: assemble, solve, judge."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

from concio.analysis.changing_laws import points_that_change, solve_changing
from concio.analysis.lent_compliance import lend, stiffened
from concio.analysis.result import Result
from concio.analysis.tie_forces import broken_ties
from concio.arguments import options_of, strict
from concio.contact.assembly import Assembly, as_assembly
from concio.errors import InputError, NoEquilibriumError, SolverError
from concio.model.model import Model
from concio.problem.solution import PROVEN_FAILURES, ProgressCallback, Solver, Status
from concio.solvers.algebra.stiff_limit import without_compliance
from concio.solvers.algebra.threads import one_thread
from concio.solvers.methods import check_options, find
from concio.verdict.unanswered import with_a_verdict


@strict
def solve(
    model: Model | Assembly,
    method: str = "auto",
    *,
    factors: Mapping[str, float] | None = None,
    on_failure: Literal["raise", "return"] = "raise",
    progress: ProgressCallback | None = None,
    **options: Any,
) -> Result:
    """Solve one load step.

    Parameters
    ----------
    model : Model or Assembly
        An assembly saves meshing again.
    method : str
        Name of a method, see :data:`concio.solvers.methods.METHODS`. A model without joints and ties is solved directly
        (by "sparse-lemke", with nothing to pivot on, in space by "auto"), whichever is named.
    factors : mapping of str to float, optional
        Factors of load groups; groups not named have 1.
    on_failure : {"raise", "return"}
        Whether an outcome other than a certified equilibrium raises or is returned as it is.
    progress : callable, optional
        Called with :class:`concio.problem.solution.Progress` as the solver works; true stops it.
    **options
        Options of the method, see the ``solve`` of its module; others are refused. Where the method has the option
        ``engine``, that of the model is taken unless another is given.

    Returns
    -------
    Result
        A tie that would be stretched to where it breaks is taken away, the farthest one first, and the step solved
        again; :attr:`Result.broken_ties` names them.

    Raises
    ------
    InputError
        The model cannot be used as it is, or the method has no option of a name that was given.
    NoEquilibriumError
        A mechanism, an unbounded motion or the exclusion of all joint states proves that the loads are not carried.
    SolverError
        The solver stopped without an answer.

    Examples
    --------
    A pillar of 20 kN:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=4, block="rigid", unit_weight=20.0)
    >>> result = concio.solve(pillar)
    >>> result.status.name
    'SOLVED'
    >>> round(float(result.reactions["ground"][1]), 6)
    20.0

    A horizontal share of the weight of 0.3 is more than width over height:

    >>> import concio
    >>> leaning = concio.column(width=0.5, height=2.0, blocks=4, block="rigid", horizontal=0.3)
    >>> concio.solve(leaning, on_failure="return").status.name
    'NO_EQUILIBRIUM'
    """
    check_options(method, options, function="solve()", others=("method", *options_of(solve)))
    begin = time.perf_counter()
    assembly = as_assembly(model, jointless=True, periodic=bool(factors))
    assembled = time.perf_counter() - begin
    result = _solve(assembly, method, factors, progress, options)
    with with_a_verdict(assembly, "solve"):
        while broken := _breaking(result):
            result = _without(result, broken, method, factors, progress, options)
    seconds = {**result.seconds, "assemble": result.seconds["assemble"] + assembled}
    result = replace(result, seconds={**seconds, "total": result.seconds["total"] + assembled})
    solution = result.solution
    if solution.solved or on_failure == "return":
        return result
    if solution.status in PROVEN_FAILURES:
        place = "solution.info" if solution.status is Status.NO_COULOMB_STATE else "mechanism"
        hint = f"solve with on_failure='return' and look at result.{place}"
        raise NoEquilibriumError(result.sentence, hint=hint, verdict=result.verdict)
    msg = f"{result.sentence} Tried: {'; '.join(solution.trace)}"
    raise SolverError(msg, hint="see result.certificate with on_failure='return'", verdict=result.verdict)


def _breaking(result: Result) -> tuple[str, float] | None:
    """Return the tie of a solved step that is stretched farthest past where it breaks, with how far [m]; or None."""
    if not result.solved or not result.model.ties:
        return None
    found = broken_ties(result.assembly, result.ties.elongation)
    return found[0] if found else None


def _without(
    result: Result,
    broken: tuple[str, float],
    method: str,
    factors: Mapping[str, float] | None,
    progress: ProgressCallback | None,
    options: dict[str, Any],
) -> Result:
    """Return the answer without a tie that breaks; the ties that broke before it stay away.

    Raises
    ------
    NoEquilibriumError
        Nothing else held the structure.
    """
    model = result.model
    left = replace(model, ties=tuple(t for t in model.ties if t.name != broken[0]))
    try:
        again = _solve(as_assembly(left, jointless=True, periodic=bool(factors)), method, factors, progress, options)
    except InputError as error:
        msg = f"tie '{broken[0]}' is stretched by {1e3 * broken[1]:.4g} mm and breaks; without it {error.what}"
        raise NoEquilibriumError(msg, hint="give it more stiffness, or the structure another support") from None
    return replace(again, broken_ties=(*result.broken_ties, broken))


def _solve(
    assembly: Assembly,
    method: str,
    factors: Mapping[str, float] | None,
    progress: ProgressCallback | None,
    given: dict[str, Any],
) -> Result:
    """Solve one load step with every tie whole."""
    solver: Solver = find(method)
    options, begin = dict(given), time.perf_counter()
    if "engine" in find(method).options:
        options.setdefault("engine", assembly.model.engine)
    lent = lend(assembly if assembly.first_laws is None else replace(assembly, laws=assembly.first_laws))
    compliance, problem = lent.lent_compliance, lent.problem(factors)
    if not problem.pairs:  # K u = f: there are no states to find, whatever the method
        solver, options = find("sparse-lemke" if problem.dim == 2 else "auto"), {}
    assembled = time.perf_counter()
    engine = options.get("engine", "")
    problem = problem.by(options.get("engine"))  # what a method asks on its way factorises as it does
    with one_thread():
        if points_that_change(lent):
            solution, laws = solve_changing(lent, problem, lambda p: solver(p, progress=progress, **options))
            lent = replace(lent, laws=laws, first_laws=lent.laws)
        else:
            solution = solver(problem, progress=progress, **options)
        if lent.first_laws is None and lent.lent_compliance and solution.solved:
            solution, left = without_compliance(assembly.problem(factors).by(problem.engine), problem, solution)
            lent = stiffened(lent, assembly, left)
    end = time.perf_counter()
    seconds = {"total": end - begin, "assemble": assembled - begin, "solve": end - assembled}
    return Result(lent, dict(factors or {}), solution, seconds, compliance, str(engine))
