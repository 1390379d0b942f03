"""Common parts of polygons whose sides may lie on each other but for rounding.

Faces of blocks in contact are just that, and there the overlay of GEOS in floating point fails: of pairs of triangles
that share a side, displaced by 1e-16, some four in a hundred had one whole triangle in common, and of equal ones one in
a hundred nothing near their area. On a grid no pair of 100,000 failed (``benchmarks/overlays.py``). The grid moves
vertices by its own unit, so its answer is taken where the areas differ, and the other, exact to rounding, elsewhere.

Where two polygons share an area here and a side or a corner there, GEOS returns all of these; which of them depends on
the last digit of the coordinates. Only areas are kept: a line among them would count as a perimeter, and the grid
refuses to cut what holds both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely

Array = np.ndarray

GRID = 2.0**-42
"""Unit of the grid over the largest coordinate."""

DIFFERENT = 1e-9
"""Difference of two areas, over that of the first polygon, up to which they are the same."""

AREAS = (shapely.GeometryType.POLYGON, shapely.GeometryType.MULTIPOLYGON)


def common(first: Array, second: Array | shapely.Geometry) -> Array:
    """Return the common parts of polygons, pair by pair.

    Parameters
    ----------
    first : (n,) array of polygons
    second : (n,) array of polygons, or one for all
        In the same coordinates [m].

    Returns
    -------
    (n,) array of geometries
        A polygon, several, or an empty one where two share no area.
    """
    return _checked(shapely.intersection, first, second)


def without(first: Array, second: Array | shapely.Geometry) -> Array:
    """Return what is left of polygons without others, pair by pair; arguments as of :func:`common`."""
    return _checked(shapely.difference, first, second)


def _checked(overlay: Callable[..., Any], first: Array, second: Array | shapely.Geometry) -> Array:
    """Return an overlay in floating point, and on the grid where that has other areas."""
    first, second = areas(first), areas(np.atleast_1d(np.asarray(second)))
    found = np.asarray(overlay(first, second))
    if not found.size:
        return found
    bounds = np.concatenate([np.ravel(shapely.bounds(first)), np.ravel(shapely.bounds(second))])
    extent = float(np.nanmax(np.abs(bounds), initial=0.0)) or 1.0
    on_grid = overlay(first, second, grid_size=GRID * extent)
    wrong = np.abs(shapely.area(found) - shapely.area(on_grid)) > DIFFERENT * shapely.area(first)
    return areas(np.where(wrong, on_grid, found))


def areas(shapes: Array) -> Array:
    """Return geometries (n,) without the lines and points among them: polygons, several, or empty ones."""
    kept = np.array(shapes, dtype=object)
    mixed = np.isin(shapely.get_type_id(kept), AREAS, invert=True)
    for k in np.flatnonzero(mixed):
        parts = shapely.get_parts(shapely.get_parts(kept[k]))
        kept[k] = shapely.multipolygons(parts[shapely.get_type_id(parts) == shapely.GeometryType.POLYGON])
    return kept
