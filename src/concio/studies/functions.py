"""What decides the rows of a function, in text: its name and code, and the values that it holds.

Functions that are made by another one have the same code and differ in what they hold: arguments of a ``partial``,
defaults, variables of the function around them, attributes of the object of a method. Global variables are not seen.
"""

from __future__ import annotations

import functools
import hashlib
import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from types import CellType, ModuleType
from typing import Any

import numpy as np

ADDRESS = re.compile(r" at 0x[0-9A-Fa-f]+")
LONG = 200
"""What is held in more letters than this is stated by its hash."""
DEEP = 12
"""Objects within so many others are stated by their kind alone."""


def function_text(function: Any) -> str:
    """Return name and code of a function, as far as Python knows them, with what it holds.

    Parameters
    ----------
    function : callable
    """
    return _called(function, ())


def _called(function: Any, around: tuple[int, ...]) -> str:
    """Return the text of a callable within objects of these identities."""
    if id(function) in around:
        return "itself"
    around = (*around, id(function))
    if is_dataclass(function) and not isinstance(function, type):
        return _fields(function, around)
    if isinstance(function, functools.partial):
        given = [_short(v, around) for v in function.args]
        given += [f"{k}={_short(v, around)}" for k, v in function.keywords.items()]
        return f"partial({', '.join([_called(function.func, around), *given])})"
    if not hasattr(function, "__qualname__"):
        return f"{_code(type(function))}({_short(getattr(function, '__dict__', {}), around)})"
    held = _holds(function)
    return _code(function) + (f" with {_short(held, around)}" if held else "")


def _code(function: Any) -> str:
    """Return the name of a function or a class with a hash of its source."""
    try:
        code = hashlib.sha256(inspect.getsource(function).encode()).hexdigest()[:16]
    except (OSError, TypeError):
        code = "without source"
    return f"{function.__module__}.{function.__qualname__} {code}"


def _holds(function: Any) -> dict[str, Any]:
    """Return what a function holds: the object of a method, defaults, variables of the function around it."""
    own = getattr(function, "__self__", None)
    bare = inspect.unwrap(getattr(function, "__func__", function))
    inside = getattr(getattr(bare, "__code__", None), "co_freevars", ())
    defaults = [*(getattr(bare, "__defaults__", None) or ()), *(getattr(bare, "__kwdefaults__", None) or {}).items()]
    cells = [_content(cell) for cell in getattr(bare, "__closure__", None) or ()]
    held: dict[str, Any] = {} if own is None or isinstance(own, ModuleType) else {"self": own}
    return held | ({"defaults": defaults} if defaults else {}) | dict(zip(inside, cells, strict=False))


def _content(cell: CellType) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # not set yet
        return None


def _short(value: Any, around: tuple[int, ...]) -> str:
    text = _value(value, around)
    return text if len(text) <= LONG else hashlib.sha256(text.encode()).hexdigest()[:16]


def _value(value: Any, around: tuple[int, ...]) -> str:
    """Return the text of a value, without places in memory."""
    if id(value) in around:
        return "itself"
    if len(around) > DEEP:
        return type(value).__qualname__
    inner = (*around, id(value))
    if isinstance(value, np.ndarray) and value.dtype != object:
        return f"array {value.dtype} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()[:16]}"
    if isinstance(value, Mapping):
        return "{" + _listed(f"{_value(k, inner)}: {_value(v, inner)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple | np.ndarray):
        return "[" + _listed(_value(v, inner) for v in value) + "]"
    if isinstance(value, set | frozenset):
        return "{" + _listed(sorted(_value(v, inner) for v in value)) + "}"
    if isinstance(value, ModuleType):
        return value.__name__
    if callable(value):
        return _called(value, around)
    if is_dataclass(value):
        return _fields(value, inner)
    kind: Any = type(value)
    if kind.__repr__ is object.__repr__:
        return f"{_code(kind)}({_value(getattr(value, '__dict__', {}), inner)})"
    return ADDRESS.sub("", repr(value))


def _fields(value: Any, around: tuple[int, ...]) -> str:
    """Return the text of a dataclass: its name and its fields."""
    told = _listed(f"{f.name}={_short(getattr(value, f.name), around)}" for f in fields(value))
    return f"{type(value).__qualname__}({told})"


def _listed(parts: Iterable[str]) -> str:
    return ", ".join(parts)
