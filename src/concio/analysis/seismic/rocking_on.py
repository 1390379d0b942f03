"""What a linkage becomes where a part that slides comes to the edge of what carries it: it rocks about the edge.

Where the resultant of a sliding joint stands at one end of its contact, the other end opens. Sliding and rocking need
the same multiplier there, and from then on rocking needs less. The end that still presses becomes a hinge of the two
material points that touch there, which holds as long as its force lies within Coulomb's cone about the turned normal of
its face (decision 0497).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.analysis.seismic.curve import CapacityCurve, follow
from concio.analysis.seismic.linkage import Linkage, Point
from concio.analysis.seismic.macro_blocks import GROUND, MacroJoint
from concio.analysis.seismic.participation import moved_of_masses
from concio.kinematics.frames import turned

Array = np.ndarray

OPENED = 1e-5
"""Share of the largest force of all joints below which the end of a sliding joint has opened."""

SAME = 1e-4
"""Relative difference of the multipliers of sliding and rocking where one passes into the other."""


def followed_on(linkage: Linkage, curve: CapacityCurve) -> CapacityCurve:
    """Return a curve that ends where a sliding joint opens, gone on with as the part rocks; else the curve as it is.

    Parameters
    ----------
    linkage : Linkage
        Without ties.
    curve : CapacityCurve
        Of it.

    Notes
    -----
    A curve whose control point would outrun the masses from there on stays as it is.
    """
    while curve.reason == "joint opens":
        last = curve.points[-1]
        rocks = _rocking(linkage, last)
        if rocks is None:
            return curve
        rest = follow(rocks, last.q, curve.end)
        if not rest.points or not rest.end > curve.end or abs(rest.multiplier[0] / last.multiplier - 1.0) > SAME:
            return curve
        if _outruns(linkage, last.q, rest):
            return curve
        curve = replace(
            rest,
            displacement=np.concatenate([curve.displacement[:-1], rest.displacement[1:]]),
            multiplier=np.concatenate([curve.multiplier[:-1], rest.multiplier[1:]]),
            tie_force=np.zeros((len(curve.points) + len(rest.points) - 2, 0)),
            points=(*curve.points[:-1], *rest.points[1:]),
        )
        linkage = rocks
    return curve


def _outruns(linkage: Linkage, start: Array, rest: CapacityCurve) -> bool:
    """Return whether the control point moves further, on a curve that goes on from ``start``, than the masses do."""
    first, end = linkage.velocity(np.zeros_like(start)).reshape(-1, 3), rest.points[-1].q
    moved = moved_of_masses(
        linkage.push, linkage.mechanics, first,
        lambda force: linkage.went(end, force.block, force.point) - linkage.went(start, force.block, force.point),
    )  # fmt: skip
    return moved < (1.0 - SAME) * float(rest.displacement[-1] - rest.displacement[0])


def _rocking(linkage: Linkage, last: Point) -> Linkage | None:
    """Return the linkage whose opened ends are gone and whose other ends are hinges.

    None where nothing has opened, or where the part would turn into what it stands on.
    """
    now = linkage.joints(last.q)
    top = float(np.abs(last.normal_force).max(initial=0.0))
    gone = [
        k for k, joint in enumerate(now)
        if joint.kind == "roller" and not joint.pulls and last.normal_force[k] <= OPENED * top
    ]  # fmt: skip
    between = {frozenset((now[k].a, now[k].b)) for k in gone}
    if not gone:
        return None
    joints = [
        _hinge(linkage, last.q, joint)
        if joint.kind == "roller" and not joint.pulls and frozenset((joint.a, joint.b)) in between
        else linkage.mechanics.joints[k]
        for k, joint in enumerate(now) if k not in gone
    ]  # fmt: skip
    rocks = replace(linkage, mechanics=replace(linkage.mechanics, joints=tuple(joints)))
    v = rocks.velocity(last.q)
    return rocks if all(_opening(linkage, last.q, now[k]) @ v > 0 for k in gone) else None


def _opening(linkage: Linkage, q: Array, joint: MacroJoint) -> Array:
    """Return how fast a roller opens with each unknown (3 G,)."""
    normal = linkage.normal(q, joint)
    opening: Array = linkage.row(q, joint.b, joint.point, normal) - linkage.row(q, joint.a, joint.point, normal)
    return opening


def _hinge(linkage: Linkage, q: Array, joint: MacroJoint) -> MacroJoint:
    """Return the hinge of the two points of material that touch at a roller."""
    own, other = (joint.a, joint.b) if joint.face else (joint.b, joint.a)
    opposite = _material(linkage, q, other, joint.point + linkage.went(q, own, joint.point))
    ends = (joint.point, opposite) if joint.face else (opposite, joint.point)
    return replace(joint, kind="hinge", point=ends[0], end=ends[1], low=-float("inf"), high=float("inf"))


def _material(linkage: Linkage, q: Array, block: int, place: Array) -> Array:
    """Return the point (2,) of a macro-block, where it was described, that is at a place now."""
    if block == GROUND:
        return place
    centre = linkage.mechanics.blocks[block].centre
    found: Array = centre + turned(place - centre - q[block, :2], -q[block, 2])
    return found
