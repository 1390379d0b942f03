"""Changes of a model's text: a value set, a table added or removed; everything else stays as the user wrote it.

Each change is a :class:`Patch`, the smallest piece of text that is replaced. The new text is read again, and a change
that would give anything else than what was asked for is refused: the text can then be edited by hand.
"""

from __future__ import annotations

import copy
import itertools
import json
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from concio.errors import InputError
from concio.window.toml_places import BARE, KeyPath, Places, places

BY_HAND = "change it in the text of the model"


@dataclass(frozen=True)
class Patch:
    """A piece of text that takes the place of another: from ``start`` on, ``removed`` becomes ``inserted``."""

    start: int
    removed: str
    inserted: str

    def applied(self, text: str) -> str:
        """Return the text with the change.

        Raises
        ------
        InputError
            What is to be replaced does not stand there.
        """
        end = self.start + len(self.removed)
        if self.start < 0 or text[self.start : end] != self.removed:
            msg = "the text has changed since: this change does not fit"
            raise InputError(msg, hint="look at the model again")
        return text[: self.start] + self.inserted + text[end:]

    @property
    def inverse(self) -> Patch:
        """The patch that takes it back."""
        return Patch(self.start, self.inserted, self.removed)


def difference(old: str, new: str) -> Patch:
    """Return the smallest single patch from one text to another."""
    start, most = 0, min(len(old), len(new))
    step = most
    while step:  # the common beginning, by halves: texts may be long
        if old[start : start + step] == new[start : start + step] and start + step <= most:
            start += step
        else:
            step //= 2
    end, step = 0, most - start
    while step:
        a, b = len(old) - end, len(new) - end
        if end + step <= most - start and old[a - step : a] == new[b - step : b]:
            end += step
        else:
            step //= 2
    return Patch(start, old[start : len(old) - end], new[start : len(new) - end])


def literal(value: object) -> str:
    """Return a value as TOML writes it.

    Raises
    ------
    InputError
        TOML has no such value, or a number is not finite.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            msg = "a number must be finite"
            raise InputError(msg, hint="write a number")
        return repr(value)
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(literal, value)) + "]"
    if isinstance(value, Mapping):
        inner = ", ".join(f"{key_text(str(k))} = {literal(v)}" for k, v in value.items())
        return "{ " + inner + " }" if inner else "{}"
    msg = f"a model file holds no value such as {value!r}"
    raise InputError(msg, hint="write a text, a number, true, false, or a list")


def key_text(key: str) -> str:
    """Return a key as TOML writes it."""
    return key if BARE.fullmatch(key) else _quoted(key)


def _quoted(text: str) -> str:
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        msg = "the text holds half of a letter"
        raise InputError(msg, hint="write the text again") from None
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def set_value(text: str, path: KeyPath, value: Any) -> Patch:
    """Return the patch that sets the value at a path; a table that is missing is added.

    Raises
    ------
    InputError
        The text is not valid TOML, or the change cannot be made without touching others.
    """
    data = _read(text)
    wanted = _with(data, path, value)
    found = places(text)
    if path in found.values:
        at = found.values[path]
        patch = Patch(at.start, text[at.start : at.end], literal(value))
    elif path in found.inline_tables:
        at = found.inline_tables[path]
        patch = Patch(at.start, text[at.start : at.end], literal(value))
    else:
        patch = _new_value(text, path, value, found)
    return _checked(text, patch, wanted, path)


def add_table(text: str, name: str, entries: Mapping[str, Any]) -> Patch:
    """Return the patch that adds a table ``[[name]]`` at the end of the text, after those there are.

    Raises
    ------
    InputError
        The text is not valid TOML, or has ``name`` already as something else than a list of tables.
    """
    data = _read(text)
    before = data.get(name, [])
    if not isinstance(before, list):
        msg = f"'{name}' is not a list of tables"
        raise InputError(msg, hint=BY_HAND)
    kept = {k: v for k, v in entries.items() if v is not None}
    wanted = {**data, name: [*before, kept]}
    found = places(text)
    own = [h for h in found.headers if h.path[:1] == (name,)]
    end = own[-1].end if own else len(text)
    lines = "".join(f"{key_text(k)} = {literal(v)}\n" for k, v in kept.items())
    gap = "" if end == 0 or text[:end].endswith("\n\n") else "\n" if text[:end].endswith("\n") else "\n\n"
    block = f"{gap}[[{key_text(name)}]]\n{lines}"
    if own and end < len(text) and not text[end:].startswith("\n"):
        block += "\n"
    return _checked(text, Patch(end, "", block), wanted, (name,))


def remove(text: str, path: KeyPath) -> Patch:
    """Return the patch that removes a table or a value.

    Raises
    ------
    InputError
        The text is not valid TOML, there is no such path, or it cannot be removed alone.
    """
    data = _read(text)
    wanted = _without(data, path)
    found = places(text)
    own = [h for h in found.headers if h.path[: len(path)] == path]
    if path in found.values and not found.values[path].inline:
        at = found.values[path]
        start = text.rfind("\n", 0, at.key) + 1
        end = text.find("\n", at.end)
        patch = Patch(start, text[start : len(text) if end < 0 else end + 1], "")
    elif own and all(b.start >= a.end for a, b in itertools.pairwise(own)):
        start, end = own[0].start, own[-1].end
        if any(start < h.start < end and h not in own for h in found.headers):
            raise _cannot(path)
        while text[:start].endswith("\n\n") and (end >= len(text) or text[end] == "\n"):
            start -= 1
        patch = Patch(start, text[start:end], "")
    else:
        raise _cannot(path)
    return _checked(text, patch, wanted, path)


def _new_value(text: str, path: KeyPath, value: Any, found: Places) -> Patch:
    parent, key = path[:-1], path[-1]
    line = f"{key_text(str(key))} = {literal(value)}\n"
    if parent in found.inline_tables:
        at = found.inline_tables[parent]
        empty = not text[at.start + 1 : at.end - 1].strip()
        piece = f"{key_text(str(key))} = {literal(value)}"
        return Patch(at.start + 1, "", f" {piece} " if empty else f" {piece},")
    if not parent:
        end = found.top_end
        if end == 0 and found.headers:
            end = _comment_block(text, found.headers[0].start)
            return Patch(end, "", line + "\n")
        return Patch(end, "", ("" if not end or text[:end].endswith("\n") else "\n") + line)
    header = found.header(parent)
    if header is not None:
        end = header.end
        return Patch(end, "", ("" if text[:end].endswith("\n") else "\n") + line)
    if any(isinstance(k, int) for k in parent):
        raise _cannot(path)
    gap = "" if not text or text.endswith("\n\n") else "\n" if text.endswith("\n") else "\n\n"
    return Patch(len(text), "", f"{gap}[{'.'.join(key_text(str(k)) for k in parent)}]\n{line}")


def _comment_block(text: str, start: int) -> int:
    """Return where the comment that stands right above a header begins, or the header's own place."""
    while start > 0:
        before = text.rfind("\n", 0, start - 1) + 1
        if not text[before:start].lstrip().startswith("#"):
            return start
        start = before
    return start


def _read(text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        msg = f"the text is not valid TOML: {error}"
        raise InputError(msg, hint="mend the text first, or undo") from None


def _with(data: dict[str, Any], path: KeyPath, value: Any) -> dict[str, Any]:
    changed = copy.deepcopy(data)
    at: Any = changed
    try:
        for key in path[:-1]:
            at = at.setdefault(key, {}) if isinstance(at, dict) else at[key]
        at[path[-1]] = value
    except (KeyError, IndexError, TypeError):
        raise _cannot(path) from None
    return changed


def _without(data: dict[str, Any], path: KeyPath) -> dict[str, Any]:
    changed = copy.deepcopy(data)
    at: Any = changed
    try:
        for key in path[:-1]:
            at = at[key]
        del at[path[-1]]
    except (KeyError, IndexError, TypeError):
        msg = f"there is nothing called {name_of(path)}"
        raise InputError(msg, hint="look at the model again") from None
    if at == [] and len(path) > 1:  # a list of tables whose last table goes is not there any more
        outer: Any = changed
        for key in path[:-2]:
            outer = outer[key]
        del outer[path[-2]]
    return changed


def _checked(text: str, patch: Patch, wanted: dict[str, Any], path: KeyPath) -> Patch:
    try:
        given = tomllib.loads(patch.applied(text))
    except (ValueError, RecursionError):
        raise _cannot(path) from None
    if json.dumps(given, sort_keys=True, default=str) != json.dumps(wanted, sort_keys=True, default=str):
        raise _cannot(path)
    return patch


def name_of(path: KeyPath) -> str:
    """Return a path in words, such as ``loads 2, at``."""
    return ", ".join(str(k + 1) if isinstance(k, int) else k for k in path).replace(", 1", " 1") or "the file"


def _cannot(path: KeyPath) -> InputError:
    return InputError(f"{name_of(path)} cannot be changed alone", hint=BY_HAND)
