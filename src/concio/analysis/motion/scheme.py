"""How time is stepped, and what drives a step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from concio.errors import InputError
from concio.kinematics.rigid import rotated

Array = np.ndarray

RETURN = 0.2
"""Share of the distance by which a held point has drifted off that is taken back in a step."""


@dataclass(frozen=True)
class Scheme:
    """Parameters of the time stepping.

    Parameters
    ----------
    theta : float
        1/2 conserves energy; up to 1 damps high frequencies.
    restitution : float
        e, coefficient of restitution of impacts of hard joints.
    mass_damping, stiffness_damping : float
        Rayleigh's alpha [1/s] and beta [s] of elastic bodies; beta also of compliant joints and ties.
    brittle : bool
        Whether joints lose cohesion and tensile strength for good in the step after either was used up.
    """

    theta: float = 0.5
    restitution: float = 0.0
    mass_damping: float = 0.0
    stiffness_damping: float = 0.0
    brittle: bool = True

    def __post_init__(self) -> None:
        if not 0.5 <= self.theta <= 1.0:
            msg = f"theta = {self.theta:g} must lie between 0.5 and 1"
            raise InputError(msg, hint="0.5 conserves energy, 1 damps high frequencies most")
        if not 0.0 <= self.restitution <= 1.0:
            msg = f"restitution = {self.restitution:g} must lie between 0 and 1"
            raise InputError(msg, hint="0 is an impact without rebound")
        for name in ("mass_damping", "stiffness_damping"):
            value = getattr(self, name)
            if not 0.0 <= value < np.inf:
                msg = f"{name} = {value:g} must be zero or positive and finite"
                raise InputError(msg, hint="alpha in 1/s and beta in s of Rayleigh's damping")


@dataclass(frozen=True, eq=False)
class Drive:
    """What is imposed during a step.

    Parameters
    ----------
    ground : (d,) array
        Mean acceleration of the ground; bodies feel its opposite as a load [m/s2].
    velocity : (d,) array
        Mean velocity of the fixed bodies, where these are moved [m/s].
    factors : mapping of str to float
        Load factors.
    moved : (d,) array
        How far the fixed bodies, and what supports hold, were moved before [m].
    spin : float in the plane, (3,) array in space
        Mean spin of the fixed bodies [rad/s].
    pivot : (d,) array or None
        About which they turn, where it is at the beginning [m]; None where they do not turn.
    """

    ground: Array
    velocity: Array
    factors: Mapping[str, float]
    moved: Array | float = 0.0
    spin: Array | float = 0.0
    pivot: Array | None = None

    def speeds(self, centre: Array, h: float) -> Array:
        """Return the mean velocities (k, d) of points of the base, now at ``centre`` (k, d), in a step [m/s]."""
        if self.pivot is None:
            return np.broadcast_to(self.velocity, centre.shape)
        arm = centre - self.pivot
        return np.asarray(self.velocity + (rotated(arm, h * np.asarray(self.spin)) - arm) / h)
