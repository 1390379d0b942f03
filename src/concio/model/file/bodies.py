"""From the tables ``[[blocks]]`` of a model file to bodies: in the plane and in space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from concio.errors import GeometryError, InputError
from concio.model.body import Body
from concio.model.file.file_errors import placed
from concio.model.file.tables import BlockTable, HoleTable
from concio.model.interfaces.polygon_check import check_polygon
from concio.model.materials import Elastic, Rigid
from concio.model.polyhedron import Polyhedron

Materials = dict[str, Elastic | Rigid]


def body_of(table: BlockTable, number: int, materials: Materials, thickness: float) -> Body | Polyhedron:
    """Return the body of the table with this number; ``thickness`` (m) is that of bodies that give none.

    Raises
    ------
    InputError
        The table describes no body; the message says which one it is.
    """
    with placed(f"[[blocks]] {number} '{table.name}'", own=f"block '{table.name}'"):
        if table.box is not None or table.vertices is not None or table.faces is not None:
            return _solid(table, materials)
        if (table.outline is None) == (table.rectangle is None):
            msg = "give either an outline or a rectangle" + ("" if table.outline is None else ", not both")
            hint = "outline = [[x, y], ...] or rectangle = two corners; in space box, or vertices and faces"
            raise InputError(msg, hint=hint)
        if table.rectangle is not None:
            _plane_points(table.rectangle)
            (x0, x1), (y0, y1) = (sorted(values) for values in zip(*table.rectangle, strict=True))
            if x0 == x1 or y0 == y1:
                msg = "the rectangle has no area"
                raise GeometryError(msg, hint="give two opposite corners")
            outline = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        else:
            assert table.outline is not None
            _plane_points(table.outline)
            outline = np.array(table.outline, dtype=float).reshape(-1, 2)
            check_polygon(outline, table.name)
        kind, role = _sort(table, materials)
        grid = None if table.grid is None else (np.array(table.grid.x), np.array(table.grid.y))
        depth = thickness if table.thickness is None else table.thickness
        holes = tuple(_plane_hole(hole) for hole in table.holes)
        for k, hole in enumerate(holes, 1):
            check_polygon(hole, f"{table.name}', hole '{k}")
        return Body(table.name, outline, table.material, kind, role, table.layer, depth, grid, table.mesh_size, holes)


def _plane_hole(hole: HoleTable | Sequence[Sequence[float]]) -> np.ndarray:
    if isinstance(hole, HoleTable):
        msg = "a hole of a block in the plane is an outline"
        raise InputError(msg, hint="holes = [[[x, y], ...], ...]")
    _plane_points(hole)
    return np.array(hole, dtype=float).reshape(-1, 2)


def _plane_points(points: Sequence[Sequence[float]]) -> None:
    if any(len(p) != 2 for p in points):
        msg = "a point of an outline or a rectangle has three coordinates"
        raise InputError(msg, hint="a block in space has vertices and faces, or box = [[x, y, z], [x, y, z]]")


def _sort(table: BlockTable, materials: Materials) -> tuple[Literal["elastic", "rigid", "fixed"], str]:
    kind: Literal["elastic", "rigid", "fixed"]
    kind = table.kind or ("rigid" if isinstance(materials.get(table.material), Rigid) else "elastic")
    role = table.role if table.role is not None else "obstacle" if kind == "fixed" else "block"
    return kind, role


def _solid(table: BlockTable, materials: Materials) -> Polyhedron:
    """Return a block in space."""
    flat = [key for key in ("outline", "rectangle", "thickness", "grid") if getattr(table, key) is not None]
    if flat or (table.box is None) == (table.vertices is None) or (table.vertices is None) != (table.faces is None):
        msg = f"'{flat[0]}' is not a key of a block in space" if flat else "give either vertices and faces, or a box"
        raise InputError(msg, hint="vertices = [[x, y, z], ...], faces = [[0, 2, 3, 1], ...], or box = two corners")
    kind, role = _sort(table, materials)
    words: dict[str, Any] = {
        "material": table.material, "kind": kind, "role": role, "layer": table.layer, "mesh_size": table.mesh_size
    }  # fmt: skip
    if table.box is not None:
        if any(len(p) != 3 for p in table.box):
            msg = "a corner of the box has two coordinates"
            hint = "in space: box = [[x, y, z], [x, y, z]]; in the plane: rectangle = [[x, y], [x, y]]"
            raise InputError(msg, hint=hint)
        low, high = (f(table.box, axis=0).tolist() for f in (np.min, np.max))
        return Polyhedron.box(table.name, low, high, **words)
    assert table.vertices is not None
    assert table.faces is not None
    if any(len(p) != 3 for p in table.vertices):
        msg = "a vertex has two coordinates"
        raise InputError(msg, hint="vertices = [[x, y, z], ...]")
    holes = []
    for hole in table.holes:
        if not isinstance(hole, HoleTable):
            msg = "a hole of a block in space is a face and a loop of vertices"
            raise InputError(msg, hint="holes = [{ face = 0, loop = [4, 5, 6] }]")
        holes.append((hole.face, tuple(hole.loop)))
    grid = None if table.hexahedra is None else np.array(table.hexahedra, dtype=float)
    faces = tuple(map(tuple, table.faces))
    return Polyhedron(table.name, np.array(table.vertices), faces, holes=tuple(holes), grid=grid, **words)


def rigid_where_its_material_is(body: Body | Polyhedron, materials: Materials) -> Body | Polyhedron:
    """Return a body of a table of blocks, which has no word for rigid ones."""
    rigid = body.kind == "elastic" and isinstance(materials.get(body.material), Rigid)
    return replace(body, kind="rigid") if rigid else body
