"""Short texts for objects that hold arrays: ``print(result.contacts)`` tells sizes and ranges, not all numbers."""

from __future__ import annotations

import dataclasses
import textwrap
from collections.abc import Mapping
from enum import Enum
from typing import Any, TypeVar

T = TypeVar("T")

FEW = 6
"""Arrays of up to this number of entries, and sequences of up to half of it, are written out."""

LONG = 60
"""Texts above this number of characters are cut short."""

WIDTH = 110
"""Characters in a line."""


def short_repr(cls: type[T]) -> type[T]:
    """Give a dataclass a short ``repr``: fields that differ from their defaults, arrays by shape and range."""

    def represent(self: Any) -> str:
        told = []
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if field.repr and not _default(field, value):
                told.append(f"{field.name}={brief(value)}")
        return textwrap.fill(
            f"{type(self).__name__}({', '.join(told)})", WIDTH, subsequent_indent="  ", break_long_words=False,
            break_on_hyphens=False,
        )  # fmt: skip

    type.__setattr__(cls, "__repr__", represent)
    return cls


def brief(value: object) -> str:
    """Return a value in a few words."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return _of_dataclass(value)
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, bool | int | str | None):
        return _cut(repr(value))
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        if len(value) > FEW:
            return f"{{{len(value)} entries}}"
        return "{" + ", ".join(f"{key!r}: {brief(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, tuple | list | set | frozenset):
        return _of_sequence(list(value))
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        return _of_array(value, shape)
    name = getattr(value, "__name__", None)
    return _cut(name if isinstance(name, str) else repr(value))


def _of_dataclass(value: Any) -> str:
    name = type(value).__name__
    if any(hasattr(getattr(value, field.name), "shape") for field in dataclasses.fields(value)):
        return f"{name}(...)"
    text = repr(value)
    return text if len(text) <= LONG and "\n" not in text else f"{name}(...)"


def _of_sequence(items: list[object]) -> str:
    text = ", ".join(brief(item) for item in items[:FEW])
    if len(items) <= FEW // 2 or (len(items) <= FEW and len(text) <= LONG):
        return f"({text})" if len(text) <= 2 * LONG else f"({len(items)} {_kind(items)})"
    return f"({len(items)} {_kind(items)})"


def _kind(items: list[object]) -> str:
    kinds = {type(item).__name__ for item in items}
    return kinds.pop() if len(kinds) == 1 else "items"


def _of_array(value: Any, shape: tuple[int, ...]) -> str:
    if not hasattr(value, "tolist"):
        return f"<{type(value).__name__} {shape}>"
    size = 1
    for n in shape:
        size *= n
    if size <= FEW:
        return _numbers(value.tolist())
    kind = value.dtype.kind
    if kind not in "fiu":
        return f"<{value.dtype} {shape}>"
    low, high = value.min(), value.max()
    return f"<{shape} from {low:.4g} to {high:.4g}>"


def _numbers(value: object) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_numbers(entry) for entry in value) + "]"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _cut(text: str) -> str:
    return text if len(text) <= LONG else text[: LONG - 3] + "..."


def _default(field: dataclasses.Field[Any], value: object) -> bool:
    """Return whether a field has its default, as far as that can be seen without comparing arrays."""
    default = field.default
    if default is dataclasses.MISSING:
        return isinstance(value, Mapping | tuple | list) and not value
    simple = (bool, int, float, str, tuple, type(None))
    return value is default or (isinstance(default, simple) and type(value) is type(default) and value == default)
