"""Rotations and the motion of the base as certificates write them, apart from what steps use."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from concio.analysis.motion.scheme import Drive
from concio.analysis.motion.state import MotionState
from concio.contact.reference import Reference
from concio.fem.discretisation import FIXED
from concio.kinematics.frames import turned

Array = np.ndarray


def driven(reference: Reference, state: MotionState, h: float, drive: Drive) -> tuple[Array, Array]:
    """Return velocities (B, d) and spins at the beginning of a step, of fixed bodies the means that are imposed."""
    fixed = reference.disc.shape_of == FIXED
    velocity, spin = state.velocity.copy(), state.spin.copy()
    velocity[fixed], spin[fixed] = drive.velocity, drive.spin
    if drive.pivot is not None:
        arm = state.centre - drive.pivot
        if arm.shape[1] == 2:
            gone = turned(arm, h * drive.spin) - arm
        else:
            gone = Rotation.from_rotvec(h * np.asarray(drive.spin)).apply(arm) - arm
        velocity[fixed] += gone[fixed] / h
    return velocity, spin


def forth(arm: Array, rotation: Array) -> Array:
    """Return vectors (k, d) turned by angles (k,) or by matrices (k, 3, 3)."""
    if rotation.ndim == 1:
        return turned(arm, rotation)
    return np.asarray(np.matmul(rotation, arm[:, :, None])[:, :, 0])


def back(arm: Array, rotation: Array) -> Array:
    """Return vectors (k, d) turned back."""
    return turned(arm, -rotation) if rotation.ndim == 1 else forth(arm, np.swapaxes(rotation, 1, 2))


def on(rotation: Array, turn: Array) -> Array:
    """Return rotations after further ones, angles (k,) or vectors (k, 3) [rad]."""
    if rotation.ndim == 1:
        return np.asarray(rotation + turn)
    return np.asarray(np.matmul(Rotation.from_rotvec(turn).as_matrix(), rotation))


def angle(before: Array, after: Array) -> Array:
    """Return the angles (k,) between two rotations [rad]."""
    if before.ndim == 1:
        return np.asarray(np.abs(after - before))
    return np.asarray(Rotation.from_matrix(np.matmul(after, np.swapaxes(before, 1, 2))).magnitude())
