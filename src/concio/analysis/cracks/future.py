"""Whether the structure stands where a cause has brought it, and how far the motion may go on.

In the plane the motion is followed at large displacements, where the bodies stand (:func:`concio.push` begins so): the
supports move in parts, each to an equilibrium that is certified there, until none follows. In space only the settlement
path at small displacements is continued, which does not see that a structure that has moved far carries less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.analysis.cracks.cause import Cause
from concio.analysis.cracks.forward import Forward
from concio.analysis.cracks.measurement import Candidate
from concio.analysis.cracks.moved import cause_model
from concio.analysis.motion.near_origin import Near
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.start_on_moved_supports import begun
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Statics
from concio.contact.reference import Reference
from concio.errors import ConcioError
from concio.kinematics.rigid import swept
from concio.units import GRAVITY

Array = np.ndarray

CENTIMETRE = 0.01
"""How much further a motion is followed to say what comes next [m]."""
FURTHER = 5.0
"""Times the motion that was found up to which it is followed to its limit."""
GROUP = "the motion that goes on"


@dataclass(frozen=True, eq=False)
class Future:
    """What happens to a structure whose supports go on moving as a cause says.

    Parameters
    ----------
    large : bool
        Whether it was followed at large displacements.
    size : float
        How far the cause has moved its supports so far: the largest displacement of their bodies [m].
    stands : bool
        Whether an equilibrium was found where the cause has brought the structure.
    followed : float
        Times the motion so far up to which equilibria were followed.
    limit : float
        Times the motion so far beyond which none was found; inf where all were found that were looked for.
    asked : float
        Times the motion so far that were examined.
    residual : float
        Worst relative violation of the equations in the last state that was found; nan where none was.
    another : float
        Times the motion so far that another centimetre makes.
    opening : float
        Largest opening of a joint after another centimetre, at small displacements [m]; nan where not reached.
    opening_now : float
        Largest opening now [m].
    """

    large: bool
    size: float
    stands: bool
    followed: float
    limit: float
    asked: float
    residual: float
    another: float
    opening: float
    opening_now: float

    @property
    def began(self) -> bool:
        """Whether any equilibrium was found there, as described if not with the motion."""
        return not np.isnan(self.residual)

    @property
    def stands_another(self) -> bool:
        """Whether an equilibrium was found another centimetre on."""
        return self.followed >= self.another * (1 - 1e-9)

    @property
    def left(self) -> float:
        """How much further it can go until no equilibrium was found [m]."""
        return (self.limit - 1.0) * self.size


def future_of(forward: Forward, cause: Cause, candidates: Sequence[Candidate], *, large: bool = True) -> Future | None:
    """Return what happens to a structure whose supports go on moving; None where no support moves.

    Parameters
    ----------
    forward : Forward
    cause : Cause
    candidates : sequence of Candidate
    large : bool
        Whether to follow it at large displacements, in the plane.
    """
    size = _size(forward, cause, candidates)
    if not size > 0:
        return None
    another = 1.0 + CENTIMETRE / size
    asked = max(FURTHER, another)
    on = forward.predict(another * cause.motions)
    openings = [float(c.gap[c.pairs.interface >= 0].max(initial=0.0)) if ok else np.nan
                for ok, c in ((True, cause.result.contacts), (on.reached, on.path.result(-1).contacts))]  # fmt: skip
    if not (large and forward.assembly.model.dim == 2 and not forward.assembly.model.temperatures):
        return Future(False, size, cause.prediction.reached, another if on.reached else 1.0,
                      np.inf if on.reached else another, another, max(cause.certificate, on.path.certificate),
                      another, openings[1], openings[0])  # fmt: skip
    followed, residual = _followed(forward, cause, candidates, asked)
    return Future(True, size, followed >= 1.0 - 1e-9, followed, np.inf if followed >= asked * (1 - 1e-9) else followed,
                  asked, residual, another, openings[1], openings[0])  # fmt: skip


def _followed(forward: Forward, cause: Cause, candidates: Sequence[Candidate], asked: float) -> tuple[float, float]:
    """Return how many times the motion has equilibria at large displacements, and the worst residual of the last."""
    model = cause_model(forward.moved, candidates, cause.motions, GROUP)
    factors = {g: f for g, f in forward.moved.factors(cause.motions).items() if g in model.load_groups}
    factors = {**dict.fromkeys(model.load_groups, 0.0), **factors, GROUP: asked}
    try:
        reference = Reference.of(Near.of(model).model, GRAVITY)
        statics = Statics(reference, Scheme(brittle=True), factors)
        found, share, last = begun(statics, MotionState.at_rest(reference))
    except ConcioError:
        return 0.0, np.nan
    return (share if not found.found else 1.0) * asked, float(last.residual) if last.found else np.nan


def _size(forward: Forward, cause: Cause, candidates: Sequence[Candidate]) -> float:
    """Return the largest displacement that a cause gives a corner of a body that it moves [m]."""
    model = cause_model(forward.moved, candidates, cause.motions, GROUP)
    largest = 0.0
    bodies = {b.name: b for b in model.bodies}
    total: dict[str, Array] = {}
    for s in model.supports:
        if s.group != GROUP:
            continue
        body = bodies[s.body]
        arm = body.vertices - np.asarray(body.centroid)
        moved = np.asarray(s.displacement) + swept(np.asarray(s.rotation, dtype=float), arm)
        total[s.body] = total.get(s.body, 0.0) + moved
    for moved in total.values():
        largest = max(largest, float(np.linalg.norm(moved, axis=1).max()))
    return largest


