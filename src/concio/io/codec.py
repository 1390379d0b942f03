"""Frozen dataclasses to JSON and named arrays, and back: what a result directory is made of.

Nothing is pickled. A value becomes a JSON tree in which classes appear under the names of a fixed list, so that a file
can only make what concio defines, and a class may move to another module without older files noticing. Arrays of more
than :data:`INLINE` numbers (or with numbers JSON has no word for) leave the tree and become entries of an npz file
under their path, such as ``solution.normal_force``: anyone can read them with numpy alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np
import scipy.sparse as sp

from concio.errors import InputError

Array = np.ndarray
Json = Any

INLINE = 24
"""Arrays up to this size stay in the JSON text."""
TABLE = 8
"""Tuples of this many dataclasses of one class are written column by column."""


class Encoder:
    """Turns values into JSON; :attr:`arrays` collects what goes into the npz file.

    Parameters
    ----------
    classes : mapping of str to type
        Dataclasses and enumerations that may appear, by the names they get in the file.
    leave_out : mapping of str to tuple of str
        Fields that are not written, for each class: they follow from the others.
    """

    def __init__(self, classes: Mapping[str, type], leave_out: Mapping[str, tuple[str, ...]]) -> None:
        self._names = {cls: name for name, cls in classes.items()}
        self._leave_out = leave_out
        self._seen: dict[int, int] = {}
        self._alive: list[object] = []
        self.arrays: dict[str, Array] = {}

    def encode(self, value: Any, path: str = "") -> Json:
        """Return ``value`` as JSON; ``path`` names its arrays.

        Raises
        ------
        TypeError
            A class is not in the list.
        """
        if value is None or isinstance(value, bool | str):
            return value
        if isinstance(value, Enum):
            return {"$enum": [self._name(type(value)), value.name]}
        if isinstance(value, np.bool_):
            return bool(value)
        if isinstance(value, int | np.integer):
            return int(value)
        if isinstance(value, float | np.floating):
            number = float(value)
            return number if np.isfinite(number) else {"$float": repr(number)}
        if isinstance(value, np.ndarray):
            return self._array(value, path)
        if sp.issparse(value):
            return self._sparse(value, path)
        if isinstance(value, Mapping):
            return {
                "$dict": [[k if type(k) is int else str(k), self.encode(v, f"{path}.{k}")] for k, v in value.items()]
            }
        if isinstance(value, list | tuple):
            return self._sequence(value, path)
        if is_dataclass(value) and not isinstance(value, type):
            return self._dataclass(value, path)
        msg = f"cannot store a {type(value).__name__} at '{path}'"
        raise TypeError(msg)

    def _name(self, cls: type) -> str:
        if cls not in self._names:
            msg = f"the class {cls.__name__} has no name in the file format"
            raise TypeError(msg)
        return self._names[cls]

    def _array(self, value: Array, path: str) -> Json:
        plain = value.dtype.kind in "biu" or (value.dtype.kind == "f" and bool(np.isfinite(value).all()))
        if value.size <= INLINE and plain:
            return {"$array": value.dtype.str, "shape": list(value.shape), "data": value.ravel().tolist()}
        name, n = path, 2
        while name in self.arrays:
            name, n = f"{path}~{n}", n + 1
        self.arrays[name] = value
        return {"$npz": name}

    def _sparse(self, value: Any, path: str) -> Json:
        kind = value.format if value.format in ("csr", "csc") else "csr"
        matrix = value.asformat(kind)
        parts = {part: self._array(getattr(matrix, part), f"{path}.{part}") for part in ("data", "indices", "indptr")}
        return {"$sparse": kind, "shape": list(matrix.shape), **parts}

    def _sequence(self, value: list[Any] | tuple[Any, ...], path: str) -> Json:
        kind = "$tuple" if isinstance(value, tuple) else "$list"
        first = type(value[0]) if value else None
        if len(value) >= TABLE and is_dataclass(first) and all(type(v) is first for v in value):
            columns = {
                f.name: self._column([getattr(v, f.name) for v in value], f"{path}.{f.name}") for f in fields(first)
            }
            return {"$table": self._name(first), "as": kind, "count": len(value), "columns": columns}
        return {kind: [self.encode(v, f"{path}.{i}") for i, v in enumerate(value)]}

    def _column(self, values: list[Any], path: str) -> Json:
        first = values[0]
        if isinstance(first, np.ndarray):
            if all(isinstance(v, np.ndarray) and v.shape == first.shape and v.dtype == first.dtype for v in values):
                return {"$each": "array", "of": self._array(np.stack(values), path)}
        elif all(type(v) is float for v in values):
            return {"$each": "float", "of": self._array(np.array(values), path)}
        elif all(type(v) is int for v in values):
            return {"$each": "int", "of": self._array(np.array(values, dtype=np.int64), path)}
        elif all(isinstance(v, str | None) and v == first for v in values):
            return {"$same": first}
        return [self.encode(v, f"{path}.{i}") for i, v in enumerate(values)]

    def _dataclass(self, value: Any, path: str) -> Json:
        if id(value) in self._seen:
            return {"$ref": self._seen[id(value)]}
        number = self._seen[id(value)] = len(self._seen)
        self._alive.append(value)
        name = self._name(type(value))
        skip = self._leave_out.get(name, ())
        inner = {
            f.name: self.encode(getattr(value, f.name), f"{path}.{f.name}" if path else f.name)
            for f in fields(value)
            if f.name not in skip
        }
        return {"$type": name, "$id": number, "fields": inner}


class Decoder:
    """Turns JSON and arrays back into values.

    Parameters
    ----------
    classes : mapping of str to type
        As given to :class:`Encoder`.
    arrays : mapping of str to array
    computed : mapping of str to callable
        For each class with fields left out, a function that adds them to the mapping of its fields.
    where : str
        The file, for messages.
    """

    def __init__(
        self, classes: Mapping[str, type], arrays: Mapping[str, Array], computed: Mapping[str, Any], where: str
    ) -> None:
        self._classes, self._arrays, self._computed, self._where = classes, arrays, computed, where
        self._seen: dict[int, Any] = {}

    def decode(self, node: Json) -> Any:
        """Return the value of a JSON node.

        Raises
        ------
        InputError
            The file holds something this version of concio does not know, or lacks something it needs.
        """
        if not isinstance(node, dict):
            return node
        match node:
            case {"$float": text}:
                return float(text)
            case {"$array": dtype, "shape": shape, "data": data}:
                return np.array(data, dtype=dtype).reshape(shape)
            case {"$npz": name}:
                if name not in self._arrays:
                    msg = f"the array '{name}' is missing"
                    raise InputError(msg, where=self._where, hint="the directory is not complete; write it again")
                return self._arrays[name]
            case {"$sparse": kind, "shape": shape, "data": data, "indices": indices, "indptr": indptr}:
                make = sp.csc_array if kind == "csc" else sp.csr_array
                return make(tuple(self.decode(v) for v in (data, indices, indptr)), shape=tuple(shape))
            case {"$enum": [cls, member]}:
                enumeration: Any = self._class(cls)
                return enumeration[member]
            case {"$dict": items}:
                return {k: self.decode(v) for k, v in items}
            case {"$tuple": items}:
                return tuple(self.decode(v) for v in items)
            case {"$list": items}:
                return [self.decode(v) for v in items]
            case {"$table": cls, "as": kind, "count": count, "columns": columns}:
                rows = self._rows(cls, count, columns)
                return tuple(rows) if kind == "$tuple" else rows
            case {"$ref": number}:
                return self._seen[number]
            case {"$type": cls, "$id": number, "fields": inner}:
                found = {name: self.decode(v) for name, v in inner.items()}
                if cls in self._computed:
                    self._computed[cls](found)
                self._seen[number] = self._make(cls, found)
                return self._seen[number]
        msg = f"the entry {sorted(node)[:3]} is not known"
        raise InputError(msg, where=self._where, hint="a newer concio may have written it")

    def _class(self, name: str) -> type:
        if name not in self._classes:
            msg = f"the class '{name}' is not known"
            raise InputError(msg, where=self._where, hint="a newer concio may have written it")
        return self._classes[name]

    def _make(self, name: str, found: dict[str, Any]) -> Any:
        cls = self._class(name)
        known = {f.name: f for f in fields(cls)}
        extra = [k for k in found if k not in known]
        if extra:
            msg = f"{name} has the entries {', '.join(extra)}, which this version does not know"
            raise InputError(msg, where=self._where, hint="a newer concio may have written it")
        needed = [
            k for k, f in known.items() if f.default is MISSING and f.default_factory is MISSING and k not in found
        ]
        if needed:
            msg = f"{name} lacks {', '.join(needed)}"
            raise InputError(msg, where=self._where, hint="the directory is not complete; write it again")
        return cls(**found)

    def _rows(self, cls: str, count: int, columns: dict[str, Json]) -> list[Any]:
        table: dict[str, list[Any]] = {}
        for name, column in columns.items():
            if isinstance(column, list):
                table[name] = [self.decode(v) for v in column]
            elif "$same" in column:
                table[name] = [column["$same"]] * count
            else:
                values = self.decode(column["of"])
                table[name] = list(values) if column["$each"] == "array" else values.tolist()
        return [self._make(cls, {k: v[i] for k, v in table.items()}) for i in range(count)]
