"""An existing bridge from a DXF drawing: lines of the barrel and of the road, each on a layer."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import concio
from concio.analysis.bridges.sweep import Sweep
from concio.analysis.bridges.variants import changes
from concio.errors import InputError
from concio.model.generate.arch_bridges import rebuilt

ezdxf = pytest.importorskip("ezdxf")

SPAN, RISE, RING = 3.0, 0.75, 0.215
FILE = """
[bridge]
voussoirs = 16
width = 2.0
block = "rigid"
unit_weight = 22.0
friction = 0.6
[bridge_drawing]
file = "survey.dxf"
road = "STRADA"
{more}
[fill]
passive = 1.0
[vehicle]
axles = [[0.0, 1.0]]
"""


def drawn(place: Path, *, layers: tuple[str, ...] = ("INTRADOS", "EXTRADOS", "STRADA"), ring: float = RING) -> Path:
    """Draw the bridge in millimetres, far from the origin; the intrados as an arc, the extrados as a polyline."""
    document = ezdxf.new(units=4)
    space = document.modelspace()
    radius = 1e3 * (SPAN**2 / 4 + RISE**2) / (2 * RISE)
    half = math.degrees(2 * math.atan2(RISE, SPAN / 2))
    centre = np.array([5000.0 + 1500.0, 2000.0 + 750.0 - radius])
    space.add_arc(centre, radius, 90 - half, 90 + half, dxfattribs={"layer": layers[0]})
    angle = np.radians(np.linspace(90 + half, 90 - half, 65))
    outer = centre + (radius + 1e3 * ring) * np.column_stack([np.cos(angle), np.sin(angle)])
    space.add_lwpolyline(outer.tolist(), dxfattribs={"layer": layers[1]})
    top = 2000.0 + 1e3 * (RISE + RING + 0.3)
    space.add_line((2000.0, top), (6500.0, top), dxfattribs={"layer": layers[2]})
    space.add_line((6500.0, top), (12000.0, top), dxfattribs={"layer": layers[2]})
    document.saveas(place / "survey.dxf")
    path = place / "bridge.toml"
    path.write_text(FILE.format(more=""))
    return path


def test_a_drawn_bridge_is_the_one_that_the_generator_makes(tmp_path: Path) -> None:
    model = concio.load(drawn(tmp_path))
    made = concio.bridge(span=SPAN, rise=RISE, ring=RING, voussoirs=16, width=2.0, block="rigid", unit_weight=22.0)
    made = concio.with_fill(made, concio.Fill(cover=0.3, passive=1.0))
    made = concio.with_vehicle(made, concio.Vehicle("axle", (concio.Axle(0.0, 1.0),)))
    assert model.body("v01").centroid == pytest.approx(made.body("v01").centroid, abs=2e-3)
    for x in (0.7, 1.5):
        one, other = Sweep(model).at(x), Sweep(made).at(x)
        assert one is not None
        assert other is not None
        assert one.multiplier == pytest.approx(other.multiplier, rel=5e-3)


def test_the_ring_of_a_drawn_bridge_is_varied_like_that_of_one_by_its_dimensions(tmp_path: Path) -> None:
    """The road that was drawn stays where it is: a thicker ring leaves less cover."""
    model = concio.load(drawn(tmp_path))
    assert model.vehicle is not None
    made = concio.bridge(span=SPAN, rise=RISE, ring=RING, voussoirs=16, width=2.0, block="rigid", unit_weight=22.0,
                         friction=0.6)  # fmt: skip
    road = ((-5.0, RISE + RING + 0.3), (8.0, RISE + RING + 0.3))
    made = concio.with_vehicle(concio.with_fill(made, concio.Fill(road=road, passive=1.0)), model.vehicle)
    found, expected = ({c.name: c for c in changes(m, 0.7, "right")}["ring"] for m in (model, made))
    assert (found.value, found.low, found.high) == pytest.approx((RING, RING - 0.01, RING + 0.01), abs=2e-3)
    assert found.at_low < found.at_high
    for one, other in ((found.at_low, expected.at_low), (found.at_high, expected.at_high)):
        assert one == pytest.approx(other, rel=1e-2)
    thick = rebuilt(model, 1.5)
    assert [b.name for b in thick] == [b.name for b in model.bodies]
    low, high = (max(b.outline[:, 1].max() for b in bodies if b.kind != "fixed") for bodies in (model.outlines, thick))
    assert high - low == pytest.approx(0.5 * RING, abs=2e-3)
    back = concio.loads(concio.dumps(model))
    assert [b.outline.tolist() for b in rebuilt(back, 1.2)] == [b.outline.tolist() for b in rebuilt(model, 1.2)]


def test_lines_between_make_rings(tmp_path: Path) -> None:
    path = drawn(tmp_path)
    document = ezdxf.readfile(tmp_path / "survey.dxf")
    radius = 1e3 * (SPAN**2 / 4 + RISE**2) / (2 * RISE)
    half = math.degrees(2 * math.atan2(RISE, SPAN / 2))
    document.modelspace().add_arc((6500.0, 2750.0 - radius), radius + 107.5, 90 - half, 90 + half,
                                  dxfattribs={"layer": "MIDDLE"})  # fmt: skip
    document.saveas(tmp_path / "survey.dxf")
    path.write_text(FILE.format(more='lines = ["INTRADOS", "MIDDLE", "EXTRADOS"]'))
    model = concio.load(path)
    assert len(model.free_bodies) == 32
    detection = concio.assemble(model).detection
    assert not detection.overlaps
    assert not detection.near_misses
    assert len(detection.interfaces) >= 2 * 17 + 16


@pytest.mark.parametrize(
    ("layers", "ring", "more", "words"),
    [
        (("INTRADOS", "EXTRADO", "STRADA"), RING, "", "no line on layer 'EXTRADOS'"),
        (("INTRADOS", "EXTRADOS", "STRADA"), -0.1, "", "meet or cross"),
        (("INTRADOS", "EXTRADOS", "STRADA"), RING, 'lines = ["INTRADOS"]', "fewer than two"),
        (("INTRADOS", "EXTRADOS", "ROAD"), RING, "", "no line on layer 'STRADA'"),
    ],
)
def test_drawings_that_do_not_fit_are_refused(
    layers: tuple[str, ...], ring: float, more: str, words: str, tmp_path: Path
) -> None:
    path = drawn(tmp_path, layers=layers, ring=ring)
    path.write_text(FILE.format(more=more))
    with pytest.raises(InputError, match=words):
        concio.load(path)


def test_lines_that_stand_apart_are_spans_on_piers_below_a_drawn_fill_line(tmp_path: Path) -> None:
    path = drawn(tmp_path)
    document = ezdxf.readfile(tmp_path / "survey.dxf")
    space = document.modelspace()
    for entity in list(space):
        if entity.dxf.layer in ("INTRADOS", "EXTRADOS"):
            other = entity.copy()
            other.translate(1e3 * (SPAN + 1.0), 0.0, 0.0)
            space.add_entity(other)
    top = 2000.0 + 1e3 * (RISE + RING + 0.2)
    space.add_line((2000.0, top), (20000.0, top), dxfattribs={"layer": "FILL"})
    road = next(e for e in space if e.dxf.layer == "STRADA" and e.dxf.end.x > 6500.0)
    road.dxf.end = (20000.0, road.dxf.end.y)
    document.saveas(tmp_path / "survey.dxf")
    path.write_text(FILE.format(more='fill_line = "FILL"').replace("width = 2.0", "width = 2.0\npier_height = 2.0"))
    model = concio.load(path)
    made = concio.bridge(span=[SPAN, SPAN], rise=RISE, ring=RING, voussoirs=16, width=2.0, block="rigid",
                         unit_weight=22.0, pier_width=1.0, pier_height=2.0)  # fmt: skip
    made = concio.with_fill(made, concio.Fill(cover=0.3, passive=1.0, layers=(concio.Layer(0.1, 23.0),)))
    assert {b.name for b in model.bodies} == {b.name for b in made.bodies}
    weights = [-sum(x.value[1] for x in m.loads if x.group == "fill") for m in (model, made)]
    assert weights[0] == pytest.approx(weights[1], rel=5e-3)
    for name in ("s1-v01", "s2-v16", "pier1-p01"):
        assert model.body(name).centroid == pytest.approx(made.body(name).centroid, abs=5e-3)


def test_layers_with_other_numbers_of_lines_are_refused(tmp_path: Path) -> None:
    path = drawn(tmp_path)
    document = ezdxf.readfile(tmp_path / "survey.dxf")
    document.modelspace().add_line((9000, 2000), (9500, 2100), dxfattribs={"layer": "EXTRADOS"})
    document.saveas(tmp_path / "survey.dxf")
    with pytest.raises(InputError, match="they make 2 lines, one is wanted"):
        concio.load(path)


def test_a_drawing_that_stands_for_a_model_file_is_refused_with_the_tables_that_name_it(tmp_path: Path) -> None:
    drawn(tmp_path)
    with pytest.raises(InputError) as caught:
        concio.load(tmp_path / "survey.dxf")
    assert "[bridge_drawing] file = 'survey.dxf'" in (caught.value.hint or "")


def test_a_drawing_whose_file_says_another_unit_than_it_was_drawn_in_is_refused_with_the_key_of_the_unit(
    tmp_path: Path,
) -> None:
    path = drawn(tmp_path)
    document = ezdxf.readfile(tmp_path / "survey.dxf")
    document.units = ezdxf.units.M
    document.saveas(tmp_path / "survey.dxf")
    with pytest.raises(InputError) as caught:
        concio.load(path)
    assert "unit in [bridge_drawing]" in (caught.value.hint or "")
    path.write_text(FILE.format(more='unit = "mm"'))
    assert concio.load(path).body("v01").area > 0
