"""One load step of a model: assemble, solve, judge."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any, Literal

from concio.analysis.lent_compliance import lend
from concio.analysis.result import Result
from concio.arguments import options_of, strict
from concio.contact.assembly import Assembly, as_assembly
from concio.errors import NoEquilibriumError, SolverError
from concio.model.model import Model
from concio.problem.solution import ProgressCallback, Solver, Status
from concio.solvers.algebra.sparse_factor import factorised_by
from concio.solvers.algebra.stiff_limit import without_compliance
from concio.solvers.methods import check_options, find


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

    Raises
    ------
    InputError
        The model cannot be used as it is, or the method has no option of a name that was given.
    NoEquilibriumError
        A mechanism, a motion without end or the exclusion of all joint states proves that the loads are not carried.
    SolverError
        The solver stopped without an answer.
    """
    solver: Solver = find(method)
    check_options(method, options, function="solve()", others=("method", *options_of(solve)))
    begin = time.perf_counter()
    assembly = as_assembly(model, jointless=True, periodic=bool(factors))
    if "engine" in find(method).options:
        options.setdefault("engine", assembly.model.engine)
    lent = lend(assembly)
    problem = lent.problem(factors)
    if not problem.pairs:  # K u = f: there are no states to find, whatever the method
        solver, options = find("sparse-lemke" if problem.dim == 2 else "auto"), {}
    assembled = time.perf_counter()
    engine, stiff = options.get("engine", ""), None
    with factorised_by(engine or None):  # what a method asks on its way factorises as it does
        solution = solver(problem, progress=progress, **options)
        if lent.lent_compliance and solution.solved:
            stiff = without_compliance(assembly.problem(factors), problem, solution)
    end = time.perf_counter()
    seconds = {"total": end - begin, "assemble": assembled - begin, "solve": end - assembled}
    judged = (lent, solution) if stiff is None else (assembly, stiff)
    result = Result(judged[0], dict(factors or {}), judged[1], seconds, lent.lent_compliance, str(engine))
    if solution.solved or on_failure == "return":
        return result
    detail = "; ".join(solution.trace)
    if solution.status in (Status.NO_EQUILIBRIUM, Status.COLLAPSES):
        raise NoEquilibriumError(
            result.sentence, hint="solve with on_failure='return' and look at result.mechanism"
        )
    if solution.status is Status.NO_COULOMB_STATE:
        raise NoEquilibriumError(
            result.sentence, hint="solve with on_failure='return' and look at result.solution.info"
        )
    msg = f"{solution.status.value} Tried: {detail}"
    raise SolverError(msg, hint="see result.certificate with on_failure='return'")
