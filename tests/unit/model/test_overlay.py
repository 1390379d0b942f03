"""Overlays of polygons whose sides lie on each other but for rounding, where GEOS in floating point fails."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import concio
from concio.model.interfaces.near import find_overlaps
from concio.model.overlay import common, without
from samples import sample

APEX = np.array([-0.13369202833173421, 0.5857430478087033])
"""Facets of two faces of a vault's blocks, on which one of six-node triangles counted a triangle twice."""
FIRST = shapely.Polygon(
    [APEX, (-0.7000000000000002, -8.326672684688674e-17), (-0.7990311320975811, 0.4338837391175579)]
)
NEXT = shapely.Polygon([(0.0, 0.0), (-0.7000000000000002, -8.572527594031473e-17), APEX])


def test_neighbouring_facets_have_no_area_in_common():
    """The case met: GEOS 3.14 gives the whole first triangle."""
    assert shapely.area(common(np.array([FIRST]), NEXT)[0]) < 1e-15


def test_random_triangles_beside_each_other_and_upon_each_other():
    """Sides that coincide to 1e-16: nothing in common with the neighbour, everything with its own double."""
    rng = np.random.default_rng(0)
    n = sample(1_000, 20_000)
    p, q = rng.normal(size=(2, n, 2))
    along = q - p
    across = np.column_stack([-along[:, 1], along[:, 0]])
    up, down = (
        0.5 * (p + q) + side * rng.uniform(0.3, 1, (n, 1)) * across + rng.uniform(-0.4, 0.4, (n, 1)) * along
        for side in (1, -1)
    )
    moved = [v + 1e-16 * rng.normal(size=(n, 2)) for v in (p, q, up)]
    upper, lower = (shapely.polygons(np.stack(v, 1)) for v in ((p, q, up), (moved[1], moved[0], down)))
    twin = shapely.polygons(np.stack(moved, 1))
    area = shapely.area(upper)
    assert (shapely.area(common(upper, lower)) < 1e-9 * area).all()
    assert np.abs(shapely.area(common(upper, twin)) / area - 1).max() < 1e-8
    assert np.abs(shapely.area(without(upper, lower)) / area - 1).max() < 1e-8


def test_what_two_polygons_share_is_areas_alone():
    """An L and a square that lies on one arm and against the other: the line between them is no part, nor a point."""
    el = shapely.Polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    beside, corner = shapely.box(1, 0.5, 2, 2), shapely.box(2, 1, 3, 2)
    assert el.intersection(beside).geom_type == "GeometryCollection"
    found = common(np.array([el, el, el]), np.array([beside, corner, shapely.box(0, 2, 1, 3)]))
    assert shapely.area(found) == pytest.approx([0.5, 0.0, 0.0], abs=1e-15)
    assert shapely.length(found) == pytest.approx([3.0, 0.0, 0.0], abs=1e-15)
    again = common(found, shapely.box(0, 0, 1.5, 3))
    assert shapely.area(again) == pytest.approx([0.25, 0.0, 0.0], abs=1e-15)
    left = without(np.array([shapely.GeometryCollection([el, shapely.LineString([(5, 5), (6, 6)])])]), beside)
    assert shapely.length(left)[0] == pytest.approx(8.0)


def test_a_side_that_two_blocks_share_hides_no_overlap():
    """Where they also share a side of 10 m, an overlap of 20 x 20 mm was taken for one of 0.04 mm and said nothing."""
    long = concio.Body("long", np.array([(0.0, 0), (11, 0), (11, 1), (0, 1)]))
    other = concio.Body("other", np.array([(0.5, 1.0), (10.5, 1), (10.5, 0.98), (10.52, 0.98), (10.52, 2), (0.5, 2)]))
    (found,) = find_overlaps([long, other], tolerance=1e-3)
    assert found.area == pytest.approx(4e-4)
    assert found.depth == pytest.approx(0.01)


@pytest.mark.parametrize("seed", range(sample(6, 60)))
def test_cuts_of_cuts_do_not_fail(seed: int):
    """Grids of squares turned by any angle, their own halves, and a third cut: the areas sum up, nothing is refused."""
    rng = np.random.default_rng(seed)
    turn = np.exp(1j * rng.uniform(0, 2 * np.pi))
    x = np.arange(5.0)
    low = (x[:-1, None] + 1j * x[:-1]).ravel()
    square = np.array([0, 1, 1 + 1j, 1j])
    cells = np.array([shapely.Polygon(np.column_stack([(z := turn * (p + square)).real, z.imag])) for p in low])
    ends = turn * np.array([0.5, 3.5, 3.5 + 3j, 2 + 3j, 2 + 2j, 0.5 + 2j])
    el = shapely.Polygon(np.column_stack([ends.real, ends.imag]))
    once = common(cells, el)
    k, m = (v.ravel() for v in np.meshgrid(np.arange(len(once)), np.arange(len(cells))))
    assert shapely.area(common(once[k], cells[m])).sum() == pytest.approx(7.5, rel=1e-9)
