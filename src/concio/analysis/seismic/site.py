"""The site: how strongly the ground shakes, how often, and what the building makes of it at a height."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from concio.analysis.seismic.code import Code, find_code
from concio.analysis.seismic.floor import FloorSpectrum, Mode, Storeys
from concio.analysis.seismic.spectrum import Spectrum
from concio.arguments import closest, strict_class
from concio.errors import InputError
from concio.units import quantity

LARGEST = 1.0
"""No rock shakes harder [g]."""


@dataclass(frozen=True)
class Hazard:
    """What one return period brings.

    Parameters
    ----------
    T_R : float
        Return period [years]; ``nan`` where not stated.
    a_g : float
        Peak acceleration on rock, in g.
    F0 : float
        Largest amplification.
    T_star : float
        Tc* [s].
    filled : tuple of str
        Which of F0 and Tc were not given, and have values that are those of no site.
    """

    T_R: float
    a_g: float
    F0: float = 2.5
    T_star: float = 0.3
    filled: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not 0 < self.a_g <= LARGEST:
            msg = f"a_g = {self.a_g:g} g is not an acceleration of a site"
            hint = "a_g is a share of gravity" + (f"; was {self.a_g:g} m/s2 meant?" if self.a_g > LARGEST else "")
            raise InputError(msg, hint=hint)
        if not 1.0 <= self.F0 <= 5.0:
            msg = f"F0 = {self.F0:g} must lie between 1 and 5"
            raise InputError(msg, hint="2.2 is the least in Italy")
        if not 0.05 <= self.T_star <= 2.0:
            msg = f"Tc* = {self.T_star:g} s must lie between 0.05 and 2 s"
            raise InputError(msg)


@strict_class
@dataclass(frozen=True)
class Site:
    """A site and the limit states to check there.

    Parameters
    ----------
    hazard : mapping or sequence
        By limit state: ``{"SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}}``; or a table of return periods, a sequence of
        ``{"T_R": 475, "a_g": 0.20, "F0": 2.45, "Tc": 0.32}``, between which the logarithms are interpolated. a_g in g
        (or a text with m/s2), Tc* in s.
    soil, topography : str
        As the code names them.
    nominal_life : float
        V_N [years].
    use_class : str
        Class of use, "I" to "IV".
    code : str
        "ntc2018", "en1998", or the path of a file.
    spectrum_type : str
        Of codes with types of spectra.
    building : Storeys, Mode, a mapping, or a sequence of modes
        Modes of the building, for mechanisms that start above the ground; none where they are all checked on the
        ground. ``{"height": 6.0, "storeys": 2, "T1": 0.25, "xi": 10}`` is the first mode of a regular building, whose
        shape follows from the height of each mechanism; ``{"T": ..., "participation": ..., "shape": ..., "xi": ...}``
        one mode with its shape at the height of the mechanism.
    source : str
        Where the hazard comes from: a map, a grid with its coordinates, a study.
    assumed : tuple of str
        Which of soil, topography, nominal life and class of use were not given; reports say that they were assumed.

    Raises
    ------
    InputError
        Something is not known to the code, or is not a number of a site.

    Examples
    --------
    A nominal life of 50 years and a class of use of 1.5 make a reference life of 75 years:

    >>> import concio
    >>> site = concio.Site({"SLV": {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}}, nominal_life=50.0, use_class="III")
    >>> site.life
    75.0
    """

    hazard: Any
    soil: str = "A"
    topography: str = "T1"
    nominal_life: float = 50.0
    use_class: str = "II"
    code: str = "ntc2018"
    spectrum_type: str = "1"
    building: Any = ()
    source: str = ""
    assumed: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        rules = self.rules
        if isinstance(self.hazard, Mapping):
            points: Any = {}
            for level, given in self.hazard.items():
                rules.pick("levels", level, "limit state")
                points[level] = _hazard(given, f"hazard of {level}")
        else:
            points = tuple(sorted((_hazard(g, f"hazard {k}") for k, g in enumerate(self.hazard, 1)), key=_by_period))
            if not points or any(math.isnan(p.T_R) for p in points):
                msg = "a table of hazards needs a return period T_R in every row"
                raise InputError(msg, hint='or give them by limit state: {"SLV": {"a_g": 0.2, "F0": 2.45, "Tc": 0.32}}')
        _check_rising(points, rules)
        object.__setattr__(self, "hazard", points)
        given = self.building if isinstance(self.building, list | tuple) else (self.building,)
        object.__setattr__(self, "building", tuple(_mode(m) for m in given))
        if self.spectrum_type != "1" and "types" not in rules.tables:
            msg = f"spectrum_type = '{self.spectrum_type}', and {rules.name} has no types of spectra"
            raise InputError(msg, hint="leave it out: F0 and Tc of the hazard give the shape of the spectrum")
        rules.spectrum(1.0, 2.5, 0.3, self.soil, self.topography, self.spectrum_type)
        rules.reference_life(self.nominal_life, self.use_class)

    @cached_property
    def rules(self) -> Code:
        """The code."""
        return find_code(self.code)

    @property
    def life(self) -> float:
        """Reference life V_R [years]."""
        return self.rules.reference_life(self.nominal_life, self.use_class)

    @property
    def levels(self) -> tuple[str, ...]:
        """Limit states for which the hazard is known; of a table of return periods without those made on request."""
        known = self.rules.choices("levels")
        if isinstance(self.hazard, Mapping):
            return tuple(level for level in known if level in self.hazard)
        made = (level for level in known if not self.rules.tables["levels"][level].get("on_request", False))
        return tuple(level for level in made if self.period(level) <= self._table_ends)

    def period(self, level: str) -> float:
        """Return the return period of a limit state, at most the longest of the code [years]."""
        longest = float(self.rules.tables["life"].get("longest", math.inf))
        return min(self.rules.return_period(level, self.life), longest)

    @property
    def _table_ends(self) -> float:
        """Return period up to which the table says what the hazard is [years]; tables round theirs."""
        return 1.005 * float(self.hazard[-1].T_R)

    @property
    def asked_by_code(self) -> tuple[str, ...]:
        """Limit states that the code asks for, whether their hazard is known or not."""
        rules = self.rules.tables["levels"]
        return tuple(v for v in self.rules.choices("levels") if not rules[v].get("on_request", False))

    def ultimate(self, levels: tuple[str, ...]) -> tuple[str, ...]:
        """Return the ultimate limit states among some; all of them where there is none."""
        rules = self.rules.tables["levels"]
        return tuple(v for v in levels if rules[v]["kind"] != "onset") or levels

    def invented(self, level: str) -> tuple[str, ...]:
        """Return which numbers of a limit state were not given though its spectrum is made of them: "F0", "Tc"."""
        return () if "types" in self.rules.tables else self.at(level).filled

    def idle(self, level: str) -> tuple[str, ...]:
        """Return which numbers of a limit state were given though its code fixes the spectrum: "F0", "Tc"."""
        filled = self.at(level).filled
        return tuple(key for key in ("F0", "Tc") if key not in filled) if "types" in self.rules.tables else ()

    def at(self, level: str) -> Hazard:
        """Return the hazard of a limit state, with its return period.

        Raises
        ------
        InputError
            The hazard of this limit state is not known.
        """
        T_R = self.rules.return_period(level, self.life)
        if isinstance(self.hazard, Mapping):
            if level not in self.hazard:
                msg = f"the hazard of {level} is not given"
                raise InputError(msg, hint="known: " + ", ".join(self.hazard))
            given: Hazard = self.hazard[level]
            return given if not math.isnan(given.T_R) else replace(given, T_R=T_R)
        if self.period(level) > self._table_ends:
            msg = f"{level} has a return period of {T_R:.0f} years, and the table of hazards ends at "
            msg += f"{self.hazard[-1].T_R:g}: how hard it shakes then is not known"
            raise InputError(msg, where="hazard", hint="give the table a longer return period, or leave that level out")
        return self.interpolated(self.period(level))

    def interpolated(self, T_R: float) -> Hazard:
        """Return the hazard of a return period from the table: linear in the logarithms, constant beside it."""
        rows = self.hazard
        logs = np.log([p.T_R for p in rows])
        at = math.log(T_R)
        values = (np.exp(np.interp(at, logs, np.log([getattr(p, k) for p in rows]))) for k in ("a_g", "F0", "T_star"))
        a_g, F0, T_star = (float(v) for v in values)
        filled = dict.fromkeys(word for row in rows for word in row.filled)
        return Hazard(T_R, a_g, F0, T_star, tuple(filled))

    def spectrum(self, hazard: Hazard) -> Spectrum:
        """Return the elastic spectrum on the ground."""
        g = self.rules.gravity
        return self.rules.spectrum(
            hazard.a_g * g, hazard.F0, hazard.T_star, self.soil, self.topography, self.spectrum_type
        )

    def at_height(self, ground: Spectrum, z: float) -> FloorSpectrum | None:
        """Return the spectrum at the height ``z`` [m]; None where no building is given, or on the ground."""
        if not self.building or z <= 0:
            return None
        rules = self.rules.tables["floor"]
        modes = tuple(m.mode(z, rules) if isinstance(m, Storeys) else m for m in self.building)
        return FloorSpectrum(ground, modes, rules)


def _check_rising(points: Any, rules: Code) -> None:
    """Refuse an acceleration that falls as the return period grows.

    Raises
    ------
    InputError
    """
    if isinstance(points, Mapping):
        rare = [level for level in rules.choices("levels") if level in points]
        rare.sort(key=lambda level: -float(rules.tables["levels"][level]["probability"]))
        rows = [(level, points[level].a_g) for level in rare]
    else:
        rows = [(f"T_R = {p.T_R:g} years", p.a_g) for p in points]
    for (often, more), (rarely, less) in pairwise(rows):
        if more > less:
            msg = f"a_g = {more:g} g of {often} is larger than a_g = {less:g} g of {rarely}, which is rarer"
            raise InputError(msg, where="hazard", hint="check which acceleration belongs to which")


def _by_period(point: Hazard) -> float:
    return point.T_R


def _hazard(given: Any, where: str) -> Hazard:
    if isinstance(given, Hazard):
        return given
    if not isinstance(given, Mapping):
        msg = f"{given!r} is not a hazard"
        raise InputError(msg, where=where, hint='for example {"a_g": 0.20, "F0": 2.45, "Tc": 0.32}')
    names = {"T_R": "T_R", "a_g": "a_g", "F0": "F0", "Tc": "T_star"}
    for key in given:
        if key not in names:
            msg = f"unknown key '{key}'"
            raise InputError(msg, where=where, hint=closest(key, names))
    if "a_g" not in given:
        msg = "a_g is missing"
        raise InputError(msg, where=where, hint="as a share of gravity, for example a_g = 0.20")
    numbers = {}
    for key, value in given.items():
        numbers[names[key]] = _number(value, key, where)
    missing = tuple(key for key in ("F0", "Tc") if key not in given)
    try:
        made = {"T_R": math.nan, **numbers}
        return Hazard(made["T_R"], made["a_g"], made.get("F0", 2.5), made.get("T_star", 0.3), missing)
    except InputError as error:
        raise InputError(error.what, where=where, hint=error.hint) from None


def _number(value: Any, key: str, where: str) -> float:
    """Return a number of the hazard; texts may say g, m/s2, cm/s2, s, ms or years."""
    if isinstance(value, str):
        for unit, factor in _UNITS.get(key, {}).items():
            if value.strip().endswith(unit):
                return quantity(value.strip().removesuffix(unit), "number", where=f"{where}, {key}") * factor
    return quantity(value, "number", where=f"{where}, {key}")


_UNITS = {
    "a_g": {"cm/s2": 0.01 / 9.81, "m/s2": 1.0 / 9.81, "g": 1.0},
    "Tc": {"ms": 1e-3, "s": 1.0},
    "T_R": {"years": 1.0, "anni": 1.0},
}
"""Units that texts may end in; those that end in another one come before it."""


def _mode(given: Any) -> Mode | Storeys:
    if isinstance(given, Mode | Storeys):
        return given
    made = Storeys if "height" in given else Mode
    known = list(made.__dataclass_fields__)
    for key in given:
        if key not in known:
            msg = f"unknown key '{key}' of a mode of the building"
            raise InputError(msg, hint=closest(key, known))
    try:
        return made(**given)
    except TypeError as error:
        msg = f"a mode of the building is not complete: {error}"
        hint = "give height and storeys (and T1, xi), or T, participation, shape and xi"
        raise InputError(msg, hint=hint) from None
