"""Ties, supports that move and bases that shake in space: closed forms, and the plane extruded and turned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import concio
from concio.analysis.motion.scheme import Drive, Scheme
from motion_models import G, standing
from samples import first, sample
from space_motions import blocks, extruded, placed, stepper_of

TURN = Rotation.from_rotvec([0.3, 0.5, -0.8]).as_matrix()
PULSES = {"x": concio.Pulse("sine", 0.5 * G, 0.2), "y": concio.Pulse("half sine", 0.3 * G, 0.15),
          "z": concio.Pulse("sine", 0.2 * G, 0.1)}  # fmt: skip
MASS = 20.0 * 0.6 * 0.6 * 0.2 / G
FLAG = blocks(((-0.3, -0.3, 0.0), (0.3, 0.3, 0.2)), friction=0.2)


def both(plane, width, height, drive, steps, h=1e-3, scheme=None, begin=None):
    """Steps of a plane model and of the same extruded and turned; joints sink in by 1e-9 of their width."""
    depth = 2.0 * width * height / (width + height)  # of the same mean width
    plane = replace(plane, bodies=tuple(replace(b, thickness=depth) for b in plane.bodies))
    flat, state = stepper_of(plane, 1e-4, scheme)
    solid, other = stepper_of(extruded(plane, depth, TURN), 1e-4, scheme)
    if begin is not None:
        state = replace(state, velocity=np.array([[0.0, 0.0], begin]))
        other = replace(other, velocity=np.array([np.zeros(3), placed(begin, TURN)]))
    for k in range(steps):
        given = drive(k * h, h)
        one = flat.step(state, h, given)
        two = solid.step(other, h, Drive(*(np.array(placed(v, TURN)) for v in (given.ground, given.velocity)), {},
                                         np.array(placed(given.moved, TURN))))  # fmt: skip
        assert max(one[1].solution.residual, two[1].solution.residual) < 1e-11
        state, other = one[0], two[0]
    return state, other


def still(time, h):
    return Drive(np.zeros(2), np.zeros(2), {}, np.zeros(2))


def same(state, other, error=1e-10):
    """Whether bodies of the plane and of space stand and move alike."""
    own = other.centre[1] @ TURN
    assert own[[0, 2]] == pytest.approx(state.centre[1], abs=error)
    assert own[1] == pytest.approx(0.0, abs=error)
    assert (other.velocity[1] @ TURN)[[0, 2]] == pytest.approx(state.velocity[1], abs=10 * error)
    vector = TURN.T @ Rotation.from_matrix(other.rotation[1]).as_rotvec()
    assert vector == pytest.approx([0.0, -state.rotation[1], 0.0], abs=error)


@pytest.mark.long
@pytest.mark.parametrize("law", first(2, [{"yield_force": 3.0}, {"break_elongation": 0.02}, {}, {"prestress": 2.0}]))
def test_a_block_pulled_by_a_tie_is_that_of_the_plane(law):
    model = replace(
        standing(0.4, 0.2, friction=0.1), ties=(concio.Tie("rod", "block", (-0.2, 0.1), "", (-1.0, 0.3), 40.0, **law),)
    )
    state, other = both(model, 0.4, 0.2, still, 60, begin=(1.0, 0.0))
    same(state, other)
    assert other.ties.plastic == pytest.approx(state.ties.plastic, abs=1e-10)
    assert (other.ties.broken == state.ties.broken).all()
    assert state.ties.broken.all() == ("break_elongation" in law)


def test_a_rocking_block_held_by_a_tie_is_that_of_the_plane():
    rod = concio.Tie("rod", "block", (0.0, 1.0), "", (-2.0, 1.5), 200.0, prestress=1.0)
    model = replace(standing(0.4, 1.2, tilt=0.1), ties=(rod,))
    state, other = both(model, 0.4, 1.2, still, 60, scheme=Scheme(stiffness_damping=1e-3))
    same(state, other)
    assert abs(state.rotation[1]) > 1e-3


@pytest.mark.long
@pytest.mark.parametrize("moves", first(1, [False, True]))
def test_a_block_on_a_shaken_base_is_that_of_the_plane(moves):
    """As forces of inertia along and square to the floor, and on a floor that moves along itself.

    What sinks into a floor that is lifted is moved out again, by other shares of corners in space.
    """

    def drive(time, h):
        way = [PULSES["x"], concio.Pulse("sine", 0.0 if moves else 0.2 * G, 0.1)]
        if moves:
            moved = np.array([float(p.displacement(np.array(time))) for p in way])
            velocity = np.array([np.diff(p.displacement(np.array([time, time + h])))[0] / h for p in way])
            return Drive(np.zeros(2), velocity, {}, moved)
        return Drive(np.array([np.diff(p.velocity(np.array([time, time + h])))[0] / h for p in way]), np.zeros(2), {},
                     np.zeros(2))  # fmt: skip

    state, other = both(standing(0.4, 1.2, friction=0.3), 0.4, 1.2, drive, 100)
    same(state, other)
    assert abs(state.centre[1, 0]) > 1e-3


@pytest.mark.parametrize("seed", range(sample(1, 4, 8)))
def test_a_block_leaves_its_tie_with_what_it_has_when_that_breaks(seed):
    """v^2 = v0^2 - (omega b)^2 in any direction, whatever part of a step is left when the elongation b is reached."""
    rng = np.random.default_rng(seed)
    stiffness, speed, angle = rng.uniform(20.0, 80.0), rng.uniform(0.5, 2.0), rng.uniform(0.0, 6.0)
    way = np.array([np.cos(angle), np.sin(angle), 0.0])
    omega = np.sqrt(stiffness / MASS)
    breaks = rng.uniform(0.3, 0.8) * speed / omega
    rod = concio.Tie("rod", "b0", (0.0, 0.0, 0.1), "", tuple(np.array([0.0, 0.0, 0.1]) - 3.0 * way), stiffness,
                     break_elongation=breaks)  # fmt: skip
    model = replace(blocks(((-0.3, -0.3, 0.0), (0.3, 0.3, 0.2)), friction=0.0), ties=(rod,))
    found = concio.dynamics(
        model, duration=2.0 * np.arcsin(omega * breaks / speed) / omega, step=1e-3, start="as described",
        velocities={"b0": tuple(speed * way)}, gravity=G,
    )  # fmt: skip
    left = np.sqrt(speed**2 - (omega * breaks) ** 2)
    assert found.certified
    assert found.energy.error < 1e-10
    assert found.end.ties.broken.all()
    assert found.end.velocity[1] @ way == pytest.approx(left, rel=1e-3)
    assert np.linalg.norm(found.end.velocity[1] - left * way) < 1e-3 * speed


def test_a_block_leans_with_a_floor_that_turns_about_any_axis():
    """Friction takes it along: it stands on the floor where it stood before."""
    turn = 0.08 * np.array([0.6, 0.8, 0.0])
    tall = blocks(((-0.3, -0.3, 0.0), (0.3, 0.3, 0.8)))
    moved = replace(tall, supports=(concio.Support("turn", "floor", rotation=tuple(turn)),))
    found = concio.dynamics(moved, duration=0.01, gravity=G)
    matrix = Rotation.from_rotvec(turn).as_matrix()
    floor, block = (np.array(b.centroid) for b in tall.bodies)
    assert found.stands
    assert found.certified
    assert found.shots.centre[0, 1] == pytest.approx(floor + matrix @ (block - floor), abs=1e-4)
    assert found.shots.rotation[0, 1] == pytest.approx(matrix, abs=2e-4)


@pytest.mark.long
@pytest.mark.parametrize(("angle", "stands"), [(0.9, True), (1.1, False)])
def test_a_floor_that_turns_beyond_the_edge_of_a_block_lets_it_fall(angle, stands):
    """tan a = b / h about an edge; a block of unequal sides has two."""
    for axis, half in ((0, 0.2), (1, 0.3)):
        tall = blocks(((-0.3, -0.2, 0.0), (0.3, 0.2, 1.2)), friction=2.0)
        turn = np.zeros(3)
        turn[axis] = angle * np.arctan(half / 0.6)
        moved = replace(tall, supports=(concio.Support("turn", "floor", rotation=tuple(turn)),))
        found = concio.dynamics(moved, duration=0.01, gravity=G)
        assert found.stands == stands
        if not stands:
            share = float(next(n for n in found.notes if "supports" in n).split("moved by ")[1].split()[0].rstrip(","))
            assert share == pytest.approx(1.0 / angle, rel=2e-2)


@pytest.mark.parametrize("friction", [0.2, 0.5])
@pytest.mark.parametrize("space", first(1, [True, False]))
def test_a_floor_that_moves_aside_takes_along_what_friction_holds(friction, space):
    """A spring of 10 kN/m holds a block of 3.2 kN back: it goes with the floor until friction is used up."""
    model = replace(
        standing(0.4, 0.4, friction=friction), ties=(concio.Tie("rod", "block", (0.0, 0.2), "", (-3.0, 0.2), 10.0),),
        supports=(concio.Support("go", "floor", displacement=(0.1, 0.0)),),
    )  # fmt: skip
    model = extruded(model, 1.0, np.eye(3)) if space else model
    found = concio.dynamics(model, duration=0.01, gravity=G)
    assert found.stands
    assert found.certified
    assert found.shots.centre[0, 1, 0] == pytest.approx(min(0.1, friction * 3.2 / 10.0), rel=1e-4)


@pytest.mark.long
def test_a_block_slides_under_a_pulse_in_any_direction_as_newmark_says():
    way, size, long, friction = np.array([0.6, 0.8]), 0.5 * G, 0.1, 0.2
    pulse = {name: concio.Pulse("rectangular", size * part, long) for name, part in zip("xy", way, strict=True)}
    found = concio.dynamics(FLAG, pulse, 0.5, 1e-3, gravity=G)
    slid = (size * long) ** 2 / (2 * friction * G) * (1 - friction * G / size)
    assert found.certified
    assert found.energy.error < 1e-10
    assert -found.end.centre[1, :2] @ way == pytest.approx(slid, rel=1e-4)
    assert abs(found.end.centre[1, :2] @ [-0.8, 0.6]) < 1e-9


@pytest.mark.long
def test_a_base_that_moves_along_three_axes_is_the_ground_seen_from_outside():
    """The difference goes with the step: a floor has one velocity in each."""
    ground = np.array([PULSES[axis].displacement(np.array(0.2)) for axis in "xyz"])
    apart = []
    for step in (4e-3, 2e-3):
        inner, outer = (
            concio.dynamics(FLAG, PULSES, 0.2, step, gravity=G, base=base, adaptive=False).end.centre[1]
            for base in ("inertia", "moving")
        )
        apart.append(np.abs(outer - ground - inner).max())
    assert apart[1] < 5e-4
    assert apart[1] < 0.65 * apart[0]


@pytest.mark.parametrize("base", first(1, ["moving", "inertia"]))
def test_what_a_support_holds_follows_three_components(base):
    """A block glued to a support shakes with it: its reaction is its mass by what the ground and weight accelerate."""
    foot = tuple((x, y, 0.0) for x, y in ((-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)))
    model = replace(FLAG, supports=(concio.Support("hold", "b0", polygon=foot),))
    found = concio.dynamics(model, PULSES, 0.2, 2e-3, gravity=G, base=base)
    time = found.steps.time - 1e-3
    gravity = np.array([0.0, 0.0, G])
    acting = gravity + np.stack([PULSES[axis].acceleration(time) for axis in "xyz"], axis=1)
    assert found.certified
    assert np.abs(found.steps.reaction.sum(axis=1) - MASS * acting).max() < 0.02 * MASS * G
    assert np.abs(found.energy.total - found.energy.total[0]).max() < 1e-12
