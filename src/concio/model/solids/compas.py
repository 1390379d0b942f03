"""COMPAS JSON: every mesh or polyhedron of it is a block; ``is_support`` makes it fixed.

Elements of a model (compas_model, compas_dem) stand where their transformation, those of the groups that hold them and
that of the model put them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.files import read_text
from concio.kinematics.frames import cross
from concio.model.polyhedron import BOX
from concio.model.solids.shapes import Array, Scene, Shape, check_size


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


NAMELESS = frozenset({"", "Mesh", "Block", "BlockElement", "Box", "Polyhedron", "Assembly", "Element", "Group"})
"""Names that COMPAS gives to what has none: those of classes."""


NO_FACES = frozenset({
    "Sphere", "Cylinder", "Cone", "Capsule", "Torus", "Brep", "RhinoBrep", "OCCBrep", "VolMesh", "CellNetwork",
})  # fmt: skip
"""Solids of COMPAS that a file states without faces, or with the faces of several."""


@dataclass(frozen=True)
class _Place:
    """What is known of a part of a file from what holds it: its name, whether it is fixed, and where it stands."""

    name: str = ""
    fixed: bool = False
    matrix: Array | None = None

    def within(self, thing: dict[str, Any], where: str) -> _Place:
        """Return the place of what ``thing`` holds."""
        attributes = thing.get("attributes")
        tables = (thing, attributes) if isinstance(attributes, dict) else (thing,)
        names = [table.get("name") for table in tables if table is attributes or "geometry" in table]
        name = next((n for n in names if isinstance(n, str) and n not in NAMELESS), self.name)
        fixed = self.fixed or any([_is_support(table, where) for table in tables])
        return _Place(name, fixed, self.moved(thing, where))

    def moved(self, thing: dict[str, Any], where: str) -> Array | None:
        """Return the matrix (4, 4) with the frame and the transformation of an element within it."""
        found = self.matrix
        element = any(key in thing for key in ("geometry", "shape", "transformation", "elements"))
        frame = _frame(thing.get("frame") if element else None, where)
        for own in (frame, _matrix(thing.get("transformation"), where)):
            if own is not None:
                found = own if found is None else np.asarray(found @ own)
        return found


def _is_support(table: dict[str, Any], where: str) -> bool:
    """Return whether a table says that a block is a support; true and 1 do."""
    said = table.get("is_support")
    if said is None or (isinstance(said, bool | int) and said in (0, 1)):
        return bool(said)
    msg = f"is_support is {json.dumps(said)[:40]}"
    raise InputError(msg, where=where, hint="write true or false")


def _frame(frame: Any, where: str) -> Array | None:
    """Return the matrix (4, 4) that takes coordinates in a frame into those around it; None for none."""
    if frame is None:
        return None
    try:
        data = frame["data"]
        origin, x, y = (np.array(data[key], dtype=float).reshape(3) for key in ("point", "xaxis", "yaxis"))
        z = cross(x, y)
        if np.isfinite(origin).all() and 0 < np.linalg.norm(z) < np.inf:
            x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
            matrix = np.eye(4)
            matrix[:3, :3], matrix[:3, 3] = np.column_stack([x, cross(z, x), z]), origin
            return matrix
    except (KeyError, TypeError, ValueError):
        pass
    msg = "a frame is not a point and two axes that span a plane"
    raise InputError(msg, where=where, hint="write the model again with compas.json_dump")


def _matrix(transformation: Any, where: str) -> Array | None:
    """Return the matrix of a transformation; None for none."""
    if transformation is None:
        return None
    data: Any = transformation.get("data") if isinstance(transformation, dict) else None
    try:
        matrix: Array = np.array(data["matrix"], dtype=float)
        if matrix.shape == (4, 4) and np.array_equal(matrix[3], (0.0, 0.0, 0.0, 1.0)):
            return matrix
    except (KeyError, TypeError, ValueError):
        pass
    msg = "a transformation is not a matrix of 4 x 4 numbers whose last row is 0, 0, 0, 1"
    raise InputError(msg, where=where, hint="write the model again with compas.json_dump")


def _shapes(data: Any, where: str) -> Iterator[Shape]:
    waiting: list[tuple[Any, _Place]] = [(data, _Place())]
    while waiting:
        thing, place = waiting.pop()
        if isinstance(thing, list):
            named = ((value, replace(place, name=f"{place.name or 'b'}{k}")) for k, value in enumerate(thing, 1))
            waiting += reversed(list(named))
        if not isinstance(thing, dict):
            continue
        inside = place.within(thing, where)
        if (kind := str(thing.get("dtype", "")).rpartition("/")[2]) in NO_FACES or thing.get("cell"):
            what = f"is a {kind or 'CellNetwork'}, which is not read"
            hint = "write it as a mesh, each cell as one of its own"
            yield Shape(inside.name, "", np.zeros((0, 3)), (), inside.fixed, unreadable=(what, hint))
            continue
        if thing.get("features") and "transformation" in thing:
            what, hint = "has features, which are not applied to its geometry", "write its geometry with them"
            yield Shape(inside.name, "", np.zeros((0, 3)), (), inside.fixed, unreadable=(what, hint))
            continue
        if kind == "Box":
            yield _box(thing, inside, where)
            continue
        points, faces = (thing.get(a, thing.get(b)) for a, b in (("vertex", "vertices"), ("face", "faces")))
        if points and faces and isinstance(points, dict | list) and isinstance(faces, dict | list):
            yield _mesh(points, faces, inside, where)
            continue
        if isinstance(thing.get("elements"), dict) and isinstance(thing.get("tree"), dict):
            waiting += reversed(list(_elements(thing, inside, where)))
            continue
        waiting += [
            (value, replace(inside, name=f"b{key}") if str(key).isdigit() else inside)
            for key, value in reversed(list(thing.items())) if key not in ("edge", "adjacency", "attributes")
        ]  # fmt: skip


def _elements(model: dict[str, Any], place: _Place, where: str) -> Iterator[tuple[Any, _Place]]:
    """Return the elements of a model with their places, in the order of its graph."""
    elements, groups = model["elements"], _groups(model["tree"].get("root"), model["elements"], place, where)
    graph = model.get("graph")
    nodes = graph.get("node") if isinstance(graph, dict) else None
    order = {node.get("element"): key for key, node in (nodes or {}).items() if isinstance(node, dict)}
    for key in sorted(elements, key=lambda k: (k not in order, list(order).index(k) if k in order else 0)):
        own = groups.get(key, place)
        yield elements[key], replace(own, name=f"b{order[key]}") if key in order else own


def _groups(root: Any, elements: dict[str, Any], place: _Place, where: str) -> dict[str, _Place]:
    """Return the place of each element that stands in a group of a model's tree."""
    found: dict[str, _Place] = {}
    waiting = [(root, place)]
    while waiting:
        node, around = waiting.pop()
        if not isinstance(node, dict):
            continue
        found[str(node.get("element"))] = around
        held = elements.get(str(node.get("element")))
        data = held.get("data") if isinstance(held, dict) else None
        inside = around
        if isinstance(data, dict):
            inside = replace(around, matrix=around.moved(data, where))
        waiting += [(child, inside) for child in node.get("children") or []]
    return found


def _box(thing: dict[str, Any], at_place: _Place, where: str) -> Shape:
    """Return a box of COMPAS: sizes about the origin of its frame."""
    held = thing.get("data")
    data: dict[str, Any] = held if isinstance(held, dict) else {}
    try:
        sizes = [float(data[key]) for key in ("xsize", "ysize", "zsize")]
    except (KeyError, TypeError, ValueError):
        msg = "a box has no xsize, ysize and zsize"
        raise InputError(msg, where=where, hint="write the model again with compas.json_dump") from None
    own = _frame(data.get("frame"), where)
    corners = np.array([[x, y, z] for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]) * sizes
    if own is not None:
        corners = corners @ own[:3, :3].T + own[:3, 3]
    return _mesh(corners.tolist(), [list(face) for face in BOX], at_place, where)


def _mesh(points: Any, faces: Any, at_place: _Place, where: str) -> Shape:
    name, matrix = at_place.name, at_place.matrix
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
    if matrix is not None:
        points_at = points_at @ matrix[:3, :3].T + matrix[:3, 3]
        if np.linalg.det(matrix[:3, :3]) < 0:  # a mirror turns faces inwards
            found = [loop[::-1] for loop in found]
    return Shape(name, "", points_at, found, at_place.fixed)
