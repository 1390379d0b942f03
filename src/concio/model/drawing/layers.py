"""What the layers of a drawing mean: their names may say it (``CONCIO_...``), or the user does (``[drawing.layers]``).

A layer is given a word::

    FONDAZIONE = "fixed"        # fixed bodies
    QUOTE = "ignore"            # left out, and counted
    FORI = "hole"               # holes in the blocks they lie in
    NOMI = "names"              # texts that name the blocks they stand in
    CONCI = "rigid"             # rigid blocks
    MURATURA = "stone"          # blocks of the material 'stone'

or a table::

    ARCHITRAVI = { material = "stone", role = "lintel", thickness = 0.4 }
    TERRENO = { use = "fixed", role = "ground" }
    SOLAIO = { load = "traction", value = [0, -12], group = "floor", face = "upper" }
    APPOGGI = { support = "y" }
    CATENE = { tie = "5000 kN/m", yield_force = "30 kN" }     # each line a tie of this stiffness

Names of layers are the same in upper and lower case; ``*`` and ``?`` stand for any characters, and a layer's own name
goes before such a pattern.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Any, Literal, get_args

from concio.arguments import closest
from concio.errors import InputError
from concio.model.model import FACES, Load
from concio.units import quantity

Use = Literal["block", "rigid", "fixed", "hole", "names", "ignore", "load", "support", "tie"]
WORDS: dict[str, Use] = {w: w for w in get_args(Use) if w not in ("load", "support", "tie")}
"""Words that a layer may be given in place of a material."""
VALUES: dict[str, tuple[str, int]] = {"pressure": ("stress", 1), "traction": ("stress", 2), "point": ("force", 2)}
"""Kind of quantity and number of values of the loads that can be drawn."""
KEYS: dict[str, tuple[str, ...]] = {
    "block": ("use", "material", "role", "thickness"),
    "load": ("load", "value", "group", "face"),
    "support": ("support", "group"),
    "tie": ("tie", "yield_force", "prestress", "break_elongation"),
}
OF_TIES = {"tie": "stiffness", "yield_force": "force", "prestress": "force", "break_elongation": "length"}
"""Kind of quantity of the keys of a tie."""


@dataclass(frozen=True)
class LayerUse:
    """What the entities of a layer are.

    Parameters
    ----------
    use : str
        One of :data:`Use`.
    material, role : str
        Of blocks; "" leaves what the name of the layer gives, and the role "block" or "obstacle".
    thickness : float or None
        Of blocks [m]; None takes that of the drawing.
    load : Load or None
        Kind, value, group and face of loads, without a place.
    directions : str
        Of supports: "x", "y" or "xy".
    group : str
        Load group of supports.
    tie : mapping or None
        Of ties: ``stiffness``, ``yield_force``, ``prestress`` and ``break_elongation`` of :class:`~concio.Tie`.
    """

    use: Use = "block"
    material: str = ""
    role: str = ""
    thickness: float | None = None
    load: Load | None = None
    directions: str = ""
    group: str = "settlement"
    tie: Mapping[str, float] | None = None


class Layers:
    """What each layer of a drawing is.

    Parameters
    ----------
    given : mapping of layer to word or table
        As in the module's description; numbers in kN and m, or texts with units.
    materials : sequence of str
        Names of the materials there are.

    Raises
    ------
    InputError
        A word is neither a use nor a material, a key is unknown, or a value is missing.
    """

    def __init__(self, given: Mapping[str, Any] | None = None, materials: Sequence[str] = ()) -> None:
        self._known: dict[str, LayerUse] = {}
        self._spelt: dict[str, str] = {}
        for layer, meaning in (given or {}).items():
            word = str(layer).upper()
            if word in self._known:
                msg = f"the layer is given twice, as '{self._spelt[word]}' too"
                raise InputError(msg, where=f"layer '{layer}'", hint="upper and lower case are the same")
            self._known[word] = _use_of(meaning, f"layer '{layer}'", materials)
            self._spelt[word] = str(layer)

    def of(self, layer: str) -> LayerUse | str:
        """Return what a layer is; a sentence where its name begins with CONCIO_ and cannot be understood."""
        word = layer.upper()
        if word in self._known:
            return self._known[word]
        for pattern, use in self._known.items():
            if ("*" in pattern or "?" in pattern) and fnmatchcase(word, pattern):
                return use
        return named_use(word)

    def check_used(self, layers: Sequence[str], where: str) -> list[str]:
        """Return a sentence for each entry of a drawing's table of meanings that fits none of its layers.

        Parameters
        ----------
        layers : sequence of str
            All layers of the drawing.
        where : str
            The drawing, for the message.

        Raises
        ------
        InputError
            What is missing would not just be left out.
        """
        words = [layer.upper() for layer in layers]
        notes = []
        for pattern, use in self._known.items():
            if pattern in words or any(fnmatchcase(word, pattern) for word in words):
                continue
            name = self._spelt[pattern]
            if use.use == "ignore":
                notes.append(f"layer '{name}' is to be ignored, but the drawing has no such layer")
                continue
            msg = f"[drawing.layers] names layer '{name}', which the drawing does not have"
            raise InputError(msg, where=where, hint=closest(name, list(layers)))
        return notes


def named_use(word: str) -> LayerUse | str:
    """Return what the name of a layer says, in upper case: a block where it says nothing, a sentence where it errs."""
    if word == "DEFPOINTS" or word.startswith(("CONCIO_IGNORE", "CONCIO_RESULT")):
        return LayerUse("ignore")
    if word == "CONCIO_FIXED":
        return LayerUse("fixed")
    if word == "CONCIO_NAMES":
        return LayerUse("names")
    if word.startswith("CONCIO_HOLE"):
        return LayerUse("hole")
    if word.startswith("CONCIO_RIGID"):
        return LayerUse("rigid")
    if word.startswith("CONCIO_SUPPORT"):
        directions = word.removeprefix("CONCIO_SUPPORT").strip("_")
        if directions in ("X", "Y", "XY"):
            return LayerUse("support", directions=directions.lower())
        return "this layer is not CONCIO_SUPPORT_X, _Y or _XY"
    return _named_load(word) if word.startswith("CONCIO_LOAD") else LayerUse()


def _named_load(word: str) -> LayerUse | str:
    parts = word.removeprefix("CONCIO_LOAD").strip("_").split("_")
    form = "the layer is not CONCIO_LOAD_<PRESSURE|TX|TY|FX|FY>_<value>_<group>"
    if len(parts) < 2 or parts[0] not in ("PRESSURE", "TX", "TY", "FX", "FY"):
        return form
    try:
        value = quantity(parts[1], "number")
    except InputError as error:
        return f"'{parts[1]}' is not a number ({error.hint}); {form}"
    group = "_".join(parts[2:]).lower() or "live"
    if parts[0] == "PRESSURE":
        return LayerUse("load", load=Load("pressure", (value,), group=group))
    vector = (value, 0.0) if parts[0].endswith("X") else (0.0, value)
    return LayerUse("load", load=Load("traction" if parts[0].startswith("T") else "point", vector, group=group))


def _use_of(meaning: Any, where: str, materials: Sequence[str]) -> LayerUse:
    """Return the use that a word or a table describes."""
    if isinstance(meaning, LayerUse):
        return meaning
    if isinstance(meaning, str):
        if meaning in materials:
            return LayerUse(material=meaning)
        if meaning in WORDS:
            return LayerUse(WORDS[meaning])
        msg = f"'{meaning}' is neither a material nor one of {', '.join(WORDS)}"
        raise InputError(msg, where=where, hint=closest(meaning, [*materials, *WORDS]))
    if not isinstance(meaning, Mapping):
        msg = f"{meaning!r} is neither a word nor a table"
        raise InputError(msg, where=where, hint=f"write a material, one of {', '.join(WORDS)}, or a table of keys")
    given = {key: value for key, value in meaning.items() if value is not None}
    sort = next((word for word in ("load", "support", "tie") if word in given), "block")
    for key in given:
        if key not in KEYS[sort]:
            msg = f"unknown key '{key}'" if sort == "block" else f"unknown key '{key}' of a {sort}"
            raise InputError(msg, where=where, hint=closest(str(key), KEYS[sort]))
    if sort == "load":
        return LayerUse("load", load=_load(given, where))
    if sort == "tie":
        return LayerUse("tie", tie=_tie(given, where))
    if sort == "support":
        directions = str(given["support"])
        if directions not in ("x", "y", "xy"):
            msg = f"support = '{directions}' is not one of x, y, xy"
            raise InputError(msg, where=where)
        return LayerUse("support", directions=directions, group=str(given.get("group", "settlement")))
    use = given.get("use", "block")
    if use not in WORDS:
        msg = f"use = '{use}' is not one of {', '.join(WORDS)}"
        raise InputError(msg, where=where, hint=closest(str(use), WORDS))
    material = str(given.get("material", ""))
    if material and material not in materials:
        msg = f"material '{material}' is not defined"
        raise InputError(msg, where=where, hint=closest(material, materials) if materials else None)
    thickness = given.get("thickness")
    if thickness is not None:
        thickness = quantity(thickness, "length", where=f"{where}, thickness")
    return LayerUse(WORDS[use], material, str(given.get("role", "")), thickness)


def _tie(given: Mapping[str, Any], where: str) -> dict[str, float]:
    found = {key: quantity(value, OF_TIES[key], where=f"{where}, {key}") for key, value in given.items()}
    for key, value in found.items():
        if not (0 < value < float("inf") or (key == "prestress" and value == 0)):
            msg = f"{key} = {value:g} must be positive"
            raise InputError(msg, where=where)
    return {"stiffness" if key == "tie" else key: value for key, value in found.items()}


def _load(given: Mapping[str, Any], where: str) -> Load:
    kind = given["load"]
    if kind not in VALUES:
        msg = f"load = '{kind}' is not one of {', '.join(VALUES)}"
        raise InputError(msg, where=where, hint="self-weight acts by itself; other loads go into [[loads]]")
    if "value" not in given:
        msg = "'value' is missing"
        raise InputError(msg, where=where, hint="give a number for pressure, [x, y] otherwise")
    sort, entries = VALUES[kind]
    value = given["value"]
    parts = list(value) if isinstance(value, Sequence) and not isinstance(value, str) else [value]
    if len(parts) != entries:
        form = "one number" if entries == 1 else "two numbers [x, y]"
        msg = f"a {kind} load takes {form}, not {len(parts)}"
        raise InputError(msg, where=where)
    face = given.get("face")
    if face is not None and face not in FACES:
        msg = f"face = '{face}' is not one of {', '.join(FACES)}"
        raise InputError(msg, where=where)
    numbers = tuple(quantity(part, sort, where=f"{where}, value") for part in parts)
    return replace(Load(kind, numbers, group=str(given.get("group", "live"))), face=face)
