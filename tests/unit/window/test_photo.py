"""A picture under the model: scale, stones, and blocks of the text corrected with all that share their corners."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image

import concio
from concio.errors import InputError
from concio.trace import read_photo, wire
from concio.window.commands import patch_of
from concio.window.starting import model_text
from concio.window.traced_picture import traced, underlay, wired
from rendered import rendered


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("photo")
    wall = concio.wall(block_size=(0.25, 0.125), length=1.0, height=0.5, block="rigid")
    grey = rendered(wall, contrast=0.25, seed=1).grey
    Image.fromarray((255 * grey).astype(np.uint8)).save(place / "wall.png")
    return place


def request(folder: Path, text: str, **more: Any) -> dict[str, Any]:
    return {"text": text, "base": str(folder), "folder": str(folder), "name": "wall.toml", **more}


def done(text: str, **command: Any) -> str:
    return patch_of(text, command)[0].applied(text)


@pytest.fixture
def scaled(folder: Path) -> str:
    text = model_text(folder / "wall.png")
    assert text is not None
    text = done(text, do="set", path=["record", "picture", "points"], value=[[0, 10], [300, 10]])
    return done(text, do="set", path=["record", "picture", "distance"], value=1.0)


def test_a_picture_lies_where_its_scale_puts_it(folder: Path, scaled: str) -> None:
    text = model_text(folder / "wall.png")
    assert text is not None
    assert not underlay(request(folder, text), lambda *_: None)["known"]
    found = underlay(request(folder, scaled), lambda *_: None)
    assert found["known"]
    assert found["box"] == pytest.approx([0.0, 0.0, 1.0, 0.5])
    corners = [[0, 150], [300, 150], [300, 0], [0, 0]]
    flat = done(text, do="set", path=["record", "picture", "corners"], value=corners)
    flat = done(flat, do="set", path=["record", "picture", "size"], value=[1.0, 0.5])
    assert underlay(request(folder, flat), lambda *_: None)["flat"]
    with pytest.raises(InputError, match="no scale yet"):
        traced(request(folder, text, method="courses", unit=[0.25, 0.125]), lambda *_: None)


def test_the_way_to_the_pointer_is_that_of_the_outline(folder: Path, scaled: str) -> None:
    """From below the bed joint at 0.25 m to above it: the way goes along the joint, a straight line would not."""
    a, b = [0.1, 0.235], [0.6, 0.262]
    found = wired(request(folder, scaled, a=a, b=b, joint=0.01), lambda *_: None)["way"]
    photo = read_photo(folder / "wall.png").scaled((0, 10), (300, 10), 1.0)
    assert np.array(found) == pytest.approx(wire(photo, a, b, joint=0.01), abs=1e-5)
    middle = [y for x, y in found if 0.2 < x < 0.5]
    assert max(abs(y - 0.25) for y in middle) < 0.007


def test_a_way_that_takes_long_is_not_shown_at_once(folder: Path, scaled: str) -> None:
    large = done(scaled, do="set", path=["record", "picture", "file"], value="large.png")
    Image.new("L", (3000, 2000)).save(folder / "large.png")
    assert wired(request(folder, large, a=[0, 0], b=[9.0, 6.0]), lambda *_: None) == {"way": None}
    unscaled = model_text(folder / "wall.png")
    assert unscaled is not None
    assert wired(request(folder, unscaled, a=[0, 0], b=[0.1, 0.1]), lambda *_: None) == {"way": None}
    with pytest.raises(InputError):
        wired(request(folder, scaled, a=[0, 0], b=["x", 1]), lambda *_: None)


def test_a_picture_that_changes_on_the_disk_is_read_again(folder: Path, scaled: str) -> None:
    other = done(scaled, do="set", path=["record", "picture", "file"], value="other.png")
    sizes = []
    for size in ((300, 100), (600, 100)):
        Image.new("L", size).save(folder / "other.png")
        sizes.append(underlay(request(folder, other), lambda *_: None)["columns"])
    assert sizes == [300, 600]


def test_traced_stones_become_blocks_that_stand(folder: Path, scaled: str) -> None:
    found = traced(request(folder, scaled, method="courses", unit=[0.25, 0.125]), lambda *_: None)
    text = done(scaled, do="stones", stones=found["stones"])
    model = concio.loads(text, folder=folder)
    assert len(model.free_bodies) == len(found["stones"]) == 18
    assert concio.solve(model).solved
    again = done(text, do="stones", stones=found["stones"][:5])
    assert len(tomllib.loads(again)["blocks"]) == 6, "they replace those that were traced before, with one ground"


SQUARES = """title = "two"   # a comment that stays
[[blocks]]
name = "a"
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
[[blocks]]
name = "b"
rectangle = [[1, 0], [2, 1]]
[[blocks]]
name = "far"
rectangle = [[5, 0], [6, 1]]
"""


def test_blocks_are_merged_and_split_again() -> None:
    one = done(SQUARES, do="merge", names=["a", "b"])
    blocks = tomllib.loads(one)["blocks"]
    assert [b["name"] for b in blocks] == ["a", "far"]
    assert shapely.Polygon(blocks[0]["outline"]).area == pytest.approx(2.0)
    two = tomllib.loads(done(one, do="split", name="a", line=[[1.0, -1.0], [1.0, 2.0]]))["blocks"]
    assert sorted(shapely.Polygon(b["outline"]).area for b in two if "outline" in b) == pytest.approx([1.0, 1.0])
    assert len({b["name"] for b in two}) == 3
    assert one.startswith('title = "two"   # a comment that stays\n')


def test_a_corner_moves_in_every_block_that_has_it() -> None:
    moved = tomllib.loads(done(SQUARES, do="corner", **{"from": [1.0, 1.0]}, to=[1.1, 1.2]))["blocks"]
    assert [1.1, 1.2] in moved[0]["outline"]
    assert [1.1, 1.2] in moved[1]["outline"]
    a, b = (shapely.Polygon(one["outline"]) for one in moved[:2])
    assert a.intersection(b).area == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ({"do": "merge", "names": ["a", "far"]}, "do not touch"),
        ({"do": "merge", "names": ["a"]}, "one block alone"),
        ({"do": "merge", "names": ["a", "c"]}, "block 'c' does not stand"),
        ({"do": "split", "name": "a", "line": [[3, 3], [4, 4]]}, "does not cut"),
        ({"do": "corner", "from": [9.0, 9.0], "to": [0.0, 0.0]}, "no block of the text has a corner"),
        ({"do": "corner", "from": [1.0, 1.0], "to": [-3.0, 0.5]}, "would cross itself"),
        ({"do": "stones", "stones": []}, "0 stones"),
        ({"do": "stones", "stones": [[[0, 0], [1, 1], [1, 0], [0, 1]]]}, "crosses itself"),
        ({"do": "stones", "stones": "all"}, "pairs of numbers"),
    ],
)
def test_what_cannot_be_corrected_is_refused(command: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        patch_of(SQUARES, command)


@pytest.mark.parametrize("name", ["a.obj", "a.ifc", "a.ply", "a.stl"])
def test_solids_start_a_model_that_names_them(name: str) -> None:
    text = model_text(Path(name))
    assert text is not None
    assert tomllib.loads(text)["solids_file"] == name


@pytest.mark.parametrize(
    "stone", [[[0, 0], [1, 0]], [[0, 0], [1, 0], [1]], [[0, 0], [1, 0], ["1 m", 1]], [[0, 0], [1, 0], [True, 1]],
              [[0, 0], [1, 0], (1, 1)], "a stone", None, [[0, 0], [1, 0], [1e9, 1]]]
)  # fmt: skip
def test_outlines_that_are_no_points_are_refused_in_words(stone: Any) -> None:
    with pytest.raises(InputError, match="points are not pairs of numbers"):
        patch_of('name = "a wall"\n', {"do": "stones", "stones": [stone]})
