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
from concio.errors import InputError
from concio.model.compose import place
from concio.model.model import Model, require_model
from concio.model.stages import ControlPoint

Array = np.ndarray
Told = TypeVar("Told", DynamicsResult, PushResult)

SAME = 1e-6
"""Corners nearer than this share of the size of a model are the same."""
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
        """Return a state as it is computed; with ``sign`` 1 one that was computed, where it is.

        Raises
        ------
        InputError
            It is of a motion of other bodies.
        """
        if state.described.size:
            self._same_bodies(state)
        if not self.origin.any() or state.centre.shape[1:] != self.origin.shape:
            return state
        return replace(state, centre=state.centre + sign * self.origin)

    def _same_bodies(self, state: MotionState) -> None:
        """Refuse a state of other bodies, or of bodies at other places: its own would stand at the places of those."""
        now, before = extents(self.described), state.described
        alike = before.shape == now.shape and before.dtype.kind == "f"
        apart = np.abs(now - before).max(axis=1) if alike else np.full(1, np.inf)
        if not (apart <= SAME * self.described.size).all():
            name = self.described.bodies[int(np.argmax(apart))].name
            which = f": block '{name}' has another shape or place" if alike else ""
            msg = f"the state to start from belongs to another model{which}"
            raise InputError(msg, hint="take the state of a motion of the same model")

    def told(self, found: Told, points: Sequence[ControlPoint], control: ControlPoint | None = None) -> Told:
        """Return what was computed, where the model was described.

        Parameters
        ----------
        found : DynamicsResult or PushResult
        points : sequence of ControlPoint
        control : ControlPoint, optional
            As they were asked for.
        """
        found = replace(found, end=replace(found.end, described=extents(self.described)))
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


def extents(model: Model) -> Array:
    """Return the least and the largest coordinates of the corners of each body (B, 2 d) [m]."""
    return np.array([[*b.vertices.min(axis=0), *b.vertices.max(axis=0)] for b in model.bodies], dtype=float)
