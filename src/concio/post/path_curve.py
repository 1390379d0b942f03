"""A load path as a curve: load parameter against the motion of a control point, with events placed on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from concio.analysis.path import ControlPoint, PathResult

Array = np.ndarray


@dataclass(frozen=True)
class CurveEvent:
    """An event of a path: load parameter, motion of the control point [m], what happens, and at which joint."""

    parameter: float
    control: float
    kind: str
    where: str


@dataclass(frozen=True, eq=False)
class Curve:
    """A path as :func:`concio.plot.path_figure.plot_path` draws it.

    Parameters
    ----------
    control : (k,) array
        Motion of the control point [m].
    parameter : (k,) array
        Load parameter.
    events : tuple of CurveEvent
    """

    control: Array
    parameter: Array
    events: tuple[CurveEvent, ...]


def path_curve(path: PathResult, point: ControlPoint, stage: int = -1) -> Curve:
    """Return one stage of a load path as a curve of a control point."""
    stage = stage % len(path.outcomes)
    control, parameter = path.curve(point, stage)
    everywhere, _ = path.curve(point)
    events = tuple(
        CurveEvent(e.parameter, float(everywhere[e.step]), e.kind, " | ".join(e.bodies))
        for e in path.events
        if e.stage == stage
    )
    return Curve(control, parameter, events)
