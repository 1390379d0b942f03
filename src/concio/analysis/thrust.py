r"""Thrust: resultants of joints, the line of thrust of an arch, hinges by name, and resultants course by course.

The resultant of a joint crosses it at the distance e = M / N from its middle. Where e reaches half the length the joint
turns about its edge: a hinge. The line of thrust joins the crossing points from joint to joint along a chain of blocks;
it exists where every block of the chain has two joints, as in an arch. In a wall the forces branch, and what makes
sense is the resultant of all bed joints at one level.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.analysis.contacts import JointResultants
from concio.analysis.result import Result
from concio.arguments import strict
from concio.errors import InputError
from concio.read_only import read_only
from concio.representation import short_repr

Array = np.ndarray

AT_EDGE = 0.02
"""A joint is a hinge when its resultant is within this share of its length from an edge."""


@short_repr
@dataclass(frozen=True)
class Hinge:
    """A joint whose resultant crosses it at an edge.

    Parameters
    ----------
    bodies : (str, str)
        Bodies a and b of the joint.
    at : (x, y)
        The edge about which the joint turns [m].
    eccentricity : float
        e over the length of the joint, -0.5 to 0.5, positive along t.
    normal_force : float
        [kN].
    """

    bodies: tuple[str, str]
    at: tuple[float, float]
    eccentricity: float
    normal_force: float

    def __str__(self) -> str:
        return f"hinge between {self.bodies[0]} and {self.bodies[1]} at ({self.at[0]:.4g}, {self.at[1]:.4g})"


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class ThrustLine:
    """Line of thrust along a chain of joints; k joints.

    Parameters
    ----------
    joint : (k,) integer array
        Interfaces in order along the chain.
    point : (k, 2) array
        Where the resultant crosses each joint [m].
    force : (k, 2) array
        Resultant on the block that follows in the chain [kN].
    eccentricity : (k,) array
        e over the length of the joint, -0.5 to 0.5; positive to the left of the way along the chain, which begins at
        the leftmost end: the extrados of an arch.
    """

    joint: Array
    point: Array
    force: Array
    eccentricity: Array


@short_repr
@dataclass(frozen=True, eq=False)
@read_only
class CourseResultants:
    """Resultants of the bed joints at each level; l levels, from below.

    Parameters
    ----------
    level : (l,) array
        Height [m].
    force : (l, 2) array
        Force of the lower part on the upper part, (x, y) [kN].
    position : (l,) array
        x at which its vertical part acts; nan where there is none [m].
    extent : (l, 2) array
        Left and right end of the joints at the level [m].
    """

    level: Array
    force: Array
    position: Array
    extent: Array


def crossing_points(joints: JointResultants) -> Array:
    """Return where the resultant of each joint crosses its line (j, 2); nan where there is no normal force [m]."""
    points: Array = joints.middle + joints.eccentricity[:, None] * joints.tangent
    return points


def edge_shares(joints: JointResultants) -> Array:
    """Return the eccentricities over the lengths (j,), 0.5 at contacts without length; nan without normal force."""
    some = joints.length > 0
    share = np.divide(joints.eccentricity, joints.length, out=np.full(len(some), 0.5), where=some)
    return np.asarray(np.where(np.isnan(joints.eccentricity), np.nan, share))


@strict
def hinges(result: Result, tolerance: float = AT_EDGE) -> list[Hinge]:
    """Return the joints whose resultant crosses them within ``tolerance`` times their length from an edge.

    Parameters
    ----------
    result : Result
    tolerance : float
    """
    joints, bodies = result.joints, result.model.bodies
    found = []
    for j, e in enumerate(edge_shares(joints).tolist()):
        if not abs(e) >= 0.5 - tolerance:
            continue
        edge = joints.middle[j] + 0.5 * np.sign(e) * joints.length[j] * joints.tangent[j]
        names = (bodies[int(joints.body_a[j])].name, bodies[int(joints.body_b[j])].name)
        found.append(Hinge(names, (float(edge[0]), float(edge[1])), float(e), float(joints.N[j])))
    return found


@strict
def thrust_line(result: Result) -> ThrustLine:
    """Return the line of thrust of a chain of blocks, such as an arch between its abutments.

    Parameters
    ----------
    result : Result

    Raises
    ------
    InputError
        The blocks do not form a chain: one of them has other than two joints.

    Examples
    --------
    Under vertical loads the horizontal thrust is the same in every joint:

    >>> import concio
    >>> import numpy as np
    >>> arch = concio.arch(span=2.0, ring=0.3, voussoirs=9, block="rigid")
    >>> line = concio.thrust_line(concio.solve(arch))
    >>> len(line.point), bool(np.ptp(line.force[:, 0]) < 1e-6)
    (10, True)
    """
    joints, model = result.joints, result.model
    at: dict[int, list[int]] = {i: [] for i, b in enumerate(model.bodies) if b.kind != "fixed"}
    for j in range(len(joints.N)):
        for b in (int(joints.body_a[j]), int(joints.body_b[j])):
            if b in at:
                at[b].append(j)
    for b, own in at.items():
        if len(own) != 2:
            msg = f"it has {len(own)} joints: the blocks do not form a chain"
            hint = "a line of thrust is that of an arch or a pier; result.plot.forces() shows those of a wall"
            raise InputError(msg, where=f"block '{model.bodies[b].name}'", hint=hint)
    ends = [j for j in range(len(joints.N)) if not {int(joints.body_a[j]), int(joints.body_b[j])} <= at.keys()]
    if len(ends) != 2:
        msg = f"the chain has {len(ends)} ends on fixed bodies, expected 2"
        raise InputError(msg, hint="a line of thrust needs one chain between two abutments")
    first = min(ends, key=lambda j: tuple(joints.middle[j]))
    order, signs, joint, block = [first], list[float](), first, -1
    while True:
        sides = (int(joints.body_a[joint]), int(joints.body_b[joint]))
        following = [b for b in sides if b in at and b != block]
        signs.append(1.0 if (sides[1] == following[0] if following else sides[0] == block) else -1.0)
        if not following:
            break
        block = following[0]
        joint = next(j for j in at[block] if j != joint)
        order.append(joint)
    force = joints.N[:, None] * joints.normal + joints.V[:, None] * joints.tangent
    chain = np.array(order)
    return ThrustLine(
        chain,
        crossing_points(joints)[chain],
        np.array(signs)[:, None] * force[chain],
        np.array(signs) * edge_shares(joints)[chain],
    )


@strict
def course_resultants(result: Result, tolerance: float = 1e-6) -> CourseResultants:
    """Return the resultants of the level bed joints of a wall, level by level from below.

    Parameters
    ----------
    result : Result
    tolerance : float
        Joints within this share of the height of the structure are on one level.
    """
    joints = result.joints
    level = np.abs(joints.normal[:, 1]) > 1.0 - 1e-9
    y = joints.middle[:, 1]
    height = float(np.ptp(y)) if len(y) else 0.0
    order = np.flatnonzero(level)[np.argsort(y[level], kind="stable")]
    groups = np.split(order, np.flatnonzero(np.diff(y[order]) > tolerance * (height or 1.0)) + 1) if order.size else []
    levels, forces, positions, extents = [], [], [], []
    for group in groups:
        up = np.sign(joints.normal[group, 1])[:, None]  # the side the normal points to is above
        force = up * (joints.N[group, None] * joints.normal[group] + joints.V[group, None] * joints.tangent[group])
        x = crossing_points(joints)[group, 0]
        total = float(force[:, 1].sum())
        moment = float(np.where(np.isfinite(x), x, 0.0) @ force[:, 1])
        ends = np.abs(joints.tangent[group, 0]) * joints.length[group] / 2
        levels.append(float(y[group].mean()))
        forces.append(force.sum(0))
        positions.append(moment / total if total else np.nan)
        middle = joints.middle[group, 0]
        extents.append((float((middle - ends).min()), float((middle + ends).max())))
    return CourseResultants(
        np.array(levels), np.array(forces).reshape(-1, 2), np.array(positions), np.array(extents).reshape(-1, 2)
    )
