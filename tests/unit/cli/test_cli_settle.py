"""``concio settle``: supports move after all loads, and the reactions against them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Literal

import jsonschema
import numpy as np
import pytest

import concio
from commands import run
from concio.cli.progress import Share
from concio.problem.solution import Progress
from samples import first

SQUEEZED = """
title = "an elastic block between two walls, one of which moves in"
[materials.stone]
kind = "elastic"
E = "1 GPa"
nu = 0.0
unit_weight = 20.0
[joints.smooth]
friction = 0.0
[[blocks]]
name = "block"
outline = [[0, 0], [2, 0], [2, 0.5], [0, 0.5]]
material = "stone"
[[blocks]]
name = "ground"
kind = "fixed"
outline = [[-1, -1], [3, -1], [3, 0], [-1, 0]]
[[blocks]]
name = "left"
kind = "fixed"
outline = [[-1, 0], [0, 0], [0, 0.5], [-1, 0.5]]
[[blocks]]
name = "right"
kind = "fixed"
outline = [[2, 0], [3, 0], [3, 0.5], [2, 0.5]]
[[loads]]
kind = "weight"
value = [0, -1]
[[supports]]
name = "moves in"
body = "left"
displacement = ["0.1 mm", 0]
group = "squeeze"
"""
PUSHED = '[[loads]]\nkind = "point"\nvalue = [-{force}, 0]\nbodies = ["block"]\nat = [2.0, 0.25]\ngroup = "live"\n'


@pytest.fixture
def squeezed(tmp_path: Path) -> Path:
    file = tmp_path / "squeezed.toml"
    file.write_text(SQUEEZED, encoding="utf-8")
    return file


@pytest.mark.long
@pytest.mark.parametrize("amount", [1.0, 2.5])
def test_a_wall_that_moves_in_presses_as_a_spring(squeezed: Path, tmp_path: Path, amount: float) -> None:
    """N = E A d / L with E = 1e6 kN/m2, A = 0.5 m2, L = 2 m; the weight of 20 kN goes down, nu = 0."""
    code, out, err = run("settle", squeezed, "--amount", str(amount), "--json", "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    told = json.loads(out)
    jsonschema.validate(told, json.loads(run("schema", "output")[1]))
    force = 1e6 * 0.5 * 1e-4 * amount / 2.0
    for name, sign in (("left", 1.0), ("right", -1.0)):
        assert np.array(told["reactions"][name])[:, 0] == pytest.approx(
            sign * force * np.array(told["share"]), abs=1e-9
        )
    assert np.array(told["reactions"]["ground"])[:, 1] == pytest.approx(20.0)
    assert told["movement"] == {
        "group": "squeeze", "amount": amount, "reached": 1.0,
        "supports": [f"'left' moves by {0.1 * amount:g} mm along x (support 'moves in')"],
    }  # fmt: skip
    rows = (tmp_path / "out" / "reactions.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "support,share,force_x [kN],force_y [kN]"
    last = next(row for row in rows if row.startswith("left,1.0,"))
    assert float(last.split(",")[2]) == pytest.approx(force)
    assert (tmp_path / "out" / "report.html").is_file()


def test_its_text_tells_the_movement_and_the_reactions(squeezed: Path) -> None:
    code, out, _ = run("settle", squeezed)
    assert code == 0
    assert "movement     'left' moves by 0.1 mm along x (support 'moves in')" in out
    assert "reactions    before the movement | at its end" in out
    assert "left         (0 kN along x, 0 kN along y) | (+25 kN along x, 0 kN along y)" in out


def test_its_report_tells_them_too_in_both_languages(squeezed: Path, tmp_path: Path) -> None:
    for language, words in (
        ("en", ("Movement and reactions", "&#x27;left&#x27; moves by 0.25 mm along x", "+62.5 kN along x")),
        ("it", ("Movimento e reazioni", "&#x27;left&#x27; si muove di 0,25 mm lungo x", "+62,5 kN lungo x")),
    ):
        place = tmp_path / language
        assert run("settle", squeezed, "--amount", "2.5", "--out", place, "--language", language, "--quiet")[0] == 0
        page = (place / "report.html").read_text(encoding="utf-8").replace("'", "&#x27;")
        assert all(word in page for word in words)
        assert "0 iterations, 0 s" not in page


def test_movements_that_fall_end_before_their_whole(tmp_path: Path) -> None:
    """A block of 1 x 2 m on a floor that turns tips where the turn reaches b / h: 0.5."""
    tower = concio.column(width=1.0, height=2.0, blocks=1, block="rigid", unit_weight=20.0, friction=2.0)
    concio.save(tower, tmp_path / "tower.toml")
    text = (tmp_path / "tower.toml").read_text(encoding="utf-8")
    ground = next(b.name for b in tower.bodies if b.kind == "fixed")
    more = f'\n[[supports]]\nname = "turns"\nbody = "{ground}"\nrotation = 0.2\n'
    (tmp_path / "tower.toml").write_text(text + more, encoding="utf-8")
    code, out, _ = run("settle", tmp_path / "tower.toml", "--json")
    told = json.loads(out)
    assert code == {"holds": 0, "fails": 3}.get(told["verdict"]["outcome"], 4)
    assert told["movement"]["supports"][0].startswith(f"'{ground}' moves by 200 mrad about z")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--group", "dead"), "no support is moved by the load group 'dead'"),
        (("--group", "none"), "groups that move supports: squeeze"),
        (("--amount", "0"), "multiplied by 0"),
        (("--amount", "nan"), "multiplied by nan"),
        (("--amount", "much"), "'--amount'"),
    ],
)
def test_what_cannot_be_asked_is_told_in_one_message(squeezed: Path, arguments: tuple[str, ...], said: str) -> None:
    code, out, err = run("settle", squeezed, *arguments)
    assert (code, out) == (2, "")
    assert said in err
    assert "Traceback" not in err


def test_a_model_without_a_movement_says_what_to_state(tmp_path: Path) -> None:
    (tmp_path / "still.toml").write_text(SQUEEZED.replace('displacement = ["0.1 mm", 0]', ""), encoding="utf-8")
    code, _, err = run("settle", tmp_path / "still.toml")
    assert code == 2
    assert "give a [[supports]] entry a displacement or a rotation" in err


@pytest.mark.long
def test_loads_that_are_not_carried_leave_no_movement(tmp_path: Path) -> None:
    lifts = '[[loads]]\nkind = "point"\nvalue = [0, 30]\nbodies = ["block"]\nat = [1, 0.5]\ngroup = "live"\n'
    text = SQUEEZED.replace("[[supports]]", lifts + "[[supports]]")
    (tmp_path / "lifted.toml").write_text(text, encoding="utf-8")
    code, out, _ = run("settle", tmp_path / "lifted.toml", "--json")
    told = json.loads(out)
    assert code in (3, 4)
    assert told["verdict"]["outcome"] != "holds"
    assert told["share"] == [0.0]
    assert told["movement"]["reached"] == 0.0


@pytest.mark.parametrize("method", first(1, ["events", "steps"]))
def test_a_path_reports_the_share_of_all_its_stages(method: Literal["events", "steps"]) -> None:
    """The share grows from the first stage to the end of the last: from it follows the time that is left."""
    arch = concio.arch(span=4.0, ring=0.35, voussoirs=15, shape="segmental", rise=1.2, friction=0.7,
                       block=concio.Elastic(E="5 GPa", nu=0.2, unit_weight=25.0))  # fmt: skip
    spread = concio.Support("spread", "right abutment", displacement=(0.002, 0.0))
    told: list[Progress] = []
    found = concio.settle(replace(arch, supports=(spread,)), method=method, progress=told.append)
    assert found.reached
    done = [1.0 - note.residual for note in told]
    assert done == sorted(done)
    assert done[0] < 0.6
    assert {note.method for note in told} == {"path"}
    assert 0.9 < done[-1] <= 1.0
    share = Share()
    for note in told:
        share.after(note)
    assert share.best == pytest.approx(done[-1])


@pytest.mark.parametrize("carried", [True, False])
def test_where_no_load_acts_nothing_is_carried(tmp_path: Path, carried: bool) -> None:
    """The headline was 'The loads are carried' for blocks without weight between walls that only move."""
    weight = '[[loads]]\nkind = "weight"\nvalue = [0, -1]\n'
    assert weight in SQUEEZED
    file = tmp_path / "model.toml"
    file.write_text(SQUEEZED if carried else SQUEEZED.replace(weight, ""), encoding="utf-8")
    verdict = concio.settle(concio.load(file), "squeeze").verdict
    assert ("carried" in verdict.headline) == ("carried" in verdict.answer) == carried
    assert ("No load acts" in verdict.headline) == (not carried)
