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
    "a decimal comma": ("[joints.j]\nfriction = 0,6", "decimals are set off by a point"),
    "a decimal comma in a text": ("[joints.j]\nfriction = '0,6'", "decimals are set off by a point"),
    "a comma first": ("[joints.j]\nfriction = ',6'", "decimals are set off by a point"),
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
    "decimal commas": ("b.csv", 'name,outline\na,"0,5 0; 1 0; 1 1"\n', "decimals are set off by a point"),
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
        with pytest.raises(InputError, match="no angle of friction"):
            concio.JointLaw(bad)
    with pytest.raises(InputError, match="must be a plain number"):
        concio.Elastic(E=1e6, nu="31 deg")
    with pytest.raises(InputError, match="kg, g and t are masses"):
        concio.Elastic(E="100 kg/cm2")


def test_a_turned_support_in_degrees() -> None:
    text = "[column]\nwidth = 1\nheight = 1\nblocks = 1\n"
    text += "[[supports]]\nname = 's'\nbody = 'ground'\nrotation = '2 deg'\n"
    assert concio.loads(text).supports[0].rotation == pytest.approx(np.deg2rad(2))
