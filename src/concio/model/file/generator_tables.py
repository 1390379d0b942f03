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

from concio.model.file.tables import Bond, Element, Friction, Material, Table
from concio.model.file.values import TYPES, Length, Number, Size
from concio.model.generate.generator_arguments import Common
from concio.model.generate.generators import GENERATORS
from concio.model.generate.openings import Opening
from concio.model.generate.plan import WallLine
from concio.model.generate.wall_panels import Panel
from concio.model.materials import Elastic, JointLaw, Rigid

LENGTHS = (
    "abutment", "at", "backing", "base", "bearing", "block_length", "block_size", "chord_tolerance", "course",
    "depth", "diameter", "eccentricity", "fill", "height", "joint", "length", "lintel", "mesh_size", "oculus",
    "pier_height", "pier_width", "ring", "rise", "side_gap", "span", "spread", "springing_ring", "stone", "thickness",
    "thrust_at", "top", "top_diameter", "width", "x", "y",
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


BY_NAME: Mapping[str, Any] = {
    "contact_points": StrictInt | Literal["auto", "corners"],
    "element": Element,
    "at": tuple[Size, Size],
    "start": tuple[Length, Length],
    "end": tuple[Length, Length],
    "towards": tuple[Number, Number],
    "intrados": list[tuple[Length, Length]],
    "extrados": list[tuple[Length, Length]],
    "ring_lines": list[list[tuple[Length, Length]]],
    "elements_per_block": tuple[StrictInt, StrictInt],
    "repeat": tuple[StrictInt, StrictInt],
}
"""Types of the keys that their annotation does not show: pairs of lengths and of numbers look alike there."""

SIMPLE: Mapping[Any, Any] = {bool: StrictBool, int: StrictInt, str: StrictStr}


def field_type(name: str, hint: Any, default: Any = None) -> Any:
    """Return the type of a key of a file.

    Parameters
    ----------
    name : str
        Name of the argument it stands for, which tells the kind of quantity (:data:`KINDS`, :data:`BY_NAME`).
    hint : type
        Annotation of the argument: laws and materials, choices, lists of tables.
    default : object
        Default of the argument: a size of three entries is one of blocks in space.
    """
    parts = [p for p in _parts(hint) if p is not NoneType]
    if name in BY_NAME:
        return BY_NAME[name]
    if any(get_origin(p) is Sequence for p in parts) and {int, float} & set(parts):
        one = StrictInt if int in parts else TYPES[KINDS.get(name, "number")]
        return Annotated[
            Annotated[one, Tag("<number>")] | Annotated[GenericAlias(list, (one,)), Tag("<list>")],
            Discriminator(_one_or_list),
        ]
    if JointLaw in parts:
        return Friction
    if Elastic in parts or Rigid in parts:
        return Material
    if len(parts) == 1 and parts[0] in SIMPLE:
        return SIMPLE[parts[0]]
    if all(get_origin(p) is Literal for p in parts):
        return Literal[tuple(word for p in parts for word in get_args(p))]
    if name == "block_size" or (name == "eccentricity" and float not in parts):
        in_space = isinstance(default, tuple) and len(default) == 3
        return tuple[Size, Size, Size] if in_space else tuple[Size, Size]
    if name == "bond":
        return Bond
    if name == "lines":
        return GenericAlias(list, (_line_type(),))
    if float in parts:
        return TYPES[KINDS.get(name, "number")]
    if name in ("openings", "panels"):
        own = GenericAlias(list, (_table_of(Opening if name == "openings" else Panel),))
        return GenericAlias(list, (own,)) if _nested(hint) else own
    return list[list[Number]]


def _one_or_list(value: Any) -> str:
    return "<list>" if isinstance(value, list | tuple) else "<number>"


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
    return create_model(kind.__name__, __base__=Table, __doc__=inspect.getdoc(kind), **members)


@cache
def generator_table(name: str) -> type[Table]:
    """Return the table of a generator; keys that are left out take the defaults of the function."""
    function = GENERATORS[name]
    members: dict[str, Any] = {}
    for key, (hint, default) in hints_of(function).items():
        kind = field_type(key, hint, default)
        members[key] = (kind, Field(...)) if default is ... else (kind, Field(None))
    return create_model(name, __base__=Table, __doc__=first_line(function), **members)


def first_line(thing: Any) -> str:
    """Return the first line of the docstring of a thing."""
    return (inspect.getdoc(thing) or "").split("\n", 1)[0]
