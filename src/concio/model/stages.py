"""Stages of a load path: which load factors are reached, or how far a control point moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from concio.arguments import strict_class
from concio.errors import InputError
from concio.model.limits import LARGEST_STEPS


@strict_class
@dataclass(frozen=True)
class ControlPoint:
    """A point whose displacement is controlled or plotted.

    Parameters
    ----------
    body : str
        Name of the body.
    at : (x, y) or (x, y, z)
        Position; the nearest node of an elastic body is taken [m].
    direction : (x, y) or (x, y, z)
        Direction in which the displacement is measured; scaled to length one.
    """

    body: str
    at: tuple[float, ...]
    direction: tuple[float, ...] = (1.0, 0.0)


@strict_class
@dataclass(frozen=True)
class Stage:
    """One stage of loading.

    Parameters
    ----------
    name : str
    factors : mapping of str to float
        Load factors at the end of the stage; groups not named stay as they are.
    control : ControlPoint, optional
        Go on until this point has moved by ``until`` in the stage, whatever the load does; without it, the load goes
        to its end.
    until : float
        Displacement of the control point [m].
    steps : int
        Steps of the stage where it is walked in steps.
    """

    name: str
    factors: Mapping[str, float]
    control: ControlPoint | None = None
    until: float = 0.0
    steps: int = 20

    def __post_init__(self) -> None:
        if isinstance(self.steps, bool) or not isinstance(self.steps, int) or not 1 <= self.steps <= LARGEST_STEPS:
            msg = f"steps = {self.steps!r} must be a whole number from 1 to {LARGEST_STEPS:,}"
            raise InputError(msg, where=f"stage '{self.name}'")
