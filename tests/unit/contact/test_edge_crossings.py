"""Where two edges in space come nearest to each other: against the closest points of two lines, found by minimising."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from concio.contact.solid_touch import Crossing


def crossed(
    s: float, u: float, long_a: float, long_b: float, gap: float, angle: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return ends (1, 2, 2, 3) of two edges, turned and moved, whose lines come nearest at shares s and u of them."""
    d_a = np.array([1.0, 0.0, 0.0])
    d_b = np.array([np.cos(angle), np.sin(angle), 0.0])
    up = np.array([0.0, 0.0, np.sign(np.sin(angle))])  # the way of d_a x d_b
    p_a, p_b = -s * long_a * d_a, gap * up - u * long_b * d_b
    ends = np.array([[[p_a, p_a + long_a * d_a], [p_b, p_b + long_b * d_b]]])
    turn, shift = Rotation.random(random_state=rng.integers(1000)), rng.normal(size=3)
    return turn.apply(ends.reshape(-1, 3)).reshape(ends.shape) + shift, turn.apply(up), shift


@pytest.mark.parametrize("unit", [1e-3, 1.0, 50.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("s", "u", "beyond"),
    [(0.5, 0.25, -0.75), (-0.1, 0.5, 0.2), (1.2, 0.5, 0.4), (0.5, -0.3, 0.9), (0.5, 1.1, 0.3), (1.2, 1.1, 0.4)],
)
def test_edges_cross_at_the_nearest_points_of_their_lines(
    s: float, u: float, beyond: float, sign: float, unit: float
) -> None:
    """Edges of 2 and 3 units; how far beyond an end they cross is a length: -0.75 is a quarter of the longer one."""
    rng = np.random.default_rng(7)
    ends, up, shift = crossed(s, u, 2.0 * unit, 3.0 * unit, 0.2 * unit, 1.1, rng)
    found = Crossing.of(ends, np.array([sign]))
    assert found.gap == pytest.approx([sign * 0.2 * unit])
    assert found.beyond == pytest.approx([unit * beyond], rel=1e-9)
    assert found.point[0] == pytest.approx(shift + 0.1 * unit * up, abs=1e-12 + 1e-9 * unit)
    normal, tangent, other = found.frame[0]
    assert normal == pytest.approx(sign * up)
    assert tangent == pytest.approx((ends[0, 0, 1] - ends[0, 0, 0]) / (2.0 * unit))
    assert np.cross(normal, tangent) == pytest.approx(other)


def test_parallel_edges_cross_nowhere() -> None:
    ends = np.array([[[(0.0, 0, 0), (1.0, 0, 0)], [(0.2, 0, 0.1), (3.0, 0, 0.1)]]])
    assert np.isinf(Crossing.of(ends, np.ones(1)).beyond[0])
