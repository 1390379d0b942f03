"""A bridge and its mirror image carry the same with Coulomb friction, and no start of an iteration decides how much."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.limit_result import LimitResult
from concio.bridges import Axle, Fill, Vehicle, with_fill, with_vehicle
from samples import first, sample


def two_rings(x: float, *, cover: float, passive: float, friction: float = 0.16, mirror: str = "") -> LimitResult:
    """Return what load steps say of two axles on a bridge of two rings that slide on each other."""
    bare = concio.bridge(
        span=3.2, rise=0.91, ring=[0.22, 0.26], ring_friction=friction, voussoirs=15, staggered=True, width=2.0,
        block="rigid", unit_weight=22.0, friction=0.6,
    )  # fmt: skip
    bare = concio.place(bare, (0.0, 0.0), mirror=mirror) if mirror else bare
    filled = with_fill(bare, Fill(cover=cover, unit_weight=20.0, passive=passive))
    at, way = (-x, "left") if mirror else (x, "right")
    axles = Axle(0.0, 10.0), Axle(1.2, 10.0)
    loaded = with_vehicle(filled, Vehicle("two axles", axles, position=at, direction=way), whole=False)  # type: ignore[arg-type]
    assert loaded.vehicle is not None
    return concio.limit(loaded, loaded.vehicle.group, path=False, steps=True, search=False)


@pytest.mark.long
@settings(max_examples=sample(1, 3, 12), deadline=None)
@given(st.floats(1.8, 2.6), st.floats(0.25, 0.6), st.floats(0.3, 1.0), st.floats(0.1, 0.4))
@example(2.3, 0.25, 1.0, 0.16)
def test_a_bridge_and_its_mirror_image_carry_the_same(
    x: float, cover: float, passive: float, friction: float
) -> None:
    one = two_rings(x, cover=cover, passive=passive, friction=friction)
    other = two_rings(x, cover=cover, passive=passive, friction=friction, mirror="x")
    assert other.associated.multiplier == pytest.approx(one.associated.multiplier, rel=1e-6)
    if np.isfinite(one.associated.multiplier):
        assert other.design == pytest.approx(one.design, rel=1e-6)


@pytest.mark.parametrize(("x", "cover", "passive"), first(1, [(2.3, 0.25, 0.5), (2.3, 0.25, 1.0), (2.1, 0.5, 1.0)]))
def test_steps_do_not_end_where_one_start_fails(x: float, cover: float, passive: float) -> None:
    """What a load step of the same size carries from the dead load on is carried by steps as well."""
    found = two_rings(x, cover=cover, passive=passive)
    assert found.steps is not None
    assert found.design >= 0.92 * found.associated.multiplier
    assert found.steps.worst <= 1e-9
