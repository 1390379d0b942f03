"""PLY, text or binary in either order of bytes: the blocks of one file are the closed parts of its surface."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.files import LARGEST, check_regular
from concio.model.solids.shapes import Scene, Shape, check_size

Array = np.ndarray
TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
"""Types of properties, as numpy calls them."""
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST_HEADER = 100_000
"""The first lines of a file end within so many bytes."""


@dataclass
class _Element:
    """A table of the file: its rows, and the type of each property; a list has two, of its length and its values."""

    name: str
    count: int
    properties: dict[str, tuple[str, ...]] = field(default_factory=dict)


def read_ply(path: Path) -> Scene:
    """Return the surface of a PLY file.

    Raises
    ------
    InputError
        The file is missing, cut off, not PLY, or holds points without faces.
    """
    where = str(path)
    size = check_regular(path)
    if size > LARGEST:
        msg = f"the file has more than {LARGEST / 1e6:.0f} MB"
        raise InputError(msg, where=where, hint="a scanned surface is not a structure of blocks: model the blocks")
    raw = path.read_bytes()
    order, elements, start = _header(raw, where)
    for element in elements:
        if sum(other.name == element.name for other in elements) > 1:
            msg = f"the header declares element '{element.name}' twice"
            raise InputError(msg, where=where, hint="was it edited by hand? Save it once more")
    of = {element.name: element for element in elements}
    vertex, face = of.get("vertex"), of.get("face")
    if vertex is None or any(len(vertex.properties.get(axis, ())) != 1 for axis in "xyz"):
        msg = "the header names no element 'vertex' with x, y and z"
        raise InputError(msg, where=where)
    check_size(vertex.count, where)
    if face is None or not face.count:
        msg = f"the file holds {vertex.count:,} points and no faces"
        raise InputError(msg, where=where, hint="a cloud of points is not a structure of blocks: model the blocks")
    indices = next((key for key in ("vertex_indices", "vertex_index") if key in face.properties), None)
    if indices is None or face.properties[indices][-1][0] == "f":
        msg = "element 'face' has no list 'vertex_indices' of whole numbers"
        raise InputError(msg, where=where)
    wanted = {"vertex": ("x", "y", "z"), "face": (indices,)}
    read = _text(raw, start, where) if not order else _binary(raw, start, order, where)
    tables = {e.name: read(e, wanted.get(e.name, ())) for e in elements}
    points = np.array(tables["vertex"], dtype=float).reshape(-1, 3)
    loops = [row[0] for row in tables["face"]]
    for number, loop in enumerate(loops, 1):
        if not isinstance(loop, list) or len(loop) < 3:
            msg = f"face {number} has {len(loop) if isinstance(loop, list) else 1} vertices, which bound nothing"
            raise InputError(msg, where=where, hint="a face needs three vertices or more")
        if min(loop) < 0 or max(loop) >= len(points):
            msg = f"face {number} uses vertex {max(loop) if min(loop) >= 0 else min(loop)}: there are {len(points)}"
            raise InputError(msg, where=where, hint="vertices are numbered from 0")
    return Scene((Shape(path.stem, "", points, loops),))


def _header(raw: bytes, where: str) -> tuple[str, list[_Element], int]:
    """Return the order of bytes (empty: text), the elements, and where they begin."""
    end = raw.find(b"end_header", 0, LONGEST_HEADER)
    line_end = raw.find(b"\n", end)
    if not raw.startswith(b"ply") or end < 0 or line_end < 0:
        msg = "the file is not PLY: it does not begin with 'ply' and a header that ends in 'end_header'"
        raise InputError(msg, where=where, hint="was it cut off? Save it once more")
    order = None
    elements: list[_Element] = []
    for number, line in enumerate(raw[:end].decode("latin-1").splitlines(), 1):
        words = line.split()
        good = True
        match words:
            case [] | ["ply" | "comment" | "obj_info", *_]:
                pass
            case ["format", kind, _] if kind in ORDERS:
                order = ORDERS[kind]
            case ["element", name, count] if count.isdigit() and len(count) < 16:
                elements.append(_Element(name, int(count)))
            case ["property", *_, name] if elements and name in elements[-1].properties:
                good = False
            case ["property", "list", length, kind, name] if {length, kind} <= TYPES.keys() and elements:
                elements[-1].properties[name] = (TYPES[length], TYPES[kind])
                good = TYPES[length][0] != "f"
            case ["property", kind, name] if kind in TYPES and elements:
                elements[-1].properties[name] = (TYPES[kind],)
            case _:
                good = False
        if not good:
            msg = f"line {number} of the header cannot be read: '{line.strip()[:60]}'"
            raise InputError(msg, where=where)
    if order is None:
        msg = "the header does not say its format"
        raise InputError(msg, where=where, hint="write 'format ascii 1.0'")
    return order, elements, line_end + 1


Reading = Callable[[_Element, tuple[str, ...]], list[list[Any]]]
"""Returns the rows of an element, of the properties asked for."""


def _cut_off(element: _Element, where: str) -> InputError:
    msg = f"the file ends before the {element.count:,} rows of '{element.name}' that its header promises"
    return InputError(msg, where=where, hint="was it cut off? Save it once more")


def _text(raw: bytes, start: int, where: str) -> Reading:
    """Return what reads the rows of a text, one after another."""
    first = raw.count(b"\n", 0, start) + 1
    lines = ((k, line.split()) for k, line in enumerate(raw[start:].decode("latin-1").splitlines(), first))
    filled: Iterator[tuple[int, list[str]]] = ((k, words) for k, words in lines if words)

    def read(element: _Element, wanted: tuple[str, ...]) -> list[list[Any]]:
        rows = []
        for _ in range(element.count):
            number, words = next(filled, (0, None))
            if words is None:
                raise _cut_off(element, where)
            at = 0
            row: dict[str, Any] = {}
            try:
                for name, types in element.properties.items():
                    if len(types) == 1:
                        row[name] = float(words[at])
                        at += 1
                    else:
                        length = int(words[at])
                        row[name] = [int(w) for w in words[at + 1 : at + 1 + length] if name in wanted]
                        at += 1 + length
                        if length < 0 or at > len(words):
                            raise IndexError
            except (ValueError, IndexError):
                msg = f"line {number} is not a row of '{element.name}': '{' '.join(words)[:60]}'"
                raise InputError(msg, where=where) from None
            rows.append([row[name] for name in wanted])
        return rows

    return read


def _binary(raw: bytes, start: int, order: str, where: str) -> Reading:
    """Return what reads the rows of a binary file, one after another."""
    place = start

    def values(kind: str, count: int, element: _Element) -> Array:
        nonlocal place
        dtype = np.dtype(order + kind)
        if count < 0 or place + count * dtype.itemsize > len(raw):
            raise _cut_off(element, where)
        found = np.frombuffer(raw, dtype, count, place)
        place += count * dtype.itemsize
        return found

    def read(element: _Element, wanted: tuple[str, ...]) -> list[list[Any]]:
        nonlocal place
        kinds = element.properties
        if not kinds:
            return []
        if all(len(types) == 1 for types in kinds.values()):
            dtype = np.dtype([(name, order + types[0]) for name, types in kinds.items()])
            if place + element.count * dtype.itemsize > len(raw):
                raise _cut_off(element, where)
            table = np.frombuffer(raw, dtype, element.count, place)
            place += element.count * dtype.itemsize
            return np.column_stack([table[n].astype(float) for n in wanted]).tolist() if wanted else []
        rows = []
        for _ in range(element.count):
            row: dict[str, Any] = {}
            for name, types in kinds.items():
                first = values(types[0], 1, element)[0]
                row[name] = float(first) if len(types) == 1 else values(types[1], int(first), element).tolist()
            rows.append([row[name] for name in wanted])
        return rows

    return read
