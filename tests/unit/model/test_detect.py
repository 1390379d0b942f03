"""Interfaces from outlines: counts, places, gaps, and the report of what was not joined."""

from __future__ import annotations

import numpy as np
import pytest

from concio.errors import InputError
from concio.model.generate.walls import wall, wall_of_courses
from concio.model.interfaces.detect import default_tolerance, detect_interfaces
from concio.model.model import Body


def box(name, x0, y0, x1, y1, kind="elastic"):
    return Body(name, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)], kind=kind)


def turned(body, angle, about=(0.0, 0.0)):
    c, s = np.cos(angle), np.sin(angle)
    outline = (body.outline - about) @ np.array([[c, -s], [s, c]]).T + about
    return Body(body.name, outline, kind=body.kind)


def test_two_boxes_share_one_segment_with_its_frame():
    a, b = box("a", 0, 0, 1, 1), box("b", 0.25, 1, 2, 2)
    (face,) = detect_interfaces([a, b], tolerance=1e-6).interfaces
    assert (face.a, face.b, face.edge_a, face.edge_b) == (0, 1, 2, 0)
    np.testing.assert_allclose(face.normal, [0, 1], atol=1e-15)
    # from start to end runs the tangent (-n_y, n_x)
    np.testing.assert_allclose([face.start, face.end], [[1, 1], [0.25, 1]])
    assert face.length == pytest.approx(0.75)
    assert face.gap.tolist() == [0, 0]


def test_t_joint_makes_one_interface_with_each_neighbour():
    bodies = [box("left", 0, 0, 1, 1), box("right", 1, 0, 2, 1), box("top", 0.5, 1, 1.5, 2)]
    faces = detect_interfaces(bodies, tolerance=1e-6).interfaces
    assert [(f.a, f.b) for f in faces] == [(0, 1), (0, 2), (1, 2)]
    assert [f.length for f in faces] == pytest.approx([1, 0.5, 0.5])


def test_collinear_pieces_stay_separate_and_cover_the_joint():
    lower = Body("lower", [(0, 0), (1, 0), (1, 1), (0.7, 1), (0.2, 1), (0, 1)])
    upper = Body("upper", [(0, 1), (0.5, 1), (1, 1), (1, 2), (0, 2)])
    faces = detect_interfaces([lower, upper], tolerance=1e-6).interfaces
    assert len(faces) == 4
    assert sum(f.length for f in faces) == pytest.approx(1)


def test_gap_is_kept_within_reach_and_reported_beyond():
    bodies = [box("lower", 0, 0, 1, 1), box("upper", 0, 1.002, 1, 2)]
    assert detect_interfaces(bodies, tolerance=1e-6, reach=0.005).interfaces[0].gap == pytest.approx([0.002, 0.002])
    found = detect_interfaces(bodies, tolerance=1e-6)
    assert not found.interfaces
    (miss,) = found.near_misses
    assert (miss.kind, miss.a, miss.b) == ("gap", "lower", "upper")
    assert miss.gap == pytest.approx(0.002)
    np.testing.assert_allclose(miss.at, [0.5, 1.0])
    assert "2 mm" in miss.sentence


def test_gap_within_tolerance_counts_as_zero_but_is_remembered():
    bodies = [box("lower", 0, 0, 1, 1), box("upper", 0, 1 - 5e-5, 1, 2)]
    (face,) = detect_interfaces(bodies, tolerance=1e-4).interfaces
    assert face.gap.tolist() == [0, 0]
    assert face.signed_gap == pytest.approx([-5e-5, -5e-5])


def test_wedge_shaped_gap_is_linear_and_clipped_at_the_reach():
    bodies = [box("lower", 0, 0, 1, 1), turned(box("upper", 0, 1, 1, 2), 0.02, about=(0, 1))]
    found = detect_interfaces(bodies, tolerance=1e-6, reach=0.03)
    (face,) = found.interfaces
    assert [face.start[0], face.end[0]] == pytest.approx([1, 0])
    assert face.gap == pytest.approx([2 * np.sin(0.01), 0], rel=1e-12)  # across the bisector
    assert not found.near_misses
    found = detect_interfaces(bodies, tolerance=1e-6, reach=0.01)
    (face,) = found.interfaces
    assert face.length == pytest.approx(0.01 / (2 * np.sin(0.01)), rel=1e-9)
    assert face.gap == pytest.approx([0.01, 0], rel=1e-9)
    assert [m.kind for m in found.near_misses] == ["partial"]


def test_touching_edges_at_a_large_angle_are_reported_not_joined():
    bodies = [box("lower", 0, 0, 1, 1), turned(box("upper", 0, 1, 1, 2), np.deg2rad(8), about=(0, 1))]
    found = detect_interfaces(bodies, tolerance=1e-6, facing_angle=np.deg2rad(5))
    assert not found.interfaces
    assert [m.kind for m in found.near_misses] == ["angle"]
    assert "8 degrees" in found.near_misses[0].sentence


def test_sliver_is_dropped_and_reported():
    bodies = [box("lower", 0, 0, 1, 1), box("upper", 0.9998, 1, 2, 2)]
    found = detect_interfaces(bodies, tolerance=1e-6)
    assert not found.interfaces
    assert [(m.kind, m.a, m.b) for m in found.near_misses] == [("sliver", "lower", "upper")]


@pytest.mark.parametrize("pieces", [400, pytest.param(4000, marks=pytest.mark.long)])
def test_short_pieces_of_a_long_joint_are_no_slivers(pieces):
    """Each is a quarter of a millimetre, and one alone would be left out."""
    width = 2.5e-4 * pieces
    top = [(v, 1) for v in np.linspace(0, width, pieces + 1)[::-1]]
    lower = Body("lower", [(0, 0), (2, 0), (2, 1), *top])
    found = detect_interfaces([lower, box("upper", 0, 1, width, 2)], tolerance=1e-6)
    assert len(found.interfaces) == pieces
    assert sum(f.length for f in found.interfaces) == pytest.approx(width)
    assert not found.near_misses
    alone = detect_interfaces([lower, box("upper", -1, 1, 2.5e-4, 2)], tolerance=1e-6)
    assert [m.kind for m in alone.near_misses] == ["sliver"]


def test_corner_on_an_edge_is_reported_and_corner_on_corner_is_not():
    s = np.sqrt(0.5)
    diamond = Body("diamond", [(0.5, 1), (0.5 + s, 1 + s), (0.5, 1 + 2 * s), (0.5 - s, 1 + s)])
    found = detect_interfaces([box("lower", 0, 0, 1, 1), diamond], tolerance=1e-6)
    assert [m.kind for m in found.near_misses] == ["corner"]
    np.testing.assert_allclose(found.near_misses[0].at, [0.5, 1])
    stack = detect_interfaces([box(f"{i}{j}", i, j, i + 1, j + 1) for i in range(2) for j in range(2)], tolerance=1e-6)
    assert len(stack.interfaces) == 4
    assert not stack.near_misses


def test_overlap_is_reported_with_names_area_and_place():
    bodies = [box("a", 0, 0, 1, 1), box("b", 0.99, 0, 2, 1), box("c", 0, 3, 1, 4), box("c again", 0, 3, 1, 4)]
    found = detect_interfaces(bodies, tolerance=1e-6)
    assert not found.interfaces
    first, second = found.overlaps
    assert (first.a, first.b) == ("a", "b")
    assert first.area == pytest.approx(0.01)
    assert first.depth == pytest.approx(0.01, rel=0.02)
    assert 0.99 < first.at[0] < 1
    assert "drawn twice" in second.sentence


def test_fixed_bodies_may_touch_and_overlap_each_other():
    bodies = [box("ground", 0, -1, 2, 0, "fixed"), box("wall", -1, -1, 0, 2, "fixed"), box("b", 0, 0, 1, 1)]
    found = detect_interfaces(bodies, tolerance=1e-6)
    assert [(f.a, f.b) for f in found.interfaces] == [(0, 2), (1, 2)]
    assert not found.report()
    for sunk in ([bodies[0], box("b", 0, -0.1, 1, 1)], [box("b", 0, -0.1, 1, 1), bodies[0]]):
        (overlap,) = detect_interfaces(sunk, tolerance=1e-6).overlaps
        assert overlap.area == pytest.approx(0.1)


def test_a_body_between_hides_what_lies_behind():
    bodies = [box("lower", 0, 0, 1, 1), box("film", 0, 1, 0.6, 1.02), box("upper", 0, 1.02, 1, 2)]
    faces = detect_interfaces(bodies, tolerance=1e-6, reach=0.03).interfaces
    assert [(f.a, f.b) for f in faces] == [(0, 1), (0, 2), (1, 2)]
    across = faces[1]
    assert across.length == pytest.approx(0.4)
    assert across.gap == pytest.approx([0.02, 0.02])


def test_non_convex_bodies():
    u = Body("u", [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)])
    faces = detect_interfaces([u, box("key", 1, 1, 2, 2)], tolerance=1e-6).interfaces
    assert sorted(f.length for f in faces) == pytest.approx([1, 1, 1])


# Ferris and Tin-Loi (2001), wall 1 as in the literature: courses in block lengths from below; 83 joints with the base
FERRIS_WALL_1 = [[0.5, 1, 1, 1, 1, 0.5], [1, 1, 1, 1, 1]] * 3


def test_ferris_tin_loi_wall_1_has_83_interfaces():
    model = wall_of_courses(FERRIS_WALL_1, block_size=(0.4, 0.175), block="rigid", friction=0.65)
    found = detect_interfaces(model.bodies, tolerance=default_tolerance(model.bodies))
    assert len(model.bodies) == 34
    assert len(found.interfaces) == 83
    assert not found.report()


def test_count_of_a_running_bond_wall():
    # n whole blocks, c courses: heads (n - 1) or n in turn; each bed shows 2 n half-block segments, the ground n
    n, c = 20, 10
    model = wall(length=n * 0.25, height=c * 0.125, bond="running")
    found = detect_interfaces(model.bodies, tolerance=1e-6)
    heads = (c // 2) * (n - 1) + (c // 2) * n
    assert len(found.interfaces) == heads + (c - 1) * 2 * n + n
    assert not found.report()


@pytest.mark.parametrize("options", [{"tolerance": 0.0}, {"tolerance": np.nan}, {"tolerance": 1e-6, "reach": -1.0}])
def test_bad_tolerances_are_refused(options):
    with pytest.raises(InputError, match="gap"):
        detect_interfaces([box("a", 0, 0, 1, 1)], **options)


def test_overlap_is_told_wherever_the_origin_is():
    for at in (-50.0, 0.0, 50.0):
        a, b = box("a", at, at, at + 1, at + 1), box("b", at + 0.9, at + 0.2, at + 2, at + 0.8)
        (overlap,) = detect_interfaces([a, b], tolerance=1e-6).overlaps
        assert overlap.area == pytest.approx(0.06)
