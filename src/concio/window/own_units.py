"""Numbers of the page, which are in kN and m, as a file with ``[units]`` of its own has them, and back."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from concio.model.file.acting_tables import LOAD_KINDS
from concio.model.file.reading import file_units
from concio.model.file.values import FileUnits

LENGTHS = (
    "at", "edge", "polygon", "at_a", "at_b", "displacement", "break_elongation", "gap", "outline", "rectangle", "box",
    "vertices", "thickness", "mesh_size",
)  # fmt: skip
FORCES = ("prestress", "yield_force")
OF_PLACES = ("loads", "supports", "ties", "temperatures", "blocks", "rules")
"""Lists of tables whose numbers the page gives in kN and m."""
DIGITS = 12
"""Digits that are written: fewer than those at which a quotient shows its rounding."""


def units_of_text(text: str) -> FileUnits:
    """Return the system of a model text."""
    return file_units(tomllib.loads(text), "the text")


def scaled(value: Any, factor: float) -> Any:
    """Return a number, or all numbers of lists, over a factor; texts have units of their own and stay."""
    if isinstance(value, list):
        return [scaled(v, factor) for v in value]
    if isinstance(value, bool) or not isinstance(value, int | float) or factor == 1.0:
        return value
    return float(f"{value / factor:.{DIGITS}g}")


def points_in_file(points: Any, text: str) -> Any:
    """Return points of the page [m] in the unit of length of the text."""
    return scaled(points, units_of_text(text).length)


def table_in_file(table: Mapping[str, Any], text: str) -> dict[str, Any]:
    """Return a table that the page gives, its numbers in the system of the text."""
    units = units_of_text(text)
    return {key: _in(value, key, table, units) for key, value in table.items()}


def value_in_file(value: Any, path: Sequence[str | int], text: str) -> Any:
    """Return a value that the page sets at a path, its numbers in the system of the text."""
    if len(path) == 3 and path[0] in OF_PLACES and path[2] in LENGTHS:
        return points_in_file(value, text)
    if tuple(path[:2]) == ("drawing", "layers") and isinstance(value, dict) and value.keys() == LAYER_LOAD:
        return {**value, "value": scaled(value["value"], _load(value["load"], units_of_text(text)))}
    return value


LAYER_LOAD = {"load", "value", "group"}
"""Keys of a load that the page gives to a layer of a drawing."""


def layer_for_page(stated: Any, text: str) -> Any:
    """Return what a text states of a layer of a drawing, the load in kN and m."""
    if not isinstance(stated, dict) or "load" not in stated or "value" not in stated:
        return stated
    return {**stated, "value": scaled(stated["value"], 1.0 / _load(stated["load"], units_of_text(text)))}


def _in(value: Any, key: str, table: Mapping[str, Any], units: FileUnits) -> Any:
    if key in LENGTHS:
        return scaled(value, units.length)
    if key in FORCES:
        return scaled(value, units.force)
    return scaled(value, _load(table["kind"], units)) if key == "value" and "kind" in table else value


def _load(kind: Any, units: FileUnits) -> float:
    """Return what one unit of a load of a kind is in kN and m; 1 of a kind that is not known."""
    quantity = LOAD_KINDS.get(str(kind), ("number", ()))[0]
    return 1.0 if quantity == "number" else units.factor(quantity)
