"""Segments clipped by convex faces, beside the same cut by shapely and by hand."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from concio.contact.clipping import nearest, segment_inside
from samples import sample


def placed(points: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Return points (..., 2) of a plane in a plane of space."""
    return points @ turn[:2] + np.array([0.3, -0.2, 0.7])


@settings(max_examples=sample(30, 300), deadline=None)
@given(st.integers(0, 10**6))
def test_what_lies_inside_and_which_sides_cut_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 8)))
    if np.diff(angle, append=angle[0] + 2 * np.pi).max() > 3.0 or np.diff(angle).min() < 0.05:
        return
    ring = np.column_stack([2.0 * np.cos(angle), np.sin(angle)])
    p, q = rng.uniform(-2.5, 2.5, (2, 20, 2))
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    low, high, first, last = segment_inside(
        np.broadcast_to(placed(ring, turn), (20, len(ring), 3)), np.broadcast_to(turn[2], (20, 3)),
        placed(p, turn), placed(q, turn),
    )  # fmt: skip
    face = shapely.Polygon(ring)
    for k in range(20):
        inside = face.intersection(shapely.LineString([p[k], q[k]]))
        length = float(np.linalg.norm(q[k] - p[k]))
        assert max(high[k] - low[k], 0.0) * length == pytest.approx(inside.length, abs=1e-9)
        if inside.length < 1e-6:
            continue
        for share, side, end in ((low[k], first[k], p[k]), (high[k], last[k], q[k])):
            if side < 0:
                assert face.contains(shapely.Point(end))
                assert share in (0.0, 1.0)
                continue
            cut = shapely.LineString([ring[side], ring[(side + 1) % len(ring)]])
            assert cut.distance(shapely.Point(p[k] + share * (q[k] - p[k]))) < 1e-9


@pytest.mark.parametrize(
    ("p", "q", "wanted"),
    [
        ((0.5, 0.5, 0), (0.6, 0.5, 0), (0.0, 1.0, -1, -1)),
        ((0.5, 0.5, 0), (1.5, 0.5, 0), (0.0, 0.5, -1, 1)),
        ((0.5, -1.0, 0), (0.5, 0.5, 0), (2 / 3, 1.0, 0, -1)),
        ((-0.5, 0.5, 0), (1.5, 0.5, 0), (0.25, 0.75, 3, 1)),
    ],
)
def test_ends_inside_are_no_cuts(p: tuple[float, ...], q: tuple[float, ...], wanted: tuple[float, ...]) -> None:
    ring = np.array([[(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]])
    found = segment_inside(ring, np.array([[0.0, 0, 1]]), np.array([p]), np.array([q]))
    assert [float(x[0]) for x in found] == pytest.approx(list(wanted))


@pytest.mark.parametrize("y", [-0.1, 1.1])
def test_a_segment_beside_a_face_and_along_its_side_lies_outside(y: float) -> None:
    ring = np.array([[(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]])
    low, high, *_ = segment_inside(ring, np.array([[0.0, 0, 1]]), np.array([[0.2, y, 0]]), np.array([[0.8, y, 0]]))
    assert low[0] > high[0]


@settings(max_examples=sample(20, 200), deadline=None)
@given(st.integers(0, 10**6))
def test_nearest_places_of_segments(seed: int) -> None:
    """Also of points, and of segments that are parallel."""
    rng = np.random.default_rng(seed)
    a, b, u, v = rng.uniform(-1, 1, (4, 20, 3))
    u[:3], v[2:5], v[5:8] = 0.0, 0.0, u[5:8] * 1.7
    s, t = nearest(a, u, b, v)
    assert ((s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)).all()
    own = np.linalg.norm(a + s[:, None] * u - b - t[:, None] * v, axis=1)
    grid = np.linspace(0, 1, 21)
    every = np.linalg.norm(
        (a[:, None, None] + grid[:, None, None] * u[:, None, None])
        - (b[:, None, None] + grid[None, :, None] * v[:, None, None]), axis=3
    )  # fmt: skip
    assert (own <= every.min(axis=(1, 2)) + 1e-12).all()
    ends = [shapely.LineString([x, x + w]) for x, w in ((a[9, :2], u[9, :2]), (b[9, :2], v[9, :2]))]
    flat = nearest(a[9:10, :2], u[9:10, :2], b[9:10, :2], v[9:10, :2])
    gap = np.linalg.norm(a[9, :2] + flat[0][0] * u[9, :2] - b[9, :2] - flat[1][0] * v[9, :2])
    assert gap == pytest.approx(ends[0].distance(ends[1]), abs=1e-12)
