"""Forces that a pair may have beside others: its cone, or the ray of a slip, against the nearest of many points."""

from __future__ import annotations

import numpy as np
import pytest

from concio.problem.cone import Cone
from concio.solvers.states.redundant_forces import _Sets


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
