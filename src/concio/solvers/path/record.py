"""What a load path consists of: outcomes, events, and the exact polygon with its corners."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from itertools import pairwise

from concio.problem.contact_problem import Array
from concio.read_only import read_only
from concio.representation import short_repr
from concio.solvers.path.path_state import PathState


class Outcome(Enum):
    """How a path ended; the value is the sentence a user reads."""

    REACHED = "The end asked for was reached."
    LIMIT = (
        "The load grows no further: the structure moves at this load, or a mechanism proves that it carries no more, "
        "and no certified state was found beyond."
    )
    MECHANISM = "A mechanism has formed: the structure moves on without change of load and without further events."
    LOST = (
        "The path was lost: no certified state was found beyond this point, and that there is none was not shown. "
        "The structure carries at least this much."
    )
    BROKEN = "A tie has broken, and no equilibrium without it was found nearby."
    TOO_MANY = "There were more events than allowed."
    CANCELLED = "Stopped on request."


@short_repr
@dataclass(frozen=True)
class Event:
    """A change of state of one pair.

    Parameters
    ----------
    parameter : float
        Load parameter.
    control : float
        Displacement of the control point, or the parameter where there is none.
    pair : int
    kind : str
        "opens", "closes", "slips", "sticks", "crushes" or "recovers"; "jumps" where the structure snaps to a state a
        finite distance away, "restarts" where the path goes on from a finite step (named after the pair that moves
        most).
    direction : int
        Of the slip, +1 or -1; else 0.
    step : int
        Index of the state of the path at which it happens.
    """

    parameter: float
    control: float
    pair: int
    kind: str
    direction: int
    step: int


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class EventPath:
    """An exact path: its corners and its events.

    Parameters
    ----------
    states : tuple of PathState
        Start, every corner, end.
    events : tuple of Event
    outcome : Outcome
    direction : (N,) array
        Last rate of the displacements, scaled to largest entry 1: the mechanism where the path ended in one.
    factorisations : int
    """

    states: tuple[PathState, ...]
    events: tuple[Event, ...]
    outcome: Outcome
    direction: Array
    factorisations: int

    @property
    def peak(self) -> float:
        """Largest load parameter met."""
        return max(state.parameter for state in self.states)

    @property
    def jumps(self) -> tuple[Event, ...]:
        """The jumps, in order: each named after the pair that moves most in it."""
        return tuple(e for e in self.events if e.kind == "jumps")

    @property
    def end(self) -> PathState:
        """Last state."""
        return self.states[-1]

    def at(self, parameter: float) -> PathState:
        """Return the state at a value of the parameter on the first branch that meets it, by exact interpolation."""
        for a, b in pairwise(self.states):
            low, high = sorted((a.parameter, b.parameter))
            if low <= parameter <= high and high > low:
                share = (parameter - a.parameter) / (b.parameter - a.parameter)
                names = ("displacement", "normal_force", "friction_force", "slip", "offset")
                mixed = {name: (1 - share) * getattr(a, name) + share * getattr(b, name) for name in names}
                return replace(b, parameter=parameter, **mixed)
        msg = f"the path does not meet the parameter {parameter:g}"
        raise ValueError(msg)
