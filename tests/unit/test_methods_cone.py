"""The return map: projection where it should be one, Coulomb where not, and its derivative."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from concio.problem.cone import Cone, return_map, return_map_derivative

number = st.floats(-5.0, 5.0).map(lambda v: round(v, 3))


@st.composite
def cones(draw: st.DrawFn) -> Cone:
    mu = draw(st.floats(0.0, 1.5))
    tension = draw(st.sampled_from([0.0, 0.0, 0.4]))
    cohesion = mu * tension + draw(st.sampled_from([0.0, 0.0, 0.7]))
    upper = draw(st.sampled_from([np.inf, 2.0]))
    return Cone(np.array([mu]), np.array([cohesion]), np.array([-tension]), np.array([upper]))


def points_of(cone: Cone, d: int) -> np.ndarray:
    """A cloud of points of the strength domain, with its corners."""
    rng = np.random.default_rng(1)
    t_n = np.r_[cone.lower, np.minimum(cone.upper, 40.0), rng.uniform(cone.lower[0], min(cone.upper[0], 8.0), 60)]
    direction = rng.normal(size=(t_n.size, d - 1))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    radius = cone.cohesion + cone.friction * t_n
    sizes = (1.0, -1.0, 0.3)
    return np.concatenate([np.column_stack([t_n, size * radius[:, None] * direction]) for size in sizes])


@pytest.mark.parametrize("d", [2, 3])
@given(cone=cones(), w=st.tuples(number, number, number))
def test_flow_equal_to_friction_is_the_euclidean_projection(d: int, cone: Cone, w: tuple[float, ...]) -> None:
    trial = np.array([w[:d]])
    t = return_map(cone, trial, cone.friction)[0]
    assert cone.lower[0] - 1e-12 <= t[0] <= cone.upper[0] + 1e-12
    assert np.linalg.norm(t[1:]) <= cone.cohesion[0] + cone.friction[0] * t[0] + 1e-12
    products = (points_of(cone, d) - t) @ (trial[0] - t)  # the variational inequality of a projection
    assert products.max() <= 1e-9


@given(cone=cones(), w=st.tuples(number, number), dilatancy=st.floats(0.0, 1.0))
def test_fixed_points_are_the_joint_law(cone: Cone, w: tuple[float, ...], dilatancy: float) -> None:
    t = return_map(cone, np.array([w]), dilatancy)[0]
    gap, slip = t[0] - w[0], t[1] - w[1]  # y = t - w: then t is the map of t - y
    strength = cone.cohesion[0] + cone.friction[0] * t[0]
    opening = gap - dilatancy * abs(slip)
    if t[0] > cone.lower[0] + 1e-9:
        assert opening <= 1e-9  # closed, or crushed
    if t[0] < cone.upper[0] - 1e-9:
        assert opening >= -1e-9
    if abs(slip) > 1e-9:
        assert t[1] == pytest.approx(-strength * np.sign(slip), abs=1e-9)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("kappa", [0.0, 0.3, 0.6])
def test_derivative_against_differences(d: int, kappa: float) -> None:
    rng = np.random.default_rng(0)
    m = 200
    cone = Cone(np.full(m, 0.6), np.full(m, 0.2), np.full(m, -0.1), np.full(m, 1.5))
    w = rng.normal(size=(m, d)) * 2.0
    jacobian = return_map_derivative(cone, w, kappa)
    h = 1e-7
    for j in range(d):
        step = np.zeros(d)
        step[j] = h
        slope = (return_map(cone, w + step, kappa) - return_map(cone, w - step, kappa)) / (2 * h)
        np.testing.assert_allclose(jacobian[:, :, j], slope, atol=1e-6)
