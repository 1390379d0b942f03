"""Write the pages of ``docs/reference``: keys of model files from their schema, commands from their options.

    python docs/make_references.py

A test compares the pages with what this writes.
"""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from typer.models import ArgumentInfo, OptionInfo

from concio.cli.main import COMMANDS, EXIT_CODES
from concio.model.file.file_table import json_schema
from concio.model.generate.generators import GENERATORS

HERE = Path(__file__).parent / "reference"
KIND = re.compile(r"^(?:.*\()?(length|unit weight|stress|force|stiffness|joint stiffness|moment): a number")
QUANTITY = re.compile(r" \((?:[^()]*(?:\([^()]*\))?[^()]*(?:with a unit|another unit|text with m/s2|\bdeg')|in s)\)$")
GROUPS = {
    "The file": ("title", "units", "report", "analysis", "solver", "record"),
    "Materials and joints": ("materials", "joints", "rules"),
    "Blocks, one by one or from files": (
        "blocks", "blocks_file", "drawing", "solids_file", "solids", "extrusion", "periods", "parts",
    ),
    "Loads, supports, ties": ("loads", "supports", "temperatures", "ties", "stages"),
    "Bridges": ("bridge", "bridge_drawing", "fill", "vehicle"),
    "Generators in the plane": (
        "panel", "wall", "wall_of_courses", "arch", "arch_on_piers", "column", "buttress", "rubble", "cell",
    ),
    "Generators in space": ("walls", "tower", "barrel", "dome", "cloister_vault", "cross_vault", "drums"),
    "Analyses": ("motion", "site", "assessment", "survey", "study"),
}  # fmt: skip
"""Tables of a file by what they are for."""


def main() -> None:
    """Write the pages."""
    HERE.mkdir(exist_ok=True)
    for name, text in pages().items():
        (HERE / name).write_text(text, encoding="utf-8")


def pages() -> dict[str, str]:
    """Return the pages by file name."""
    return {"model_file.md": model_file(), "commands.md": commands()}


# -- model files ----------------------------------------------------------------------------------------------------


def model_file() -> str:
    """Return the page of all keys of a model file."""
    schema = json_schema()
    tables = schema["$defs"]
    lines = [
        "# Keys of a model file",
        "",
        "A model file is written in [TOML](https://toml.io). Every key is checked; one that is not known is refused, "
        "with the key that was probably meant. A bare number of a length, a force, a stress or a weight is in the "
        "system of `[units]`, kN and m by default; a text carries its unit: `\"25 cm\"`. Units in brackets, as [m], "
        "stand for that system. `concio schema` prints the same as a JSON Schema, which editors read for completion "
        "and checks.",
        "",
        "This page is written from that schema by `docs/make_references.py`.",
    ]  # fmt: skip
    told: set[str] = set()
    for title, keys in GROUPS.items():
        lines += ["", f"## {title}"]
        plain = [key for key in keys if not tables_of(schema["properties"][key])]
        if plain:
            lines += ["", *table_of({key: schema["properties"][key] for key in plain}, tables, {}, set())]
        for key in keys:
            if key not in plain:
                lines += section(key, schema["properties"][key], tables, told)
    missing = set(schema["properties"]) - {key for keys in GROUPS.values() for key in keys}
    if missing:
        msg = f"no group for {', '.join(sorted(missing))}"
        raise ValueError(msg)
    return "\n".join(lines) + "\n"


def section(key: str, entry: dict[str, Any], tables: dict[str, Any], told: set[str]) -> list[str]:
    """Return a table of the file and the tables in it that were not told before."""
    name, form = tables_of(entry)[0], f"[{key}]"
    if any(part.get("type") == "array" for part in (entry, *entry.get("anyOf", ()))):
        form = f"[[{key}]]"
    elif "additionalProperties" in entry:
        form = f"[{key}.NAME]"
    labels = [f"({anchor(key)})=", *([f"({place(name)})="] if name not in told and place(name) != anchor(key) else [])]
    lines = ["", *labels, f"### `{form}`", "", cell(entry["description"].rstrip(".")) + "."]
    return lines + body(name, tables, told, defaults_of(key))


def body(name: str, tables: dict[str, Any], told: set[str], defaults: dict[str, Any]) -> list[str]:
    """Return the keys of a table, then those of the tables in it."""
    told.add(name)
    table = tables[name]
    text = [part.replace("\n", " ") for part in table.get("description", "").split("\n\n")[1:]]
    keys = {k: v for k, v in table["properties"].items() if not (name == "part" and k in GENERATORS)}
    lines = [line for part in text for line in ("", part)]
    lines += ["", *table_of(keys, tables, defaults, set(table.get("required", ())))]
    if name == "part":
        lines += ["", "A part also takes the table of any generator, such as `[parts.arch]`."]
    for inner in dict.fromkeys(n for entry in keys.values() for n in tables_of(entry)):
        if inner not in told:
            about = tables[inner].get("description", "").split("\n", 1)[0]
            lines += ["", f"({place(inner)})=", f"#### {title_of(inner)}", "", about]
            lines += body(inner, tables, told, {})
    return lines


def table_of(
    keys: dict[str, Any], tables: dict[str, Any], defaults: dict[str, Any], required: set[str]
) -> list[str]:  # fmt: skip
    """Return the keys of a table with type, default and description."""
    lines = ["| Key | Value | Default | |", "|---|---|---|---|"]
    for key, entry in keys.items():
        default = "required" if key in required else shown(defaults.get(key, entry.get("default")))
        about = QUANTITY.sub("", entry.get("description", ""))
        about = "" if KIND.match(about) else about
        lines.append(f"| `{key}` | {kind(entry)} | {default} | {cell(about)} |")
    return lines


def kind(entry: dict[str, Any]) -> str:
    """Return what values a key takes, in words."""
    if found := KIND.match(entry.get("description", "")):
        return found[1]
    if "angle with a unit" in entry.get("description", ""):
        return "number or angle"
    if "degrees, or another unit" in entry.get("description", ""):
        return "angle, degrees"
    if "$ref" in entry:
        name = entry["$ref"].rsplit("/", 1)[-1]
        return f"[table](#{place(name)})"
    if "enum" in entry or "const" in entry:
        return ", ".join(f'`"{word}"`' for word in entry.get("enum", [entry.get("const")]))
    if "anyOf" in entry or "oneOf" in entry:
        parts = [p for p in entry.get("anyOf", entry.get("oneOf", ())) if p.get("type") != "null"]
        if {p.get("type") for p in parts} == {"number", "string"} and len(parts) == 2:
            return "number, or text with a unit"
        return " or ".join(dict.fromkeys(kind(p) for p in parts))
    if entry.get("type") == "array":
        inner = entry.get("items") or {}
        if "prefixItems" in entry:
            inner = entry["prefixItems"][0]
            return f"{len(entry['prefixItems'])} × {kind(inner)}"
        if entry.get("maxItems") == 3 and entry.get("minItems") == 2:
            return f"[x, y] or [x, y, z], {kind(inner)}"
        return f"list of {kind(inner)}"
    if isinstance(entry.get("additionalProperties"), dict):
        return f"{kind(entry['additionalProperties'])} by name"
    words = {"string": "text", "integer": "whole number", "boolean": "`true`, `false`", "number": "number"}
    return words.get(entry.get("type", ""), "table" if entry.get("type") == "object" else "any")


def tables_of(entry: Any) -> list[str]:
    """Return the names of the tables that a key holds."""
    return re.findall(r'"#/\$defs/([^"]+)"', json.dumps(entry))


def defaults_of(key: str) -> dict[str, Any]:
    """Return the defaults of the arguments of a generator."""
    if key not in GENERATORS:
        return {}
    own = inspect.signature(GENERATORS[key]).parameters.values()
    return {p.name: p.default for p in own if p.default is not inspect.Parameter.empty}


def shown(value: Any) -> str:
    """Return a default as it would be written in a file; nothing where there is none."""
    if value is None or value in ([], {}, (), ""):
        return ""
    if isinstance(value, dict) or not isinstance(value, bool | int | float | str | list | tuple):
        return ""
    if value == float("inf"):
        return "none"
    return f"`{json.dumps(list(value) if isinstance(value, tuple) else value)}`"


def anchor(name: str) -> str:
    """Return the anchor of a table."""
    return "key-" + re.sub(r"\W+|__?", "-", name).lower()


def place(name: str) -> str:
    """Return the anchor of a table by its name in the schema, which may be that of a key of a file."""
    taken = any(anchor(key) == anchor(name) and key != name for keys in GROUPS.values() for key in keys)
    return anchor(name) + ("-table" if taken else "")


def title_of(name: str) -> str:
    """Return the heading of a table in a table."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name.rsplit("__", 1)[-1].removesuffix("Table"))
    return words.lower().capitalize()


def cell(text: str) -> str:
    """Return a text as the cell of a table."""
    return text[:1].upper() + text[1:].replace("\n", " ").replace("|", "\\|")


# -- commands -------------------------------------------------------------------------------------------------------


def commands() -> str:
    """Return the page of all commands and their options."""
    lines = [
        "# Commands",
        "",
        "`concio COMMAND --help` prints the same. " + EXIT_CODES,
        "",
        "A length or a stress without a unit is in kN and m. Where the file has `[units]` of its own it is refused: "
        "write `--until '20 mm'`.",
        "",
        "`--install-completion` lets the shell complete commands and options. This page is written from the commands "
        "by `docs/make_references.py`.",
    ]  # fmt: skip
    for command in COMMANDS:
        about = help_of(inspect.getdoc(command) or "")
        lines += ["", f"## `concio {command.__name__}`", "", *about, "", *options_of(command)]
    return "\n".join(lines) + "\n"


def help_of(text: str) -> list[str]:
    """Return the help of a command, its example as a block."""
    told, _, example = inspect.cleandoc(text).partition("Example:")
    lines = [told.strip()]
    if example:
        lines += ["", "```sh", *(line.strip() for line in example.strip().splitlines()), "```"]
    return lines


def options_of(command: Callable[..., int]) -> list[str]:
    """Return the arguments and options of a command."""
    lines = ["| | Value | Default | |", "|---|---|---|---|"]
    hints = get_type_hints(command, include_extras=True)
    for name, parameter in inspect.signature(command).parameters.items():
        hint = hints[name]
        info = next(m for m in _all(hint) if isinstance(m, ArgumentInfo | OptionInfo))
        own = ", ".join(n for n in (info.default, *(info.param_decls or ())) if isinstance(n, str))
        names = own or (name.upper() if isinstance(info, ArgumentInfo) else f"--{name}")
        required = parameter.default is inspect.Parameter.empty
        given = None if required or parameter.default in (None, False) else parameter.default
        default = "required" if required else "" if given is None else "on" if given is True else f"`{given}`"
        lines.append(f"| `{names}` | {_value(hint)} | {default} | {cell(info.help or '')} |")
    return lines


def _all(hint: Any) -> list[Any]:
    """Return what annotates a type, in depth: a type that may be None is annotated within."""
    return [*getattr(hint, "__metadata__", ()), *(m for part in get_args(hint) for m in _all(part))]


def _value(hint: Any) -> str:
    """Return what an option takes, in a word."""
    if get_origin(hint) is Annotated:
        return _value(get_args(hint)[0])
    if get_origin(hint) is Literal:
        return ", ".join(f"`{word}`" for word in get_args(hint))
    if get_origin(hint) is list:
        return f"{_value(get_args(hint)[0])}, repeatable"
    parts = [part for part in get_args(hint) if part is not NoneType]
    if parts:
        return _value(parts[0])
    return {str: "text", int: "whole number", float: "number", Path: "path"}.get(hint, "")


if __name__ == "__main__":
    main()
