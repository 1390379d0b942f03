"""What a code says, as data: factors, limits and shapes of spectra stand in a table with their clauses.

A code is a TOML file; those that come with the program are in ``codes/``. One may stand on another (``base``): tables
it does not have are those of its base. A user's own file is given by its path.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from concio.analysis.seismic.spectrum import Spectrum
from concio.arguments import closest
from concio.errors import InputError

CODES = ("ntc2018", "en1998")


@dataclass(frozen=True)
class Code:
    """Tables of a code.

    Parameters
    ----------
    key : str
        Name of its file.
    tables : mapping
    """

    key: str
    tables: Mapping[str, Any]

    @property
    def name(self) -> str:
        """What the code is called."""
        return str(self.tables["name"])

    @property
    def gravity(self) -> float:
        """Acceleration of gravity as the code rounds it [m/s2]."""
        return float(self.tables["gravity"])

    def clause(self, of: str) -> str:
        """Return the clause of a formula or of a table."""
        clauses: Mapping[str, Any] = self.tables["clauses"]
        return str(clauses[of]) if of in clauses else str(self.tables[of]["clause"])

    def choices(self, table: str) -> list[str]:
        """Return the names that a table offers: soils, topographies, limit states, knowledge levels."""
        return [key for key in self.tables[table] if key != "clause"]

    def pick(self, table: str, name: str, what: str) -> Any:
        """Return an entry of a table.

        Raises
        ------
        InputError
            The table has no such entry; ``what`` says what it would be.
        """
        known = self.choices(table)
        if name not in known:
            msg = f"there is no {what} '{name}' in {self.name}"
            raise InputError(msg, hint="one of " + ", ".join(known))
        return self.tables[table][name]

    def spectrum(self, a_g: float, F0: float, T_star: float, soil: str, topography: str, kind: str = "1") -> Spectrum:
        """Return the elastic spectrum of a site.

        Parameters
        ----------
        a_g : float
            On rock [m/s2].
        F0, T_star : float
            Amplification, and the period [s] from which the code takes T_C; of a code with fixed spectra they do not
            count.
        soil, topography : str
        kind : str
            Type of spectrum, of a code that has types.

        Raises
        ------
        InputError
            There is no such soil, topography or type.
        """
        rules = self.tables["spectrum"]
        eta = rules["damping"]
        damping = (float(eta["numerator"]), float(eta["added"]), float(eta["least"]))
        hill = float(self.pick("topography", topography, "topography"))
        T_F = float(rules["T_F"])
        if "types" in self.tables:
            shapes = self.pick("types", kind, "type of spectrum")
            shape = _entry(shapes, soil, self.name)
            S, T_B, T_C, T_D, T_E = (float(shape[key]) for key in ("S", "T_B", "T_C", "T_D", "T_E"))
            return Spectrum(a_g, S * hill, float(rules["F0"]), T_B, T_C, T_D, T_E, T_F, damping)
        ground = self.pick("soils", soil, "soil")
        share = a_g / self.gravity
        S = min(max(ground["constant"] - ground["slope"] * F0 * share, ground["low"]), ground["high"])
        T_C = ground["factor"] * T_star ** (1.0 + ground["power"])
        corner = rules["corner"]
        T_D = corner["T_D"][0] * share + corner["T_D"][1]
        T_B = corner["T_B_over_T_C"] * T_C
        return Spectrum(a_g, S * hill, F0, T_B, T_C, T_D, ground["T_E"], T_F, damping)

    def return_period(self, level: str, life: float) -> float:
        """Return the return period of a limit state for a reference life, both in years: -V_R / ln(1 - P)."""
        probability = float(self.pick("levels", level, "limit state")["probability"])
        return -life / math.log1p(-probability)

    def reference_life(self, nominal: float, use_class: str) -> float:
        """Return the reference life [years].

        Raises
        ------
        InputError
            There is no such class of use, or the life is not positive.
        """
        life = self.tables["life"]
        if use_class not in life["use_class"]:
            msg = f"there is no class of use '{use_class}' in {self.name}"
            raise InputError(msg, hint="one of " + ", ".join(life["use_class"]))
        if not 0 < nominal < math.inf:
            msg = f"a nominal life of {nominal:g} years must be positive"
            raise InputError(msg)
        return max(nominal * float(life["use_class"][use_class]), float(life["least"]))


def _entry(table: Mapping[str, Any], soil: str, name: str) -> Mapping[str, Any]:
    known = [key for key in table if key != "clause"]
    if soil not in known:
        msg = f"there is no soil '{soil}' in {name}"
        raise InputError(msg, hint="one of " + ", ".join(known))
    entry: Mapping[str, Any] = table[soil]
    return entry


@cache
def _own(name: str) -> str:
    return (files("concio.analysis.seismic") / "codes" / f"{name}.toml").read_text(encoding="utf-8")


LEVEL = ("probability", "kind", "share", "period", "damping", "q", "mark", "on_request", "clause")
"""Keys of a limit state."""


def _over(base: Mapping[str, Any], own: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Return the tables of a code with those of another one laid over them, number by number.

    Raises
    ------
    InputError
        A table or a key of a limit state is not known.
    """
    for key in own:
        if key not in (*base, "base", "types", "soils"):
            msg = f"a code has no table or key '{key}'"
            raise InputError(msg, where=name, hint=closest(key, base))
    for level, rule in own.get("levels", {}).items():
        for key in rule if isinstance(rule, Mapping) else ():
            if key not in LEVEL:
                msg = f"a limit state has no key '{key}'"
                raise InputError(msg, where=f"{name}, [levels.{level}]", hint=closest(key, LEVEL))

    def laid(old: Any, new: Any) -> Any:
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            return {**old, **{k: laid(old.get(k), v) for k, v in new.items()}}
        return new

    return {**base, **{k: laid(base.get(k), v) for k, v in own.items()}}


def find_code(name: str) -> Code:
    """Return a code by its name, or from a file of the user's.

    Raises
    ------
    InputError
        There is no such code, or the file is none.
    """
    if name in CODES:
        text = _own(name)
    elif name.endswith(".toml"):
        try:
            text = Path(name).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            msg = f"the code cannot be read: {error}"
            raise InputError(msg, where=name) from None
    else:
        msg = f"there is no code '{name}'"
        raise InputError(msg, hint=closest(name, CODES) + ", or a file NAME.toml")
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(str(error), where=name) from None
    if "base" in tables:
        tables = _over(find_code(str(tables["base"])).tables, tables, name)
    missing = [key for key in ("name", "gravity", "spectrum", "topography", "levels", "clauses") if key not in tables]
    if missing:
        msg = f"the code has no {missing[0]}"
        raise InputError(msg, where=name, hint="begin with: base = 'ntc2018'")
    return Code(Path(name).stem, tables)
