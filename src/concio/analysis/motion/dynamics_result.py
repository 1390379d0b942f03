"""What a computed motion is: an immutable value with histories, energies and the state it ended in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Any

import numpy as np

from concio.analysis.motion.energy import EnergyBalance
from concio.analysis.motion.history import Shots, Steps
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import Memory, MotionState
from concio.contact.moving.reference import Configuration, Reference
from concio.errors import InputError
from concio.kinematics.placement import Placement
from concio.model.model import Model
from concio.model.stages import ControlPoint
from concio.problem.tolerances import CERTIFIED

Array = np.ndarray


class Ending(Enum):
    """How a motion ended; the value is the sentence a user reads."""

    COMPLETE = "Computed to its end."
    OVERTURNED = "A block overturned: it has turned by more than 60 degrees."
    AT_REST = "Everything came to rest."
    STOPPED = "Stopped on request; what was computed is kept."
    UNSOLVED = "A step could not be solved, however small: the motion ends before it."


@dataclass(frozen=True, eq=False)
class DynamicsResult:
    """A motion.

    Parameters
    ----------
    model : Model
    gravity : float
        [m/s2].
    scheme : Scheme
    factors : mapping of str to float
    ending : Ending
    shots : Shots
        Placements at some times.
    steps : Steps
        Points, reactions, residuals at every step.
    energy : EnergyBalance
        At the times of the shots.
    points : tuple of ControlPoint
        Whose positions ``steps.point`` holds.
    reactions_of : tuple of str
        Fixed bodies and supports whose forces ``steps.reaction`` holds.
    joints : tuple of (str, str)
        Bodies of the joints whose motions ``shots`` holds.
    end : MotionState
        State at the end, from which another motion can start.
    ground_time, ground : (k,), (k, 2) arrays
        Acceleration of the ground [m/s2].
    notes : tuple of str
    seconds : float
        Time it took [s].
    lent_compliance : float
        Compliance lent to hard joints of rigid bodies [m/kN].
    """

    model: Model
    gravity: float
    scheme: Scheme
    factors: Mapping[str, float]
    ending: Ending
    shots: Shots
    steps: Steps
    energy: EnergyBalance
    points: tuple[ControlPoint, ...]
    reactions_of: tuple[str, ...]
    joints: tuple[tuple[str, str], ...]
    end: MotionState
    ground_time: Array
    ground: Array
    notes: tuple[str, ...]
    seconds: float
    lent_compliance: float

    @property
    def complete(self) -> bool:
        """Whether the motion was computed to where it was meant to end."""
        return self.ending in (Ending.COMPLETE, Ending.AT_REST, Ending.OVERTURNED)

    @property
    def certificate(self) -> float:
        """Worst relative residual of all steps."""
        return float(self.steps.residual.max(initial=0.0))

    @property
    def certified(self) -> bool:
        """Whether every step satisfies every equation to 1e-9."""
        return self.certificate <= CERTIFIED

    @cached_property
    def reference(self) -> Reference:
        """What the bodies are made of."""
        return Reference.of(self.model, self.gravity)

    def configuration(self, shot: int = -1) -> Configuration:
        """Return where the bodies stand in one of the shots."""
        s = self.shots
        return Configuration(self.reference, Placement(s.centre[shot], s.rotation[shot]), s.strain[shot])

    def point(self, k: int = 0) -> Array:
        """Return the displacement of a point along its direction at every step (k,) [m]."""
        if not -len(self.points) <= k < len(self.points):
            msg = f"there is no point number {k}"
            raise InputError(msg, hint="ask for points when the motion is computed: points=(ControlPoint(...),)")
        wanted = self.points[k]
        direction = np.array(wanted.direction, dtype=float)
        along = direction / np.linalg.norm(direction)
        moved: Array = (self.steps.point[:, k] - np.array(wanted.at)) @ along
        return moved

    def rotation(self, body: str) -> Array:
        """Return the rotation of a body at the times of the shots, anticlockwise [rad]."""
        names = [b.name for b in self.model.bodies]
        if body not in names:
            msg = f"there is no body called '{body}'"
            raise InputError(msg, hint="see the names with 'concio check'")
        turned: Array = self.shots.rotation[:, names.index(body)]
        return turned

    @property
    def largest_rotation(self) -> tuple[str, float]:
        """The body that turned most, and by how much [rad]."""
        turned = np.abs(self.shots.rotation - self.shots.rotation[0]).max(0)
        b = int(np.argmax(turned))
        return self.model.bodies[b].name, float(turned[b])

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        body, turned = self.largest_rotation
        joint = np.abs(self.shots.slip).max(0) if self.joints else np.zeros(0)
        opening = self.shots.opening.max(0) if self.joints else np.zeros(0)
        return {
            "status": self.ending.name.lower(),
            "sentence": self.ending.value,
            "title": self.model.title,
            "time": float(self.end.time),
            "steps": len(self.steps),
            "solved_by": self.steps.shares(),
            "engine": self.model.engine,
            "certificate": {"worst": self.certificate},
            "energy_error": self.energy.error,
            "drift": float(self.steps.depth.max(initial=0.0)),
            "largest_rotation": {"body": body, "angle": turned},
            "largest_opening": float(opening.max(initial=0.0)),
            "largest_slip": float(joint.max(initial=0.0)),
            "lent_compliance": self.lent_compliance,
            "notes": list(self.notes),
            "seconds": round(self.seconds, 3),
            "units": {"force": "kN", "length": "m", "time": "s", "angle": "rad"},
        }


__all__ = ["DynamicsResult", "Ending", "Memory"]
