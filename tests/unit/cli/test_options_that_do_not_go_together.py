"""Options of which one would be left aside, and numbers of multiplied groups that have a factor of their own."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from commands import run

MODEL = """
[materials.block]
kind = "rigid"
unit_weight = 20
[joints.dry]
friction = 0.6
[[blocks]]
name = "ground"
rectangle = [[-2, -1], [2, 0]]
kind = "fixed"
[[blocks]]
name = "b"
rectangle = [[-0.5, 0], [0.5, 1]]
[[loads]]
kind = "weight"
value = [0, -1]
[[loads]]
kind = "point"
value = [1, 0]
at = [-0.5, 0.5]
bodies = ["b"]
group = "live"
"""
STAGES = """
[[stages]]
name = "up"
factors = { dead = 1 }
steps = 3
[[stages]]
name = "pushed"
factors = { live = 5 }
steps = 4
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "block.toml"
    path.write_text(MODEL)
    return path


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (("push", "--weights", "--group", "live"), "either all weights are multiplied or load groups"),
        (("push", "--along", "y"), "no control point is given"),
        (("path", "--along", "-x"), "no control point is given"),
        (("path", "--steps", "50"), "takes no number of steps"),
        (("path", "--steps", "50", "--method", "events"), "takes no number of steps"),
    ],
)
def test_what_would_be_left_aside_is_refused(file, command, words):
    code, _, err = run(command[0], file, *command[1:])
    assert code == 2
    assert words in err


@pytest.mark.parametrize(("given", "steps"), [((), 3 + 4), (("--steps", "2"), 2 + 2)])
def test_steps_are_those_of_the_stages_or_of_the_command(file, given, steps):
    """With stages in the file the number of the command was left aside."""
    file.write_text(MODEL + STAGES)
    code, out, err = run("path", file, "--method", "steps", *given, "--json")
    assert code == 0, err
    assert len(json.loads(out)["curve"]["stage"]) == steps + 1


@pytest.mark.parametrize("factor", [1.0, 3.0, -2.0])
def test_a_multiplied_group_is_stated_with_its_own_factor(file, factor):
    """With -f live=3 a peak of 4 stood beside "at factor 1 +1 kN", where 12 kN push."""
    code, out, err = run("push", file, "-g", "live", "-f", f"live={factor}", "--json")
    assert code == 0, err
    found = json.loads(out)
    (live,) = [one for one in found["verdict"]["question"]["acting"] if one["group"] == "live"]
    assert live["factor"] * live["force"][0] == pytest.approx(12.0 if factor > 0 else -12.0, rel=1e-4)


@pytest.mark.parametrize(("command", "options"), [
    ("run", ("-f", "live=2", "-f", "live=3")), ("path", ("--stage", "dead=1,live=1,dead=2")),
    ("shake", ("--pulse", "sine,0.1 g,0.2 s", "-f", "live=2", "-f", "live=2")),
])  # fmt: skip
def test_two_factors_of_one_group_are_refused(command: str, options: tuple[str, ...], tmp_path: Path) -> None:
    """The last one counted, without a word on the first."""
    path = tmp_path / "m.toml"
    path.write_text(MODEL)
    code, _, error = run(command, path, *options)
    assert code == 2
    assert "two factors are given for the load group" in " ".join(error.split())


def test_a_push_that_ends_at_a_multiplier_does_not_say_that_the_strength_is_lost(tmp_path: Path) -> None:
    """A curve that ends at half of the peak by --smallest ended where "the strength is lost"."""
    path = tmp_path / "m.toml"
    path.write_text(MODEL)
    told = {}
    for smallest in (0.0, 3.0):
        told[smallest] = json.loads(run("push", path, "--smallest", smallest, "--json")[1])["verdict"]["sentence"]
    assert "The strength is lost at" in told[0.0]
    assert "The multiplier falls to 3 at" in told[3.0]
    assert "lost" not in told[3.0]


def test_a_collapse_state_without_any_load_is_none(tmp_path: Path) -> None:
    """Where all loads are multiplied, and are carried at any multiple, 0 was one "where friction lets it move"."""
    path = tmp_path / "m.toml"
    path.write_text(MODEL)
    code, out, _ = run("limit", path, "-g", "live", "-g", "dead")
    assert code == 0
    assert "can grow without bound" in out
    assert "lets it begin to move" not in out


IDLE = {
    "unit of tables": (2, ("--to", "csv", "--unit", "mm"), "--unit is that of a DXF drawing of a plane model"),
    "scale of tables": (2, ("--to", "csv", "--scale", "10"), "--scale is that of displaced shapes"),
    "scale of a series": (2, ("--to", "vtu", "--scale", "10"), "Warp By Vector"),
    "scale of a model": (2, ("--to", "toml", "--scale", "10"), "--scale is that of displaced shapes"),
    "unit of solids": (3, ("--to", "obj", "--unit", "mm"), "--unit is that of a DXF drawing of a plane model"),
    "another format": (3, ("--to", "obj", "--out", "solids.stl"), "'solids.stl' does not end in .obj"),
    "scale without a number": (2, ("--to", "dxf", "--scale", "nan", "--out", "solids.stl"), "--scale nan is not"),
    "scale without end": (3, ("--to", "stl", "--scale", "inf", "--out", "solids.stl"), "--scale inf is not"),
    "no format": (3, ("--to", "stl", "--out", "solids"), "write --out solids.stl"),
}


@pytest.mark.parametrize("sort", IDLE)
def test_options_of_an_export_that_would_be_left_aside(
    sort: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tables "in mm" were in m, and ``--to obj --out solids.stl`` wrote an STL file."""
    monkeypatch.chdir(tmp_path)
    dim, options, said = IDLE[sort]
    Path("m.toml").write_text(MODEL + ("[extrusion]\nthickness = 1.0\n" if dim == 3 else ""))
    assert run("run", "m.toml", "--out", "r", "--quiet")[0] == 0
    code, _, error = run("export", "r", *options)
    assert code == 2
    assert said in " ".join(error.split())
    assert not Path("solids.stl").exists()
