"""Keys of a model file by path: ``wall.friction``, ``blocks[b1].thickness``, ``loads[2].value[1]``.

A path names tables and keys with points between them. Entries of lists stand in brackets, by their number from 1 on or,
where they have one, by their name. Names that hold points or brackets stand in quotation marks. A key that the file
does not state, but could, is created; any other is refused with the key that was probably meant.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from concio.arguments import closest
from concio.errors import InputError
from concio.model.file.file_errors import known_keys
from concio.model.file.file_table import file_table

_PART = re.compile(r'\.?(?:"([^"]*)"|\[([^\]]*)\]|([^.\[\]"]+))')


@dataclass(frozen=True)
class KeyPath:
    """The place of one value in the tables of a model file.

    Parameters
    ----------
    text : str
        The path as written.
    parts : tuple of str or int
        Keys of tables and indices of lists (from 0), from the root on.
    """

    text: str
    parts: tuple[str | int, ...]

    def get(self, data: Mapping[str, Any]) -> Any:
        """Return the value at this place of the tables ``data``, or None where the file does not state it."""
        here: Any = data
        for part in self.parts:
            if isinstance(part, int) or part in here:
                here = here[part]
            else:
                return None
        return here

    def put(self, data: dict[str, Any], value: Any) -> None:
        """Set the value at this place of ``data``, in place; missing tables on the way are made."""
        here: Any = data
        for part in self.parts[:-1]:
            here = here[part] if isinstance(part, int) else here.setdefault(part, {})
        here[self.parts[-1]] = value


def find_key(data: Mapping[str, Any], text: str, *, where: str = "") -> KeyPath:
    """Return the place that a path names in the tables of a model file.

    Parameters
    ----------
    data : mapping
        Tables as read from TOML.
    text : str
        The path.
    where : str
        Name of the file, for messages.

    Raises
    ------
    InputError
        The path names nothing that the file holds or could hold.
    """
    parts: list[str | int] = []
    location: tuple[str, ...] = ()
    here: Any = data
    for word, bracket in _words(text, where):
        if bracket:
            index = _entry(here, word, text, where)
            parts.append(index)
            here = here[index]
            continue
        known = known_keys(file_table(), location)
        held = list(here) if isinstance(here, Mapping) else []
        if here is not None and not isinstance(here, Mapping):
            msg = f"'{text}': there are no keys below a {'list' if isinstance(here, list) else 'value'}"
            hint = "name an entry of a list in brackets, as in loads[1].value[2]" if isinstance(here, list) else None
            raise InputError(msg, where=where or None, hint=hint)
        if word not in held and word not in known:
            msg = f"'{text}': there is no key '{word}'"
            raise InputError(
                msg, where=where or None, hint=closest(word, [*held, *(k for k in known if k not in held)])
            )
        parts.append(word)
        location = (*location, word)
        here = here.get(word) if isinstance(here, Mapping) else None
    if isinstance(here, Mapping) or (isinstance(here, list) and here and isinstance(here[0], Mapping)):
        msg = f"'{text}' is a table, not a value"
        held = list(here) if isinstance(here, Mapping) else [f"[{k + 1}]" for k in range(min(len(here), 9))]
        raise InputError(msg, where=where or None, hint="its keys: " + ", ".join(held))
    return KeyPath(text, tuple(parts))


def with_values(data: Mapping[str, Any], values: Mapping[KeyPath, Any]) -> dict[str, Any]:
    """Return a copy of the tables ``data`` with other values at some places."""
    changed = copy.deepcopy(dict(data))
    for place, value in values.items():
        place.put(changed, value)
    return changed


def _words(text: str, where: str) -> list[tuple[str, bool]]:
    """Return the parts of a path, and whether each stood in brackets."""
    found, at = [], 0
    while at < len(text):
        match = _PART.match(text, at)
        if match is None or (at == 0 and text[0] in ".["):
            break
        quoted, bracket, plain = match.groups()
        if bracket is not None:
            found.append((bracket.strip(" \"'"), True))
        else:
            found.append((plain if quoted is None else quoted, False))
        at = match.end()
    if not found or at < len(text):
        msg = f"'{text}' is not a path of a key"
        raise InputError(msg, where=where or None, hint="write for example wall.friction, or loads[1].value[2]")
    return found


def _entry(here: Any, word: str, text: str, where: str) -> int:
    """Return the index of the entry of a list that ``word`` numbers (from 1) or names."""
    if not isinstance(here, list) or not here:
        msg = f"'{text}': there is no list that [{word}] could be an entry of"
        raise InputError(msg, where=where or None, hint="brackets stand behind lists, as in loads[1].value[2]")
    names = [entry.get("name") for entry in here if isinstance(entry, Mapping)]
    if word in names:
        return names.index(word)
    if word.isdigit() and 1 <= int(word) <= len(here):
        return int(word) - 1
    msg = f"'{text}': there is no entry [{word}] among {len(here)}"
    known = [str(name) for name in names if name]
    raise InputError(
        msg, where=where or None, hint=closest(word, known) if known else f"numbers go from 1 to {len(here)}"
    )
