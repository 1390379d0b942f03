"""A load path as a curve: load parameter against the motion of a control point, with events placed on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.model.stages import ControlPoint
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.path_result import PathResult

Array = np.ndarray

SLIGHT = 1e-9
"""Components of a direction below this are rounding."""


@dataclass(frozen=True)
class CurveEvent:
    """An event of a path: load factor, motion of the control point [m], what happens, and at which joint."""

    parameter: float
    control: float
    kind: str
    where: str


@short_repr
@dataclass(frozen=True, eq=False)
class Curve:
    """A path as :func:`concio.plot.path_figure.plot_path` draws it.

    Parameters
    ----------
    control : (k,) array
        Motion of the control point [m].
    parameter : (k,) array
        Load factor of what changes in the stage (:meth:`concio.PathResult.load`).
    events : tuple of CurveEvent
    """

    control: Array
    parameter: Array
    events: tuple[CurveEvent, ...]


def path_curve(path: PathResult, point: ControlPoint, stage: int = -1) -> Curve:
    """Return one stage of a load path as a curve of a control point: load factor against its motion."""
    stage = stage % len(path.outcomes)
    control, _ = path.curve(point, stage)
    _, load = path.load(stage)
    everywhere, _ = path.curve(point)
    first = next(i for i, step in enumerate(path.steps) if step.stage == stage)
    skipped = len(load) - sum(step.stage == stage for step in path.steps)  # 1 where the stage begins at a step before
    events = tuple(
        CurveEvent(float(load[e.step - first + skipped]), float(everywhere[e.step]), e.kind, " | ".join(e.bodies))
        for e in path.events
        if e.stage == stage
    )
    return Curve(control, load, events)


def most_moving(path: PathResult) -> ControlPoint:
    """Return the point that moved most in the end, in the direction in which it moved."""
    end = path.result()
    best: tuple[float, ControlPoint] | None = None
    for b, body in enumerate(path.assembly.model.bodies):
        if body.kind == "fixed":
            continue
        motion = end.node_displacement(b)
        size = np.linalg.norm(motion, axis=1)
        k = int(size.argmax())
        if best is None or size[k] > best[0]:
            at, u = end.nodes(b)[k], motion[k] / size[k] if size[k] > 0 else np.eye(motion.shape[1])[-1]
            u = np.where(np.abs(u) > SLIGHT, u, 0.0)
            best = float(size[k]), ControlPoint(body.name, tuple(map(float, at)), tuple(map(float, u)))
    assert best is not None  # a model without free bodies is not assembled
    return best[1]
