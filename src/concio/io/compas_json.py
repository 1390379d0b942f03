"""Blocks as COMPAS writes them: a BlockModel of compas_dem, which ``compas.json_load`` and concio read.

The elements are blocks with a mesh each, a name and whether it is a support. No package of COMPAS is needed to write
them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from uuid import NAMESPACE_URL, uuid5

import numpy as np

Array = np.ndarray


def block_model(blocks: Sequence[tuple[str, bool, Array, Sequence[Sequence[int]]]], name: str) -> dict[str, Any]:
    """Return the JSON object of a model of blocks.

    Parameters
    ----------
    blocks : sequence of (name, support, points, faces)
        Whether the block is a support, its points (n, 3) [m], and its faces, counter-clockwise from outside.
    name : str
        Name of the model.
    """
    keys = [str(uuid5(NAMESPACE_URL, f"concio/{k}/{block[0]}")) for k, block in enumerate(blocks)]
    elements = {key: _element(key, *block) for key, block in zip(keys, blocks, strict=True)}
    graph = {
        "attributes": {}, "default_node_attributes": {}, "default_edge_attributes": {},
        "node": {str(k): {"element": key} for k, key in enumerate(keys)},
        "edge": {str(k): {} for k in range(len(keys))},
        "max_node": len(keys) - 1,
    }  # fmt: skip
    children = [{"name": "ElementNode", "element": key} for key in keys]
    return {
        "dtype": "compas_dem.models/BlockModel",
        "inheritance": ["compas_model.models/Model"],
        "guid": str(uuid5(NAMESPACE_URL, f"concio/{name}")),
        "name": name,
        "data": {
            "transformation": None,
            "elements": elements,
            "materials": {},
            "tree": {"attributes": {}, "root": {"name": "root", "children": children}},
            "graph": graph,
        },
    }


def _element(key: str, name: str, support: bool, points: Array, faces: Sequence[Sequence[int]]) -> dict[str, Any]:
    mesh = {
        "attributes": {"name": name, "is_support": support},
        "default_vertex_attributes": {"x": 0.0, "y": 0.0, "z": 0.0},
        "default_edge_attributes": {},
        "default_face_attributes": {},
        "vertex": {str(v): dict(zip("xyz", p, strict=True)) for v, p in enumerate(np.asarray(points).tolist())},
        "face": {str(f): [int(v) for v in face] for f, face in enumerate(faces)},
        "facedata": {str(f): {} for f in range(len(faces))},
        "edgedata": {},
        "max_vertex": len(points) - 1,
        "max_face": len(faces) - 1,
    }
    geometry = {"dtype": "compas.datastructures/Mesh", "inheritance": [], "name": name, "data": mesh}
    own: dict[str, Any] = {"transformation": None, "features": [], "name": name, "material": None, "geometry": geometry}
    return {"dtype": "compas_dem.elements/Block", "guid": key, "name": name, "data": {**own, "is_support": support}}
