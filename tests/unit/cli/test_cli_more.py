"""Commands beyond one load step: limit, path, export."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.path import ControlPoint, Stage, run_path
from concio.cli.path_lines import path_lines
from concio.post.result_tables import GIVEN

TOPPLES = """
[column]
width = 0.2
height = 1.0
blocks = 1
block = { E = "1 GPa", unit_weight = 20 }
friction = 0.9
horizontal = 1.0
mesh_size = 0.1
"""


@pytest.fixture
def slender(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A block 0.2 m wide and 1 m high, in a directory of its own."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "slender.toml"
    path.write_text(TOPPLES)
    return path


def test_limit_of_a_slender_block(slender: Path) -> None:
    code, out, err = run("limit", slender, "--json", "--friction")
    assert (code, err) == (0, "")
    data = json.loads(out)
    assert data["checked"] is True
    assert data["associated_multiplier"] == pytest.approx(0.2, rel=1e-8)  # it topples at b/h
    assert data["coulomb_path_multiplier"] == pytest.approx(0.2, rel=1e-6)


@pytest.mark.long
def test_limit_draws_its_mechanisms(slender: Path, tmp_path: Path) -> None:
    """Numbers and a figure of each motion go to --out, and JSON holds nothing that JSON cannot say."""
    place = tmp_path / "limit"
    code, out, err = run("limit", slender, "--out", place)
    assert code == 0, err
    told = json.loads((place / "summary.json").read_text())
    assert told["friction_factor"] is None, "it topples: no friction decides"
    assert {"associated_mechanism.png", "collapse_state.svg"} <= {p.name for p in place.iterdir()}
    assert "associated bound     0.2 times 'live': no equilibrium beyond it" in out
    assert "Coulomb load path" in out
    assert "friction" in out
    assert "written" in out
    code, out, _ = run("limit", slender, "--no-friction", "--no-path")
    assert "friction  " not in out


def test_limit_without_a_limit_or_a_load(tmp_path: Path) -> None:
    path = tmp_path / "c.toml"
    path.write_text("[column]\nwidth=0.5\nheight=1\nblocks=2\ntop_force=10\n")
    code, out, _ = run("limit", path, "--group", "top")
    assert code == 0
    assert "associated bound     locked" in out
    code, out, _ = run("limit", path, "--group", "top", "--json")
    assert json.loads(out)["associated_multiplier"] is None
    code, _, err = run("limit", path)
    assert code == 2
    assert "there is no load group 'live'" in err


@pytest.mark.long
def test_path_names_events_and_ends_where_the_block_topples(slender: Path) -> None:
    stages = ("--stage", "dead=1", "--stage", "live=1", "--point", "b01,-0.1,1.0")
    code, out, err = run("path", slender, *stages, "--json")
    assert err == ""
    data = json.loads(out)
    assert data["stages"][0]["outcome"] == "reached"
    assert data["stages"][1]["peak"] == pytest.approx(0.2, rel=1e-6)
    assert code == 3
    assert data["status"] in ("limit", "mechanism")
    assert {e["kind"] for e in data["events"]} >= {"opens"}
    assert all(set(e["bodies"]) == {"ground", "b01"} for e in data["events"])
    assert data["certificate"]["worst"] < 1e-9
    same = run_path(concio.load(slender), [Stage("a", {"dead": 1.0}), Stage("b", {"live": 1.0})])
    curve = same.curve(ControlPoint("b01", (-0.1, 1.0)))
    assert np.allclose(data["curve"]["displacement"], curve[0], rtol=1e-9, atol=1e-15)
    said = "\n".join(path_lines(same, ControlPoint("b01", (-0.1, 1.0)), every=False))
    assert "ground | b01 opens" in said or "b01 | ground opens" in said


@pytest.mark.usefixtures("blank_figures")
def test_path_writes_curve_events_and_the_last_state(slender: Path) -> None:
    code, _, err = run("path", slender, "-s", "dead=1", "-s", "live=0.1", "--out", "p")
    assert (code, err) == (0, "")
    place = slender.parent / "p"
    assert {p.name for p in place.iterdir()} == {
        "summary.json", "path.csv", "events.csv", "path.png", "path.svg", "report.html", "end", "concio.json",
    }  # fmt: skip
    rows = list(csv.reader((place / "path.csv").read_text().splitlines()))
    data = json.loads((place / "summary.json").read_text())
    assert len(rows) - 1 == len(data["curve"]["parameter"])
    assert float(rows[-1][2]) == data["curve"]["displacement"][-1]
    assert json.loads((place / "end" / "summary.json").read_text())["status"] == "solved"
    assert run("path", slender, "-s", "dead=1", "--out", "p")[0] == 0
    assert {p.name for p in slender.parent.iterdir()} == {"slender.toml", "p"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--stage", "snow=1"), "there is no load group 'snow'"),
        (("--stage", "dead"), "'dead' is not a factor"),
        (("--until", "0.01"), "no control point is given"),
        (("--point", "b01,0"), "is not a point of a body"),
        (("--point", "b01,0,wide", "--until", "0.1"), "'wide' is not a number"),
        (("--point", "b77,0,0", "--until", "0.1"), "there is no body called 'b77'"),
    ],
)
def test_path_with_wrong_options(slender: Path, options: tuple[str, ...], said: str) -> None:
    code, _, err = run("path", slender, *options)
    assert code == 2
    assert said in err


def test_tables_of_a_result_in_space_are_exported(tmp_path: Path) -> None:
    block = concio.Polyhedron.box("b", (0, 0, 0), (1, 1, 1), kind="rigid")
    floor = concio.Polyhedron.box("floor", (-1, -1, -1), (2, 2, 0), kind="fixed")
    materials, laws = {"block": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.6)}
    model = concio.Model((floor, block), materials, laws, loads=(concio.Load("weight", (0, 0, -1)),))
    result = concio.solve(model)
    files = concio.io.write_result(result, tmp_path / "r", figures=False, report=False)
    written = {path.name: path.read_bytes() for path in files}
    code, out, _ = run("export", tmp_path / "r", "--to", "csv")
    assert code == 0
    assert [Path(line).stem for line in out.splitlines()] == ["bodies", "joints", "contacts", "reactions"]
    for path in map(Path, out.splitlines()):
        assert path.read_bytes() == written[path.name]
    with pytest.raises(concio.InputError, match="three principal values"):
        _ = result.stress.principal


def test_tables_of_a_result_without_an_answer_hold_no_numbers_of_one(slender: Path) -> None:
    """Stresses, forces and reactions of a wall that falls were 0, and its joints open."""
    assert run("run", slender, "--out", "r", "--no-figures", "-q")[0] == 3
    code, out, err = run("export", "r", "--to", "csv")
    assert code == 0
    assert err.startswith("No equilibrium is possible")
    assert "Displacements, stresses and forces are left out." in err
    for path in map(Path, (*out.splitlines(), "r/bodies.csv")):
        head, *rows = list(csv.reader(path.read_text().splitlines()))
        held = {name.split(" ")[0] for row in rows for name, cell in zip(head, row, strict=True) if cell}
        assert held <= {*GIVEN, "body", "kind", "role", "body_a", "body_b", "interface", "law", "support"}
        assert "x" in held or "support" in held
    err = run("export", "r", "--to", "dxf", "--scale", "0.1")[2]
    assert "displaced by 0.1 times the velocities of the mechanism" in err
    assert "'velocity' is the mechanism" in run("export", "r", "--to", "vtu")[2]
    assert run("export", "r", "--to", "dxf", "--scale", "0", "--force")[2] == ""


@pytest.mark.usefixtures("blank_figures")
def test_export_for_other_programs(slender: Path) -> None:
    assert run("run", slender, "--factor", "live=0.05", "--out", "r", "--no-figures", "-q")[0] == 0
    code, out, _ = run("export", "r", "--to", "vtu")
    assert code == 0
    assert all(Path(line).exists() for line in out.splitlines())
    assert Path("r/vtu/bodies.pvd").exists()
    code, out, _ = run("export", "r", "--to", "csv", "--out", "tables")
    assert code == 0
    rows = list(csv.reader(Path("tables/reactions.csv").read_text().splitlines()))
    weight = 0.2 * 1.0 * 20
    assert weight == pytest.approx(max(float(cell) for cell in rows[1][1:]))
    assert run("export", "r", "--to", "toml")[0] == 0
    assert concio.load("r/model.toml").body("b01").area == pytest.approx(0.2)
    code, _, err = run("export", "nothing", "--to", "csv")
    assert code == 2
    assert "Traceback" not in err
    assert run("export", "r", "--to", "png")[0] == 2


@pytest.mark.usefixtures("blank_figures")
def test_the_exported_drawing_can_be_read_again(slender: Path) -> None:
    pytest.importorskip("ezdxf")
    assert run("run", slender, "--factor", "live=0.05", "--out", "r", "--no-figures", "-q")[0] == 0
    assert run("export", "r", "--to", "dxf", "--scale", "0")[0] == 0
    read = concio.model_from_dxf("r/deformed.dxf")
    assert sorted(b.area for b in read.bodies) == pytest.approx([0.02, 0.2])


@pytest.mark.parametrize(("command", "shown"), [("path", "[[stages]]"), ("cell", "[kN/m2]"), ("study", "[study]")])
def test_help_keeps_what_stands_in_brackets(command: str, shown: str) -> None:
    code, out, _ = run(command, "--help")
    assert (code, shown in "".join(out.split())) == (0, True)
