"""The thrust surface of a structure in space: where the force of each joint passes, and how far that is from an edge.

In an arch the crossing points of the joints lie on a line; in a vault, a dome or a wall forces branch, and the points
of all joints that carry make up a surface inside the masonry. Where a point comes to the edge of its joint, the joint
turns about that edge: a hinge line.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from concio.analysis.result import Result
from concio.analysis.thrust import AT_EDGE
from concio.arguments import strict
from concio.errors import InputError
from concio.problem.tolerances import AT_BOUND
from concio.read_only import read_only
from concio.representation import short_repr

Array = np.ndarray


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class ThrustSurface:
    """Crossing points of the joints that carry; k joints.

    Parameters
    ----------
    joint : (k,) integer array
        Interfaces.
    bodies : tuple of (str, str)
        Bodies a and b of each.
    point : (k, 3) array
        Centre of pressure [m].
    force : (k, 3) array
        Resultant on body b [kN].
    to_edge : (k,) array
        Distance of the point from the nearest edge of the convex hull of the joint, zero or more [m].
    depth : (k,) array
        The same over the distance of the middle: 1 in the middle, 0 at an edge.
    obliquity : (k,) array
        Shear over normal force; the coefficient of friction that the joint calls for.
    """

    joint: Array
    bodies: tuple[tuple[str, str], ...]
    point: Array
    force: Array
    to_edge: Array
    depth: Array
    obliquity: Array

    @property
    def hinges(self) -> Array:
        """Positions (h,) in these arrays of joints whose force passes at an edge."""
        return np.flatnonzero(self.depth <= 2 * AT_EDGE)


@strict
def thrust_surface(result: Result) -> ThrustSurface:
    """Return where the forces of the joints of a structure in space pass.

    Parameters
    ----------
    result : Result

    Raises
    ------
    InputError
        The model is in the plane.

    Examples
    --------
    A force 0.1 m beside the axis of a pillar without weight passes every joint there:

    >>> import concio
    >>> light = concio.Rigid(unit_weight=0.0)
    >>> pillar = concio.drums(
    ...     diameter=1.0, height=3.0, drums=3, sides=8, block=light, top_force=10.0, eccentricity=(0.1, 0.0)
    ... )
    >>> surface = concio.thrust_surface(concio.solve(pillar))
    >>> surface.point[:, 0].round(6).tolist()
    [0.1, 0.1, 0.1]
    """
    if result.model.dim != 3:
        msg = "a thrust surface is for models in space; the model is in the plane"
        raise InputError(msg, hint="thrust_line gives the line of thrust of an arch")
    joints, names = result.joints_in_space, [body.name for body in result.model.bodies]
    chosen = np.flatnonzero(joints.N / (float(joints.N.max(initial=0.0)) or 1.0) > AT_BOUND)
    patches = result.assembly.detection.patches
    distance = np.zeros((len(chosen), 2))  # none from the edge of a contact at a corner or along an edge
    for k, j in enumerate(chosen.tolist()):
        if j >= len(patches):
            continue
        patch = patches[j]
        hull = ConvexHull((patch.polygon - patch.middle) @ patch.frame.T).equations
        at = np.array([(joints.point[j] - patch.middle) @ patch.frame.T, np.zeros(2)])
        distance[k] = np.maximum(-(at @ hull[:, :2].T + hull[:, 2]).max(axis=1), 0.0)
    return ThrustSurface(
        chosen,
        tuple((names[int(joints.body_a[j])], names[int(joints.body_b[j])]) for j in chosen),
        joints.point[chosen],
        joints.force[chosen],
        distance[:, 0],
        distance[:, 0] / np.where(distance[:, 1] > 0, distance[:, 1], 1.0),
        np.linalg.norm(joints.V[chosen], axis=1) / joints.N[chosen],
    )
