"""Bases that turn in time: blocks that go with them, slide off, or stay behind; the plane extruded and turned."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import concio
from concio.analysis.motion.ground_motion import Ground
from concio.analysis.motion.scheme import Drive
from motion_models import G, standing
from space_motions import blocks, extruded, stepper_of

TURN = Rotation.from_rotvec([0.3, 0.5, -0.8]).as_matrix()


@dataclass(frozen=True)
class Spin:
    """A rotation that begins smoothly and goes on at a constant rate [rad]."""

    rate: float
    begins: float = 0.1
    duration: float = 1.0

    def _share(self, time):
        return np.clip(np.asarray(time, dtype=float) / self.begins, 0.0, 1.0)

    def displacement(self, time):
        s = self._share(time)
        late = np.maximum(np.asarray(time, dtype=float) - self.begins, 0.0)
        return self.rate * (self.begins * (s**3 - 0.5 * s**4) + late)

    def velocity(self, time):
        s = self._share(time)
        return self.rate * (3 * s**2 - 2 * s**3)

    def acceleration(self, time):
        s = self._share(time)
        return self.rate * 6 * (s - s**2) / self.begins


def turntable(radius, friction):
    """A low block at a distance from the axis."""
    floor = ((-1.5, -1.5, -0.3), (1.5, 1.5, 0.0))
    return blocks(((radius - 0.2, -0.15, 0.0), (radius + 0.2, 0.15, 0.1)), friction=friction, floor=floor)


def test_a_block_goes_with_a_base_that_turns_about_any_axis():
    """Friction holds it: it stands on the base where it stood, whatever that has turned by."""
    model = replace(turntable(0.6, 0.9), laws={"joint": concio.JointLaw(0.9, cohesion=1e4, tensile_strength=1e4)})
    signals = {"rx": Spin(0.5), "ry": Spin(-0.3), "rz": Spin(0.8), "x": concio.Pulse("sine", 1.0, 0.2)}
    found = concio.dynamics(model, signals, 0.15, 2.5e-3, base="moving", gravity=G, stop_overturned=False)
    ground = Ground.of(signals, 1.0, 3)
    matrix = Rotation.from_rotvec(ground.rotation(0.15)).as_matrix()
    assert found.certified
    assert np.linalg.norm(ground.rotation(0.15)) > 0.08
    for body in (0, 1):
        place = matrix @ found.shots.centre[0, body] + ground.displacement(np.array(0.15))
        assert found.end.centre[body] == pytest.approx(place, abs=1e-9 if body == 0 else 2e-4)
        assert found.end.rotation[body] == pytest.approx(matrix, abs=1e-9 if body == 0 else 1e-3)


@pytest.mark.parametrize(("share", "slides"), [(0.95, False), (1.05, True)])
def test_a_block_leaves_a_turntable_when_friction_does_not_hold_it(share, slides):
    """omega^2 r = mu g."""
    radius, friction = 1.0, 0.3
    rate, end = np.sqrt(share * friction * G / radius), 0.1
    begun = {"b0": (0.0, rate * radius, 0.0, 0.0, 0.0, rate)}  # goes round already
    found = concio.dynamics(
        turntable(radius, friction), {"rz": Spin(rate, 1e-12)}, end, 5e-3, base="moving", gravity=G, velocities=begun
    )
    out = np.linalg.norm(found.end.centre[1, :2]) - radius
    assert found.certified
    if slides:
        assert out == pytest.approx(0.5 * (share - 1.0) * friction * G * end**2, rel=0.2)
    else:
        assert abs(out) < 2e-5


def test_a_block_without_friction_stays_where_it_is():
    found = concio.dynamics(turntable(0.8, 0.0), {"rz": Spin(4.0)}, 0.1, 4e-3, base="moving", gravity=G)
    assert found.certified
    assert found.end.centre[1] == pytest.approx(found.shots.centre[0, 1], abs=1e-9)
    assert found.end.rotation[1] == pytest.approx(np.eye(3), abs=1e-9)
    assert abs(Rotation.from_matrix(found.end.rotation[0]).as_rotvec()[2]) > 0.15


@pytest.mark.long  # the block that goes with a base below
def test_a_block_on_a_floor_that_turns_extruded_and_turned_is_that_of_the_plane():
    width, height, h = 0.4, 1.2, 1e-3
    depth = 2.0 * width * height / (width + height)
    plane = standing(width=width, height=height, friction=0.7)
    plane = replace(plane, bodies=tuple(replace(b, thickness=depth) for b in plane.bodies))
    flat, state = stepper_of(plane, 1e-4)
    solid, other = stepper_of(extruded(plane, depth, TURN), 1e-4)
    spin, angles = Spin(6.0, 0.05), []
    for k in range(80):
        turn = float(spin.displacement((k + 1) * h) - spin.displacement(k * h)) / h
        moved, velocity = np.array([0.2 * k * h, 0.0]), np.array([0.2, 0.0])
        state, one = flat.step(state, h, Drive(np.zeros(2), velocity, {}, moved, turn, moved))
        shift, speed = (TURN @ np.array([v[0], 0.0, v[1]]) for v in (moved, velocity))
        other, two = solid.step(
            other, h, Drive(np.zeros(3), speed, {}, shift, TURN @ np.array([0.0, -turn, 0.0]), shift)
        )
        assert max(one.solution.residual, two.solution.residual) < 1e-9
        for b in (0, 1):
            assert (TURN.T @ other.centre[b])[[0, 2]] == pytest.approx(state.centre[b], abs=1e-11)
        angles.append(state.rotation.copy())
    vectors = Rotation.from_matrix(TURN.T @ other.rotation @ TURN).as_rotvec()
    assert -vectors[:, 1] == pytest.approx(state.rotation, abs=1e-11)
    assert abs(state.rotation[0] - state.rotation[1]) > 1e-3  # it has begun to rock on its floor


def test_the_work_of_a_base_that_turns_is_what_the_bodies_have():
    spin = {"ry": Spin(0.4), "rz": Spin(1.0)}
    found = concio.dynamics(turntable(0.6, 0.3), spin, 0.1, 4e-3, base="moving", gravity=G)
    assert found.certified
    assert found.energy.error < 1e-10
    assert abs(found.energy["input"][-1]) > 1e-4


def test_a_model_far_from_the_origin_turns_about_the_origin():
    """It is computed near it: the block goes round with its floor, by a small angle at a large radius."""
    shift, signals = np.array([400.0, -300.0, 0.0]), {"rz": Spin(0.02, 0.05)}
    model = turntable(0.0, 0.9)
    far = replace(model, bodies=tuple(replace(b, vertices=b.vertices + shift) for b in model.bodies))
    found = concio.dynamics(far, signals, 0.02, 2e-3, base="moving", gravity=G, stop_overturned=False)
    turn = float(signals["rz"].displacement(0.02))
    matrix = Rotation.from_rotvec([0.0, 0.0, turn]).as_matrix()
    assert found.certified
    assert found.end.centre[0] == pytest.approx(matrix @ far.bodies[0].centroid, abs=1e-9)
    assert np.linalg.norm(found.end.centre[0] - far.bodies[0].centroid) > 1e-3


@pytest.mark.parametrize(
    ("motion", "options", "words"),
    [
        ({"rz": Spin(1.0)}, {}, "a base that moves"),
        ({"tilt": Spin(1.0)}, {"base": "moving"}, "no component 'tilt'"),
    ],
)
def test_bad_rotations_are_refused(motion, options, words):
    with pytest.raises(concio.InputError, match=words):
        concio.dynamics(turntable(0.6, 0.3), motion, 0.1, **options)


@pytest.mark.parametrize("motion", [{"rz": Spin(1.0)}, {"x": concio.Pulse("sine", 1.0, 0.1)}])
@pytest.mark.parametrize("body", ["", "floor"])
def test_what_a_moving_base_does_not_take_along_is_refused(motion, body):
    """It was followed as if its end stayed where it was: with forces of inertia the same block goes the other way."""
    rod = concio.Tie("rod", "b0", (0.8, 0.0, 0.05), body, (-1.0, 0.0, -0.1), 40.0)
    model = replace(turntable(0.6, 0.3), ties=(rod,))
    with pytest.raises(concio.InputError, match="ends at what is fixed"):
        concio.dynamics(model, motion, 0.1, base="moving")


def test_a_support_does_not_turn_with_the_base():
    foot = tuple((x, y, 0.0) for x, y in ((0.4, -0.15), (0.8, -0.15), (0.8, 0.15), (0.4, 0.15)))
    model = replace(turntable(0.6, 0.3), supports=(concio.Support("hold", "b0", polygon=foot),))
    with pytest.raises(concio.InputError, match="does not turn with the base"):
        concio.dynamics(model, {"rz": Spin(1.0)}, 0.1, base="moving")


def test_a_motion_lasts_as_long_as_its_longest_component() -> None:
    """Rotations count, too; nothing lasts no time."""
    short, long = (concio.Pulse("sine", 1.0, length) for length in (0.5, 2.0))
    assert Ground.of({"x": short, "y": long}).duration == pytest.approx(2.0)
    assert Ground.of({"x": long, "z": short}, dim=3).duration == pytest.approx(2.0)
    assert Ground.of({"x": short, "rz": Spin(0.1, duration=3.0)}).duration == pytest.approx(3.0)
    assert Ground.of(None).duration == 0.0
