"""What is odd about a model stands under ``attention`` in the JSON of every command, and in every exception."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import typer.main

import concio
from commands import run
from concio.cli.main import app
from concio.errors import ConcioError
from concio.verdict.unanswered import ASKED
from pillars import pillar, sideways
from samples import first

ODD = pillar(sideways(0.2), friction=3.0)
SITE = """
[site]
soil = "B"
[site.hazard]
SLV = { a_g = 0.1, F0 = 2.45, Tc = 0.32 }
"""
STUDY = """
[study]
size = 2
outputs = ["stands"]
[[study.variables]]
name = "lean"
keys = "loads[2].value[1]"
low = 0.1
high = 0.2
"""
SINKING = ODD + '[[supports]]\nname = "sinks"\nbody = "floor"\ndisplacement = [0.0, -0.001]\n'
CELL = "[cell]\nblock_size = [0.4, 0.2]\nfriction = 3.0\n"
WALL = "[wall]\nlength = 0.8\nheight = 0.4\nblock_size = [0.4, 0.2]\nfriction = 3.0\nhorizontal = 0.1\n"
BRIDGE = (
    "[bridge]\nspan = 3.0\nrise = 0.75\nring = 0.215\nvoussoirs = 8\nwidth = 2.0\nblock = 'rigid'\nfriction = 3.0\n"
    "[fill]\ncover = 0.3\n[vehicle]\naxles = [[0.0, 50.0]]\nposition = 1.0\n"
)

SURVEY = (
    (Path(concio.__file__).parents[2] / "examples" / "cracked_arch.toml").read_text(encoding="utf-8")
    .replace("friction = ", "friction = 3.0 # ")
)  # fmt: skip

ASKS: dict[str, tuple[str, tuple[object, ...]]] = {
    "check": (ODD, ()),
    "run": (ODD, ()),
    "path": (ODD, ("--stage", "dead=1", "--stage", "live=1")),
    "settle": (SINKING, ()),
    "limit": (ODD, ("--no-friction",)),
    "compare": (ODD, ("--methods", "auto")),
    "push": (ODD, ("--until", "5 mm")),
    "shake": (ODD, ("--pulse", "sine,0.05 g,0.1 s")),
    "assess": (pillar(friction=3.0) + SITE, ("--quiet",)),
    "study": (ODD + STUDY, ()),
    "prove": (ODD, ()),
    "diagnose": (SURVEY, ("--most", "1")),
    "cell": (CELL, ("--no-strength",)),
    "continuum": (WALL, ("--no-strength", "--mesh-size", "0.4")),
    "bridge": (BRIDGE, ("--step", "1 m", "--fine", "1 m", "--worst", "1", "--checked", "1", "--no-sensitivity")),
}
"""A model with an implausible friction, given to every command that takes a model."""
WRONG: dict[str, tuple[str, tuple[object, ...]]] = {
    "run": (ODD, ("--method", "none")),
    "path": (ODD, ("--stage", "none=1")),
    "settle": (SINKING, ("--group", "none")),
    "limit": (ODD, ("--group", "none")),
    "compare": (ODD, ("--methods", "none")),
    "push": (ODD, ("--group", "none")),
    "shake": (ODD, ("--pulse", "none")),
    "assess": (ODD, ()),
    "study": (ODD, ()),
    "prove": (ODD, ("--group", "none")),
    "diagnose": (ODD, ()),
    "cell": (ODD, ()),
    "continuum": (WALL, ("--group", "none")),
    "bridge": (BRIDGE, ("--vehicle", "none")),
}
"""The same, asked what it cannot answer."""


def asked(command: str, text: str, options: tuple[object, ...], tmp_path: Path) -> tuple[int, dict[str, Any]]:
    """Return exit code and JSON of a command; what it writes goes to a directory of the test."""
    path = tmp_path / "model.toml"
    path.write_text(text)
    code, out, err = run(command, path, *options, "--json")
    assert out, err
    found: dict[str, Any] = json.loads(out)
    return code, found


def odd(text: str) -> set[str]:
    """Return what the verdict of a model says is odd about it."""
    from concio.contact.detection import detect
    from concio.verdict.attention import attention_of

    model = concio.loads(text)
    found = set(attention_of(model, detect(model)))
    assert any("friction 3" in line for line in found)
    return found


def test_every_command_with_json_is_asked() -> None:
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    told = {name for name, command in commands.items() if any("--json" in p.opts for p in command.params)}
    assert told - {"verify"} == set(ASKS), "a command whose JSON was not examined"
    assert set(WRONG) == set(ASKS) - {"check"}


@pytest.mark.parametrize("command", first(4, ASKS))
def test_the_json_of_every_command_carries_the_list(command: str, tmp_path: Path) -> None:
    text, options = ASKS[command]
    code, found = asked(command, text, options, tmp_path)
    assert code in (0, 3, 4), found
    assert odd(text) <= set(found["attention"])
    if command != "check":
        assert found["verdict"]["exit_code"] == code
        assert found["attention"] == found["verdict"]["attention"]
        assert found["verdict"]["question"]["asked"]


@pytest.mark.parametrize("command", WRONG)
def test_the_json_of_a_refusal_carries_the_list(command: str, tmp_path: Path) -> None:
    text, options = WRONG[command]
    code, found = asked(command, text, options, tmp_path)
    assert (code, found["status"]) == (2, "error"), found
    assert odd(text) <= set(found["attention"])


@pytest.mark.parametrize("command", ["limit", "push", "prove"])
def test_the_json_of_a_structure_that_does_not_stand_carries_the_list(command: str, tmp_path: Path) -> None:
    """It leans past its edge under its own weight: an exception of these commands."""
    text = pillar(sideways(0.2), lean=0.5, friction=3.0)
    code, found = asked(command, text, (), tmp_path)
    assert code == found["verdict"]["exit_code"] == 3, found
    assert odd(text) <= set(found["attention"])
    assert found["verdict"]["question"]["acting"]


def test_a_certificate_keeps_the_list(tmp_path: Path) -> None:
    code, made = asked("prove", ODD, (), tmp_path)
    assert code == 0
    found = json.loads(run("verify", made["file"], "--json")[1])
    assert odd(ODD) <= set(found["attention"])
    place = Path(made["file"])
    place.write_text(place.read_text().replace("friction 3", "friction 2"))
    assert run("verify", place)[0] == 2, "what is noted belongs to what the digest covers"


def test_what_prove_does_not_take_is_refused(tmp_path: Path) -> None:
    for options in (("--claim", "limit", "--factor", "dead=2"), ("--claim", "collapse", "--group", "live")):
        code, found = asked("prove", ODD, options, tmp_path)
        assert code == 2
        assert "does not go with" in found["what"]


@pytest.mark.parametrize("name", sorted(set(ASKED) - {"prove", "solve", "limit_stages"}))
def test_an_exception_of_every_analysis_has_a_verdict(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever ends an analysis from within: here the first look at its problem."""

    def broken(*_: object, **__: object) -> None:
        msg = "the matrices are lost"
        raise concio.SolverError(msg)

    text = {"homogenise": CELL, "strength": CELL, "strain_path": CELL, "compare_with_continuum": WALL,
            "assess_bridge": BRIDGE}.get(name, ODD)  # fmt: skip
    model = concio.loads(text)
    more: dict[str, Any] = {}
    if name == "assess":
        from seismic_walls import site

        more["site"] = site()
    if name == "diagnose":
        from concio.analysis.cracks.measurement import Candidate, Measurement

        places = ((-0.2, 1.6), (0.2, 1.6))
        more["measurements"] = [Measurement(f"K{x}", "level", 1e-4, -1e-3, body="pillar", at=(x, y)) for x, y in places]
        more["candidates"] = [Candidate("sinks", body="floor", direction=(0, -1))]
    if name == "run_path":
        more["stages"] = [concio.Stage("dead", {"dead": 1.0})]
    if name == "strain_path":
        more["stages"] = [concio.Stage("press", {"stress yy": -10.0})]
    about = concio.solve(model, on_failure="return") if name == "let_go" else model
    for place in (
        "concio.contact.assembly.Assembly.problem", "concio.contact.reference.Reference.of",
        "concio.analysis.cells.periodic_cell.PeriodicCell.problem",
    ):  # fmt: skip
        monkeypatch.setattr(place, broken)
    with pytest.raises(ConcioError, match="the matrices are lost") as caught:
        getattr(concio, name)(about, **more)
    verdict = caught.value.verdict
    assert verdict is not None
    told = verdict.as_dict()
    assert odd(text) <= set(told["attention"])
    assert told["question"]["asked"] == ASKED[name]
    assert verdict.exit_code == caught.value.exit_code
