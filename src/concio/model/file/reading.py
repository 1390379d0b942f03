"""Model files: ``concio.load("panel.toml")``.

A model file is TOML. It states its units, and describes a structure by a generator, by blocks, or by both::

    [panel]                      # or [wall], [arch], [column], [buttress], [rubble]: keys are the function's arguments
    courses = 3
    blocks = 6
    joint = "20 mm"
    block.E = "100 MPa"

    [materials.stone]            # the general form
    E = "5 GPa"
    [joints.dry]
    friction = 0.6
    [[blocks]]
    name = "b1"
    rectangle = [[0, 0], [0.4, 0.2]]
    material = "stone"

Large models keep their blocks in a table or a drawing beside the file: ``blocks_file = "blocks.csv"`` (or ``.json``,
``.dxf``). Every key is checked; the JSON Schema of the file is printed by ``concio schema``.
"""

from __future__ import annotations

import os
import re
import sys
import tomllib
from contextlib import suppress
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from concio.arguments import strict
from concio.errors import InputError
from concio.files import read_text
from concio.model.file.build import build
from concio.model.file.file_errors import check_depth, check_finite, first_fault
from concio.model.file.file_table import FileTable, file_table, table_for
from concio.model.file.tables import UnitsTable
from concio.model.file.values import FileUnits
from concio.model.model import Model
from concio.units import DECIMAL_COMMA, quantity

STDIN = Path("-")
"""The name of standard input."""


@strict
def load(path: str | os.PathLike[str]) -> Model:
    r"""Return the model that a TOML file describes.

    Parameters
    ----------
    path : str or Path
        ``-`` reads standard input; files that it names are relative to the working directory.

    Raises
    ------
    InputError
        The file is missing, not readable, or says something that cannot be used; the message names the key.

    Examples
    --------
    >>> import concio
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "pillar.toml"
    ...     written = file.write_text("[column]\nwidth = 0.5\nheight = '200 cm'\nblocks = 4\n")
    ...     model = concio.load(file)
    >>> round(float(model.body("b04").centroid[1]), 6)
    1.75
    """
    path = Path(path)
    return model_of_file(read_tables(path), path)


def model_of_file(data: dict[str, Any], path: Path) -> Model:
    """Return the model that the tables of a file describe; raises as :func:`load`."""
    return model_from_tables(data, folder=path.parent, name=str(path), chain=(path.resolve(),))


def read_tables(path: Path) -> dict[str, Any]:
    """Return the tables of a TOML file as they stand in it; raises as :func:`load`."""
    named = {".dxf": "blocks_file", **dict.fromkeys((".obj", ".stl", ".ply", ".off", ".3dm", ".ifc"), "solids_file")}
    key = named.get(path.suffix.lower())
    if key is not None:
        msg = f"this is a drawing of blocks ({path.suffix}), not a model file"
        hint = f"name it in a model file: {key} = '{path.name}'"
        if key == "blocks_file":
            hint += f"; the lines of a bridge: [bridge_drawing] file = '{path.name}'"
        raise InputError(msg, where=str(path), hint=hint)
    if path == STDIN:
        return parse(_standard_input(), "standard input")
    too_large = "put the blocks into a table of their own: blocks_file = 'blocks.csv'"
    text = read_text(path, hint="start one with: concio new panel", pipes=True, too_large=too_large)
    return parse(text, str(path))


def _standard_input() -> str:
    hint = "send a model file: concio run - < model.toml"
    if sys.stdin is None or sys.stdin.isatty():
        msg = "nothing is sent there"
        raise InputError(msg, where="standard input", hint=hint)
    try:
        return sys.stdin.buffer.read().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        msg = f"it cannot be read: {error}"
        raise InputError(msg, where="standard input", hint=hint) from None


@strict
def loads(text: str, *, folder: str | os.PathLike[str] = ".", name: str = "model text") -> Model:
    r"""Return the model that a TOML text describes.

    Parameters
    ----------
    text : str
    folder : str or Path
        ``blocks_file`` is relative to it.
    name : str
        Used in messages.

    Raises
    ------
    InputError
        As :func:`load`.

    Examples
    --------
    >>> import concio
    >>> model = concio.loads("[column]\nwidth = 0.5\nheight = '200 cm'\nblocks = 4\n")
    >>> round(float(model.body("b04").centroid[1]), 6)
    1.75
    """
    return model_from_tables(parse(text, name), folder=folder, name=name)


def model_from_tables(
    data: dict[str, Any], *, folder: str | os.PathLike[str] = ".", name: str = "model text",
    chain: tuple[Path, ...] = (), thickness: float | None = None,
) -> Model:  # fmt: skip
    """Return the model that the tables of a TOML text describe; ``folder`` and ``name`` as in :func:`loads`.

    ``chain`` holds the files that are being read: a part of a file may be a file with parts. ``thickness`` is that of
    bodies for which the text states none [m], where the file that it is a part of states one.

    Raises
    ------
    InputError
        As :func:`load`.
    """
    table = _checked(data, file_units(data, name), name)
    depth = table.analysis.thickness if "thickness" in table.analysis.model_fields_set else thickness
    return build(table, Path(folder), name, lambda part: _read_part(Path(folder) / part, chain, depth), depth)


def _checked(data: dict[str, Any], units: FileUnits, name: str) -> FileTable:
    """Return the tables of a file, checked; words for a fault come from the table of all keys."""
    context = {"units": units}
    with suppress(ValidationError):
        return table_for(data).model_validate(data, context=context)
    try:
        return file_table().model_validate(data, context=context)
    except ValidationError as error:
        raise first_fault(error, data, file_table(), name) from None


def _read_part(path: Path, chain: tuple[Path, ...], thickness: float | None) -> Model:
    """Return the model of a file that a part of another names."""
    own = path.resolve()
    if own in chain:
        names = " -> ".join(p.name for p in (*chain, own))
        msg = f"the file is a part of itself: {names}"
        raise InputError(msg, where=str(path), hint="a part may not hold the whole")
    return model_from_tables(
        read_tables(path), folder=path.parent, name=str(path), chain=(*chain, own), thickness=thickness
    )


def parse(text: str, name: str) -> dict[str, Any]:
    """Return the tables of a TOML text, which must not be empty nor hold numbers that are not finite."""
    if not text.strip():
        msg = "the file is empty"
        raise InputError(msg, where=name, hint="start from a commented one: concio new panel")
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(error, text, name) from None
    except RecursionError:
        msg = "the tables are nested too deeply"
        raise InputError(msg, where=name) from None
    except ValueError:  # Python reads no whole number of more than 4,300 digits
        msg = "a whole number has too many digits"
        raise InputError(msg, where=name, hint="write large numbers as 1e9") from None
    if not data:
        msg = "the file holds only comments"
        raise InputError(msg, where=name, hint="start from a commented one: concio new panel")
    check_depth(data, name)
    check_finite(data, name)
    return data


def _syntax_error(error: tomllib.TOMLDecodeError, text: str, name: str) -> InputError:
    said = str(error)
    match = re.search(r"\s*\(at (?:line (\d+), column (\d+)|end of document)\)$", said)
    place, hint = name, "the file is not valid TOML"
    if match:
        said = said[: match.start()]
        if match.group(1):
            number = int(match.group(1))
            line = text.split("\n")[number - 1].strip()
            place = f"{name}, line {number}, column {match.group(2)}"
            hint += f"; the line reads: {line[:80]}" if line else ""
            if re.search(r"[=\[,]\s*[-+]?\.\d", line):
                hint = "numbers begin with a digit: 0.5, not .5"
            elif re.search(r"=\s*[-+]?\d+,\d+\s*(#.*)?$", line):
                hint = DECIMAL_COMMA
        else:
            place = f"{name}, last line"
    return InputError(said[:1].lower() + said[1:], where=place, hint=hint)


def file_units(data: dict[str, Any], name: str) -> FileUnits:
    """Return the system of units that the tables of a file state."""
    try:
        table = UnitsTable.model_validate(data.get("units", {}))
    except ValidationError as error:
        fault = first_fault(error, data.get("units"), UnitsTable, f"{name}, [units]")
        raise fault from None
    return FileUnits(quantity(f"1 {table.force}", "force"), quantity(f"1 {table.length}", "length"))
