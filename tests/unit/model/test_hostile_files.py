"""Files made to break a reader: each is one message that says what and where, at once."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.errors import InputError
from concio.files import guarded, read_text, unguarded
from concio.io.csv_table import write_csv
from concio.model.file.block_table import read_blocks, write_blocks
from concio.model.model import Body
from models import box

PANEL = "[panel]\n"
TEXTS = {
    "a whole number of 5,000 digits": (f"[panel]\ncourses = {'9' * 5000}", "a whole number has too many digits"),
    "one in base sixteen": (f"[panel]\ncourses = 0x{'f' * 5000}", "[panel], courses: the whole number is too large"),
    "one as a length": (f"[panel]\njoint = {10**30}", "[panel], joint: the whole number is too large"),
    "a dotted key of 5,000 parts": (".".join("a" * 5000) + " = 1", "nested more than 40 deep"),
    "a table of 5,000 parts": (f"[{'.'.join('a' * 5000)}]\nx = 1", "nested more than 40 deep"),
    "brackets": (f"x = {'[' * 5000}{']' * 5000}", "nested too deeply"),
    "inline tables": ("x = " + "{a = " * 60 + "1" + "}" * 60, "nested more than 40 deep"),
    "a decimal comma": ("[joints.j]\nfriction = 0,6", "the decimal separator is a point"),
    "a decimal comma in a text": ("[joints.j]\nfriction = '0,6'", "the decimal separator is a point"),
    "a comma first": ("[joints.j]\nfriction = ',6'", "the decimal separator is a point"),
    "a text of a million letters": (f"[panel]\njoint = '{'x' * 1_000_000}'", "is not a number with a unit"),
    "a number beyond all numbers": ("[panel]\njoint = 1e400", "not finite"),
    "a text beyond all numbers": ("[panel]\njoint = '1e400 m'", "is not a finite number"),
}


@pytest.mark.parametrize("case", TEXTS)
def test_hostile_texts(tmp_path: Path, case: str) -> None:
    text, said = TEXTS[case]
    with pytest.raises(InputError) as caught:
        concio.loads(text, name="f.toml")
    assert said in str(caught.value)
    assert len(str(caught.value)) < 400
    (tmp_path / "f.toml").write_text(text)
    code, out, err = run("check", tmp_path / "f.toml", "--json")
    assert (code, json.loads(out)["exit_code"]) == (2, 2)
    assert len(err) < 600


TABLES = {
    "a cell of 131,073 letters": ("b.csv", f"name,outline\n{'x' * 131_073},0 0\n", "field larger than field limit"),
    "a column twice": ("b.csv", "name,outline,name\na,0 0; 1 0; 1 1,b\n", "column 'name' twice"),
    "semicolons": ("b.csv", "name;outline\na;0 0\n", "columns are separated by commas"),
    "decimal commas": ("b.csv", 'name,outline\na,"0,5 0; 1 0; 1 1"\n', "the decimal separator is a point"),
    "brackets": ("b.json", "[" * 100_000, "nested too deeply"),
    "digits": ("b.json", "[" + "9" * 5000 + "]", "too many digits"),
    "a large whole number": ("b.json", f'[{{"name": "a", "outline": [[{10**400}, 0], [1, 0], [1, 1]]}}]', "vertices"),
    "a deep outline": ("b.json", '[{"name": "a", "outline": ' + "[" * 400 + "]" * 400 + "}]", "vertices"),
    "no number": ("b.json", '[{"name": "a", "outline": [[NaN, 0], [1, 0], [1, 1]]}]', "missing or not finite"),
}  # fmt: skip


@pytest.mark.parametrize("case", TABLES)
def test_hostile_tables(tmp_path: Path, case: str) -> None:
    name, text, said = TABLES[case]
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=said):
        read_blocks(tmp_path / name)


NO_FILES = ["/dev/zero", "/dev/null", "pipe", "folder", "/dev/zero.csv", "link.csv", "link.dxf", "\\u0000"]


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device")
@pytest.mark.parametrize("name", NO_FILES)
def test_what_is_no_file_is_refused_at_once(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    for link in ("link.csv", "link.dxf"):
        (tmp_path / link).symlink_to("/dev/zero")
    (tmp_path / "f.toml").write_text(f'blocks_file = "{name}"\n[joints.j]\nfriction = 1\n')
    code, _, err = run("check", tmp_path / "f.toml")
    assert code == 2
    assert re.search(r"device or a pipe|directory|no such file|cannot be read|ends in \.json or \.csv", err)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device")
def test_a_model_may_come_through_a_pipe_but_not_from_a_device(tmp_path: Path) -> None:
    assert run("check", "/dev/zero")[0] == 2
    reader, writer = os.pipe()
    os.write(writer, b"[panel]\ncourses = 1\n")
    os.close(writer)
    assert read_text(Path(f"/dev/fd/{reader}"), pipes=True).startswith("[panel]")
    os.close(reader)


FORMULAS = ["=1+1", "+1", "-1", "@SUM(A1)", "\tx", "'=x", "''=x", "=cmd|' /C calc'!A0"]


@pytest.mark.parametrize("name", FORMULAS)
def test_names_never_become_formulas_and_read_back(tmp_path: Path, name: str) -> None:
    assert guarded(name).startswith("'")
    assert unguarded(guarded(name)) == name
    write_csv({"body": np.array([name, "plain"]), "x": np.array([-1.5, 2.0])}, tmp_path / "t.csv")
    lines = (tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()
    assert lines[1].lstrip('"').startswith("'")
    assert lines[1].endswith(",-1.5")  # numbers stay numbers
    assert lines[2] == "plain,2.0"
    body = Body(name, box("x", 0, 1, 0, 1).outline, layer=name)
    write_blocks(tmp_path / "b.csv", [body])
    (again,) = read_blocks(tmp_path / "b.csv")
    assert (again.name, again.layer) == (name, name)


@pytest.mark.parametrize("name", ["plain", "'plain'", "a=b", "1", ""])
def test_other_texts_stay_as_they_are(name: str) -> None:
    assert guarded(name) == unguarded(name) == name


def test_no_name_ends_the_data_of_a_report(tmp_path: Path) -> None:
    from concio.report.page import report_html

    name = "<!--<script>alert(1)</script>"
    model = concio.Model(
        (box("ground", -1, 2, -1, 0, kind="fixed"), box(name, 0, 1, 0, 1)),
        {"block": concio.Elastic(E=1e6, unit_weight=20.0)}, {"joint": concio.JointLaw(0.5)},
        loads=(concio.Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
    page = report_html(concio.solve(model), figures=False)
    (data,) = re.findall(r'<script[^>]*id="?data"?[^>]*>(.*?)</script>', page, re.DOTALL)
    assert "<" not in data
    assert json.loads(data)["bodies"]["name"][1] == name
    assert "<!--" not in page.replace(data, "")


def test_friction_as_an_angle_and_weights_as_masses() -> None:
    text = PANEL + "courses = 1\n[panel.friction]\nfriction = '31 deg'\ndilatancy = '5°'\n"
    (law,) = {name: law for name, law in concio.loads(text).laws.items() if name == "joint"}.values()
    assert law.friction == pytest.approx(np.tan(np.deg2rad(31)), rel=1e-14)
    assert law.dilatancy == pytest.approx(np.tan(np.deg2rad(5)), rel=1e-14)
    short = concio.loads("[column]\nwidth = 1\nheight = 1\nblocks = 1\nfriction = '31 deg'\nbase_friction = '0.5 rad'")
    assert short.laws["joint"].friction == law.friction
    assert short.laws["base"].friction == pytest.approx(np.tan(0.5), rel=1e-14)
    stone = concio.Elastic(E=1e6, unit_weight="2100 kg/m3")
    assert stone.unit_weight == pytest.approx(2.1 * 9.80665, rel=1e-14)
    assert concio.Rigid("2.1 t/m3").unit_weight == stone.unit_weight
    for bad in ("90 deg", "-5 deg", "120 deg"):
        with pytest.raises(InputError, match="not an angle of friction"):
            concio.JointLaw(bad)
    with pytest.raises(InputError, match="must be a plain number"):
        concio.Elastic(E=1e6, nu="31 deg")
    with pytest.raises(InputError, match="kg, g and t are masses"):
        concio.Elastic(E="100 kg/cm2")


def test_a_turned_support_in_degrees() -> None:
    text = "[column]\nwidth = 1\nheight = 1\nblocks = 1\n"
    text += "[[supports]]\nname = 's'\nbody = 'ground'\nrotation = '2 deg'\n"
    assert concio.loads(text).supports[0].rotation == pytest.approx(np.deg2rad(2))


HUGE = 1_000_000_000
COUNTS = {
    "voussoirs": f"[arch]\nspan = 2\nring = 0.3\nvoussoirs = {HUGE}",
    "blocks of a column": f"[column]\nwidth = 1\nheight = 2\nblocks = {HUGE}",
    "courses of a buttress": f"[buttress]\nbase = 2\ntop = 1\nheight = 4\ncourses = {HUGE}",
    "blocks of a course": "[buttress]\nbase = 2\ntop = 1\nheight = 4\ncourses = 2\nblock_length = 1e-9",
    "courses of a panel": f"[panel]\ncourses = {HUGE}",
    "blocks of a panel": f"[panel]\nblocks = {HUGE}",
    "elements of a block": "[panel]\nelements_per_block = [100000, 100000]",
    "elements along a block": f"[panel]\nelements_per_block = [{HUGE}, 1]",
    "elements of many blocks": "[panel]\ncourses = 100\nblocks = 100\nelements_per_block = [100, 100]",
    "refinement of a panel": "[panel]\nrefinement = 900",
    "refinement": f"[wall]\nlength = 1\nheight = 1\nrefinement = {HUGE}",
    "refinement of the analysis": f"[wall]\nlength = 1\nheight = 1\n[analysis]\nrefinement = {HUGE}",
    "elements": "[wall]\nlength = 1\nheight = 1\nmesh_size = 1e-7",
    "elements along a film": "[column]\nwidth = 1e5\nheight = 1e-3\nblocks = 1\nmesh_size = 1e-3",
    "blocks of a wall": "[wall]\nlength = 1e6\nheight = 1e6",
    "pieces of a bond": "[wall]\nlength = 1\nheight = 1\nbond = [[1e-30]]",
    "heights of a bond": "[wall]\nlength = 1\nheight = 1\nbond = [{ unit = [1], height = 1e-30 }]",
    "small pieces of a bond": "[wall]\nlength = 1e4\nheight = 100\nbond = [[0.01]]",
    "stones": "[rubble]\nlength = 1e6\nheight = 1e6\nstone = 1e-6",
    "rounds of evening out": f"[rubble]\nlength = 1\nheight = 1\nstone = 0.3\nevenness = {HUGE}",
    "a seed": f"[rubble]\nlength = 1\nheight = 1\nstone = 0.3\nseed = {10**30}",
    "chords": "[arch]\nspan = 20\nring = 0.3\nvoussoirs = 2\nchord_tolerance = 1e-9",
    "steps": f"[panel]\n[[stages]]\nname = 's'\nfactors = {{ dead = 1 }}\nsteps = {HUGE}",
}  # fmt: skip


@pytest.mark.parametrize("case", COUNTS)
def test_numbers_beyond_all_use_are_refused_at_once(tmp_path: Path, case: str) -> None:
    (tmp_path / "f.toml").write_text(COUNTS[case] + "\n")
    code, _, err = run("check", tmp_path / "f.toml")
    assert code == 2, err
    assert re.search(r"more than|too many|must lie between|whole number", err), err


def test_counts_in_python_are_bounded_too() -> None:
    for call in (
        lambda: concio.column(width=1, height=1, blocks=10**40),
        lambda: concio.rubble(length=1e308, height=1e308, stone=1e-308),
        lambda: concio.Stage("s", {}, steps=0),
        lambda: concio.Stage("s", {}, steps=2.5),  # type: ignore[arg-type]
    ):
        with pytest.raises(InputError, match=r"more than|whole number|no structure has"):
            call()


@pytest.mark.parametrize(("name", "key"), [("wall.dxf", "blocks_file"), ("VAULT.OBJ", "solids_file")])
def test_a_drawing_given_as_a_model_file_is_told_where_to_go(tmp_path, name, key):
    drawing = tmp_path / name
    drawing.write_text("0\nSECTION\n")
    with pytest.raises(InputError, match="not a model file") as told:
        concio.load(drawing)
    assert f"{key} = '{name}'" in str(told.value)
    table = tmp_path / "model.toml"
    table.write_text("blocks_file = 'vault.obj'\n")
    (tmp_path / "vault.obj").write_text("v 0 0 0\n")
    with pytest.raises(InputError, match="solids_file = "):
        concio.load(table)


@pytest.mark.parametrize("options", [{"workers": 0}, {"workers": -2}, {"executor": "procesess"}, {"executor": 3}])
def test_a_study_that_cannot_run_leaves_no_directory(tmp_path, options):
    """The next study into that place would have been reported that there is one already."""
    place = tmp_path / "study"
    mu = concio.variable("mu", "uniform", keys="arch.friction", low=0.3, high=0.7)
    with pytest.raises(InputError):
        concio.study({"arch": {"span": 2.0}}, [mu], "stands", size=2, directory=place, **options)
    assert not place.exists()
