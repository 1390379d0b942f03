"""Models in the coordinates of a national grid, or high above the sea, have the answers of those at the origin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import Load, Tie
from concio.analysis.seismic.default_parts import parts_of
from models import turned
from samples import first
from seismic_walls import courses, ground, overturning, site

GRID = (512345.7, 5034567.3)


def sliding_wall() -> concio.Model:
    """Four courses on little friction, with a tie that yields: joints slide, open and the tie gives way."""
    tie = Tie("rod", "c4", (0.0, 2.9), "", (4.0, 2.9), 8000.0, yield_force=2.0)
    return concio.Model(
        (ground(), *courses(4, 3.0, 0.5)), {"block": concio.Rigid(19.0)}, {"joint": concio.JointLaw(0.45)},
        loads=(Load("weight", (0.0, -1.0)), Load("point", (0.0, -8.0), bodies=("c2",), at=(0.4, 1.5))), ties=(tie,),
    )  # fmt: skip


@pytest.mark.parametrize("wall", [sliding_wall(), overturning(4)], ids=["sliding", "overturning"])
def test_an_assessment_far_from_the_origin_is_that_near_it(wall: concio.Model) -> None:
    options = {"direction": "right", "elsewhere": ("height",), "levels": ("SLV",)}
    near = concio.assess(wall, site=site(), **options)
    far = concio.assess(turned(wall, 0.0, GRID), site=site(), **options)
    assert far.verdict.outcome is near.verdict.outcome
    assert far.zeta == pytest.approx(near.zeta, rel=1e-7)
    assert far.sought == near.sought
    for one, other in zip(near.mechanisms, far.mechanisms, strict=True):
        assert other.multiplier == pytest.approx(one.multiplier, rel=1e-7)
        assert (other.followed.kind, other.followed.reason) == (one.followed.kind, one.followed.reason)
        assert other.followed.end == pytest.approx(one.followed.end, rel=1e-6)


def test_levels_high_above_zero_keep_their_names_apart() -> None:
    assembly = concio.assemble(turned(overturning(12), 0.0, (0.0, 1234.567)))
    names = [part.name for part in parts_of(assembly, np.array([1.0, 0.0])).parts]
    assert len(set(names)) == len(names) == 11


def test_names_of_levels_have_four_digits_where_they_suffice() -> None:
    names = [part.name for part in parts_of(concio.assemble(overturning(3)), np.array([1.0, 0.0])).parts]
    assert names == ["above z = 2 m", "above z = 4 m"]


def pushed_to_the_left(model: concio.Model) -> concio.Model:
    side = (-1.0,) + (0.0,) * (model.dim - 1)
    return replace(model, loads=(*model.loads, Load("weight", side, group="live")))


@pytest.mark.parametrize("dim", first(1, [2, 3]))
def test_a_push_far_from_the_origin_is_that_near_it(dim: int) -> None:
    wall = pushed_to_the_left(overturning(2))
    at, shift = (0.0, 6.0), np.array(GRID)
    if dim == 3:
        wall, at, shift = concio.extrude(wall, 1.0), (0.0, 0.5, 6.0), np.array([*GRID, 300.0])
    top = concio.ControlPoint("c2", at, (-1.0, 0.0) if dim == 2 else (-1.0, 0.0, 0.0))
    there = replace(top, at=tuple(np.array(at) + shift))
    near = concio.push(wall, points=(top,), step=0.05)
    far = concio.push(concio.place(wall, shift.tolist()), points=(there,), step=0.05)
    assert far.certified
    assert far.ending is near.ending
    np.testing.assert_allclose(far.multiplier, near.multiplier, atol=1e-7 * near.peak)
    np.testing.assert_allclose(far.point(), near.point(), atol=1e-7)
    np.testing.assert_allclose(far.centre, near.centre + shift, atol=1e-7)
    np.testing.assert_allclose(far.end.centre, near.end.centre + shift, atol=1e-7)
    assert [(e.step, e.kind, e.bodies) for e in far.events] == [(e.step, e.kind, e.bodies) for e in near.events]
    np.testing.assert_allclose([e.at for e in far.events], [np.array(e.at) + shift for e in near.events], atol=1e-6)


@pytest.mark.long
def test_a_motion_far_from_the_origin_is_that_near_it_and_goes_on() -> None:
    wall, shift = overturning(2), np.array(GRID)
    top = concio.ControlPoint("c2", (0.0, 6.0))
    there = replace(top, at=tuple(np.array(top.at) + shift))
    pulse = concio.Pulse("sine", 3.0, 0.3)
    near = concio.dynamics(wall, pulse, duration=0.3, points=(top,))
    far = concio.dynamics(turned(wall, 0.0, shift), pulse, duration=0.3, points=(there,))
    assert far.certified
    assert len(far.steps) == len(near.steps)
    assert near.largest_rotation[1] > 1e-3
    np.testing.assert_allclose(far.point(), near.point(), atol=1e-7)
    np.testing.assert_allclose(far.shots.centre, near.shots.centre + shift, atol=1e-7)
    on = [
        concio.dynamics(model, duration=0.1, start=first.end)
        for model, first in ((wall, near), (turned(wall, 0.0, shift), far))
    ]
    np.testing.assert_allclose(on[1].end.centre, on[0].end.centre + shift, atol=1e-7)


def test_what_is_wrong_far_from_the_origin_is_told_where_it_was_described() -> None:
    wall = turned(overturning(2), 0.0, (1e6, 0.0))
    block = replace(wall.bodies[2], name="twice", outline=wall.bodies[2].outline + np.array([0.1, 0.1]))
    with pytest.raises(concio.GeometryError, match=r"1e\+06"):
        concio.push(replace(wall, bodies=(*wall.bodies, block)))
