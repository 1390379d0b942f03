"""Wavefront OBJ: ``v`` and ``f`` lines; an object (``o``) or group (``g``) for each block, ``usemtl`` its layer."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from concio.errors import InputError
from concio.files import read_text
from concio.model.solids.shapes import Scene, Shape, check_size

Array = np.ndarray


def read_obj(path: Path) -> Scene:
    """Return the surfaces of an OBJ file.

    Raises
    ------
    InputError
        The file is missing or not OBJ; the message names the line.
    """
    points: list[tuple[float, float, float]] = []
    groups: dict[tuple[str, str], list[list[int]]] = {}
    layers: dict[tuple[str, str], str] = {}
    object_name, group, layer = "", "", ""
    for number, line in enumerate(read_text(path).replace("\\\n", " ").split("\n"), 1):
        word, _, rest = line.strip().partition(" ")
        try:
            if word == "v":
                x, y, z = rest.split()[:3]
                points.append((float(x), float(y), float(z)))
            elif word == "f":
                loop = [int(corner.split("/", 1)[0]) for corner in rest.split()]
                if any(not 1 <= abs(v) <= len(points) for v in loop):
                    msg = f"line {number}: a face uses a vertex that is not there: there are {len(points)} so far"
                    raise InputError(msg, where=str(path))
                if len(loop) < 3:
                    msg = f"line {number}: a face has {len(loop)} vertices, which bound nothing"
                    raise InputError(msg, where=str(path), hint="delete the line: points and edges are not faces")
                key = (object_name, group)
                groups.setdefault(key, []).append([v - 1 if v > 0 else len(points) + v for v in loop])
                layers.setdefault(key, layer)
            elif word == "o":
                object_name, group = rest.strip(), ""
            elif word == "g":
                group = rest.strip()
            elif word == "usemtl":
                layer = rest.strip()
        except ValueError:
            msg = f"line {number} cannot be read: '{line.strip()[:60]}'"
            raise InputError(msg, where=str(path), hint="write 'v x y z' and 'f 1 2 3'") from None
        check_size(len(points), str(path))
    every = np.array(points).reshape(-1, 3)
    many: dict[str, int] = {}
    for first, _ in groups:
        many[first] = many.get(first, 0) + 1
    shapes = []
    for (first, second), faces in groups.items():
        name = first if first and many[first] == 1 else "-".join(w for w in (first, second) if w)
        layer = layers[first, second] or (second if name == first else "")
        shapes.append(_own(name, layer, every, faces))
    return Scene(tuple(shapes))


def _own(name: str, layer: str, points: Array, faces: Sequence[Sequence[int]]) -> Shape:
    used = np.unique([v for face in faces for v in face])
    number = dict(zip(used.tolist(), range(len(used)), strict=True))
    return Shape(name, layer, points[used], [[number[v] for v in face] for face in faces])
