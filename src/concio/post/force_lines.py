"""Forces between bodies: where the resultant of each joint acts, how large it is, how it flows through the blocks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.post.struts import balanced, struts
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

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
    """Lines along which forces run through the blocks from joint to joint, k in all.

    Parameters
    ----------
    lines : (k, 2, 2) array
        [m].
    force : (k,) array
        Force that each carries, compression positive [kN].
    """

    lines: Array
    force: Array


def force_chains(result: Result, threshold: float = 1e-3) -> Chains:
    """Return how forces flow through every block that is not fixed, see :mod:`concio.post.struts`.

    The lines in a block hold the resultants of its joints and its own load in balance; those that carry less than
    ``threshold`` times the largest resultant of a joint are left out.
    """
    found = joint_forces(result, 0.0)
    joints, bodies = result.joints, result.model.outlines
    fixed = np.array([body.kind == "fixed" for body in bodies])
    body = np.concatenate([joints.body_b[found.joint], joints.body_a[found.joint]])
    point, force = np.vstack([found.point] * 2), np.vstack([found.force, -found.force])
    pushed = []
    for b in np.unique(body[~fixed[body]]):
        own = body == b
        pushed.append(balanced(bodies[b], point[own], force[own]))
    bars = struts(pushed)
    keep = np.abs(bars.force) > threshold * found.size.max(initial=0.0)
    return Chains(bars.lines[keep], bars.force[keep])
