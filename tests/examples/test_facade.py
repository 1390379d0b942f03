"""The sloppy facade: its drawing is what its script draws, and it is read as the wall it means."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run

ezdxf = pytest.importorskip("ezdxf")
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def script():
    spec = importlib.util.spec_from_file_location("draw_facade", EXAMPLES / "draw_facade.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def drawn(path):
    return [
        (e.dxftype(), e.dxf.layer, list(e.get_points("xy")) if e.dxftype() == "LWPOLYLINE" else None)
        for e in ezdxf.readfile(path).modelspace()
    ]


def test_the_drawing_is_what_the_script_draws(tmp_path):
    assert script().main(tmp_path / "facade.dxf") == 182
    assert drawn(tmp_path / "facade.dxf") == drawn(EXAMPLES / "facade.dxf")


@pytest.mark.long
def test_it_is_read_as_the_wall_it_means():
    facade = script()
    model = concio.load(EXAMPLES / "facade.toml")
    walls, lintels = facade.stones()
    assert len(model.free_bodies) == len(walls) + len(lintels)
    area = 1e-6 * sum((b - a) * (d - c) for a, b, c, d in [*walls, *lintels])
    assert sum(b.area for b in model.free_bodies) == pytest.approx(area, rel=1e-4)
    # the interfaces of the repaired drawing are those of the wall as it was meant
    meant = [
        concio.Body(f"b{k}", 1e-3 * np.array([(a, c), (b, c), (b, d), (a, d)]))
        for k, (a, b, c, d) in enumerate([*walls, *lintels])
    ]
    ground = next(b for b in model.bodies if b.kind == "fixed")
    law, stone = {"joint": concio.JointLaw(0.6)}, {"block": concio.Elastic(E=1e6)}
    clean = concio.assemble(concio.Model((*meant, ground), stone, law))
    assembly = concio.assemble(model)
    assert len(assembly.detection.interfaces) == len(clean.detection.interfaces)
    assert not assembly.detection.report()
    lengths = [sorted(f.length for f in a.detection.interfaces) for a in (assembly, clean)]
    np.testing.assert_allclose(*lengths, atol=1.5e-3)
    # 24 kN/m2 of floor and 10 of roof on a wall of 0.5 m: the floor's line lies in a joint, and counts once
    weight = 21 * 0.5 * area + (27 - 21) * 0.5 * 1e-6 * sum((b - a) * (d - c) for a, b, c, d in lintels)
    total = assembly.load({"live": 0.0}).reshape(-1, 2).sum(0)
    np.testing.assert_allclose(total, (0, -weight - 0.5 * 5 * (24 + 10)), rtol=3e-4, atol=1e-9)


@pytest.mark.long
def test_check_says_what_was_done_to_it():
    code, out, err = run("check", EXAMPLES / "facade.toml")
    assert (code, err) == (0, "")
    assert "in a joint, on its lower face only (face = 'upper' or 'both' says otherwise)" in out
    assert "corners that nearly met" in out
    assert "8 LINE" not in out
    assert "3 LINE on layer 'ASSI', which is ignored" in out
    assert "drawn twice, deleted" in out
    code, out, _ = run("check", EXAMPLES / "facade.toml", "--all")
    assert out.count("moved        entity") > 500
