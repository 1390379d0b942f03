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
from concio.contact.points import direction_of
from concio.contact.reference import Configuration, Reference
from concio.errors import InputError
from concio.kinematics.placement import Placement
from concio.kinematics.spins import rotation_vector, turned_by
from concio.model.model import Model
from concio.model.stages import ControlPoint
from concio.problem.tolerances import CERTIFIED
from concio.read_only import read_only
from concio.verdict.dynamics_verdict import dynamics_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown

Array = np.ndarray


class Ending(Enum):
    """How a computation ended; what that says of the structure is stated by the verdict."""

    COMPLETE = "the time to compute is over"
    OVERTURNED = "a block has turned by more than 60 degrees"
    FALLEN = "a block has lost the support on which it stood"
    AT_REST = "nothing moves any more"
    STOPPED = "stopped on request"
    UNSOLVED = "no step, however small, satisfies its equations"


@dataclass(frozen=True, eq=False)
@read_only
class DynamicsResult(Shown):
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
    ground_time, ground : (k,), (k, d) arrays
        Acceleration of the ground [m/s2].
    notes : tuple of str
    seconds : float
        Time it took [s].
    lent_compliance : float
        Compliance added to hard joints of rigid bodies [m/kN].
    asked : str
        What moves the ground, in words.
    begun, ground_ends : float
        When the motion begins, and when that of the ground ends [s].
    stated : float or None
        Duration that was asked for; None where the motion was followed until rest or a fall [s].
    stands : bool or None
        Whether an equilibrium was found at the start; None where none was asked for.
    refuted : str
        What proves that there is no equilibrium under the loads at the start; empty where nothing does.
    fallen : tuple of str
        Blocks that have fallen or passed their own equilibrium, a phrase each.
    rests : bool
        Whether nothing moves in the end, and an equilibrium was found there.
    structures : tuple of tuples of int
        Bodies of each structure that stood apart from the others to the end: each moved by itself.
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
    asked: str = ""
    begun: float = 0.0
    ground_ends: float = 0.0
    stated: float | None = None
    stands: bool | None = None
    refuted: str = ""
    fallen: tuple[str, ...] = ()
    rests: bool = False
    structures: tuple[tuple[int, ...], ...] = ()

    @property
    def complete(self) -> bool:
        """Whether the motion was computed to where it was meant to end."""
        return self.ending not in (Ending.STOPPED, Ending.UNSOLVED)

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
        moved: Array = (self.steps.point[:, k] - np.array(wanted.at)) @ direction_of(wanted, self.model.dim)
        return moved

    def rotation(self, body: str) -> Array:
        """Return the rotation of a body at the times of the shots [rad].

        Anticlockwise in the plane (n,); in space rotation vectors (n, 3), of a length up to pi.
        """
        names = [b.name for b in self.model.bodies]
        if body not in names:
            msg = f"there is no body called '{body}'"
            raise InputError(msg, hint="see the names with 'concio check'")
        turned: Array = self.shots.rotation[:, names.index(body)]
        return turned if self.model.dim == 2 else rotation_vector(turned)

    @property
    def turned(self) -> Array:
        """By how much bodies have turned from where they were described, at the times of the shots (n, B) [rad]."""
        return np.stack([turned_by(rotation) for rotation in self.shots.rotation])

    @property
    def largest_rotation(self) -> tuple[str, float]:
        """The body that turned most from where it was described, and by how much [rad]."""
        turned = self.turned.max(axis=0)
        turned[[body.kind == "fixed" for body in self.model.bodies]] = -1.0
        b = int(np.argmax(turned))
        return self.model.bodies[b].name, float(turned[b])

    @property
    def ground_peak(self) -> float:
        """Largest acceleration of the ground at any step [m/s2]."""
        return float(np.linalg.norm(self.ground, axis=1).max(initial=0.0))

    @cached_property
    def verdict(self) -> Verdict:
        """Whether the structure stands the motion, with the question and what proves the answer."""
        return dynamics_verdict(self)

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        body, turned = self.largest_rotation
        joint = np.abs(self.shots.slip).max(0) if self.joints else np.zeros(0)
        opening = self.shots.opening.max(0) if self.joints else np.zeros(0)
        return {
            "status": self.verdict.status,
            "sentence": self.verdict.sentence,
            "verdict": self.verdict.as_dict(),
            "title": self.model.title,
            "ground_peak": self.ground_peak,
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
