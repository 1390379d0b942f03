"""``concio.study``: one model, many runs.

The table of values is made first and then stays as it is; each run is a row of its own, whatever comes of it; rows are
written as they end, so that a study that was stopped goes on where it was. Which executor made a row, and when, changes
nothing in it.
"""

from __future__ import annotations

import os
import time
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from concio.arguments import strict, strict_class
from concio.errors import InputError
from concio.model.file.keys import find_key
from concio.model.file.reading import read_tables
from concio.model.file.study_table import StudyTable, study_table
from concio.model.file.writing import dumps
from concio.model.model import Model
from concio.representation import short_repr
from concio.studies.analyses import Settings
from concio.studies.bridges import variables_of_salib
from concio.studies.executors import check_executor, run_rows
from concio.studies.groups import check_groups
from concio.studies.outputs import outputs_of
from concio.studies.sampling import Correlation, Sample, draw, given_sample
from concio.studies.statistics import probability
from concio.studies.store import Store, describe, missing
from concio.studies.study_reliability import required_multiplier
from concio.studies.study_result import StudyResult, event_of
from concio.studies.study_rows import Row, Tables, Task
from concio.studies.variables import Variable, variable

Array = np.ndarray
Progress = Callable[["StudyProgress"], "bool | None"]


@dataclass(frozen=True)
class StudyProgress:
    """What a progress callback receives after every row.

    Parameters
    ----------
    done, total : int
        Runs that have ended, those of earlier sittings included, and runs in all.
    failed : int
        Rows without a verdict on the structure.
    seconds : float
        Since this sitting began.
    seconds_left : float
        At the pace of this sitting.
    """

    done: int
    total: int
    failed: int
    seconds: float
    seconds_left: float


@strict_class
@short_repr
@dataclass(frozen=True)
class Stop:
    """When a study has seen enough: a probability is known to within an interval.

    The interval is that of the rows from the first on without a gap, so that it does not matter in which order workers
    bring them. Looking after every row makes intervals a little too narrow, as with any sequential test.

    Parameters
    ----------
    output : str
    width : float
        Width of the interval (high less low) at which to stop.
    below, above : float, optional
        The event: the output is less than ``below``, or more than ``above``; without both, it is not zero.
    confidence : float
    least : int
        Runs that are made in any case.

    Examples
    --------
    The study of 40 runs ends when the probability that the pillar stands is known to within 0.6:

    >>> import concio
    >>> push = concio.variable("push", "uniform", low=0.1, high=0.4)
    >>> def pillar(values):
    ...     return concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=values["push"])
    >>> stop = concio.Stop("stands", width=0.6, above=0.5, least=5)
    >>> found = concio.study(pillar, [push], "stands", size=40, stop=stop)
    >>> found.stopped
    True
    """

    output: str
    width: float
    below: float | None = None
    above: float | None = None
    confidence: float = 0.95
    least: int = 30

    def __post_init__(self) -> None:
        if not 0 < self.width < 1:
            msg = f"width = {self.width!r} must lie between 0 and 1"
            raise InputError(msg, where="stop")

    def enough(self, values: Array) -> bool:
        """Return whether the values (n,) of the output in the first n runs say enough."""
        if len(values) < self.least:
            return False
        found = probability(event_of(values, self.below, self.above), self.confidence)
        return found.high - found.low <= self.width


@strict
def study(
    model: Any,
    variables: Any = None,
    outputs: Any = None,
    sample: Any = None,
    *,
    size: int | None = None,
    seed: int | None = None,
    correlation: Correlation | None = None,
    executor: Any = None,
    workers: int | None = None,
    directory: str | os.PathLike[str] | None = None,
    resume: bool = False,
    time_limit: float | None = None,
    stop: Stop | None = None,
    method: str | None = None,
    factors: Mapping[str, float] | None = None,
    live: str | Sequence[str] | None = None,
    required: float | None = None,
    progress: Progress | None = None,
) -> StudyResult:
    """Make many runs of one model and return their table.

    Parameters
    ----------
    model : path, Model, mapping or callable
        A model file (what its ``[study]`` says counts where arguments do not), a model, the tables of a model file, or
        a function that takes the values of a run by name (a dict, with a ``seed`` of its own) and returns a
        :class:`concio.Model`, or a mapping of outputs.
    variables : sequence of Variable, or mapping
        What differs from run to run: see :func:`concio.variable`; or a mapping of names to its arguments; or the
        problem dictionary of SALib (for functions, whose arguments need no keys).
    outputs : str, sequence of str, or mapping of str to function
        Names as in :data:`concio.studies.outputs.KNOWN`, or functions of the run's
        :class:`~concio.studies.analyses.Analyses`.
    sample : str, Sample or (n, k) array
        A design of :data:`concio.studies.sampling.DESIGNS`, "latin-hypercube" by default, or values made elsewhere.
    size : int, optional
        Number of runs; see :func:`concio.studies.sampling.draw`.
    seed : int, optional
        What random numbers begin with; 0 by default.
    correlation : mapping of pairs of names to float, or (k, k) array, optional
        Rank correlation of variables; as a matrix in their order.
    executor : optional
        None or "serial", "processes", "dask", the address of a Dask scheduler, a Dask client, or any executor of
        ``concurrent.futures``.
    workers : int, optional
        More than one means processes where no executor is named.
    directory : path, optional
        Rows are written there as they end.
    resume : bool
        Go on with the study that ``directory`` holds.
    time_limit : float, optional
        Seconds for a run; one that takes longer is a row that says so.
    stop : Stop, optional
        When to stop before the end of the sample.
    method, factors, live
        Of the analyses, as in :func:`concio.solve` and :func:`concio.limit`.
    required : float, optional
        Multiplier of ``live`` that is required: its reliability index of first order is given beside the sample.
    progress : callable, optional
        Called with :class:`StudyProgress` after every row; true stops the study.

    Returns
    -------
    StudyResult

    Raises
    ------
    InputError
        Something does not fit; or the directory holds another study.
    StorageError
        Rows cannot be written; those written before are kept.

    Examples
    --------
    A pillar tips under a horizontal share of its weight of 0.25:

    >>> import concio
    >>> push = concio.variable("push", "uniform", low=0.1, high=0.4)
    >>> def pillar(values):
    ...     return concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=values["push"])
    >>> found = concio.study(pillar, [push], "stands", sample=[[0.1], [0.2], [0.3], [0.4]])
    >>> found.table()["stands"].tolist()
    [1.0, 1.0, 0.0, 0.0]
    >>> found.probability("stands", above=0.5).estimate
    0.5

    Friction in the tables of a model file, of which a file may be given as well:

    >>> mu = concio.variable("mu", "uniform", keys="arch.friction", low=0.3, high=0.7)
    >>> arch = {"arch": {"span": 2.0, "ring": 0.3, "voussoirs": 9, "block": "rigid"}}
    >>> found = concio.study(arch, [mu], "stands", size=4)
    >>> found.verdicts
    {'solved': 3, 'no_equilibrium': 1}
    """
    check_executor(executor, workers)
    source, table = _source(model)
    if table is None and outputs is None and isinstance(model, str | os.PathLike):
        msg = "there is no table [study]"
        raise InputError(msg, where=str(model), hint="add [study] with outputs = ['stands'], and [[study.variables]]")
    given = table or StudyTable()
    stated = tuple(variable(**v.arguments()) for v in given.variables)
    chosen = _variables(variables) if variables is not None else stated
    wanted = outputs_of(outputs if outputs is not None else given.outputs, returned=callable(source))
    settings = Settings(
        method if method is not None else given.method,
        dict(factors if factors is not None else given.factors),
        (live,) if isinstance(live, str) else tuple(live if live is not None else given.live),
    )
    limit = time_limit if time_limit is not None else given.time_limit
    if not limit > 0:
        msg = f"time_limit = {limit!r} must be positive"
        raise InputError(msg)
    if isinstance(source, Mapping):
        source = _tables(source, chosen, model)
    elif any(v.keys for v in chosen):
        named = next(v for v in chosen if v.keys)
        msg = f"variable '{named.name}' names keys of a model file, but the model is a function"
        raise InputError(msg, hint="leave keys out: the function gets the value by its name")
    design = sample if sample is not None else given.sample
    if isinstance(design, str):
        pairs = correlation if correlation is not None else given.correlations
        first = seed if seed is not None else given.seed
        made = draw(chosen, design, size if size is not None else given.size, seed=first, correlation=pairs)
    else:
        made = _made_elsewhere(design, chosen, size, correlation, seed or 0)
    task = Task(source, made.variables, wanted, settings, float(limit))
    if stop is None and given.stop is not None:
        stop = Stop(**given.stop.model_dump())
    if stop is not None and stop.output not in [o.name for o in wanted]:
        msg = f"'{stop.output}' is not an output of the study"
        raise InputError(msg, where="stop", hint="outputs: " + ", ".join(o.name for o in wanted))
    check_groups(task, made)
    path = None if directory is None else Path(directory)
    wanted_multiplier = required if required is not None else given.required
    index = None
    if wanted_multiplier is not None:  # before the runs: what it refuses is refused at once
        index = required_multiplier(wanted_multiplier, source, made, settings)
    found = _run(task, made, path, resume, stop, progress, executor, workers)
    return found if index is None else replace(found, required=index)


def _run(
    task: Task,
    sample: Sample,
    directory: Path | None,
    resume: bool,
    stop: Stop | None,
    progress: Progress | None,
    executor: Any,
    workers: int | None,
) -> StudyResult:
    description = describe(task, sample)
    store = Store(directory, description, sample, resume=resume)
    begun, before = time.monotonic(), len(store.rows)
    first = 0
    values: list[float] = []
    watched = next((o for o in task.outputs if stop is not None and o.name == stop.output), task.outputs[0])

    def enough() -> bool:
        nonlocal first
        if stop is None:
            return False
        while first in store.rows:
            values.append(store.rows[first].placed(watched))
            first += 1
            if stop.enough(np.array(values)):
                return True
        return False

    def emit(row: Row) -> bool:
        store.add(row)
        done, seconds = len(store.rows), time.monotonic() - begun
        left = seconds / max(done - before, 1) * (len(sample) - done)
        failed = sum(r.failed for r in store.rows.values())
        halt = progress is not None and progress(StudyProgress(done, len(sample), failed, seconds, left))
        return enough() or bool(halt)

    try:
        if not enough():
            run_rows(task, sample, missing(len(sample), store.rows), emit, executor=executor, workers=workers)
    finally:
        store.close()
    count = first if stop is not None and stop.enough(np.array(values)) else len(sample)
    rows = tuple(store.rows[i] for i in sorted(store.rows) if i < count)
    tables = task.source if isinstance(task.source, Tables) else None
    return StudyResult(sample, task.outputs, rows, tables, directory, count < len(sample), task.settings)


def _source(model: Any) -> tuple[Any, StudyTable | None]:
    """Return a function, or the tables of a model, and what its file says of a study."""
    if isinstance(model, str | os.PathLike):
        data = read_tables(Path(model))
        return {k: v for k, v in data.items() if k != "study"}, study_table(data, str(model))
    if isinstance(model, Model):
        return tomllib.loads(dumps(model)), None
    if isinstance(model, Mapping):
        return {k: v for k, v in model.items() if k != "study"}, study_table(model, "model")
    if callable(model):
        return model, None
    msg = f"{type(model).__name__} is not a model"
    raise InputError(msg, hint="give the name of a model file, a concio.Model, or a function of a run's values")


def _tables(data: Mapping[str, Any], variables: Sequence[Variable], model: Any) -> Tables:
    """Return the source of models, each key of each variable found in the file."""
    is_file = isinstance(model, str | os.PathLike)
    name = str(model) if is_file else "model"
    taken: dict[tuple[str | int, ...], str] = {}
    places = []
    for v in variables:
        if not v.keys:
            msg = f"variable '{v.name}' changes nothing: it names no key of the model"
            raise InputError(msg, where=name, hint='for example keys = "wall.friction"')
        found = tuple(find_key(data, key, where=f"{name}, variable '{v.name}'") for key in v.keys)
        for place in found:
            if place.parts in taken:
                msg = f"variables '{taken[place.parts]}' and '{v.name}' both set {place.text}"
                raise InputError(msg, where=name)
            taken[place.parts] = v.name
            held = place.get(data)
            if isinstance(held, str) and not v.unit and v.distribution != "choice" and any(c.isdigit() for c in held):
                msg = f"the file writes {place.text} as '{held}', with a unit; variable '{v.name}' says none"
                raise InputError(msg, where=name, hint="give the variable a unit, such as " + held.split(" ", 1)[-1])
        places.append(found)
    folder = str(Path(model).absolute().parent) if is_file else "."
    return Tables(dict(data), folder, name, tuple(places))


def _variables(given: Any) -> tuple[Variable, ...]:
    """Return variables from themselves, from their arguments by name, or from a problem of SALib."""
    if isinstance(given, Variable):
        return (given,)
    if isinstance(given, Mapping):
        if "num_vars" in given:
            return variables_of_salib(given)
        return tuple(v if isinstance(v, Variable) else variable(str(name), **v) for name, v in given.items())
    found = tuple(given)
    for v in found:
        if not isinstance(v, Variable):
            msg = f"{v!r} is not a variable"
            raise InputError(msg, hint='make one: concio.variable("mu", low=0.3, high=0.7, keys="wall.friction")')
    return found


def _made_elsewhere(
    design: Any, variables: Sequence[Variable], size: int | None, correlation: Correlation | None, seed: int
) -> Sample:
    for name, value in (("size", size), ("correlation", correlation)):
        if value is not None:
            msg = f"{name} belongs to a sample that is drawn here, not to one that is given"
            raise InputError(msg, hint=f"leave {name} out")
    if isinstance(design, Sample):
        return design
    return given_sample(variables, design, seed=seed)
