"""What pushing a structure over gives: its capacity curve, with placements, events and a certificate at every point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Any

import numpy as np

from concio.analysis.motion.joint_events import JointEvent
from concio.analysis.motion.state import MotionState
from concio.arguments import closest
from concio.contact.points import Followed
from concio.contact.reference import Configuration, Reference
from concio.errors import InputError
from concio.kinematics.placement import Placement
from concio.kinematics.spins import rotation_vector, turned_from
from concio.model.model import Model
from concio.model.stages import ControlPoint
from concio.problem.tolerances import CERTIFIED
from concio.read_only import read_only
from concio.verdict.push_verdict import push_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown

Array = np.ndarray


class PushEnding(Enum):
    """How pushing ended; what that says of the structure is stated by the verdict."""

    LOST = "the multiplier fell to the smallest one"
    REACHED = "the displacement or multiplier asked for was reached"
    NO_EQUILIBRIUM = "no equilibrium at a larger displacement could be followed"
    NO_LARGER_LOAD = "no equilibrium nearby at a larger multiplier: load control ends at the peak"
    LOCKED = "the structure locks: the multiplier grows without bound"
    STOPPED = "stopped on request"


@dataclass(frozen=True, eq=False)
@read_only
class PushResult(Shown):
    """A capacity curve of n points.

    Parameters
    ----------
    model : Model
    gravity : float
        [m/s2].
    ending : PushEnding
    displacement : (n,) array
        Controlled displacement, from the equilibrium at multiplier zero [m].
    multiplier : (n,) array
    residual : (n,) array
        Worst relative violation of any equation in the displaced structure: the certificate of each point.
    centre : (n, B, d) array
        Centroids of all bodies [m].
    rotation : (n, B) array in the plane, (n, B, 3, 3) in space
        Anticlockwise [rad]; rotation matrices in space.
    strain : (n, nodes, d) array
        Displacements of nodes of elastic bodies in the frames of their bodies [m].
    reaction : (n, r, d) array
        Force of each fixed body and support on the structure [kN].
    reactions_of : tuple of str
    events : tuple of JointEvent
    live : tuple of str
        Load groups that the multiplier scales; empty where it scales a share of the weights.
    direction : (d,) array
        Of that share.
    force : (d,) array
        Resultant of the loads at a multiplier of one, in the structure as described [kN].
    factors : mapping of str to float
    control : ControlPoint or None
    points : tuple of ControlPoint
        Points followed beside the control.
    notes : tuple of str
    seconds : float
    lent_compliance : float
        Compliance added to hard joints of rigid bodies [m/kN].
    end : MotionState
        State at the end.
    until : float or None
        Controlled displacement [m], or multiplier, that was asked for.
    by_load : bool
        Whether the load grew instead of a displacement.
    reversed : bool
        Whether the live groups grew with the opposite sign, to push to the side asked for.
    structures : tuple of tuples of int
        Bodies of each structure that stands apart from the others.
    """

    model: Model
    gravity: float
    ending: PushEnding
    displacement: Array
    multiplier: Array
    residual: Array
    centre: Array
    rotation: Array
    strain: Array
    reaction: Array
    reactions_of: tuple[str, ...]
    events: tuple[JointEvent, ...]
    live: tuple[str, ...]
    direction: Array
    force: Array
    factors: Mapping[str, float]
    control: ControlPoint | None
    points: tuple[ControlPoint, ...]
    notes: tuple[str, ...]
    seconds: float
    lent_compliance: float
    end: MotionState
    until: float | None = None
    by_load: bool = False
    reversed: bool = False
    structures: tuple[tuple[int, ...], ...] = ()

    def __len__(self) -> int:
        return len(self.multiplier)

    def __repr__(self) -> str:
        return (
            f"PushResult({len(self)} points, peak {self.peak:.6g} at {self.displacement[self.peak_step]:.4g} m, "
            f"ends at {self.displacement[-1]:.4g} m with {self.multiplier[-1]:.4g}; certificate {self.certificate:.1e})"
        )

    @property
    def peak_step(self) -> int:
        """Point with the largest multiplier."""
        return int(np.argmax(self.multiplier))

    @property
    def peak(self) -> float:
        """Largest multiplier."""
        return float(self.multiplier.max())

    @property
    def peak_passed(self) -> bool:
        """Whether the curve goes on below its largest multiplier: otherwise no peak was shown."""
        return self.peak_step < len(self) - 1

    @property
    def capacity(self) -> float:
        """Controlled displacement at which the strength is lost; nan where the curve does not get there [m]."""
        return float(self.displacement[-1]) if self.ending is PushEnding.LOST else float("nan")

    @property
    def certificate(self) -> float:
        """Worst relative residual of all points."""
        return float(self.residual.max(initial=0.0))

    @property
    def certified(self) -> bool:
        """Whether every point satisfies every equation of the displaced structure to 1e-9."""
        return self.certificate <= CERTIFIED

    @cached_property
    def reference(self) -> Reference:
        """What the bodies are made of."""
        return Reference.of(self.model, self.gravity)

    def configuration(self, step: int = -1) -> Configuration:
        """Return where the bodies stand at a point of the curve."""
        return Configuration(self.reference, Placement(self.centre[step], self.rotation[step]), self.strain[step])

    def point(self, which: int | ControlPoint = 0) -> Array:
        """Return the displacements of a followed point, or of any point of a body, along its direction (n,) [m].

        They count from where the structure was described.
        """
        if isinstance(which, ControlPoint):
            wanted = which
        elif -len(self.points) <= which < len(self.points):
            wanted = self.points[which]
        else:
            msg = f"there is no point number {which}"
            raise InputError(
                msg, hint="give a ControlPoint, or ask for points when pushing: points=(ControlPoint(...),)"
            )
        followed = Followed.of(self.reference, wanted)
        rows = zip(self.centre, self.rotation, self.strain, strict=True)
        return np.array([followed.displacement(c, r, s)[0] for c, r, s in rows])

    def mechanism(self, step: int) -> tuple[Array, Array]:
        """Return how the structure moves just before a point of the curve, for a unit of the control displacement.

        Returns
        -------
        velocity : (B, d) array
            Of the centroids; zero for bodies that stand.
        rotation : (B,) array in the plane, (B, 3) in space
            Anticlockwise; in space vectors [rad/m].
        """
        k = range(len(self))[step]
        if k == 0:
            k = 1
        grown = self.displacement[k] - self.displacement[k - 1]
        grown = grown if grown else 1.0
        turned = turned_from(self.rotation[k - 1], self.rotation[k])
        return (self.centre[k] - self.centre[k - 1]) / grown, turned / grown

    def rotation_of(self, body: str) -> Array:
        """Return the rotation of a body at every point, anticlockwise (n,), in space vectors (n, 3) [rad].

        Examples
        --------
        A block falls once its diagonal is upright:

        >>> import concio
        >>> import math
        >>> pushed = concio.push(concio.column(width=0.5, height=2.0, blocks=1, block="rigid"))
        >>> round(float(abs(pushed.rotation_of("b01")[-1])), 4), round(math.atan(0.25), 4)
        (0.245, 0.245)
        """
        names = [b.name for b in self.model.bodies]
        if body not in names:
            msg = f"there is no body called '{body}'"
            raise InputError(msg, hint=closest(body, names, otherwise="see the names with 'concio check'"))
        turned: Array = self.rotation[:, names.index(body)]
        return turned if self.model.dim == 2 else rotation_vector(turned)

    @cached_property
    def verdict(self) -> Verdict:
        """What the structure carries sideways, with the question and what proves the answer."""
        return push_verdict(self)

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``."""
        capacity = self.capacity
        return {
            "status": self.verdict.status,
            "sentence": self.verdict.sentence,
            "verdict": self.verdict.as_dict(),
            "title": self.model.title,
            "engine": self.model.engine,
            "points": len(self),
            "peak": {"multiplier": self.peak, "displacement": float(self.displacement[self.peak_step]),
                     "passed": self.peak_passed},
            "end": {"multiplier": float(self.multiplier[-1]), "displacement": float(self.displacement[-1])},
            "capacity": None if np.isnan(capacity) else capacity,
            "curve": {"displacement": self.displacement.tolist(), "multiplier": self.multiplier.tolist()},
            "scaled": list(self.live) or "weights",
            "events": [str(e) for e in self.events],
            "certificate": {"worst": self.certificate},
            "lent_compliance": self.lent_compliance,
            "notes": list(self.notes),
            "seconds": round(self.seconds, 3),
            "units": {"force": "kN", "length": "m", "angle": "rad"},
        }
