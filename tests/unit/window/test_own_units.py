"""What the page writes into files with units of their own: the page has kN and m, whatever a file has."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.window.commands import patch_of
from concio.window.own_units import layer_for_page
from samples import sample

HEAD = """[units]
force = "{force}"
length = "{length}"
[materials.block]
kind = "rigid"
unit_weight = "20 kN/m3"
[joints.dry]
friction = 0.5
[[loads]]
kind = "weight"
value = [0, -1]
"""
FLOOR = {"name": "floor", "rectangle": [[-2.0, -1.0], [5.0, 0.0]], "kind": "fixed"}
STONE = {"name": "stone", "outline": [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]}
UNITS = [("N", "mm"), ("kN", "cm"), ("MN", "m"), ("kN", "m")]
few = settings(max_examples=sample(10, 40), deadline=None)
sizes = st.floats(0.01, 0.99).map(lambda v: round(v, 4))


def done(text: str, *commands: dict[str, Any]) -> str:
    for command in commands:
        text = patch_of(text, command)[0].applied(text)
    return text


def read(folder: Path, text: str) -> concio.Model:
    path = folder / "file.toml"
    path.write_text(text, encoding="utf-8")
    return concio.load(path)


@given(units=st.sampled_from(UNITS), at=sizes, force=sizes, moved=sizes)
@few
def test_what_the_page_adds_is_what_it_says_in_any_units(units, at, force, moved, tmp_path_factory):
    """Ten in a field "force [kN]" was 10 N in a file in N and mm, and a click at 1 m a point at 1 mm."""
    loads = [
        {"kind": "point", "value": [force, -10.0], "at": [at, 2.0], "bodies": ["stone"], "group": "live"},
        {"kind": "pressure", "value": 3 * force, "edge": [[0.0, 2.0], [at, 2.0]], "bodies": ["stone"], "group": "live"},
        {"kind": "traction", "value": [force, 0.0], "edge": [[0.0, 0.0], [0.0, 2.0]], "group": "live"},
        {"kind": "weight", "value": [force, 0.0], "group": "quake"},
    ]
    tie = {"name": "rod", "body_a": "stone", "at_a": [at, 1.0], "at_b": [-1.5, 1.0], "stiffness": "13 MN/m",
           "prestress": force, "yield_force": 40.0}  # fmt: skip
    support = {"name": "held", "body": "floor", "displacement": [0.001 * moved, 0.0]}
    text = done(
        HEAD.format(force=units[0], length=units[1]),
        *({"do": "add", "to": "blocks", "table": one} for one in (FLOOR, STONE)),
        *({"do": "add", "to": "loads", "table": one} for one in loads),
        {"do": "add", "to": "ties", "table": tie}, {"do": "add", "to": "supports", "table": support},
        {"do": "set", "path": ["loads", 1, "at"], "value": [0.5 * at, 2.0]},
    )  # fmt: skip
    model = read(tmp_path_factory.mktemp("units"), text)
    assert model.bodies[1].outline == pytest.approx(np.array(STONE["outline"]))
    point, pressure, traction, quake = model.loads[1:]
    assert point.value == pytest.approx((force, -10.0))
    assert point.at == pytest.approx((0.5 * at, 2.0))
    assert pressure.value == pytest.approx((3 * force,))
    assert np.array(pressure.edge) == pytest.approx(np.array(loads[1]["edge"]))
    assert traction.value == pytest.approx((force, 0.0))
    assert quake.value == pytest.approx((force, 0.0))
    (rod,), (held,) = model.ties, model.supports
    assert (*rod.at_a, *rod.at_b) == pytest.approx((at, 1.0, -1.5, 1.0))
    assert (rod.prestress, rod.yield_force, rod.stiffness) == pytest.approx((force, 40.0, 13_000.0))
    assert held.displacement == pytest.approx((0.001 * moved, 0.0))


@pytest.mark.parametrize("units", UNITS)
def test_stones_are_traced_merged_split_and_moved_in_any_units(units, tmp_path):
    """Stones that were traced in metres were a thousandth of their size in a file in mm."""
    stones = [[[x, 0.0], [x + 0.4, 0.0], [x + 0.4, 0.3], [x, 0.3]] for x in (0.0, 0.4, 0.8)]
    text = done(
        HEAD.format(force=units[0], length=units[1]), {"do": "stones", "stones": stones},
        {"do": "corner", "from": [0.4, 0.3], "to": [0.42, 0.3]}, {"do": "merge", "names": ["s1", "s2"]},
        {"do": "split", "name": "s1", "line": [[0.25, -0.1], [0.25, 0.5]]},
    )  # fmt: skip
    model = read(tmp_path, text)
    areas = sorted(b.area for b in model.bodies if b.kind != "fixed")
    assert areas == pytest.approx([0.25 * 0.3, 0.4 * 0.3, 0.55 * 0.3])


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("kind", ["point", "traction"])
def test_loads_of_layers_are_shown_and_written_in_kn_and_m(units, kind):
    load = {"load": kind, "value": [0.5, -10.0], "group": "live"}
    text = done('blocks_file = "x.dxf"\n' + HEAD.format(force=units[0], length=units[1]),
                {"do": "set", "path": ["drawing", "layers", "L"], "value": load})  # fmt: skip
    stated = tomllib.loads(text)["drawing"]["layers"]["L"]
    assert layer_for_page(stated, text)["value"] == pytest.approx(load["value"])
    written = {"point": (-1e4, -10.0, -0.01, -10.0), "traction": (-0.01, -1e-3, -0.01, -10.0)}[kind]
    assert stated["value"][1] == pytest.approx(written[UNITS.index(units)])
