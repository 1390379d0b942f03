"""Limit loads in space: what is carried lies below what begins to move, and no number falls with the contact points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import JointLaw, Load, Model, Polyhedron, Rigid
from concio.analysis.limit_result import LimitResult
from concio.contact.patch_points import spread_points
from concio.problem.solution import PROVEN_FAILURES
from samples import sample

SLACK = 1e-6
"""Certificates hold to a millionth."""

CORNER = """
[walls]
lines = [[[0, 0], [0, 2.0]], [[0, 0], [1.5, 0]]]
height = 3.0
block_size = [0.8, 0.3, 0.3]
block = "rigid"
unit_weight = "18 kN/m3"
friction = 0.6
[[loads]]
kind = "weight"
value = [-1.0, 0.0, 0.0]
group = "live"
"""
"""Where load steps once carried 0.4311 above a state that begins to move at 0.4261."""


def in_order(found: LimitResult) -> None:
    """What is carried, what begins to move and what nothing exceeds stand in this order, in numbers and in words."""
    bound, most = found.associated.multiplier, found.design
    assert np.isfinite(most)
    assert most <= bound * (1 + SLACK)
    assert found.steps is not None
    assert found.carried <= bound * (1 + SLACK)
    assert not found.steps.failed < found.carried
    state = found.collapse_state
    if state is not None and found.state_counts:
        assert state.multiplier <= bound * (1 + SLACK)
        assert most <= state.multiplier * (1 + SLACK)
        if found.carried > state.multiplier * (1 + SLACK) and most >= state.multiplier * (1 - SLACK):
            assert "begin to move" in found.verdict.sentence, "several equilibria: the less is designed with, and told"
    assert f"{most:.6g}" in found.verdict.sentence
    assert concio.solve(found.assembly.model, factors={"live": 0.98 * most}).verdict.holds
    if found.steps.outcome in PROVEN_FAILURES:
        beyond = concio.solve(found.assembly.model, factors={"live": found.steps.failed}, on_failure="return")
        assert not beyond.verdict.holds


def corner(rng: np.random.Generator) -> Model:
    """Return a small corner of two walls of one to three courses, drawn along a random way with a random friction."""
    ends = [(0.0, float(rng.choice([0.75, 1.0]))), (float(rng.choice([0.5, 0.75])), 0.0)]
    model = concio.walls(
        lines=[((0, 0), ends[0]), ((0, 0), ends[1])], height=0.25 * int(rng.integers(1, 4)),
        block_size=(0.5, 0.25, 0.25), block="rigid", friction=float(rng.uniform(0.3, 0.8)),
    )  # fmt: skip
    way = rng.uniform(0, 2 * np.pi)
    push = Load("weight", (float(np.cos(way)), float(np.sin(way)), 0.0), group="live")
    return replace(model, loads=(*model.loads, push))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 5, 12)))
def test_numbers_of_a_random_corner_stand_in_order(seed: int) -> None:
    in_order(concio.limit(corner(np.random.default_rng([25, 11, seed]))))


@pytest.mark.long
def test_numbers_of_the_corner_with_a_return_stand_in_order() -> None:
    in_order(concio.limit(concio.loads(CORNER)))


def footing(points: int | str, length: float = 1.0, friction: float = 0.4) -> Model:
    """Return a block on the ground under a couple about its vertical axis."""
    couple = (
        Load("point", (0, 1.0, 0), bodies=("b",), at=(length, 0.5, 0), group="live"),
        Load("point", (0, -1.0, 0), bodies=("b",), at=(0, 0.5, 0), group="live"),
    )
    bodies = (
        Polyhedron.box("g", (-5, -5, -1), (5, 5, 0), kind="fixed"),
        Polyhedron.box("b", (0, 0, 0), (length, 1, 0.5), kind="rigid"),
    )
    loads = (Load("weight", (0, 0, -1)), *couple)
    return Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(friction)}, loads=loads, contact_points=points)


def even(length: float) -> float:
    """Return the mean distance of a rectangle of length x 1 from its middle, by a million midpoints."""
    x, y = ((np.arange(1000) + 0.5) / 1000 - 0.5)[:, None] * length, (np.arange(1000) + 0.5) / 1000 - 0.5
    return float(np.hypot(x, y).mean())


GRIDS = ["corners", 2, 3, 4, 5, 6, 8]


@pytest.mark.long
@pytest.mark.parametrize("length", sample([2.0], [2.0], [1.0, 2.0]))  # square ones in test_limit_verdict
@pytest.mark.parametrize("points", GRIDS)
def test_the_torsion_that_is_designed_with_does_not_depend_on_the_contact_points(
    points: int | str, length: float
) -> None:
    """A footing under a pure couple, 0.4 of its weight times the mean distance from its middle: 1.530 for a square."""
    found = concio.limit(footing(points, length))
    exact = 0.4 * 10.0 * length * even(length) / length
    assert found.design <= exact * (1 + 3e-3)
    short = 0.0
    if points in (3, 5):  # fewer points far out than an even pressure has: told, with how much
        patch = found.assembly.detection.interfaces[0]
        at, area = spread_points(patch, int(points))
        middle = area @ at / area.sum()
        short = 1.0 - float(area @ np.linalg.norm(at - middle, axis=1) / area.sum()) / even(length)
        assert f"resist torsion {100 * short:.2g} % less than a uniform pressure" in found.verdict.sentence
    assert found.design >= exact * (1 - short) * (1 - 3e-3)
    in_order(found)
