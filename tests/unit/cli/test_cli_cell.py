"""``concio cell``: what it prints and writes, exit codes, and what it refuses."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run

DRY = """
[cell]
block = "rigid"
block_size = [0.4, 0.175]
friction = { friction = 0.65, normal_stiffness = 1e5, tangential_stiffness = 4e4 }
"""


@pytest.fixture
def dry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A dry cell in a directory of its own, which is the working directory."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "dry.toml"
    path.write_text(DRY)
    return path


def test_the_template_is_a_cell_that_can_be_checked_and_homogenised(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("new", "cell")[0] == 0
    code, out, _ = run("check", "cell.toml", "--out", "cell.png")
    assert code == 0
    assert "repeats by (0.26, 0) and (0, 0.13) m" in out
    assert "no loads" not in out
    assert (tmp_path / "cell.png").exists()
    code, out, err = run("cell", "cell.toml", "--no-strength")
    assert (code, err) == (0, "")
    assert "E_x 8.65463e+06" in out
    assert "all joints closed" in out
    assert "sheared: The end asked for was reached." in out


def test_a_cell_is_told_in_the_units_that_are_asked_for(tmp_path):
    file = tmp_path / "soft.toml"
    law = concio.JointLaw(0.6, cohesion=20.0, tensile_strength=10.0, normal_stiffness=1e6, tangential_stiffness=4e5)
    concio.save(concio.cell(block="rigid", lap=0.3, friction=law), file)
    asked = ("cell", file, "--stress", "yy=-100 kPa", "-d", "xy=1 kPa", "--no-coulomb", "-s", "stress yy=-30 kPa")
    code, out, _ = run(*asked, "--units", "N, mm, MPa")
    assert code == 0
    assert "repeats by (250, 0) and (0, 250) mm" in out
    assert "E_x 292, E_y 125, G_xy 40.1961 MPa" in out  # E_y is the height of a course times the normal stiffness
    assert "+1 s_yy <= 0.01 MPa" in out
    assert "xy 0.001 MPa: associated bound 61.5" in out
    assert "stress (0, -0.03, 0) MPa" in out
    assert "kN/m2" not in out
    assert "E_y 125000, G_xy 40196.1 kN/m2" in run(*asked)[1]


@pytest.mark.long
def test_moduli_strength_and_directions_in_words(dry):
    code, out, _ = run("cell", dry, "--stress", "yy=-100", "--direction", "xy=1", "--direction", "xx=-1,yy=-1")
    assert code == 0
    moduli = concio.homogenise(concio.load(dry))
    assert f"E_y {moduli.E_y:.6g}" in out
    assert "+0.65 s_yy +1 s_xy <= 0" in out
    assert "associated bound 41.4343, checked from both sides" in out
    assert "Coulomb path collapses at 41.4343" in out
    assert "xx -1, yy -1: no associated bound" in out
    code, out, _ = run("cell", dry, "--direction", "xy=1", "--no-coulomb", "--no-strength")
    assert code == 0
    assert "exactly" not in out


def test_json_is_one_object(dry):
    code, out, err = run("cell", dry, "--json", "--stage", "stress yy=-100 kPa", "--stage", "strain xy=0.01")
    assert (code, err) == (0, "")
    data = json.loads(out)
    assert data["status"] == "solved"
    assert data["strength"]["faces_exact"] is True
    assert data["path"]["stress"] == pytest.approx([0.0, -100.0, 41.434263], abs=1e-5)
    assert np.array(data["moduli"]["matrix"]).shape == (3, 3)
    assert data["moduli"]["certificate"]["worst"] < 1e-8


@pytest.mark.long
def test_out_holds_tables_that_a_finite_element_program_can_read(dry):
    code, out, _ = run("cell", dry, "--out", "result", "--direction", "xx=1", "--stress", "yy=-100", "--no-coulomb",
                       "--stage", "stress yy=-100")  # fmt: skip
    assert code == 0
    assert "half_spaces.csv" in out
    place = dry.parent / "result"
    names = {p.name for p in place.iterdir()}
    figures = {f"{name}.{form}" for form in ("png", "svg") for name in (
        "cell", "moduli", "strength_yy_xy", "strength_xx_yy", "strength_by_direction", "strength_surface",
        "mechanism_1", "path", "path_end")}  # fmt: skip
    assert names >= figures | {"summary.json", "moduli.csv", "half_spaces.csv", "strength.csv", "path.csv"}
    with (place / "half_spaces.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["a_xx", "a_yy", "a_xy", "h [kN/m2]"]
    faces = np.array(rows[1:], dtype=float)
    assert len(faces) == 4
    stress = np.array([0.65 * 100 * 0.4 / 0.35, -100.0, 0.0])  # the known strength along the beds
    assert (faces[:, :3] @ stress - faces[:, 3]).max() == pytest.approx(0.0, abs=1e-9)
    with (place / "moduli.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head == ["stress", *(f"by_strain_{name} [kN/m2]" for name in ("xx", "yy", "xy"))]
    matrix = np.array([row[1:] for row in rows], dtype=float)
    assert matrix == pytest.approx(concio.homogenise(concio.load(dry)).matrix)
    again = run("cell", dry, "--out", "result", "--no-strength")
    assert again[0] == 0


def test_a_path_that_ends_before_its_end_says_so_in_the_exit_code(dry):
    code, out, _ = run("cell", dry, "--no-strength", "--stage", "stress yy=-100", "--stage", "stress xy=100")
    assert code == 3
    assert "ended at 0.41434" in out


def test_rigid_blocks_on_hard_joints_have_strength_but_no_moduli(dry):
    dry.write_text(DRY.replace(", normal_stiffness = 1e5, tangential_stiffness = 4e4", ""))
    code, out, _ = run("cell", dry)
    assert code == 0
    assert "moduli       none: the joints allow no strain xx" in out
    assert "exactly" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--direction", "zz=1"], "'zz=1' is not a component"),
        (["--direction", "xx"], "'xx' is not a component"),
        (["--direction", "xx=a"], "'a'"),
        (["--direction", "xx=0"], "is zero"),
        (["--stress", "yy=1"], "beyond the strength"),
        (["--stage", "strain"], "neither a strain nor a stress"),
        (["--stage", "strain zz=1"], "neither a strain nor a stress"),
        (["--stage", "stress xx=1,strain xx=1"], "both strain xx and stress xx"),
        (["--stage", "stress xx=1 kN"], "kN"),
    ],
)
def test_what_means_nothing_is_refused(dry, arguments, words):
    code, _, err = run("cell", dry, *arguments)
    assert code in (2, 3)
    assert words in err
    assert "Traceback" not in err


def test_a_wall_is_no_cell_and_a_cell_no_wall(dry):
    wall = dry.parent / "wall.toml"
    wall.write_text("[wall]\nlength = 1\nheight = 1\n")
    code, _, err = run("cell", wall)
    assert code == 2
    assert "not a periodic cell" in err
    for command in ("run", "path", "limit"):
        code, _, err = run(command, dry)
        assert code == 2
        assert "periodic cell" in err
