"""What each measurement reads of a state: linear functions of the displacements and of the motions of fixed bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from concio.analysis.cracks.measurement import AT_A_JOINT, Measurement
from concio.arguments import closest
from concio.contact.assembly import Assembly
from concio.contact.expansion import expanded, warmed
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID
from concio.kinematics.frames import cross, tangents, turned_left
from concio.kinematics.rigid import swept
from concio.model.interfaces.detect import Interface
from concio.model.interfaces.patch import Patch

Array = np.ndarray
Joint = Interface | Patch

NEAR = 0.05
"""A point is at a joint that is nearer than this share of the joint's size."""


@dataclass(frozen=True, eq=False)
class Reading:
    """A linear function of a state.

    Parameters
    ----------
    row : (N_all,) array
        Of the displacements of all unknowns.
    moved : mapping of str to float
        What fixed bodies that are moved, and rigid ones that expand, add for each load group, at factor 1.
    at : (d,) array
        Where it is read, for figures [m].
    along : (d,) array
        Direction in which it is positive: of a joint the motion of its second body.
    change : bool
        Whether it is counted from the loaded structure, not from the structure as described.
    bodies : (int, int)
        Bodies between which it is read; -1 for none.
    """

    row: Array
    moved: Mapping[str, float]
    at: Array
    along: Array
    change: bool
    bodies: tuple[int, int]

    def value(self, displacement: Array, factors: Mapping[str, float]) -> float:
        """Return what is read of displacements (N_all,) under load factors [m or rad]."""
        return float(self.row @ displacement) + sum(f * factors[g] for g, f in self.moved.items() if g in factors)


def readings(assembly: Assembly, measurements: Sequence[Measurement]) -> tuple[Reading, ...]:
    """Return what each measurement reads.

    Raises
    ------
    InputError
        There is no measurement, two have one name, or one names a body or a joint that does not exist.
    """
    names = [m.name for m in measurements]
    twice = next((n for n in names if names.count(n) > 1), None)
    if not names or twice is not None:
        msg = f"two measurements are called '{twice}'" if names else "there is no measurement"
        hint = "give each a name of its own" if names else "give openings, tilts, levels or distances"
        raise InputError(msg, where="measurements", hint=hint)
    return tuple(_reading(assembly, m) for m in measurements)


def joint_reading(assembly: Assembly, joint: Joint, point: Array, along: Array) -> Reading:
    """Return the motion of body b of a joint against body a at a point, along a direction."""
    a = _moving(assembly, joint.a, point, along)
    b = _moving(assembly, joint.b, point, along)
    moved = {g: b[1].get(g, 0.0) - a[1].get(g, 0.0) for g in (*a[1], *b[1])}
    return Reading(b[0] - a[0], moved, point, along, False, (joint.a, joint.b))


def body_reading(assembly: Assembly, b: int, along: Array) -> Reading:
    """Return the displacement of the middle of a body along a direction, from the loaded structure."""
    disc = assembly.disc
    middle = np.asarray(disc.centroids[b], dtype=float)
    if disc.shape_of[b] not in (FIXED, RIGID):
        nodes = disc.nodes(b)
        middle = nodes[int(np.argmin(np.linalg.norm(nodes - middle, axis=1)))]
    row, moved = _moving(assembly, b, middle, along)
    return Reading(row, moved, middle, along, True, (b, -1))


def corners(joint: Joint) -> Array:
    """Return the corners (k, d) of a joint: its two ends in the plane, those of its polygon in space [m]."""
    return np.array([joint.start, joint.end]) if isinstance(joint, Interface) else joint.polygon


def middle(joint: Joint) -> Array:
    """Return the middle (d,) of a joint [m]."""
    return (joint.start + joint.end) / 2 if isinstance(joint, Interface) else joint.middle


def tangent(joint: Joint) -> Array:
    """Return a direction (d,) along a joint: in the plane its normal turned left, in space the first tangent."""
    return turned_left(joint.normal) if isinstance(joint, Interface) else tangents(joint.normal)[0]


def _reading(assembly: Assembly, m: Measurement) -> Reading:
    where = f"measurement '{m.name}'"
    d = assembly.model.dim
    for key in ("at", "to"):
        point = getattr(m, key)
        if point is not None and len(point) != d:
            msg = f"{key} = {point} has not {d} coordinates"
            raise InputError(msg, where=where, hint="two in the plane, three in space")
    if m.kind in AT_A_JOINT:
        joint = _joint(assembly, m, where)
        point = middle(joint) if m.at is None else _on(joint, np.array(m.at, dtype=float), where)
        along = joint.normal if m.kind != "slip" else _slip_direction(assembly, joint, m, where)
        return joint_reading(assembly, joint, point, along)
    b = _number(assembly, m.body, where)
    c = _number(assembly, m.other, where) if m.other else b
    if m.kind == "tilt":
        return _tilt(assembly, m, b, where)
    at = np.array(m.at, dtype=float)
    if m.kind == "distance":
        to = np.array(m.to, dtype=float)
        size = float(np.linalg.norm(to - at))
        if not size > 0:
            msg = "the two points are the same"
            raise InputError(msg, where=where, hint="give at and to apart from each other")
        return _between(assembly, b, at, c, to, (at - to) / size, where)
    along = _direction(m.direction or (0.0,) * (d - 1) + (1.0,), d, where)
    if m.to is None and not m.other:
        row, moved = _moving(assembly, b, at, along, where)
        return Reading(row, moved, at, along, True, (b, -1))
    return _between(assembly, b, at, c, at if m.to is None else np.array(m.to, dtype=float), along, where)


def _between(assembly: Assembly, b: int, at: Array, c: int, to: Array, along: Array, where: str) -> Reading:
    """Return the displacement of a point of b less that of a point of c."""
    first, second = _moving(assembly, b, at, along, where), _moving(assembly, c, to, along, where)
    moved = {g: first[1].get(g, 0.0) - second[1].get(g, 0.0) for g in (*first[1], *second[1])}
    return Reading(first[0] - second[0], moved, at, along, True, (b, c))


def _tilt(assembly: Assembly, m: Measurement, b: int, where: str) -> Reading:
    """Return the rotation of a body between two of its points, about an axis in space."""
    d = assembly.model.dim
    nodes = assembly.disc.nodes(b)
    at = nodes[np.argmin(nodes[:, -1])] if m.at is None else np.array(m.at, dtype=float)
    to = nodes[np.argmax(nodes[:, -1])] if m.to is None else np.array(m.to, dtype=float)
    if d == 3 and not m.direction:
        msg = "a tilt in space needs the axis about which it turns"
        raise InputError(msg, where=where, hint="direction = [1, 0, 0] is a lean towards -y")
    arm = to - at
    across = turned_left(arm) if d == 2 else cross(_direction(m.direction, d, where), arm)
    size2 = float(across @ across)
    if not size2 > (1e-9 * float(np.ptp(nodes, axis=0).max())) ** 2:
        msg = "the two points between which the tilt is measured do not determine it"
        raise InputError(msg, where=where, hint="take points apart from each other, across the axis")
    found = _between(assembly, b, to, b, at, across / size2, where)
    return Reading(found.row, found.moved, (at + to) / 2, across / np.sqrt(size2), True, (b, -1))


def _moving(
    assembly: Assembly, b: int, point: Array, along: Array, where: str | None = None
) -> tuple[Array, dict[str, float]]:
    """Return the displacement of a point of body b along a direction, as (row (N_all,), part of each load group)."""
    disc = assembly.disc
    row = np.zeros(disc.unknowns)
    if disc.shape_of[b] == FIXED:
        moved: dict[str, float] = {}
        for s in assembly.model.supports:
            if s.body == assembly.model.bodies[b].name:
                motion = np.asarray(s.displacement) + swept(np.asarray(s.rotation), point - disc.centroids[b])
                moved[s.group] = moved.get(s.group, 0.0) + float(motion @ along)
        return row, moved
    try:
        unknowns, operator = disc.point_operator(b, point)
    except InputError as error:
        raise InputError(error.what, where=where or error.where, hint=error.hint) from None
    row[unknowns] = along @ operator
    model = assembly.model
    changes = model.temperatures if disc.shape_of[b] == RIGID else ()  # nodes of elastic bodies move by all of it
    grown: dict[str, float] = {}
    for change in (c for c in changes if b in warmed(model, c)):
        by = float(expanded(model, b, change, point[None, :])[0] @ along)
        grown[change.group] = grown.get(change.group, 0.0) + by
    return row, grown


def _joint(assembly: Assembly, m: Measurement, where: str) -> Joint:
    """Return the joint between the bodies named that is nearest to the point given."""
    joints: list[Joint] = list(assembly.detection.faces)
    if m.joint:
        pair = {_number(assembly, name, where) for name in m.joint}
        joints = [j for j in joints if {j.a, j.b} == pair]
        if not joints:
            msg = f"there is no joint between '{m.joint[0]}' and '{m.joint[1]}'"
            raise InputError(msg, where=where, hint="see the joints with 'concio check'")
    if m.at is None:
        return max(joints, key=lambda j: j.size)
    at = np.array(m.at, dtype=float)
    return min(joints, key=lambda j: _distance(j, at))


def _distance(joint: Joint, point: Array) -> float:
    """Return how far a point is from a joint: in the plane from its segment, in space from about its polygon [m]."""
    if isinstance(joint, Interface):
        along = joint.end - joint.start
        share = float(np.clip((point - joint.start) @ along / (along @ along), 0.0, 1.0))
        return float(np.linalg.norm(point - joint.start - share * along))
    offset = float(abs((point - joint.middle) @ joint.normal))
    inside = max(0.0, float(np.linalg.norm(point - joint.middle)) - joint.size / 2)
    return offset + inside


def _on(joint: Joint, point: Array, where: str) -> Array:
    """Return a point of a measurement, refused where it is not at its joint."""
    far = _distance(joint, point)
    if far > NEAR * joint.size:
        text = ", ".join(f"{v:g}" for v in point)
        msg = f"the point ({text}) is {far:.3g} m away from the nearest joint that is meant"
        raise InputError(msg, where=where, hint="give a point on the joint, or leave it out for the middle")
    return point


def _slip_direction(assembly: Assembly, joint: Joint, m: Measurement, where: str) -> Array:
    """Return the direction in which a slip is positive as the motion of body b of its joint."""
    if isinstance(joint, Interface):
        return tangent(joint)
    if not m.direction:
        msg = "a slip in space needs the direction along which it is positive"
        raise InputError(msg, where=where, hint="direction = [x, y, z] of the motion of the second body named")
    along = _direction(m.direction, 3, where)
    return -along if m.joint and _number(assembly, m.joint[0], where) == joint.b else along


def _direction(vector: Sequence[float], d: int, where: str) -> Array:
    given = np.asarray(vector, dtype=float)
    size = float(np.linalg.norm(given)) if given.shape == (d,) else np.nan
    if not 0 < size < np.inf:
        msg = f"direction = {tuple(vector)} is not a direction with {d} components"
        raise InputError(msg, where=where)
    unit: Array = given / size
    return unit


def _number(assembly: Assembly, name: str, where: str) -> int:
    names = [b.name for b in assembly.model.bodies]
    if name not in names:
        msg = f"there is no body called '{name}'"
        raise InputError(msg, where=where, hint=closest(name, names, otherwise="see the names with 'concio check'"))
    return names.index(name)
