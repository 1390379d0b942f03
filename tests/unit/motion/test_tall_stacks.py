"""Stacks whose lowest joints are pressed much deeper than a block of mean weight presses: they stay where they are."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from models import box, model_of, weight
from samples import sample
from space_motions import blocks


def stack(count, dim):
    """Blocks on top of each other."""
    if dim == 3:
        return blocks(*(((-0.5, -0.4, 0.2 * k), (0.5, 0.4, 0.2 * k + 0.2)) for k in range(count)))
    parts = [concio.Body(f"b{k}", [(-0.5, 0.2 * k), (0.5, 0.2 * k), (0.5, 0.2 * k + 0.2), (-0.5, 0.2 * k + 0.2)],
                         kind="rigid", material="stone") for k in range(count)]  # fmt: skip
    return model_of(box("floor", -3.0, 3.0, -1.0, 0.0, kind="fixed"), *parts, law=0.6, loads=(weight(),))


@pytest.mark.parametrize(
    ("count", "duration"), [(60, 0.1), pytest.param(100, sample(1.0, 3.0, 10.0), marks=pytest.mark.long)]
)
@pytest.mark.parametrize("dim", [2, 3])
def test_a_tall_stack_at_rest_does_not_sink(count, duration, dim):
    found = concio.dynamics(stack(count, dim), duration=duration, step=1e-2, stop_at_rest=False)
    assert found.stands
    assert found.certified
    assert np.abs(found.shots.centre - found.shots.centre[0]).max() < 1e-11 * count
    assert np.abs(found.shots.rotation - found.shots.rotation[0]).max() < 1e-12
    weighs = float(found.reference.body_mass.sum()) * found.gravity
    assert np.ptp(found.energy.total) < 1e-12 * weighs * 0.2 * count
