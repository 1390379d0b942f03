"""The present point of a path: what rounding has carried off its equations is put back, and nothing else is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.solvers.path.path_point import PathPoint
from concio.solvers.path.paths_apart import _turns
from path_helpers import weight_then
from rigid_walls import FERRIS_TIN_LOI, MU, wall


@pytest.fixture(scope="module")
def point() -> PathPoint:
    """Return a point inside a piece of a path, some of whose pairs slip and some are open."""
    a = wall(FERRIS_TIN_LOI["wall 3"])
    path, found = weight_then(a, MU, a.load(1, 0), compliance=1e-4, until=0.1)
    return PathPoint(path, found.states[len(found.states) // 2], 0.1, None)


def left(point: PathPoint, x: np.ndarray) -> float:
    """Return the largest residual of the equations at x, relative to their terms."""
    b = point.right_hand_side()
    return float(np.abs(b - point.equations.multiply(x)).max()) / (np.abs(x).max() + np.abs(b).max())


@pytest.mark.parametrize("off", [1e-12, 1e-10, 1e-8])
def test_a_point_off_its_equations_by_rounding_is_put_back(point: PathPoint, off: float) -> None:
    exact = point.x.copy()
    rng = np.random.default_rng(3)
    try:
        point.put_on_equations()
        assert left(point, point.x) < 1e-13
        begun = point.x.copy()
        moved = rng.normal(size=len(exact) - 1)
        point.x = begun + np.append(off * np.abs(begun).max() * moved / np.abs(moved).max(), 0.0)
        before = left(point, point.x)
        assert before > 1e-14
        point.put_on_equations()
        assert left(point, point.x) < max(1e-13, 1e-3 * before)
        assert np.abs(point.x - begun).max() <= 10 * off * np.abs(begun).max()
    finally:
        point.x = exact


def test_a_point_that_is_somewhere_else_is_left_there(point: PathPoint) -> None:
    """A few equations that are far off are no rounding: states are wrong, and what is seen later must see it."""
    exact = point.x.copy()
    try:
        point.x = exact.copy()
        point.x[0] += 1e-2 * np.abs(exact).max()
        moved = point.x.copy()
        point.put_on_equations()
        np.testing.assert_array_equal(point.x, moved)
    finally:
        point.x = exact


@pytest.mark.parametrize(
    ("loads", "turns"),
    [
        ([0.2], [0.2]), ([0.0, 0.4, 1.0], [0.0, 1.0]), ([0.0, 0.0, 0.3, 0.3, 0.5], [0.0, 0.5]),
        ([0.0, 0.7, 1.0, 1.0, 0.6, 0.3, 0.3, 0.5], [0.0, 1.0, 0.3, 0.5]),
        ([0.0, 0.5, -0.5, 0.5], [0.0, 0.5, -0.5, 0.5]), ([1.0, 0.6, 0.6, 0.8], [1.0, 0.6, 0.8]),
    ],
)  # fmt: skip
def test_a_leading_part_turns_where_its_load_does(loads: list[float], turns: list[float]) -> None:
    """It begins, turns and ends there; a load that stays is no turn."""
    assert _turns(SimpleNamespace(states=[SimpleNamespace(parameter=v) for v in loads])) == turns
