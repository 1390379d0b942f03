"""Rhino 3dm (needs the ``rhino`` extra): meshes, extrusions and render meshes of closed surfaces, by layer."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.files import check_regular
from concio.model.solids.shapes import Scene, Shape, check_size

METRES = {
    "Millimeters": 1e-3, "Centimeters": 1e-2, "Decimeters": 0.1, "Meters": 1.0, "Kilometers": 1e3, "Inches": 0.0254,
    "Feet": 0.3048, "Yards": 0.9144,
}  # fmt: skip
"""Metres in one unit of a model."""


def read_rhino(path: Path) -> Scene:
    """Return the surfaces of a 3dm file.

    Raises
    ------
    InputError
        rhino3dm is not installed, the file is missing or damaged, or a closed surface has no mesh.
    """
    try:
        rhino3dm: Any = importlib.import_module("rhino3dm")
    except ImportError:
        msg = "reading 3dm needs the package rhino3dm, which is not installed"
        raise InputError(msg, where=str(path), hint="pip install rhino3dm") from None
    check_regular(path)
    document = rhino3dm.File3dm.Read(str(path))
    if document is None:
        msg = "the file is not a Rhino model that can be read"
        raise InputError(msg, where=str(path), hint="save it once more as 3dm, version 5 or later")
    layers = {layer.Index: layer.FullPath for layer in document.Layers}
    shapes = []
    for k, thing in enumerate(document.Objects, 1):
        name, layer = thing.Attributes.Name or f"b{k}", layers.get(thing.Attributes.LayerIndex, "")
        meshes = _meshes(thing.Geometry, rhino3dm)
        if meshes is None:
            continue
        if not meshes:
            msg = f"object '{name}' on layer '{layer}' is a surface without a mesh"
            raise InputError(msg, where=str(path), hint="mesh it in Rhino, or save after it was shown shaded")
        points, faces, start = [], [], 0
        for mesh in meshes:
            corners = getattr(mesh.Vertices, "ToPoint3dArray", lambda own=mesh.Vertices: own)()  # double precision
            points += [(v.X, v.Y, v.Z) for v in corners]
            for f in range(len(mesh.Faces)):
                loop = list(dict.fromkeys(mesh.Faces[f]))
                if len(loop) > 2:
                    faces.append([start + v for v in loop])
            start = len(points)
        shapes.append(Shape(name, layer, np.array(points, dtype=float).reshape(-1, 3), faces))
    check_size(sum(len(s.points) for s in shapes), str(path))
    return Scene(tuple(shapes), METRES.get(document.Settings.ModelUnitSystem.name))


def _meshes(geometry: Any, rhino3dm: Any) -> list[Any] | None:
    """Return the meshes of an object, none where it has none, None where it is not a surface."""
    if isinstance(geometry, rhino3dm.Mesh):
        return [geometry]
    kind = rhino3dm.MeshType.Any
    if isinstance(geometry, rhino3dm.Extrusion):
        mesh = geometry.GetMesh(kind)
        return [mesh] if mesh else []
    if isinstance(geometry, rhino3dm.Brep):
        found = [geometry.Faces[k].GetMesh(kind) for k in range(len(geometry.Faces))]
        return [mesh for mesh in found if mesh] if all(found) else []
    return None
