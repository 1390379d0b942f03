"""Random simple polygons: every mesh is conforming, counter-clockwise and exact in area."""

from __future__ import annotations

import numpy as np
import shapely
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from concio.fem.polygon_mesh import mesh_polygon
from concio.model.interfaces.polygon_check import polygon_faults
from meshes import assert_good_mesh
from samples import sample


@st.composite
def simple_polygons(draw):
    """Star-shaped polygons, convex or not, turned and moved, of any size."""
    n = draw(st.integers(3, 12))
    angle = np.sort(draw(st.lists(st.floats(0, 6.28), min_size=n, max_size=n)))
    radius = np.array(draw(st.lists(st.floats(0.1, 1), min_size=n, max_size=n)))
    scale = draw(st.sampled_from([1e-3, 1.0, 50.0]))
    move = np.array(draw(st.tuples(st.floats(-10, 10), st.floats(-10, 10))))
    outline = scale * (radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1) + move)
    shape = shapely.Polygon(outline)
    assume(shape.is_valid and shape.exterior.is_ccw and shape.area > 1e-3 * scale**2)
    assume(shapely.minimum_clearance(shape) > 1e-4 * scale)
    assume(not polygon_faults(outline))
    return outline


@settings(max_examples=sample(25, 60), deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(simple_polygons(), st.floats(0.15, 0.8), st.data())
def test_every_mesh_of_a_simple_polygon_is_right(outline, share, data):
    size = share * np.ptp(outline, axis=0).max()
    lengths = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T)
    breaks = [
        np.array(data.draw(st.lists(st.sampled_from([0.2, 0.35, 0.5, 0.9]), max_size=2, unique=True))) * length
        for length in lengths
    ]
    points, cells = mesh_polygon(outline, size, breaks)
    assert_good_mesh(outline, points, cells)
    for a, b, length, marks in zip(outline, np.roll(outline, -1, axis=0), lengths, breaks, strict=True):
        for mark in marks:
            assert np.hypot(*(points - (a + (b - a) * mark / length)).T).min() < 1e-9 * size


@settings(max_examples=sample(10, 25), deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(simple_polygons(), st.floats(0.2, 0.6))
def test_triangles_keep_the_subdivision_of_the_boundary(outline, share):
    size = share * np.ptp(outline, axis=0).max()
    _, cells = mesh_polygon(outline, size, quads=False)
    assert cells.shape[1] == 3
    sides = np.sort(np.concatenate([cells[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    _, count = np.unique(sides, axis=0, return_counts=True)
    parts = np.ceil(np.hypot(*(np.roll(outline, -1, axis=0) - outline).T) / size - 1e-6)
    assert (count == 1).sum() == parts.sum()
