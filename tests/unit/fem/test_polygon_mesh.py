"""Meshes of polygons: conforming, counter-clockwise, exact in area, faithful to the boundary, well shaped."""

from __future__ import annotations

import numpy as np
import pytest

from concio.errors import GeometryError, InputError
from concio.fem.mapped_mesh import _monotone, _paired
from concio.fem.polygon_mesh import mesh_polygon, mesh_quality
from concio.fem.triangulate import _Area, _smoothed, _worst_around
from concio.kinematics.mass import signed_area
from concio.model.interfaces.polygon_check import check_polygon, polygon_faults
from meshes import assert_good_mesh


def sector(inner, outer, start, stop, chords):
    angle = np.linspace(start, stop, chords + 1)
    ring = np.stack([np.cos(angle), np.sin(angle)], 1)
    return np.concatenate([outer * ring, inner * ring[::-1]])


TRAPEZIUM = np.array([(0, 0), (1, 0), (0.8, 0.6), (0.1, 0.5)])
HEXAGON = np.stack([np.cos(np.arange(6) * np.pi / 3), np.sin(np.arange(6) * np.pi / 3)], 1)
L_SHAPE = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])


def test_quadrilateral_gets_quads_with_breaks_as_nodes():
    breaks = [np.array([0.31]), np.zeros(0), np.array([0.2]), np.zeros(0)]
    points, cells = mesh_polygon(TRAPEZIUM, 0.2, breaks)
    assert cells.shape[1] == 4
    assert_good_mesh(TRAPEZIUM, points, cells)
    b = TRAPEZIUM[2] + 0.2 * (TRAPEZIUM[3] - TRAPEZIUM[2]) / np.hypot(*(TRAPEZIUM[3] - TRAPEZIUM[2]))
    for wanted in ((0.31, 0.0), b):
        assert np.hypot(*(points - wanted).T).min() < 1e-12
    assert mesh_quality(points, cells).smallest_angle > 50


def test_opposite_breaks_share_one_line():
    breaks = [np.array([0.5]), np.zeros(0), np.array([0.48]), np.zeros(0)]
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])
    points, cells = mesh_polygon(square, 1.0, breaks)
    assert len(cells) == 2  # one line from 0.5 below to 0.52 above, not two
    assert_good_mesh(square, points, cells)


def test_spans_of_a_mapped_mesh_are_no_longer_than_asked():
    points, cells = mesh_polygon(TRAPEZIUM, 0.2)
    x = points[cells]
    assert np.hypot(*(np.roll(x, -1, axis=1) - x).transpose(2, 0, 1)).max() <= 0.2 * (1 + 1e-9)
    assert len(cells) == 5 * 4  # the longer of two opposite sides says into how many


def test_a_break_is_joined_with_the_one_that_is_nearest_to_it():
    """Of 0.2 and 0.3 below, the second is nearer to 0.29 above: one line joins these two, another leaves from 0.2."""
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])
    points, cells = mesh_polygon(square, 1.0, [np.array([0.2, 0.3]), np.zeros(0), np.array([0.71]), np.zeros(0)])
    assert_good_mesh(square, points, cells)
    lines = {frozenset(edge) for cell in cells for edge in zip(cell, np.roll(cell, -1), strict=True)}
    below, above = (int(np.argmin(np.hypot(*(points - at).T))) for at in ((0.3, 0.0), (0.29, 1.0)))
    assert np.hypot(*(points[above] - (0.29, 1.0))) < 1e-12
    assert frozenset((below, above)) in lines
    assert len(cells) == 3


def test_voussoir_with_curved_edges_is_mapped():
    outline = sector(1.0, 1.3, 0.4, 0.7, 5)
    points, cells = mesh_polygon(outline, 0.1)
    assert cells.shape[1] == 4
    assert_good_mesh(outline, points, cells)
    assert mesh_quality(points, cells).smallest_angle > 80


@pytest.mark.parametrize(
    ("outline", "least"), [(HEXAGON, 30), (L_SHAPE, 30), (np.array([(0, 0), (1, 0), (0, 0.6)]), 25)]
)
def test_triangles_elsewhere_keep_the_boundary(outline, least):
    breaks = [np.array([0.123])] + [np.zeros(0)] * (len(outline) - 1)
    points, cells = mesh_polygon(outline, 0.25, breaks)
    assert cells.shape[1] == 3
    assert_good_mesh(outline, points, cells)
    first = outline[0] + 0.123 * (outline[1] - outline[0]) / np.hypot(*(outline[1] - outline[0]))
    assert np.hypot(*(points - first).T).min() < 1e-12
    assert mesh_quality(*mesh_polygon(outline, 0.25)).smallest_angle > least


def test_finer_size_gives_more_and_smaller_cells():
    coarse, fine = (mesh_polygon(HEXAGON, h) for h in (0.5, 0.1))
    assert len(fine[1]) > 15 * len(coarse[1])
    x = fine[0][fine[1]]
    assert np.hypot(*(x - np.roll(x, 1, axis=1)).transpose(2, 0, 1)).max() < 0.2


def test_comb_with_thin_teeth():
    teeth = 12
    top = [(k / teeth + s, 1.0 if s else 0.2) for k in range(teeth) for s in (0.0, 0.01)]
    outline = np.array([(0, 0), *top[1:], (1, 0.2), (1, 0)][::-1])
    outline = outline if signed_area(outline) > 0 else outline[::-1]
    check_polygon(outline)
    points, cells = mesh_polygon(outline, 0.2)
    assert_good_mesh(outline, points, cells)


def test_crossed_outlines_are_refused():
    with pytest.raises(GeometryError, match="triangles"):
        mesh_polygon(np.array([(0, 0), (2, 0), (2, 1), (0.5, -1), (0, 1.0)]), 0.3)
    with pytest.raises(GeometryError, match="coincide"):
        mesh_polygon(np.array([(0, 0), (1, 0), (1, 0), (0, 1.0)]), 0.3)
    with pytest.raises(InputError, match="mesh size"):
        mesh_polygon(HEXAGON, 0.0)
    with pytest.raises(InputError, match="2 lists of break points for 6 edges"):
        mesh_polygon(HEXAGON, 0.1, [np.zeros(0)] * 2)


@pytest.mark.parametrize(
    ("outline", "kinds", "place"),
    [
        ([(0, 0), (1, 1), (1, 0), (0, 1)], {"crossing"}, (0.5, 0.5)),
        ([(0, 0), (1, 0), (1, 0), (1, 1)], {"double vertex"}, (1, 0)),
        ([(0, 0), (1, 0)], {"too few"}, None),
        ([(0, 0), (2, 0), (1, 0), (1, 1)], {"spike", "touching"}, (2, 0)),
        ([(0, 0), (1, 0), (1, 1), (0.5, 0), (0, 1)], {"touching"}, (0.5, 0)),
        ([(0, 0), (1, np.nan), (1, 1)], {"not finite"}, None),
    ],
)
def test_faults_of_an_outline_are_named_with_their_place(outline, kinds, place):
    faults = polygon_faults(np.array(outline, dtype=float))
    assert {f.kind for f in faults} == kinds
    if place is not None:
        np.testing.assert_allclose(faults[0].at, place)
        with pytest.raises(GeometryError, match=rf"block 'c01-b02'.*\({place[0]:g}, {place[1]:g}\) m"):
            check_polygon(np.array(outline, dtype=float), "c01-b02")


def test_a_sound_outline_has_no_faults():
    assert polygon_faults(L_SHAPE) == ()
    assert polygon_faults(np.concatenate([L_SHAPE, L_SHAPE[:1]])) == ()


def test_marks_without_a_partner_get_one_at_the_same_fraction():
    """Unless lines would cross: then those that nothing holds are spread evenly between those that are."""
    p, q = np.array([0.0, 0.2, 1.0]), np.array([0.0, 0.7, 1.0])
    f, g = _paired(p, q, 1.0, 1.0, 1.0)
    assert f == pytest.approx([0.0, 0.2, 0.7, 1.0])
    assert g == pytest.approx([0.0, 0.2, 0.7, 1.0])
    p, q = np.array([0.0, 0.30, 0.42, 1.0]), np.array([0.0, 0.40, 0.52, 1.0])
    f, g = _paired(p, q, 1.0, 1.0, 0.3)
    assert (np.diff(f) > 0).all()
    assert (np.diff(g) > 0).all()
    assert {0.30, 0.42} <= set(f.tolist())
    assert {0.40, 0.52} <= set(g.tolist())


def test_the_shape_of_triangles_at_a_point_is_that_of_the_worst():
    """1 where equilateral, wherever that is; smaller where flat, negative where turned over."""
    third = np.array([(0.0, 0.0), (2.0, 0.0), (1.0, 3**0.5), (3.0, 3**0.5), (1.2, -0.1)])
    third += np.array([30.0, -70.0])
    assert _worst_around(third, np.array([(0, 1, 2), (1, 3, 2)]))[:4] == pytest.approx(np.ones(4), rel=1e-12)
    flat = 2 * 3**0.5 * 0.2 / (4.0 + 1.2**2 + 0.01 + 0.8**2 + 0.01)
    found = _worst_around(third, np.array([(0, 1, 2), (1, 3, 2), (0, 4, 1)]))
    assert found == pytest.approx([flat, flat, 1.0, 1.0, flat], rel=1e-9)
    assert _worst_around(third, np.array([(0, 2, 1)]))[:3] == pytest.approx(-np.ones(3), rel=1e-12)


@pytest.mark.parametrize("turn", [0, 1])
def test_breaks_that_all_but_coincide_are_one_node_of_a_slender_body(turn: int) -> None:
    """What is a millionth of its length apart is one place, however thin the body is."""
    strip = np.array([(0, 0), (4, 0), (4, 0.02), (0, 0.02)])
    if turn:
        strip = strip[:, ::-1] * [-1.0, 1.0]
    breaks = [np.array([1.0, 1.0 + 1e-6]), np.zeros(0), np.zeros(0), np.zeros(0)]
    points, cells = mesh_polygon(strip, 0.5, breaks)
    assert_good_mesh(strip, points, cells)
    assert min(np.hypot(*np.diff(points[np.append(cell, cell[0])], axis=0).T).min() for cell in cells) > 1e-3


def test_partners_that_would_cross_a_mark_are_spread_between_their_neighbours():
    """Marks at 0.5 and 0.8 stay where they are; of the two partners between them one lay beyond."""
    pairs = [(0.0, 0.0), (0.5, 0.1), (0.9, 0.2), (0.7, 0.3), (0.8, 0.4), (1.0, 1.0)]
    found = _monotone(pairs, np.array([0.5, 0.8]), np.array([0.1, 0.2, 0.3, 0.4]))
    assert np.array(found) == pytest.approx(
        np.array([(0.0, 0.0), (0.5, 0.1), (0.6, 0.2), (0.7, 0.3), (0.8, 0.4), (1.0, 1.0)])
    )


@pytest.mark.parametrize("seed", range(3))
def test_points_that_were_disturbed_are_smoothed(seed):
    """Inside of a hexagon on a triangular grid: shapes gain, the worst one too, and the boundary stays."""
    rows = np.stack(np.meshgrid(np.arange(-4, 5), np.arange(-4, 5)), -1).reshape(-1, 2)
    grid = 0.25 * rows @ np.array([(1.0, 0.0), (0.5, 0.75**0.5)])
    angle = np.pi / 6 + np.arange(6) * np.pi / 3
    reach = (grid @ np.stack([np.cos(angle), np.sin(angle)])).max(1)
    edge, inner = grid[np.isclose(reach, 0.75**0.5)], grid[reach < 0.8]
    ring = edge[np.argsort(np.arctan2(edge[:, 1], edge[:, 0]))]
    area = _Area([ring])

    def shapes(points):
        return _worst_around(points, area.triangulated(points))

    regular = np.concatenate([ring, inner])
    assert (len(ring), len(inner)) == (24, 37)
    assert shapes(regular) == pytest.approx(1.0)
    assert _smoothed(area, regular) == pytest.approx(regular)
    moved = regular.copy()
    moved[24:] += np.random.default_rng(seed).uniform(-0.08, 0.08, inner.shape)
    once = _smoothed(area, moved)
    thrice = _smoothed(area, _smoothed(area, once))
    assert (once[:24] == ring).all()
    assert shapes(moved).min() < shapes(once).min() <= shapes(thrice).min()
    assert 1 - shapes(once).mean() < 0.6 * (1 - shapes(moved).mean())
