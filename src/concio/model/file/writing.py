"""Writing a model as a file: ``concio.dumps(model)`` and ``concio.save(model, "wall.toml")``.

The text is the general form, in kN and m, and every number is written so that it reads back to the last bit. The table
of a generator is not restored: the file holds its blocks, and how they were made stands in ``[record]``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from concio.arguments import strict
from concio.display import Units
from concio.errors import InputError
from concio.files import whole_file
from concio.model.file.block_table import write_blocks
from concio.model.file.road_tables import fill_table, vehicle_table
from concio.model.materials import Elastic, Rigid
from concio.model.model import Body, Load, Model, Support, require_model
from concio.model.polyhedron import Polyhedron
from concio.model.stages import Stage


@strict
def dumps(model: Model, *, blocks_file: str | None = None) -> str:
    """Return the model as TOML text; :func:`concio.loads` makes an equal model of it.

    Parameters
    ----------
    model : Model
    blocks_file : str, optional
        Name a table of blocks instead of writing them into the text.

    Examples
    --------
    >>> import concio
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=4)
    >>> text = concio.dumps(pillar)
    >>> text.splitlines()[1]
    'title = "column of 4 blocks, 0.5 x 2 m"'
    >>> round(float(concio.loads(text).body("b04").centroid[1]), 6)
    1.75
    """
    require_model(model)
    lines = ["# concio model"]
    lines += _pairs({"title": model.title or None, "blocks_file": blocks_file, "periods": model.periods})
    if not model.rules:
        lines.append("rules = []")
    lines += ["", "[units]", 'force = "kN"', 'length = "m"']
    if model.report != Units():
        lines += _table("report", asdict(model.report))
    if model.engine != "superlu":
        lines += _table("solver", {"engine": model.engine})
    own = _ANALYSIS if model.dim == 2 else _IN_SPACE
    lines += _table("analysis", {key: getattr(model, key) for key in own if getattr(model, key) is not None})
    for name, material in model.materials.items():
        lines += _table(f"materials.{_key(name)}", _material(material))
    for name, law in model.laws.items():
        if law.changes:
            msg = f"joint law '{name}' changes with what the joint undergoes, which a model file cannot say"
            raise InputError(msg, hint="keep such a model in Python")
        constants = {f.name: getattr(law, f.name) for f in fields(law) if f.name != "changes"}
        lines += _table(f"joints.{_key(name)}", constants)
    for rule in model.rules:
        lines += _table("rules", {"law": rule.law, "between": rule.between, "gap": rule.gap or None}, many=True)
    if blocks_file is None:
        for body in model.bodies:
            lines += _table("blocks", _body(body), many=True)
    for support in model.supports:
        lines += _table("supports", _support(support), many=True)
    for load in model.loads:
        lines += _table("loads", _load(load), many=True)
    for change in model.temperatures:
        own_fields = {f.name: getattr(change, f.name) for f in fields(change)}
        lines += _table("temperatures", {key: value for key, value in own_fields.items() if value != ()}, many=True)
    for tie in model.ties:
        bar = {f.name: getattr(tie, f.name) for f in fields(tie)}
        lines += _table("ties", {**bar, "kind": None if tie.kind == "bar" else tie.kind}, many=True)
    if model.fill is not None:
        lines += _table("fill", fill_table(model.fill))
    if model.vehicle is not None:
        lines += _table("vehicle", vehicle_table(model.vehicle))
    for stage in model.stages:
        lines += _table("stages", _stage(stage), many=True)
    if model.generator:
        lines += _table("record", model.generator)
    return "\n".join(lines) + "\n"


def toml_of(tables: Mapping[str, Any]) -> str:
    """Return tables as TOML text: plain values, then a heading for each table and each entry of a list of tables."""
    lines = _pairs({k: v for k, v in tables.items() if not _is_table(v)})
    for name, value in tables.items():
        if isinstance(value, Mapping):
            lines += _table(_key(name), value)
        elif _is_table(value):
            for entry in value:
                lines += _table(_key(name), entry, many=True)
    return "\n".join(lines).lstrip("\n") + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or (isinstance(value, list) and bool(value) and isinstance(value[0], Mapping))


@strict
def save(model: Model, path: str | os.PathLike[str], *, blocks_file: str | None = None) -> None:
    """Write the model as a TOML file; an existing file is replaced only when the new one is complete.

    Parameters
    ----------
    model : Model
    path : str or Path
    blocks_file : str, optional
        Name of a table ``.json`` or ``.csv`` beside the file for the blocks; a table does not keep mesh lines, only a
        ``.json`` one keeps mesh sizes.

    Raises
    ------
    InputError
        The file cannot be written.

    Examples
    --------
    >>> import concio
    >>> import tempfile
    >>> from pathlib import Path
    >>> pillar = concio.column(width=0.5, height=2.0, blocks=4)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     concio.save(pillar, Path(folder) / "pillar.toml")
    ...     again = concio.load(Path(folder) / "pillar.toml")
    >>> round(float(again.body("b04").centroid[1]), 6)
    1.75
    """
    path = Path(path)
    text = dumps(model, blocks_file=blocks_file)
    try:
        if blocks_file is not None:
            write_blocks(path.parent / blocks_file, model.bodies)
        with whole_file(path) as fresh:
            fresh.write_text(text, encoding="utf-8")
    except OSError as error:
        msg = f"the file cannot be written: {error.strerror or error}"
        raise InputError(msg, where=str(path)) from None


_ANALYSIS = ("plane", "element", "mesh_size", "refinement", "gap_tolerance", "gap_reach")
_IN_SPACE = ("element", "mesh_size", "refinement", "gap_tolerance", "gap_reach", "contact_points")


def _material(material: Elastic | Rigid) -> dict[str, Any]:
    if isinstance(material, Rigid):
        own: dict[str, Any] = {"kind": "rigid", "unit_weight": material.unit_weight}
    else:
        own = {"E": material.E, "nu": material.nu, "unit_weight": material.unit_weight}
    return {**own, "expansion": material.expansion} if material.expansion else own


def _body(body: Body | Polyhedron) -> dict[str, Any]:
    if isinstance(body, Polyhedron):
        return {
            "name": body.name,
            "vertices": body.vertices,
            "faces": body.faces,
            "holes": [{"face": face, "loop": loop} for face, loop in body.holes] or None,
            "hexahedra": body.grid if body.kind == "elastic" else None,
            "material": body.material,
            "kind": body.kind,
            "role": body.role,
            "layer": body.layer or None,
            "mesh_size": body.mesh_size,
        }
    grid = None if body.grid is None else {"x": body.grid[0], "y": body.grid[1]}
    return {
        "name": body.name,
        "outline": body.outline,
        "holes": list(body.holes) or None,
        "material": body.material,
        "kind": body.kind,
        "role": body.role,
        "layer": body.layer or None,
        "thickness": body.thickness,
        "mesh_size": body.mesh_size,
        "grid": grid,
    }


def _support(support: Support) -> dict[str, Any]:
    return {f.name: getattr(support, f.name) for f in fields(support)}


def _load(load: Load) -> dict[str, Any]:
    found = {f.name: getattr(load, f.name) for f in fields(load)}
    return {key: value for key, value in found.items() if value != ()}


def _stage(stage: Stage) -> dict[str, Any]:
    found = {f.name: getattr(stage, f.name) for f in fields(stage)}
    if stage.control is None:
        return {key: value for key, value in found.items() if key not in ("control", "until")}
    return {**found, "control": {f.name: getattr(stage.control, f.name) for f in fields(stage.control)}}


def _table(name: str, values: Mapping[str, Any], *, many: bool = False) -> list[str]:
    return ["", f"[[{name}]]" if many else f"[{name}]", *_pairs(values)]


def _pairs(values: Mapping[str, Any]) -> list[str]:
    return [f"{_key(key)} = {_value(value)}" for key, value in values.items() if value is not None]


def _key(name: str) -> str:
    bare = name.isascii() and name.replace("_", "").replace("-", "").isalnum()
    return name if bare else json.dumps(name, ensure_ascii=False)


def _value(value: Any) -> str:
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(_pairs(value)) + " }" if value else "{}"
    if isinstance(value, Iterable) and not isinstance(value, str):
        return "[" + ", ".join(_value(v) for v in value if v is not None) + "]"
    return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007f")
