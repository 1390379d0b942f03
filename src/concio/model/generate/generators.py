"""All generators by name, for model files: a table ``[wall]`` becomes ``wall(...)`` with its keys as arguments."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, get_args, get_type_hints

from concio.arguments import closest
from concio.errors import InputError
from concio.model.generate.arch_bridges import bridge
from concio.model.generate.arch_on_piers import arch_on_piers
from concio.model.generate.arches import arch
from concio.model.generate.barrel import barrel
from concio.model.generate.columns import buttress, column
from concio.model.generate.dome import dome
from concio.model.generate.drums import drums
from concio.model.generate.groins import cloister_vault, cross_vault
from concio.model.generate.panel import running_bond_panel
from concio.model.generate.periodic_cells import cell
from concio.model.generate.plan_walls import tower, walls
from concio.model.generate.rubble import rubble
from concio.model.generate.walls import wall, wall_of_courses
from concio.model.model import Model

GENERATORS: Mapping[str, Callable[..., Model]] = MappingProxyType(
    {
        "panel": running_bond_panel,
        "wall": wall,
        "wall_of_courses": wall_of_courses,
        "arch": arch,
        "column": column,
        "buttress": buttress,
        "rubble": rubble,
        "cell": cell,
        "arch_on_piers": arch_on_piers,
        "bridge": bridge,
        "walls": walls,
        "tower": tower,
        "barrel": barrel,
        "dome": dome,
        "cloister_vault": cloister_vault,
        "cross_vault": cross_vault,
        "drums": drums,
    }
)
"""Functions that return a model, by the name of their table in a model file."""


def arguments_of(kind: str) -> tuple[str, ...]:
    """Return the names of the arguments of a generator, the common options included.

    Raises
    ------
    InputError
        No generator of that name.
    """
    if kind not in GENERATORS:
        msg = f"there is no generator '{kind}'"
        raise InputError(msg, hint=closest(kind, GENERATORS))
    function = GENERATORS[kind]
    hints = get_type_hints(function)
    names: list[str] = []
    for name, parameter in inspect.signature(function).parameters.items():
        further = parameter.kind is inspect.Parameter.VAR_KEYWORD
        names += get_type_hints(get_args(hints[name])[0]) if further else [name]
    return tuple(names)


def generate(kind: str, arguments: Mapping[str, Any]) -> Model:
    """Return the model a generator makes of ``arguments``, unknown and missing ones named in the message.

    Raises
    ------
    InputError
        Unknown generator or argument, a missing one, or a value out of range.
    """
    known = arguments_of(kind)
    for name in arguments:
        if name not in known:
            msg = f"unknown key '{name}'"
            raise InputError(msg, where=kind, hint=closest(name, known))
    function = GENERATORS[kind]
    for name, parameter in inspect.signature(function).parameters.items():
        needed = parameter.default is inspect.Parameter.empty and parameter.kind is inspect.Parameter.KEYWORD_ONLY
        if needed and name not in arguments:
            msg = f"'{name}' is missing"
            raise InputError(msg, where=kind, hint=f"'{kind}' needs it")
    return function(**arguments)
