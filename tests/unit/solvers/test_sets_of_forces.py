"""Forces that a pair may have beside others: its cone, or the ray of a slip, against the nearest of many points."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from concio.problem.cone import Cone
from concio.solvers.states.redundant_forces import _least, _Sets


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e4])
def test_a_force_is_put_on_the_nearest_place_of_the_ray_of_its_slip(d: int, unit: float) -> None:
    """Friction opposes the slip with c + mu t_n, from t_n = -T up to the cap N."""
    rng = np.random.default_rng(d)
    m = 40
    friction, tension = rng.uniform(0.2, 1.0, m), unit * rng.uniform(0.5, 2.0, m)
    cohesion = friction * tension + unit * rng.uniform(0.1, 3.0, m)
    cap = unit * rng.uniform(3.0, 9.0, m)
    cap[::4] = np.inf
    cone = Cone(friction, cohesion, tension, cap)
    direction = rng.normal(size=(m, d - 1))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    sets = _Sets(cone, np.ones(m, dtype=bool), direction, np.ones(m, dtype=bool))
    w = unit * rng.uniform(-12.0, 12.0, (m, d))
    found, J = sets.project(w)
    for k in range(m):
        most = cap[k] if np.isfinite(cap[k]) else 60.0 * unit
        t_n = np.linspace(-tension[k], most, 40_001)
        on = np.column_stack([t_n, -(cohesion[k] + friction[k] * t_n)[:, None] * direction[k]])
        away = np.linalg.norm(on - w[k], axis=1)
        assert np.linalg.norm(found[k] - w[k]) <= away.min() * (1 + 1e-12)
        assert found[k] == pytest.approx(on[away.argmin()], abs=5e-3 * unit)
        assert found[k, 0] <= cap[k] * (1 + 1e-12)
    step = 1e-6 * unit
    for i in range(d):
        beside = w.copy()
        beside[:, i] += step
        slope = (sets.project(beside)[0] - found) / step
        assert slope == pytest.approx(J[:, :, i], abs=1e-6)
    along = np.column_stack([np.ones(m), -friction[:, None] * direction])
    along /= np.linalg.norm(along, axis=1)[:, None]
    assert sets.spanned == pytest.approx(along[:, :, None] * along[:, None, :])


def test_pairs_that_do_not_slip_have_their_cone_and_smooth_ones_their_normal_alone() -> None:
    cone = Cone(np.full(2, 0.5), np.zeros(2), np.zeros(2), np.full(2, np.inf))
    sets = _Sets(cone, np.zeros(2, dtype=bool), np.zeros((2, 1)), np.array([True, False]))
    found, J = sets.project(np.array([[2.0, 0.7], [2.0, 0.7]]))
    assert found == pytest.approx(np.array([[2.0, 0.7], [2.0, 0.0]]))
    own = np.array([np.eye(2), np.diag([1.0, 0.0])])
    np.testing.assert_allclose(J, own, atol=1e-15)
    np.testing.assert_allclose(sets.spanned, own, atol=1e-15)


def _room(x: np.ndarray) -> np.ndarray:
    """Return what is left to the cones of a friction of 0.4 of five forces, smooth where there is no shear."""
    t = x.reshape(5, -1)
    return np.asarray(0.4 * t[:, 0] - np.sqrt((t[:, 1:] ** 2).sum(1) + 1e-16))


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e4])
def test_least_forces_have_the_resultants_given_to_rounding_and_are_the_nearest_of_all(d: int, unit: float) -> None:
    """Of forces inside their cones a linear system says which are nearest; others are beside what SLSQP finds."""
    rng = np.random.default_rng(10 + d)
    c, n = 5, 2 * d
    C = rng.normal(size=(c * d, n))
    share = rng.uniform(0.3, 3.0, c)
    weights = np.repeat(share, d)
    rough, slips, none = np.ones(c, dtype=bool), np.zeros(c, dtype=bool), np.zeros((c, d - 1))
    for friction, binding in ((50.0, False), (0.4, True)):
        cone = Cone(np.full(c, friction), np.zeros(c), np.zeros(c), np.full(c, np.inf))
        given = unit * np.column_stack([rng.uniform(2.0, 4.0, c), 0.3 * rng.normal(size=(c, d - 1))])
        middle = given + unit * 0.3 * rng.normal(size=given.shape) if not binding else np.zeros_like(given)
        given = cone.project(given)
        found = _least(C, _Sets(cone, slips, none, rough), share, given, middle, 4.0 * unit)
        assert found is not None
        assert np.abs(C.T @ (found - given).ravel()).max() <= 1e-13 * 4.0 * unit
        assert np.abs(cone.project(found) - found).max() <= 1e-13 * unit
        if not binding:
            pull = np.linalg.solve(C.T @ (weights[:, None] * C), C.T @ (given - middle).ravel())
            nearest = (middle.ravel() + weights * (C @ pull)).reshape(c, d)
            assert np.abs(cone.project(nearest) - nearest).max() == 0.0
            assert found == pytest.approx(nearest, abs=1e-11 * unit)
            continue

        wanted = C.T @ given.ravel() / unit
        inside = {"type": "ineq", "fun": _room}
        held = {"type": "eq", "fun": lambda x, wanted=wanted: C.T @ x - wanted}
        begin, laws = given.ravel() / unit, [inside, held]
        other = minimize(lambda x: (x**2 / weights).sum(), begin, method="SLSQP", constraints=laws, tol=1e-12)
        assert other.success
        assert found.ravel() / unit == pytest.approx(other.x, abs=1e-4)
        assert (found.ravel() ** 2 / weights).sum() / unit**2 <= other.fun * (1 + 1e-7)
