"""Corners over edges, and the accelerations that turning adds between them, by differences in time."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from concio.contact.edges import PlacedEdges
from concio.contact.touch import Toucher

NONE = np.zeros(0, dtype=int)


def toucher(corner: list[int], edge: list[int], length: list[float], slack: float = 0.0) -> Toucher:
    """Corners that start edges, over other edges; no edges face each other."""
    return Toucher(
        NONE, NONE, np.array(corner), np.array(edge), np.zeros(len(edge), dtype=int), np.ones(len(edge), dtype=int),
        np.zeros(0), np.array(length), np.zeros(0), slack, np.zeros((2, 0), dtype=bool),
    )  # fmt: skip


@pytest.mark.parametrize("turn", [0.0, 2.0])
def test_a_corner_stands_over_an_edge_between_its_ends_and_a_little_beyond(turn: float) -> None:
    """The edge runs from (1, 1) to (4, 1) with its body to its left, above it; normals point out of it, down."""
    places = [(0.8, 0.5), (0.95, 0.5), (2.0, 0.7), (4.05, 0.2), (4.2, 0.5), (3.0, 1.1)]
    R = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    start = np.array([(1.0, 1.0), *places]) @ R.T
    tangent = np.array([(1.0, 0.0)] * len(start)) @ R.T
    n = len(places)
    found = toucher(list(range(1, n + 1)), [0] * n, [3.0] * n, 0.1).touch(PlacedEdges(start, start + tangent, tangent))
    assert found.valid.tolist() == [False, True, True, True, False, True]
    assert found.gap == pytest.approx([0.5, 0.5, 0.3, 0.8, 0.5, -0.1])
    assert found.normal == pytest.approx(np.array([(0.0, -1.0)] * n) @ R.T)
    assert found.point == pytest.approx(start[1:])
    assert found.on_a.all()


@pytest.mark.parametrize("d", [2, 3])
def test_turning_adds_what_the_second_derivative_of_the_way_between_bodies_is(d: int) -> None:
    """Both bodies move on with their velocities and spins; the slave's point is seen in the frame of the master."""
    rng = np.random.default_rng(d)
    centre, velocity = rng.normal(size=(2, d)), rng.normal(size=(2, d))
    spin = rng.normal(size=2) if d == 2 else rng.normal(size=(2, 3))
    point = rng.normal(size=(2, d))
    touch = SimpleNamespace(point=point, on_a=np.array([True, False]))
    two = toucher([0, 0], [0, 0], [1.0, 1.0])

    def turned(b: int, t: float) -> np.ndarray:
        if d == 3:
            matrix: np.ndarray = Rotation.from_rotvec(t * spin[b]).as_matrix()
            return matrix
        c, s = np.cos(t * spin[b]), np.sin(t * spin[b])
        return np.array([[c, -s], [s, c]])

    def seen(k: int, t: float) -> np.ndarray:
        """Return where the point of the slave is in the frame of the master."""
        master, slave = (0, 1) if touch.on_a[k] else (1, 0)
        at = centre[slave] + t * velocity[slave] + turned(slave, t) @ (point[k] - centre[slave])
        found: np.ndarray = turned(master, t).T @ (at - centre[master] - t * velocity[master])
        return found

    h = 1e-4
    wanted = [sign * (seen(k, h) - 2 * seen(k, 0.0) + seen(k, -h)) / h**2 for k, sign in ((0, 1.0), (1, -1.0))]
    found = two.turning(touch, SimpleNamespace(centre=centre), velocity, spin)
    assert found == pytest.approx(np.array(wanted), abs=1e-5)
