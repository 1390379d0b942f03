"""What was measured on a structure, and what may have caused it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from concio.arguments import closest, strict_class
from concio.errors import InputError
from concio.model.actions import Point
from concio.units import quantity

Kind = Literal["opening", "slip", "closed", "tilt", "level", "distance"]
"""Kinds of measurements."""
KINDS: tuple[str, ...] = get_args(Kind)
AT_A_JOINT = ("opening", "slip", "closed")
"""Kinds that belong to a joint, and are counted from the joints as described."""
ANGLES = ("tilt",)
"""Kinds in radians; all others are in metres."""

LARGEST = 1.0
"""No measurement is larger than this [m or rad]: it is in another unit."""

LOOSEST = 0.1
"""An error as large as this is in another unit, or tells nothing [m or rad]."""


@strict_class
@dataclass(frozen=True)
class Measurement:
    """A number that was measured, with its error and its place.

    Parameters
    ----------
    name : str
    kind : {"opening", "slip", "closed", "tilt", "level", "distance"}
        ``opening``: how far a joint is open, normal to it. ``slip``: how far body b of the joint has moved along its
        tangent, in the plane the normal from a to b turned left; the sign does not depend on which body is named first.
        ``closed``: a joint that is not open, which is an opening of zero. ``tilt``: rotation of a body, in the plane
        anticlockwise, in space about ``direction`` by the right hand. ``level``: displacement of a point along
        ``direction``, by default upwards, less that of a second point where one is given. ``distance``: how much longer
        the way from one point to another has become.
    error : float or str
        Standard deviation of the measurement [m], of a tilt [rad]; a text may have a unit, such as ``"0.5 mm"``.
    value : float or str
        What was measured [m], of a tilt [rad]. Openings and slips are counted from the joints as described, all other
        kinds from the structure under its loads before anything moved.
    joint : (str, str), optional
        The two bodies of the joint; of opening, slip and closed. Without it, the joint nearest to ``at`` is taken.
    body : str
        Body whose tilt, level or distance is measured.
    at : point, optional
        Where [m]. At a joint, by default its middle. Of a tilt with ``to``, the first of the two points between which
        it is measured; by default the lowest and the highest corner of the body.
    other : str
        Body of the second point of a level or a distance; by default the same body.
    to : point, optional
        Second point [m].
    direction : vector, optional
        Of a level, of a slip in space, and axis of a tilt in space.

    Raises
    ------
    InputError
        The kind is not known, a number is not usable, or the place is missing.

    Examples
    --------
    >>> import concio
    >>> crack = concio.Measurement("K1", "opening", error=0.5e-3, value=3.2e-3, joint=("voussoir 3", "voussoir 4"))
    >>> crack.value
    0.0032
    """

    name: str
    kind: Kind
    error: float
    value: float = 0.0
    joint: tuple[str, ...] = ()
    body: str = ""
    at: Point | None = None
    other: str = ""
    to: Point | None = None
    direction: Point = ()

    def __post_init__(self) -> None:
        where = f"measurement '{self.name}'"
        if self.kind not in KINDS:
            msg = f"unknown kind of measurement '{self.kind}'"
            raise InputError(msg, where=where, hint=closest(str(self.kind), KINDS))
        for key in ("error", "value"):
            kind = "angle" if self.kind in ANGLES else "length"
            object.__setattr__(self, key, quantity(getattr(self, key), kind, where=f"{where}, {key}"))
        object.__setattr__(self, "joint", tuple(self.joint))
        if not (math.isfinite(self.error) and self.error > 0):
            msg = f"error = {self.error!r} must be positive: it is the standard deviation of the measurement"
            raise InputError(msg, where=where, hint="a ruler reads to about 0.5 mm, a crack gauge to 0.1 mm")
        if self.error >= LOOSEST:
            unit = "rad" if self.kind in ANGLES else "m"
            msg = f"error = {self.error:g} {unit} is more than any crack or tilt of a structure that stands"
            raise InputError(msg, where=where, hint=f"a bare number is in {unit}: give the unit, such as '0.5 mm'")
        if not math.isfinite(self.value):
            msg = f"value = {self.value!r} is not a finite number"
            raise InputError(msg, where=where, hint="leave out what was not measured")
        if abs(self.value) > LARGEST:
            unit = "rad" if self.kind in ANGLES else "m"
            msg = f"value = {self.value:g} {unit} is no {self.kind} of a structure that stands"
            raise InputError(msg, where=where, hint=f"a bare number is in {unit}: give the unit, such as '4.9 mm'")
        self._check_place(where)

    def _check_place(self, where: str) -> None:
        """Refuse a place that does not fit the kind."""
        if self.kind == "closed" and self.value:
            msg = f"a closed joint has no value, {self.value!r} was given"
            raise InputError(msg, where=where, hint="kind 'opening' takes a value")
        if self.kind in AT_A_JOINT:
            if self.body or self.other or self.to is not None:
                msg = f"a measurement of kind '{self.kind}' belongs to a joint, not to a body or a second point"
                raise InputError(msg, where=where, hint="name the joint by its two bodies, joint = [a, b]")
            if len(self.joint) not in (0, 2) or (not self.joint and self.at is None):
                msg = "the joint is not given"
                raise InputError(msg, where=where, hint="joint = [a, b] names its two bodies; or give the point at")
            if self.kind != "slip" and self.value < 0:
                msg = f"an opening of {1e3 * self.value:g} mm: a joint cannot be open by less than nothing"
                raise InputError(msg, where=where, hint="openings are positive; kind 'slip' may have either sign")
            return
        if self.joint:
            msg = f"a measurement of kind '{self.kind}' belongs to a body, not to a joint"
            raise InputError(msg, where=where, hint="give body = name")
        if not self.body:
            msg = "the body is not given"
            raise InputError(msg, where=where, hint="give body = name")
        if self.kind == "level" and self.at is None:
            msg = "the point is not given"
            raise InputError(msg, where=where, hint="give at = [x, y]")
        if self.kind == "distance" and (self.at is None or self.to is None):
            msg = "a distance is measured between two points"
            raise InputError(msg, where=where, hint="give at and to; other names the body of the second point")
        if self.kind == "tilt" and (self.at is None) != (self.to is None):
            msg = "a tilt is measured between two points, and one of them is missing"
            raise InputError(msg, where=where, hint="give at and to, or neither")

    @property
    def quantity(self) -> str:
        """Kind of quantity for units: "motion" or "rotation"."""
        return "rotation" if self.kind in ANGLES else "motion"

    def rounded(self, value: float) -> float:
        """Return a reading rounded to a tenth of the power of ten of the error, as it is reported."""
        return round(value, 1 - math.floor(math.log10(self.error)))


@strict_class
@dataclass(frozen=True)
class Candidate:
    """A motion that may have caused the cracks: of a fixed body, or a load group that changed.

    Parameters
    ----------
    name : str
    body : str
        Fixed body that moves: ground, a foundation, an abutment.
    direction : vector, optional
        Direction of its translation, scaled to length one: the motion is then in m.
    rotation : float or vector, optional
        Sense of its rotation: 1 or -1 in the plane, an axis in space, scaled to length one: the motion is in rad.
    about : point, optional
        Point about which it turns [m]; by default the centroid of the body.
    group : str
        Instead of a body, a load group of the model: loads whose factor changes, supports that move, or temperatures.
        The motion is the change of its factor.
    base : float, optional
        Factor of that group before it changed: by default 1 of loads, 0 of supports and temperatures.
    times : int
        How often the group's factor went by the motion and came back, after everything else, before anything was
        measured: what friction has kept of it is measured then, such as after summers. 0: it went and stayed.
    low, high : float
        Smallest and largest motion that can be meant, such as ``low=0`` of a pier that sinks and does not rise.

    Raises
    ------
    InputError
        Not exactly one of a translation, a rotation and a group is given, or bounds that leave nothing.

    Examples
    --------
    >>> import concio
    >>> sinks = concio.Candidate("pier 3 sinks", body="ground 3", direction=(0, -1), low=0.0)
    >>> sinks.quantity
    'motion'
    """

    name: str
    body: str = ""
    direction: Point = ()
    rotation: float | Point = 0.0
    about: Point | None = None
    group: str = ""
    base: float | None = None
    times: int = 0
    low: float = -math.inf
    high: float = math.inf

    def __post_init__(self) -> None:
        where = f"candidate '{self.name}'"
        unit = {"motion": "length", "rotation": "angle", "number": "number"}[self.quantity]
        for key in ("low", "high"):
            object.__setattr__(self, key, quantity(getattr(self, key), unit, where=f"{where}, {key}"))
        if isinstance(self.rotation, Sequence):
            object.__setattr__(self, "rotation", tuple(self.rotation))
        turns = any(self.rotation) if isinstance(self.rotation, tuple) else bool(self.rotation)
        if (bool(self.body) == bool(self.group)) or (self.body and turns == bool(any(self.direction))):
            msg = "exactly one of a translation, a rotation and a load group must be given"
            hint = "body with direction = [0, -1]; body with rotation = 1; or group = the name of a load group"
            raise InputError(msg, where=where, hint=hint)
        if self.group and (turns or self.direction or self.about is not None):
            msg = "a load group has no direction and no rotation"
            raise InputError(msg, where=where, hint="leave them out, or name a body")
        if not self.low <= 0.0 <= self.high or self.low == self.high:
            msg = f"the motion must be allowed to be zero and something else, not {self.low:g} to {self.high:g}"
            raise InputError(msg, where=where, hint="low is zero or negative, high zero or positive")
        if self.times < 0 or (self.times and not self.group):
            msg = f"times = {self.times} is the number of times that a load group was applied and removed"
            raise InputError(msg, where=where, hint="leave it out, or name a group")
        if self.base is not None and not (self.group and math.isfinite(self.base)):
            msg = "base is the finite factor of a load group"
            raise InputError(msg, where=where, hint="leave it out, or name a group")

    @property
    def quantity(self) -> str:
        """Kind of quantity for units: "motion", "rotation" or "number"."""
        if self.group:
            return "number"
        return "motion" if self.direction else "rotation"

    @property
    def mover(self) -> str:
        """What moves: the body, or the load group."""
        return self.body or self.group
