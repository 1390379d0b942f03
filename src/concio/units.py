"""Values with units: ``"100 MPa"``, ``"20 kN/m3"``, ``"5 mm"`` become numbers in kN and m.

A bare number is taken to be in the consistent system already (kN, m, and what follows from them). A coefficient of
friction may be given as its angle (``"31 deg"``), a weight per volume as a mass per volume (``"2100 kg/m3"``).
"""

from __future__ import annotations

import math
import re

from concio.errors import InputError

_FORCE = {"N": 1e-3, "kN": 1.0, "MN": 1e3, "kgf": 9.80665e-3, "tf": 9.80665}
_LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3, "in": 0.0254, "ft": 0.3048}
_MASS = {"g": 1e-6, "kg": 1e-3, "t": 1.0}
_ANGLE = {"deg": math.pi / 180, "degree": math.pi / 180, "degrees": math.pi / 180, "gon": math.pi / 200, "rad": 1.0,
          "mrad": 1e-3}  # fmt: skip
_STRESS = {"Pa": 1e-3, "kPa": 1.0, "MPa": 1e3, "GPa": 1e6, "bar": 100.0}

# exponents of (force, length)
KINDS: dict[str, tuple[int, int]] = {
    "number": (0, 0),
    "friction": (0, 0),
    "angle": (0, 0),
    "length": (0, 1),
    "area": (0, 2),
    "force": (1, 0),
    "line load": (1, -1),
    "stress": (1, -2),
    "unit weight": (1, -3),
    "joint stiffness": (1, -3),
    "stiffness": (1, -1),
    "moment": (1, 1),
    "temperature": (0, 0),
    "temperature gradient": (0, -1),
    "expansion": (0, 0),
}
"""Kinds of quantity, with the exponents of force and length."""

SYMBOL: dict[str, str] = {
    "number": "-",
    "friction": "-",
    "angle": "rad",
    "length": "m",
    "area": "m2",
    "force": "kN",
    "line load": "kN/m",
    "stress": "kN/m2",
    "unit weight": "kN/m3",
    "joint stiffness": "kN/m3",
    "stiffness": "kN/m",
    "moment": "kN m",
    "temperature": "K",
    "temperature gradient": "K/m",
    "expansion": "1/K",
}
"""Unit in which concio keeps and prints each kind."""

_KELVIN: dict[str, dict[str, float]] = {
    "temperature": {"K": 1.0},
    "temperature gradient": {"K/m": 1.0, "K/cm": 100.0, "K/mm": 1000.0},
    "expansion": {"1/K": 1.0, "/K": 1.0, "K-1": 1.0, "K^-1": 1.0},
}
"""Units of changes of temperature; degrees Celsius are kelvins there."""

_VALUE = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf|nan)\s*(.*?)\s*$")
_ATOM = re.compile(r"^([A-Za-z]+)(?:\^|\*\*)?([23])?$")


GRAVITY = 9.80665
"""Standard gravity [m/s2]."""
DECIMAL_COMMA = "the decimal separator is a point, not a comma: 1.5, not 1,5"
"""What to do about ``1,5``."""
HEADING = re.compile(r"^\s*(?P<name>[^\[\]]+?)\s*(?:\[(?P<unit>[^\[\]]*)\])?\s*$")
"""Heading of a column, perhaps with a unit: ``value [mm]``."""


def _unit(text: str) -> tuple[float, int, int, int] | None:
    """Return factor and exponents of force, length and mass of a unit such as ``kN/m2``; None where unknown."""
    text = text.replace("²", "2").replace("³", "3").replace("·", " ").replace("*", " ")
    factor, force, length, mass = 1.0, 0, 0, 0
    for position, part in enumerate(text.split("/")):
        sign = 1 if position == 0 else -1
        for atom in part.split():
            if atom == "1":
                continue
            match = _ATOM.match(atom)
            if match is None:
                return None
            name, power = match.group(1), sign * int(match.group(2) or 1)
            if name in _FORCE:
                factor, force = factor * _FORCE[name] ** power, force + power
            elif name in _LENGTH:
                factor, length = factor * _LENGTH[name] ** power, length + power
            elif name in _STRESS:
                factor, force, length = factor * _STRESS[name] ** power, force + power, length - 2 * power
            elif name in _MASS:
                factor, mass = factor * _MASS[name] ** power, mass + power
            else:
                return None
    return factor, force, length, mass


def unit_of(symbol: str) -> float:
    """Return a unit such as ``"MPa"`` or ``"N/mm2"`` in kN and m.

    Raises
    ------
    InputError
        The unit is not known.
    """
    found = _unit(symbol)
    if found is None:
        msg = f"unknown unit '{_short(symbol)}'"
        raise InputError(msg, hint="for example kN, m, MPa or kN/m3")
    return found[0]


def degrees(value: float | str, *, where: str | None = None) -> float:
    """Return an angle in degrees: a bare number is in degrees already, a text may say another unit.

    Raises
    ------
    InputError
        As :func:`quantity`.
    """
    if isinstance(value, str) and re.search(r"[A-Za-z]\s*$", value):
        return math.degrees(quantity(value, "angle", where=where))
    return quantity(value, "number", where=where)


LARGEST = 1e30
"""No quantity of a structure is larger in kN and m, infinite ones apart: products of such numbers are still numbers."""


def quantity(value: float | str, kind: str, *, where: str | None = None) -> float:
    """Return ``value`` as a number in kN and m.

    Parameters
    ----------
    value : float or str
        A number, or a text with a unit such as ``"100 MPa"``.
    kind : str
        One of :data:`KINDS`. Friction takes an angle too, and gives its tangent; a unit weight takes a mass per volume.
    where : str, optional
        Name used in the message of an error.

    Raises
    ------
    InputError
        Not a number, a number beyond any structure's, a unit that is not known, or a unit of another kind.
    """
    number = _read(value, kind, where)
    if LARGEST < abs(number) < math.inf:
        msg = f"{number:g} is a number that no structure has"
        raise InputError(msg, where=where, hint="look at the number, and at its unit")
    return number


def is_bare(text: str) -> bool:
    """Return whether a quantity is a number without a unit."""
    match = _VALUE.match(text)
    return match is not None and not match.group(2)


def _read(value: float | str, kind: str, where: str | None) -> float:
    if not isinstance(value, str):
        try:
            number, unit = float(value), ""
        except (TypeError, ValueError):
            msg = f"{value!r} is not a number"
            raise InputError(msg, where=where) from None
        except OverflowError:
            msg = "the number is too large"
            raise InputError(msg, where=where, hint="give a finite value") from None
    else:
        match = _VALUE.match(value)
        if match is None:
            msg = f"'{_short(value)}' is not a number with a unit"
            example = "1.5" if SYMBOL[kind] == "-" else f"'1.5 {SYMBOL[kind]}'"
            hint = DECIMAL_COMMA if re.match(r"\s*[-+]?\d*,\d", value) else f"write for example {example}"
            raise InputError(msg, where=where, hint=hint)
        number, unit = float(match.group(1)), match.group(2)
    if math.isnan(number):
        msg = "the value is not a number (NaN)"
        raise InputError(msg, where=where, hint="give a finite value")
    if not unit or (unit == "-" and SYMBOL[kind] == "-"):
        return number
    if kind in _KELVIN:
        return number * _kelvin(unit, kind, value, where)
    angle = _ANGLE.get(unit.replace("°", "deg"))
    if angle is not None and kind in ("friction", "angle"):
        return number * angle if kind == "angle" else _tangent(number * angle, str(value), where)
    found = _unit(unit)
    if found is None and not (angle is not None and kind == "number"):
        msg = f"unknown unit '{_short(unit)}' in '{_short(str(value))}'"
        if re.match(r",\d", unit):
            raise InputError(msg, where=where, hint=DECIMAL_COMMA)
        hint = f"use {SYMBOL[kind]}, or another unit made of N, kN, MN, m, cm, mm, Pa, kPa, MPa, GPa, such as 'kN/m2'"
        if SYMBOL[kind] == "-":
            hint = "leave the unit out" + (", or give the angle: '31 deg'" if kind == "friction" else "")
        raise InputError(msg, where=where, hint=hint)
    factor, force, length, mass = found or (1.0, 0, 1, 0)
    if kind == "unit weight" and (force, length, mass) == (0, -3, 1):
        return number * factor * GRAVITY
    if mass or (force, length) != KINDS[kind]:
        plain = SYMBOL[kind] == "-"
        article = "an" if kind[0] in "ae" else "a"
        told = f"'{_short(str(value))}'"
        msg = f"{told} must be a plain number" if plain else f"{told} is not {article} {kind}"
        expected = None if plain else f"expected a unit like {SYMBOL[kind]}"
        masses = "kg, g and t are masses: write N, kN or kgf for a force"
        raise InputError(msg, where=where, hint=masses if mass else expected)
    return number * factor


def _kelvin(unit: str, kind: str, value: float | str, where: str | None) -> float:
    """Return the factor of a unit of temperature."""
    known = _KELVIN[kind]
    found = known.get(re.sub("°C|degC", "K", unit.replace(" ", "")))
    if found is None:
        msg = f"'{_short(str(value))}' is not a {kind}"
        raise InputError(msg, where=where, hint=f"expected a unit like {SYMBOL[kind]}")
    return found


def _tangent(angle: float, value: str, where: str | None) -> float:
    if not 0 <= angle < math.pi / 2:
        msg = f"'{_short(value)}' is not an angle of friction"
        raise InputError(msg, where=where, hint="it lies between 0 and 90 degrees; stones have some 30 to 40")
    return math.tan(angle)


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
