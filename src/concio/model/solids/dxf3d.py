"""DXF in space (``dxf`` extra): polyface meshes and MESH entities are blocks, 3DFACEs those of their layer."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.files import check_regular
from concio.model.drawing.dxf_entities import DAMAGED, UNITS
from concio.model.solids.shapes import Scene, Shape, check_size

NAMES = "CONCIO"
"""Application under which the extended data of a mesh hold the name of its block."""


def read_dxf_solids(path: Path) -> Scene:
    """Return the surfaces of a DXF file; block references are taken apart.

    Raises
    ------
    InputError
        ezdxf is not installed, the file is missing, damaged, or holds solids of a modeller that cannot be read.
    """
    try:
        import ezdxf
        import ezdxf.disassemble
    except ImportError:
        msg = "reading DXF needs the package ezdxf, which is not installed"
        raise InputError(msg, where=str(path), hint="pip install ezdxf") from None
    check_regular(path)
    try:
        document = ezdxf.readfile(path)
        entities = list(ezdxf.disassemble.recursive_decompose(document.modelspace()))
        shapes = _shapes(entities)
        closed = sum(e.dxftype() in ("3DSOLID", "BODY", "SURFACE", "REGION") for e in entities)
        metres = UNITS.get(int(document.header.get("$INSUNITS", 0)))
    except (ezdxf.DXFError, *DAMAGED) as error:
        msg = f"the file is not a DXF drawing that can be read: {' '.join(str(error).split())[:200]}"
        raise InputError(msg, where=str(path), hint="save it as DXF (ASCII, 2000 or later) once more") from None
    if closed:
        msg = f"{closed} solids of a modeller (3DSOLID, BODY, SURFACE) cannot be read"
        raise InputError(msg, where=str(path), hint="explode them into meshes, or save the blocks as OBJ or 3dm")
    check_size(sum(len(s.points) for s in shapes), str(path))
    return Scene(tuple(shapes), metres)


def _shapes(entities: list[Any]) -> list[Shape]:
    from ezdxf.render import MeshBuilder

    found: list[Shape] = []
    loose: dict[str, list[list[tuple[float, ...]]]] = {}
    for entity in entities:
        kind, layer = entity.dxftype(), str(entity.dxf.get("layer", "0"))
        if kind == "3DFACE":
            corners = [tuple(v) for v in entity.wcs_vertices()]
            loop = [c for k, c in enumerate(corners) if c != corners[k - 1]]
            loose.setdefault(layer, []).extend([loop] if len(loop) > 2 else [])
        elif kind == "MESH" or (kind == "POLYLINE" and entity.is_poly_face_mesh):
            mesh = MeshBuilder.from_mesh(entity) if kind == "MESH" else MeshBuilder.from_polyface(entity)
            points = np.array([tuple(v) for v in mesh.vertices], dtype=float).reshape(-1, 3)
            faces = [list(f) for f in mesh.faces if len(f) > 2]
            name = f"h{entity.dxf.get('handle', '')}"
            if entity.has_xdata(NAMES):
                name = next((str(tag.value) for tag in entity.get_xdata(NAMES) if tag.code == 1000), name)
            found.append(Shape(name, layer, points, faces, source=f"layer '{layer}'"))
    for layer, loops in loose.items():
        if not loops:
            continue
        points = np.array([c for loop in loops for c in loop], dtype=float)
        ends = np.cumsum([0] + [len(loop) for loop in loops]).tolist()
        found.append(Shape(layer, layer, points, [list(range(p, q)) for p, q in pairwise(ends)]))
    return found
