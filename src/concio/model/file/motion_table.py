"""The table ``[motion]`` of a model file: how the ground moves, and how the motion is to be computed.

It says nothing of the structure: ``concio.load`` checks it and leaves it at that; ``concio shake`` reads it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import (
    BeforeValidator,
    Field,
    StrictBool,
    StrictStr,
    ValidationError,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
)

from concio.errors import InputError
from concio.model.file.file_errors import first_fault
from concio.model.file.tables import Name, Table
from concio.model.file.values import FileUnits, Length, fault, units_of
from concio.model.motion.records import STANDARD_GRAVITY, read_record
from concio.model.motion.signals import Pulse, Record
from concio.model.stages import ControlPoint

TIMES = {"s": 1.0, "ms": 1e-3, "min": 60.0}
SPEEDS = {"m/s": 1.0, "cm/s": 0.01, "mm/s": 1e-3}
SPINS = {"rad/s": 1.0, "deg/s": math.pi / 180}
ACCELERATIONS = {"m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01, "g": STANDARD_GRAVITY}
_QUANTITY = re.compile(r"\s*([-+0-9.eE]+)\s*([a-zA-Z/0-9]*)\s*")


def with_unit(value: Any, units: Mapping[str, float], what: str) -> Any:
    """Return a number, given plainly or with one of the units, in s or m/s2; anything else as it is.

    Raises
    ------
    ValueError
        A text that is not a number with such a unit.
    """
    if not isinstance(value, str):
        return value
    found = _QUANTITY.fullmatch(value)
    try:
        size = float(found.group(1)) if found else None
    except ValueError:
        size = None
    if found is None or size is None or (found.group(2) and found.group(2) not in units):
        article = "an" if what[0] in "aeiou" else "a"
        msg = f"'{value}' is not {article} {what}: write a number with one of {', '.join(units)}"
        raise ValueError(msg)
    return size * units.get(found.group(2), 1.0)


def seconds(value: Any) -> Any:
    """Return a time in s."""
    return with_unit(value, TIMES, "time")


def acceleration(value: Any) -> Any:
    """Return an acceleration in m/s2."""
    return with_unit(value, ACCELERATIONS, "acceleration")


def _refuse_bare(value: Any, info: ValidationInfo, form: str) -> None:
    """Refuse a bare number in a file that is not in m: m and the unit of the file are as likely meant."""
    found = value if isinstance(value, str) else repr(value)
    bare = isinstance(value, int | float | str) and re.search("[a-zA-Z]", re.sub("[eE][-+]?[0-9]", "", found)) is None
    if bare and units_of(info).length != 1.0 and float(value) != 0:
        msg = f"{value} has no unit, and this file has units of its own"
        raise fault(msg, f"write its unit, as in {form}")


def _acceleration(value: Any, info: ValidationInfo) -> Any:
    _refuse_bare(value, info, "'0.4 g' or '3.9 m/s2'")
    return acceleration(value)


_PUBLISHED = WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})
Time = Annotated[float, BeforeValidator(seconds), _PUBLISHED]
Acceleration = Annotated[float, BeforeValidator(_acceleration), _PUBLISHED]


class PulseTable(Table):
    """A pulse by name; see :class:`concio.Pulse`."""

    shape: Literal["rectangular", "half sine", "sine", "ricker"]
    amplitude: Acceleration
    length: Time
    cycles: float = 1.0


class MotionPoint(Table):
    """A point whose displacement is kept at every step.

    Keys
    ----
    body :
        Name of the block.
    at :
        The point, where it is at the start: x, y, in space also z.
    direction :
        Direction in which the displacement is positive; without it along x.
    """

    body: Name
    at: tuple[Length, Length] | tuple[Length, Length, Length]
    direction: tuple[float, float] | tuple[float, float, float] = (1.0, 0.0)


class MotionTable(Table):
    """The arguments of :func:`concio.dynamics`.

    Keys
    ----
    record :
        File of accelerations along x, beside the model file.
    transverse :
        The same along y, in space.
    vertical :
        The same along y in the plane, along z in space.
    unit :
        Unit of the accelerations, where the file does not say it.
    record_step :
        Time from one value of the record to the next, where the file does not say it.
    pulse :
        A pulse along x, in place of a record.
    velocities :
        Initial velocities in m/s, then rad/s, or texts with a unit.
    """

    record: StrictStr | None = None
    transverse: StrictStr | None = None
    vertical: StrictStr | None = None
    unit: StrictStr | None = None
    record_step: Time | None = None
    pulse: PulseTable | None = None
    scale: float = 1.0
    duration: Time | None = None
    step: Time | None = None
    restitution: float | None = None
    theta: float | None = None
    mass_damping: float | None = None
    stiffness_damping: float | None = None
    gravity: Acceleration | None = None
    base: Literal["inertia", "moving"] | None = None
    start: Literal["equilibrium", "as described"] | None = None
    adaptive: StrictBool | None = None
    velocities: dict[str, list[StrictStr | float]] = Field(default_factory=dict)
    points: list[MotionPoint] = Field(default_factory=list)

    @field_validator("velocities", mode="after")
    @classmethod
    def _said(cls, value: dict[str, list[Any]], info: ValidationInfo) -> dict[str, list[Any]]:
        for parts in value.values():
            for part in parts[:3]:
                _refuse_bare(part, info, "['200 mm/s', '0 m/s', '0.1 rad/s']")
        return value

    def ground(self, folder: Path, dim: int) -> dict[str, Pulse | Record]:
        """Return the ground motion by component, of a model in the plane or in space.

        Raises
        ------
        InputError
            A record cannot be read, or there is a record and a pulse, or a transverse one in the plane.
        """
        if self.record is not None and self.pulse is not None:
            msg = "there is a record and a pulse along x"
            raise InputError(msg, where="[motion]", hint="keep one of them")
        idle = [key for key in ("unit", "record_step") if getattr(self, key) is not None]
        if idle and self.record is self.transverse is self.vertical is None:
            msg = f"{idle[0]} is that of records, and no record is named"
            raise InputError(msg, where="[motion]", hint="name the record, or leave it out")
        found: dict[str, Pulse | Record] = {}
        for axis, name in records_by_axis(self.record, self.transverse, self.vertical, dim, "[motion]"):
            if name is not None:
                found[axis] = read_record(folder / name, unit=self.unit, step=self.record_step)
        if self.pulse is not None:
            p = self.pulse
            found["x"] = Pulse(p.shape, p.amplitude, p.length, p.cycles)
        return found

    def arguments(self, dim: int) -> dict[str, Any]:
        """Return the arguments of :func:`concio.dynamics` that the file states, without the ground motion.

        Raises
        ------
        InputError
            A velocity has a unit that does not fit in a model of that dimension.
        """
        names = (
            "duration", "step", "restitution", "theta", "mass_damping", "stiffness_damping", "gravity", "base", "start",
            "adaptive",
        )  # fmt: skip
        found: dict[str, Any] = {n: getattr(self, n) for n in names if getattr(self, n) is not None}
        if self.velocities:
            found["velocities"] = {body: _velocity(parts, dim, body) for body, parts in self.velocities.items()}
        if self.points:
            found["points"] = tuple(ControlPoint(p.body, p.at, p.direction) for p in self.points)
        return found


def _velocity(parts: list[Any], dim: int, body: str) -> list[float]:
    """Return the velocity of a body [m/s, rad/s]: one of its centroid along each axis, then its spin."""
    try:
        return [float(with_unit(part, SPEEDS, "velocity") if k < dim else with_unit(part, SPINS, "rate of rotation"))
                for k, part in enumerate(parts)]  # fmt: skip
    except ValueError as error:
        raise InputError(str(error), where=f"[motion] velocities, '{body}'") from None


T = TypeVar("T")


def records_by_axis(
    along: T | None, transverse: T | None, vertical: T | None, dim: int, where: str
) -> tuple[tuple[str, T | None], ...]:
    """Return records with the axes along which they move a model of that dimension.

    Raises
    ------
    InputError
        There is a transverse record and the model is in the plane.
    """
    if dim == 2 and transverse is not None:
        msg = "there is a transverse record, and the model is in the plane"
        raise InputError(msg, where=where, hint="along the plane is x; leave it out")
    return (("x", along), ("y", vertical)) if dim == 2 else (("x", along), ("y", transverse), ("z", vertical))


Motion = Annotated[MotionTable | None, Field(description="ground motion and time stepping; see concio shake")]


def motion_table(data: Mapping[str, Any], where: str, units: FileUnits | None = None) -> MotionTable:
    """Return the table ``[motion]`` of the tables of a file, checked; an empty one where there is none.

    Raises
    ------
    InputError
        It holds a key that is not known, or a value that does not fit.
    """
    try:
        return MotionTable.model_validate(data.get("motion", {}), context={"units": units or FileUnits()})
    except ValidationError as error:
        raise first_fault(error, data["motion"], MotionTable, f"{where}, [motion]") from None
