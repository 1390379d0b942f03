"""Where the tables and values of a TOML text stand, so that a change touches nothing else that the user wrote.

:func:`places` reads a text that :mod:`tomllib` accepts. It finds values inside inline tables as well; lists are
values as a whole. Every change made with these places is checked by reading the new text again
(:mod:`concio.window.toml_edits`).
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass, field

KeyPath = tuple[str | int, ...]
"""Keys from the top of the file; tables of a list by their number from 0."""

BARE = re.compile(r"[A-Za-z0-9_-]+")
STRINGS = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|' r"'''.*?'{3,5}|" r'"(?:\\.|[^"\\\n])*"|' r"'[^'\n]*'", re.DOTALL
)  # fmt: skip
SPACE = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
BLANK = re.compile(r"[ \t]*")


@dataclass(frozen=True)
class Value:
    """A value in a text: where its key begins, and from where to where it stands."""

    key: int
    start: int
    end: int
    inline: bool = False


@dataclass(frozen=True)
class Header:
    """The header of a table: its path, where its line begins, and where its own lines end."""

    path: KeyPath
    start: int
    end: int
    listed: bool


@dataclass
class Places:
    """Places of values and headers by their paths; headers in the order of the text."""

    values: dict[KeyPath, Value] = field(default_factory=dict)
    headers: list[Header] = field(default_factory=list)
    inline_tables: dict[KeyPath, Value] = field(default_factory=dict)
    top_end: int = 0

    def header(self, path: KeyPath) -> Header | None:
        """Return the header of a table, or None."""
        return next((h for h in self.headers if h.path == path), None)


def places(text: str) -> Places:
    """Return where the tables and values of a text that is valid TOML stand."""
    found = Places()
    counted: dict[KeyPath, int] = {}
    here: KeyPath = ()
    opened: list[tuple[KeyPath, int, bool]] = []
    at = last = 0
    while True:
        at = _end(SPACE, text, at)
        if at >= len(text):
            break
        if text[at] == "[":
            if not opened:
                found.top_end = last
            else:
                found.headers.append(Header(opened[-1][0], opened[-1][1], last, opened[-1][2]))
            listed = text.startswith("[[", at)
            keys, end = _keys(text, at + 1 + listed)
            here = _numbered(keys, counted, listed=listed)
            opened.append((here, text.rfind("\n", 0, at) + 1, listed))
            at = last = _line_end(text, text.index("]", end) + 1 + listed)
        else:
            at = last = _line_end(text, _pair(text, at, here, found, inline=False))
    if opened:
        found.headers.append(Header(opened[-1][0], opened[-1][1], last, opened[-1][2]))
    else:
        found.top_end = last
    return found


def _end(pattern: re.Pattern[str], text: str, at: int) -> int:
    match = pattern.match(text, at)
    return match.end() if match else at


def _line_end(text: str, at: int) -> int:
    """Return where the line of ``at`` ends, its comment and its line feed included."""
    end = text.find("\n", at)
    return len(text) if end < 0 else end + 1


def _keys(text: str, at: int) -> tuple[KeyPath, int]:
    keys: list[str] = []
    while True:
        at = _end(BLANK, text, at)
        match = STRINGS.match(text, at) or BARE.match(text, at)
        assert match is not None, "the text is valid TOML"
        word = match.group()
        keys.append(tomllib.loads(f"k = {word}")["k"] if word[0] in "\"'" else word)
        at = _end(BLANK, text, match.end())
        if not text.startswith(".", at):
            return tuple(keys), at
        at += 1


def _numbered(keys: KeyPath, counted: dict[KeyPath, int], *, listed: bool) -> KeyPath:
    """Return the path of a header: each list of tables on the way stands for its last table."""
    path: KeyPath = ()
    for k, key in enumerate(keys):
        path = (*path, key)
        if listed and k == len(keys) - 1:
            counted[path] = counted.get(path, -1) + 1
        if path in counted:
            path = (*path, counted[path])
    return path


def _pair(text: str, at: int, here: KeyPath, found: Places, *, inline: bool) -> int:
    """Read a key with its value; return where the value ends."""
    begin = at
    keys, at = _keys(text, at)
    start = _end(BLANK, text, at + 1)
    path = (*here, *keys)
    end = _value(text, start, path, found)
    found.values[path] = Value(begin, start, end, inline)
    return end


def _value(text: str, at: int, path: KeyPath, found: Places) -> int:
    """Return where the value that begins at ``at`` ends; values of an inline table are put down."""
    if match := STRINGS.match(text, at):
        return match.end()
    if text[at] == "{":
        start, at = at, _end(SPACE, text, at + 1)
        while text[at] != "}":
            at = _end(SPACE, text, _pair(text, at, path, found, inline=True))
            at = _end(SPACE, text, at + (text[at] == ","))
        found.inline_tables[path] = Value(start, start, at + 1, inline=True)
        return at + 1
    if text[at] == "[":
        return _list(text, at)
    while at < len(text) and text[at] not in ",]}#\n\r":
        at += 1
    while text[at - 1] in " \t":
        at -= 1
    return at


def _list(text: str, at: int) -> int:
    """Return where a list ends."""
    depth = 0
    while True:
        if match := STRINGS.match(text, at):
            at = match.end()
        elif text[at] == "#":
            at = _line_end(text, at)
        else:
            depth += (text[at] in "[{") - (text[at] in "]}")
            at += 1
            if depth == 0:
                return at
