"""What has happened to the blocks of a motion: fallen, past their own equilibrium, at rest.

A block has fallen where it has turned by 60 degrees, or sunk by its width below where it stood: it lost its support.
It has passed its own equilibrium where everything that touches it carries it upwards and from one side of its centroid,
so that its weight turns it further the way it has turned already, and turns: without the ground moving, nothing brings
it back. At rest is what moves no more for a while
and is in equilibrium where it stands.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from concio.analysis.motion.holding_still import held_still, may_be_asked
from concio.analysis.motion.joints import SAG
from concio.analysis.motion.observer import Observer
from concio.analysis.motion.scheme import Scheme
from concio.analysis.motion.state import MotionState
from concio.analysis.motion.statics import Statics
from concio.contact.reference import Reference
from concio.fem.discretisation import FIXED
from concio.problem.contact_problem import Engine

Array = np.ndarray

OVERTURNED = np.deg2rad(60.0)
"""Rotation from where it was described at which a block has overturned [rad]."""

SUNK = 1.0
"""Depth below where it stood, over its mean width, from which on a block has lost its support."""

LEANS = 5e-3
"""Rotation from which on a block may have passed its own equilibrium [rad]."""

CALM = 1e-8
"""Kinetic energy over the weight times the width of the bodies below which nothing seems to move."""

WHILE = 0.1
"""How long nothing may seem to move before an equilibrium is looked for: what turns back is slow for an instant [s]."""

STILLER = 1e-2
"""Share of that energy below which forces within friction are asked for where no equilibrium near by was found."""

LONGER = 0.5
"""How long nothing may seem to move before they are: what begins to move away is slow for an instant, too [s]."""

NEAR = 1e-3
"""Distance of that equilibrium over the width of the bodies."""


def tilted(rotation: Array) -> Array:
    """Return the angles (B,) by which bodies have turned over, in space those of what was upright in them [rad]."""
    if rotation.ndim == 1:
        return np.asarray(np.abs(rotation))
    return np.asarray(np.arccos(np.clip(rotation[:, 2, 2], -1.0, 1.0)))


class Watch:
    """Looks at what happens to blocks.

    Parameters
    ----------
    observer : Observer
    factors : mapping of str to float
    scheme : Scheme
    origin : (B, d) array
        Where the centroids stood [m].
    engine : {"superlu", "pardiso"}, optional
    """

    def __init__(
        self, observer: Observer, factors: Mapping[str, float], scheme: Scheme, origin: Array, engine: Engine | None
    ) -> None:
        self.observer, self.factors, self.scheme, self.engine = observer, factors, scheme, engine
        self.reference: Reference = observer.reference
        self.origin = origin
        width, mass = observer.maker.width, float(self.reference.body_mass.sum())
        self.still = CALM * mass * self.reference.gravity * width
        self.calm_since: float | None = None
        self.stiller_since: float | None = None

    def overturned(self, state: MotionState) -> list[str]:
        """Return the blocks that have turned over, a phrase each."""
        free = self.reference.free
        turned = tilted(state.rotation)
        return [f"'{self._name(b)}' has turned by {np.rad2deg(turned[b]):.3g} degrees"
                for b in free[turned[free] > OVERTURNED].tolist()]  # fmt: skip

    def sunk(self, state: MotionState) -> list[str]:
        """Return the blocks that have lost their support, a phrase each."""
        free = self.reference.free
        depth = self.origin[:, -1] - state.centre[:, -1]
        lost = free[depth[free] > SUNK * self.reference.surface.width[free]]
        return [f"'{self._name(b)}' has sunk by {depth[b]:.3g} m below where it stood" for b in lost.tolist()]

    def lost(self, state: MotionState) -> list[str]:
        """Return the blocks that have fallen by more than the size of all that there is, a phrase each."""
        depth = self.origin[:, -1] - state.centre[:, -1]
        fixed = self.reference.disc.shape_of == FIXED
        ground = float(depth[fixed].max(initial=0.0))  # a base that moves
        free = self.reference.free
        below = free[depth[free] - ground > self.reference.disc.size]
        return [f"'{self._name(b)}' has fallen by {depth[b]:.3g} m, below everything in the model"
                for b in below.tolist()]  # fmt: skip

    def passed(self, state: MotionState) -> list[str]:
        """Return the blocks that have passed their own equilibrium, a phrase each, in the layout of the last step.

        In space none are named: a block that leans may roll on over its next corner and come to rest.
        """
        slots, force = self.observer.maker.slots, state.memory.force
        if state.memory.key is not slots.key or self.reference.disc.dim == 3:
            return []
        rows = self.observer.rows(state)
        found = []
        for b in self.reference.free.tolist():
            mine = ((slots.body_a == b) | (slots.body_b == b)) & (force[:, 0] > 0)
            if abs(state.rotation[b]) < LEANS or not mine.any():
                continue
            sign = np.where(slots.body_b[mine] == b, 1.0, -1.0)
            n, t = rows.normal[mine], force[mine]
            upward = sign * (t[:, 0] * n[:, 1] + t[:, 1] * n[:, 0])
            arm = state.centre[b, 0] - rows.point[mine, 0]
            further = (arm * state.rotation[b] < 0).all() and state.rotation[b] * state.spin[b] > 0
            if (upward > 0).all() and further:
                angle = np.rad2deg(abs(state.rotation[b]))
                found.append(f"'{self._name(b)}' leans beyond its own equilibrium, at {angle:.3g} degrees, and goes on")
        return found

    def calm(self, state: MotionState) -> bool:
        """Return whether nothing has seemed to move for a while; to be asked after every step."""
        f = self.observer.frames
        x = f.unknowns(state.velocity, state.spin, state.nodal, state.placement.turns)
        moving = f.kinetic_energy(x)
        if moving > STILLER * self.still:
            self.stiller_since = None
        elif self.stiller_since is None:
            self.stiller_since = state.time
        if moving > self.still:
            self.calm_since = None
        elif self.calm_since is None:
            self.calm_since = state.time
        return self.calm_since is not None and state.time - self.calm_since >= WHILE

    def rests(self, state: MotionState) -> bool:
        """Return whether there is an equilibrium where the bodies stand; what only seemed calm has to wait again."""
        statics = Statics(self.reference, self.scheme, self.factors, engine=self.engine, sag=SAG)
        still = replace(
            state, velocity=np.zeros_like(state.velocity), spin=np.zeros_like(state.spin),
            nodal=np.zeros_like(state.nodal),
        )  # fmt: skip
        found = statics.balance(still, 0.0)
        near = float(np.abs(found.moved).max(initial=0.0)) <= NEAR * self.observer.maker.width
        rests = (found.found and near) or self._held(statics, still)
        if not rests:
            self.calm_since = None
        return rests

    def _held(self, statics: Statics, still: MotionState) -> bool:
        """Return whether blocks that have long been still are held by forces within friction where they stand."""
        if self.stiller_since is None or still.time - self.stiller_since < LONGER or not may_be_asked(statics):
            return False
        return held_still(statics, statics.certificate, still)

    def _name(self, b: int) -> str:
        return self.reference.model.bodies[b].name
