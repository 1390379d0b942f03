"""Every command that can say that something does not stand says with which joints, how many are missing, and where."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from commands import run
from pillars import FLOOR, STONE, WEIGHT, sideways

STUDY = """
[study]
size = 1
outputs = ["stands"]
[[study.variables]]
name = "friction"
distribution = "choice"
keys = "joints.dry.friction"
values = [0.6]
"""
PHRASE = "with the joints that were made"


def block(name: str, outline: str) -> str:
    return f'[[blocks]]\nname = "{name}"\noutline = {outline}\nmaterial = "stone"\n'


def posts(below: str, beam: str, law: str = "") -> str:
    """Return a beam above a post and what else stands below it."""
    stone = STONE.format(friction=0.6) + law
    return stone + FLOOR + below + block("beam", beam) + WEIGHT + sideways(0.1) + STUDY


def wall(x: float) -> str:
    """Return a fixed post of 0.4 m, 0.5 m high."""
    return f'[[blocks]]\nname = "post {x:g}"\nrectangle = [[{x}, 0.0], [{x + 0.4}, 0.5]]\nkind = "fixed"\n'


KNIVES = "".join(
    block(name, f"[[{x}, 0.0], [{x + 0.4}, 0.0], [{x + 0.2}, 0.5]]") for name, x in (("k1", 0.0), ("k2", 1.5))
)
BEAM = "[[0.0, 0.5], [2.0, 0.5], [2.0, 0.8], [0.0, 0.8]]"
MODELS = {
    "knife edges of stone that crushes": (
        posts(KNIVES, BEAM, 'compressive_strength = "2 MPa"\n'), 2, ("'k1' and 'beam' at (0.2, 0.5) m (corner)",)
    ),
    "a sliver": (posts(wall(-0.3) + wall(1.9999), BEAM), 1, ("'post 1.9999' and 'beam' at (2, 0.5) m (sliver)",)),
    "a face a hundredth of a block away": (
        posts(wall(-0.3) + wall(1.6).replace("0.5]]", "0.495]]"), BEAM), 1, ("'post 1.6' and 'beam' at (1.8, ", "(gap)")
    ),
}  # fmt: skip
"""Beams that would stand, the number of joints that were not made, and what is said of their place."""
COMMANDS: dict[str, tuple[object, ...]] = {
    "run": (), "limit": (), "path": ("--stage", "dead=1"), "push": ("--until", "5 mm"), "prove": (),
    "shake": ("--pulse", "sine,0.01 g,0.05 s", "--duration", "0.05 s"), "compare": ("--methods", "auto"),
    "study": ("--no-figures",),
}  # fmt: skip
MOVING = ("push", "shake")
"""Contacts are sought while blocks move: what is near is met, and no proof is needed that it was not."""


def asked(command: str, name: str, tmp_path: Path) -> tuple[int, dict[str, Any]]:
    path = tmp_path / "model.toml"
    path.write_text(MODELS[name][0])
    code, out, err = run(command, path, *COMMANDS[command], "--json")
    assert out, err
    return code, json.loads(out)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("command", [c for c in COMMANDS if c not in MOVING])
def test_what_does_not_stand_does_not_with_the_joints_that_were_made(command: str, name: str, tmp_path: Path) -> None:
    _, count, place = MODELS[name]
    code, found = asked(command, name, tmp_path)
    verdict = found["verdict"]
    assert code == (0 if command == "study" else 3), verdict["sentence"]
    assert PHRASE in verdict["sentence"]
    for told in (verdict["sentence"], " ".join(verdict["limits"]), " ".join(found["attention"])):
        assert f"{count} joint{'s' if count > 1 else ''} almost made" in told
        assert all(word in told for word in place)


@pytest.mark.parametrize("command", MOVING)
def test_motions_meet_what_was_not_joined_or_say_that_it_was_not_checked(command: str, tmp_path: Path) -> None:
    code, found = asked(command, "knife edges of stone that crushes", tmp_path)
    assert code == found["verdict"]["exit_code"] == 4
    assert found["verdict"]["outcome"] == {"push": "incomplete", "shake": "moving"}[command]
    assert "at 2 contacts at a corner or along an edge" in found["verdict"]["sentence"]
    assert "'k1' on 'beam' at (0.2, 0.5) m (corner)" in found["verdict"]["sentence"]


@pytest.mark.parametrize("name", [n for n in MODELS if "knife" not in n])
@pytest.mark.parametrize("command", MOVING)
def test_motions_over_joints_that_were_not_made_name_them(command: str, name: str, tmp_path: Path) -> None:
    _, _, place = MODELS[name]
    _, found = asked(command, name, tmp_path)
    for told in (" ".join(found["verdict"]["limits"]), " ".join(found["attention"])):
        assert "1 joint almost made" in told
        assert all(word in told for word in place)


def test_a_beam_whose_joints_were_all_made_gets_no_such_sentence(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(posts(wall(-0.3) + wall(1.6), BEAM))
    verdict = json.loads(run("path", path, "--stage", "dead=1", "--json")[1])["verdict"]
    assert verdict["outcome"] == "holds"
    assert PHRASE not in verdict["sentence"]


def test_fractions_prove_no_collapse_while_joints_are_missing(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(MODELS["a sliver"][0])
    code, out, _ = run("prove", path, "--claim", "collapse", "--json")
    assert code == 2
    assert "1 joint almost made" in json.loads(out)["what"]
    assert "(sliver)" in json.loads(out)["what"]
