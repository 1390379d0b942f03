"""The wall of a model file with smaller blocks at the same outline."""

from __future__ import annotations

import re
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from concio.model.model import Model
    from concio.problem.contact_problem import Engine

STIFFNESSES = ("normal_stiffness", "tangential_stiffness")


def halved_file(file: Path, units: str | None = None, engine: Engine | None = None) -> Callable[[int], Model]:
    """Return ``make(n)``: the wall or panel of a file with blocks n times smaller in both directions, for an engine.

    The first one, which is the file as it is, is reported in ``units``.

    Mortar joints become n times thinner and joints n times stiffer, so that the homogenised wall stays the same; a
    panel gets n times as many courses and blocks.

    Raises
    ------
    InputError
        The file describes no ``[wall]`` and no ``[panel]``.
    """
    from concio.cli.options import loaded
    from concio.errors import InputError
    from concio.model.file.reading import model_from_tables, read_tables

    data = read_tables(file)
    kind = next((name for name in ("wall", "panel") if name in data), "")
    if not kind or not isinstance(data[kind], dict):
        msg = "blocks are halved in a [wall] or a [panel], and the file has neither"
        raise InputError(msg, where=str(file), hint="leave --halve out, or use concio.halve_blocks from Python")

    def make(n: int) -> Model:
        if n == 1:
            return loaded(file, units, engine)
        tables = deepcopy(data)
        _halve(tables[kind], kind, n)
        for name in ("joints", "materials"):
            for law in tables.get(name, {}).values():
                _stiffen(law, n)
        model = model_from_tables(tables, folder=file.parent, name=str(file))
        return model if engine is None else replace(model, engine=engine)

    return make


def _halve(table: dict[str, Any], kind: str, n: int) -> None:
    default = [0.25, 0.125] if kind == "wall" else [0.2, 0.1]
    for name, value in (("block_size", table.get("block_size", default)), ("joint", table.get("joint"))):
        if value is not None:
            table[name] = [_over(v, n) for v in value] if isinstance(value, list) else _over(value, n)
    if kind == "panel":
        table |= {name: n * int(table.get(name, 3)) for name in ("courses", "blocks")}
    if "mesh_size" in table:
        table["mesh_size"] = _over(table["mesh_size"], n)
    _stiffen(table.get("friction"), n)


def _stiffen(law: Any, n: int) -> None:
    if isinstance(law, dict):
        law |= {name: _over(law[name], 1 / n) for name in STIFFNESSES if law.get(name) is not None}


def _over(value: Any, n: float) -> Any:
    """Return a number, or a text such as "20 mm", divided by n."""
    if not isinstance(value, str):
        return value / n
    found = re.match(r"\s*([-+]?[0-9][0-9._]*(?:[eE][-+]?[0-9]+)?)(.*)", value)
    return value if found is None else f"{float(found[1]) / n!r}{found[2]}"
