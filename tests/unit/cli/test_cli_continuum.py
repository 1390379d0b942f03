"""``concio continuum`` and its figures: what is printed, written and drawn, and what is refused."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest

import concio
from commands import run
from concio.cli.halved import halved_file
from concio.verdict.continuum_verdict import continuum_strength_words

WALL = """
title = "pushed wall"
[wall]
length = 1.6
height = 1.05
block_size = ["80 cm", 0.35]
block = { E = "1 GPa", nu = 0.2, unit_weight = "20 kN/m3" }
friction = { friction = 0.65, normal_stiffness = "3e5 kN/m3", tangential_stiffness = 1.2e5 }
horizontal = 0.2
"""


@pytest.fixture
def wall(tmp_path, monkeypatch):
    """A wall in a directory of its own, which is the working directory."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wall.toml").write_text(WALL)
    return "wall.toml"


@pytest.mark.long
def test_blocks_and_continuum_are_printed_and_drawn_side_by_side(wall, tmp_path):
    code, out, _ = run("continuum", wall, "--halve", "1", "--out", "twin", "--mesh-size", "40 cm")
    assert code == 0
    assert "limit load" in out
    assert "(proven)" in out
    assert "1/2" in out
    names = {p.name for p in (tmp_path / "twin").iterdir()}
    figures = ("displacement", "stress_yy", "stress_xx", "stress_xy", "mechanism", "halving_limit",
               "halving_displacement")
    assert {f"{name}.{form}" for name in figures for form in ("png", "svg")} < names
    assert {"summary.json", "blocks.csv", "halving.csv"} < names
    told = json.loads((tmp_path / "twin" / "summary.json").read_text())
    assert told["strength"]["continuum_at_least"] <= told["strength"]["continuum_at_most"]
    assert told["halving"]["times_smaller"] == [1, 2]


@pytest.mark.long
def test_json_holds_what_is_said_and_python_says_the_same(wall):
    code, out, err = run("continuum", wall, "--json", "--no-elastic", "--group", "live", "--mesh-size", "40 cm")
    assert (code, err) == (0, "")
    told = json.loads(out)
    found = concio.compare_with_continuum(concio.load(wall), elastic=False, mesh_size=0.4).summary()
    assert told["strength"] == found["strength"]
    assert told["elastic"] is None


def test_halved_files_have_the_same_outline_and_the_same_cell(wall, tmp_path):
    make = halved_file(tmp_path / wall)
    first, third = make(1), make(3)
    assert len(third.free_bodies) > 6 * len(first.free_bodies)
    for model in (first, third):
        points = np.vstack([b.outline for b in model.free_bodies])
        assert points.min(0) == pytest.approx([0, 0])
        assert points.max(0) == pytest.approx([1.6, 1.05])
    assert third.laws["joint"].normal_stiffness == pytest.approx(9e5)
    assert third.laws["joint"].tangential_stiffness == pytest.approx(3.6e5)
    text = '[panel]\ncourses = 2\nblocks = 3\njoint = "20 mm"\nblock_size = ["0.2 m", 0.1]'
    (tmp_path / "panel.toml").write_text(text)
    panel = halved_file(tmp_path / "panel.toml")(2)
    assert panel.generator["joint"] == pytest.approx(0.01)
    assert panel.generator["courses"] == 4


@pytest.mark.long  # the numbers are looked at without figures
def test_figures_show_blocks_and_continuum_at_one_scale(wall):
    found = concio.compare_with_continuum(concio.load(wall), factors={"live": 0.5}, mesh_size=0.4)
    left, middle, right = found.plot.displacement(scale=100.0)
    assert left.get_xlim() == middle.get_xlim() == right.get_xlim()
    triangles = right.collections[1].get_paths()
    moved = np.array([p.vertices[:3] for p in triangles])
    at = found.wall.points + 100.0 * found.elastic.continuum.displacement
    assert moved == pytest.approx(at[found.wall.triangles], abs=1e-9)
    assert "Homogenised" in right.get_title(loc="left")
    assert len(left.texts) == 1, "one note, that of the comparison"
    panels = found.plot.stress(component="xy")
    assert len(panels) == 3
    again = found.plot.mechanism(axes=found.plot.mechanism())
    assert len(again) == 2
    with pytest.raises(concio.InputError, match="axes are 1"):
        found.plot.mechanism(axes=[left])
    with pytest.raises(concio.InputError, match="no component"):
        found.plot.stress(component="zz")
    rigid = concio.compare_with_continuum(
        concio.wall(length=1.6, height=1.05, block_size=(0.8, 0.35), block="rigid", horizontal=0.2), strength=False
    )
    assert "no moduli" in rigid.elastic_note
    with pytest.raises(concio.InputError, match="no moduli"):
        rigid.plot.displacement()
    with pytest.raises(concio.InputError, match="not asked for"):
        rigid.plot.mechanism()


def test_limit_loads_say_that_factors_are_not_theirs_and_proofs_name_what_there_is(wall):
    """Loads times 2 stood in the question of limit loads that had them once; no stresses were "in balance inf"."""
    found = concio.compare_with_continuum(concio.load(wall), factors={"dead": 1.5}, mesh_size=0.8)
    assert any("factors of the elastic answers alone: 'dead' 1.5" in line for line in found.verdict.limits)
    assert "from below" in found.verdict.proof
    none = replace(found.strength.static, multiplier=np.nan, residual=np.inf)
    without = replace(found, strength=replace(found.strength, static=none)).verdict
    assert "inf" not in without.proof
    assert "from above" in without.proof
    exact = replace(found.strength.static, multiplier=-0.0)
    words = continuum_strength_words(replace(found.strength, static=exact))
    assert "carries 0 " in words[1]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("wall.toml", "--halve", "9"), "between 0 and 6"),
        (("wall.toml", "--halve", "1", "--factor", "live=0.5"), "--factor does not go"),
        (("wall.toml", "--no-elastic", "--no-strength"), "neither elastic answers nor limit loads"),
        (("wall.toml", "--no-elastic", "--factor", "live=2"), "load factors are those of the elastic comparison"),
        (("wall.toml", "--mesh-size", "wide"), "wide"),
        (("wall.toml", "--group", "wind"), "no load group 'wind'"),
        (("wall.toml", "--cell", "wall.toml"), "no periods"),
        (("arch.toml", "--halve", "1"), "[wall] or a [panel]"),
        (("arch.toml",), "cell that this wall repeats is not known"),
    ],
)
def test_bad_input_is_answered_in_a_sentence(wall, tmp_path, arguments, words):
    (tmp_path / "arch.toml").write_text('[arch]\nspan = 2.0\nring = 0.3\nvoussoirs = 7\nblock = "rigid"')
    code, out, err = run("continuum", *arguments, "--out", "there")
    assert code == 2
    assert out == ""
    assert words in err
    assert "Traceback" not in err
    assert not (tmp_path / "there").exists()


def test_all_numbers_have_the_units_that_are_asked_for(wall):
    """Forces in N and settlements in cm are those in kN and mm times 1000 and over 10, halved blocks as well."""
    told = {}
    for units in ("kN, mm", "N, motion = cm"):
        code, out, _ = run("continuum", wall, "--halve", "1", "--no-strength", "--mesh-size", "40 cm", "--units", units)
        assert code == 0
        told[units] = out
    first, other = told.values()
    assert "kN" not in other.replace("kN/m", "")
    assert "mm" not in other
    settled = [float(re.search(r"continuum (\S+) [mc]m;", text)[1]) for text in told.values()]
    assert settled[1] == pytest.approx(settled[0] / 10, rel=1e-4)
    pushed = [float(re.search(r"continuum \((\S+) k?N along x", text)[1].replace(",", "")) for text in told.values()]
    assert pushed[1] == pytest.approx(1e3 * pushed[0], rel=1e-3)
    rows = [re.search(r"1/2 +\d+ +(\S+)", text)[1] for text in told.values()]
    assert float(rows[1]) == pytest.approx(float(rows[0]) / 10, rel=1e-4)
    assert "settle [mm]" in first
    assert "settle [cm]" in other
