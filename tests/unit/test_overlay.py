"""Overlays of polygons whose sides lie on each other but for rounding, where GEOS in floating point fails."""

from __future__ import annotations

import numpy as np
import shapely

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
    n = sample(4_000, 20_000)
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
