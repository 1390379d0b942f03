"""Several kinds of oddities at once, the default thickness and ignored layers are told in the JSON of every command."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import pytest
from test_attention_everywhere import ASKS, SITE, STUDY, SURVEY, asked

import concio
from commands import run
from concio.contact.detection import detect
from concio.verdict.attention import attention_of
from pillars import pillar, point, sideways
from samples import first

ODD = (
    pillar(sideways(0.02)).replace("20 kN/m3", "100 kN/m3")
    + point(0.0, -0.1, (0.0, 9.0), "dead")
    + '[[loads]]\nkind = "weight"\nvalue = [0.0, -1.0]\ngroup = "dead"\n'
    + '[[rules]]\nbetween = ["pillar", "floor"]\nlaw = "dry"\n[[rules]]\nbetween = ["*", "*"]\nlaw = "dry"\n'
)
ODDITIES = ("more than that of steel", "outside 'pillar'", "weight", "decides no joint")
"""What is said of its unit weight, of the place of a load, of weight that acts twice, and of an idle rule."""
CELL = "[cell]\nblock_size = [0.4, 0.2]\nfriction = 0.6\nunit_weight = 100.0\nthickness = 30.0\n"
WALL = (
    "[wall]\nlength = 0.8\nheight = 0.4\nblock_size = [0.4, 0.2]\nfriction = 0.6\nhorizontal = 0.01\n"
    "unit_weight = 100.0\nthickness = 30.0\n"
)
BRIDGE = (
    "[bridge]\nspan = 3.0\nrise = 0.75\nring = 1.6\nvoussoirs = 8\nwidth = 2.0\nblock = 'rigid'\nfriction = 0.6\n"
    "unit_weight = 100.0\n[fill]\ncover = 0.3\n[vehicle]\naxles = [[0.0, 5000.0]]\nposition = 1.0\n"
)
OWN = {"cell": CELL, "continuum": WALL, "bridge": BRIDGE, "assess": ODD + SITE, "study": ODD + STUDY,
       "settle": ODD + '[[supports]]\nname = "sinks"\nbody = "floor"\ndisplacement = [0.0, -0.001]\n',
       "diagnose": SURVEY.replace("friction = 3.0 # ", "thickness = 30.0\nfriction = ")
       .replace("22 kN/m3", "100 kN/m3")}  # fmt: skip
"""Files of commands that need more than a pillar, or a model of their own kind."""


def odd(text: str) -> tuple[str, ...]:
    model = concio.loads(text)
    return attention_of(model, detect(model))


def text_of(command: str) -> str:
    return OWN.get(command, ODD)


@pytest.mark.parametrize("command", ASKS)
def test_several_kinds_of_oddities_stand_in_the_json_of_every_command(command: str, tmp_path: Path) -> None:
    text = text_of(command)
    found = odd(text)
    assert len(found) >= 2, found
    if text.startswith(ODD):
        assert all(any(word in line for line in found) for word in ODDITIES)
    code, told = asked(command, text, ASKS[command][1], tmp_path)
    assert code in (0, 3, 4), told
    assert set(found) <= set(told["attention"])


DEFAULT = pillar(sideways(0.2))
GIVEN = DEFAULT.replace('kind = "rigid"\nmaterial', 'kind = "rigid"\nthickness = 0.8\nmaterial')
IN_PLANE = [c for c in ASKS if c not in ("check", "cell", "continuum", "bridge", "diagnose", "settle")]
"""Commands that are asked about a pillar."""


@pytest.mark.parametrize("command", first(2, IN_PLANE))
def test_a_thickness_that_nobody_gave_is_told_with_the_question(command: str, tmp_path: Path) -> None:
    more = {"assess": SITE, "study": STUDY}.get(command, "")
    for text, said in ((DEFAULT, "thickness 1 m, the default where none is given"), (GIVEN, "thickness 0.8 m")):
        path = tmp_path / f"{len(said)}.toml"
        path.write_text(text + more)
        told = json.loads(run(command, path, *ASKS[command][1], "--json")[1])["verdict"]
        assert said in json.dumps(told["question"])
        assert ("the default" in json.dumps(told["question"])) == (text is DEFAULT)


def drawn(tmp_path: Path) -> str:
    """Return a file of a pillar in a drawing with a dimension line on a layer that is ignored."""
    sheet = ezdxf.new(units=6)
    for layer, (x0, y0, x1, y1) in (("stone", (-0.2, 0.0, 0.2, 1.6)), ("CONCIO_FIXED", (-3.0, -0.5, 3.0, 0.0))):
        ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        sheet.modelspace().add_lwpolyline(ring, close=True, dxfattribs={"layer": layer})
    sheet.modelspace().add_line((0.5, 0.0), (0.5, 1.6), dxfattribs={"layer": "QUOTE 2"})
    sheet.saveas(tmp_path / "pillar.dxf")
    return (
        "blocks_file = 'pillar.dxf'\n[drawing.layers]\n'QUOTE*' = 'ignore'\n"
        "[materials.stone]\nkind = 'rigid'\nunit_weight = 20\n[joints.dry]\nfriction = 0.7\n"
        + sideways(0.2)
    )


@pytest.mark.parametrize("command", first(2, IN_PLANE))
def test_layers_that_were_ignored_are_told(command: str, tmp_path: Path) -> None:
    more = {"assess": SITE, "study": STUDY.replace("loads[2]", "loads[1]")}.get(command, "")
    path = tmp_path / "model.toml"
    path.write_text(drawn(tmp_path) + more)
    code, out, err = run(command, path, *ASKS[command][1], "--json")
    assert code in (0, 3, 4), err
    told: dict[str, Any] = json.loads(out)
    line = "the drawing: 1 thing left out, first: 1 LINE on layer 'QUOTE 2', which is ignored"
    assert line in told["attention"]


SINKS = DEFAULT + '[[supports]]\nname = "sinks"\nbody = "floor"\ndisplacement = [0.0, -0.001]\n'
STAGES = """
[[stages]]
name = "by itself"
factors = { dead = 1.0 }
[[stages]]
name = "lean"
factors = { live = 0.5 }
"""
ONCE = [c for c in IN_PLANE if c != "path"]
"""Commands that apply loads at once, or multiply them."""


@pytest.mark.parametrize("command", first(3, ONCE))
def test_stages_that_are_not_followed_are_told_with_the_question(command: str, tmp_path: Path) -> None:
    """A file whose stages put on half of a load was answered with all of it, without a word on the stages."""
    path = tmp_path / "staged.toml"
    path.write_text(DEFAULT + STAGES + {"assess": SITE, "study": STUDY}.get(command, ""))
    told = json.loads(run(command, path, *ASKS[command][1], "--json")[1])["verdict"]
    assert "stages of the model are not followed" in json.dumps(told["question"])
    assert "'by itself', 'lean'" in json.dumps(told["question"])


def test_stages_that_are_followed_are_those_of_the_question() -> None:
    """Other stages are told; a state of a path is called that, and not one step from rest."""
    model = concio.loads(DEFAULT + STAGES)
    path, other = concio.run_path(model), concio.run_path(model, [concio.Stage("all", {"dead": 1.0, "live": 1.0})])
    point = concio.ControlPoint("pillar", model.body("pillar").outline[2])
    controlled = [replace(one, steps=7) for one in model.stages[:-1]]
    controlled.append(replace(model.stages[-1], control=point, until=1e-3))
    moved = concio.run_path(model, controlled)
    known = [" ".join(found.verdict.question.assumptions) for found in (path, other, moved)]
    assert ["not followed" in text for text in known] == [False, True, False]
    state = path.result().verdict.question
    assert "a state of a load path" in state.asked
    assert "not followed" not in " ".join(state.assumptions)
    settled = concio.settle(concio.loads(SINKS + STAGES))
    assert "not followed" in " ".join(settled.verdict.question.assumptions)
