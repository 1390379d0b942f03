"""Tables of generators, made from the signatures of the functions: ``[arch]`` has the keys of ``concio.arch``.

Nothing is listed twice: a new argument of a generator is a new key of its table. Only the kinds of quantity of the
arguments are written here, by name, so that a bare number can be in the units of the file.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from types import GenericAlias, NoneType, UnionType
from typing import Annotated, Any, Literal, Union, Unpack, get_args, get_origin, get_type_hints

from pydantic import Discriminator, Field, StrictBool, StrictInt, StrictStr, Tag, create_model

from concio.model.file.assessment_table import AssessmentEntry, SiteEntry
from concio.model.file.motion_table import Motion
from concio.model.file.study_table import Study
from concio.model.file.tables import Bond, Element, FileTable, Friction, Material, PartTable, Table
from concio.model.file.values import TYPES, Length, Number, Size
from concio.model.generate.arguments import Common
from concio.model.generate.generators import GENERATORS
from concio.model.generate.openings import Opening
from concio.model.generate.plan import WallLine
from concio.model.generate.wall_panels import Panel
from concio.model.materials import Elastic, JointLaw, Rigid

LENGTHS = (
    "at", "base", "bearing", "block_length", "block_size", "chord_tolerance", "course", "depth", "diameter",
    "eccentricity", "fill", "height", "joint", "length", "lintel", "mesh_size", "oculus", "pier_height", "pier_width",
    "ring", "rise", "side_gap", "span", "spread", "stone", "thickness", "thrust_at", "top", "top_diameter", "width",
    "x", "y",
)  # fmt: skip
KINDS: Mapping[str, str] = {
    **dict.fromkeys(LENGTHS, "length"),
    "top_pressure": "stress",
    "unit_weight": "unit weight",
    "base_friction": "friction",
    "wall_friction": "friction",
    "lantern": "force",
    "skew": "degrees",
    "springing": "degrees",
    "crown_load": "force",
    "top_force": "force",
    "thrust": "force",
}
"""Kind of quantity of each argument that is not a plain number."""


def hints_of(function: Callable[..., Any]) -> dict[str, tuple[Any, Any]]:
    """Return annotation and default (``...`` where there is none) of each argument, the common options included."""
    hints = get_type_hints(function)
    found: dict[str, tuple[Any, Any]] = {}
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind is inspect.Parameter.VAR_KEYWORD:
            common = get_args(hints[name])[0] if get_origin(hints[name]) is Unpack else Common
            found |= {key: (hint, None) for key, hint in get_type_hints(common).items()}
        else:
            missing = parameter.default is inspect.Parameter.empty
            found[name] = (hints[name], ... if missing else parameter.default)
    return found


def field_type(name: str, hint: Any, default: Any = None) -> Any:
    """Return the type of a key of a file from annotation and default of the argument it stands for."""
    parts = [p for p in _parts(hint) if p is not NoneType]
    if name == "contact_points":
        return StrictInt | Literal["auto", "corners"]
    if name == "element":
        return Element
    if JointLaw in parts:
        return Friction
    if Elastic in parts or Rigid in parts:
        return Material
    if len(parts) == 1 and (parts[0] is bool or parts[0] is int or parts[0] is str):
        return {bool: StrictBool, int: StrictInt, str: StrictStr}[parts[0]]
    if all(get_origin(p) is Literal for p in parts):
        return Literal[tuple(word for p in parts for word in get_args(p))]
    if name == "block_size" and isinstance(default, tuple) and len(default) == 3:
        return tuple[Size, Size, Size]
    if name in ("block_size", "at") or (name == "eccentricity" and float not in parts):
        return tuple[Size, Size]
    if name == "towards":
        return tuple[Number, Number]
    if name in ("start", "end"):
        return tuple[Length, Length]
    if name == "lines":
        return GenericAlias(list, (_line_type(),))
    if name in ("elements_per_block", "repeat"):
        return tuple[StrictInt, StrictInt]
    if any(p is float for p in parts):
        return TYPES[KINDS.get(name, "number")]
    if name in ("openings", "panels"):
        own = GenericAlias(list, (_table_of(Opening if name == "openings" else Panel),))
        return GenericAlias(list, (own,)) if _nested(hint) else own
    if name == "bond":
        return Bond
    return list[list[Number]]


def _nested(hint: Any) -> bool:
    """Return whether an annotation is a sequence of sequences."""
    inner = get_args(hint)
    return bool(inner) and get_origin(inner[0]) is Sequence


def _line_branch(value: Any) -> str:
    return "<table>" if isinstance(value, dict | Table) else "<list>"


@cache
def _line_type() -> Any:
    """Return the type of a wall in plan: a table, or a pair of points."""
    pair = tuple[tuple[Length, Length], tuple[Length, Length]]
    table = _table_of(WallLine)
    return Annotated[Annotated[table, Tag("<table>")] | Annotated[pair, Tag("<list>")], Discriminator(_line_branch)]


def _parts(hint: Any) -> tuple[Any, ...]:
    return get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)


@cache
def _table_of(kind: type) -> type[Table]:
    """Return the table of a dataclass that generators take, such as an opening."""
    if not is_dataclass(kind):  # pragma: no cover
        raise TypeError(kind)
    hints = get_type_hints(kind)
    members: dict[str, Any] = {f.name: (field_type(f.name, hints[f.name]), Field(None)) for f in fields(kind)}
    return create_model(kind.__name__, __base__=Table, __doc__=_first_line(kind), **members)


@cache
def generator_table(name: str) -> type[Table]:
    """Return the table of a generator; keys that are left out take the defaults of the function."""
    function = GENERATORS[name]
    members: dict[str, Any] = {}
    for key, (hint, default) in hints_of(function).items():
        kind = field_type(key, hint, default)
        members[key] = (kind, Field(...)) if default is ... else (kind, Field(None))
    return create_model(name, __base__=Table, __doc__=_first_line(function), **members)


@cache
def file_table() -> type[FileTable]:
    """Return the table of a whole model file, generators included."""
    members: dict[str, Any] = {name: (generator_table(name), Field(None)) for name in GENERATORS}
    part = create_model("part", __base__=PartTable, __doc__=PartTable.__doc__, **members)
    members["study"] = (Study, None)
    members["site"] = (SiteEntry, None)
    members["assessment"] = (AssessmentEntry, None)
    members["parts"] = (GenericAlias(list, (part,)), Field(default_factory=list))
    members["motion"] = (Motion, None)
    return create_model("concio model", __base__=FileTable, __doc__=FileTable.__doc__, **members)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a model file (draft 2020-12)."""
    schema = _any_of(file_table().model_json_schema())
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "concio model file",
        "description": "A masonry structure for concio, written in TOML.",
    }


def _any_of(schema: Any) -> Any:
    """Return a schema in which a text may be read in two ways: the angle of a coefficient and a name are both texts."""
    if isinstance(schema, dict):
        return {"anyOf" if key == "oneOf" else key: _any_of(value) for key, value in schema.items()}
    return [_any_of(value) for value in schema] if isinstance(schema, list) else schema


def _first_line(thing: Any) -> str:
    return (inspect.getdoc(thing) or "").split("\n", 1)[0]
