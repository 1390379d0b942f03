"""How long a step may be where bodies move fast: none passes another one, or turns far, between two looks.

Contacts are looked for in the middle of a step, among what is within a skin. A body that moves further in a step than
it is thick could pass through another one and no equation of the step would know. So where bodies may come near each
other in a step, it ends before they have come closer by more than their distance and the skin, or half of the
thinner one.
"""

from __future__ import annotations

import numpy as np

from concio.analysis.motion.state import MotionState
from concio.contact.reference import Reference
from concio.display import number
from concio.fem.discretisation import FIXED
from concio.kinematics.frames import norm
from concio.kinematics.rigid import swept
from concio.verdict.dynamics_verdict import outran

Array = np.ndarray

TURN = 0.5
"""Rotation of a body in a step at most [rad]."""

THIN = 0.5
"""Share of the width of the thinner of two bodies by which they may come closer in a step than they are."""


class Pace:
    """Bounds the steps of a reference.

    Parameters
    ----------
    reference : Reference
    skin : float
        Distance within which contacts are found [m].
    """

    def __init__(self, reference: Reference, skin: float) -> None:
        self.reference, self.surface, self.skin = reference, reference.surface, skin
        arm = norm(self.surface.start)
        self.radius = np.zeros(len(reference.model.bodies))
        np.maximum.at(self.radius, self.surface.body, arm)
        self.fixed = reference.disc.shape_of == FIXED
        self.reach = np.minimum(skin, THIN * self.surface.width)

    def longest(self, state: MotionState, h: float) -> float:
        """Return the length of the longest step up to h in which nothing is passed unseen [s]."""
        spin = np.abs(state.spin) if state.spin.ndim == 1 else norm(state.spin)
        fastest = float(spin.max(initial=0.0))
        if h * fastest > TURN:
            h = TURN / fastest
        speed = norm(state.velocity) + spin * self.radius
        if 2.0 * h * float(speed.max(initial=0.0)) <= float(self.reach.min()):
            return h
        return min(h, self._until(state, h, speed, spin, 1.0))

    def _until(self, state: MotionState, h: float, speed: Array, spin: Array, share: float) -> float:
        """Return the time until bodies have come closer by a share of their distance and by what is allowed beyond."""
        low, high = self._boxes(state)
        until = np.inf
        fast = np.flatnonzero((2.0 * h * speed > self.skin) | (2.0 * h * float(speed.max()) > self.reach))
        for b in fast.tolist():
            apart = np.maximum(low - high[b], low[b] - high).max(axis=1)
            closing = norm(state.velocity - state.velocity[b]) + spin * self.radius + spin[b] * self.radius[b]
            seen = state.velocity - state.velocity[b] - swept(state.spin[b], state.centre - state.centre[b])
            other = state.spin - state.spin[b]
            turning = np.abs(other) if other.ndim == 1 else norm(other)
            closing = np.minimum(closing, norm(seen) + turning * self.radius)  # seen from b, which may turn with them
            near = (apart <= h * closing) & ~(self.fixed & self.fixed[b])
            near[b] = False
            free = share * np.maximum(apart[near], 0.0) + np.minimum(self.reach[near], self.reach[b])
            moving = closing[near] > 0
            until = min(until, float((free[moving] / closing[near][moving]).min(initial=np.inf)))
        return until

    def _boxes(self, state: MotionState) -> tuple[Array, Array]:
        """Return the corners (B, d) of the boxes around bodies [m]."""
        start = self.surface.placed(state.placement).start
        low, high = np.full((2, *state.centre.shape), np.inf) * [[[1.0]], [[-1.0]]]
        np.minimum.at(low, self.surface.body, start)
        np.maximum.at(high, self.surface.body, start)
        return low, high

    def outrun(self, state: MotionState, h: float, least: float) -> str:
        """Return what is said of a body that in a step h outruns those of a least length [s]; empty where none does."""
        spin = np.abs(state.spin) if state.spin.ndim == 1 else norm(state.spin)
        speed = norm(state.velocity) + spin * self.radius
        bodies = self.reference.model.bodies
        if least * float(spin.max(initial=0.0)) > TURN:
            moves = f"turns at {number(float(spin.max()), 4)} rad/s"
            return outran(bodies[int(np.argmax(spin))].name, moves, least)
        if self._until(state, h, speed, spin, 0.0) < least:
            moves = f"comes near others at {number(float(speed.max()), 4)} m/s"
            return outran(bodies[int(np.argmax(speed))].name, moves, least)
        return ""
