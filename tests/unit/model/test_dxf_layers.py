"""Layers of the draughtsman's own, what is left out and counted, block references, mirrored and damaged entities."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import concio
from concio.contact.assembly import assemble
from concio.contact.sides import interface_breaks
from concio.errors import GeometryError, InputError
from concio.model.drawing.drawing import model_from_dxf
from concio.model.drawing.mend import mended
from concio.model.materials import Elastic, Rigid
from samples import first

ezdxf = pytest.importorskip("ezdxf")
STONE, GRANITE = Elastic(E=4e6, unit_weight=20.0), Elastic(E=3e7, unit_weight=27.0)


class Sheet:
    """A drawing in metres in the making."""

    def __init__(self, unit=6):
        self.document = ezdxf.new("R2010", units=unit)
        self.space = self.document.modelspace()

    def box(self, x0, y0, x1, y1, layer, to=None):
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        return (self.space if to is None else to).add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})

    def line(self, a, b, layer):
        self.space.add_line(a, b, dxfattribs={"layer": layer})

    def saved(self, tmp_path):
        self.document.saveas(tmp_path / "d.dxf")
        return tmp_path / "d.dxf"


def two_storeys():
    sheet = Sheet()
    sheet.box(-1, -0.5, 3, 0, "Fondazione")
    sheet.box(0, 0, 2, 1, "MURATURA")
    sheet.box(0, 1, 2, 2, "muratura")
    sheet.box(0, 2, 2, 2.5, "ARCHITRAVI")
    sheet.line((0, 1), (2, 1), "SOLAIO")
    sheet.line((-5, 9), (5, 9), "QUOTE 1")
    sheet.line((-5, 8), (5, 8), "QUOTE 2")
    sheet.space.add_text("2.50", dxfattribs={"layer": "QUOTE 2", "insert": (1, 1)})
    return sheet


LAYERS = {
    "FONDAZIONE": "fixed",
    "MURATURA": "stone",
    "ARCHITRAVI": {"material": "granite", "role": "lintel", "thickness": "0.3 m"},
    "SOLAIO": {"load": "traction", "value": [0, "-12 kN/m2"], "group": "floor"},
    "QUOTE*": "ignore",
}


def test_layers_are_given_a_meaning(tmp_path):
    path = two_storeys().saved(tmp_path)
    model = model_from_dxf(path, materials={"stone": STONE, "granite": GRANITE}, layers=LAYERS)
    by_layer = {b.layer: b for b in model.bodies}
    assert by_layer["Fondazione"].kind == "fixed"
    assert by_layer["muratura"].material == "stone"
    lintel = by_layer["ARCHITRAVI"]
    assert (lintel.material, lintel.role, lintel.thickness) == ("granite", "lintel", 0.3)
    (floor,) = (load for load in model.loads if load.kind == "traction")
    assert (floor.value, floor.group, floor.edge) == ((0.0, -12.0), "floor", ((0.0, 1.0), (2.0, 1.0)))
    # a line on an ignored layer is left out and counted, and stops nothing
    assert model.generator["left_out"] == (
        "1 LINE on layer 'QUOTE 1', which is ignored", "1 LINE, 1 TEXT on layer 'QUOTE 2', which is ignored",
    )  # fmt: skip
    assert model.generator["faults"] == ()
    assert assemble(model).load({"dead": 0, "floor": 1}).sum() == pytest.approx(-24)


def test_a_line_where_blocks_are_expected_stops_the_reading_and_names_the_way_out(tmp_path):
    path = two_storeys().saved(tmp_path)
    layers = {k: v for k, v in LAYERS.items() if not k.startswith("QUOTE")}
    with pytest.raises(GeometryError, match=r"1 LINE on layer 'QUOTE 1' left out.*QUOTE 1 = 'ignore'"):
        model_from_dxf(path, materials={"stone": STONE, "granite": GRANITE}, layers=layers)


def test_the_same_in_a_file(tmp_path):
    two_storeys().saved(tmp_path)
    text = """
    blocks_file = "d.dxf"
    [units]
    force = "N"
    length = "mm"
    [drawing.layers]
    FONDAZIONE = "fixed"
    MURATURA = "stone"
    ARCHITRAVI = { material = "granite", role = "lintel", thickness = 300 }
    SOLAIO = { load = "traction", value = [0, -0.012], group = "floor" }
    "QUOTE*" = "ignore"
    [materials.stone]
    E = "4 GPa"
    [materials.granite]
    E = "30 GPa"
    [joints.dry]
    friction = 0.6
    """
    model = concio.loads(text, folder=tmp_path)
    assert {b.material for b in model.free_bodies} == {"stone", "granite"}
    assert {b.thickness for b in model.free_bodies} == {1.0, 0.3}
    assert [(load.value, load.group) for load in model.loads] == [((0.0, pytest.approx(-12.0)), "floor")]
    again = concio.loads(concio.dumps(model))
    assert again.loads == model.loads


@pytest.mark.parametrize(
    ("layers", "message"),
    [
        ({"MURTURA": "stone"}, "layer 'MURTURA', which the drawing does not have .did you mean 'MURATURA'"),
        ({"MURATURA": "ston"}, "'ston' is neither a material nor one of block, .*did you mean 'stone'"),
        ({"MURATURA": {"materiale": "stone"}}, "layer 'MURATURA': unknown key 'materiale' .did you mean 'material'"),
        ({"MURATURA": {"material": "x"}}, "material 'x' is not defined"),
        ({"MURATURA": {"use": "hold"}}, "use = 'hold' is not one of"),
        ({"SOLAIO": {"load": "traction"}}, "'value' is missing"),
        ({"SOLAIO": {"load": "traction", "value": 3}}, "takes two numbers"),
        ({"SOLAIO": {"load": "snow", "value": 3}}, "load = 'snow' is not one of"),
        ({"SOLAIO": {"load": "pressure", "value": "3 kN"}}, "is not a stress"),
        ({"SOLAIO": {"load": "pressure", "value": 3, "face": "top"}}, "face = 'top' is not one of"),
        ({"SOLAIO": {"load": "pressure", "value": 3, "material": "stone"}}, "unknown key 'material' of a load"),
        ({"SOLAIO": {"support": "z"}}, "support = 'z' is not one of"),
        ({"MURATURA": "stone", "muratura": "granite"}, "given twice"),
        ({"MURATURA": 3}, "neither a word nor a table"),
    ],
)
def test_bad_meanings_are_told(tmp_path, layers, message):
    path = two_storeys().saved(tmp_path)
    with pytest.raises(InputError, match=message):
        model_from_dxf(path, materials={"stone": STONE, "granite": GRANITE}, layers=layers)


def test_an_ignored_layer_that_is_not_there_is_only_noted(tmp_path):
    sheet = Sheet()
    sheet.box(0, 0, 1, 1, "A")
    model = model_from_dxf(sheet.saved(tmp_path), layers={"TESTI": "ignore"})
    assert "no such layer" in model.generator["left_out"][0]


def test_layer_0_in_a_block_is_the_layer_of_the_reference_and_mirrored_ones_stand_where_they_are_seen(tmp_path):
    sheet = Sheet()
    brick = sheet.document.blocks.new("BRICK")
    sheet.box(0, 0, 2, 1, "0", brick)
    brick.add_lwpolyline([(2, 0, 0.3), (3, 0, 0), (3, 1, 0), (2, 1, 0)], format="xyb", close=True,
                         dxfattribs={"layer": "ARCHED"})  # fmt: skip
    sheet.space.add_blockref("BRICK", (0, 0), dxfattribs={"layer": "CONCIO_FIXED"})
    sheet.space.add_blockref("BRICK", (-1, 0), dxfattribs={"layer": "WALL", "xscale": -1})
    model = model_from_dxf(sheet.saved(tmp_path))
    fixed, seen, wall, mirrored = sorted(model.bodies, key=lambda b: (b.kind != "fixed", -b.centroid[0]))
    assert (fixed.kind, wall.layer) == ("fixed", "WALL")
    np.testing.assert_allclose(wall.outline.min(0), (-3, 0), atol=1e-12)
    np.testing.assert_allclose(wall.outline.max(0), (-1, 1), atol=1e-12)
    assert mirrored.area == pytest.approx(seen.area, rel=1e-12)  # the arc bulges the same way
    np.testing.assert_allclose(mirrored.centroid * (-1, 1) - (1, 0), seen.centroid, atol=1e-12)


@pytest.mark.parametrize("copies", [(1_000_000_000, 1), (40_000, 40_000)])
def test_a_block_that_stands_for_too_many_copies_is_refused(tmp_path, copies):
    sheet = Sheet()
    sheet.box(0, 0, 1, 1, "A")
    sheet.box(0, 0, 2, 1, "0", sheet.document.blocks.new("BRICK"))
    rows, columns = copies
    sheet.space.add_blockref("BRICK", (0, 0), dxfattribs={
        "row_count": rows, "column_count": columns, "row_spacing": 1, "column_spacing": 1,
    })  # fmt: skip
    with pytest.raises(GeometryError, match=r"stands for .* copies"):
        model_from_dxf(sheet.saved(tmp_path))


def test_blocks_that_hold_themselves_are_refused(tmp_path):
    sheet = Sheet()
    sheet.box(0, 0, 1, 1, "A")
    one, two = sheet.document.blocks.new("ONE"), sheet.document.blocks.new("TWO")
    one.add_blockref("TWO", (0, 0))
    two.add_blockref("ONE", (0, 0))
    sheet.space.add_blockref("ONE", (0, 0))
    with pytest.raises((GeometryError, InputError)):
        model_from_dxf(sheet.saved(tmp_path))


def test_polylines_and_points_carry_loads_and_supports(tmp_path):
    sheet = Sheet()
    sheet.box(0, 0, 2, 1, "A")
    sheet.box(0, 1, 2, 2, "A")
    sheet.space.add_lwpolyline([(0, 2), (1.2, 2), (2, 2)], dxfattribs={"layer": "ROOF"})
    sheet.space.add_lwpolyline([(0, 0), (2, 0)], dxfattribs={"layer": "BASE"})
    sheet.space.add_point((1, 1), dxfattribs={"layer": "HOOK"})
    layers = {
        "ROOF": {"load": "pressure", "value": 5}, "BASE": {"support": "xy"},
        "HOOK": {"load": "point", "value": [0, "-3 kN"]},
    }  # fmt: skip
    model = model_from_dxf(sheet.saved(tmp_path), layers=layers, block=Rigid(20.0))
    lower, upper = sorted(model.bodies, key=lambda b: b.centroid[1])
    assert [s.body for s in model.supports] == [lower.name]
    roof = [load for load in model.loads if load.kind == "pressure"]
    assert {load.bodies for load in roof} == {(upper.name,)}
    assert sum(abs(b[0] - a[0]) for a, b in (load.edge for load in roof)) == pytest.approx(2)
    (hook,) = (load for load in model.loads if load.kind == "point")
    assert hook.bodies == (lower.name,)  # a point in a joint acts on the block below


def jittered_wall(seed, slip, tolerance):
    """Corners of a running bond of 12 x 6 stones, each off by up to ``slip``; repaired."""
    random = np.random.default_rng(seed)
    outlines = []
    for course in range(6):
        marks = [0.0, *np.arange(0.2 + 0.13 * (course % 3), 4.6, 0.4).tolist(), 4.8]
        for a, b in pairwise(marks):
            ideal = np.array([(a, 0.2 * course), (b, 0.2 * course), (b, 0.2 * course + 0.2), (a, 0.2 * course + 0.2)])
            outlines.append(ideal + random.uniform(-slip, slip, (4, 2)))
    return outlines, *mended(outlines, tolerance)


@pytest.mark.parametrize("seed", first(2, range(4)))
def test_mending_leaves_no_interface_shorter_than_its_tolerance_and_lists_every_move(seed):
    tolerance = 5e-4
    drawn, found, moves = jittered_wall(seed, 0.45 * tolerance, tolerance)
    bodies = [concio.Body(f"b{k}", o) for k, o in enumerate(found)]
    bodies.append(concio.Body("ground", np.array([(-1, -1), (6, -1), (6, 0), (-1, 0.0)]), kind="fixed"))
    model = concio.Model(
        tuple(bodies), {"block": STONE}, {"joint": concio.JointLaw(0.6)}, gap_tolerance=tolerance, mesh_size=0.4
    )
    assembly = assemble(model)
    assert min(f.length for f in assembly.detection.interfaces) > 20 * tolerance
    marks = interface_breaks(model, assembly.detection.interfaces)
    for b, edges in marks.items():
        corners = model.bodies[b].outline
        for e, at in enumerate(edges):
            length = np.hypot(*(corners[(e + 1) % len(corners)] - corners[e]))
            assert np.diff([0.0, *at, length]).min() > 0.9 * tolerance
    assert assembly.pairs.length.min() > 0.4 * tolerance
    # a corner either stayed where it was drawn or its move is listed
    starts = {tuple(m.start) for m in moves}
    for before, after in zip(drawn, found, strict=True):
        for p, q in zip(before, after, strict=True):
            assert tuple(p) in starts or (p == q).all()
    assert max(m.length for m in moves) <= 2 * tolerance


def test_a_row_of_close_corners_does_not_run_together():
    row = [np.array([(x, 0.0), (x + 2.0, 0.0), (x + 2.0, 1.0), (x, 1.0)]) for x in np.arange(8) * 0.4]
    stack = [o + np.array([0.0, 1.0]) for o in row]
    found, moves = mended([*row, *stack], 0.3)
    assert len(moves) > 10
    assert max(m.length for m in moves) <= 0.3
    corners = np.unique(np.concatenate(found).round(9), axis=0)
    assert len(corners) > 20


def test_mending_that_would_swallow_blocks_is_refused(tmp_path):
    path = two_storeys().saved(tmp_path)
    options = {"materials": {"stone": STONE, "granite": GRANITE}, "layers": LAYERS}
    with pytest.raises(InputError, match=r"mend = 5 m would remove 4 of 4 outlines .the thinnest, entity"):
        model_from_dxf(path, mend="5 m", **options)
    with pytest.raises(GeometryError, match=r"layer 'ARCHITRAVI'.* only about 400 mm wide.* would remove it"):
        model_from_dxf(path, mend="0.22 m", **options)


# -- ties -------------------------------------------------------------------------------------------------------------


def two_walls():
    sheet = Sheet()
    sheet.box(-1, -0.5, 5, 0, "Fondazione")
    sheet.box(0, 0, 0.5, 3, "MURATURA")
    sheet.box(3.5, 0, 4, 3, "MURATURA")
    return sheet


TIED = {"FONDAZIONE": "fixed", "MURATURA": "stone",
        "CATENE": {"tie": "5 MN/m", "yield_force": "30 kN", "prestress": 2.0}}  # fmt: skip


def test_lines_of_a_tie_layer_join_the_blocks_that_their_ends_lie_in(tmp_path):
    sheet = two_walls()
    sheet.line((3.5, 2.5), (0.5, 2.5), "Catene")
    sheet.line((6.0, 2.0), (4.0, 2.0), "CATENE")  # to a fixed point
    model = model_from_dxf(sheet.saved(tmp_path), layers=TIED, materials={"stone": STONE})
    one, other = model.ties
    assert {one.body_a, one.body_b} == {b.name for b in model.free_bodies}
    assert {one.body_a: one.at_a, one.body_b: one.at_b} == {
        b.name: ((0.5, 2.5) if b.centroid[0] < 2 else (3.5, 2.5)) for b in model.free_bodies
    }
    assert (one.stiffness, one.yield_force, one.prestress, one.break_elongation) == (5000.0, 30.0, 2.0, None)
    assert (other.body_b, other.at_b) == ("", (6.0, 2.0))
    assert one.name != other.name


@pytest.mark.parametrize(
    ("ends", "words"),
    [(((0.1, 1.0), (0.4, 2.0)), "joins .* with itself"), (((1.0, 1.0), (2.0, 1.0)), "joins no block")],
)
def test_a_tie_that_joins_nothing_is_a_fault(tmp_path, ends, words):
    sheet = two_walls()
    sheet.line(*ends, "CATENE")
    with pytest.raises(GeometryError, match=words):
        model_from_dxf(sheet.saved(tmp_path), layers=TIED, materials={"stone": STONE})
    left = model_from_dxf(sheet.saved(tmp_path), layers=TIED, materials={"stone": STONE}, on_fault="skip")
    assert not left.ties


@pytest.mark.parametrize(
    ("meaning", "words"),
    [
        ({"tie": 0.0}, "tie = 0 must be positive"),
        ({"tie": 5e3, "yield_force": -3.0}, "yield_force = -3 must be positive"),
        ({"tie": 5e3, "group": "live"}, "unknown key 'group' of a tie"),
        ({"tie": "5 kN/m2"}, "kN/m"),
    ],
)
def test_a_tie_layer_that_says_nothing_is_refused(tmp_path, meaning, words):
    sheet = two_walls()
    sheet.line((0.5, 2.5), (3.5, 2.5), "CATENE")
    with pytest.raises(InputError, match=words):
        model_from_dxf(sheet.saved(tmp_path), layers={**TIED, "CATENE": meaning}, materials={"stone": STONE})


def test_a_model_file_gives_a_tie_layer(tmp_path):
    sheet = two_walls()
    sheet.line((0.5, 2.5), (3.5, 2.5), "CATENE")
    sheet.saved(tmp_path)
    (tmp_path / "m.toml").write_text(
        'blocks_file = "d.dxf"\n[drawing.layers]\nFONDAZIONE = "fixed"\nMURATURA = "stone"\n'
        'CATENE = { tie = "5000 kN/m", yield_force = "30 kN" }\n'
        '[materials.stone]\nE = "4 GPa"\nnu = 0.2\nunit_weight = "20 kN/m3"\n[joints.j]\nfriction = 0.6\n',
        encoding="utf-8",
    )
    (tie,) = concio.load(tmp_path / "m.toml").ties
    assert tie.stiffness == 5000.0
    assert tie.yield_force == 30.0
