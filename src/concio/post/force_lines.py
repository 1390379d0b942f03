"""Forces between bodies: where the resultant of each joint acts, how large it is, how it runs through the blocks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

FILM = 4.0
"""A body longer than this times its width is a film: no force is drawn to its centre."""


@short_repr
@dataclass(frozen=True, eq=False)
class JointForces:
    """Resultants of the loaded joints, j in all.

    Parameters
    ----------
    joint : (j,) integer array
        Interface of each.
    point : (j, 2) array
        Where the resultant meets the joint [m].
    force : (j, 2) array
        Force on side b [kN].
    size : (j,) array
        Its size [kN].
    """

    joint: Array
    point: Array
    force: Array
    size: Array


def joint_forces(result: Result, threshold: float = 1e-6) -> JointForces:
    """Return the resultants above ``threshold`` times the largest."""
    joints = result.joints
    force = joints.N[:, None] * joints.normal + joints.V[:, None] * joints.tangent
    size = np.hypot(*force.T)
    keep = np.flatnonzero((size > threshold * size.max(initial=0.0)) & (size > 0))
    away = np.clip(np.nan_to_num(joints.eccentricity[keep]), -joints.length[keep] / 2, joints.length[keep] / 2)
    point = joints.middle[keep] + away[:, None] * joints.tangent[keep]
    return JointForces(keep, point, force[keep], size[keep])


@short_repr
@dataclass(frozen=True, eq=False)
class Chains:
    """Lines along which forces run from joint to joint, k in all.

    Parameters
    ----------
    lines : (k, 2, 2) array
        [m].
    force : (k,) array
        Force that each carries [kN].
    """

    lines: Array
    force: Array


def force_chains(result: Result, threshold: float = 1e-3) -> Chains:
    """Return a line from each loaded joint to the centre of the block on either side.

    Fixed bodies and films (such as mortar beds, much longer than wide) get no line: the force crosses them on the spot.
    """
    found = joint_forces(result, threshold)
    joints = result.joints
    bodies = result.model.outlines
    compact = np.array([b.kind != "fixed" and not _is_film(b.outline, b.area) for b in bodies])
    centres = result.assembly.disc.centroids
    lines, force = [], []
    for side in (joints.body_a, joints.body_b):
        body = side[found.joint]
        keep = compact[body]
        lines.append(np.stack([found.point[keep], centres[body[keep]]], axis=1))
        force.append(found.size[keep])
    return Chains(np.concatenate(lines), np.concatenate(force))


def _is_film(outline: Array, area: float) -> bool:
    longest = float(np.hypot(*(outline - np.roll(outline, 1, axis=0)).T).max())
    return longest**2 > FILM * area
