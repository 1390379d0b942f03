"""Outputs of a study: numbers of a model by name, each with the analysis it comes from, computed once a run."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.arguments import closest
from concio.errors import InputError
from concio.model.model import Model
from concio.problem.solution import PROVEN_FAILURES, Progress, Status

if TYPE_CHECKING:
    from concio.analysis.limit import LimitResult
    from concio.analysis.margins import Margin
    from concio.analysis.result import Result
    from concio.contact.assembly import Assembly
    from concio.problem.solution import ProgressCallback

NAN = float("nan")


@dataclass(frozen=True)
class Settings:
    """How the analyses of every run are made.

    Parameters
    ----------
    method : str
        Method of :func:`concio.solve`.
    factors : mapping of str to float
        Load factors of :func:`concio.solve`.
    live : tuple of str
        Load groups that limits and margins multiply.
    """

    method: str = "auto"
    factors: Mapping[str, float] = field(default_factory=dict)
    live: tuple[str, ...] = ("live",)


class Analyses:
    """The analyses of one model, each made when it is first asked for.

    Parameters
    ----------
    model : Model
    settings : Settings
    deadline : float
        Time of :func:`time.monotonic` at which solvers are asked to stop.
    """

    def __init__(self, model: Model, settings: Settings | None = None, deadline: float = np.inf) -> None:
        self.model, self.settings, self.deadline = model, settings or Settings(), deadline

    @property
    def progress(self) -> ProgressCallback:
        """The callback that asks solvers to stop when the time of the run is over."""

        def late(_: Progress) -> bool:
            return time.monotonic() > self.deadline

        return late

    @cached_property
    def assembly(self) -> Assembly:
        """The discretised model."""
        from concio.contact.assembly import assemble

        return assemble(self.model)

    @cached_property
    def result(self) -> Result:
        """One load step, whatever its outcome."""
        from concio.analysis.step import solve

        s = self.settings
        return solve(
            self.assembly, method=s.method, factors=dict(s.factors), on_failure="return", progress=self.progress
        )

    @cached_property
    def limit(self) -> LimitResult:
        """The associated limit load, without the Coulomb path."""
        from concio.analysis.limit import limit

        return limit(self.assembly, self.settings.live, path=False, search=False)

    @cached_property
    def coulomb(self) -> LimitResult:
        """The associated limit load and the Coulomb path."""
        from concio.analysis.limit import limit

        return limit(self.assembly, self.settings.live, path=True, search=False, progress=self.progress)

    @cached_property
    def load_margin(self) -> Margin:
        """The largest factor of the live load that single steps were found to carry."""
        from concio.analysis.margins import load_margin

        return load_margin(self.assembly, self.settings.live)

    @cached_property
    def friction_factor(self) -> float:
        """The smallest common factor of friction with which admissible forces exist."""
        from concio.analysis.limit import friction_margin

        return friction_margin(self.assembly, self.settings.live).factor

    def made(self, name: str) -> bool:
        """Return whether an analysis was asked for."""
        return name in self.__dict__


def _stands(a: Analyses) -> float:
    if a.result.solved:
        return 1.0
    return 0.0 if a.result.status in PROVEN_FAILURES else NAN


@dataclass(frozen=True)
class OfSolved:
    """Reads a number of a certified equilibrium; ``nan`` of other outcomes (a class, so that it travels to workers)."""

    read: Callable[[Result], float]

    def __call__(self, a: Analyses) -> float:
        """Return the number."""
        return self.read(a.result) if a.result.solved else NAN


def _settlement(result: Result) -> float:
    return result.max_settlement


def _motion(result: Result) -> float:
    return result.joint_motion.motion


@dataclass(frozen=True)
class Output:
    """A number of every run.

    Parameters
    ----------
    name : str
    unit : str
        "-" where it has none.
    meaning : str
        What it is, in a few words.
    read : callable
        From the :class:`Analyses` of a model to the number; ``nan`` where the run has none.
    """

    name: str
    unit: str
    meaning: str
    read: Callable[[Analyses], float]


def _associated(a: Analyses) -> float:
    return a.limit.associated.multiplier


def _path(a: Analyses) -> float:
    return a.coulomb.coulomb


def _carried(a: Analyses) -> float:
    return a.coulomb.carried


def _load_margin(a: Analyses) -> float:
    return a.load_margin.holds


def _friction(a: Analyses) -> float:
    return a.friction_factor


KNOWN: dict[str, Output] = {
    o.name: o
    for o in (
        Output("stands", "-", "1 in certified equilibrium, 0 proven not to stand, nan undecided", _stands),
        Output("max_settlement", "m", "largest downward displacement", OfSolved(_settlement)),
        Output("joint_motion", "m", "largest opening or slip of a joint", OfSolved(_motion)),
        Output("associated_multiplier", "-", "associated limit multiplier of the live load", _associated),
        Output("coulomb_multiplier", "-", "collapse multiplier of the Coulomb load path, where shown", _path),
        Output("coulomb_carried", "-", "largest multiplier met on the Coulomb load path", _carried),
        Output("load_margin", "-", "largest factor of the live load that a step was found to carry", _load_margin),
        Output("friction_factor", "-", "smallest common factor of friction that admits forces in balance", _friction),
    )
}
"""Outputs by name; beside them ``reaction.NAME.x`` and ``reaction.NAME.y`` of a fixed body or a support [kN]."""


@dataclass(frozen=True)
class Reaction:
    """Reads one component of the reaction of a fixed body or a support (a class, so that it travels to workers)."""

    body: str
    component: int

    def __call__(self, a: Analyses) -> float:
        """Return the force on the structure [kN]."""
        if not a.result.solved:
            return NAN
        reactions = a.result.reactions
        if self.body not in reactions:
            msg = f"there is no fixed body or support called '{self.body}'"
            raise InputError(msg, hint=closest(self.body, list(reactions)))
        return reactions[self.body][self.component]


@dataclass(frozen=True)
class Computed:
    """Reads an output by a function of the user's, which takes the :class:`Analyses` of the run."""

    name: str
    function: Callable[[Any], float]

    def __call__(self, a: Analyses) -> float:
        """Return what the function says, as a number."""
        return float(self.function(a))


def find_output(name: str) -> Output:
    """Return the output of a name.

    Raises
    ------
    InputError
        There is none.
    """
    if name in KNOWN:
        return KNOWN[name]
    if name.startswith("reaction."):
        body, _, component = name.removeprefix("reaction.").rpartition(".")
        if body and component in ("x", "y"):
            return Output(name, "kN", f"reaction of '{body}' along {component}", Reaction(body, "xy".index(component)))
    msg = f"there is no output '{name}'"
    raise InputError(msg, hint=closest(name, [*KNOWN, "reaction.NAME.x", "reaction.NAME.y"]))


@dataclass(frozen=True)
class Returned:
    """Stands for a number that the study's own function returns: no model has it."""

    name: str

    def __call__(self, _: Analyses) -> float:
        """Raise: a model was returned where this number was announced."""
        msg = f"there is no output '{self.name}', and the function returned a model"
        raise InputError(msg, hint=closest(self.name, list(KNOWN)))


def outputs_of(wanted: Any, *, returned: bool = False) -> tuple[Output, ...]:
    """Return outputs from a name, a sequence of names and outputs, or a mapping of names to functions.

    Names that are not known are those of a function's own where it returns outputs (``returned``).

    Raises
    ------
    InputError
        A name is not known, or stands twice.
    """
    if isinstance(wanted, str | Output):
        wanted = [wanted]
    found: list[Output] = []
    if isinstance(wanted, Mapping):
        for name, function in wanted.items():
            if not callable(function):
                msg = f"output '{name}' is no function"
                raise InputError(msg, hint="give a function of the run's analyses, or the name of an output in a list")
            found.append(Output(str(name), "-", "by a function of the user's", Computed(str(name), function)))
    else:
        for o in wanted:
            if returned and isinstance(o, str) and o not in KNOWN and not o.startswith("reaction."):
                found.append(Output(o, "-", "returned by the study's function", Returned(o)))
            else:
                found.append(o if isinstance(o, Output) else find_output(str(o)))
    names = [o.name for o in found]
    if not names:
        msg = "a study needs outputs"
        raise InputError(msg, hint="for example outputs=['stands'], or one of " + ", ".join(KNOWN))
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        msg = f"the output '{twice}' stands twice"
        raise InputError(msg)
    return tuple(found)


def verdict_of(analyses: Analyses) -> tuple[str, str]:
    """Return the verdict of a run and its sentence: that of the load step where one was made."""
    if analyses.made("result"):
        status: Status = analyses.result.status
        return status.name.lower(), "" if status is Status.SOLVED else status.value
    return "done", ""
