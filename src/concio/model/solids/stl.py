"""STL, text or binary: triangles; a file for each block in a folder, or several ``solid`` sections in one file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from concio.errors import InputError
from concio.files import LARGEST, check_regular
from concio.model.solids.shapes import Scene, Shape, check_size

Array = np.ndarray
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary file."""


def read_stl(path: Path) -> Scene:
    """Return the surfaces of an STL file.

    Raises
    ------
    InputError
        The file is missing, cut off, or not STL.
    """
    if check_regular(path) > LARGEST:
        msg = f"the file has more than {LARGEST / 1e6:.0f} MB"
        raise InputError(msg, where=str(path), hint="a scanned surface is not a structure of blocks: model the blocks")
    raw = path.read_bytes()
    if len(raw) >= 84 and len(raw) == 84 + 50 * int.from_bytes(raw[80:84], "little"):
        corners = np.frombuffer(raw, RECORD, offset=84)["corners"].astype(float)
        check_size(3 * len(corners), str(path))
        return Scene((_shape(path.stem, corners),) if len(corners) else ())
    try:
        text = raw.decode("utf-8")
    except UnicodeDecodeError:
        text = ""
    if not text.lstrip().startswith("solid"):
        msg = "the file is not STL: neither text that begins with 'solid' nor binary of the length it states"
        raise InputError(msg, where=str(path), hint="was it cut off? Save it once more")
    shapes = []
    name: str = ""
    values: list[float] = []
    for number, line in enumerate(text.split("\n"), 1):
        words = line.split()
        if not words:
            continue
        if words[0] == "solid":
            name, values = " ".join(words[1:]), []
        elif words[0] == "vertex":
            try:
                x, y, z = map(float, words[1:])
            except ValueError:
                msg = f"line {number} cannot be read: '{line.strip()[:60]}'"
                raise InputError(msg, where=str(path), hint="write 'vertex x y z'") from None
            values += (x, y, z)
        elif words[0] == "endsolid":
            if len(values) % 9:
                msg = f"line {number}: a facet of solid '{name}' has no three vertices"
                raise InputError(msg, where=str(path))
            if values:
                shapes.append(_shape(name or path.stem, np.array(values).reshape(-1, 3, 3)))
            values = []
    if values:
        msg = f"solid '{name}' has no end: the file was cut off"
        raise InputError(msg, where=str(path), hint="save it once more")
    check_size(sum(len(s.points) for s in shapes), str(path))
    return Scene(tuple(shapes))


def _shape(name: str, corners: Array) -> Shape:
    points, number = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = [face for face in number.reshape(-1, 3).tolist() if len(set(face)) == 3]
    return Shape(name, "", points, faces)
