"""The cone: return map and its derivative, support function, strength and excess, other ways to read it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from concio.problem.cone import Cone

number = st.floats(-5.0, 5.0).map(lambda v: round(v, 3))


@st.composite
def cones(draw: st.DrawFn) -> Cone:
    mu = draw(st.floats(0.0, 1.5))
    tension = draw(st.sampled_from([0.0, 0.0, 0.4]))
    cohesion = mu * tension + draw(st.sampled_from([0.0, 0.0, 0.7]))
    upper = draw(st.sampled_from([np.inf, 2.0]))
    return Cone(np.array([mu]), np.array([cohesion]), np.array([tension]), np.array([upper]))


def points_of(cone: Cone, d: int) -> np.ndarray:
    """A cloud of points of the strength domain, with its corners."""
    rng = np.random.default_rng(1)
    t_n = np.r_[-cone.tension, np.minimum(cone.cap, 40.0), rng.uniform(-cone.tension[0], min(cone.cap[0], 8.0), 60)]
    direction = rng.normal(size=(t_n.size, d - 1))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    radius = cone.cohesion + cone.friction * t_n
    sizes = (1.0, -1.0, 0.3)
    return np.concatenate([np.column_stack([t_n, size * radius[:, None] * direction]) for size in sizes])


@pytest.mark.parametrize("d", [2, 3])
@given(cone=cones(), w=st.tuples(number, number, number))
def test_flow_equal_to_friction_is_the_euclidean_projection(d: int, cone: Cone, w: tuple[float, ...]) -> None:
    trial = np.array([w[:d]])
    t = cone.project(trial)[0]
    assert -cone.tension[0] - 1e-12 <= t[0] <= cone.cap[0] + 1e-12
    assert np.linalg.norm(t[1:]) <= cone.cohesion[0] + cone.friction[0] * t[0] + 1e-12
    products = (points_of(cone, d) - t) @ (trial[0] - t)  # the variational inequality of a projection
    assert products.max() <= 1e-9


@given(cone=cones(), w=st.tuples(number, number), dilatancy=st.floats(0.0, 1.0))
def test_fixed_points_are_the_joint_law(cone: Cone, w: tuple[float, ...], dilatancy: float) -> None:
    t = cone.project(np.array([w]), dilatancy)[0]
    gap, slip = t[0] - w[0], t[1] - w[1]  # y = t - w: then t is the map of t - y
    strength = cone.cohesion[0] + cone.friction[0] * t[0]
    opening = gap - dilatancy * abs(slip)
    if t[0] > -cone.tension[0] + 1e-9:
        assert opening <= 1e-9  # closed, or crushed
    if t[0] < cone.cap[0] - 1e-9:
        assert opening >= -1e-9
    if abs(slip) > 1e-9:
        assert t[1] == pytest.approx(-strength * np.sign(slip), abs=1e-9)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("kappa", [0.0, 0.3, 0.6])
def test_derivative_against_differences(d: int, kappa: float) -> None:
    rng = np.random.default_rng(0)
    m = 200
    cone = Cone(np.full(m, 0.6), np.full(m, 0.2), np.full(m, 0.1), np.full(m, 1.5))
    w = rng.normal(size=(m, d)) * 2.0
    jacobian = cone.derivative(w, kappa)
    h = 1e-7
    for j in range(d):
        step = np.zeros(d)
        step[j] = h
        slope = (cone.project(w + step, kappa) - cone.project(w - step, kappa)) / (2 * h)
        np.testing.assert_allclose(jacobian[:, :, j], slope, atol=1e-6)


@pytest.mark.parametrize("d", [2, 3])
@given(cone=cones(), w=st.tuples(number, number, number))
def test_absorbed_power_is_the_support_function(d: int, cone: Cone, w: tuple[float, ...]) -> None:
    velocity = np.array(w[:d])
    w_n, speed = velocity[:1], np.linalg.norm(velocity[1:], keepdims=True)
    if cone.lift(w_n, speed)[0] < 0 and not cone.capped[0]:
        return  # no bound
    points = points_of(cone, d)
    if d == 3:  # the direction that matters, exactly
        t_n = np.r_[-cone.tension, np.minimum(cone.cap, 40.0)]
        ends = cone[np.zeros(2, dtype=int)].opposing(t_n, np.tile(velocity[1:], (2, 1)))
        points = np.vstack([points, np.column_stack([t_n, ends])])
    power = -(points @ velocity)
    h = cone.absorbed_power(w_n, speed)[0]
    assert power.max() <= h + 1e-9
    assert power.max() >= h - 1e-9


def test_strength_excess_and_opposition() -> None:
    numbers = [[0.5, 0.5, 0.0], [1.0, 1.0, 0.0], [0.5, 0.5, 0.0], [np.inf, 3.0, np.inf]]
    cone = Cone(*(np.array(row) for row in numbers))
    np.testing.assert_allclose(cone.strength(np.array([2.0, -4.0, 1.0])), [2.0, 0.0, 0.0])
    np.testing.assert_allclose(cone.spare, [0.75, 0.75, 0.0])
    np.testing.assert_array_equal(cone.rough, [True, True, False])
    t_t = np.array([[3.0, 4.0], [0.3, 0.4], [0.0, 0.2]])
    np.testing.assert_allclose(cone.excess(np.array([2.0, 3.5, 1.0]), t_t), [3.0, 0.5, 0.2])
    np.testing.assert_allclose(cone.excess(np.array([2.0, -0.75, 1.0]), np.zeros((3, 2))), [0.0, 0.25, 0.0])
    slip = np.array([[0.0, -2.0], [0.0, 0.0], [1.0, 0.0]])
    np.testing.assert_allclose(cone.opposing(np.array([2.0, 3.0, 1.0]), slip), [[0.0, 2.0], [0.0, 0.0], [0.0, 0.0]])


@given(cone=cones(), w=st.tuples(number, number, number))
def test_other_readings_are_the_same_set(cone: Cone, w: tuple[float, ...]) -> None:
    """The projection moves with the shift by T and with the unit of force."""
    trial = np.array([w])
    shift = np.column_stack([cone.tension, [0.0], [0.0]])
    there = cone.shifted.project(trial + shift, 0.3) - shift
    np.testing.assert_allclose(there, cone.project(trial, 0.3), atol=1e-12)
    np.testing.assert_allclose(4.0 * cone.in_units(4.0).project(trial / 4.0), cone.project(trial), atol=1e-12)
    assert cone.shifted.tension[0] == 0.0
