"""Outputs of a study: numbers of a model by name, each with the analysis it comes from, computed once a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from concio.arguments import closest
from concio.errors import InputError, NoEquilibriumError
from concio.problem.solution import PROVEN_FAILURES, Status
from concio.problem.tolerances import NO_REACTION
from concio.studies.analyses import Analyses

if TYPE_CHECKING:
    from concio.analysis.result import Result

NAN = float("nan")


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
               "bridge", _bridge_bound, "low", multiplies=True),
        Output("bridge_axle", "kN", "heaviest axle at that bound", _bridge_axle, "low", multiplies=True),
        Output("bridge_worst_position", "m", "worst position of the vehicle", _bridge_place, multiplies=True),
    )
}  # fmt: skip
"""Outputs by name; beside them ``reaction.NAME.x``, ``.y`` and, in space, ``.z`` of a fixed body or a support [kN]."""


@dataclass(frozen=True)
class Reaction:
    """Reads one component of the reaction of a fixed body or a support (a class, so that it travels to workers)."""

    body: str
    component: int

    def __call__(self, a: Analyses) -> float:
        """Return the force on the structure [kN]; zero where it is no more than rounding of the reactions."""
        if not _solved(a.result):
            return NAN
        reactions = a.result.reactions
        if self.body not in reactions:
            msg = f"there is no fixed body or support called '{self.body}'"
            raise InputError(msg, hint=closest(self.body, list(reactions)))
        force = reactions[self.body]
        if self.component >= len(force):
            msg = f"reaction.{self.body}.z: a plane model has no reaction along z"
            raise InputError(msg, hint=f"reaction.{self.body}.y is the vertical one")
        largest = max(abs(part) for one in reactions.values() for part in one)
        return force[self.component] if abs(force[self.component]) > NO_REACTION * largest else 0.0


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
        if body and component in ("x", "y", "z"):
            return Output(name, "kN", f"reaction of '{body}' along {component}", Reaction(body, "xyz".index(component)))
    msg = f"there is no output '{name}'"
    raise InputError(msg, hint=closest(name, [*KNOWN, "reaction.NAME.x", "reaction.NAME.y", "reaction.NAME.z"]))


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
