"""Frames, rigid motions, exact moments: against closed forms, against each other, and far from the origin."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from concio.kinematics.frames import cross, tangents, turned, turned_left, turned_right, turning
from concio.kinematics.mass import polygon_moments, polyhedron_moments, signed_area
from concio.kinematics.rigid import (
    motions,
    plane_rotation,
    rigid_modes,
    rigid_operator,
    rigid_row,
    rotation_matrix,
    swept,
)

RNG = np.random.default_rng(20)
BOX = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
"""Faces of a hexahedron, counter-clockwise seen from outside."""


def cuboid(a, b, c):
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
    return corners * np.array([a, b, c], dtype=float)


def test_left_of_x_is_y():
    np.testing.assert_array_equal(turned_left(np.array([1.0, 0.0])), [0.0, 1.0])
    v = RNG.normal(size=(4, 3, 2))
    np.testing.assert_array_equal(turned_right(turned_left(v)), v)
    np.testing.assert_allclose(turned_left(v), np.einsum("ij,abj->abi", [[0.0, -1.0], [1.0, 0.0]], v))


def test_cross_products_of_plane_and_space_agree():
    p, q = RNG.normal(size=(2, 7, 3))
    np.testing.assert_allclose(cross(p, q), np.cross(p, q), atol=1e-15)
    flat = np.zeros(3), np.zeros(3)
    flat[0][:2], flat[1][:2] = p[0, :2], q[0, :2]
    assert cross(p[0, :2], q[0, :2]) == pytest.approx(np.cross(*flat)[2])


def test_turning_is_positive_to_the_left():
    assert turning(np.array([1.0, 0.0]), np.array([1.0, 1.0])) == pytest.approx(np.pi / 4)
    assert turning(np.array([1.0, 0.0]), np.array([1.0, -1.0])) == pytest.approx(-np.pi / 4)


def test_frames_are_orthonormal_and_right_handed():
    n = RNG.normal(size=(50, 3))
    n /= np.linalg.norm(n, axis=1)[:, None]
    n = np.vstack([n, np.eye(3), -np.eye(3), [[1e-9, 0.0, 1.0]]])
    t = tangents(n)
    frame = np.concatenate([n[:, None], t], axis=1)
    np.testing.assert_allclose(frame @ frame.transpose(0, 2, 1), np.broadcast_to(np.eye(3), frame.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0)
    steep = np.abs(n[:, 2]) < 1 - 1e-6
    assert np.abs(t[steep, 0, 2]).max() < 1e-15  # horizontal
    assert (t[steep, 1, 2] > 0).all()  # up
    np.testing.assert_allclose(tangents(np.array([1.0, 0.0, 0.0])), [[0, 1, 0], [0, 0, 1]])
    plan = n[steep][:, :2] / np.hypot(*n[steep, :2].T)[:, None]
    np.testing.assert_allclose(t[steep, 0, :2], turned_left(plan), atol=1e-12)
    np.testing.assert_array_equal(tangents(np.array([0.0, 1.0])), [[-1.0, 0.0]])


@pytest.mark.parametrize("dim", [2, 3])
def test_rigid_operator_is_the_small_rotation(dim):
    arm, reach = RNG.normal(size=(5, dim)), RNG.uniform(0.3, 2.0, 5)
    motion = 1e-8 * RNG.normal(size=(5, motions(dim)))
    rotation = motion[:, dim:] / reach[:, None]
    rotation = rotation[:, 0] if dim == 2 else rotation
    turn = plane_rotation(rotation) if dim == 2 else rotation_matrix(rotation)
    moved = motion[:, :dim] + np.einsum("kij,kj->ki", turn, arm) - arm
    operator = rigid_operator(arm, reach)
    assert operator.shape == (5, dim, motions(dim))
    np.testing.assert_allclose(np.einsum("kij,kj->ki", operator, motion), moved, atol=1e-13)
    np.testing.assert_allclose(motion[:, :dim] + swept(rotation, arm), moved, atol=1e-13)
    direction = RNG.normal(size=(5, dim))
    np.testing.assert_allclose(
        (rigid_row(direction, arm, reach) * motion).sum(1), (direction * moved).sum(1), atol=1e-13
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_rigid_operators_of_one_point_and_of_points_in_a_grid(dim):
    rng = np.random.default_rng(dim)
    arm, reach = rng.normal(size=(2, 4, dim)), rng.uniform(0.3, 2.0, (2, 4))
    grid = rigid_operator(arm, reach)
    assert grid.shape == (2, 4, dim, motions(dim))
    for place in np.ndindex(2, 4):
        one = rigid_operator(arm[place], reach[place])
        assert one.shape == (dim, motions(dim))
        np.testing.assert_array_equal(one, grid[place])


@pytest.mark.parametrize("dim", [2, 3])
def test_rigid_modes_are_orthonormal_and_span_every_rigid_motion(dim):
    points = RNG.normal(size=(9, dim)) + 100.0
    modes = rigid_modes(points)
    np.testing.assert_allclose(modes.T @ modes, np.eye(motions(dim)), atol=1e-12)
    any_motion = rigid_operator(points, 1.0).reshape(-1, motions(dim)) @ RNG.normal(size=motions(dim))
    np.testing.assert_allclose(modes @ (modes.T @ any_motion), any_motion, atol=1e-9)


def test_finite_rotations():
    theta = np.array([0.3, -1.2, 0.7])
    angle, axis = np.linalg.norm(theta), theta / np.linalg.norm(theta)
    Q = rotation_matrix(theta)
    np.testing.assert_allclose(Q @ Q.T, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(Q @ axis, axis, atol=1e-15)
    assert np.trace(Q) == pytest.approx(1 + 2 * np.cos(angle))
    np.testing.assert_allclose(rotation_matrix(np.array([0.0, 0.0, 0.4]))[:2, :2], plane_rotation(0.4), atol=1e-15)
    np.testing.assert_allclose(plane_rotation(np.pi / 2) @ [1.0, 0.0], [0.0, 1.0], atol=1e-15)
    angles, v = np.array([0.4, -1.1, 2.9]), np.array([[3.0, 1.0], [-0.5, 2.0], [0.1, -0.7]])
    np.testing.assert_allclose(turned(v, angles), np.einsum("kij,kj->ki", plane_rotation(angles), v), atol=1e-15)
    np.testing.assert_allclose(turning(v, turned(v, angles)), angles, atol=1e-15)
    np.testing.assert_array_equal(rotation_matrix(np.zeros((2, 3))), np.broadcast_to(np.eye(3), (2, 3, 3)))


def test_rectangle_far_from_the_origin():
    a, b = 3.0, 1.0
    ring = np.array([(0, 0), (a, 0), (a, b), (0, b)]) + np.array([1e6, -2e6])
    m = polygon_moments(ring)
    assert m.measure == pytest.approx(a * b, rel=1e-9)
    np.testing.assert_allclose(m.centroid, [1e6 + a / 2, -2e6 + b / 2], rtol=1e-15)
    np.testing.assert_allclose(m.second, np.diag([a**3 * b / 12, a * b**3 / 12]), rtol=1e-8, atol=1e-8)
    assert m.radius_of_gyration == pytest.approx(np.sqrt((a**2 + b**2) / 12), rel=1e-9)
    assert signed_area(ring[::-1]) == pytest.approx(-a * b, rel=1e-9)
    assert polygon_moments(ring[::-1]).measure == pytest.approx(a * b, rel=1e-9)


def test_frame_with_a_hole_off_centre():
    outer = np.array([(0, 0), (4, 0), (4, 3), (0, 3)], dtype=float)
    hole = np.array([(0.5, 1), (2, 1), (2, 2.5), (0.5, 2.5)])
    whole, gone = polygon_moments(outer), polygon_moments(hole)
    for ring in (hole, hole[::-1]):
        m = polygon_moments(outer, [ring])
        assert m.measure == pytest.approx(12 - 2.25)
        centroid = (12 * whole.centroid - 2.25 * gone.centroid) / (12 - 2.25)
        np.testing.assert_allclose(m.centroid, centroid)
        shift_w, shift_g = whole.centroid - centroid, gone.centroid - centroid
        second = whole.second + 12 * np.outer(shift_w, shift_w) - gone.second - 2.25 * np.outer(shift_g, shift_g)
        np.testing.assert_allclose(m.second, second)


def test_concave_polygon_by_integration():
    ring = np.array([(0, 0), (5, 0), (5, 1), (2, 1), (2, 4), (0, 3)], dtype=float)
    points, weights = np.polynomial.legendre.leggauss(4)
    area, first, second = 0.0, np.zeros(2), np.zeros((2, 2))
    for i in range(1, len(ring) - 1):  # a fan of triangles, each mapped from the square
        p, q, r = ring[0], ring[i], ring[i + 1]
        det = cross(q - p, r - p)
        for s, ws in zip(points, weights, strict=True):
            for t, wt in zip(points, weights, strict=True):
                u, v = (1 + s) / 2, (1 + t) / 2
                x = p + u * (q - p) + u * v * (r - q)
                w = ws * wt / 4 * u * det
                area, first, second = area + w, first + w * x, second + w * np.outer(x, x)
    m = polygon_moments(ring)
    assert m.measure == pytest.approx(area)
    np.testing.assert_allclose(m.centroid, first / area)
    np.testing.assert_allclose(m.second, second - np.outer(first, first) / area)


def test_cuboid():
    a, b, c = 0.5, 1.5, 0.7
    m = polyhedron_moments(cuboid(a, b, c) + 3.0, BOX)
    assert m.measure == pytest.approx(a * b * c)
    np.testing.assert_allclose(m.centroid, np.array([a, b, c]) / 2 + 3.0)
    inertia = a * b * c / 12 * np.diag([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    np.testing.assert_allclose(m.inertia, inertia, atol=1e-14)
    assert m.radius_of_gyration == pytest.approx(np.sqrt((a**2 + b**2 + c**2) / 18))


def test_inertia_turns_with_the_body():
    Q = rotation_matrix(np.array([0.4, 1.1, -0.6]))
    points = RNG.normal(size=(12, 3))
    hull = ConvexHull(points)
    faces = []
    for triangle, plane in zip(hull.simplices, hull.equations, strict=True):
        p, q, r = points[triangle]
        faces.append(triangle if np.cross(q - p, r - p) @ plane[:3] > 0 else triangle[::-1])
    m, turned = polyhedron_moments(points, faces), polyhedron_moments(points @ Q.T, faces)
    assert m.measure == pytest.approx(hull.volume)
    np.testing.assert_allclose(turned.second, Q @ m.second @ Q.T)
    np.testing.assert_allclose(turned.centroid, Q @ m.centroid)


def test_regular_tetrahedron():
    """Edge s: volume s^3 / (6 sqrt 2), every principal moment m s^2 / 20."""
    s = 2.0
    points = s / np.sqrt(8) * np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], dtype=float)
    m = polyhedron_moments(points, [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)])
    assert m.measure == pytest.approx(s**3 / (6 * np.sqrt(2)))
    np.testing.assert_allclose(m.inertia, m.measure * s**2 / 20 * np.eye(3), atol=1e-14)
