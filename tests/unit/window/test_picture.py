"""What the page draws of a model, beside the model itself."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import concio
from concio.window.page_picture import picture

TEMPLATES = Path(concio.__file__).parent / "model" / "templates"


def drawn(text: str, folder: Path) -> dict[str, Any]:
    request = {"text": text, "base": str(folder), "folder": str(folder), "name": "model.toml"}
    return picture(request, lambda *_: None)


@pytest.fixture(scope="module")
def in_space() -> tuple[dict[str, Any], concio.Model]:
    file = TEMPLATES / "blocks_in_space.toml"
    return drawn(file.read_text(encoding="utf-8"), file.parent), concio.load(file)


def test_triangles_of_a_body_in_space_enclose_its_volume_and_lie_on_their_faces(
    in_space: tuple[dict[str, Any], concio.Model],
) -> None:
    shown, model = in_space
    for one, body in zip(shown["bodies"], model.bodies, strict=True):
        points = np.array(one["vertices"])
        volume = sum(np.linalg.det(points[triangle[:3]]) for triangle in one["triangles"]) / 6.0
        assert volume == pytest.approx(body.volume)
        for *corners, face in one["triangles"]:
            assert set(corners) <= set(one["faces"][face])
        assert len(points) - len(one["edges"]) + len(one["faces"]) == 2, "Euler"


def test_loads_in_space_have_an_arrow_where_and_as_they_act(in_space: tuple[dict[str, Any], concio.Model]) -> None:
    loads = {load["group"]: load for load in in_space[0]["loads"]}
    assert "tips" not in loads["dead"]
    assert loads["wind"]["tips"] == [pytest.approx([1.0, 0.0, 1.35])]
    assert loads["wind"]["ways"] == [pytest.approx([0.0, 1.0, 0.0])]
    assert loads["live"]["tips"] == [[1.0, 0.2, 1.7]]
    assert loads["live"]["ways"] == [[0.0, 0.0, -1.0]]
    assert [load["table"] for load in in_space[0]["loads"]] == [0, 1, 2]


def test_joints_in_space_are_the_faces_that_touch(in_space: tuple[dict[str, Any], concio.Model]) -> None:
    shown = in_space[0]
    names = [b["name"] for b in shown["bodies"]]
    found = {(names[j["a"]], names[j["b"]]): np.array(j["ends"]) for j in shown["joints"]}
    lower = found["left pier", "lintel"]
    assert np.ptp(lower, axis=0) == pytest.approx([0.4, 0.4, 0.0])
    assert set(lower[:, 2]) == {1.2}


def test_the_geometry_is_shown_before_joints_are_sought(tmp_path: Path) -> None:
    text = (TEMPLATES / "arch.toml").read_text(encoding="utf-8")
    told: list[tuple[str, dict[str, Any]]] = []
    request = {"text": text, "base": str(tmp_path), "folder": str(tmp_path), "name": "arch.toml"}
    found = picture(request, lambda word, what: told.append((word, what)))
    [(word, early)] = told
    assert (word, early["early"], found["early"]) == ("early", True, False)
    assert early.keys() == found.keys()
    assert early["joints"] == []
    assert found["joints"] != []
    unknown = {"early", "joints", "attention", "attention_italian", "findings", "notes", "fault"}
    assert {k for k in found if found[k] != early[k]} <= unknown


def test_what_draws_the_geometry_loads_no_solver_and_no_scipy() -> None:
    slow = "('scipy', 'skfem')"
    code = f"import sys, concio.window.page_picture; print([m for m in sys.modules if m.split('.')[0] in {slow}])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
