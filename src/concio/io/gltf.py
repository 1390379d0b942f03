"""glTF 2.0 in one binary file: a node for each block, flat shading, in metres with y upwards as the format asks.

A motion is an animation with one channel for the place and one for the rotation of each block that moves.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from concio.kinematics.frames import cross

Array = np.ndarray
STONE, GROUND = [0.86, 0.80, 0.70, 1.0], [0.55, 0.55, 0.55, 1.0]
"""Colours of blocks and of fixed bodies."""




@dataclass(frozen=True, eq=False)
class Moving:
    """How blocks move.

    Parameters
    ----------
    time : (n,) array
        Growing, from zero [s].
    centroid : (B, 3) array
        As described [m].
    centre : (n, B, 3) array
        Where the centroids are [m].
    rotation : (n, B, 3, 3) array
    """

    time: Array
    centroid: Array
    centre: Array
    rotation: Array

    def places(self, k: int, point: Array) -> Array:
        """Return where a point (3,) of block k as described is (n, 3) [m]."""
        return np.asarray(self.centre[:, k] + self.rotation[:, k] @ (point - self.centroid[k]))

    def quaternions(self, k: int) -> Array:
        """Return the rotations of block k as unit quaternions (n, 4), x y z w, the shorter way from one to the next."""
        found = Rotation.from_matrix(self.rotation[:, k]).as_quat()
        turns = np.where((found[1:] * found[:-1]).sum(axis=1) < 0, -1.0, 1.0)
        found[1:] *= np.cumprod(turns)[:, None]
        return np.asarray(found)


class _Data:
    """The binary part of a file, with its accessors."""

    def __init__(self) -> None:
        self.bytes = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, values: Array, kind: str, *, bounds: bool = False, target: int | None = None) -> int:
        """Return the number of the accessor of values (n,) or (n, c), which are stored in single precision."""
        values = np.ascontiguousarray(values, dtype="<f4")
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": values.nbytes}
        self.views.append(view if target is None else {**view, "target": target})
        self.bytes += values.tobytes()
        one: dict[str, Any] = {"bufferView": len(self.views) - 1, "componentType": 5126, "count": len(values)}
        one["type"] = kind
        if bounds:
            flat = values.reshape(len(values), -1)
            one |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        self.accessors.append(one)
        return len(self.accessors) - 1


def glb_bytes(blocks: Sequence[tuple[str, Array, bool]], moving: Moving | None = None) -> bytes:
    """Return a scene of blocks: name, triangles (t, 3, 3) [m], and whether the block is fixed.

    Coordinates are in single precision about the middle of each block, whose place is that of its node.

    Parameters
    ----------
    blocks : sequence of (str, (t, 3, 3) array, bool)
    moving : Moving, optional
        Makes an animation of the scene, whose blocks are then given as described.
    """
    nodes, meshes, middles = [], [], []
    data = _Data()
    for k, (name, triangles, fixed) in enumerate(blocks):
        middle = triangles.reshape(-1, 3).mean(0)
        normal = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        point = data.add((triangles - middle).reshape(-1, 3), "VEC3", bounds=True, target=34962)
        attributes = {"POSITION": point, "NORMAL": data.add(np.repeat(normal, 3, axis=0), "VEC3", target=34962)}
        meshes.append({"name": name, "primitives": [{"attributes": attributes, "material": int(fixed)}]})
        nodes.append({"name": name, "mesh": k, "translation": middle.tolist()})
        middles.append(middle)
    animations = [] if moving is None else [_animation(data, nodes, middles, moving)]
    turn = {"name": "concio", "rotation": [-(0.5**0.5), 0.0, 0.0, 0.5**0.5], "children": list(range(len(nodes)))}
    materials = [
        {"name": word, "pbrMetallicRoughness": {"baseColorFactor": tone, "metallicFactor": 0.0, "roughnessFactor": 1.0}}
        for word, tone in (("blocks", STONE), ("fixed", GROUND))
    ]
    scene = {
        "asset": {"version": "2.0", "generator": "concio"}, "scene": 0, "scenes": [{"nodes": [len(nodes)]}],
        "nodes": [*nodes, turn], "meshes": meshes, "materials": materials, "accessors": data.accessors,
        "bufferViews": data.views, "buffers": [{"byteLength": len(data.bytes)}],
    }  # fmt: skip
    if animations:
        scene["animations"] = animations
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    body = bytes(data.bytes) + b"\0" * (-len(data.bytes) % 4)
    chunks = len(text).to_bytes(4, "little") + b"JSON" + text + len(body).to_bytes(4, "little") + b"BIN\0" + body
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks


def _animation(data: _Data, nodes: list[dict[str, Any]], middles: Sequence[Array], moving: Moving) -> dict[str, Any]:
    """Return the animation of a motion; nodes get the places and rotations of its first instant."""
    time = data.add(moving.time, "SCALAR", bounds=True)
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    for k, node in enumerate(nodes):
        place, turn = moving.places(k, middles[k]), moving.quaternions(k)
        node |= {"translation": place[0].tolist(), "rotation": turn[0].tolist()}
        for path, values, kind in (("translation", place, "VEC3"), ("rotation", turn, "VEC4")):
            if (values == values[0]).all():
                continue
            channels.append({"sampler": len(samplers), "target": {"node": k, "path": path}})
            samplers.append({"input": time, "output": data.add(values, kind), "interpolation": "LINEAR"})
    return {"name": "motion", "samplers": samplers, "channels": channels}
