"""Stages of a load path: which load factors are reached, or how far a control point moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from concio.arguments import strict, strict_class
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

    Examples
    --------
    A block falls once its centroid, the control point here, has moved by half its width:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid")
    >>> centroid = concio.ControlPoint("b01", at=(0.0, 1.0), direction=(1.0, 0.0))
    >>> round(float(concio.push(pillar, control=centroid).capacity), 3)
    0.25
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
        Steps of the stage where it is followed in steps.

    Examples
    --------
    The weight acts first. Then a horizontal share of it grows, until the pillar tips at width over height:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=1, block="rigid", horizontal=1.0)
    >>> stages = [concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 1.0})]
    >>> round(concio.run_path(pillar, stages).peak(), 6)
    0.25
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


@strict
def cycles(group: str, factor: float = 1.0, *, times: int = 1, back: float = 0.0, steps: int = 20) -> tuple[Stage, ...]:
    """Return the stages in which the factor of a load group comes and goes, such as the temperature of the seasons.

    What slips remembers it: after every cycle the structure may stand elsewhere than before.

    Parameters
    ----------
    group : str
    factor : float
        Of the group at the far end of every cycle.
    times : int
        How often it goes there and comes back.
    back : float
        Its factor at the near end.
    steps : int
        Of each of the two stages of a cycle, where they are followed in steps.

    Raises
    ------
    InputError
        There is no cycle, or no way between its two ends.

    Examples
    --------
    >>> import concio
    >>> [stage.factors["temperature"] for stage in concio.cycles("temperature", 25.0, times=2)]
    [25.0, 0.0, 25.0, 0.0]
    """
    if times < 1 or factor == back:
        msg = f"times = {times}, from {back:g} to {factor:g} and back, is not a cycle"
        raise InputError(msg, where=f"load group '{group}'", hint="give at least one cycle between two factors")
    ends = (("there", factor), ("back", back))
    return tuple(Stage(f"{group} {k} {way}", {group: f}, steps=steps) for k in range(1, times + 1) for way, f in ends)
