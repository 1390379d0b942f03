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
