"""glTF 2.0 in one binary file: a node for each block, flat shading, in metres with y upwards as the format asks."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from concio.kinematics.frames import cross

Array = np.ndarray
STONE, GROUND = [0.86, 0.80, 0.70, 1.0], [0.55, 0.55, 0.55, 1.0]
"""Colours of blocks and of fixed bodies."""


def glb_bytes(blocks: Sequence[tuple[str, Array, bool]]) -> bytes:
    """Return a scene of blocks: name, triangles (t, 3, 3) [m], and whether the block is fixed.

    Coordinates are in single precision about the middle of each block, whose place is that of its node.
    """
    nodes, meshes, accessors, views = [], [], [], []
    data = bytearray()
    for k, (name, triangles, fixed) in enumerate(blocks):
        middle = triangles.reshape(-1, 3).mean(0)
        points = (triangles - middle).astype("<f4").reshape(-1, 3)
        normal = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        for values in (points, np.repeat(normal, 3, axis=0).astype("<f4")):
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes, "target": 34962})
            data += values.tobytes()
        common: dict[str, Any] = {"componentType": 5126, "count": len(points), "type": "VEC3"}
        accessors += [
            {"bufferView": 2 * k, **common, "min": points.min(0).tolist(), "max": points.max(0).tolist()},
            {"bufferView": 2 * k + 1, **common},
        ]
        part = {"attributes": {"POSITION": 2 * k, "NORMAL": 2 * k + 1}, "material": int(fixed)}
        meshes.append({"name": name, "primitives": [part]})
        nodes.append({"name": name, "mesh": k, "translation": middle.tolist()})
    turn = {"name": "concio", "rotation": [-(0.5**0.5), 0.0, 0.0, 0.5**0.5], "children": list(range(len(nodes)))}
    materials = [
        {"name": word, "pbrMetallicRoughness": {"baseColorFactor": tone, "metallicFactor": 0.0, "roughnessFactor": 1.0}}
        for word, tone in (("blocks", STONE), ("fixed", GROUND))
    ]
    scene = {
        "asset": {"version": "2.0", "generator": "concio"}, "scene": 0, "scenes": [{"nodes": [len(nodes)]}],
        "nodes": [*nodes, turn], "meshes": meshes, "materials": materials, "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }  # fmt: skip
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    body = bytes(data) + b"\0" * (-len(data) % 4)
    chunks = len(text).to_bytes(4, "little") + b"JSON" + text + len(body).to_bytes(4, "little") + b"BIN\0" + body
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks
