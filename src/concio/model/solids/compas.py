"""COMPAS JSON: every mesh or polyhedron of it is a block; ``is_support`` of an assembly makes it fixed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.files import read_text
from concio.model.solids.shapes import Scene, Shape, check_size


def read_compas(path: Path) -> Scene:
    """Return the blocks of a COMPAS file: an assembly, a mesh, or lists of them.

    Raises
    ------
    InputError
        The file is missing, no JSON, or a mesh in it cannot be read.
    """
    try:
        data = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        msg = f"line {error.lineno}, column {error.colno}: {error.msg}"
        raise InputError(msg, where=str(path), hint="the file is not valid JSON") from None
    except (ValueError, RecursionError):
        msg = "it is nested too deeply, or a number has too many digits"
        raise InputError(msg, where=str(path)) from None
    shapes = tuple(_shapes(data, str(path)))
    check_size(sum(len(s.points) for s in shapes), str(path))
    return Scene(shapes)


def _shapes(data: Any, where: str) -> Iterator[Shape]:
    waiting: list[tuple[Any, str, bool]] = [(data, "", False)]
    while waiting:
        thing, name, fixed = waiting.pop()
        if isinstance(thing, list):
            waiting += [(value, f"{name or 'b'}{k}", fixed) for k, value in reversed(list(enumerate(thing, 1)))]
        if not isinstance(thing, dict):
            continue
        fixed = fixed or thing.get("is_support") is True
        attributes = thing.get("attributes")
        if isinstance(attributes, dict):
            own = attributes.get("name")
            name = own if isinstance(own, str) and own not in ("", "Mesh", "Block", "Assembly") else name
            fixed = fixed or attributes.get("is_support") is True
        points, faces = (thing.get(a, thing.get(b)) for a, b in (("vertex", "vertices"), ("face", "faces")))
        if points and faces and isinstance(points, dict | list) and isinstance(faces, dict | list):
            yield _mesh(points, faces, name, fixed, where)
            continue
        waiting += [
            (value, f"b{key}" if str(key).isdigit() else name, fixed)
            for key, value in reversed(list(thing.items())) if key not in ("edge", "adjacency", "attributes")
        ]  # fmt: skip


def _mesh(points: Any, faces: Any, name: str, fixed: bool, where: str) -> Shape:
    place = f"{where}, block '{name}'" if name else where
    try:
        table = points if isinstance(points, dict) else dict(enumerate(points))
        number = {str(key): k for k, key in enumerate(table)}
        at = [[v["x"], v["y"], v["z"]] if isinstance(v, dict) else v for v in table.values()]
        loops = faces.values() if isinstance(faces, dict) else faces
        found = [[number[str(v)] for v in loop] for loop in loops]
        points_at = np.array(at, dtype=float).reshape(-1, 3)
    except KeyError as error:
        msg = f"a face or a vertex lacks {error}"
        raise InputError(msg, where=place, hint="vertices need x, y, z; faces name vertices that are there") from None
    except (TypeError, ValueError, OverflowError):
        msg = "vertices or faces are not lists of numbers"
        raise InputError(msg, where=place) from None
    short = next((k for k, loop in enumerate(found, 1) if len(loop) < 3), None)
    if short is not None:
        msg = f"face {short} has {len(found[short - 1])} vertices, which bound nothing"
        raise InputError(msg, where=place, hint="a face needs three vertices or more")
    return Shape(name, "", points_at, found, fixed)
