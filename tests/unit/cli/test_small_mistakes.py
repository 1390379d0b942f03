"""Mistakes that were found by users: each is told in words, or is none any more."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from models import box, model_of, weight
from seismic_walls import overturning, site


def test_a_path_whose_last_stage_ends_where_it_begins_says_so() -> None:
    wall = concio.wall(
        length=1.0, height=1.0, block_size=(0.5, 0.25), block="rigid", friction=0.6, unit_weight=20, horizontal=0.1
    )
    found = concio.run_path(wall, [concio.Stage("nothing", {"live": 0.0}), concio.Stage("push", {"live": 1.0})])
    assert "live = 0 of 1" in found.sentence
    word, values = found.load()
    assert word == "live"
    assert np.array_equal(values, [0.0])


@pytest.mark.parametrize(("name", "value"), [("levels", "SLV"), ("elsewhere", "out of plane")])
def test_a_text_in_place_of_a_list_of_texts_is_told(name: str, value: str) -> None:
    with pytest.raises(TypeError, match=rf"{name} = '{value}' must be a sequence of texts") as told:
        concio.assess(overturning(), site=site(), **{name: value})  # type: ignore[arg-type]
    assert f"write ('{value}',)" in str(told.value)


def test_a_tie_reads_texts_with_units() -> None:
    tie = concio.Tie(
        "t", "a", (0.0, 0.0), "", (1.0, 0.0), stiffness="10 MN/m", prestress="500 N", break_elongation="2 mm"
    )  # type: ignore[arg-type]
    assert (tie.stiffness, tie.prestress, tie.break_elongation) == pytest.approx((1e4, 0.5, 2e-3))
    with pytest.raises(concio.InputError, match="tie 't', stiffness"):
        concio.Tie("t", "a", (0.0, 0.0), "", (1.0, 0.0), stiffness="10 m")  # type: ignore[arg-type]


def test_a_comparison_with_the_continuum_prints_in_a_few_lines() -> None:
    wall = concio.wall(length=0.8, height=0.4, block_size=(0.4, 0.2), friction=0.6, unit_weight=20.0, top_pressure=10.0)
    assert len(repr(concio.compare_with_continuum(wall, mesh_size=0.4, strength=False))) < 1500


def test_the_thrust_line_of_a_wall_names_what_shows_its_forces() -> None:
    stone = {"kind": "rigid", "material": "stone"}
    blocks = [box("floor", 0, 2, -1, 0, kind="fixed"), box("a", 0, 1, 0, 1, **stone), box("b", 1, 2, 0, 1, **stone)]
    result = concio.solve(model_of(*blocks, box("c", 0, 2, 1, 2, **stone), loads=(weight(),)))
    with pytest.raises(concio.InputError, match=r"result\.plot\.forces"):
        concio.thrust_line(result)


WALL = "[wall]\nlength = 1.0\nheight = 0.5\nblock_size = [0.5, 0.25]\n"


@pytest.mark.parametrize(
    ("text", "asked", "said"),
    [
        (WALL + 'friction = "steel"\n', ("check",), "give a number, or define [joints.steel]"),
        (WALL + 'block = "oak"\n', ("check",), "define [materials.oak]"),
        (WALL, ("study",), "there is no table [study]"),
        (WALL, ("limit",), "where --group names no other -> name one with --group (dead), or add [[loads]]"),
        (WALL, ("limit", "--group", "daed"), "there is no load group 'daed' -> did you mean 'dead'?"),
        ("[[blocks]]\nname = 'a'\nbox = [[0, 0], [1, 1]]\n", ("check",), "in the plane: rectangle = [[x, y], [x, y]]"),
        (WALL, ("path", "--until", "5 mm"), "--until: it is a displacement of a control point, and no control point"),
        ('[wall]\nlength = "1 foot"\n', ("check",), "use m, or another unit made of N, kN"),
    ],
)
def test_what_is_missing_is_named_with_what_to_add(
    text: str, asked: tuple[str, ...], said: str, tmp_path: Path
) -> None:
    path = tmp_path / "wall.toml"
    path.write_text(text)
    code, _, err = run(asked[0], path, *asked[1:])
    assert code == 2
    assert said in " ".join(err.split())
    assert err.startswith("Error: "), "nothing comes before the one message"


def test_a_path_without_self_weight_says_so_in_its_answer() -> None:
    ground, pillar = box("ground", 0, 1, -0.2, 0, kind="fixed"), box("pillar", 0, 1, 0, 2)
    model = model_of(ground, pillar, loads=(), supports=(concio.Support("sinks", "ground", displacement=(0, -0.01)),))
    found = concio.settle(model)
    assert "Self-weight does not act: 1 block has a unit weight" in found.path.verdict.sentence


def test_a_kind_that_there_is_not_is_told_without_words_of_a_library() -> None:
    code, _, told = run("new", "facade")
    assert code == 2
    assert "'facade' is not one of 'panel', 'wall'" in " ".join(told.replace("│", " ").split())
    assert "Value error" not in told


@pytest.mark.parametrize(
    ("options", "said"),
    [(("--methods", ","), "names no method"), (("--methods", "lemke", "--time-limit", "-1"), "time_limit = -1"),
     (("--time-limit", "nan"), "time_limit = nan")],
)  # fmt: skip
def test_compare_asks_for_a_method_and_for_time(tmp_path: Path, options: tuple[str, ...], said: str) -> None:
    """No method was the engine alone; with no time every method was "too slow" and the exit code 0."""
    (tmp_path / "m.toml").write_text('[column]\nwidth = 0.5\nheight = 1.0\nblocks = 2\nblock = "rigid"')
    code, out, err = run("compare", tmp_path / "m.toml", *options)
    assert (code, out) == (2, "")
    assert said in err


def test_one_method_is_one_method(tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text('[column]\nwidth = 0.5\nheight = 1.0\nblocks = 2\nblock = "rigid"')
    out = run("compare", tmp_path / "m.toml", "--methods", "interior-point")[1]
    assert "by 1 method\n" in out
    assert "Of 1 method 1 meets the equations" in out
