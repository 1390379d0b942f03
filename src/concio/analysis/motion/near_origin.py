"""Models far from the origin of coordinates: their motion is computed near it, and given where they are.

In national grids a coordinate has seven digits before the point, and doubles then leave 1e-9 m for places. Gaps of
hard joints at large displacements are smaller: a wall that was followed there ended in wrong curves, or found no
equilibrium at the start.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.push_result import PushResult
from concio.analysis.motion.state import MotionState
from concio.contact.points import check_point
from concio.contact.reference import Reference
from concio.model.compose import place
from concio.model.model import Model, require_model
from concio.model.stages import ControlPoint

Array = np.ndarray
Told = TypeVar("Told", DynamicsResult, PushResult)

FAR = 100.0
"""Times its own size by which a model is away from the origin where it is moved."""


@dataclass(frozen=True, eq=False)
class Near:
    """A model where it is computed.

    Parameters
    ----------
    described, model : Model
        Where it was described, and near the origin: the same where it is near anyway.
    origin : (d,) array
        From which places of ``model`` are measured [m].
    """

    described: Model
    model: Model
    origin: Array

    @classmethod
    def of(cls, model: Model) -> Near:
        """Return a model near the origin.

        Raises
        ------
        InputError, GeometryError
            As :meth:`concio.contact.reference.Reference.of`, with places as they were described.
        """
        require_model(model)
        corners = np.concatenate([b.vertices for b in model.bodies])
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        if float(np.abs(middle).max()) <= FAR * model.size:
            return cls(model, model, np.zeros(model.dim))
        Reference.of(model)
        return cls(model, place(model, (-middle).tolist()), middle)

    def point(self, point: ControlPoint) -> ControlPoint:
        """Return a point of the model that is computed."""
        if not self.origin.any():
            return point
        check_point(self.described, point, "point")
        return replace(point, at=tuple((np.array(point.at, dtype=float) - self.origin).tolist()))

    def points(self, points: Sequence[ControlPoint]) -> tuple[ControlPoint, ...]:
        """Return points of the model that is computed."""
        return tuple(self.point(p) for p in points)

    def state(self, state: MotionState, sign: float = -1.0) -> MotionState:
        """Return a state as it is computed; with ``sign`` 1 one that was computed, where it is."""
        if not self.origin.any() or state.centre.shape[1:] != self.origin.shape:
            return state
        return replace(state, centre=state.centre + sign * self.origin)

    def told(self, found: Told, points: Sequence[ControlPoint], control: ControlPoint | None = None) -> Told:
        """Return what was computed, where the model was described.

        Parameters
        ----------
        found : DynamicsResult or PushResult
        points : sequence of ControlPoint
        control : ControlPoint, optional
            As they were asked for.
        """
        if not self.origin.any():
            return found
        end, asked = self.state(found.end, 1.0), tuple(points)
        if isinstance(found, PushResult):
            events = tuple(replace(e, at=tuple((np.array(e.at) + self.origin).tolist())) for e in found.events)
            return replace(
                found, model=self.described, end=end, points=asked, control=control, events=events,
                centre=found.centre + self.origin,
            )  # fmt: skip
        shots = replace(found.shots, centre=found.shots.centre + self.origin)
        steps = replace(found.steps, point=found.steps.point + self.origin)
        return replace(found, model=self.described, end=end, points=asked, shots=shots, steps=steps)
