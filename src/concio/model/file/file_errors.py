"""From what is wrong in a model file to one message: file, key, what is wrong, what to do."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

from concio.arguments import closest
from concio.errors import InputError

Location = tuple[int | str, ...]

PLAIN = {
    "string_type": "must be a text in quotation marks",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "list_type": "must be a list in brackets",
    "tuple_type": "must be a list in brackets",
    "model_type": "must be a table of keys",
    "dict_type": "must be a table of keys",
    "string_too_short": "must not be empty",
}
"""What to say for pydantic's commonest complaints."""


@contextmanager
def placed(place: str, *, own: str = "") -> Iterator[None]:
    """Put ``place`` in front of where an InputError says it was found; ``own`` is a first word to be left out."""
    try:
        yield
    except InputError as error:
        where = error.where or ""
        if own and (where == own or where.startswith(f"{own}, ")):
            where = where[len(own) + 2 :]
        raise type(error)(error.what, where=f"{place}, {where}" if where else place, hint=error.hint) from None


def key_path(data: Any, location: Location) -> str:
    """Return a place in a file as a reader finds it: ``[panel.block], E`` or ``[[blocks]] 3 'b3', outline``."""
    tables: list[str] = []
    rest: list[str] = []
    here = data
    for part in location:
        if isinstance(part, int):
            label = f"{part + 1}"
            here = here[part] if isinstance(here, list) and part < len(here) else None
            if isinstance(here, dict) and isinstance(here.get("name"), str):
                label += f" '{here['name']}'"
            rest.append(label)
            continue
        here = here.get(part) if isinstance(here, dict) else None
        is_list = isinstance(here, list) and bool(here) and isinstance(here[0], dict)
        if not rest and isinstance(here, dict):
            tables.append(part)
        elif not rest and is_list:
            rest.append(f"[[{'.'.join([*tables, part])}]]")
            tables = []
        else:
            rest.append(part)
    words = [f"[{'.'.join(tables)}]"] if tables else []
    if rest and rest[0].startswith("[["):
        rest = [" ".join(rest[:2]), *rest[2:]]
    return ", ".join(words + rest)


def first_fault(error: ValidationError, data: Any, root: type[BaseModel], where: str) -> InputError:
    """Return the first complaint of pydantic as a message for a person."""
    fault = _most_telling(error.errors(include_url=False))
    location: Location = tuple(part for part in fault["loc"] if not is_tag(part))
    kind = fault["type"]
    hint: str | None = None
    if kind == "extra_forbidden":
        key = str(location[-1])
        what, hint = f"unknown key '{key}'", closest(key, known_keys(root, location[:-1]))
        location = location[:-1]
    elif kind == "missing":
        absent = location[-1]
        what = f"value {absent + 1} is missing" if isinstance(absent, int) else f"'{absent}' is missing"
        location = location[:-1]
    elif kind == "concio":
        what, hint = fault["ctx"]["what"], fault["ctx"]["hint"] or None
    elif kind == "literal_error":
        what = f"{fault['input']!r} is not one of {fault['ctx']['expected'].replace(' or ', ', ')}"
    elif kind in ("too_short", "too_long", "missing_argument"):
        what = f"{fault['ctx']['actual_length']} values where {_expected(fault['ctx'])} are needed"
    else:
        said = fault["msg"].removeprefix("Value error, ")
        what = PLAIN.get(kind, said[:1].lower() + said[1:])
        if kind in PLAIN:
            what = f"{_short(fault['input'])} {what}"
    place = key_path(data, location)
    return InputError(what, where=f"{where}, {place}" if place else where, hint=hint)


def is_tag(part: int | str) -> bool:
    """Return whether a part of a location is the name of a branch of a union, ``<table>`` or ``dict[str,T]``."""
    return isinstance(part, str) and part.startswith(("<", "dict[", "list["))


def _expected(context: dict[str, Any]) -> str:
    return str(context.get("min_length", context.get("max_length", "others")))


def _short(value: Any) -> str:
    text = {True: "true", False: "false"}[value] if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _most_telling(faults: Sequence[Any]) -> Any:
    """Return the fault to report: an unknown key before the one that its misspelling leaves missing.

    A list that may be a table or a list of tables is at fault where its entries are, not for being no table.
    """
    first = faults[0]
    if first["type"] == "dict_type" and isinstance(first["input"], list):
        inside = [f for f in faults if len(f["loc"]) > len(first["loc"]) and f["loc"][:-1] != first["loc"][:-1]]
        return _most_telling(inside) if inside else first
    if first["type"] == "missing":
        table = first["loc"][:-1]
        return next((f for f in faults if f["type"] == "extra_forbidden" and f["loc"][:-1] == table), first)
    return first


def known_keys(root: type[BaseModel], location: Location) -> list[str]:
    """Return the keys of the table at a place of the schema."""
    table: Any = root
    for part in location:
        if isinstance(part, int):  # an entry of a list
            table = next(_models_in(table), None) if get_origin(table) is dict else table
            continue
        if get_origin(table) is dict:  # a name of the file's own
            table = get_args(table)[1]
        elif table is not None:
            member = table.model_fields.get(part)
            table = None if member is None else _by_name(member.annotation)
        if get_origin(table) is not dict:
            table = next(_models_in(table), None)
    return [] if table is None or get_origin(table) is dict else list(table.model_fields)


def _by_name(annotation: Any) -> Any:
    """Return the tables by name among the alternatives of an annotation; without any, the annotation."""
    return next((one for one in get_args(annotation) if get_origin(one) is dict), annotation)


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)


DEEPEST = 40
"""Tables within tables within tables: more than this is not a model file."""
LARGEST_NUMBER = 2**63
"""Whole numbers of a file are below this."""


def check_depth(data: Any, where: str) -> None:
    """Raise where tables and lists are nested deeper than :data:`DEEPEST`."""
    level: list[Any] = [data]
    for _ in range(DEEPEST):
        level = [
            value
            for holder in level
            for value in (holder.values() if isinstance(holder, dict) else holder)
            if isinstance(value, dict | list)
        ]
    if level:
        msg = f"tables are nested more than {DEEPEST} deep"
        raise InputError(msg, where=where, hint="keys have at most a few dots")


def check_finite(data: Any, where: str, location: Location = (), root: Any = None) -> None:
    """Raise where a number of a file is NaN, infinite or too large, whatever key it stands under."""
    root = data if root is None else root
    if isinstance(data, dict):
        for key, value in data.items():
            check_finite(value, where, (*location, key), root)
    elif isinstance(data, list):
        for i, value in enumerate(data):
            check_finite(value, where, (*location, i), root)
    elif isinstance(data, float) and not math.isfinite(data):
        msg = "the value is not a number (NaN)" if math.isnan(data) else "the value is not finite"
        raise InputError(msg, where=f"{where}, {key_path(root, location)}", hint="give a finite value")
    elif isinstance(data, int) and not isinstance(data, bool) and abs(data) >= LARGEST_NUMBER:
        msg = "the whole number is too large"
        raise InputError(msg, where=f"{where}, {key_path(root, location)}", hint="write large numbers as 1e9")
