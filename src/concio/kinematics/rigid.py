r"""Rigid motions: their operators, and finite rotations.

The motion of a rigid body is the displacement of its centroid and its rotation times a length, the *reach* (its radius
of gyration), so that all its unknowns are lengths: (u_x, u_y, r theta) in the plane, (u_x, u_y, u_z, r theta_x,
r theta_y, r theta_z) in space. A point at the arm a from the centroid moves by u + theta x a; in the plane
theta x a = theta (-a_y, a_x).
"""

from __future__ import annotations

import numpy as np

from concio.kinematics.frames import cross

Array = np.ndarray


def motions(dim: int) -> int:
    """Return the number of rigid motions of a body: 3 in the plane, 6 in space."""
    return 3 if dim == 2 else 6


def swept(rotation: Array | float, arm: Array) -> Array:
    """Return theta x a (..., d): what a small rotation adds to the displacement of points at arms (..., d).

    Parameters
    ----------
    rotation : (...) array in the plane, (..., 3) in space
        [rad].
    arm : (..., d) array
        From the centroid to the point [m].
    """
    arm = np.asarray(arm, dtype=float)
    if arm.shape[-1] == 2:
        spin = np.asarray(rotation, dtype=float)
        found = np.empty((*np.broadcast_shapes(spin.shape, arm.shape[:-1]), 2))
        np.multiply(-spin, arm[..., 1], out=found[..., 0])
        np.multiply(spin, arm[..., 0], out=found[..., 1])
        return found
    return cross(np.broadcast_to(np.asarray(rotation, dtype=float), arm.shape), arm)


def rotated(arm: Array, turn: Array | float) -> Array:
    """Return arms (k, d) after one finite rotation: an angle in the plane, a vector (3,) in space [rad]."""
    matrix = plane_rotation(float(turn)) if arm.shape[-1] == 2 else rotation_matrix(np.asarray(turn)[None])[0]
    return np.asarray(arm @ matrix.T)


def rigid_row(direction: Array, arm: Array, reach: Array | float) -> Array:
    """Return (..., 3 or 6): the displacement along ``direction`` of a point at ``arm``, from the motion of its body.

    Parameters
    ----------
    direction : (..., d) array
    arm : (..., d) array
        From the centroid to the point [m].
    reach : (...) array or float
        Length that turns rotations into displacements [m].
    """
    direction, arm = np.broadcast_arrays(np.asarray(direction, dtype=float), np.asarray(arm, dtype=float))
    turn = cross(arm, direction)
    if direction.shape[-1] == 2:
        turn = turn[..., None]
    return np.concatenate([direction, turn / np.asarray(reach, dtype=float)[..., None]], axis=-1)


def write_rigid_rows(out: Array, frame: Array, arm: Array, reach: Array) -> None:
    """Write into ``out`` (m, d, 3 or 6) the displacements along directions ``frame`` (m, d, d), as :func:`rigid_row`.

    Parameters
    ----------
    out : (m, d, 3 or 6) array
    frame : (m, d, d) array
    arm : (m, d) array
        From the centroid to the point [m].
    reach : (m,) array
        Length that turns rotations into displacements [m].
    """
    d = frame.shape[-1]
    for k in range(d):
        for axis in range(d):  # component by component: arrays that are long along their first axis only
            out[:, k, axis] = frame[:, k, axis]
        turn = cross(arm, frame[:, k])
        if d == 2:
            np.divide(turn, reach, out=out[:, k, 2])
        else:
            np.divide(turn, reach[:, None], out=out[:, k, 3:])


def rigid_operator(arm: Array, reach: Array | float) -> Array:
    """Return (..., d, 3 or 6): the displacement of points at arms (..., d) from the motion of their body."""
    arm = np.asarray(arm, dtype=float)
    d = arm.shape[-1]
    directions = np.broadcast_to(np.eye(d), (*arm.shape[:-1], d, d))
    return rigid_row(directions, arm[..., None, :], np.asarray(reach, dtype=float)[..., None])


def rigid_modes(points: Array) -> Array:
    """Return the rigid motions (d n, 3 or 6) of points (n, d), orthonormal, unknowns point by point.

    Translations first, then rotations about the mean of the points.
    """
    n, d = points.shape
    arm = points - points.mean(0)
    modes = rigid_operator(arm, 1.0).reshape(d * n, motions(d))
    modes[:, :d] /= np.sqrt(n)
    if d == 2:
        modes[:, 2] /= np.linalg.norm(modes[:, 2])
    else:
        modes[:, 3:] = np.linalg.qr(modes[:, 3:])[0]
    return modes


def plane_rotation(angle: Array | float) -> Array:
    """Return the matrices (..., 2, 2) of rotations in the plane by angles (...) [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)


def rotation_matrix(rotation: Array) -> Array:
    """Return the matrices (..., 3, 3) of finite rotations in space by vectors (..., 3) [rad]."""
    theta = np.asarray(rotation, dtype=float)
    angle = np.linalg.norm(theta, axis=-1)[..., None, None]
    zero = np.zeros(theta.shape[:-1])
    x, y, z = theta[..., 0], theta[..., 1], theta[..., 2]
    rows = [np.stack(row, axis=-1) for row in ([zero, -z, y], [z, zero, -x], [-y, x, zero])]
    spin = np.stack(rows, axis=-2)
    sine = np.sinc(angle / np.pi)  # sin(a) / a
    versine = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2  # (1 - cos(a)) / a^2
    return np.asarray(np.eye(3) + sine * spin + versine * (spin @ spin))
