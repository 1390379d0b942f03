"""Common parts of polygons whose sides may lie on each other but for rounding.

Faces of blocks in contact are just that, and there the overlay of GEOS in floating point fails: of pairs of triangles
that share a side, displaced by 1e-16, some four in a hundred had one whole triangle in common, and of equal ones one in
a hundred nothing near their area. On a grid no pair of 100,000 failed (``benchmarks/overlays.py``). The grid moves
vertices by its own unit, so its answer is taken where the areas differ, and the other, exact to rounding, elsewhere.
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
        Polygons, several, or lines, points and nothing where two do not share an area.
    """
    return _checked(shapely.intersection, first, second)


def without(first: Array, second: Array | shapely.Geometry) -> Array:
    """Return what is left of polygons without others, pair by pair; arguments as of :func:`common`."""
    return _checked(shapely.difference, first, second)


def _checked(overlay: Callable[..., Any], first: Array, second: Array | shapely.Geometry) -> Array:
    """Return an overlay in floating point, and on the grid where that has other areas."""
    found = np.asarray(overlay(first, second))
    if not found.size:
        return found
    bounds = np.concatenate([np.ravel(shapely.bounds(first)), np.ravel(shapely.bounds(second))])
    extent = float(np.nanmax(np.abs(bounds), initial=0.0)) or 1.0
    on_grid = overlay(first, second, grid_size=GRID * extent)
    wrong = np.abs(shapely.area(found) - shapely.area(on_grid)) > DIFFERENT * shapely.area(first)
    return np.where(wrong, on_grid, found)
