"""Bodies with holes: a frame around a shelf, in Python, files, tables and drawings, rigid and elastic."""

from __future__ import annotations

import json

import numpy as np
import pytest

import concio
from commands import run
from concio.contact.assembly import assemble
from concio.contact.detection import detect
from concio.errors import GeometryError, InputError
from concio.fem.polygon_mesh import mesh_polygon
from concio.io.paraview import bodies_grid
from concio.io.result_file import load_result
from concio.model.drawing.drawing import model_from_dxf
from concio.model.file.block_table import read_blocks, write_blocks
from concio.model.model import Body, Load, Support
from concio.plot.model_figure import plot_model
from concio.post.outlines import outlines
from concio.report.view_data import unpack, view_data
from models import box, model_of, turned, weight

ezdxf = pytest.importorskip("ezdxf")


def rectangle(x0, x1, y0, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float)


def moved(x, y):
    """The hole of the frame, elsewhere."""
    return HOLE + np.array([x, y])


FRAME, HOLE = rectangle(0, 3, 0, 2), rectangle(0.5, 2.7, 0.4, 1.7)
SHELF = rectangle(0.7, 1.5, 0.4, 0.6)


def framed(kind="elastic", material="block", law=0.5, **options):
    """A frame on the ground with a short shelf standing in it, left of its middle, and a stone on the shelf."""
    same = {"kind": kind, "material": material}
    stone = Body("stone", rectangle(0.75, 1.0, 0.6, 1.1), **same)
    return model_of(
        box("ground", -1, 4, -1, 0, kind="fixed", role="ground"),
        Body("frame", FRAME, holes=[HOLE], **same), Body("shelf", SHELF, **same), stone,
        law=law, loads=(weight(),), **options,
    )  # fmt: skip


KINDS = [("elastic", "block"), ("rigid", "stone")]


def test_area_centroid_and_inertia_leave_the_hole_out():
    body = Body("b", FRAME, holes=[HOLE[::-1]])
    area = 6 - 2.2 * 1.3
    assert body.area == pytest.approx(area, rel=1e-14)
    np.testing.assert_allclose(body.centroid, (6 * np.array((1.5, 1)) - 2.86 * np.array((1.6, 1.05))) / area)
    own = [a * (w * w + h * h) / 12 for a, w, h in ((6, 3, 2), (2.86, 2.2, 1.3))]
    away = [((np.array(c) - body.centroid) ** 2).sum() for c in ((1.5, 1), (1.6, 1.05))]
    polar = own[0] + 6 * away[0] - own[1] - 2.86 * away[1]
    assert body.moments.radius_of_gyration == pytest.approx(np.sqrt(polar / area), rel=1e-12)
    assert [len(ring) for ring in body.rings] == [4, 4]
    for ring in (HOLE, HOLE[::-1]):  # either way round
        x, y = Body("c", FRAME, holes=[ring]).holes[0].T
        assert 0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() == pytest.approx(-2.86)


@pytest.mark.parametrize(
    ("holes", "options", "said"),
    [
        ([moved(5, 0)], {}, "hole 1 at .* does not lie inside the outline"),
        ([moved(-0.5, 0)], {}, "does not lie inside the outline, clear of it"),
        ([HOLE, rectangle(2.6, 2.9, 1, 1.2)], {}, "holes 1 and 2 touch or overlap"),
        ([rectangle(1, 1.2, 1, 1.2), rectangle(1.2, 1.4, 1, 1.2)], {}, "holes 1 and 2 touch or overlap"),
        ([HOLE[[0, 2, 1, 3]]], {}, "hole 1 has no area|crosses itself"),
        ([HOLE[:2]], {}, "hole 1 has 2 different vertices"),
        ([HOLE * np.nan], {}, "hole 1 holds a coordinate that is not finite"),
        ([HOLE], {"grid": (np.array([0, 3.0]), np.array([0, 2.0]))}, "a body with holes has no grid"),
    ],
)
def test_bad_holes_are_told(holes, options, said):
    with pytest.raises(InputError, match=said):
        Body("b", FRAME, holes=holes, **options)


def test_what_stands_in_a_hole_touches_it_and_overlaps_nothing():
    found = detect(framed())
    assert {(f.a, f.b) for f in found.interfaces} == {(0, 1), (1, 2), (2, 3)}
    assert not found.report()
    shelf = next(f for f in found.interfaces if (f.a, f.b) == (1, 2))
    assert shelf.edge_a >= 4  # an edge of the hole
    np.testing.assert_allclose(shelf.normal, (0, 1))
    assert shelf.length == pytest.approx(0.8)
    wide = model_of(Body("frame", FRAME, holes=[HOLE]), Body("shelf", SHELF - (0.4, 0)))
    assert len(detect(wide).overlaps) == 1


@pytest.mark.parametrize(("kind", "material"), KINDS)
@pytest.mark.parametrize("angle", [0.0, 0.2])
def test_a_frame_carries_its_shelf(kind, material, angle):
    model = turned(framed(kind, material), angle)
    result = concio.solve(model)
    assert result.solved
    heavy = 20 * (6 - 2.86)
    light = 20 * (0.8 * 0.2 + 0.25 * 0.5)
    down = np.array((np.sin(angle), -np.cos(angle)))
    np.testing.assert_allclose(result.reactions["ground"], -(heavy + light) * down, rtol=1e-9, atol=1e-9)
    joints = result.joints
    k = next(i for i in range(len(joints.N)) if (joints.body_a[i], joints.body_b[i]) == (1, 2))
    force = joints.N[k] * joints.normal[k] + joints.V[k] * joints.tangent[k]
    np.testing.assert_allclose(force, -light * down, atol=1e-8 * heavy)
    at = joints.middle[k] + joints.eccentricity[k] * joints.tangent[k]
    shelf, stone = model.body("shelf"), model.body("stone")
    middle = (20 * shelf.area * shelf.centroid + 20 * stone.area * stone.centroid) / light
    away = at - middle  # the resultant passes under what it carries
    assert abs(away[0] * down[1] - away[1] * down[0]) < 1e-7


def test_pressure_all_round_gives_the_same_stress_everywhere():
    """With the hole's edges loaded too the state is uniform, whatever the mesh: s = -p in every direction."""
    p = 50.0
    rings = [FRAME, HOLE[::-1]]
    loads = [
        Load("pressure", (p,), ("frame",), (tuple(a), tuple(b)))
        for ring in rings for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True)
    ]  # fmt: skip
    held = (
        Support("a", "frame", ((0.0, 0.0), (0.0, 0.0))), Support("b", "frame", ((3.0, 0.0), (3.0, 0.0)), "y"),
    )  # fmt: skip
    model = model_of(Body("frame", FRAME, holes=[HOLE]), loads=tuple(loads), supports=held, mesh_size=0.3)
    result = concio.solve(model)
    _, stress = result.stress.at_points(0)
    np.testing.assert_allclose(stress, np.tile((-p, -p, 0.0), (len(stress), 1)), atol=1e-8 * p)


def test_loads_and_supports_find_the_edges_of_holes():
    load = Load("pressure", (7.0,), edge=((0.5, 0.4), (2.7, 0.4)))
    model = model_of(
        Body("frame", FRAME, holes=[HOLE]), loads=(load,), supports=(Support("s", "frame", ((0.5, 1.7), (2.7, 1.7))),)
    )
    assembly = assemble(model)
    np.testing.assert_allclose(assembly.loads["dead"].reshape(-1, 2).sum(0), (0, -7 * 2.2))
    result = concio.solve(model)
    np.testing.assert_allclose(result.reactions["s"], (0, 7 * 2.2), atol=1e-8)


@pytest.mark.parametrize("element", ["Q4", "Q8", "T6"])
def test_meshes_of_bodies_with_holes_cover_them(element):
    assembly = assemble(framed(element=element, mesh_size=0.25))
    shape = assembly.disc.shapes[assembly.disc.shape_of[1]]
    assert shape.elements.weights.sum() == pytest.approx(6 - 2.86, rel=1e-12)
    assert len(shape.edges) == 8
    two = [rectangle(0.5, 1, 0.5, 1)[::-1], rectangle(1.5, 2.5, 0.7, 1.6)[::-1]]
    points, cells = mesh_polygon(FRAME, 0.2, holes=two)
    x = points[cells]
    u, v = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    assert 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() == pytest.approx(6 - 0.25 - 0.9, rel=1e-12)


TEXT = """
[materials.block]
E = "5 GPa"
unit_weight = 20
[joints.dry]
friction = 0.5
[[blocks]]
name = "ground"
kind = "fixed"
rectangle = [[-1, -1], [4, 0]]
[[blocks]]
name = "frame"
rectangle = [[0, 0], [3, 2]]
holes = [[[0.5, 0.4], [2.7, 0.4], [2.7, 1.7], [0.5, 1.7]]]
[[blocks]]
name = "shelf"
rectangle = [[0.7, 0.4], [1.5, 0.6]]
[[loads]]
kind = "weight"
value = [0, -1]
"""


@pytest.mark.long
def test_model_files_hold_holes(tmp_path):
    path = tmp_path / "f.toml"
    path.write_text(TEXT)
    code, out, _ = run("check", path, "--out", tmp_path / "f.png")
    assert (code, "'frame': 4 vertices with 1 hole, area 3.14 m2" in out) == (0, True)
    model = concio.load(path)
    again = concio.loads(concio.dumps(model))
    np.testing.assert_array_equal(again.body("frame").holes[0], model.body("frame").holes[0])
    path.write_text(TEXT.replace("[0.5, 1.7]]]", "[0.5, 9]]]"))
    code, _, err = run("check", path)
    assert (code, "[[blocks]] 2 'frame': hole 1 at" in err) == (2, True)
    path.write_text(TEXT.replace("[2.7, 1.7]", "[2.7, 0.4]"))
    code, _, err = run("check", path)
    assert (code, "'frame', hole '1': vertices 2 and 3 coincide" in err) == (2, True)


@pytest.mark.parametrize("suffix", ["json", "csv"])
def test_tables_hold_holes(tmp_path, suffix):
    bodies = (Body("f", FRAME, holes=[HOLE, rectangle(0.1, 0.2, 0.1, 0.3)]), Body("s", SHELF))
    path = tmp_path / f"b.{suffix}"
    write_blocks(path, bodies)
    again = read_blocks(path)
    for one, two in zip(bodies, again, strict=True):
        assert len(one.rings) == len(two.rings)
        for ring, other in zip(one.rings, two.rings, strict=True):
            np.testing.assert_array_equal(ring, other)


@pytest.mark.long
def test_drawings_hold_holes_and_exports_give_them_back(tmp_path):
    document = ezdxf.new("R2010", units=4)
    space = document.modelspace()
    for layer, ring in (
        ("TERRA", rectangle(-1, 4, -1, 0)), ("TELAIO", FRAME), ("FORI", HOLE), ("MENSOLA", SHELF),
        ("concio_hole", rectangle(0.1, 0.3, 0.1, 0.3)),
    ):  # fmt: skip
        space.add_lwpolyline((1000 * ring).tolist(), close=True, dxfattribs={"layer": layer})
    document.saveas(tmp_path / "d.dxf")
    (tmp_path / "d.toml").write_text(
        'blocks_file = "d.dxf"\n[drawing]\nmend = "0.5 mm"\n[drawing.layers]\nTERRA = "fixed"\nFORI = "hole"\n'
        "[materials.block]\nE = '5 GPa'\nunit_weight = 20\n[joints.dry]\nfriction = 0.5\n"
    )
    model = concio.load(tmp_path / "d.toml")
    frame = next(b for b in model.bodies if b.layer == "TELAIO")
    assert frame.area == pytest.approx(6 - 2.86 - 0.04)
    assert len(detect(model).interfaces) == 2
    assert run("run", tmp_path / "d.toml", "--out", tmp_path / "r", "--no-figures")[0] == 0
    assert run("export", tmp_path / "r", "--to", "dxf", "--scale", "0", "--out", tmp_path / "e.dxf")[0] == 0
    drawn = ezdxf.readfile(tmp_path / "e.dxf")
    assert drawn.header["$INSUNITS"] == 4  # in the drawing's unit
    assert {e.dxf.layer for e in drawn.modelspace()} == {"TERRA", "TELAIO", "MENSOLA", "CONCIO_HOLES", "CONCIO_NAMES"}
    again = model_from_dxf(tmp_path / "e.dxf", layers={"TERRA": "fixed"})
    for body in model.bodies:
        other = again.body(body.name)
        assert (other.kind, len(other.holes)) == (body.kind, len(body.holes))
        np.testing.assert_allclose(other.outline, body.outline, atol=1e-9)


@pytest.mark.parametrize(
    ("ring", "said"),
    [(moved(9, 0), "lies in no block, or only in part"), (moved(-0.6, 0), "only in part"),
     (moved(-0.5, 0), "does not lie inside the outline")],
)  # fmt: skip
def test_holes_drawn_amiss_are_told(tmp_path, ring, said):
    document = ezdxf.new("R2010", units=6)
    for layer, points in (("A", FRAME), ("B", rectangle(4, 5, 0, 1)), ("CONCIO_HOLE", ring)):
        document.modelspace().add_lwpolyline(points.tolist(), close=True, dxfattribs={"layer": layer})
    document.saveas(tmp_path / "d.dxf")
    with pytest.raises(GeometryError, match=said):
        model_from_dxf(tmp_path / "d.dxf")


def test_a_block_drawn_in_another_is_asked_whether_it_is_a_hole(tmp_path):
    document = ezdxf.new("R2010", units=6)
    for points in (FRAME, HOLE):
        document.modelspace().add_lwpolyline(points.tolist(), close=True, dxfattribs={"layer": "A"})
    document.saveas(tmp_path / "d.dxf")
    with pytest.raises(GeometryError, match=r"overlap.*is one a hole in the other"):
        model_from_dxf(tmp_path / "d.dxf")


@pytest.mark.parametrize(("kind", "material"), KINDS)
def test_results_figures_and_views_show_the_hole(tmp_path, kind, material):
    result = concio.solve(framed(kind, material))
    from concio.io.result_dir import write_result

    write_result(result, tmp_path / "r", figures=False, report=False)
    again = load_result(tmp_path / "r")
    np.testing.assert_array_equal(again.model.body("frame").holes[0], result.model.body("frame").holes[0])
    shown = outlines(result)
    area = {
        b.name: sum(0.5 * (r[:-1, 0] * r[1:, 1] - r[1:, 0] * r[:-1, 1]).sum() for r in rings)
        for b, rings in zip(result.model.bodies, shown.moved(0.0), strict=True)
    }
    assert area["frame"] == pytest.approx(6 - 2.86)
    data = view_data([result], ["x"])
    ring, start = unpack(data["bodies"]["ring"]), unpack(data["bodies"]["start"])
    assert len(start) == 5
    assert len(ring) == 6  # one ring more
    assert set(start) < set(ring)
    grid = bodies_grid(result)
    first = np.concatenate([[0], grid.offsets[:-1]])
    total = 0.0
    for a, b, body in zip(first, grid.offsets, grid.cell_data["body"], strict=True):
        x, y = grid.points[grid.connectivity[a:b]].T
        total += (body == 1) * 0.5 * abs((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())
    assert total == pytest.approx(6 - 2.86)
    for draw in (result.plot.deformed, result.plot.forces):
        draw().figure.canvas.draw()
    axes = plot_model(result.model)
    canvas = axes.figure.canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())

    def colour(x, y):
        across, up = axes.transData.transform((x, y))
        return tuple(pixels[round(pixels.shape[0] - up), round(across)][:3])

    assert colour(2.2, 1.2) == (255, 255, 255)  # in the hole
    assert colour(2.85, 1.2) != (255, 255, 255)  # in the frame
    assert json.dumps(result.summary())
