"""A structure is let go at rest, with its masses, and followed: where one load step stays undecided."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.entry_point import entry_point
from concio.analysis.motion.dynamics import dynamics
from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.state import MotionState
from concio.arguments import strict
from concio.contact.reference import Reference
from concio.errors import InputError
from concio.fem.discretisation import FIXED
from concio.kinematics.spins import turned_by
from concio.problem.limits_of_work import LEAST_LET_GO, LET_GO_WORK, MOST_LET_GO
from concio.problem.solution import Progress, ProgressCallback
from concio.units import GRAVITY
from concio.verdict.let_go_verdict import let_go_verdict
from concio.verdict.verdict import Verdict
from concio.views import Shown

if TYPE_CHECKING:
    from concio.analysis.result import Result
    from concio.model.model import Model

LONG = 20.0
"""Longest time it is followed, over that in which a body falls by half the size of the structure."""

FINE = 0.01
"""Step of the time in which a body falls by half the mean width of the bodies."""

FADES = 1.0
"""Theta of the scheme: vibrations of elastic blocks and joints fade, which nothing else would take away."""

FADING = 0.1
"""Stiffness damping of joints with a stiffness and of ties, over the time in which a body falls by half its width.

Blocks that rock on mortar go back and forth slowly enough for the scheme to take next to nothing: seconds, for walls
of a metre. Where nothing moves damping carries nothing, so it changes no place of rest that is certified."""


@dataclass(frozen=True, eq=False)
class LetGo(Shown):
    """A load step, and what the structure did when it was let go.

    Parameters
    ----------
    step : Result
        Of the load step.
    motion : DynamicsResult
        From rest, as described.
    worked : bool
        Whether the motion ended because it had taken as many steps as are spent on it.
    """

    step: Result
    motion: DynamicsResult
    worked: bool

    @cached_property
    def moved(self) -> tuple[str, float, float]:
        """The body that moved furthest beside its width, how far any of it moved at most, and that width [m]."""
        reference, end = self.motion.reference, self.motion.end
        width, reach = reference.surface.width, _reach(self.motion.model, reference.disc.centroids)
        far = np.linalg.norm(end.centre - reference.disc.centroids, axis=1) + turned_by(end.rotation) * reach
        far[reference.disc.shape_of == FIXED] = -1.0
        b = int(np.argmax(far / np.where(width > 0, width, 1.0)))
        return self.motion.model.bodies[b].name, float(far[b]), float(width[b])

    @property
    def fades(self) -> bool:
        """Whether vibrations fade in the motion by what the scheme, or damping of joints and ties, takes away."""
        return bool(self.motion.reference.meshed.size or self.motion.scheme.stiffness_damping)

    @property
    def hard(self) -> bool:
        """Whether any joint has no stiffness of its own."""
        laws = self.motion.reference.laws
        return not bool((laws.normal[: len(self.motion.model.laws)] > 0).all())

    @property
    def speed(self) -> float:
        """Largest speed of the centroid of a body at the end [m/s]."""
        return float(np.linalg.norm(self.motion.end.velocity, axis=1).max(initial=0.0))

    @property
    def sunk(self) -> float:
        """How far hard joints of rigid bodies have given way at the end at most [m]."""
        force = self.motion.end.memory.force
        return float(self.motion.lent_compliance * force[:, 0].max(initial=0.0))

    @cached_property
    def verdict(self) -> Verdict:
        """Whether it comes to rest or moves away, with the question and what shows it."""
        return let_go_verdict(self)

    def summary(self) -> dict[str, Any]:
        """Return the numbers of ``--json``: those of the load step, with the verdict and the motion."""
        name, far, width = self.moved
        return {
            **self.step.summary(),
            "status": self.verdict.status,
            "sentence": self.verdict.sentence,
            "verdict": self.verdict.as_dict(),
            "let_go": {
                **self.motion.summary(), "verdict": self.motion.verdict.as_dict(), "speed": self.speed,
                "moved_most": {"body": name, "distance": far, "width": width},
            },
        }  # fmt: skip


@strict
@entry_point
def let_go(
    result: Result,
    duration: float | None = None,
    step: float | None = None,
    *,
    gravity: float = GRAVITY,
    progress: ProgressCallback | None = None,
) -> LetGo:
    """Let a structure go at rest, with its masses, and follow it until it rests, falls, or enough was spent on it.

    Meant for a load step that stays undecided near its limit. The motion is that of :func:`concio.dynamics` at large
    displacements, from the bodies as described, with every step certified. Blocks may be elastic, joints may have a
    stiffness, and ties may hold blocks: what vibrates in them fades. Where it ends at rest, an equilibrium was
    certified where the bodies stand. Where it moves away, that is what was seen of one motion and no proof that no
    equilibrium exists.

    Parameters
    ----------
    result : Result
        A load step, decided or not; its loads act with its factors.
    duration : float, optional
        Longest time it is followed [s]; by default as long as a body falls by two hundred times the size of the
        structure.
    step : float, optional
        Largest time step [s]; by default a hundredth of the time in which a body falls by half of its width.
    gravity : float
        Turns weights into masses [m/s2].
    progress : callable, optional
        Called after every step; true stops the motion, and what was computed is kept.

    Returns
    -------
    LetGo

    Raises
    ------
    InputError
        The model cannot be moved, see :func:`concio.dynamics`; or its supports are moved, where there is no place
        from which it could be let go.

    Examples
    --------
    A block that stands:

    >>> import concio
    >>> pillar = concio.column(width=0.5, height=1.0, blocks=1, block="rigid")
    >>> found = concio.let_go(concio.solve(pillar))
    >>> found.verdict.outcome.name
    'HOLDS'
    """
    model = result.model
    for support in model.supports:
        if support.moves:
            msg = f"support '{support.name or support.body}' is moved: there is no place at rest to let the bodies go"
            raise InputError(msg, hint="ask for the equilibrium from where supports have moved with 'concio shake'")
    reference = Reference.of(model, gravity)
    width = float(np.median(reference.surface.width[reference.free]))
    corners = np.concatenate([model.bodies[b].vertices for b in reference.free.tolist()])
    size = float((corners.max(axis=0) - corners.min(axis=0)).max())
    long = LONG * float(np.sqrt(size / gravity)) if duration is None else duration
    fine = FINE * float(np.sqrt(width / gravity)) if step is None else step
    sprung = bool(reference.laws.normal.any() or reference.laws.tangential.any() or model.ties)
    fades = FADING * float(np.sqrt(width / gravity)) if sprung else 0.0
    many = reference.disc.unknowns + len(result.assembly.pairs)
    most = int(np.clip(LET_GO_WORK // many, LEAST_LET_GO, MOST_LET_GO))
    worked = False

    def enough(state: Progress) -> bool:
        nonlocal worked
        worked = state.iteration >= most
        return worked or (progress is not None and bool(progress(state)))

    motion = dynamics(
        model, None, long, fine, factors=dict(result.factors), gravity=gravity, theta=FADES,
        stiffness_damping=fades, start=MotionState.at_rest(reference), stop_overturned=True, stop_at_rest=True,
        progress=enough,
    )  # fmt: skip
    return LetGo(result, motion, worked)


def _reach(model: Model, centroids: np.ndarray) -> np.ndarray:
    """Return how far corners of bodies are from their centroids at most (B,) [m]."""
    bodies = zip(model.bodies, centroids, strict=True)
    return np.array([np.linalg.norm(body.vertices - centre, axis=1).max() for body, centre in bodies])
