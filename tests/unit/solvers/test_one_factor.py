"""Steps in space with one factorisation: the motion is that of factorising in every round."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.motion import stepper
from concio.solvers.algebra.minimal_residuals import minimal_residuals
from motion_models import G
from space_motions import blocks

BRICK = np.array([0.2, 0.1, 0.06])


def wall(courses: int, along: int) -> concio.Model:
    pitch = BRICK[0] + 0.01
    low = [((k + 0.45 * (c % 2)) * pitch, 0.0, c * BRICK[2]) for c in range(courses) for k in range(along)]
    return blocks(*((at, tuple(np.array(at) + BRICK)) for at in low))


def shaken(model: concio.Model) -> concio.DynamicsResult:
    ground = {name: concio.Pulse("sine", 0.9 * G, length, cycles=20.0) for name, length in (("x", 0.05), ("y", 0.07))}
    return concio.dynamics(model, ground, duration=0.03, step=2e-3, stop_overturned=False)


@pytest.mark.long
def test_a_wall_that_slides_moves_as_with_factors_of_every_round(monkeypatch):
    model = wall(7, 14)
    one = shaken(model)
    monkeypatch.setattr(stepper, "LARGE", np.inf)
    every = shaken(model)
    moved = np.abs(one.end.centre - one.reference.disc.centroids).max()
    assert moved > 1e-3
    np.testing.assert_allclose(one.end.centre, every.end.centre, atol=1e-9 * moved)
    np.testing.assert_allclose(one.end.velocity, every.end.velocity, atol=1e-9)
    assert one.steps.residual.max() <= 1e-9
    assert one.energy.error <= 1e-10
    assert np.median(one.steps.factorisations) <= 2 < 4 <= np.median(every.steps.factorisations)


@pytest.mark.parametrize("rank", [0, 1, 5])
def test_minimal_residuals_need_an_iteration_for_each_direction_that_has_changed(rank):
    rng = np.random.default_rng(rank)
    F = np.diag(rng.uniform(1.0, 2.0, 60))
    E = rng.normal(size=(60, rank)) @ rng.normal(size=(rank, 60))
    b = rng.normal(size=60)
    x, spent = minimal_residuals(lambda v: np.linalg.solve(F, v), lambda v: E @ v, b, 1e-12, 30)
    np.testing.assert_allclose((F + E) @ x, b, atol=1e-10)
    assert spent == rank + 1


def test_minimal_residuals_of_nothing_are_nothing():
    x, spent = minimal_residuals(lambda v: v, lambda v: v, np.zeros(4), 1e-3, 5)
    assert not x.any()
    assert spent == 0
