"""The exchange structure of ISO 10303-21 (STEP), in which IFC files are written: numbered instances with arguments.

``#12= IFCCARTESIANPOINT((0.,1.,2.5));`` is instance 12 of class IFCCARTESIANPOINT with one argument, a list of three
numbers. Instances are distinguished in one pass over the text; their arguments are read when somebody asks for them,
since most of a building model is not geometry.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from concio.errors import InputError
from concio.files import read_text

DEEPEST = 30
"""Lists within lists may go so deep."""
_STATEMENT = re.compile(r"\s*(?:#(\d{1,15})\s*=\s*(\w*)\s*(\((?:[^';]++|'[^']*+')*+);|ENDSEC\s*;)")
_COMMENT = re.compile(r"('[^']*+')|/\*.*?\*/", re.DOTALL)
_TOKEN = re.compile(
    r"\s*(?:([-+]?(?:\d++\.?\d*+|\.\d++)(?:[eE][-+]?\d{1,4})?)|#(\d{1,15})|'((?:[^']++|'')*+)'|\.(\w++)\."
    r"|([A-Za-z_]\w*+)\s*(?=\()|([(),$*]))"
)
_ESCAPE = re.compile(r"\\X2\\((?:[0-9A-Fa-f]{4})*)\\X0\\|\\X\\([0-9A-Fa-f]{2})|\\S\\(.)|\\(\\)", re.DOTALL)


class Reference(int):
    """The number of another instance."""


class Word(str):
    """A value of an enumeration, without its dots: T, F, LENGTHUNIT."""

    __slots__ = ()


@dataclass(frozen=True)
class Typed:
    """A value that names its type: ``IFCLENGTHMEASURE(0.3048)``."""

    kind: str
    value: Any


@dataclass(frozen=True, eq=False)
class Instance:
    """One instance; what its arguments are not is reported with its number and class.

    Parameters
    ----------
    file : StepFile
    number : int
    kind : str
        Its class in capital letters.
    arguments : tuple
        None for what is left open.
    """

    file: StepFile
    number: int
    kind: str
    arguments: tuple[Any, ...]

    @property
    def label(self) -> str:
        """Number and class, for messages."""
        return f"#{self.number} {self.kind}"

    def refuse(self, what: str, hint: str = "") -> NoReturn:
        """Raise the error that says what is wrong with this instance."""
        msg = f"{self.label} {what}"
        raise InputError(msg, hint=hint)

    def value(self, place: int) -> Any:
        """Return an argument, None where it is left open or there are fewer."""
        return self.arguments[place] if place < len(self.arguments) else None

    def number_at(self, place: int) -> float:
        """Return an argument that must be a number."""
        value = self.value(place)
        value = value.value if isinstance(value, Typed) else value
        if isinstance(value, bool | Reference) or not isinstance(value, int | float) or not math.isfinite(value):
            self.refuse(f"has no number as argument {place + 1}")
        return float(value)

    def numbers(self, place: int, count: int) -> list[float]:
        """Return an argument that must be a list of at least ``count`` numbers: the first ones."""
        return self.checked(self.value(place), count, place)

    def checked(self, value: Any, count: int, place: int) -> list[float]:
        """Return ``count`` numbers from a list of an argument."""
        if not isinstance(value, tuple) or len(value) < count:
            self.refuse(f"has no list of {count} numbers as argument {place + 1}")
        found = value[:count]
        if any(type(v) not in (int, float) or not math.isfinite(v) for v in found):
            self.refuse(f"has something else than numbers in argument {place + 1}")
        return [float(v) for v in found]

    def rows(self, place: int, count: int) -> list[list[float]]:
        """Return an argument that must be a list of lists of at least ``count`` numbers."""
        return [self.checked(row, count, place) for row in self.listed(place)]

    def listed(self, place: int) -> tuple[Any, ...]:
        """Return an argument that must be a list."""
        value = self.value(place)
        if not isinstance(value, tuple):
            self.refuse(f"has no list as argument {place + 1}")
        return value

    def instance(self, place: int) -> Instance:
        """Return the instance that an argument refers to."""
        return self._followed(self.value(place), place)

    def open_instance(self, place: int) -> Instance | None:
        """Return the instance that an argument refers to, None where it is left open."""
        return None if self.value(place) is None else self.instance(place)

    def instances(self, place: int) -> list[Instance]:
        """Return the instances that a list refers to."""
        return [self._followed(v, place) for v in self.listed(place)]

    def _followed(self, value: Any, place: int) -> Instance:
        if not isinstance(value, Reference):
            self.refuse(f"refers to nothing in argument {place + 1}")
        if value not in self.file:
            self.refuse(f"refers to #{value}, which is not in the file", "was the file cut? Save it once more")
        return self.file[value]

    def text(self, place: int) -> str:
        """Return an argument as text, empty where it is left open."""
        value = self.value(place)
        return value if isinstance(value, str) else ""


class StepFile:
    """All instances of a file.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    schema : str
        As the header names it, in capital letters: IFC4.

    Raises
    ------
    InputError
        The file is missing, cut off, or no exchange structure; the message names the line.
    """

    def __init__(self, path: Path) -> None:
        where = str(path)
        text = read_text(path, latin=True)
        if not text.lstrip().startswith("ISO-10303-21;"):
            begin = "".join(c if c.isprintable() else "?" for c in " ".join(text[:40].split()))
            msg = f"the file does not begin with 'ISO-10303-21;' but with '{begin}'"
            hint = "save it as IFC in the STEP physical file format (.ifc, not ifcXML, ifcZIP or JSON)"
            raise InputError(msg, where=where, hint=hint)
        if "/*" in text:
            text = _COMMENT.sub(lambda found: found[1] or " ", text)
        data = re.search(r"\bDATA\s*(\([^;]*\))?\s*;", text)
        schema = re.search(r"FILE_SCHEMA\s*\(\s*\(\s*'([^']*)'", text[: data.start()] if data else text)
        if data is None or schema is None:
            msg = "the file has no section " + ("DATA" if data is None else "HEADER with a FILE_SCHEMA")
            raise InputError(msg, where=where, hint="was it cut off? Save it once more")
        self.schema = schema[1].upper()
        self.where = where
        self._raw: dict[int, tuple[str, str]] = {}
        self._read: dict[int, Instance] = {}
        self.by_kind: dict[str, list[int]] = {}
        at = data.end()
        while True:
            found = _STATEMENT.match(text, at)
            if found is None:
                raise self._unreadable(text, at)
            at = found.end()
            if found[1] is None:
                break
            number, kind = int(found[1]), found[2].upper()
            if number in self._raw:
                msg = f"line {text.count(chr(10), 0, found.start(1)) + 1}: #{number} is given twice"
                raise InputError(msg, where=where, hint="each instance needs a number of its own")
            self._raw[number] = (kind, found[3])
            self.by_kind.setdefault(kind, []).append(number)

    def _unreadable(self, text: str, at: int) -> InputError:
        rest = text[at:].lstrip()
        line = text.count("\n", 0, len(text) - len(rest)) + 1
        if ";" not in rest:
            last = f" after #{next(reversed(self._raw))}" if self._raw else ""
            msg = f"the file was cut off{last} (line {line}): its section DATA has no end"
            return InputError(msg, where=self.where, hint="save it once more")
        msg = f"line {line} is not an instance: '{' '.join(rest[:60].split())}'"
        return InputError(msg, where=self.where, hint="write '#12= IFCCARTESIANPOINT((0.,0.,0.));'")

    def __contains__(self, number: object) -> bool:
        return number in self._raw

    def __getitem__(self, number: int) -> Instance:
        found = self._read.get(number)
        if found is None:
            kind, text = self._raw[number]
            found = self._read[number] = Instance(self, int(number), kind, _arguments(text, f"#{number} {kind}"))
        return found

    def of_kind(self, *kinds: str) -> list[Instance]:
        """Return the instances of some classes, in the order of the file."""
        return [self[number] for kind in kinds for number in self.by_kind.get(kind, ())]

    def roots(self) -> list[int]:
        """Return the instances whose first argument is an identifier: products, their relations and properties."""
        return [n for n, (_, text) in self._raw.items() if text.startswith("('") or text[1:].lstrip()[:1] == "'"]

    def kind(self, number: int) -> str:
        """Return the class of an instance."""
        return self._raw[number][0]


def _arguments(text: str, label: str) -> tuple[Any, ...]:
    """Return the arguments in the brackets of an instance."""
    stack: list[tuple[str, list[Any]]] = []
    kind, at = "", 0
    while True:
        found = _TOKEN.match(text, at)
        if found is None or (not stack and found[6] != "("):
            raise _garbled(text[at:], label)
        at = found.end()
        number, reference, string, word, typed, sign = found.groups()
        if sign == "(":
            stack.append((kind, []))
            kind = ""
            if len(stack) > DEEPEST:
                msg = f"{label} is nested more than {DEEPEST} deep"
                raise InputError(msg)
        elif sign == ")":
            own, values = stack.pop()
            value: Any = tuple(values)
            if not stack:
                if text[at:].strip():
                    raise _garbled(text[at:], label)
                return tuple(values)
            stack[-1][1].append(Typed(own.upper(), value[0] if len(value) == 1 else value) if own else value)
        elif sign == ",":
            continue
        elif typed is not None:
            kind = typed
        else:
            stack[-1][1].append(_value(number, reference, string, word))


def _value(number: str | None, reference: str | None, string: str | None, word: str | None) -> Any:
    """Return a single value; signs that stand for nothing give None."""
    if number is not None:
        return int(number) if len(number) < 16 and number.lstrip("+-").isdigit() else float(number)
    if reference is not None:
        return Reference(reference)
    if string is not None:
        return decoded(string)
    return None if word is None else Word(word.upper())


def _garbled(rest: str, label: str) -> InputError:
    msg = f"{label} cannot be read at '{' '.join(rest[:40].split())}'"
    return InputError(msg, hint="was the file edited by hand? Save it once more")


def decoded(text: str) -> str:
    """Return a text with doubled apostrophes and the escapes of letters outside ASCII resolved."""
    text = text.replace("''", "'")
    return _ESCAPE.sub(_letter, text) if "\\" in text else text


def _letter(found: re.Match[str]) -> str:
    if found[1] is not None:
        return bytes.fromhex(found[1]).decode("utf-16-be", errors="replace")
    if found[2] is not None:
        return bytes.fromhex(found[2]).decode("latin-1")
    return chr((ord(found[3]) + 128) % 0x110000) if found[3] is not None else "\\"
