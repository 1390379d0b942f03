"""Values of a model file: numbers in the file's own consistent system, or texts with a unit.

A file states its system in ``[units]``; without that table it is kN and m. A bare number is taken to be in that system,
whatever its kind: with ``force = "N"`` and ``length = "mm"`` a bare stress is in N/mm2. A text such as ``"100 MPa"``
says its unit itself. Inside concio everything is in kN and m.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from concio.errors import InputError
from concio.units import KINDS, SYMBOL, degrees, quantity


@dataclass(frozen=True)
class FileUnits:
    """Consistent system of a file: its units of force and of length in kN and in m."""

    force: float = 1.0
    length: float = 1.0

    def factor(self, kind: str) -> float:
        """Return what one unit of a bare number of ``kind`` is in kN and m."""
        force, length = KINDS[kind]
        return self.force**force * self.length**length


def converted(value: Any, kind: str, units: FileUnits) -> float:
    """Return a value of a file in kN and m.

    Raises
    ------
    PydanticCustomError
        Not a finite number, or a unit that does not fit; the message is in its context.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        what = f"{_shown(value)} is not a number"
        raise fault(what, f"write a number in {SYMBOL[kind]}, or a text with a unit")
    try:
        number = quantity(value, kind)
    except InputError as error:
        raise fault(error.what, error.hint) from None
    if not math.isfinite(number):
        what = f"{value} is not a finite number"
        raise fault(what, "give a finite value")
    return number * units.factor(kind) if _is_bare(value) else number


def _is_bare(value: int | float | str) -> bool:
    try:
        float(value)
    except ValueError:
        return False
    return True


def _shown(value: Any) -> str:
    text = {True: "true", False: "false"}[value] if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def fault(what: str, hint: str | None) -> PydanticCustomError:
    """Return the error of a value that is not what a file may say."""
    return PydanticCustomError("concio", "{what}", {"what": what, "hint": hint or ""})


def units_of(info: ValidationInfo) -> FileUnits:
    """Return the system of the file that is being validated."""
    context = info.context or {}
    units: FileUnits = context.get("units", FileUnits())
    return units


def _converter(kind: str) -> Callable[[Any, ValidationInfo], float]:
    def convert(value: Any, info: ValidationInfo) -> float:
        return converted(value, kind, units_of(info))

    return convert


def _schema(kind: str) -> dict[str, Any]:
    if kind == "number":
        return {"type": "number"}
    if kind in ("friction", "angle"):
        text = "a number, or an angle with a unit such as '31 deg'"
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "description": text}
    text = f"{kind}: a number in the file's system ({SYMBOL[kind]} by default), or a text with a unit"
    return {"anyOf": [{"type": "number"}, {"type": "string"}], "description": text}


Number = Annotated[float, BeforeValidator(_converter("number")), WithJsonSchema(_schema("number"))]
Coefficient = Annotated[float, BeforeValidator(_converter("friction")), WithJsonSchema(_schema("friction"))]
Angle = Annotated[float, BeforeValidator(_converter("angle")), WithJsonSchema(_schema("angle"))]
Length = Annotated[float, BeforeValidator(_converter("length")), WithJsonSchema(_schema("length"))]
Area = Annotated[float, BeforeValidator(_converter("area")), WithJsonSchema(_schema("area"))]
Force = Annotated[float, BeforeValidator(_converter("force")), WithJsonSchema(_schema("force"))]
Stress = Annotated[float, BeforeValidator(_converter("stress")), WithJsonSchema(_schema("stress"))]
UnitWeight = Annotated[float, BeforeValidator(_converter("unit weight")), WithJsonSchema(_schema("unit weight"))]
JointStiffness = Annotated[
    float, BeforeValidator(_converter("joint stiffness")), WithJsonSchema(_schema("joint stiffness"))
]
Stiffness = Annotated[float, BeforeValidator(_converter("stiffness")), WithJsonSchema(_schema("stiffness"))]
Kelvin = Annotated[float, BeforeValidator(_converter("temperature")), WithJsonSchema(_schema("temperature"))]
KelvinGradient = Annotated[
    float, BeforeValidator(_converter("temperature gradient")), WithJsonSchema(_schema("temperature gradient"))
]
Expansion = Annotated[float, BeforeValidator(_converter("expansion")), WithJsonSchema(_schema("expansion"))]

SMALLEST, LARGEST = 1e-9, 1e7
"""Sizes of a structure lie between these, or are zero [m]."""


def _size(value: float) -> float:
    if value != 0 and not (SMALLEST <= abs(value) <= LARGEST):
        msg = f"{value:g} m is not a size of a structure"
        raise fault(msg, f"sizes lie between {SMALLEST:g} and {LARGEST:g} m")
    return value


def _degrees(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        what = f"{_shown(value)} is not an angle"
        raise fault(what, "write a number of degrees, or a text with a unit")
    try:
        return degrees(value)
    except InputError as error:
        raise fault(error.what, error.hint) from None


Degrees = Annotated[
    float,
    BeforeValidator(_degrees),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}], "description": "degrees, or another unit"}),
]
Size = Annotated[Length, AfterValidator(_size)]
"""A length that a generator works with: coordinates of outlines may hold rounding errors, sizes may not."""

TYPES: dict[str, Any] = {
    "number": Number,
    "friction": Coefficient,
    "degrees": Degrees,
    "length": Size,
    "force": Force,
    "stress": Stress,
    "unit weight": UnitWeight,
    "joint stiffness": JointStiffness,
    "stiffness": Stiffness,
}
"""Type of each kind of quantity in the tables of generators."""
