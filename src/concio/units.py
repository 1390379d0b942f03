"""Values with units: ``"100 MPa"``, ``"20 kN/m3"``, ``"5 mm"`` become numbers in kN and m.

A bare number is taken to be in the consistent system already (kN, m, and what follows from them).
"""

from __future__ import annotations

import math
import re

from concio.errors import InputError

_FORCE = {"N": 1e-3, "kN": 1.0, "MN": 1e3, "kgf": 9.80665e-3, "tf": 9.80665}
_LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3, "in": 0.0254, "ft": 0.3048}
_STRESS = {"Pa": 1e-3, "kPa": 1.0, "MPa": 1e3, "GPa": 1e6, "bar": 100.0}

# exponents of (force, length)
KINDS: dict[str, tuple[int, int]] = {
    "number": (0, 0),
    "length": (0, 1),
    "area": (0, 2),
    "force": (1, 0),
    "line load": (1, -1),
    "stress": (1, -2),
    "unit weight": (1, -3),
    "joint stiffness": (1, -3),
    "stiffness": (1, -1),
    "moment": (1, 1),
}
"""Kinds of quantity, with the exponents of force and length."""

SYMBOL: dict[str, str] = {
    "number": "-",
    "length": "m",
    "area": "m2",
    "force": "kN",
    "line load": "kN/m",
    "stress": "kN/m2",
    "unit weight": "kN/m3",
    "joint stiffness": "kN/m3",
    "stiffness": "kN/m",
    "moment": "kN m",
}
"""Unit in which concio keeps and prints each kind."""

_VALUE = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf|nan)\s*(.*?)\s*$")
_ATOM = re.compile(r"^([A-Za-z]+)(?:\^|\*\*)?([23])?$")


def _unit(text: str) -> tuple[float, int, int] | None:
    """Return factor and exponents of force and length of a unit such as ``kN/m2``; None where unknown."""
    text = text.replace("²", "2").replace("³", "3").replace("·", " ").replace("*", " ")
    factor, force, length = 1.0, 0, 0
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
            else:
                return None
    return factor, force, length


def quantity(value: float | str, kind: str, *, where: str | None = None) -> float:
    """Return ``value`` as a number in kN and m.

    Parameters
    ----------
    value : float or str
        A number, or a text with a unit such as ``"100 MPa"``.
    kind : str
        One of :data:`KINDS`.
    where : str, optional
        Name used in the message of an error.

    Raises
    ------
    InputError
        Not a number, a unit that is not known, or a unit of another kind.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        try:
            value = float(value)
        except (TypeError, ValueError):
            msg = f"{value!r} is not a number"
            raise InputError(msg, where=where) from None
    if not isinstance(value, str):
        number, unit = float(value), ""
    else:
        match = _VALUE.match(value)
        if match is None:
            msg = f"'{value}' is not a number with a unit"
            example = "1.5" if kind == "number" else f"'1.5 {SYMBOL[kind]}'"
            raise InputError(msg, where=where, hint=f"write for example {example}")
        number, unit = float(match.group(1)), match.group(2)
    if math.isnan(number):
        msg = "the value is not a number (NaN)"
        raise InputError(msg, where=where, hint="give a finite value")
    if not unit or unit == "-":
        return number
    found = _unit(unit)
    if found is None:
        msg = f"unknown unit '{unit}' in '{value}'"
        if re.match(r",\d", unit):
            raise InputError(msg, where=where, hint="decimals are set off by a point, not by a comma: 1.5, not 1,5")
        hint = f"use {SYMBOL[kind]}, or N, kN, MN, m, cm, mm, Pa, kPa, MPa, GPa combined as in 'kN/m2'"
        raise InputError(msg, where=where, hint=hint)
    factor, *exponents = found
    if tuple(exponents) != KINDS[kind]:
        msg = f"'{value}' is not a {kind}" if kind != "number" else f"'{value}' must be a plain number"
        raise InputError(msg, where=where, hint=f"expected a unit like {SYMBOL[kind]}")
    return number * factor
