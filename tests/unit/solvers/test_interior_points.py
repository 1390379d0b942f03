"""Points of the interior point method: strictly inside every cone, and the flow rule of its homotopy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from concio.problem.contact_problem import ContactProblem, Laws
from concio.solvers.algebra.scaled import Scaled, scale
from concio.solvers.interior.interior_point import InteriorPoint, Stopping
from concio.solvers.interior.point import Point
from contact_problems import wall
from space_problems import wall as wall_in_space


def problem(d: int) -> ContactProblem:
    """Return a small wall with pairs that are smooth, capped, cohesive with and without friction, and dilatant."""
    found = wall(2, 2, alpha=0.1) if d == 2 else wall_in_space(2, 2).at(0.1)
    m, rng = found.pairs, np.random.default_rng(d)
    size = float(np.abs(found.f).sum()) / m
    friction = np.where(np.arange(m) % 4 == 0, 0.0, rng.uniform(0.3, 0.9, m))
    cohesion = np.where(np.arange(m) % 4 == 1, 0.5 * size, 0.0)
    cohesion[::8] = size  # and no friction
    tension = 0.3 * cohesion
    cap = np.where(np.arange(m) % 3 == 0, 5.0 * size * rng.uniform(0.5, 1.5, m), np.inf)
    laws = Laws(friction, cohesion, tension, 0.5 * friction, np.zeros(m), np.zeros(m), cap)
    return replace(found, laws=laws)


def is_inside(s: Scaled, z: Point) -> bool:
    """Return whether forces and slips are strictly inside their cones, gaps and crushing positive."""
    t_n, t_t = z.t[:, 0], np.linalg.norm(z.t[:, 1:], axis=1)
    rough = s.cone.friction * t_n + s.cone.spare > 0
    own = bool((z.eta > 0).all()) if s.dim == 2 else bool((z.eta[:, 0] > np.linalg.norm(z.eta[:, 1:], axis=1)).all())
    return (
        own and bool((t_n > 0).all()) and bool((t_n < s.cone.cap).all()) and bool((z.y_n > 0).all())
        and bool((z.p > 0).all()) and bool((t_t < s.cone.friction * t_n + s.cone.spare)[rough].all())
        and not t_t[~rough].any()
    )  # fmt: skip


@pytest.mark.parametrize("d", [2, 3])
def test_a_run_begins_strictly_inside_at_any_size(d: int) -> None:
    s = scale(problem(d))
    engine = InteriorPoint(s)
    for force, length in ((10.0, 10.0), (1e-6, 1e3), (1e6, 1e-3)):
        assert is_inside(s, engine.start(force, length))


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("size", [0.0, 1e-3, 1.0, 1e3])
def test_a_run_from_nearby_begins_strictly_inside_and_keeps_what_it_may(d: int, size: float) -> None:
    """Forces on their cones or in them, gaps of either sign, slips of any size."""
    s = scale(problem(d))
    rng = np.random.default_rng(5)
    t = s.cone.project(size * rng.normal(size=s.x.shape))
    t[~s.rough, 1:] = 0.0
    u = size * rng.normal(size=len(s.f))
    z = InteriorPoint(s).near(u, t)
    assert is_inside(s, z)
    np.testing.assert_array_equal(z.u, u)
    free, rubs = ~s.cone.capped, s.cone.friction > 0.1
    assert z.t[free, 0] == pytest.approx(t[free, 0] + 1.0)
    assert z.t[free & rubs, 1:] == pytest.approx(t[free & rubs, 1:], rel=1e-12)  # friction is as it was
    assert (np.linalg.norm(z.t[:, 1:], axis=1) <= np.linalg.norm(t[:, 1:], axis=1) * (1 + 1e-12)).all()
    cap = s.cone.cap[~free]
    assert z.t[~free, 0] == pytest.approx(np.minimum(t[~free, 0] + 1.0, np.maximum(cap - 1.0, 0.5 * cap)))
    assert z.y_n == pytest.approx(np.maximum(s.position(u, t)[:, 0], 0.0) + 1.0)
    if d == 3:  # where runs begin so
        assert InteriorPoint(s).run(z)[1].converged  # from pairs that are crushed, too


@pytest.mark.parametrize("d", [2, 3])
def test_the_homotopy_goes_from_the_own_dilatancy_to_that_of_associated_flow(d: int) -> None:
    s = scale(problem(d))
    engine = InteriorPoint(s)
    assert s.dilatancy[s.rough].max() > 0
    np.testing.assert_array_equal(engine.dilatancy(0.0), s.dilatancy)
    assert engine.dilatancy(1.0) == pytest.approx(np.where(s.rough, s.cone.friction, 0.0))
    assert engine.dilatancy(0.3) == pytest.approx(0.7 * engine.dilatancy(0.0) + 0.3 * engine.dilatancy(1.0))


def test_a_run_ends_where_it_has_no_progress_or_runs_away() -> None:
    """A tenth is progress: 25 iterations without from afar, six close by; eight short steps in a row; growth."""
    for first, patience in ((1.0, 25), (1e-5, 6)):
        stopping = Stopping(100)
        assert stopping.improved(first)
        told = []
        for k in range(40):
            assert not stopping.improved(0.95 * first)
            told.append(stopping.reason(k, first, 0.5))
            if told[-1]:
                break
        assert told == (patience - 1) * [""] + ["no progress"]
        assert stopping.improved(0.8 * first)
        assert stopping.reason(41, 0.8 * first, 0.5) == ""
    stopping = Stopping(100)
    stopping.improved(1.0)
    steps = [0.01] * 7 + [0.1] + [0.01] * 8
    assert [stopping.reason(k, 1.0, step) for k, step in enumerate(steps)] == 15 * [""] + ["steps became short"]
    stopping = Stopping(3)
    assert stopping.improved(1e-5)
    assert stopping.reason(0, 0.9e-3, 1.0) == ""
    assert stopping.reason(0, 1.1e-3, 1.0) == "diverged"
    assert stopping.reason(3, 1e-5, 1.0) == "limit of iterations"
    impatient, patient = Stopping(100, patient=False), Stopping(100)
    for stopping in (impatient, patient):
        stopping.improved(1.0)
    steps = [0.3, 0.4, 0.2] + 6 * [0.015]
    assert [impatient.reason(k, 1.0, step) for k, step in enumerate(steps)][-3:] == ["", *2 * ["steps became short"]]
    assert [patient.reason(k, 1.0, step) for k, step in enumerate(steps)] == 9 * [""]
    close = Stopping(100, patient=False)
    close.improved(1e-3)  # closer by, eight steps count, which go 0.15 of the way together
    steps = [0.3, 0.06] + 4 * [0.021, 0.01]
    assert [close.reason(k, 1e-3, step) for k, step in enumerate(steps)] == 9 * [""] + ["steps became short"]
    far = Stopping(3)
    assert far.improved(1e-3)
    assert far.reason(0, 1e3, 1.0) == ""
