"""Outputs of a study: numbers of a model by name, each with the analysis it comes from, computed once a run."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from concio.arguments import closest
from concio.contact.factors import load_factor
from concio.errors import InputError, NoEquilibriumError
from concio.model.model import Model
from concio.problem.solution import PROVEN_FAILURES, Progress, Status
from concio.solvers.algebra.threads import one_thread

if TYPE_CHECKING:
    from concio.analysis.bridges.sweep import Standing
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
        Load factors of every analysis; a group that is not named has 1.
    live : tuple of str
        Load groups that limits and margins multiply from zero, whatever their factors.
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
    def multiplied(self) -> Model | Assembly:
        """What limits and margins are asked about: groups that are not multiplied act with their factors."""
        s = self.settings
        scaled = {g: f for g, f in s.factors.items() if g not in s.live and f != 1.0}
        return at_factors(self.model, scaled) if scaled else self.assembly

    @cached_property
    def limit(self) -> LimitResult:
        """The associated limit load, without the Coulomb path."""
        from concio.analysis.limit import limit

        return limit(self.multiplied, self.settings.live, path=False, search=False)

    @cached_property
    def coulomb(self) -> LimitResult:
        """The associated limit load and the Coulomb path."""
        from concio.analysis.limit import limit

        return limit(self.multiplied, self.settings.live, path=True, search=False, progress=self.progress)

    @cached_property
    def load_margin(self) -> Margin:
        """The largest factor of the live load that single steps were found to carry."""
        from concio.analysis.margins import load_margin

        return load_margin(self.multiplied, self.settings.live)

    @cached_property
    def friction_factor(self) -> float:
        """The smallest common factor of friction with which forces balance the loads of the load step."""
        from concio.solvers.statics.friction import smallest_friction

        with one_thread():
            return smallest_friction(self.assembly.problem(dict(self.settings.factors))).factor

    @cached_property
    def bridge(self) -> Standing | None:
        """The worst position of the vehicle of a bridge with its bound; None where nothing bounds its load."""
        from concio.analysis.bridges.sweep import Sweep, least, search
        from concio.solvers.statics.existence import find_mechanism

        sweep = Sweep(self.model)
        with one_thread():
            if find_mechanism(sweep.dead) is not None:
                msg = "the bridge does not stand without the vehicle"
                raise NoEquilibriumError(msg)
            found = least(search(sweep, worst=1, progress=self.progress), 1, 0.0)
        return found[0] if found else None

    @property
    def acting(self) -> dict[str, dict[str, Any]]:
        """Load groups with their forces at factor 1, where the model was assembled."""
        from concio.verdict.question import acting_groups

        if not self.made("assembly"):
            return {}
        return {a.group: {"what": a.what, "force": list(a.force), "size": a.size} for a in acting_groups(self.assembly)}

    @property
    def attention(self) -> tuple[str, ...]:
        """What is suspicious about the model, where it was assembled."""
        from concio.verdict.attention import attention

        return attention(self.assembly) if self.made("assembly") else ()

    @property
    def unseen(self) -> tuple[str, ...]:
        """Bodies too light for the certificates of what was computed, where that says that something holds."""
        from concio.verdict.unseen import unseen_bodies

        multiplied = any(self.made(name) for name in ("limit", "coulomb", "load_margin"))
        stepped = self.made("result") and self.result.solved
        at = [dict(self.settings.factors)] if stepped or multiplied else []
        if multiplied:
            at.append({**self.settings.factors, **dict.fromkeys(self.settings.live, 0.0)})
        return unseen_bodies(self.assembly, at) if at else ()

    def made(self, name: str) -> bool:
        """Return whether an analysis was asked for."""
        return name in self.__dict__


def at_factors(model: Model, factors: Mapping[str, float]) -> Model:
    """Return a model whose loads and moved supports are multiplied by the factors of their groups."""
    loads = tuple(
        replace(load, value=tuple(load_factor(factors, load.group) * v for v in load.value)) for load in model.loads
    )
    supports = tuple(
        replace(
            one,
            displacement=_times(factors[one.group], one.displacement),
            rotation=_times(factors[one.group], one.rotation),
        )
        if one.group in factors and one.moves
        else one
        for one in model.supports
    )
    return replace(model, loads=loads, supports=supports)


def _times(factor: float, value: Any) -> Any:
    return tuple(factor * v for v in value) if isinstance(value, tuple | list) else factor * value


def _stands(a: Analyses) -> float:
    if a.result.solved:
        return 1.0
    return 0.0 if a.result.status in PROVEN_FAILURES else NAN


@dataclass(frozen=True)
class OfSolved:
    """Reads a number of a certified equilibrium; ``nan`` where none was found (a class, so that it travels to workers).

    It raises :class:`concio.NoEquilibriumError` of a structure that is proven not to stand.
    """

    read: Callable[[Result], float]

    def __call__(self, a: Analyses) -> float:
        """Return the number."""
        return self.read(a.result) if _solved(a.result) else NAN


def _solved(result: Result) -> bool:
    """Tell whether a load step is certified; raise where it is proven that the structure does not stand."""
    if result.status in PROVEN_FAILURES:
        raise NoEquilibriumError(result.sentence)
    return result.solved


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
    end : {"low", "high", ""}
        Where a structure belongs that is proven not to stand, in the order of all runs: a multiplier is then less than
        any other ("low"), a settlement more ("high"); "" where it has no place.
    event : bool
        Whether it is 1 or 0 for yes or no, so that a share of the runs is a probability.
    multiplies : bool
        Whether it multiplies the live groups from zero, rather than let them act with their factors.
    """

    name: str
    unit: str
    meaning: str
    read: Callable[[Analyses], float]
    end: Literal["low", "high", ""] = ""
    event: bool = False
    multiplies: bool = False


def _associated(a: Analyses) -> float:
    return a.limit.associated.multiplier


def _path(a: Analyses) -> float:
    return a.coulomb.coulomb


def _carried(a: Analyses) -> float:
    return a.coulomb.carried


def _load_margin(a: Analyses) -> float:
    margin = a.load_margin
    if margin.fails == 0.0 and margin.outcome in PROVEN_FAILURES:
        msg = "the structure fails under its other loads, without the live groups"
        raise NoEquilibriumError(msg)
    return margin.holds


def _friction(a: Analyses) -> float:
    return a.friction_factor


def _bridge_bound(a: Analyses) -> float:
    return NAN if a.bridge is None else a.bridge.multiplier


def _bridge_axle(a: Analyses) -> float:
    vehicle = a.model.vehicle
    assert vehicle is not None
    return _bridge_bound(a) * vehicle.heaviest.load * vehicle.dynamic * vehicle.factor


def _bridge_place(a: Analyses) -> float:
    return NAN if a.bridge is None else a.bridge.position


KNOWN: dict[str, Output] = {
    o.name: o
    for o in (
        Output("stands", "-", "1 in certified equilibrium, 0 shown not to stand, nan undecided", _stands, event=True),
        Output("max_settlement", "m", "largest downward displacement", OfSolved(_settlement), "high"),
        Output("joint_motion", "m", "largest opening or slip of a joint", OfSolved(_motion), "high"),
        Output("associated_multiplier", "-", "upper bound of the multiplier of the live load: friction that dilates, "
               "at or above what Coulomb friction gives", _associated, "low", multiplies=True),
        Output("coulomb_multiplier", "-", "collapse multiplier of the Coulomb load path, where shown", _path, "low",
               multiplies=True),
        Output("coulomb_carried", "-", "largest multiplier met on the Coulomb load path", _carried, "low",
               multiplies=True),
        Output("load_margin", "-", "largest factor of the live load that a step was found to carry", _load_margin,
               "low", multiplies=True),
        Output("friction_factor", "-", "lower bound of the common factor of friction with which the structure stands: "
               "with less no forces balance the loads", _friction, "high"),
        Output("bridge_load_factor", "-", "upper bound of the load factor of a vehicle at its worst position on a "
               "bridge", _bridge_bound, "low"),
        Output("bridge_axle", "kN", "heaviest axle at that bound", _bridge_axle, "low"),
        Output("bridge_worst_position", "m", "worst position of the vehicle", _bridge_place),
    )
}  # fmt: skip
"""Outputs by name; beside them ``reaction.NAME.x`` and ``reaction.NAME.y`` of a fixed body or a support [kN]."""


@dataclass(frozen=True)
class Reaction:
    """Reads one component of the reaction of a fixed body or a support (a class, so that it travels to workers)."""

    body: str
    component: int

    def __call__(self, a: Analyses) -> float:
        """Return the force on the structure [kN]."""
        if not _solved(a.result):
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
        A name is not known, or is listed twice.
    """
    if isinstance(wanted, str | Output):
        wanted = [wanted]
    found: list[Output] = []
    if isinstance(wanted, Mapping):
        for name, function in wanted.items():
            if not callable(function):
                msg = f"output '{name}' is not a function"
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
        msg = f"the output '{twice}' is listed twice"
        raise InputError(msg)
    return tuple(found)


def verdict_of(analyses: Analyses) -> tuple[str, str]:
    """Return the verdict of a run and its sentence: that of the load step where one was made."""
    if analyses.made("result"):
        status: Status = analyses.result.status
        return status.name.lower(), "" if status is Status.SOLVED else status.value
    return "done", ""
