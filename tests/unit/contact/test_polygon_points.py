"""Weights of corners of a polygon, and the nearest of its points: the same at any size, one point beside another."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from concio.contact.polygon_points import nearest_inside, outside, polygon_weights

Array = np.ndarray
HOOK = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [0.0, 1.0]])
"""An outline with a corner inwards."""
SIZES = [1e-5, 1.0, 1e5]


def sides_of(ring: Array) -> Array:
    """Return the sides (s, 2, 2) of a ring."""
    return np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-6, 1e-3, 0.4])
def test_corners_with_their_weights_give_the_point(size: float, off: float) -> None:
    """At a distance inwards from every side; on a side by its two ends alone."""
    middle, along = 0.3 * np.roll(HOOK, -1, axis=0) + 0.7 * HOOK, np.roll(HOOK, -1, axis=0) - HOOK
    inwards = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    points = middle + off * inwards
    weights = polygon_weights(size * HOOK, size * points)
    assert weights.sum(axis=1) == pytest.approx(1.0, rel=1e-12)
    assert weights @ HOOK == pytest.approx(points, abs=1e-12 if off == 0.0 or off > 1e-4 else 1e-6 * off + 1e-12)
    for k, row in enumerate(weights):
        assert sorted(np.argsort(np.abs(row))[-2:]) == sorted([k, (k + 1) % 6]) or off == 0.4
        if off == 0.0:
            assert sorted(row.tolist()) == pytest.approx([0.0, 0.0, 0.0, 0.0, 0.3, 0.7], abs=1e-12)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("way", [1, -1])
def test_at_a_corner_it_alone_counts(size: float, way: int) -> None:
    """And at a distance of rounding from it, where no angles are known any more; along a side the two ends share."""
    ring = HOOK[::way]
    for off in (0.0, 1e-14):
        assert polygon_weights(size * ring, size * (ring + off)) == pytest.approx(np.eye(6), abs=1e-12)
    ends = 0.25 * np.roll(np.eye(6), 1, axis=1) + 0.75 * np.eye(6)
    assert polygon_weights(size * ring, size * (ends @ ring)) == pytest.approx(ends, abs=1e-12)


@pytest.mark.parametrize("size", SIZES)
def test_points_outside_move_to_the_nearest_inside_and_others_stay(size: float) -> None:
    """As shapely has it, several points of several polygons at once."""
    rng = np.random.default_rng(3)
    at = rng.uniform([-1.0, -1.0], [4.0, 3.0], (200, 2))
    rings = HOOK + rng.uniform(-0.2, 0.2, (200, 6, 2))
    sides = np.array([sides_of(ring) for ring in rings])
    sides[::2, 0, 1] = sides[::2, 1, 1]  # a corner less, its side of no length at the end
    sides[::2, 1, 0] = sides[::2, 1, 1]
    polygons = [shapely.Polygon(ring[[0, 2, 3, 4, 5]] if k % 2 == 0 else ring) for k, ring in enumerate(rings)]
    whole = [polygon.is_valid for polygon in polygons]
    assert sum(whole) > 100
    away = np.array([p.exterior.distance(shapely.Point(q)) for p, q in zip(polygons, at, strict=True)])
    inside = np.array([p.contains(shapely.Point(q)) for p, q in zip(polygons, at, strict=True)])
    told = outside(size * sides, *(size * at.T)) / size
    moved = nearest_inside(size * sides, size * at) / size
    assert 20 < inside[whole].sum() < 180
    assert told[whole] == pytest.approx(np.where(inside, -away, away)[whole], abs=1e-12)
    assert moved[whole & inside] == pytest.approx(at[whole & inside], rel=1e-15)
    assert np.linalg.norm(moved - at, axis=1)[whole & ~inside] == pytest.approx(away[whole & ~inside], abs=1e-12)
    assert outside(sides, *moved.T)[whole & ~inside] == pytest.approx(0.0, abs=1e-12)


def test_where_all_points_are_inside_none_moves() -> None:
    at = np.array([[0.5, 0.5], [2.5, 1.5]])
    assert nearest_inside(np.array([sides_of(HOOK)] * 2), at) == pytest.approx(at, abs=0.0)
