"""A diagnosis is that of its structure: what stands elsewhere, of whatever size, changes no motion and no interval."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio import Body, Candidate, Measurement
from concio.analysis.cracks.diagnose import expected
from samples import sample


def cracked() -> tuple[concio.Model, list[Measurement], list[Candidate]]:
    """A flat arch whose left abutment gives way and turns a little; a level counts as well."""
    arch = concio.arch(shape="flat", span=1.2, ring=0.3, voussoirs=6, skew=70, block="rigid", friction=2.0)
    top = (-0.6 - 0.3 / np.tan(np.radians(70)), 0.3)
    cracks = [
        Measurement("crown", "opening", "0.2 mm", "10.1 mm", ("v03", "v04"), at=(0.0, 0.0)),
        Measurement("springer", "opening", "0.2 mm", "5.2 mm", ("left abutment", "v01"), at=top),
        Measurement("lean", "tilt", "0.3 mrad", "0 mrad", body="left abutment"),
    ]
    moves = [
        Candidate("gives way", body="left abutment", direction=(-1, 0), low=0.0),
        Candidate("turns", body="left abutment", rotation=1),
    ]
    return arch, cracks, moves


def beside(model: concio.Model, size: float, far: float, first: bool) -> concio.Model:
    """Return the model with a block on a ground of its own, some way off."""
    low, high = np.array([[0.0, 0.0], [1.0, 1.0]]) * size + [far, 0.0]
    corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
    material = next(b.material for b in model.bodies if b.kind != "fixed")
    down = [(x, y - size) for x, y in corners]
    more = (Body("other", corners, material, "rigid"), Body("other ground", down, material, "fixed"))
    return replace(model, bodies=(*more, *model.bodies) if first else (*model.bodies, *more))


@cache
def alone_of() -> concio.Diagnosis:
    arch, cracks, moves = cracked()
    return concio.diagnose(arch, cracks, moves, large=False)


@pytest.mark.long
@settings(max_examples=sample(1, 3, 8), deadline=None)
@given(st.floats(-2, 2), st.booleans())
def test_a_block_elsewhere_changes_no_motion_and_no_interval(size: float, first: bool) -> None:
    arch, cracks, moves = cracked()
    alone = alone_of()
    both = concio.diagnose(beside(arch, 10.0**size, 300.0, first), cracks, moves, large=False)
    assert both.verdict.status == alone.verdict.status
    assert [c.names for c in both.causes] == [c.names for c in alone.causes]
    assert alone.causes
    for one, other in zip(alone.causes, both.causes, strict=True):
        for key in ("motion", "low", "high", "predicted"):
            np.testing.assert_allclose(getattr(other, key), getattr(one, key), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("far", [30.0, 3000.0])
def test_how_far_a_rotation_is_expected_to_go_is_measured_by_the_structure_that_turns(far: float) -> None:
    arch, cracks, moves = cracked()
    found = expected(beside(arch, 0.1, far, True), cracks, moves)
    np.testing.assert_array_equal(found, expected(arch, cracks, moves))
