"""Tables of blocks beside a model file: JSON or CSV, one row a block, read and written without loss.

JSON::

    {"format": "concio blocks", "version": 1, "unit": "m",
     "blocks": [{"name": "b1", "outline": [[0, 0], [0.4, 0], [0.4, 0.2], [0, 0.2]], "material": "block"}]}

CSV has a header; an outline is a text of vertices separated by semicolons. Lengths are in metres, or in the unit that
stands with the name of their column: ``outline [mm]``, ``thickness [cm]``; ``holes`` have that of the outline. Names
that a spreadsheet would take for a formula are written with an apostrophe in front, which reading takes away again::

    name,outline,material,kind,role,layer,thickness
    b1,0 0; 0.4 0; 0.4 0.2; 0 0.2,block,elastic,block,,1.0

A further column ``holes`` gives the holes of a block, written as its outline, with ``|`` between them; in JSON they
are a list of outlines. A block in space has ``vertices`` and ``faces`` (and perhaps ``holes``, pairs of a face and a
loop) in place of its outline; it goes into a JSON table. ``name`` and the shape must be there; the others, where they
are left out or their cell is empty, have the defaults of :class:`concio.model.body.Body`; a thickness that is not
given is that of ``[analysis]``. JSON may hold ``mesh_size``
too, and another ``unit`` of its coordinates (thickness and mesh size are always in m).

A model file whose ``[units]`` count lengths in another unit than m needs a table that says its own: it would be read in
metres where its author meant millimetres.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from concio.arguments import closest
from concio.errors import InputError
from concio.files import guarded, read_text, unguarded, whole_file
from concio.model.interfaces.polygon_check import check_polygon
from concio.model.model import Array, Body
from concio.model.polyhedron import Polyhedron
from concio.units import DECIMAL_COMMA, HEADING, is_bare, quantity

FORMAT, VERSION = "concio blocks", 1
_TEXTS = ("material", "kind", "role", "layer")
_NUMBERS = ("thickness", "mesh_size")
_LENGTHS = ("outline", "holes", *_NUMBERS)
_COLUMNS = ("name", "outline", *_TEXTS, *_NUMBERS, "holes")
NO_UNIT = "{}: the model file counts in {}, and the table does not say its unit"
_SOLID = ("vertices", "faces", "holes")


def _row(body: Body | Polyhedron) -> dict[str, Any]:
    row: dict[str, Any] = {"name": body.name}
    if isinstance(body, Body):
        row["outline"] = body.outline.tolist()
        row |= {k: getattr(body, k) for k in _TEXTS + _NUMBERS}
        return {**row, "holes": [hole.tolist() for hole in body.holes] or None}
    row |= {"vertices": body.vertices.tolist(), "faces": [list(face) for face in body.faces]}
    if body.holes:
        row["holes"] = [[face, list(loop)] for face, loop in body.holes]
    return {**row, **{k: getattr(body, k) for k in _TEXTS}, "mesh_size": body.mesh_size}


def read_blocks(path: str | Path, thickness: float = 1.0, length: str = "m") -> tuple[Body | Polyhedron, ...]:
    """Return the blocks of a table, every outline checked.

    Parameters
    ----------
    path : str or Path
        Ends in ``.json`` or ``.csv``.
    thickness : float
        Of plane blocks that give none [m].
    length : str
        Unit of the bare lengths of the model file; the table has to say its own where that is not m.

    Raises
    ------
    InputError
        The file is missing or not of the form above; the message names row or block and key.
    GeometryError
        An outline has a fault.
    """
    path = Path(path)
    text = read_text(path, hint="paths in a model file are relative to it")
    rows: Iterable[tuple[str, Mapping[str, Any]]]
    if path.suffix.lower() == ".json":
        rows, factor = _json_rows(text, str(path), length)
    elif path.suffix.lower() == ".csv":
        rows, factor = _csv_rows(text, str(path), length)
    else:
        solid = path.suffix.lower() in (".obj", ".stl", ".ply", ".off", ".3dm", ".ifc")
        msg = f"a table of blocks ends in .json or .csv, not in '{path.suffix}'"
        hint = f"blocks in space: solids_file = '{path.name}'" if solid else ""
        raise InputError(msg, where=str(path), hint=hint)
    bodies: list[Body | Polyhedron] = []
    seen: set[str] = set()
    for where, row in rows:
        body = _body(row, factor, where, thickness)
        if body.name in seen:
            msg = f"there is another block called '{body.name}'"
            raise InputError(msg, where=where, hint="give each block a name of its own")
        seen.add(body.name)
        bodies.append(body)
    if not bodies:
        msg = "the table holds no blocks"
        raise InputError(msg, where=str(path))
    return tuple(bodies)


def write_blocks(path: str | Path, bodies: Sequence[Body | Polyhedron]) -> None:
    """Write a table of blocks; reading it gives the same bodies to the last bit (their ``grid`` is not kept).

    Parameters
    ----------
    path : str or Path
        Ends in ``.json`` or ``.csv``. An existing file is replaced only when the new one is complete.
    bodies : sequence of Body or Polyhedron
    """
    path = Path(path)
    rows = [_row(b) for b in bodies]
    if path.suffix.lower() == ".csv" and any(isinstance(b, Polyhedron) for b in bodies):
        msg = "blocks in space do not fit into a .csv table"
        raise InputError(msg, where=str(path), hint="take a .json table")
    if path.suffix.lower() == ".json":
        rows = [{k: v for k, v in row.items() if v is not None} for row in rows]
        blocks = ",\n".join("  " + json.dumps(row, ensure_ascii=False) for row in rows)
        text = f'{{"format": "{FORMAT}", "version": {VERSION}, "unit": "m", "blocks": [\n{blocks}\n]}}\n'
    elif path.suffix.lower() == ".csv":
        stream = io.StringIO()
        with_holes = any(row["holes"] for row in rows)
        table = csv.DictWriter(stream, _COLUMNS if with_holes else _COLUMNS[:-1], lineterminator="\n")
        table.writeheader()
        for row in rows:
            row["outline"] = _written(row["outline"])
            holes = " | ".join(_written(hole) for hole in row.pop("holes") or ())
            row |= {"holes": holes} if with_holes else {}
            table.writerow({k: guarded(v) if k in ("name", *_TEXTS) else v for k, v in row.items()})
        text = stream.getvalue()
    else:
        msg = f"a table of blocks ends in .json or .csv, not in '{path.suffix}'"
        raise InputError(msg, where=str(path))
    with whole_file(path) as fresh:
        fresh.write_text(text, encoding="utf-8")


def _json_rows(text: str, where: str, length: str) -> tuple[list[tuple[str, Mapping[str, Any]]], float]:
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        msg = f"line {error.lineno}, column {error.colno}: {error.msg}"
        raise InputError(msg, where=where, hint="the file is not valid JSON") from None
    except (ValueError, RecursionError) as error:
        what = "it is nested too deeply" if isinstance(error, RecursionError) else "a number has too many digits"
        raise InputError(what, where=where) from None
    factor, unit = 1.0, data.get("unit") if isinstance(data, dict) else None
    if length != "m" and not unit:
        hint = f'write {{"unit": "{length}", "blocks": [...]}}, or "m" where they are in metres'
        raise InputError(NO_UNIT.format("coordinates", length), where=where, hint=hint)
    if isinstance(data, dict):
        if data.get("format", FORMAT) != FORMAT or data.get("version", VERSION) != VERSION:
            msg = f"format '{data.get('format')}' version {data.get('version')} is not '{FORMAT}' version {VERSION}"
            raise InputError(msg, where=where)
        factor = quantity(f"1 {data.get('unit', 'm')}", "length", where=f"{where}, unit")
        data = data.get("blocks")
    if not isinstance(data, list):
        msg = "there is no list 'blocks'"
        raise InputError(msg, where=where, hint='write {"blocks": [{"name": ..., "outline": [[x, y], ...]}]}')
    rows: list[tuple[str, Mapping[str, Any]]] = []
    for k, row in enumerate(data, 1):
        place = f"{where}, block {k}"
        if not isinstance(row, dict):
            msg = f"{row!r} is not a table of keys"
            raise InputError(msg, where=place)
        for key in _NUMBERS:
            if length != "m" and _is_bare(row.get(key)):
                hint = f'write "{key}": "{row[key]} {length}", or "{row[key]} m" where it is in metres'
                raise InputError(NO_UNIT.format(key, length), where=place, hint=hint)
        rows.append((place, row))
    return rows, factor


def _csv_rows(text: str, where: str, length: str) -> tuple[Iterable[tuple[str, Mapping[str, Any]]], float]:
    reader = csv.reader(io.StringIO(text), skipinitialspace=True)
    with _legible(reader, where):
        header, units = _columns(next(reader, []), where, length)
    return _csv_lines(reader, header, units, where, length), quantity(f"1 {units['outline']}", "length", where=where)


def _columns(cells: list[str], where: str, length: str) -> tuple[list[str], dict[str, str]]:
    """Return the names of the columns, and the units of those of lengths."""
    found = [match.groups() if (match := HEADING.match(unguarded(cell))) else (cell, None) for cell in cells]
    both = zip(found, cells, strict=True)
    header = [name if unit is None or name in _LENGTHS else cell for (name, unit), cell in both]
    for name in ("name", "outline"):
        if name not in header:
            msg = f"the header has no column '{name}'"
            hint = "the first line must name the columns: " + ",".join(_COLUMNS[:-2])
            if ";" in "".join(cells):
                hint = "columns are separated by commas, vertices by semicolons"
            for cell in cells:
                if cell.split("(")[0].strip() == name != cell:
                    hint = f"units stand in square brackets: {cell.replace('(', '[').replace(')', ']')}"
            raise InputError(msg, where=where, hint=hint)
    twice = [name for name in header if header.count(name) > 1]
    if twice:
        msg = f"the header has the column '{twice[0]}' twice"
        raise InputError(msg, where=where, hint="leave one of them out")
    stated = {name: unit for name, unit in found if name in _LENGTHS}
    if length != "m" and not stated["outline"]:
        raise _no_unit(length, where)
    units = {name: unit or ("m" if length == "m" or name not in _NUMBERS else "") for name, unit in stated.items()}
    if stated.get("holes") and units["holes"] != units["outline"]:
        msg = "outlines and holes are in different units"
        raise InputError(msg, where=where, hint="holes have the unit of the outline")
    return header, units


def _no_unit(length: str, where: str, column: str = "outline") -> InputError:
    hint = f"name it '{column} [{length}]', or '{column} [m]' where it is in metres"
    return InputError(NO_UNIT.format(f"column '{column}'", length), where=where, hint=hint)


def _is_bare(value: Any) -> bool:
    """Tell whether an entry is a number without a unit, be it a text."""
    return is_bare(value) if isinstance(value, str) else isinstance(value, int | float)


def _csv_lines(
    reader: Any, header: list[str], units: Mapping[str, str], where: str, length: str
) -> Iterator[tuple[str, Mapping[str, Any]]]:
    with _legible(reader, where):
        for cells in reader:
            place = f"{where}, line {reader.line_num}"
            if not any(cell.strip() for cell in cells):
                continue
            if len(cells) != len(header):
                msg = f"{len(header)} values were expected"
                raise InputError(msg, where=place, hint="outlines use spaces and semicolons, not commas")
            row = dict(zip(header, cells, strict=True))
            for key in _NUMBERS:
                if row.get(key) and is_bare(row[key]):
                    if not units[key]:
                        raise _no_unit(length, place, key)
                    row[key] = f"{row[key]} {units[key]}"
            kept = ("name", "outline", "material") if row.get("kind") == "fixed" else ("name", "outline")
            yield place, {k: unguarded(v) for k, v in row.items() if v != "" or k in kept}


@contextmanager
def _legible(reader: Any, where: str) -> Iterator[None]:
    try:
        yield
    except csv.Error as error:
        msg = f"line {reader.line_num} cannot be read: {error}"
        raise InputError(msg, where=where, hint="tables with outlines as long as that go into a .json file") from None


def _body(row: Mapping[str, Any], factor: float, where: str, thickness: float) -> Body | Polyhedron:
    for key in row:
        if key not in (*_COLUMNS, *_SOLID):
            msg = f"unknown key '{key}'"
            raise InputError(msg, where=where, hint=closest(key, _COLUMNS))
    name = row.get("name")
    if not isinstance(name, str) or not name:
        msg = "the block has no name"
        raise InputError(msg, where=where)
    where = f"{where} '{name}'"
    solid = "vertices" in row or "faces" in row
    if "outline" not in row and not solid:
        msg = "outline is missing"
        raise InputError(msg, where=where, hint="give its vertices, for example [[0, 0], [0.4, 0], [0.4, 0.2]]")
    if solid and "outline" in row:
        msg = "outline and vertices are given together"
        raise InputError(msg, where=where, hint="a block is an outline, or vertices and faces in space")
    values: dict[str, Any] = {}
    for key in _TEXTS:
        if key in row:
            if not isinstance(row[key], str):
                msg = f"{key} = {row[key]!r} is not a text"
                raise InputError(msg, where=where)
            values[key] = row[key]
    for key in _NUMBERS:
        if row.get(key) is not None:
            values[key] = quantity(row[key], "length", where=f"{where}, {key}")
    if solid:
        return _solid(row, factor, where, name, values)
    outline = factor * _outline(row["outline"], where)
    check_polygon(outline, name)
    holes = row.get("holes") or []
    if isinstance(holes, str):
        holes = holes.split("|")
    if not isinstance(holes, list):
        msg = "holes is not a list of outlines"
        raise InputError(msg, where=where, hint="write [[[x, y], ...], ...] in JSON, x y; x y; x y | ... in CSV")
    rings = [factor * _outline(hole, f"{where}, hole {k}") for k, hole in enumerate(holes, 1)]
    for k, ring in enumerate(rings, 1):
        check_polygon(ring, f"{name}', hole '{k}")
    return Body(name, outline, holes=tuple(rings), **{"thickness": thickness, **values})


def _written(ring: Iterable[tuple[float, float]]) -> str:
    return "; ".join(f"{x!r} {y!r}" for x, y in ring)


def _solid(row: Mapping[str, Any], factor: float, where: str, name: str, values: dict[str, Any]) -> Polyhedron:
    """Return a block in space."""
    if "thickness" in values:
        msg = "a block in space has no thickness"
        raise InputError(msg, where=where, hint="leave it out")
    try:
        vertices = np.array(row.get("vertices"), dtype=float)
        faces = tuple(tuple(map(int, face)) for face in row.get("faces", ()))
        holes = tuple((int(face), tuple(map(int, loop))) for face, loop in row.get("holes") or ())
    except (TypeError, ValueError, OverflowError, RecursionError):
        msg = "vertices, faces or holes are not lists of numbers"
        hint = '"vertices": [[x, y, z], ...], "faces": [[0, 2, 3, 1], ...], "holes": [[face, [4, 5, 6]], ...]'
        raise InputError(msg, where=where, hint=hint) from None
    return Polyhedron(name, factor * vertices, faces, holes=holes, **values)


def _outline(value: Any, where: str) -> Array:
    commas = isinstance(value, str) and re.search(r"\d,\d", value)
    try:
        if isinstance(value, str):
            value = [vertex.split() for vertex in value.split(";") if vertex.strip()]
        points = np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError, RecursionError):
        points = np.zeros(0)
    if points.ndim != 2 or points.shape[1] != 2:
        msg = "the outline is not a list of vertices with two numbers each"
        hint = "write 0 0; 0.4 0; 0.4 0.2 in CSV, [[0, 0], [0.4, 0], ...] in JSON"
        raise InputError(msg, where=where, hint=DECIMAL_COMMA if commas else hint)
    return points
