"""Results as layers of a DXF drawing: forces, states and hinges are those of the tables; it reads back as the model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.thrust import hinges
from concio.io.dxf_results import HEAD, LONGEST, write_results_dxf

ezdxf = pytest.importorskip("ezdxf")


def tied_arch() -> concio.Model:
    arch = concio.arch(span=3.0, ring=0.2, voussoirs=9, friction=0.7, crown_load=2.0, unit_weight=25, block="rigid")
    tie = concio.Tie("chain", "v01", (-1.6, 0.2), "v09", (1.6, 0.2), stiffness=5e3)
    return replace(arch, ties=(tie,))


def entities(path: Path, layer: str, kind: str) -> list:
    found = ezdxf.readfile(path).modelspace().query(f"{kind}[layer=='{HEAD}{layer}']")
    return list(found)


def corners(path: Path, layer: str) -> list[np.ndarray]:
    return [np.array([p[:2] for p in e.get_points()]) for e in entities(path, layer, "LWPOLYLINE")]


@pytest.mark.parametrize("unit", ["m", "mm"])
def test_forces_stand_in_the_joints_with_their_sizes_and_directions(tmp_path: Path, unit: str) -> None:
    result, metres = concio.solve(tied_arch(), factors={"live": 2.0}), {"m": 1.0, "mm": 1e-3}[unit]
    path = tmp_path / "r.dxf"
    write_results_dxf(path, result, unit=unit)
    table = result.tables.joints()
    sizes = np.hypot(table["normal_force"], table["shear_force"])
    words = [float(e.dxf.text.removesuffix(" kN")) for e in entities(path, "FORCE_VALUES", "TEXT")]
    assert sorted(words) == pytest.approx(sorted(sizes), rel=5e-3)
    lines = [metres * line for line in corners(path, "FORCES")]
    lengths = [float(np.hypot(*(line[1] - line[0]))) for line in lines]
    assert np.array(lengths) / max(lengths) == pytest.approx(sizes / sizes.max(), rel=1e-6)
    size = max(float(np.ptp(body.vertices, axis=0).max()) for body in result.model.bodies)
    assert 0.5 * LONGEST * size < max(lengths) < 10 * LONGEST * size  # to be seen beside the blocks, in any unit
    joints = result.joints
    for line, middle, tangent, e in zip(lines, joints.middle, joints.tangent, joints.eccentricity, strict=True):
        assert line.mean(axis=0) == pytest.approx(middle + e * tangent, abs=1e-6)
    told = sorted(tuple(metres * np.array(c.dxf.center)[:2]) for c in entities(path, "HINGES", "CIRCLE"))
    assert np.array(told).reshape(-1, 2) == pytest.approx(np.array(sorted(h.at for h in hinges(result))).reshape(-1, 2))


def test_ties_loads_and_the_deformed_shape_are_drawn(tmp_path: Path) -> None:
    result, path = concio.solve(tied_arch(), factors={"live": 2.0}), tmp_path / "r.dxf"
    write_results_dxf(path, result, scale=3.0)
    assert corners(path, "TIES")[0] == pytest.approx(np.array([[-1.6, 0.2], [1.6, 0.2]]))
    pull = result.model.report.text("force", float(result.ties.tension[0]))
    assert entities(path, "TIES", "TEXT")[0].dxf.text == f"chain: {pull}, {result.ties.state[0]}"
    assert [e.dxf.text for e in entities(path, "LOADS", "TEXT")] == ["live: 2 x 2 kN"]
    table = result.tables.bodies()
    motion = dict(zip(table["body"], np.column_stack([table["u_x"], table["u_y"]]), strict=True))
    drawn = corners(path, "DEFORMED")
    for body, ring in zip(result.model.bodies, drawn, strict=True):
        away = ring.mean(axis=0) - np.asarray(body.rings[0]).mean(axis=0)
        assert away == pytest.approx(3.0 * motion[body.name], abs=3e-2 * max(np.abs(away).max(), 1e-9))


def test_a_structure_that_falls_shows_its_mechanism_and_no_forces(tmp_path: Path) -> None:
    wall = concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), friction=0.5, horizontal=0.8, block="rigid")
    result, path = concio.solve(wall, on_failure="return"), tmp_path / "r.dxf"
    write_results_dxf(path, result)
    assert not corners(path, "FORCES")
    assert not corners(path, "DEFORMED")
    moved = corners(path, "MECHANISM")
    still = [np.asarray(b.rings[0]) for b in wall.bodies]
    away = np.array([np.abs(a - b).max() for a, b in zip(moved, still, strict=True)])
    assert (away > 0).any()
    assert away[[b.kind == "fixed" for b in wall.bodies]].max() == 0.0
    assert corners(path, "SLIPS")


def test_the_drawing_reads_back_as_the_model(tmp_path: Path) -> None:
    arch = tied_arch()
    write_results_dxf(tmp_path / "r.dxf", concio.solve(arch))
    read = concio.model_from_dxf(tmp_path / "r.dxf")
    assert [(b.name, b.kind) for b in read.bodies] == [(b.name, b.kind) for b in arch.bodies]
    for one, other in zip(read.bodies, arch.bodies, strict=True):
        assert np.asarray(one.rings[0]) == pytest.approx(np.asarray(other.rings[0]), abs=1e-9)


@pytest.mark.long
def test_export_writes_results_and_says_where_it_cannot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("new", "arch", "a.toml")[0] == 0
    assert run("run", "a.toml", "--out", "r", "--no-figures")[0] == 0
    assert run("export", "r", "--to", "dxf", "--results")[0] == 0
    assert corners(Path("r/results.dxf"), "FORCES")
    code, _, told = run("export", "r", "--to", "vtu", "--results")
    assert code == 2
    assert "write --to dxf" in told
