"""Corners of joints with a compressive strength in a motion: each is counted, and named or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.contact.reference import Reference
from concio.verdict.capped_corners import NAMED, capped_corners
from models import box, model_of, weight


def feet(count: int) -> concio.Model:
    """Return stones that stand on pointed feet, under a law with a compressive strength."""
    bodies = [box("ground", -1.0, 3.0 * count, -1.0, 0.0, kind="fixed")]
    for k in range(count):
        outline = np.array([[3.0 * k + 0.5, 0.0], [3.0 * k + 1.0, 1.0], [3.0 * k, 1.0]])
        bodies.append(concio.Body(f"s{k}", outline, kind="rigid"))
    model = model_of(*bodies, law=0.5, materials={"block": concio.Rigid(20.0)}, loads=(weight(),))
    return replace(model, laws={name: replace(law, compressive_strength=3e3) for name, law in model.laws.items()})


@pytest.mark.parametrize("count", [1, NAMED, NAMED + 1, NAMED + 4])
def test_all_are_counted_and_no_more_than_three_are_named(count: int) -> None:
    model = feet(count)
    (said,) = capped_corners(model, Reference.of(model, 9.81).detection)
    assert f"at {count} contact" in said
    assert sum(f"s{k}" in said for k in range(count)) == min(count, NAMED)
    assert (f"and {count - NAMED} more:" in said) == (count > NAMED)
    assert ("more" in said) == (count > NAMED)
