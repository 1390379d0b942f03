"""Numbers as people write them, in the units a reader chose: for text, figures and reports.

What programs read (``--json``, CSV tables, results, arrays) stays in kN and m; every number for people goes through
:class:`Units`, which says its unit and writes no dust: what is below a millionth of the numbers it stands beside is 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields

from concio.arguments import closest, strict_class
from concio.errors import InputError
from concio.units import KINDS, unit_of

DUST = 1e-6
"""Share of the size of a set of numbers below which one of them is written as 0."""

STRESS_MPA, STRESS_GPA = 1e3, 1e6
"""Stresses from which on they are reported in MPa and moduli in GPa [kN/m2]."""

SHORT = 0.01
"""Lengths in m below this are reported in mm [m]."""

CHOICES: dict[str, tuple[str, ...]] = {
    "force": ("kN", "N", "MN", "kgf", "tf"),
    "length": ("m", "cm", "mm", "ft", "in"),
    "motion": ("mm", "m", "cm", "in"),
    "stress": ("auto", "kN/m2", "MPa", "N/mm2", "kPa", "Pa", "bar", "kgf/cm2", "tf/m2"),
}
"""Units that may be chosen for each kind of quantity, the default first."""


def number(value: float, digits: int = 3, *, size: float = 0.0) -> str:
    """Return a number as text: three digits, separators in large ones, no dust, no minus zero.

    Parameters
    ----------
    value : float
    digits : int
        Digits that count.
    size : float
        Size of the numbers it stands beside; what is a millionth of it or less is 0.
    """
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "unlimited" if value > 0 else "-unlimited"
    if value == 0 or abs(value) <= DUST * size:
        return "0"
    power = math.floor(math.log10(abs(value)))
    if power >= digits:
        whole = float(f"{value:.{digits + 1}g}")
        return f"{whole:,.0f}" if abs(whole) >= 1e4 else f"{whole:.0f}"
    if power >= -4:
        return f"{value:.{digits}g}" if power < digits - 1 else f"{value:.0f}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


def counted(count: int, one: str, several: str | None = None) -> str:
    """Return a number and its noun, such as ``"1 joint"`` or ``"1,024 joints"``."""
    return f"{count:,} {one if count == 1 else several or one + 's'}"


@strict_class
@dataclass(frozen=True)
class Units:
    """Units in which quantities are reported.

    Parameters
    ----------
    force : str
        "kN", "N", "MN", "kgf" or "tf".
    length : str
        "m", "cm", "mm", "ft" or "in": coordinates and sizes.
    motion : str
        "mm", "m", "cm" or "in": displacements, openings, slips.
    stress : str
        "auto" tells stresses in kN/m2 where they are small and in MPa where they are not, moduli in MPa or GPa; or
        "kN/m2", "MPa", "N/mm2", "kPa", "Pa", "bar", "kgf/cm2", "tf/m2".

    Raises
    ------
    InputError
        A unit is not among these.

    Examples
    --------
    1 kgf is 9.80665 N:

    >>> import concio
    >>> concio.Units(force="kgf").text("force", 9.80665)
    '1000 kgf'
    >>> concio.Units.parse("force = N, motion = cm").text("motion", 0.0123)
    '1.23 cm'
    """

    force: str = "kN"
    length: str = "m"
    motion: str = "mm"
    stress: str = "auto"

    def __post_init__(self) -> None:
        for key, allowed in CHOICES.items():
            value = getattr(self, key)
            if value not in allowed:
                msg = f"'{value}' is not a unit of {key} for reports"
                raise InputError(msg, where=key, hint="one of: " + ", ".join(allowed))

    @classmethod
    def parse(cls, text: str) -> Units:
        """Return units from a text such as ``"N, mm, MPa"`` or ``"force = N, motion = cm"``.

        Raises
        ------
        InputError
            A part of it is not a unit of a force, a length or a stress.
        """
        found: dict[str, str] = {}
        for part in filter(None, (p.strip() for p in text.split(","))):
            key, sign, unit = (p.strip() for p in part.partition("="))
            if not sign:
                key, unit = next((k for k, allowed in CHOICES.items() if part in allowed), ""), part
            if key not in CHOICES:
                units = dict.fromkeys(u for allowed in CHOICES.values() for u in allowed)
                msg = f"'{part}' is not a unit for reports"
                raise InputError(msg, where="units", hint=closest(part, units, names="one of"))
            found[key] = unit
        return cls(**found)

    def factor(self, kind: str, size: float = 0.0) -> tuple[float, str]:
        """Return what to multiply values in kN and m by, and the symbol of the unit they then have.

        Parameters
        ----------
        kind : str
            "force", "length", "motion", "stress", "modulus", "rotation", "compliance", or a kind of
            :data:`concio.units.KINDS`.
        size : float
            Largest of the values: chooses between units of one kind.
        """
        if kind == "rotation":
            return 1e3, "mrad"
        if kind in ("force", "length"):
            symbol = getattr(self, kind)
            if symbol == "m" and 0 < abs(size) < SHORT:
                symbol = "mm"
        elif kind == "motion":
            small = self.motion == "mm" and 0 < abs(size) < 1e-6
            return (1e6, "µm") if small else (1.0 / unit_of(self.motion), self.motion)
        elif kind in ("stress", "modulus"):
            symbol = self.stress
            if symbol == "auto" or (kind == "modulus" and symbol == "MPa"):
                symbol = _stress_symbol(abs(size), modulus=kind == "modulus")
        elif kind == "compliance":
            symbol = f"{self.motion}/{self.force}"
        else:
            symbol = _composed(*KINDS[kind], self.force, self.length)
        return (1.0 / unit_of(symbol) if symbol else 1.0), symbol

    def text(self, kind: str, value: float, digits: int = 3, *, size: float = 0.0, sign: bool = False) -> str:
        """Return a quantity in kN and m as text with its unit, such as ``"12.3 kN"``.

        Parameters
        ----------
        kind : str
            As in :meth:`factor`.
        value : float
        digits : int
        size : float
            Size of the quantities it stands beside.
        sign : bool
            Whether a positive number has its sign.

        Examples
        --------
        >>> import concio
        >>> concio.Units(motion="cm").text("motion", 0.0123)
        '1.23 cm'
        """
        factor, symbol = self.factor(kind, size or value)
        told = number(factor * value, digits, size=factor * size)
        plus = "+" if sign and value > 0 and told != "0" else ""
        return f"{plus}{told} {symbol}".strip()

    def force_vector(self, value: Sequence[float], *, size: float = 0.0) -> str:
        """Return a force (x, y) or (x, y, z) as text: ``"+1.5 kN along x, -20 kN along y"``; ``size`` as above."""
        size = max(size, math.hypot(*value))
        told = (self.text("force", v, 4, size=size, sign=True) for v in value)
        return ", ".join(f"{text} along {axis}" for text, axis in zip(told, "xyz", strict=False))

    def column(self, kind: str, values: Iterable[float], digits: int = 4) -> tuple[list[str], str]:
        """Return quantities of one kind with equal decimals, and the symbol of their unit.

        Parameters
        ----------
        kind : str
            As in :meth:`factor`.
        values : iterable of float
        digits : int
            Digits of the largest.
        """
        listed = [float(v) for v in values]
        largest = max((abs(v) for v in listed if math.isfinite(v)), default=0.0)
        factor, symbol = self.factor(kind, largest)
        power = math.floor(math.log10(factor * largest)) if largest > 0 else 0
        decimals = min(max(digits - 1 - power, 0), 9)
        return [_fixed(factor * v, decimals, DUST * factor * largest) for v in listed], symbol


def _fixed(value: float, decimals: int, dust: float) -> str:
    if not math.isfinite(value):
        return number(value)
    if abs(value) <= dust:
        return "0"
    text = f"{value:,.{decimals}f}" if abs(value) >= 1e4 else f"{value:.{decimals}f}"
    return text if text.strip("-0.,") else "0"


def _stress_symbol(size: float, *, modulus: bool) -> str:
    if modulus:
        return "GPa" if size >= STRESS_GPA else "MPa" if size >= STRESS_MPA else "kN/m2"
    return "MPa" if size >= STRESS_MPA else "kN/m2"


def _composed(force: int, length: int, force_unit: str, length_unit: str) -> str:
    """Return the symbol of a unit of forces and lengths to some power."""

    def power(unit: str, exponent: int) -> str:
        return unit if exponent == 1 else f"{unit}{exponent}"

    above = [power(u, e) for u, e in ((force_unit, force), (length_unit, length)) if e > 0]
    below = [power(u, -e) for u, e in ((force_unit, force), (length_unit, length)) if e < 0]
    return " ".join(above or ["1"] * bool(below)) + "".join(f"/{unit}" for unit in below)


DEFAULT = Units()
"""kN, m, motions in mm, stresses in kN/m2 or MPa."""

KEYS = tuple(f.name for f in fields(Units))
"""What can be chosen."""
