"""Rigid blocks that move in space: free flight, contacts of corners, faces and edges, the plane extruded and turned."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import concio
from commands import run
from concio.analysis.motion.scheme import Drive
from concio.contact.reference import Reference
from motion_models import G, standing
from space_motions import STILL, blocks, extruded, stepper_of

BRICK = ((-0.05, -0.1, -0.2), (0.05, 0.1, 0.2))
INERTIA = 16.0 / 12.0 * np.array([0.2**2 + 0.4**2, 0.1**2 + 0.4**2, 0.1**2 + 0.2**2])
PERIOD, FIRST_ZERO = 6.9980616997, 1.5664225246
"""Of the rates of the brick with rates (0.05, 5, 0.1) rad/s [s]: Euler's equations by elliptic functions."""


def flight(steps, h, turn=None):
    """Rates of the brick along its own axes over steps without any load."""
    turn = np.eye(3) if turn is None else turn
    model = replace(blocks(BRICK, floor=((-1.0, -1.0, -9.0), (1.0, 1.0, -8.0)), turn=turn), loads=())
    model = replace(model, materials={"block": concio.Rigid(unit_weight=2.0 * G)})
    stepper, state = stepper_of(model)
    spin = state.spin.copy()
    spin[1] = turn @ np.array([0.05, 5.0, 0.1])
    state, rates, momentum = replace(state, spin=spin), [], []
    for _ in range(steps):
        state, report = stepper.step(state, h, STILL)
        assert report.solution.residual < 1e-12
        now = state.rotation[1] @ turn
        rates.append(now.T @ state.spin[1])
        momentum.append(now @ (INERTIA * rates[-1]))
    return np.array(rates), np.array(momentum)


def zeros(h, values):
    """Times at which values at steps of h cross zero."""
    k = np.flatnonzero(values[:-1] * values[1:] < 0)
    return h * (k + 1 + values[k] / (values[k] - values[k + 1]))


def test_a_brick_in_flight_keeps_energy_and_momentum_and_turns_over():
    h = 4e-2
    rates, momentum = flight(42, h)
    energy, size = (INERTIA * rates**2).sum(axis=1), np.linalg.norm(momentum, axis=1)
    assert np.ptp(energy) < 1e-13 * energy[0]
    assert np.ptp(size) < 1e-13 * size[0]
    assert zeros(h, rates[:, 1])[0] == pytest.approx(FIRST_ZERO, abs=5 * h**2)


def test_the_flight_of_a_turned_brick_is_turned():
    turn = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
    plain, turned = flight(15, 2e-2), flight(15, 2e-2, turn)
    assert np.abs(turned[0] - plain[0]).max() < 1e-12
    assert np.abs(turned[1] - plain[1] @ turn.T).max() < 1e-12 * np.abs(plain[1]).max()


@pytest.mark.long
def test_the_flight_of_a_brick_converges_to_its_period_and_flips_as_often():
    """The second order: a fourth of the error for half the step; flips every half period."""
    errors = []
    for h in (4e-2, 2e-2):
        times = zeros(h, flight(round(9.0 / h), h)[0][:, 1])
        errors.append(times[2] - times[0] - PERIOD)
    assert abs(errors[1]) < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    flips = 1 + int((30.0 - FIRST_ZERO) / (0.5 * PERIOD))
    assert len(zeros(4e-2, flight(750, 4e-2)[0][:, 1])) == flips


def test_a_rocking_block_extruded_and_turned_is_that_of_the_plane():
    """Joints sink in by 1e-9 of their width: what they are lent differs in plane and space by lengths of joints."""
    width, height = 0.4, 1.2
    plane = standing(width=width, height=height, tilt=0.16)
    depth = 2.0 * width * height / (width + height)  # of the same mean width
    plane = replace(plane, bodies=tuple(replace(b, thickness=depth) for b in plane.bodies))
    turn = Rotation.from_rotvec([0.3, 0.5, -0.8]).as_matrix()
    flat, state = stepper_of(plane, 1e-4)
    solid, placed = stepper_of(extruded(plane, depth, turn), 1e-4)
    assert solid.maker.width == pytest.approx(flat.maker.width, rel=1e-12)
    nothing = Drive(np.zeros(2), np.zeros(2), {})
    for _ in range(80):
        state, one = flat.step(state, 1e-3, nothing)
        placed, other = solid.step(placed, 1e-3, STILL)
        assert max(one.solution.residual, other.solution.residual) < 1e-11
    assert abs(state.rotation[1]) > 5e-3
    own = turn.T @ placed.centre[1]
    assert own[[0, 2]] == pytest.approx(state.centre[1], abs=1e-12)
    assert own[1] == pytest.approx(0.0, abs=1e-12)
    vector = turn.T @ Rotation.from_matrix(placed.rotation[1]).as_rotvec()
    assert vector == pytest.approx([0.0, -state.rotation[1], 0.0], abs=1e-12)
    assert turn.T @ placed.spin[1] == pytest.approx([0.0, -state.spin[1], 0.0], abs=1e-11)


@pytest.mark.long
@pytest.mark.parametrize("vector", [(0.0, 0.0, 0.0), (0.3, 0.5, -0.8)])
def test_impacts_of_a_rocking_block_extruded_and_turned_are_those_of_the_plane(vector):
    """Both ends of an edge move a block apart from the floor as the corner of the plane does, however it is turned."""
    width, height = 0.4, 1.2
    plane = standing(width=width, height=height, tilt=0.01)
    depth = 2.0 * width * height / (width + height)  # of the same mean width
    plane = replace(plane, bodies=tuple(replace(b, thickness=depth) for b in plane.bodies))
    turn = Rotation.from_rotvec(vector).as_matrix()
    flat, state = stepper_of(plane, 1e-4)
    solid, placed = stepper_of(extruded(plane, depth, turn), 1e-4)
    nothing, impacts = Drive(np.zeros(2), np.zeros(2), {}), 0
    for _ in range(110):
        state, one = flat.step(state, 2e-3, nothing)
        placed, other = solid.step(placed, 2e-3, STILL)
        assert max(one.solution.residual, other.solution.residual) < 1e-9
        impacts += one.works["impact"] > 1e-7
        assert other.works["impact"] == pytest.approx(one.works["impact"], abs=1e-12)
        assert (turn.T @ placed.centre[1])[[0, 2]] == pytest.approx(state.centre[1], abs=1e-12)
        flown = np.insert(state.velocity[1], 1, 0.0)
        assert turn.T @ placed.velocity[1] == pytest.approx(flown, abs=1e-11)
        assert turn.T @ placed.spin[1] == pytest.approx([0.0, -state.spin[1], 0.0], abs=1e-11)
    assert impacts >= 2


@pytest.mark.long
def test_an_impact_of_a_rocking_block_is_housners():
    """With e = 0 the ratio of the spins is 1 - 1.5 sin^2 alpha, and the plane's to what joints sink in."""
    width, height, tilt = 0.4, 1.2, 0.16
    turn = Rotation.from_rotvec([0.0, 0.0, 0.6]).as_matrix()
    solid, state = stepper_of(extruded(standing(width=width, height=height, tilt=tilt), 0.6, turn))
    spins = []
    for _ in range(480):
        state, report = solid.step(state, 1e-3, STILL)
        assert report.solution.residual < 1e-9
        spins.append(np.linalg.norm(state.spin[1]))
    hit = int(np.argmax(spins))
    after = 2.5 * spins[hit + 2] - 1.5 * spins[hit + 3]  # what it was at the impact: its weight slows it down
    assert after / spins[hit] == pytest.approx(1.0 - 1.5 * np.sin(np.arctan(width / height)) ** 2, abs=2e-3)


def test_a_block_slides_as_far_as_its_energy_in_any_direction():
    """v^2 / (2 mu g), to the second order in the step; it does not turn, and ends the way it began."""
    way = np.array([0.6, 0.8, 0.0])
    point = concio.ControlPoint("b0", (0.0, 0.0, 0.15), tuple(way))
    found = concio.dynamics(
        blocks(((-0.5, -0.5, 0.0), (0.5, 0.5, 0.3)), friction=0.5), velocities={"b0": 0.5 * way}, duration=0.15,
        points=(point,), gravity=G,
    )  # fmt: skip
    assert found.certified
    assert found.energy.error < 1e-12
    assert found.point()[-1] == pytest.approx(0.25 / (2 * 0.5 * G), rel=1e-3)
    assert np.abs(found.shots.centre[-1, 1] @ np.array([-0.8, 0.6, 0.0])) < 1e-9


def test_a_stack_at_rest_does_not_move_by_a_bit():
    model = blocks(*(((-0.3, -0.2, 0.2 * k), (0.3, 0.2, 0.2 * k + 0.2)) for k in range(3)))
    found = concio.dynamics(model, duration=0.12)
    assert found.stands
    assert found.verdict.holds
    corner = np.array([0.3, 0.2, 0.1])  # of every block, from its centre

    def corners(k: int) -> np.ndarray:
        return found.shots.centre[k] + found.shots.rotation[k] @ corner

    assert np.array_equal(corners(0), corners(-1))  # a rotation of 1e-39 is rounding of the linear algebra


def test_a_block_dropped_flat_rebounds_with_its_energy():
    found = concio.dynamics(
        blocks(((-0.2, -0.2, 0.05), (0.2, 0.2, 0.25))), duration=0.2, restitution=1.0, start="as described", gravity=G,
        step=2e-3,
    )  # fmt: skip
    assert found.certified
    assert found.energy.error < 1e-12
    assert found.shots.centre[-1, 1, 2] == pytest.approx(0.15, abs=1e-4)  # 2 sqrt(2 h / g) = 0.2019 s later


@pytest.mark.long
def test_a_cube_dropped_on_a_corner_comes_to_rest_on_a_face():
    """Corner, edge and face touch in turn; every step is certified and the energy closes."""
    model = blocks(((-0.2, -0.2, 0.5), (0.2, 0.2, 0.9)))
    turn = Rotation.from_rotvec([0.6, 0.5, 0.2]).as_matrix()
    cube = model.bodies[1]
    placed = (cube.vertices - cube.centroid) @ turn.T + np.array([0.0, 0.0, 0.6])
    found = concio.dynamics(
        replace(model, bodies=(model.bodies[0], replace(cube, vertices=placed))), duration=1.5, start="as described"
    )
    assert found.certified
    assert found.verdict.holds
    assert found.energy.error < 1e-10
    upright = np.abs(found.end.rotation[1] @ turn).max(axis=0)
    assert upright.max() == pytest.approx(1.0, abs=1e-3)
    assert found.end.centre[1, 2] == pytest.approx(0.2, abs=1e-4)


def test_bricks_that_cross_rest_on_crossings_of_their_edges():
    """No corner of either stands over the other: four crossings of edges carry the weight, a quarter each."""
    model = blocks(((-0.5, -0.1, 0.0), (0.5, 0.1, 0.2)), ((-0.1, -0.5, 0.2), (0.1, 0.5, 0.4)))
    stepper, state = stepper_of(model)
    for _ in range(20):
        state, report = stepper.step(state, 2e-3, STILL)
    slots, t = stepper.maker.slots, report.solution.t
    between = (slots.body_a == 1) & (slots.body_b == 2) & (t[:, 0] > 0)
    assert between.sum() == 4
    assert t[between, 0] == pytest.approx(np.full(4, 0.25 * 20.0 * 0.04), rel=1e-3)
    assert report.solution.residual < 1e-10


def test_the_certificate_of_a_step_in_space_sees_what_is_wrong():
    model = blocks(((-0.2, -0.2, 0.0), (0.2, 0.2, 0.4)))
    stepper, state = stepper_of(model)
    new, report = stepper.step(state, 2e-3, STILL)
    t = report.solution.t
    from concio.analysis.motion.certified import Returned

    def judged(new, t):
        return stepper.certificate.step(state, new, state.memory, t, 2e-3, STILL, Returned(), stepper.matrix(2e-3))

    assert judged(new, t) < 1e-10
    assert judged(new, 1.01 * t) > 1e-4
    aside = t.copy()
    aside[np.argmax(t[:, 0]), 1] += 0.7 * t[:, 0].max()
    assert judged(new, aside) > 1e-3
    spin = new.spin.copy()
    spin[1, 0] += 1e-3
    assert judged(replace(new, spin=spin), t) > 1e-4
    deep = new.centre.copy()
    deep[1, 2] -= 0.1
    assert stepper.certificate.original.deepest(deep, new.rotation, new.strain, 0.1) > 1.0


def test_what_slides_over_an_edge_hands_on_its_force():
    """A block slides until its corners stand beside the lower one: crossings of edges go on where corners were."""
    model = blocks(
        ((-0.3, -0.3, 0.0), (0.3, 0.3, 0.2)), ((-0.3, -0.3, 0.2), (0.3, 0.3, 0.4)), friction=0.3,
        floor=((-1.0, -1.0, -0.5), (1.0, 1.0, 0.0)),
    )  # fmt: skip
    stepper, state = stepper_of(model)
    impacts, named = 0.0, set()
    for k in range(25):
        if k == 3:
            velocity = state.velocity.copy()
            velocity[2] = 0.3, 0.2, 0.0
            state = replace(state, velocity=velocity)
        state, report = stepper.step(state, 2e-3, STILL)
        assert report.solution.residual < 1e-9
        impacts += abs(report.works["impact"])
        slots, t = stepper.maker.slots, report.solution.t[:, 0]
        loaded = (slots.body_a != 0) & (slots.body_b != 0) & (t > 0)
        assert t[loaded].sum() == pytest.approx(20.0 * 0.072, rel=1e-2)
        assert loaded.sum() == 4
        named.add(tuple(slots.key[loaded].tolist()))
    assert len(named) == 2  # corners at rest, other features beside
    assert impacts == 0.0  # none of which is hit


def test_joints_that_dilate_are_refused_in_a_sentence():
    model = blocks(((-0.2, -0.2, 0.0), (0.2, 0.2, 0.4)))
    with pytest.raises(concio.InputError, match="dilates"):
        concio.dynamics(replace(model, laws={"joint": concio.JointLaw(0.5, dilatancy=0.1)}), duration=0.1)


def test_a_motion_in_space_is_saved_and_goes_on(tmp_path):
    model = blocks(((-0.2, -0.2, 0.0), (0.2, 0.2, 0.4)))
    first = concio.dynamics(model, duration=0.02, velocities={"b0": (0.5, 0.2, 0.0, 0.0, 0.0, 0.5)})
    read = concio.load_motion(concio.save_motion(first, tmp_path / "motion.npz"))
    assert np.array_equal(read.end.rotation, first.end.rotation)
    assert read.rotation("b0") == pytest.approx(first.rotation("b0"))
    on = concio.dynamics(model, duration=0.02, start=read.end)
    whole = concio.dynamics(model, duration=0.04, velocities={"b0": (0.5, 0.2, 0.0, 0.0, 0.0, 0.5)})
    assert on.end.centre == pytest.approx(whole.end.centre, abs=1e-9)
    assert on.end.rotation == pytest.approx(whole.end.rotation, abs=1e-9)


SHAKEN = """
[drums]
diameter = 1.0
height = 1.0
drums = 1
sides = 4
block = "rigid"
unit_weight = "20 kN/m3"
friction = 0.6

[motion]
duration = "0.02 s"
pulse = {shape = "sine", amplitude = "0.1 g", length = "0.02 s"}
"""


@pytest.mark.long
def test_shake_takes_three_components_in_space(tmp_path):
    file, record = tmp_path / "drum.toml", tmp_path / "north.txt"
    file.write_text(SHAKEN, encoding="utf-8")
    record.write_text("".join(f"{0.002 * k:.3f} {0.01 * k:.3f}\n" for k in range(11)), encoding="utf-8")
    options = ["--transverse", record, "--vertical", record, "--record-unit", "g", "--json", "--out", tmp_path / "out"]
    code, out, err = run("shake", file, "--pulse", "sine,0.1 g,0.02 s", *options)
    assert code == 4, err  # it still moves
    told = json.loads(out)
    assert told["certificate"]["worst"] < 1e-9
    assert "along x, record 'north.txt'" in told["verdict"]["question"]["asked"]
    assert "along z" in told["verdict"]["question"]["asked"]
    assert {"history.csv", "report.html", "motion.npz"} <= {p.name for p in (tmp_path / "out").iterdir()}
    head = (tmp_path / "out" / "history.csv").read_text(encoding="utf-8").splitlines()[0]
    assert "reaction z" in head


def test_a_transverse_record_of_a_plane_model_is_refused(tmp_path):
    file, record = tmp_path / "plane.toml", tmp_path / "north.txt"
    file.write_text('[column]\nwidth = 1.0\nheight = 1.0\nblocks = 1\nblock = "rigid"\n', encoding="utf-8")
    record.write_text("".join(f"{0.002 * k:.3f} {0.01 * k:.3f}\n" for k in range(11)), encoding="utf-8")
    code, _, err = run("shake", file, "--transverse", record, "--record-unit", "g")
    assert code == 2
    assert "transverse record" in err


def test_loads_of_turned_blocks_have_the_moments_of_their_points():
    """A dead force keeps its direction at an arm that turns, pressure turns with its face; a potential is its work."""
    model = blocks(((-0.2, -0.3, 0.0), (0.2, 0.3, 0.5)))
    at, force = np.array([0.2, 0.1, 0.4]), np.array([1.0, -2.0, 0.5])
    on_face = tuple((0.2, y, z) for y, z in ((-0.1, 0.1), (0.3, 0.1), (0.3, 0.5), (-0.1, 0.5)))
    model = replace(model, loads=(
        *model.loads, concio.Load("point", tuple(force), bodies=("b0",), at=tuple(at)),
        concio.Load("pressure", (3.0,), polygon=on_face, group="wind"),
    ))  # fmt: skip
    reference = Reference.of(model, G)
    here = reference.at_rest().placement
    turn = Rotation.from_rotvec([0.5, -0.7, 1.9]).as_matrix()
    placed = replace(here, rotation=np.stack([np.eye(3), turn]))
    found = reference.loads.forces({}, placed.turns)
    arm, push = at - here.centre[1], 3.0 * 0.4 * 0.4 * np.array([-1.0, 0.0, 0.0])
    wind = np.cross(np.array([0.2, 0.1, 0.3]) - here.centre[1], push)
    own = reference.spin_axes.outward(found[3:6][None] * reference.disc.reach[1], np.array([1]), placed.turns)[0]
    assert own == pytest.approx(np.cross(turn @ arm, force) + turn @ wind, abs=1e-12)
    weight = np.array([0.0, 0.0, -20.0 * 0.12])
    assert found[:3] == pytest.approx(weight + force + turn @ push, abs=1e-12)
    moved = np.zeros((2, 3))
    moved[1] = 0.1, 0.2, -0.3
    work = (weight + force) @ moved[1] + force @ (turn @ arm - arm)
    none = np.zeros((0, 3))
    assert reference.loads.potential({}, moved, placed.turns, none) == pytest.approx(-work, abs=1e-12)


def test_bad_input_of_a_motion_in_space_is_told_in_words():
    model = blocks(((-0.2, -0.2, 0.0), (0.2, 0.2, 0.4)))
    pulse = concio.Pulse("sine", 1.0, 0.1)
    with pytest.raises(concio.InputError, match="no component 'w' of a ground motion in space"):
        concio.dynamics(model, {"w": pulse})
    with pytest.raises(concio.InputError, match=r"\(v_x, v_y, v_z\) or \(v_x, v_y, v_z, w_x, w_y, w_z\)"):
        concio.dynamics(model, duration=0.1, velocities={"b0": (1.0, 0.0)})


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("gap", [0.004, 0.03])
def test_a_block_falls_by_the_initial_gap_of_its_joint_however_thin_the_ground_is(dim, gap):
    """The ground is 5 cm thick: bodies stand deeper in each other than a tenth of that where a joint begins open."""
    block = concio.column(width=0.4, height=0.5, blocks=1, block="rigid", unit_weight=20.0)
    model = replace(block, rules=tuple(replace(rule, gap=gap) for rule in block.rules))
    model = concio.extrude(model, 0.3) if dim == 3 else model
    found = concio.dynamics(model, duration=0.25, step=2e-3)
    assert found.ending.name == "COMPLETE"
    fallen = found.reference.disc.centroids - found.end.centre
    assert fallen[1, -1] == pytest.approx(gap, abs=5e-6)
    assert np.abs(fallen[:, :-1]).max() <= 1e-9
    assert found.certificate <= 1e-9


@pytest.mark.long
@pytest.mark.parametrize("dim", [2, 3])
def test_an_initial_gap_elsewhere_changes_nothing_here(dim):
    """Bodies far away whose joints begin open by more than a block is thick fall; the pillar is shaken as without."""

    def fallen(*, elsewhere):
        pillar = concio.column(width=0.4, height=0.5, blocks=2, block="rigid", unit_weight=20.0)
        away = concio.place(pillar, at=(30.0, 0.0), name="away")
        rules = (*pillar.rules, concio.JointRule("joint", ("away-*", "away-*"), gap=0.3)) if elsewhere else pillar.rules
        model = replace(concio.merge(pillar, away), rules=rules)
        model = concio.extrude(model, 0.3) if dim == 3 else model
        found = concio.dynamics(model, concio.Pulse("sine", 2.0, 0.3), duration=0.2, step=2e-3, adaptive=False)
        return np.array([found.end.centre[i] for i, body in enumerate(model.bodies) if body.name in ("b01", "b02")])

    assert np.abs(fallen(elsewhere=True) - fallen(elsewhere=False)).max() <= 1e-12
