"""Bodies that are fast: none passes through another one unseen, in the plane and in space; what records beside say."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import concio
from concio.analysis.motion.dynamics_result import Ending
from concio.analysis.motion.ground_motion import Ground
from models import box, model_of, weight
from motion_models import G
from samples import first
from space_motions import blocks

THIN = ((-1.0, -1.0, -0.002), (1.0, 1.0, 0.0))


def shot(low, high, speed, **floor):
    """A block that is shot at a floor; how high it stands in the end, over its half height."""
    found = concio.dynamics(
        blocks((low, high), **floor), velocities={"b0": (0.0, 0.0, -speed)}, start="as described", duration=0.2,
        gravity=G,
    )  # fmt: skip
    assert found.certified
    assert found.energy.error < 1e-10
    return 2.0 * found.end.centre[1, 2] / (high[2] - low[2])


@pytest.mark.parametrize("speed", first(1, [40.0, 10.0, 30.0]))
def test_a_fast_block_does_not_pass_through_a_thin_floor(speed):
    assert shot((-0.1, -0.1, 1.0), (0.1, 0.1, 1.2), speed, floor=THIN) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("size", [(0.5, 0.001), (0.0005, 1.0)])
def test_a_thin_plate_and_a_needle_land_on_the_floor(size):
    half, height = size
    assert shot((-half, -half, 0.2), (half, half, 0.2 + height), 1.0) == pytest.approx(1.0, abs=1e-4)


def test_a_fast_block_in_the_plane_does_not_pass_through_a_thin_floor():
    block = concio.Body("block", [(-0.1, 1.0), (0.1, 1.0), (0.1, 1.2), (-0.1, 1.2)], kind="rigid", material="stone")
    model = model_of(box("floor", -3.0, 3.0, -0.002, 0.0, kind="fixed"), block, law=0.5, loads=(weight(),))
    found = concio.dynamics(
        model, velocities={"block": (0.0, -25.0)}, start="as described", duration=0.1, gravity=G
    )
    assert found.certified
    assert found.end.centre[1, 1] == pytest.approx(0.1, abs=1e-4)


@pytest.mark.long
def test_what_stands_apart_is_met_where_it_stands():
    """Two structures: a block thrown at another one, which is thinner than what it moves in a step."""
    model = blocks(((-0.3, -0.3, 0.0), (-0.29, 0.3, 0.6)), ((-3.0, -0.1, 0.3), (-2.8, 0.1, 0.5)))
    found = concio.dynamics(
        model, velocities={"b1": (20.0, 0.0, 0.0)}, start="as described", duration=0.2, step=5e-3, gravity=G
    )
    assert found.certified
    assert found.end.velocity[1, 0] > 5.0  # it was hit, and is no longer where it stood
    assert found.end.centre[2, 0] < found.end.centre[1, 0]


def test_a_body_in_flight_may_be_as_fast_as_it_likes_and_turns_by_half_a_radian_in_a_step():
    model = blocks(((-0.1, -0.1, 5.0), (0.1, 0.1, 5.2)))
    found = concio.dynamics(
        model, velocities={"b0": (300.0, 0.0, 0.0, 0.0, 0.0, 1000.0)}, start="as described", duration=0.02,
        stop_overturned=False, gravity=G,
    )  # fmt: skip
    assert found.certified
    assert np.diff(found.steps.time).max() <= 0.5 / 1000.0 + 1e-12
    turned = Rotation.from_matrix(found.end.rotation[1]).as_rotvec()
    wanted = Rotation.from_rotvec([0.0, 0.0, 1000.0 * found.end.time]).as_rotvec()
    assert turned == pytest.approx(wanted, abs=1e-9)


def test_rounding_halves_no_step_of_a_body_that_hardly_turns():
    model = blocks(((-0.1, -0.1, 5.0), (0.1, 0.1, 5.2)))
    for step in np.random.default_rng(11).uniform(1e-3, 4e-3, 30).tolist():
        found = concio.dynamics(
            model, velocities={"b0": (0.0, 0.0, 0.1, 0.0, 0.1, 0.0)}, start="as described", duration=2.0 * step,
            step=step, gravity=G, stop_overturned=False,
        )  # fmt: skip
        np.testing.assert_allclose(np.diff(found.steps.time, prepend=0.0), step, rtol=1e-9)


@pytest.mark.parametrize("spin", [1e5, 1e9])
def test_a_spin_that_outruns_the_step_is_told_in_a_sentence(spin):
    model = blocks(((-0.05, -0.1, 0.5), (0.05, 0.1, 0.9)))
    found = concio.dynamics(model, velocities={"b0": (0, 0, 0, spin, 1.0, 2.0)}, start="as described", duration=0.1)
    assert found.ending is Ending.UNSOLVED
    assert "too fast for the shortest step" in found.verdict.answer
    assert "ask for a smaller step" in found.verdict.answer
    assert found.verdict.exit_code == 4


@pytest.mark.parametrize("speed", [80.0, 300.0, 1e3])
def test_a_body_that_comes_near_others_too_fast_is_told_in_a_sentence(speed):
    model = blocks(((-0.1, -0.1, 1.0), (0.1, 0.1, 1.2)), floor=THIN)
    thrown = {"b0": (0.0, 0.0, -speed)}
    found = concio.dynamics(model, velocities=thrown, start="as described", gravity=1e-3, duration=0.1)
    assert found.ending is Ending.UNSOLVED
    assert f"'b0' comes near others at {speed:g} m/s" in found.verdict.answer


def record(step, count, size):
    return concio.Record(size * np.sin(np.arange(count)), step)


@pytest.mark.parametrize(
    ("records", "words"),
    [
        ((record(5e-3, 101, 1.0), record(4e-3, 126, 1.0), None), "different sampling intervals"),
        ((record(5e-3, 101, 1.0), record(5e-3, 90, 1.0), None), "end at different times"),
        ((record(5e-3, 101, 1.0), record(5e-3, 101, 1.0), record(5e-3, 101, 2.0)), "are components swapped"),
    ],
)
def test_records_that_do_not_seem_to_belong_together_are_told(records, words):
    told = Ground(records).attention
    assert len(told) == 1
    assert words in told[0]


def test_records_that_belong_together_are_not():
    assert Ground((record(5e-3, 101, 1.0), record(5e-3, 101, 0.9), record(5e-3, 101, 0.8))).attention == ()
    assert Ground((record(5e-3, 101, 1.0), record(5e-3, 101, 0.9))).attention == ()


@pytest.mark.long
def test_what_falls_past_everything_ends_a_motion_that_began_as_described():
    model = blocks(((-0.1, -0.1, 0.5), (0.1, 0.1, 0.7)), floor=((1.0, 1.0, 0.0), (2.0, 2.0, 0.4)))
    found = concio.dynamics(model, start="as described", duration=1e4, gravity=G)
    assert found.ending is Ending.FALLEN
    assert found.end.time == pytest.approx(np.sqrt(2.0 * found.reference.disc.size / G), abs=2e-3)
    assert found.verdict.status == "fallen"
    assert "'b0' has fallen by" in found.verdict.answer
    assert "below everything in the model" in found.verdict.answer


def test_blocks_that_begin_inside_each_other_are_refused_in_a_sentence():
    model = blocks(((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), ((0.5, 0.0, 0.2), (1.5, 1.0, 1.2)))
    with pytest.raises(concio.GeometryError, match="'b0' and 'b1' overlap") as caught:
        concio.dynamics(model, duration=0.1, gravity=G)
    assert "\n" not in str(caught.value)


def test_a_motion_of_more_steps_than_can_be_kept_is_refused():
    model = blocks(((-0.1, -0.1, 0.0), (0.1, 0.1, 0.2)))
    with pytest.raises(concio.InputError, match=r"a motion of 1e\+09 s has 5e\+11 steps of 0.002 s"):
        concio.dynamics(model, duration=1e9)
