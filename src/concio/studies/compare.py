"""One problem, all methods, one certificate: the table of ``concio compare``.

Every method solves the same :class:`~concio.problem.contact_problem.ContactProblem` and is judged by the same
certificate. A
method that does not apply, gives up or takes too long is a row of the table like any other: what it reached is
printed, and it is never called solved. Seconds are given as a ratio to the engine measured in the same run, so that a
table can be compared with one made on another machine.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from concio.arguments import closest, strict
from concio.errors import InputError, MethodError
from concio.problem.contact_problem import ContactProblem
from concio.problem.solution import Progress, ProgressCallback, Solution
from concio.solvers.methods import METHODS, check_options, find
from concio.verdict.comparison_verdict import comparison_verdict, word_of
from concio.verdict.verdict import Verdict
from concio.views import Shown

ENGINE = "interior-point"
"""The method the seconds of all others are divided by."""

@dataclass(frozen=True)
class ComparisonRow:
    """What one method made of the problem.

    Parameters
    ----------
    method : str
    outcome : str
        "solved", "no equilibrium", "undecided", "gave up", "too slow", "not applicable"; "balanced only" where the
        equations are met by forces that nothing puts there, of a structure that is proven to fail.
    worst : float
        Worst entry of the certificate; ``inf`` where there is no answer to judge, ``nan`` where none was tried.
    iterations, factorisations : int
    seconds : float
    ratio : float
        Seconds over those of the engine.
    unknowns : int
        Size of the system the method iterates on.
    difference : float
        Largest difference of its displacements to those of the first solved row, relative; ``nan`` unless solved.
        Coulomb problems may have several equilibria: a solved row that differs is another one.
    note : str
        The method's last word where it did not solve.
    history, work : tuple of float
        Residual after each iteration, and the work spent until then in factorisations of K + C'C.
    """

    method: str
    outcome: str
    worst: float
    iterations: int
    factorisations: int
    seconds: float
    ratio: float
    unknowns: int
    difference: float
    note: str = ""
    history: tuple[float, ...] = ()
    work: tuple[float, ...] = ()


@dataclass(frozen=True)
class ComparisonTable(Shown):
    """The rows of a comparison and the size of its problem.

    Parameters
    ----------
    rows : tuple of ComparisonRow
    engine : str
    pairs, unknowns, rigid_motions : int
    title : str
    decided : Verdict or None
        What is known of the structure whose problem was compared; None of a bare problem.
    """

    rows: tuple[ComparisonRow, ...]
    engine: str
    pairs: int
    unknowns: int
    rigid_motions: int
    title: str = ""
    decided: Verdict | None = None

    @property
    def verdict(self) -> Verdict:
        """The verdict of the structure, with what the methods say of its equations."""
        return comparison_verdict(self)

    def as_dict(self) -> dict[str, Any]:
        """Return plain numbers, for JSON (residual histories included; not finite becomes None)."""
        told: dict[str, Any] = _plain(asdict(replace(self, decided=None)))
        del told["decided"]
        return {"status": self.verdict.status, **told, "verdict": self.verdict.as_dict()}


@strict
def compare(
    problem: ContactProblem,
    methods: Iterable[str] | None = None,
    *,
    engine: str = ENGINE,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    time_limit: float | None = None,
    progress: ProgressCallback | None = None,
    title: str = "",
    decided: Verdict | None = None,
) -> ComparisonTable:
    """Solve one problem by several methods and return the table.

    Parameters
    ----------
    problem : ContactProblem
    methods : iterable of str, optional
        Names as in :data:`concio.solvers.methods.METHODS`; default all but ``auto``. The engine is always run.
    engine : str
        Method whose seconds are 1.
    options : mapping, optional
        Options of methods by name.
    time_limit : float, optional
        Seconds after which a method is asked to stop (at its next iteration).
    progress : callable, optional
        Receives the progress of every method.
    title : str
    decided : Verdict, optional
        Verdict of the structure that the problem is of, such as ``result.verdict`` for the problem
        ``result.assembly.problem(result.factors)``: a row never calls solved what it says to fail.

    Raises
    ------
    MethodError
        There is no method of one of the names, or options are given for one that is not compared.
    ArgumentError
        A method has no option of a name that was given.
    InputError
        ``time_limit`` is not positive.
    """
    if time_limit is not None and not time_limit > 0:
        msg = f"time_limit = {time_limit:g} is not positive: no method would get any time"
        raise InputError(msg, hint="give seconds for each method, or None for no limit")
    names = [name for name in METHODS if name != "auto"] if methods is None else list(dict.fromkeys(methods))
    for name in (*names, engine):
        find(name)
    for name, given in (options or {}).items():
        if name not in (*names, engine):
            msg = f"options are given for '{name}', which is not among the methods compared"
            raise MethodError(msg, hint=closest(name, (*names, engine), names="compared"))
        check_options(name, given, function=f"method '{name}'")
    order = [engine, *(name for name in names if name != engine)]
    runs = [_run(problem, name, (options or {}).get(name, {}), time_limit, progress) for name in order]
    unit = runs[0][1]
    reference = next((s for s, _, _ in runs if isinstance(s, Solution) and s.solved), None)
    rows = [
        _row(problem, name, outcome, seconds, unit, reference, decided, slow=slow)
        for name, (outcome, seconds, slow) in zip(order, runs, strict=True)
    ]
    words = title or "comparison of methods"
    return ComparisonTable(
        tuple(rows), engine, problem.pairs, problem.unknowns, problem.rigid_motions, words, decided
    )


def format_table(table: ComparisonTable) -> str:
    """Return the table as text, one line a method, notes below."""
    head = ("method", "outcome", "certificate", "iterations", "factorisations", "time", "unknowns", "difference")
    lines = [
        (
            row.method,
            row.outcome,
            _number(row.worst, ".1e"),
            str(row.iterations) if row.iterations else "-",
            str(row.factorisations) if row.factorisations else "-",
            _number(row.ratio, ".2f") if row.ratio < 100 else _number(row.ratio, ".0f"),
            str(row.unknowns) if row.unknowns else "-",
            _number(row.difference, ".1e"),
        )
        for row in table.rows
    ]
    widths = [max(len(cell) for cell in column) for column in zip(head, *lines, strict=True)]
    text = [
        f"{table.title}: {table.pairs} pairs, {table.unknowns} displacements, {table.rigid_motions} rigid motions; "
        f"time in units of {table.engine}",
        "",
    ]
    for k, line in enumerate((head, *lines)):
        cells = [c.ljust(w) if i < 2 else c.rjust(w) for i, (c, w) in enumerate(zip(line, widths, strict=True))]
        text.append("  ".join(cells).rstrip())
        if k == 0:
            text.append("  ".join("-" * w for w in widths))
    notes = [f"  {row.method}: {row.note}" for row in table.rows if row.note]
    return "\n".join([*text, *(["", *notes] if notes else [])])


def _run(
    problem: ContactProblem,
    name: str,
    options: Mapping[str, Any],
    time_limit: float | None,
    progress: ProgressCallback | None,
) -> tuple[Solution | MethodError, float, bool]:
    """Solve by one method; a method that does not apply hands back its message."""
    start = perf_counter()
    slow = False

    def watch(state: Progress) -> bool:
        nonlocal slow
        slow = slow or (time_limit is not None and perf_counter() - start > time_limit)
        return slow or bool(progress and progress(state))

    try:
        outcome: Solution | MethodError = find(name)(problem, progress=watch, **options)
    except MethodError as error:
        outcome = error
    return outcome, perf_counter() - start, slow


def _row(
    problem: ContactProblem,
    name: str,
    outcome: Solution | MethodError,
    seconds: float,
    unit: float,
    reference: Solution | None,
    decided: Verdict | None,
    *,
    slow: bool,
) -> ComparisonRow:
    if isinstance(outcome, MethodError):
        nan = float("nan")
        return ComparisonRow(name, "not applicable", nan, 0, 0, seconds, seconds / unit, 0, nan, str(outcome))
    word = word_of(outcome.status, decided)
    if slow and not outcome.solved:
        word = "too slow"
    difference = float("nan")
    if outcome.solved and reference is not None:
        size = float(np.abs(reference.displacement).max(initial=0.0)) or 1.0
        difference = float(np.abs(outcome.displacement - reference.displacement).max(initial=0.0)) / size
    history = tuple(float(r) for r in outcome.info.get("history", ()))
    work = tuple(float(w) for w in outcome.info.get("work", ()))
    return ComparisonRow(
        method=name,
        outcome=word,
        worst=outcome.certificate.worst,
        iterations=outcome.iterations,
        factorisations=outcome.factorisations,
        seconds=seconds,
        ratio=seconds / unit,
        unknowns=int(outcome.info.get("unknowns", problem.unknowns + problem.pairs * problem.dim)),
        difference=difference,
        note="" if outcome.solved else (outcome.trace[-1] if outcome.trace else outcome.status.value),
        history=history,
        work=work if len(work) == len(history) else (),
    )


def _number(value: float, form: str) -> str:
    return format(value, form) if np.isfinite(value) else "-"


def _plain(value: Any) -> Any:
    """Replace tuples by lists and numbers that JSON does not know by None."""
    if isinstance(value, dict):
        return {key: _plain(v) for key, v in value.items()}
    if isinstance(value, (tuple, list)):
        return [_plain(v) for v in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value
