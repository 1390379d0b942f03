"""Verdicts that were missing or wrong: what runs off is no answer, and what is not proven is not said."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.model.materials import Elastic
from concio.model.model import Body
from concio.problem.solution import Status
from models import box, model_of, weight


def between_walls(height, friction, **options):
    """A block 1 m long, touched by two fixed faces 1 m high and lying on nothing."""
    left, right = box("left", -0.5, 0, 0, 1, kind="fixed"), box("right", 1, 1.5, 0, 1, kind="fixed")
    return model_of(left, box("block", 0, 1, 0.2, 0.2 + height, **options), right, law=friction, loads=(weight(),))


def upright_wedge(angles, friction, mesh_size):
    """A wedge of 0.035 m2, its point up, in a notch of one fixed body that is open below: only friction holds it."""
    left, right = np.tan(np.radians(angles))
    h = np.sqrt(2 * 0.035 / (left + right))
    notch = np.array([(-1, 0.5), (-1, -h), (-left * h, -h), (0, 0), (right * h, -h), (1, -h), (1, 0.5)])
    wedge = Body("wedge", np.array([(0, 0), (-left * h, -h), (right * h, -h)]), "block", mesh_size=mesh_size)
    materials = {"block": Elastic(E=1e6, nu=0.2, unit_weight=20.0)}
    notched = Body("notch", notch, kind="fixed")
    return model_of(notched, wedge, law=friction, materials=materials, loads=(weight(),))


@pytest.mark.parametrize("height", [0.4, 0.1, 0.05, 0.01])
def test_a_rigid_block_between_smooth_walls_falls(height):
    """Displacements ran off to 8e10 m and the point counted as exact: measured against itself it was."""
    result = concio.solve(between_walls(height, 0.0, kind="rigid", material="stone"), on_failure="return")
    assert result.status is Status.NO_EQUILIBRIUM
    velocity = result.node_displacement("block", result.mechanism_velocity)
    assert velocity == pytest.approx(np.tile([0.0, -1.0], (4, 1)), abs=1e-12)


@pytest.mark.parametrize(
    ("angles", "mesh_size"),
    [((33.6367, 33.6367), 0.1), ((37.7248, 30.0603), 0.1), ((20.7675, 44.6809), 0.05), ((39.4016, 39.4016), 0.2)],
)
def test_an_elastic_wedge_in_a_notch_gets_a_verdict(angles, mesh_size):
    """Forces ran off to 1e20 times the weight, exact to 1e-15 of themselves, and the solver gave up."""
    result = concio.solve(upright_wedge(angles, 0.84, mesh_size), on_failure="return")
    assert result.status in (Status.SOLVED, Status.COLLAPSES)
    if result.solved:
        assert result.certificate.certified
