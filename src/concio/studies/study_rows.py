"""One run of a study: from the values of its variables to a row, whatever happens in it.

Nothing that goes wrong in a run stops the study: bad values, structures that do not stand, solvers that give up,
functions that raise and runs that take too long are rows with a verdict and a sentence.
"""

from __future__ import annotations

import faulthandler
import math
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from types import FrameType
from typing import Any

from concio.errors import ConcioError, InputError, NoEquilibriumError, SolverError
from concio.model.file.keys import KeyPath, with_values
from concio.model.file.reading import model_from_tables
from concio.model.model import Model
from concio.studies.analyses import Analyses, Settings
from concio.studies.outputs import Output, verdict_of
from concio.studies.variables import Variable

GRACE = 5.0
"""Seconds beyond its time limit after which a run that does not answer is ended with its process."""


@dataclass(frozen=True)
class Row:
    """Outcome of one run.

    Parameters
    ----------
    index : int
        Number of the run, from 0.
    verdict : str
        "solved", "no_equilibrium", "collapses" ... of its load step; "done" where none was asked for; "bad_input",
        "raised", "time_limit", "worker_lost" where it did not end by itself.
    message : str
        Why, in a sentence; empty where all is well.
    outputs : mapping of str to float
        ``nan`` where the run has no such number.
    seconds : float
    fails : tuple of str
        Outputs without a number because the structure is proven not to stand under the loads that they begin with.
    errors : mapping of str to str
        Why an output could not be computed: a word of :data:`FAILURES` and a sentence.
    acting : mapping
        Load groups with their forces at factor 1, as :class:`concio.verdict.question.Acting` has them.
    attention : tuple of str
        What is suspicious about the model of the run.
    unseen : tuple of str
        Bodies too light for the certificates of the run.
    assumed : tuple of str
        What of the model was not given, such as the thickness of a plane one.
    """

    index: int
    verdict: str
    message: str = ""
    outputs: Mapping[str, float] = field(default_factory=dict)
    seconds: float = 0.0
    fails: tuple[str, ...] = ()
    errors: Mapping[str, str] = field(default_factory=dict)
    acting: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    attention: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()

    @property
    def failed(self) -> bool:
        """Whether the run has no verdict on the structure, or none on one of its outputs because of a fault."""
        return self.verdict in FAILURES or bool(self.errors)

    def placed(self, output: Output) -> float:
        """Return the value of an output; of a structure that does not stand the worse end of the scale."""
        value = self.outputs.get(output.name, math.nan)
        if math.isnan(value) and output.name in self.fails:
            return {"low": -math.inf, "high": math.inf}.get(output.end, math.nan)
        return value

    def as_dict(self) -> dict[str, Any]:
        """Return plain values; numbers that are not finite as texts, so that JSON keeps them."""
        told = asdict(self)
        told["outputs"] = {k: v if math.isfinite(v) else str(v) for k, v in self.outputs.items()}
        return told

    @classmethod
    def from_dict(cls, told: Mapping[str, Any]) -> Row:
        """Return the row that :meth:`as_dict` wrote."""
        outputs = {str(k): float(v) for k, v in told["outputs"].items()}
        return cls(
            int(told["index"]), str(told["verdict"]), str(told["message"]), outputs, float(told["seconds"]),
            tuple(told.get("fails", ())), dict(told.get("errors", {})), dict(told.get("acting", {})),
            tuple(told.get("attention", ())), tuple(told.get("unseen", ())),
            tuple(told.get("assumed", ())),
        )  # fmt: skip


FAILURES = ("bad_input", "raised", "time_limit", "worker_lost", "gave_up", "cancelled")
"""Verdicts that say nothing of the structure."""


@dataclass(frozen=True)
class Tables:
    """A model file as the source of models: tables, and the keys that variables change.

    Parameters
    ----------
    data : mapping
        Tables as read from TOML, without ``[study]``.
    folder : str
        Files beside the model file are relative to it.
    name : str
        For messages.
    places : tuple of tuple of KeyPath
        Of each variable.
    """

    data: Mapping[str, Any]
    folder: str
    name: str
    places: tuple[tuple[KeyPath, ...], ...]

    def tables(self, variables: tuple[Variable, ...], numbers: tuple[float, ...]) -> dict[str, Any]:
        """Return the tables of one run."""
        values = {
            place: v.written(x)
            for v, x, places in zip(variables, numbers, self.places, strict=True)
            for place in places
        }
        return with_values(self.data, values)

    def model(self, variables: tuple[Variable, ...], numbers: tuple[float, ...]) -> Model:
        """Return the model of one run."""
        return model_from_tables(self.tables(variables, numbers), folder=self.folder, name=self.name)


@dataclass(frozen=True)
class Task:
    """All that a worker needs to make any run of a study.

    Parameters
    ----------
    source : Tables or callable
        A function takes the values by name, and ``seed``, and returns a :class:`Model` or the outputs by name.
    variables : tuple of Variable
    outputs : tuple of Output
        Of models; of a function that returns outputs itself only their names count.
    settings : Settings
    time_limit : float
        Seconds for a run.
    own_process : bool
        Whether the process may be ended with a run that does not stop.
    """

    source: Tables | Callable[..., Any]
    variables: tuple[Variable, ...]
    outputs: tuple[Output, ...]
    settings: Settings = field(default_factory=Settings)
    time_limit: float = math.inf
    own_process: bool = False

    def __call__(self, index: int, numbers: tuple[float, ...], seed: int) -> Row:
        """Make one run; see :func:`run_row`."""
        return run_row(self, index, numbers, seed)


class OutOfTimeError(Exception):
    """Raised in a run whose time is over."""


def run_row(task: Task, index: int, numbers: tuple[float, ...], seed: int) -> Row:
    """Make one run and return its row; only interrupts get out of it."""
    start = time.monotonic()
    made = _Made({o.name: math.nan for o in task.outputs})
    try:
        with _limited(task.time_limit, task.own_process):
            _evaluate(task, numbers, seed, start + task.time_limit, made)
    except OutOfTimeError:
        made.verdict = "time_limit"
    except Exception as error:  # what a function of the user's raises is a row, never the end of a study
        made.verdict, made.message = _fault(error)
    late = time.monotonic() - start > task.time_limit
    if made.verdict == "time_limit" or (late and made.verdict in ("cancelled", "raised", "gave_up", "undecided")):
        made.verdict, made.message = "time_limit", f"the run did not end within {task.time_limit:g} s"
    return Row(
        index, made.verdict, made.message, made.outputs, round(time.monotonic() - start, 6), tuple(made.fails),
        made.errors, made.acting, made.attention, made.unseen, made.assumed,
    )  # fmt: skip


@dataclass
class _Made:
    """What a run has come to so far."""

    outputs: dict[str, float]
    verdict: str = "raised"
    message: str = ""
    fails: list[str] = field(default_factory=list)
    errors: dict[str, str] = field(default_factory=dict)
    acting: dict[str, dict[str, Any]] = field(default_factory=dict)
    attention: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()


def _fault(error: Exception) -> tuple[str, str]:
    """Return a word of :data:`FAILURES` or a verdict, and a sentence, for what was raised."""
    if isinstance(error, NoEquilibriumError):
        return "no_equilibrium", str(error)
    if isinstance(error, InputError):
        return "bad_input", str(error)
    if isinstance(error, SolverError):
        return "gave_up", str(error)
    if isinstance(error, ConcioError):
        return "raised", str(error)
    if isinstance(error, MemoryError):
        return "raised", "the run does not fit into memory"
    return "raised", f"{type(error).__name__}: {error}"


def _evaluate(task: Task, numbers: tuple[float, ...], seed: int, deadline: float, row: _Made) -> None:
    """Fill a row from a model, or from what the study's function returns."""
    if isinstance(task.source, Tables):
        made: Any = task.source.model(task.variables, numbers)
    else:
        values = {v.name: v.value(x) for v, x in zip(task.variables, numbers, strict=True)}
        made = task.source({**values, "seed": seed})
    if isinstance(made, Model):
        _analyse(Analyses(made, task.settings, deadline), task.outputs, row)
        return
    outputs = row.outputs
    if not isinstance(made, Mapping):
        made = {task.outputs[0].name: made} if len(task.outputs) == 1 else made
    if not isinstance(made, Mapping) or not set(outputs) <= set(made):
        said = ", ".join(map(str, made)) if isinstance(made, Mapping) else type(made).__name__
        msg = f"the function returned {said or 'nothing'}, not the outputs {', '.join(outputs)}"
        raise InputError(msg, hint="return a concio.Model, or a mapping of the outputs' names to numbers")
    outputs.update({name: float(made[name]) for name in outputs})
    row.verdict, row.message = str(made.get("verdict", "done")), str(made.get("message", ""))


def _analyse(analyses: Analyses, wanted: tuple[Output, ...], row: _Made) -> None:
    """Read every output of a model, each for itself: one that is not available takes nothing from the others."""
    proven = first = ""
    for output in wanted:
        try:
            row.outputs[output.name] = float(output.read(analyses))
        except OutOfTimeError:
            raise
        except NoEquilibriumError as error:
            row.fails.append(output.name)
            proven = proven or str(error)
        except Exception as error:  # what a function of the user's raises is reported in the row
            word, message = _fault(error)
            row.errors[output.name] = f"{word}: {message}"
            first = first or word
    row.verdict, row.message = verdict_of(analyses)
    if row.verdict == "done" and (proven or first):
        row.verdict, row.message = ("no_equilibrium", proven) if proven else (first, "")
    if row.errors:
        row.message = "; ".join(dict.fromkeys(text.split(": ", 1)[1] for text in row.errors.values()))
    row.acting, row.attention, row.unseen = analyses.acting, analyses.attention, analyses.unseen
    row.assumed = analyses.assumed


@contextmanager
def _limited(seconds: float, own_process: bool) -> Iterator[None]:
    """Raise :class:`OutOfTimeError` after some seconds where the system can; later end a process of its own."""
    if not math.isfinite(seconds):
        yield
        return
    alarm = threading.current_thread() is threading.main_thread() and hasattr(signal, "setitimer")

    def late(_: int, __: FrameType | None) -> None:
        raise OutOfTimeError

    if own_process:
        faulthandler.dump_traceback_later(seconds + GRACE, exit=True, file=_nowhere())
    previous = signal.signal(signal.SIGALRM, late) if alarm else None
    if alarm:
        signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        if alarm:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, previous)
        if own_process:
            faulthandler.cancel_dump_traceback_later()


_SINK: list[int] = []


def _nowhere() -> int:
    """Return the descriptor of a file that keeps nothing, opened once."""
    if not _SINK:
        _SINK.append(os.open(os.devnull, os.O_WRONLY))
    return _SINK[0]
