"""What the page may do with a document: small commands, each of which becomes one patch of the text."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Mapping
from typing import Any

from concio.errors import InputError
from concio.window.block_edits import BLOCK_COMMANDS
from concio.window.own_units import table_in_file, value_in_file
from concio.window.toml_edits import Patch, add_table, difference, literal, remove, set_value
from concio.window.toml_places import KeyPath

Command = Mapping[str, Any]
LISTS = ("loads", "supports", "ties", "temperatures", "blocks", "rules", "stages")
"""Lists of tables to which the page may add."""
DEEPEST = 12


def patch_of(text: str, command: Command) -> tuple[Patch, str]:
    """Return the patch of a command, and the command in a few words.

    Parameters
    ----------
    text : str
        Text of the model.
    command : mapping
        ``{"do": "set", "path": [...], "value": ...}``, ``{"do": "add", "to": "loads", "table": {...}}``,
        ``{"do": "remove", "path": [...]}``, ``{"do": "text", "text": "..."}``.

    Raises
    ------
    InputError
        The command is not one of these, or cannot be carried out on this text.
    """
    make = _COMMANDS.get(str(command.get("do")))
    if make is None:
        msg = f"unknown command '{command.get('do')}'"
        raise InputError(msg, hint="one of " + ", ".join(_COMMANDS))
    return make(text, command)


def path_of(given: Any) -> KeyPath:
    """Return the path that the page names.

    Raises
    ------
    InputError
        It is not a list of keys and numbers.
    """
    sound = isinstance(given, list) and 0 < len(given) <= DEEPEST
    if not sound or not all(isinstance(k, str) or (type(k) is int and k >= 0) for k in given):
        msg = "a path is a list of keys and numbers"
        raise InputError(msg, hint="for example ['loads', 0, 'value']")
    return tuple(given)


def value_of(given: Any, depth: int = 0) -> Any:
    """Return a value that the page gives; whole numbers stay whole.

    Raises
    ------
    InputError
        TOML has no such value.
    """
    if given is None or depth > DEEPEST or (isinstance(given, float) and not math.isfinite(given)):
        msg = "a value is missing, or is not finite"
        raise InputError(msg, hint="write a number or a text")
    if isinstance(given, list):
        return [value_of(v, depth + 1) for v in given]
    if isinstance(given, dict):
        return {str(k): value_of(v, depth + 1) for k, v in given.items()}
    literal(given)
    return given


def written_value(text: str) -> Any:
    """Return what a person wrote into a field: a TOML value where it is one, otherwise the text itself."""
    try:
        return tomllib.loads(f"value = {text}")["value"] if "\n" not in text else text
    except (ValueError, RecursionError):
        return text


def _set(text: str, command: Command) -> tuple[Patch, str]:
    path = path_of(command.get("path"))
    if "written" in command:
        value = written_value(str(command["written"]))
    else:
        value = value_in_file(value_of(command.get("value")), path, text)
    return set_value(text, path, value), f"set {path[-1]}"


def _add(text: str, command: Command) -> tuple[Patch, str]:
    name, table = command.get("to"), command.get("table")
    if name not in LISTS or not isinstance(table, dict):
        msg = f"nothing can be added to '{name}'"
        raise InputError(msg, hint="one of " + ", ".join(LISTS))
    entries = {key: value_of(value) for key, value in table.items() if value is not None}
    return add_table(text, name, table_in_file(entries, text)), f"add {name}"


def _remove(text: str, command: Command) -> tuple[Patch, str]:
    path = path_of(command.get("path"))
    return remove(text, path), f"remove {path[0]}"


def _text(text: str, command: Command) -> tuple[Patch, str]:
    new = command.get("text")
    if not isinstance(new, str):
        msg = "the text is missing"
        raise InputError(msg, hint="send the whole text of the model")
    literal(new)
    return difference(text, new.replace("\r\n", "\n")), "edit text"


_COMMANDS: dict[str, Callable[[str, Command], tuple[Patch, str]]] = {
    "set": _set, "add": _add, "remove": _remove, "text": _text, **BLOCK_COMMANDS,
}  # fmt: skip
