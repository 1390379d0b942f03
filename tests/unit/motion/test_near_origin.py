"""A model far from the origin is computed near it, and what is asked and told comes back to where it was described."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

import concio
from concio.analysis.motion.near_origin import Near
from concio.model.stages import ControlPoint
from models import box, model_of


@dataclass(frozen=True)
class State:
    """Of a state of motion its centres alone."""

    centre: np.ndarray
    described: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))


def pillar(x: float, y: float) -> concio.Model:
    """A stone of 1 x 2 m on a base: 3 m are its size, its middle is (x, y)."""
    base = box("base", x - 0.5, x + 0.5, y - 1.5, y - 0.5, kind="fixed", role="ground")
    return model_of(base, box("stone", x - 0.5, x + 0.5, y - 0.5, y + 1.5, kind="rigid", material="stone"))


@pytest.mark.parametrize("way", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, -1.0)])
def test_a_model_a_hundred_times_its_size_away_is_computed_near_the_origin(way: tuple[float, float]) -> None:
    """Along one axis only, too, and on either side."""
    there = pillar(0.0, 0.0)
    size = there.size
    near, far = (Near.of(pillar(share * size * way[0], share * size * way[1])) for share in (99.9, 100.1))
    assert near.model is near.described
    assert not near.origin.any()
    assert far.model is not far.described
    assert far.origin == pytest.approx(100.1 * size * np.array(way), rel=1e-12)
    for moved, own in zip(far.model.bodies, there.bodies, strict=True):
        assert moved.vertices == pytest.approx(own.vertices, abs=1e-9)


@pytest.mark.parametrize("origin", [(1000.0, 0.0), (0.0, -2000.0), (300.0, 400.0)])
def test_points_and_states_go_there_and_back(origin: tuple[float, float]) -> None:
    near = Near(pillar(*origin), pillar(0.0, 0.0), np.array(origin))
    asked = ControlPoint("stone", at=(origin[0] + 0.25, origin[1] + 1.5))
    assert near.point(asked).at == pytest.approx((0.25, 1.5))
    assert [p.at for p in near.points((asked, asked))] == [near.point(asked).at] * 2
    centre = np.array([[1.0, 2.0], [-3.0, 5.0]])
    assert near.state(State(centre)).centre == pytest.approx(centre - origin)
    assert near.state(State(centre), 1.0).centre == pytest.approx(centre + origin)
