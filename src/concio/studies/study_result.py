"""The result of a study: an immutable table, and what can be asked of it."""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.arguments import closest, strict
from concio.errors import InputError
from concio.model.file.keys import KeyPath, find_key
from concio.model.file.writing import toml_of
from concio.studies.analyses import Analyses, Settings
from concio.studies.outputs import KNOWN, NAN, Output
from concio.studies.sampling import Sample
from concio.studies.statistics import (
    Fragility,
    Probability,
    Sensitivity,
    Spread,
    fragility,
    probability,
    rank_correlations,
    sobol_indices,
)
from concio.studies.store import DESCRIPTION, ROWS, SAMPLE
from concio.studies.study_rows import Row, Tables
from concio.studies.variables import Variable
from concio.verdict.study_verdict import output_words, study_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown, view

if TYPE_CHECKING:
    from concio.plot.study_figures import StudyPlots
    from concio.studies.study_reliability import RequiredMultiplier

Array = np.ndarray
Event = str | Callable[[Mapping[str, Any]], bool]


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult(Shown):
    """Rows of a study, in the order of its sample.

    Parameters
    ----------
    sample : Sample
        Values of the variables in all runs that were planned.
    outputs : tuple of Output
    rows : tuple of Row
        Of the runs that ended; without gaps where the study was not interrupted.
    source : Tables or None
        The model file behind it; None where models come from a function.
    directory : Path or None
        Where rows are kept.
    stopped : bool
        Whether it stopped before the end of the sample because the stopping criterion was met.
    settings : Settings or None
        Load factors and multiplied groups of the analyses.
    required : RequiredMultiplier or None
        Reliability index of the multiplier that is required, where one is.
    """

    sample: Sample
    outputs: tuple[Output, ...]
    rows: tuple[Row, ...]
    source: Tables | None = None
    directory: Path | None = None
    stopped: bool = False
    settings: Settings | None = None
    required: RequiredMultiplier | None = None

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        head = f"StudyResult: {len(self)} of {len(self.sample)} runs, {self.sample.design} sample"
        lines = [head + (", stopped early: the stopping criterion was met" if self.stopped else "")]
        lines += [f"  {v.name}: {v.describe()}" for v in self.sample.variables[:4]]
        lines += [f"  {word}: {count}" for word, count in self.verdicts.items()]
        lines += [f"  {o.name} [{o.unit}]: {output_words(self, o)}" for o in self.outputs[:4]]
        return "\n".join(lines)

    @cached_property
    def verdict(self) -> Verdict:
        """What was asked of the runs, what came out, and what has no answer."""
        return study_verdict(self)

    @cached_property
    def verdicts(self) -> dict[str, int]:
        """How many rows have each verdict, the commonest first."""
        return dict(Counter(row.verdict for row in self.rows).most_common())

    @property
    def failures(self) -> tuple[Row, ...]:
        """Rows without a verdict on the structure or on an output, each with its sentence."""
        return tuple(row for row in self.rows if row.failed)

    @cached_property
    def _index(self) -> Array:
        return np.array([row.index for row in self.rows], dtype=int)

    def values(self, name: str) -> Array:
        """Return the values (n,) of an output or a variable, row by row; of a choice the indices of its values.

        An output is ``nan`` where a run has no number; :meth:`placed` tells failures from runs without an answer.

        Raises
        ------
        InputError
            There is no output or variable of that name.
        """
        if name in (o.name for o in self.outputs):
            return np.array([row.outputs.get(name, NAN) for row in self.rows])
        names = [v.name for v in self.sample.variables]
        if name not in names:
            msg = f"there is no output or variable '{name}'"
            raise InputError(msg, hint=closest(name, [*(o.name for o in self.outputs), *names]))
        column: Array = self.sample.column(name)[self._index]
        return column

    def placed(self, name: str) -> Array:
        """Return the values (n,) of an output with runs that do not stand at the worse end of the scale.

        That is ``-inf`` of a multiplier and ``inf`` of a settlement; ``nan`` is left to runs without an answer.
        """
        output = self._output(name)
        return np.array([row.placed(output) for row in self.rows])

    def spread(self, name: str) -> Spread:
        """Return how an output is spread over all runs: quantiles, and how many runs fail or have no answer."""
        output = self._output(name)
        return Spread(self.placed(name), sum(name in row.fails for row in self.rows), output.end)

    def _output(self, name: str) -> Output:
        found = next((o for o in self.outputs if o.name == name), None)
        if found is None:
            msg = f"there is no output '{name}'"
            raise InputError(msg, hint=closest(name, [o.name for o in self.outputs]))
        return found

    def event(self, event: Event, *, below: float | None = None, above: float | None = None) -> Array:
        """Return whether an event happened in each row (n,): 1, 0, or ``nan`` where the row does not say.

        Parameters
        ----------
        event : str or callable
            An output, or a function of a row (a mapping of variables and outputs, these as :meth:`placed`). A row in
            which the function looks at an output without an answer does not say.
        below, above : float, optional
            The output is less than ``below``, or more than ``above``; without both, it is not zero.
        """
        if isinstance(event, str):
            known = event in (o.name for o in self.outputs)
            return event_of(self.placed(event) if known else self.values(event), below, above)
        told = []
        for row in self.rows:
            read = _Read({**self.sample.row(row.index), **{o.name: row.placed(o) for o in self.outputs}})
            happened = bool(event(read))
            told.append(NAN if read.unknown else float(happened))
        return np.array(told)

    def probability(
        self, event: Event, *, below: float | None = None, above: float | None = None, confidence: float = 0.95
    ) -> Probability:
        """Return the probability of an event with its interval; see :meth:`event`.

        Raises
        ------
        InputError
            The runs are not a random sample.

        Examples
        --------
        A pillar stands in two of four runs. The interval for so few runs is wide:

        >>> import concio
        >>> push = concio.variable("push", "uniform", low=0.1, high=0.4)
        >>> def pillar(values):
        ...     return concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=values["push"])
        >>> found = concio.study(pillar, [push], "stands", sample=[[0.1], [0.2], [0.3], [0.4]])
        >>> stands = found.probability("stands", above=0.5)
        >>> stands.estimate, round(stands.low, 2), round(stands.high, 2)
        (0.5, 0.07, 0.93)
        """
        if self.sample.design in ("grid", "one-at-a-time", "saltelli"):
            msg = f"a {self.sample.design} sample has no probabilities"
            raise InputError(msg, hint="take monte-carlo, latin-hypercube or sobol")
        return probability(self.event(event, below=below, above=above), confidence)

    def fragility(
        self, intensity: str, event: Event, *, below: float | None = None, above: float | None = None
    ) -> Fragility:
        """Fit a lognormal fragility curve of an event over a variable; see :meth:`event`."""
        return fragility(self.values(intensity), self.event(event, below=below, above=above))

    def sensitivity(self, output: str) -> Sensitivity:
        """Return what matters for an output: Sobol indices of a ``saltelli`` sample, else rank correlations."""
        names = [v.name for v in self.sample.variables]
        if self.sample.design == "saltelli":
            if len(self) < len(self.sample):
                msg = f"only {len(self)} of {len(self.sample)} runs have ended"
                raise InputError(msg, hint="resume the study: Sobol indices need all of them")
            return sobol_indices(names, self.placed(output), self.sample.seed)
        columns = {v.name: self.values(v.name) for v in self.sample.variables if v.distribution != "seed"}
        return rank_correlations(columns, self.placed(output))

    def table(self) -> dict[str, Any]:
        """Return columns by name, units in brackets: run, variables, outputs, verdict, message, seconds."""
        runs = [self.sample.row(row.index) for row in self.rows]
        columns: dict[str, Any] = {"run": self._index}
        for v in self.sample.variables:
            columns[f"{v.name} [{v.unit}]" if v.unit else v.name] = np.array([run[v.name] for run in runs])
        for o in self.outputs:
            columns[f"{o.name} [{o.unit}]" if o.unit != "-" else o.name] = self.values(o.name)
        columns["verdict"] = np.array([row.verdict for row in self.rows])
        columns["message"] = np.array([row.message for row in self.rows])
        columns["seconds"] = np.array([row.seconds for row in self.rows])
        return columns

    def frame(self) -> Any:
        """Return the table as a ``pandas.DataFrame``.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        try:
            import pandas as pd
        except ImportError:
            msg = "a DataFrame needs the package pandas"
            raise InputError(msg, hint="pip install 'concio[study]', or take table()") from None
        return pd.DataFrame(self.table()).set_index("run")

    def model_text(self, index: int) -> str:
        """Return the model file that reproduces a run.

        Raises
        ------
        InputError
            There is no such run, or its model came from a function.
        """
        if not 0 <= index < len(self.sample):
            msg = f"there is no run {index}"
            raise InputError(msg, hint=f"runs go from 0 to {len(self.sample) - 1}")
        if self.source is None:
            msg = "models of this study come from a function, not from a file"
            raise InputError(msg, hint="call the function with sample.row(...) and the run's seed")
        return toml_of(self.source.tables(self.sample.variables, tuple(self.sample.numbers[index].tolist())))

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        outputs = {
            o.name: {"unit": o.unit, "meaning": o.meaning, **self.spread(o.name).as_dict()} for o in self.outputs
        }
        return {
            "runs": len(self),
            "planned": len(self.sample),
            "stopped": self.stopped,
            "design": self.sample.design,
            "seed": self.sample.seed,
            "verdicts": self.verdicts,
            "outputs": outputs,
            "variables": {v.name: v.describe() for v in self.sample.variables},
            "verdict": self.verdict.as_dict(),
            **({} if self.required is None else {"required": self.required.as_dict()}),
        }

    @property
    def plot(self) -> StudyPlots:
        """Figures by name; matplotlib is loaded here."""
        plots: StudyPlots = view(self, "plot")
        return plots


class _Read(dict[str, Any]):
    """A row that notes whether an output without an answer was examined."""

    unknown = False

    def __getitem__(self, name: str) -> Any:
        value = super().__getitem__(name)
        self.unknown = self.unknown or (isinstance(value, float) and math.isnan(value))
        return value

    def get(self, name: str, default: Any = None) -> Any:
        """Return a value, as a dict does."""
        try:
            return self[name]
        except KeyError:
            return default


def event_of(values: Array, below: float | None, above: float | None) -> Array:
    """Return whether values (n,) are less than ``below``, more than ``above``, or not zero; ``nan`` where unknown."""
    if below is not None and above is not None:
        msg = "an event is either below or above a threshold"
        raise InputError(msg, hint="give one of the two")
    if below is not None:
        happened = values < below
    elif above is not None:
        happened = values > above
    else:
        happened = values != 0
    told: Array = np.where(np.isnan(values), NAN, happened)
    return told


@strict
def load_study(directory: str | os.PathLike[str]) -> StudyResult:
    """Return a study from its directory, ended or not.

    Raises
    ------
    InputError
        There is no study, or it cannot be read.

    Examples
    --------
    >>> import concio
    >>> import tempfile
    >>> from pathlib import Path
    >>> push = concio.variable("push", "uniform", low=0.1, high=0.4)
    >>> def pillar(values):
    ...     return concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=values["push"])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = concio.study(pillar, [push], "stands", sample=[[0.2], [0.3]], directory=Path(folder) / "runs")
    ...     found = concio.load_study(Path(folder) / "runs")
    >>> found.table()["stands"].tolist()
    [1.0, 0.0]
    """
    path = Path(directory)
    try:
        told = json.loads((path / DESCRIPTION).read_text(encoding="utf-8"))
        variables = tuple(Variable(**v) for v in told["variables"])
        outputs = tuple(_stored_output(o) for o in told["outputs"])
        held = told["settings"]
        settings = Settings(str(held["method"]), dict(held["factors"]), tuple(held["live"]))
        sample = _stored_sample(path, variables, told)
        source = _stored_source(told["source"])
        lines = (path / ROWS).read_bytes().split(b"\n")[:-1]
        rows = {row.index: row for row in (Row.from_dict(json.loads(line)) for line in reversed(lines))}
    except FileNotFoundError:
        msg = "there is no study"
        raise InputError(msg, where=str(path), hint="make one: concio study FILE --out DIR") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        msg = f"the study cannot be read: {error}"
        raise InputError(msg, where=str(path)) from None
    return StudyResult(sample, outputs, tuple(rows[i] for i in sorted(rows)), source, path, settings=settings)


def _stored_output(told: Mapping[str, Any]) -> Output:
    known = KNOWN.get(told["name"], Output(told["name"], told["unit"], "", _unread))
    given = {key: told[key] for key in ("meaning", "end", "event", "multiplies") if key in told}
    return replace(known, read=_unread, **given)


def _unread(_: Analyses) -> float:
    return NAN


def _stored_source(told: Mapping[str, Any]) -> Tables | None:
    if "tables" not in told:
        return None
    places: tuple[tuple[KeyPath, ...], ...] = tuple(
        tuple(find_key(told["tables"], key) for key in keys) for keys in told["keys"]
    )
    return Tables(told["tables"], ".", "model", places)


def _stored_sample(path: Path, variables: tuple[Variable, ...], told: Mapping[str, Any]) -> Sample:
    import csv

    with (path / SAMPLE).open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))[1:]
    columns = []
    for j, v in enumerate(variables):
        texts = [row[1 + j] for row in rows]
        if v.distribution == "choice":
            known = [str(value) for value in v.values]
            columns.append([float(known.index(text)) for text in texts])
        else:
            columns.append([float(text) for text in texts])
    seeds = np.array([int(row[-1]) for row in rows], dtype=np.int64)
    return Sample(variables, np.array(columns).T, told["design"], int(told["seed"]), seeds)
