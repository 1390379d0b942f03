"""Motions in space as animations: glTF files are read back and their nodes placed at key times."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import concio
from commands import run
from space_motions import blocks

WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
UPWARDS = Rotation.from_euler("x", -90, degrees=True).as_matrix()
"""glTF has y upwards."""


class Scene:
    """A binary glTF file."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        assert int.from_bytes(data[8:12], "little") == len(data)
        length = int.from_bytes(data[12:16], "little")
        self.json, self.body = json.loads(data[20 : 20 + length]), data[28 + length :]

    def values(self, number: int) -> np.ndarray:
        accessor = self.json["accessors"][number]
        view = self.json["bufferViews"][accessor["bufferView"]]
        found = np.frombuffer(self.body, "<f4", view["byteLength"] // 4, view["byteOffset"])
        return found.reshape(accessor["count"], WIDTH[accessor["type"]])

    def corners(self, key: int) -> dict[str, np.ndarray]:
        """Corners of each block at a key time, in the axes of the scene."""
        (animation,) = self.json["animations"]
        root = self.json["nodes"][self.json["scenes"][0]["nodes"][0]]
        outer, found = Rotation.from_quat(root["rotation"]), {}
        for number in root["children"]:
            node = dict(self.json["nodes"][number])
            for channel in animation["channels"]:
                if channel["target"]["node"] == number:
                    sampler = animation["samplers"][channel["sampler"]]
                    node[channel["target"]["path"]] = self.values(sampler["output"])[key]
            mesh = self.json["meshes"][node["mesh"]]["primitives"][0]["attributes"]["POSITION"]
            own = Rotation.from_quat(node["rotation"]).apply(self.values(mesh)) + node["translation"]
            found[node["name"]] = outer.apply(own)
        return found


def alike(scene: Scene, result, count: int) -> None:
    """Corners of every block at every key time are those of the result, to single precision."""
    for key in range(count):
        corners, standing = scene.corners(key), result.configuration(key)
        for b, body in enumerate(result.model.bodies):
            wanted = standing.vertices(b) @ UPWARDS.T
            apart = np.linalg.norm(corners[body.name][:, None] - wanted, axis=2)
            assert apart.min(axis=0).max() < 1e-5
            assert apart.min(axis=1).max() < 1e-5


def test_the_animation_of_a_motion_stands_where_the_result_does(tmp_path: Path) -> None:
    model = blocks(((-0.2, -0.3, 0.5), (0.2, 0.3, 0.9)), ((1.0, 1.0, 0.0), (1.5, 1.4, 0.3)))
    thrown = {"b0": (0.5, 0.2, 0.0, 20.0, -14.0, 5.0), "b1": (0.2, 0.1, 0.0)}
    found = concio.dynamics(model, duration=0.1, velocities=thrown, every=0.02, start="as described")
    concio.write_solids(tmp_path / "moved.glb", found)
    scene = Scene(tmp_path / "moved.glb")
    (animation,) = scene.json["animations"]
    times = {tuple(scene.values(s["input"]).ravel().tolist()) for s in animation["samplers"]}
    assert len(times) == 1
    assert times.pop() == pytest.approx(found.shots.time, abs=1e-6)
    assert {c["target"]["node"] for c in animation["channels"]} == {1, 2}  # the floor stays
    alike(scene, found, len(found.shots.time))
    turns = [scene.values(s["output"]) for s in animation["samplers"]
             if scene.json["accessors"][s["output"]]["type"] == "VEC4"]  # fmt: skip
    assert np.linalg.norm(Rotation.from_matrix(found.end.rotation[1]).as_rotvec()) > 0.5
    for turn in turns:
        assert ((turn[1:] * turn[:-1]).sum(axis=1) > 0).all()  # viewers go the shorter way


def test_the_animation_of_a_push(tmp_path: Path) -> None:
    tall = blocks(((-0.25, -0.2, 0.0), (0.25, 0.2, 2.0)))
    found = concio.push(tall, direction=(1, 0), until=0.05)
    concio.write_solids(tmp_path / "pushed.glb", found)
    alike(Scene(tmp_path / "pushed.glb"), found, len(found))


@pytest.mark.long
def test_the_command_line_writes_animations(tmp_path: Path) -> None:
    tall = blocks(((-0.25, -0.2, 0.0), (0.25, 0.2, 2.0)))
    concio.save(tall, tmp_path / "tall.toml")
    code, _, err = run("push", tmp_path / "tall.toml", "--out", tmp_path / "out", "--film", "glb", "--until", "0.05")
    assert code == 0, err
    assert Scene(tmp_path / "out" / "film.glb").json["animations"]


@pytest.mark.parametrize(("name", "scale", "words"), [("a.obj", 1.0, "no animation"), ("a.glb", 2.0, "true to scale")])
def test_what_cannot_be_animated_is_said(tmp_path: Path, name: str, scale: float, words: str) -> None:
    model = blocks(((-0.2, -0.3, 0.0), (0.2, 0.3, 0.4)))
    found = concio.dynamics(model, duration=0.01)
    with pytest.raises(concio.InputError, match=words):
        concio.write_solids(tmp_path / name, found, scale=scale)


def test_a_motion_in_the_plane_has_no_solids(tmp_path: Path) -> None:
    found = concio.dynamics(concio.column(width=0.5, height=1.0, blocks=1, block="rigid"), duration=0.01)
    with pytest.raises(concio.InputError, match="space"):
        concio.write_solids(tmp_path / "flat.glb", found)


def test_materials_are_as_the_format_has_them(tmp_path: Path) -> None:
    """Factors lie between nothing and one; the ground has another colour than what stands on it."""
    concio.write_solids(tmp_path / "a.glb", blocks(((-0.2, -0.3, 0.0), (0.2, 0.3, 0.4))))
    scene = Scene(tmp_path / "a.glb").json
    tones = []
    for material in scene["materials"]:
        look = material["pbrMetallicRoughness"]
        assert (look["metallicFactor"], look["roughnessFactor"]) == (0.0, 1.0)  # of stone: dull, no metal
        assert len(look["baseColorFactor"]) == 4
        assert all(0.0 <= part <= 1.0 for part in look["baseColorFactor"])
        tones.append(look["baseColorFactor"])
    used = {mesh["name"]: mesh["primitives"][0]["material"] for mesh in scene["meshes"]}
    assert len(used) == 2
    assert sorted(used.values()) == [0, 1]
    assert tones[0] != tones[1]
