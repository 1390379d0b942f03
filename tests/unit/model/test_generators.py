"""Generated walls, arches, columns and rubble: geometry known in closed form, names, and bad arguments."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.errors import GeometryError, InputError
from concio.model.generate.arch_on_piers import _cut
from concio.model.generate.arches import arch
from concio.model.generate.bonds import SHORTEST, Course, bond_courses, head_joints, without_short_pieces
from concio.model.generate.columns import buttress, column
from concio.model.generate.generators import GENERATORS, arguments_of, generate
from concio.model.generate.rubble import rubble
from concio.model.generate.wall_panels import Panel
from concio.model.generate.walls import wall, wall_of_courses
from concio.model.interfaces.detect import default_tolerance, detect_interfaces
from concio.model.materials import Elastic, JointLaw, Rigid


def detected(model):
    return detect_interfaces(model.bodies, tolerance=default_tolerance(model.bodies))


def free_area(model):
    return sum(b.area for b in model.free_bodies)


@pytest.mark.parametrize("bond", ["running", "stack", "english", "flemish", [(1,), (0.25, 1)]])
def test_every_bond_fills_the_wall_exactly(bond):
    model = wall(length=2.125, height=1.0, bond=bond)
    assert free_area(model) == pytest.approx(2.125, rel=1e-12)
    found = detected(model)
    assert not found.report()
    heads = sum(f.length for f in found.interfaces if abs(f.normal[0]) > 0.5)
    beds = sum(f.length for f in found.interfaces if abs(f.normal[1]) > 0.5)
    assert beds == pytest.approx(8 * 2.125)  # 7 bed joints and the ground
    assert heads == pytest.approx(0.125 * (len(model.free_bodies) - 8))


@pytest.mark.parametrize(("bond", "lap"), [("running", 0.5), ("english", 0.25), ("flemish", 0.25)])
def test_head_joints_lap(bond, lap):
    length = 10.0 if bond != "flemish" else 1.5 * 6 + 1
    first, second = (head_joints(c, length)[1:-1] for c in bond_courses(bond))
    apart = np.abs(first[:, None] - second[None, :])
    assert apart.min() == pytest.approx(lap)
    # mirror-symmetric where the length fits the bond
    for lines in (first, second):
        np.testing.assert_allclose(lines, (length - lines)[::-1], atol=1e-12)


def test_stack_bond_has_its_joints_in_line():
    (course,) = bond_courses("stack")
    np.testing.assert_allclose(head_joints(course, 4), range(5))


def test_english_bond_shows_headers_and_closers():
    lines = head_joints(bond_courses("english")[1], 4)
    np.testing.assert_allclose(np.diff(lines), [0.5, 0.25, 0.5, 0.5, 0.5, 0.5, 0.5, 0.25, 0.5])


def test_short_pieces_are_joined_or_shared():
    np.testing.assert_allclose(without_short_pieces([0, 1, 2, 2.1]), [0, 1, 1.55, 2.1])
    np.testing.assert_allclose(without_short_pieces([0, 0.1, 0.6, 1.6]), [0, 0.6, 1.6])


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=9), st.sampled_from([1.0, 1.25]))
def test_short_pieces_are_joined_to_neighbours(pieces, longest):
    """No piece is short, none grows beyond what two whole ones give, ends stay, and nothing is left to do."""
    lines = np.cumsum([0.0, *pieces])
    found = without_short_pieces(lines, longest)
    assert (found[0], found[-1]) == (lines[0], lines[-1])
    assert (np.diff(found) > 0).all()
    assert len(found) == 2 or np.diff(found).min() >= SHORTEST - 1e-8
    assert np.diff(found).max() <= longest + SHORTEST + 1e-8 or np.diff(found).max() <= max(pieces)
    assert without_short_pieces(found, longest) == pytest.approx(found, abs=1e-9)
    kept = np.abs(lines[:, None] - found).min(axis=1) < 1e-9
    assert kept.sum() + np.sum(np.diff(lines) < SHORTEST) >= len(lines) - 1  # only lines of short pieces go or move


def test_a_line_between_pieces_that_are_too_long_together_moves_to_their_middle():
    """From both ends alike: mirrored lines give mirrored ones."""
    for lines, wanted in (([0, 1, 1.1], [0, 0.55, 1.1]), ([0, 1, 2, 2.2, 3.2], [0, 1, 1.6, 2.2, 3.2])):
        there = lines[-1] - np.array(lines)[::-1]
        assert without_short_pieces(lines) == pytest.approx(wanted)
        if len(lines) == 3:
            assert without_short_pieces(there) == pytest.approx(lines[-1] - np.array(wanted)[::-1])


def test_names_and_layers_tell_course_and_sort():
    model = wall(length=1.0, height=0.25, block_size=(0.25, 0.125))
    names = [b.name for b in model.bodies]
    assert names[:3] == ["ground", "c01-b01", "c01-b02"]
    assert model.body("c02-b01").layer == "half"
    assert model.body("c02-b02").layer == "whole"


def test_opening_and_lintel_leave_the_right_area():
    door = {"x": 0.5, "y": 0, "width": 0.9, "height": 2.0, "lintel": 0.25, "bearing": 0.25}
    model = wall(length=3, height=3, openings=[door], lintel=Elastic(E="30 GPa", unit_weight=25))
    assert free_area(model) == pytest.approx(9 - 1.8)
    beam = model.body("lintel1")
    np.testing.assert_allclose([beam.outline.min(0), beam.outline.max(0)], [[0.25, 2], [1.65, 2.25]])
    assert beam.material == "lintel"
    assert not detected(model).report()


def test_opening_off_the_bed_joints_notches_blocks():
    model = wall(length=2, height=1, openings=[{"x": 0.6, "y": 0.3125, "width": 0.5, "height": 0.375}])
    assert free_area(model) == pytest.approx(2 - 0.5 * 0.375)
    assert any(len(b.outline) == 6 for b in model.bodies)
    assert not detected(model).report()
    with pytest.raises(GeometryError, match=r"course 3: .*strip thinner than"):
        wall(length=2, height=1, openings=[{"x": 0.6, "y": 0.255, "width": 0.5, "height": 0.375}])


def test_several_panels_have_bonds_and_names_of_their_own():
    model = wall(panels=[Panel(1, 1), {"length": 1, "height": 0.5, "at": (1, 0), "bond": "stack"}])
    assert {b.name[:3] for b in model.free_bodies} == {"p1-", "p2-"}
    assert free_area(model) == pytest.approx(1.5)
    assert not detected(model).report()
    with pytest.raises(InputError, match="panels 1 and 2 overlap"):
        wall(panels=[Panel(1, 1), Panel(1, 1, (0.5, 0))])


def test_loads_materials_and_base_law():
    model = wall(
        length=1, height=0.5, block=Rigid(), unit_weight="22 kN/m3", horizontal=0.1, top_pressure="50 kPa",
        friction=JointLaw(0.7, cohesion=5), base_friction=0.4, thickness="30 cm",
    )  # fmt: skip
    assert {b.kind for b in model.free_bodies} == {"rigid"}
    assert model.materials["block"].unit_weight == 22
    assert [(l.kind, l.value, l.group) for l in model.loads] == [
        ("weight", (0.0, -1.0), "dead"),
        ("weight", (0.1, 0.0), "live"),
        ("pressure", (50.0,), "top"),
    ]
    ground, first, second = (model.body(n) for n in ("ground", "c01-b01", "c01-b02"))
    assert model.laws[model.rule_between(ground, first).law].friction == 0.4
    assert model.laws[model.rule_between(first, second).law] == JointLaw(0.7, cohesion=5)
    assert first.thickness == pytest.approx(0.3)


def test_wall_of_courses_leaves_openings():
    model = wall_of_courses([[1, 1, 1], [0.5, -1, 1.5]], block_size=(0.4, 0.2))
    assert [b.name for b in model.free_bodies][3:] == ["c02-b01", "c02-b03"]
    assert free_area(model) == pytest.approx(0.08 * 5)


@pytest.mark.parametrize("row", [[1, 0, 1], [0], [], [1, float("nan")]])
def test_a_block_without_length_is_refused(row):
    with pytest.raises(InputError, match="course 2 has the lengths"):
        wall_of_courses([[1, 1], row], block_size=(0.4, 0.2))


@pytest.mark.parametrize("voussoirs", [7, 12])
@pytest.mark.parametrize("edges", ["curved", "straight"])
def test_semicircular_arch_is_a_half_ring(voussoirs, edges):
    model = arch(span=2, ring=0.3, voussoirs=voussoirs, edges=edges, chord_tolerance=1e-6)
    exact = np.pi / 2 * (1.3**2 - 1)
    chord = np.sin(np.pi / voussoirs) / (np.pi / voussoirs)
    assert free_area(model) == pytest.approx(exact * (1 if edges == "curved" else chord), rel=1e-5)
    found = detected(model)
    assert len(found.interfaces) == voussoirs + 1
    assert [f.length for f in found.interfaces] == pytest.approx([0.3] * (voussoirs + 1))
    assert not found.report()
    keys = [b.layer for b in model.free_bodies].count("keystone")
    assert keys == voussoirs % 2


def test_segmental_arch_has_the_radius_of_its_rise():
    s, r = 3.0, 0.5
    radius = (s * s / 4 + r * r) / (2 * r)
    model = arch(span=s, ring=0.25, voussoirs=9, shape="segmental", rise=r)
    points = np.concatenate([b.outline for b in model.free_bodies])
    distance = np.hypot(points[:, 0], points[:, 1] - (r - radius))
    assert distance.min() == pytest.approx(radius)
    assert distance.max() == pytest.approx(radius + 0.25, abs=0.25e-3)  # chords keep the area, not the radius
    assert len(detected(model).interfaces) == 10


@pytest.mark.parametrize("voussoirs", [10, 11])
def test_pointed_arch_meets_on_its_axis(voussoirs):
    model = arch(span=2, ring=0.3, voussoirs=voussoirs, shape="pointed")
    points = np.concatenate([b.outline for b in model.free_bodies])
    crown = points[np.abs(points[:, 0]) < 1e-9]
    # equilateral: both centres on the other springing, radius = span
    assert crown[:, 1].min() == pytest.approx(np.sqrt(3))
    assert crown[:, 1].max() == pytest.approx(np.sqrt(2.3**2 - 1))
    assert len(detected(model).interfaces) == voussoirs + 1
    mirrored = {tuple(p) for p in np.round(points * [-1, 1], 9)}
    assert mirrored == {tuple(p) for p in np.round(points, 9)}


def test_flat_arch_joints_point_to_one_centre():
    model = arch(span=1.2, ring=0.3, voussoirs=5, shape="flat", skew=60)
    found = detected(model)
    assert len(found.interfaces) == 6
    centre = np.array([0, -0.6 * np.tan(np.deg2rad(60))])
    for f in found.interfaces:
        assert abs(np.dot(f.normal, f.start - centre)) < 1e-12
    assert not found.report()


def test_crown_load_acts_on_the_extrados():
    load = arch(span=2, ring=0.2, voussoirs=9, crown_load=3, load_at=0.5).loads[-1]
    assert (load.value, load.bodies, load.group) == ((0.0, -3.0), ("v05",), "live")
    # the crown lies in the middle of the keystone's extrados, at most a chord's rise below the arc
    assert load.at == pytest.approx((0.0, 1.2), abs=2e-4)


def test_column_and_buttress():
    model = column(width=0.4, height=2, blocks=5, top_force=10, eccentricity=0.1)
    assert len(detected(model).interfaces) == 5
    assert model.loads[-1].at == (0.1, 2.0)
    model = buttress(base=1.5, top=0.5, height=3, courses=10, block_length=0.5, thrust=5)
    assert free_area(model) == pytest.approx(3.0)
    assert not detected(model).report()
    assert model.loads[-1].bodies == ("c10-b01",)


def test_rubble_is_repeatable_fills_the_wall_and_has_no_slivers():
    one, again, other = (rubble(length=3, height=2, stone=0.3, seed=s) for s in (4, 4, 5))
    assert all(np.array_equal(p.outline, q.outline) for p, q in zip(one.bodies, again.bodies, strict=True))
    assert not np.array_equal(one.bodies[1].outline, other.bodies[1].outline)
    assert free_area(one) == pytest.approx(6)
    found = detected(one)
    assert not found.overlaps
    assert {m.kind for m in found.near_misses} <= {"corner"}
    inner = [f.length for f in found.interfaces if one.bodies[f.a].kind != "fixed"]
    assert min(inner) > 0.01 * 0.3
    assert np.median(inner) > 0.2 * 0.3


@pytest.mark.parametrize(
    ("kind", "arguments", "message"),
    [
        ("wall", {"height": 1}, "length is missing"),
        ("wall", {"length": -1, "height": 1}, "length = -1 must be positive"),
        ("wall", {"length": 1, "height": 1, "bond": "dutch"}, "bond 'dutch' is not known"),
        ("wall", {"length": 1, "height": 1, "lap": 1.0}, "lap = 1"),
        ("wall", {"length": 1, "height": 1, "colour": "red"}, "unknown key 'colour'"),
        ("wall", {"length": 1, "height": 1, "ground": False}, "nothing holds the wall"),
        (
            "wall",
            {"length": 1, "height": 1, "openings": [{"x": 0.5, "y": 0, "width": 1, "height": 1}]},
            "leaves the wall",
        ),
        ("wall", {"length": 1, "height": 1, "openings": [{"x": 0.5}]}, "y is missing"),
        ("wall", {"length": 1e6, "height": 1e6}, "blocks are more than 500,000"),
        (
            "arch_on_piers",
            {"span": 2e3, "ring": 0.3, "voussoirs": 25, "pier_width": 1, "pier_height": 3, "pier_courses": 6},
            "blocks are more than 500,000",
        ),
        ("wall", {"length": 1, "height": 1, "block": "wood"}, "is not a material"),
        ("wall", {"length": 1, "height": 1, "unit_weight": 0, "horizontal": 0.1}, "unit_weight is zero"),
        ("wall", {"length": "3 kN", "height": 1}, "is not a length"),
        ("arch", {"span": 2, "ring": 0.2}, "'voussoirs' is missing"),
        ("arch", {"span": 2, "ring": 0.2, "voussoirs": 1}, "voussoirs = 1 must be at least 2"),
        ("arch", {"span": 2, "ring": 0.2, "voussoirs": 9, "shape": "segmental"}, "rise is missing"),
        ("arch", {"span": 2, "ring": 0.2, "voussoirs": 9, "shape": "segmental", "rise": 1.5}, "rises at most 1 m"),
        ("arch", {"span": 2, "ring": 0.2, "voussoirs": 9, "shape": "pointed", "rise": 0.5}, "rises more than 1 m"),
        ("arch", {"span": 2, "ring": 0.2, "voussoirs": 9, "shape": "round"}, "'round' is not one of"),
        ("column", {"width": 1, "height": 2, "blocks": 2.5}, "must be a whole number"),
        ("column", {"width": 1, "height": 2, "blocks": 2, "top_force": 1, "eccentricity": 0.6}, "outside the column"),
        ("buttress", {"base": 1, "top": 2, "height": 2, "courses": 2}, "wider than base"),
        ("rubble", {"length": 1, "height": 1, "stone": 0}, "stone = 0 must be positive"),
        ("castle", {}, "no generator 'castle'"),
    ],
)
def test_bad_arguments_are_named(kind, arguments, message):
    with pytest.raises(InputError, match=message):
        generate(kind, arguments)


def test_common_options_are_known_to_all_generators():
    for kind in GENERATORS:
        known = set(arguments_of(kind))
        assert {"friction", "block"} <= known
        assert ("thickness" in known) != ("contact_points" in known)  # the options of the plane, or those of space


def test_a_course_needs_positive_lengths():
    with pytest.raises(InputError, match=r"must lie between 0\.01 and 100"):
        Course((1, -1))


@pytest.mark.parametrize(("shape", "rise"), [("semicircular", None), ("segmental", 1.2), ("pointed", 2.6)])
def test_curved_voussoirs_keep_the_area_of_their_sectors(shape, rise):
    span, ring = 4.0, 0.4
    model = concio.arch(span=span, ring=ring, voussoirs=8, shape=shape, rise=rise, chord_tolerance=0.02)
    rise = span / 2 if rise is None else rise
    if shape == "pointed":
        c = (rise**2 - span**2 / 4) / span
        radius = span / 2 + c
        inner, outer = np.arccos(c / radius), np.arccos(c / (radius + ring))
        # two sectors of a ring, and what the outer arc has beyond the last radius before the axis
        area = (radius + ring) ** 2 * outer - radius**2 * inner + c * rise - c * (radius + ring) * np.sin(outer)
    else:
        radius = (span**2 / 4 + rise**2) / (2 * rise)
        half = np.pi / 2 if shape == "semicircular" else np.arcsin(span / 2 / radius)
        area = half * ((radius + ring) ** 2 - radius**2)
    assert sum(b.area for b in model.free_bodies) == pytest.approx(area, rel=1e-12)
    polygons = [len(b.outline) for b in model.free_bodies]
    assert max(polygons) < 20  # with a few chords


def test_a_published_load_does_not_depend_on_the_chords():
    """Coarse and fine chords give the same collapse load of an arch; chords on the arc lost 9e-5 of it by default."""
    arch = {"span": 4.0, "ring": 0.4, "voussoirs": 12, "block": "rigid", "friction": 5.0, "crown_load": 1.0}
    found = [
        concio.limit(concio.arch(**arch, load_at=0.25, **options), "live", path=False).associated.multiplier
        for options in ({}, {"chord_tolerance": 1e-6})
    ]
    assert found[0] == pytest.approx(found[1], rel=2e-7)


@pytest.mark.parametrize("off", [2e-9, -2e-9])
def test_an_opening_that_misses_a_bed_joint_by_rounding_makes_no_slivers(off):
    door = {"x": 0.75, "y": 0.5, "width": 1.0, "height": 1.5}
    sizes = {"length": 2.5, "height": 2.5, "block_size": (0.25, 0.25), "block": "rigid"}
    exact = concio.wall(openings=[door], **sizes)
    rounded = concio.wall(openings=[{**door, "height": 1.5 + off}], **sizes)
    assert [(b.name, len(b.outline)) for b in rounded.bodies] == [(b.name, len(b.outline)) for b in exact.bodies]


def test_no_wall_of_more_blocks_than_the_limit_is_begun(monkeypatch):
    """Of 154 blocks most are short: a count by the long ones would let them pass."""
    monkeypatch.setattr("concio.model.generate.generator_arguments.LARGEST_BLOCKS", 120)
    sizes = {"length": 4.0, "height": 1.0, "block_size": (0.4, 0.2), "bond": [(1.0, 0.1, 0.1, 0.1)]}
    monkeypatch.setattr("concio.model.generate.walls.panel_pieces", lambda *_: pytest.fail("blocks were made"))
    with pytest.raises(InputError, match="blocks are more than 120"):
        concio.wall(**sizes)


@pytest.mark.parametrize("shape", ["semicircular", "segmental", "pointed", "flat"])
def test_abutments_stand_behind_their_springing_joint_at_right_angles(shape):
    """Half a ring deep, and on the side where the arch is not."""
    rise = {"segmental": 0.5}.get(shape)
    model = concio.arch(span=2.0, ring=0.3, voussoirs=9, shape=shape, block="rigid", **({"rise": rise} if rise else {}))
    free = np.concatenate([b.outline for b in model.free_bodies])
    for body in (b for b in model.bodies if b.kind == "fixed"):
        sides = np.roll(body.outline, -1, axis=0) - body.outline
        assert abs(sides[0] @ sides[1]) < 1e-9
        assert min(np.hypot(*sides.T)) == pytest.approx(0.15)
        joint = max((i for i in detected(model).interfaces if model.bodies[i.a] is body or model.bodies[i.b] is body),
                    key=lambda i: i.length)  # fmt: skip
        assert joint.length == pytest.approx(max(np.hypot(*sides.T)))
        outside = np.sign(body.centroid[0])
        assert (outside * free[:, 0] <= outside * body.outline[:, 0].mean() + 1.0).all()
        assert abs(body.centroid[0]) > 1.0 - 1e-9


@pytest.mark.parametrize("span", [1e-2, 3.0, 500.0])
def test_the_rise_of_a_semicircle_is_half_its_span_to_rounding(span: float) -> None:
    """Given or not, it is the same arch; a millionth more or less is another shape, in any size."""
    options = {"span": span, "ring": 0.1 * span, "voussoirs": 5}
    plain = concio.arch(**options)
    for share in (1 - 1e-12, 1.0, 1 + 1e-12):
        told = concio.arch(**options, rise=0.5 * span * share)
        for one, other in zip(plain.bodies, told.bodies, strict=True):
            assert other.outline == pytest.approx(one.outline, abs=1e-11 * span)
    for share in (1 - 1e-6, 1 + 1e-6):
        with pytest.raises(concio.InputError, match="a semicircular arch of span"):
            concio.arch(**options, rise=0.5 * span * share)
    with pytest.raises(concio.InputError, match="rises at most"):
        concio.arch(**options, shape="segmental", rise=0.5 * span * (1 + 1e-6))
    assert concio.arch(**options, shape="segmental", rise=0.5 * span * (1 - 1e-6)).bodies


@pytest.mark.parametrize("span", [0.3, 3.0, 300.0])
def test_an_arch_may_be_as_thick_as_its_pier_is_wide_and_no_thicker(span: float) -> None:
    options = {"span": span, "voussoirs": 7, "pier_height": span, "pier_courses": 2, "spandrels": False}
    for ring in (0.1 * span, 0.17 * span, 0.23 * span):
        made = concio.arch_on_piers(**options, ring=ring, pier_width=ring)
        assert np.ptp(np.vstack([b.vertices for b in made.free_bodies])[:, 0]) == pytest.approx(span + 2 * ring)
        with pytest.raises(concio.InputError, match="thicker at its springing than the pier"):
            concio.arch_on_piers(**options, ring=ring * (1 + 1e-6), pier_width=ring)


@pytest.mark.parametrize("unit", [0.1, 1.0, 20.0])
def test_blocks_of_a_buttress_are_about_as_long_as_asked_for(unit: float) -> None:
    """None longer than a block and a quarter but that at the sloping face, and all of the width is filled."""
    base, top, length, n = 2.0 * unit, 1.2 * unit, 0.4 * unit, 5
    made = concio.buttress(base=base, top=top, height=3.0 * unit, courses=n, block_length=length)
    for c in range(n):
        row = [b for b in made.free_bodies if b.name.startswith(f"c{c + 1:02d}-")]
        ends = sorted((float(b.vertices[:, 0].min()), float(b.vertices[:, 0].max())) for b in row)
        assert all(q - p <= 1.25 * length + 1e-9 * unit for p, q in ends[:-1])
        assert ends[-1][1] - ends[-1][0] <= 1.75 * length, "no joint meets the sloping face"
        assert [p for p, _ in ends[1:]] == pytest.approx([q for _, q in ends[:-1]])
        assert (ends[0][0], ends[-1][1]) == pytest.approx((0.0, base + (top - base) * c / n))
        assert len(row) >= (base + (top - base) * c / n) / (1.35 * length)


@pytest.mark.parametrize(
    ("low", "high", "course", "widths"),
    [
        (-3.0, -0.4, 0, [1.0, 1.0, 0.6]),
        (-3.0, -0.4, 1, [0.5, 1.0, 1.1]),
        (-3.0, -0.65, 0, [1.0, 1.35]),
        (-3.0, 3.0, 2, [1.0] * 6),
        (-3.0, 3.0, 3, [0.5, *[1.0] * 5, 0.5]),
        (-3.0, -2.2, 0, [0.8]),
    ],
)
def test_courses_beside_an_arch_are_cut_in_running_bond_from_their_outer_faces(low, high, course, widths):
    """Left and right mirrored, at any size; what is left at the arch is no shorter than two fifths of a block."""
    for size in (1.0, 1e-3, 1e3):
        left = _cut(shapely.box(size * low, 0.0, size * high, 0.3 * size), 3.0 * size, size, course)
        right = _cut(shapely.box(-size * high, 0.0, -size * low, 0.3 * size), 3.0 * size, size, course)
        for found, wanted in ((left, widths), (right, widths[::-1])):
            assert [b.bounds[2] - b.bounds[0] for b in found] == pytest.approx([size * w for w in wanted])
            assert sum(b.area for b in found) == pytest.approx(0.3 * size * (high - low) * size)


def test_the_width_of_a_course_at_a_sloping_arch_is_the_lesser_of_both_edges():
    part = shapely.Polygon([(-3, 0), (-1.2, 0), (-0.4, 0.4), (-3, 0.4)])
    assert [b.bounds[0] for b in _cut(part, 3.0, 1.0, 0)] == pytest.approx([-3.0, -2.0])
    other = shapely.affinity.scale(part, xfact=-1.0, origin=(0, 0))
    assert [b.bounds[2] for b in _cut(other, 3.0, 1.0, 0)] == pytest.approx([2.0, 3.0])


@pytest.mark.parametrize("spandrels", [True, False])
def test_an_arch_on_piers_is_as_wide_as_its_span_and_two_piers(spandrels: bool) -> None:
    """Spandrels end above the outer faces of the piers, and cover the arch by the fill at least."""
    made = concio.arch_on_piers(span=2.0, ring=0.25, voussoirs=11, pier_width=0.7, pier_height=1.5, pier_courses=5,
                                spandrels=spandrels, fill=0.3, block="rigid", unit_weight=20.0)  # fmt: skip
    corners = np.vstack([b.vertices for b in made.free_bodies])
    assert np.abs(corners[:, 0]).max() == pytest.approx(1.0 + 0.7)
    outer = corners[np.abs(corners[:, 0]) > 1.69, 1].max()
    assert outer == pytest.approx(corners[:, 1].max() if spandrels else 1.5)
    crown = max(b.vertices[:, 1].max() for b in made.free_bodies if b.name.startswith("v"))
    assert outer >= crown + 0.3 - 1e-9 or not spandrels
