"""Descriptions of the keys of a model file, from the docstrings of what the keys are arguments of."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any, Unpack, get_args, get_origin, get_type_hints

from concio.model.generate.generator_arguments import Common
from concio.model.generate.generators import GENERATORS

REFERENCE = re.compile(r":(?:class|func):`[~!]?(concio[\w.]+)`")
TABLE = re.compile(r'"#/\$defs/([^"]+)"')
ROLE = re.compile(r":\w+:`(?:[^`<]*<)?[~!]?([^`>]+)>?`")
ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: :|$)")
ELSEWHERE = re.compile(r"^(?:As in|See) :(?:class|func):`[~!]?([\w.]+)`")
HEAD = re.compile(r"\n\n(?:Keys|Parameters)\n")
QUANTITY = re.compile(r"with a unit|another unit|^in |text with m/s2")
"""How the descriptions of kinds of quantities are known: they tell the unit, not what the key is."""
UNIT = re.compile(r" ?\[(?:k?N?m?[/\w]*|degrees|rad|1/s|s)\](?= |[.,;]|$)")
SECTIONS = ("Parameters", "Keys", "Attributes")


def described(schema: dict[str, Any]) -> dict[str, Any]:
    """Return a JSON Schema in which every key has a description where a docstring gives one.

    Parameters
    ----------
    schema : dict
        With the tables of a model file under ``$defs``; it is not changed.
    """
    tables = {name: _described(name, table) for name, table in schema["$defs"].items()}
    whole = {**_described("concio model", schema), "$defs": tables}
    for table in (whole, tables["part"]):
        table["properties"] = {key: _by_table(entry, tables) for key, entry in table["properties"].items()}
    return whole


def _by_table(entry: dict[str, Any], tables: dict[str, Any]) -> dict[str, Any]:
    """Return a key that holds a table, described by what the table is."""
    names = TABLE.findall(json.dumps(entry))
    if "description" in entry or not names:
        return entry
    first = tables[names[0]]["description"].split("\n", 1)[0].removeprefix("Return ")
    return {**entry, "description": first[0].upper() + first[1:]}


def _described(name: str, table: dict[str, Any]) -> dict[str, Any]:
    """Return a table whose keys have descriptions."""
    own = table.get("description", "")
    told = {key: _plain(text) for key, text in _entries(own)}
    for source in _sources(name, own):
        told = {**parameters(source), **told}
    keys = dict(table.get("properties", {}))
    for key, entry in keys.items():
        quantity, text = entry.get("description", ""), told.get(key, "")
        if text and QUANTITY.search(quantity):
            text = UNIT.sub("", text).strip(". ")
            keys[key] = {**entry, "description": f"{text} ({quantity})" if text else quantity}
        elif text and not quantity:
            keys[key] = {**entry, "description": text}
    head = _plain(HEAD.split(own, maxsplit=1)[0])
    return {**table, **({"description": head} if own else {}), **({"properties": keys} if keys else {})}


def _sources(name: str, description: str) -> list[Any]:
    """Return what a table holds the arguments of."""
    if name in GENERATORS:
        return [GENERATORS[name], _common(GENERATORS[name])]
    return [_named(path, None) for path in REFERENCE.findall(HEAD.split(description, maxsplit=1)[0])]


def _common(function: Callable[..., Any]) -> type:
    """Return the options that a generator shares with others."""
    hints = get_type_hints(function)
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind is inspect.Parameter.VAR_KEYWORD and get_origin(hints[name]) is Unpack:
            shared: type = get_args(hints[name])[0]
            return shared
    return Common


def parameters(thing: Any) -> dict[str, str]:
    """Return what the docstring of a function or class says of each argument, on one line, by name.

    Examples
    --------
    >>> from concio.model.file.descriptions import parameters
    >>> from concio.model.materials import JointLaw
    >>> parameters(JointLaw)["friction"]
    'Coulomb coefficient mu >= 0, or its angle: `"31 deg"`.'
    """
    found = dict(_entries(inspect.getdoc(thing) or ""))
    for name, text in found.items():
        if there := ELSEWHERE.match(text):
            other = parameters(_named(there[1], thing))
            found[name] = other.get(name, text)
    return {name: _plain(text) for name, text in found.items()}


def _named(path: str, beside: Any) -> Any:
    """Return what a reference in the docstring of a thing names."""
    module, _, own = path.rpartition(".")
    return getattr(import_module(module or beside.__module__), own)


def _entries(doc: str) -> Iterator[tuple[str, str]]:
    """Yield names and descriptions of the arguments in a docstring."""
    found: dict[str, list[str]] = {}
    section, names = "", [""]
    lines = doc.split("\n")
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        if below and set(below) == {"-"}:
            section = line
        elif section in SECTIONS and (entry := ENTRY.match(line)):
            names = [name.lstrip("*") for name in entry[1].split(", ")]
            found |= {name: [] for name in names}
        elif section in SECTIONS and line.startswith("    "):
            for name in names:
                found[name].append(line.strip())
    yield from ((name, " ".join(text)) for name, text in found.items() if text)


def _plain(text: str) -> str:
    """Return a text without the markup of references."""
    return ROLE.sub(lambda m: m[1], text).replace("``", "`")
