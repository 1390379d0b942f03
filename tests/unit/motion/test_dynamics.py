"""Dynamics of rigid blocks in the plane against closed forms; convergence and long motions are in tests/validation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

import concio
import concio.solvers.stepping.solver as step_solver
from concio.analysis.motion.certified import measures
from concio.analysis.motion.dynamics_result import Ending
from concio.analysis.motion.state import MotionState
from concio.contact.reference import Reference
from concio.errors import InputError
from concio.verdict.italian import italian
from concio.verdict.verdict import Outcome
from motion_models import G, standing
from samples import first, sample

ALPHA = np.arctan(1 / 3)


def test_free_fall_keeps_momentum():
    """A block in flight: parabola, constant spin, constant horizontal momentum."""
    model = standing(at=(0.0, 8.0))
    found = concio.dynamics(model, duration=0.8, step=1e-2, gravity=G, velocities={"block": (1.5, 2.0, 3.0)})
    t = found.end.time
    start = np.array([0.0, 8.6])
    flown = np.array([1.5 * t, 2.0 * t - 0.5 * G * t**2])
    assert found.end.centre[1] == pytest.approx(start + flown, abs=1e-12)
    assert found.end.velocity[1] == pytest.approx([1.5, 2.0 - G * t], abs=1e-12)
    assert found.end.rotation[1] == pytest.approx(3.0 * t, abs=1e-12)
    assert found.energy.error < 1e-12


@pytest.mark.long
def test_sliding_block_stops_where_it_should():
    """v0 = 2 m/s, mu = 0.3: v0^2 / (2 mu g)."""
    model = standing(height=0.4, friction=0.3)
    found = concio.dynamics(model, duration=1.0, step=1e-3, gravity=G, velocities={"block": (2.0, 0.0)})
    assert found.end.centre[1, 0] == pytest.approx(2.0**2 / (2 * 0.3 * G), rel=5e-6)
    assert np.abs(found.end.velocity[1]).max() < 1e-7  # g h is 1e-2: what is left sinks into the added compliance
    assert found.certified
    assert found.energy.error < 1e-9


@pytest.mark.long
def test_newmark_block_under_a_rectangular_pulse():
    """A = 0.5 g for 0.3 s, mu = 0.2: (A g T)^2 / (2 mu g) (1 - mu / A)."""
    pulse = concio.Pulse("rectangular", 0.5 * G, 0.3)
    found = concio.dynamics(standing(height=0.4, friction=0.2), pulse, 1.2, 1e-3, gravity=G)
    exact = (0.5 * G * 0.3) ** 2 / (2 * 0.2 * G) * (1 - 0.2 / 0.5)
    assert -found.end.centre[1, 0] == pytest.approx(exact, rel=5e-6)


@pytest.mark.long  # a base that moves has other tests; this is the same motion seen from outside
def test_newmark_block_on_a_base_that_moves():
    pulse = concio.Pulse("rectangular", 0.5 * G, 0.3)
    found, moving = (
        concio.dynamics(standing(height=0.4, friction=0.2), pulse, 1.2, 1e-3, gravity=G, base=base)
        for base in ("inertia", "moving")
    )
    ground = pulse.displacement(np.array(1.2))
    assert moving.end.centre[1, 0] - ground == pytest.approx(found.end.centre[1, 0], abs=1e-9)


@pytest.mark.long
def test_rocking_block_meets_housner():
    """From half the critical angle: the time to the first zero by energy, the next peak by Housner's impact."""
    first, R = 0.5 * ALPHA, np.hypot(0.2, 0.6)

    def speed(theta):
        return np.sqrt(1.5 * G / R * (np.cos(ALPHA - first) - np.cos(ALPHA - theta)))

    wanted, _ = quad(lambda s: 2 * s / speed(first - s * s), 0, np.sqrt(first))
    kept = 1 - 1.5 * np.sin(ALPHA) ** 2  # share of the speed after the impact
    peak = ALPHA - np.arccos(np.cos(ALPHA) + kept**2 * (np.cos(ALPHA - first) - np.cos(ALPHA)))
    assert (wanted, peak / ALPHA) == pytest.approx((0.38730, 0.32387), abs=5e-6)
    model = standing(tilt=first)
    found = concio.dynamics(model, duration=0.9, step=5e-4, start="as described", gravity=G, every=1e-6)
    theta, time = 0.5 * ALPHA + found.rotation("block"), found.shots.time
    k = int(np.flatnonzero(theta < 0)[0])
    zero = time[k - 1] + (time[k] - time[k - 1]) * theta[k - 1] / (theta[k - 1] - theta[k])
    assert zero == pytest.approx(wanted, rel=1e-5)
    assert np.abs(theta[k:]).max() / ALPHA == pytest.approx(peak / ALPHA, abs=1e-3)
    assert found.certified
    assert found.energy.error < 1e-9


def test_a_pulse_too_weak_to_uplift_moves_nothing():
    """Uplift needs a > g tan(alpha)."""
    weak = concio.Pulse("sine", 0.95 * G / 3, 0.5)
    found = concio.dynamics(standing(), weak, 0.6, 2e-3, gravity=G)
    assert found.largest_rotation[1] < 1e-4


@pytest.mark.long
def test_a_strong_pulse_overturns_and_the_motion_ends():
    pulse = concio.Pulse("half sine", 1.5 * G, 0.6)
    found = concio.dynamics(standing(), pulse, 4.0, 2e-3, gravity=G)
    assert found.ending is Ending.OVERTURNED
    assert found.end.time < 4.0


@pytest.mark.long
def test_a_motion_goes_on_from_where_it_ended():
    model = standing(tilt=0.3 * ALPHA)
    options = {"step": 1e-3, "gravity": G, "adaptive": False}
    whole = concio.dynamics(model, duration=0.6, start="as described", **options)
    first = concio.dynamics(model, duration=0.25, start="as described", **options)
    second = concio.dynamics(model, duration=0.35, start=first.end, **options)
    assert second.end.time == pytest.approx(0.6)
    assert second.end.rotation == pytest.approx(whole.end.rotation, abs=1e-9)


def test_a_motion_that_may_stop_at_rest_waits_for_the_ground():
    """Begun at 0.2 s, under a pulse too weak to move anything that ends at 0.3 s: not before, and at once then."""
    options = {"step": 5e-3, "gravity": G, "adaptive": False}
    begun = concio.dynamics(standing(), duration=0.2, **options).end
    pulse = concio.Pulse("half sine", 0.1 * G, 0.3)
    found = concio.dynamics(standing(), pulse, 1.0, start=begun, stop_at_rest=True, **options)
    assert found.ending is Ending.AT_REST
    assert found.end.time == pytest.approx(0.3, abs=0.02)


@pytest.mark.long
def test_a_motion_in_two_runs_is_that_of_one():
    """The time of the ground goes on: the second run ends with the record, and not a first run's length later."""
    rng = np.random.default_rng(3)
    record = concio.Record(np.r_[0.0, 5.0 * rng.normal(size=18), 0.0], 0.05)
    options = {"step": 5e-3, "gravity": G, "adaptive": False}
    whole = concio.dynamics(standing(friction=0.3), record, 2.0, **options)
    first = concio.dynamics(standing(friction=0.3), record, 0.5, **options)
    second = concio.dynamics(standing(friction=0.3), record, 1.5, start=first.end, **options)
    assert second.end.centre == pytest.approx(whole.end.centre, abs=1e-9)
    assert second.ground_ends == whole.ground_ends == pytest.approx(0.95)
    assert second.verdict.outcome is whole.verdict.outcome is Outcome.HOLDS
    assert second.verdict.unchecked == ()


@pytest.mark.long
def test_a_record_that_is_over_before_the_motion_goes_on_is_not_withstood():
    """1 g for 0.3 s overturns the block; put on 0.2 s after its end nothing of it acts, and no verdict may say so."""
    strong = concio.Record(np.r_[0.0, 1.0, 1.0, 0.0] * G, 0.1)
    options = {"step": 5e-3, "gravity": G, "adaptive": False}
    assert concio.dynamics(standing(), strong, **options).verdict.outcome is Outcome.FAILS
    begun = concio.dynamics(standing(), duration=0.5, **options).end
    late = concio.dynamics(standing(), strong, start=begun, **options).verdict
    assert "withstands" not in late.headline
    assert "nothing of the motion of the ground was left" in late.headline
    assert any("is over before this one begins" in line for line in late.attention)
    shifted = concio.Record(np.r_[np.zeros(6), strong.values], 0.1)
    assert concio.dynamics(standing(), shifted, start=begun, **options).verdict.outcome is Outcome.FAILS


def test_the_drift_told_is_the_deepest_of_all_steps():
    found = concio.dynamics(standing(tilt=0.3 * ALPHA), duration=0.4, step=2e-3, start="as described", gravity=G)
    assert 0 < found.summary()["drift"] < 1e-2
    assert all(found.steps.depth <= found.summary()["drift"])


@pytest.mark.parametrize("block", ["springs", "elastic"])
def test_energy_balance_of_walls(block):
    """Energy stored in joints counts from the beginning; what their common lengths change by has its own column."""
    law = concio.JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=4e5)
    wall = concio.running_bond_panel(
        courses=2, blocks=2, block_size=(1.0, 0.5), thickness=1.0, side_walls=False, elements_per_block=(2, 2),
        friction=law if block == "springs" else 0.6,
        block=concio.Rigid(20.0) if block == "springs" else concio.Elastic(E=1e6, nu=0.15, unit_weight=20.0),
    )  # fmt: skip
    found = concio.dynamics(wall, concio.Pulse("sine", 0.6 * G, 0.5), 0.1, 2e-3, every=0.02)
    assert found.certified
    assert found.energy.error < 1e-6


SPRINGS = {"normal_stiffness": 1e5, "tangential_stiffness": 4e4}


@pytest.mark.parametrize(
    ("law", "options", "height"),
    first(4, [
        (concio.JointLaw(1.0, **SPRINGS), {}, 1.2),
        (concio.JointLaw(1.0, cohesion=6.0, tensile_strength=3.0, **SPRINGS), {"brittle": False}, 1.2),
        (concio.JointLaw(1.0, compressive_strength=120.0), {}, 1.2),
        (concio.JointLaw(0.4, dilatancy=0.1, normal_stiffness=1e5), {}, 0.4),
        (concio.JointLaw(1.0, **SPRINGS), {"theta": 0.7}, 1.2),
        (concio.JointLaw(1.0, **SPRINGS), {"stiffness_damping": 1e-3}, 1.2),
        (concio.JointLaw(1.0, cohesion=6.0, tensile_strength=3.0, **SPRINGS), {}, 1.2),
        (concio.JointLaw(1.0, compressive_strength=120.0, **SPRINGS), {}, 1.2),
        (concio.JointLaw(0.4, tangential_stiffness=1e5), {}, 0.4),
    ]),
)
def test_energy_balance_of_a_rocking_or_sliding_block_whatever_its_joint(law, options, height):
    """Closed to rounding; drift, which is of second order in the step, stays below a hundredth of the input."""
    found = concio.dynamics(
        standing(height=height, friction=law), concio.Pulse("sine", 0.6 * G, 0.5), 0.6, 4e-3, gravity=G, every=0.02,
        **options,
    )  # fmt: skip
    assert found.certified
    assert found.energy.error < 1e-12
    assert np.abs(found.energy["drift"]).max() < 1e-2 * found.energy.turned_over
    rocks = found.largest_rotation[1]
    assert 0.1 < rocks < 0.16 if height > 1 else rocks < 0.01


@pytest.mark.long
def test_a_crushing_joint_settles_and_carries_the_block_on():
    """After 0.6 s of rocking the block has sunk in by millimetres at its corners and stands on them."""
    law = concio.JointLaw(1.0, compressive_strength=120.0)
    found = concio.dynamics(standing(friction=law), concio.Pulse("sine", 0.6 * G, 0.5), 0.8, 4e-3, gravity=G)
    assert found.energy["crushing"][-1] > 0.1
    assert found.end.centre[1, 1] > 0.6
    assert 1e-3 < found.end.memory.crushing.max() < 0.03


@pytest.mark.long
def test_a_tie_yields_and_lets_the_block_go_slower():
    """Without friction: m v^2 / 2 = F d - F^2 / 2 k stretches it, F^2 / 2 k comes back; the balance closes."""
    k, most, speed = 300.0, 4.0, 1.0
    model = standing(height=0.4, friction=0.0)
    tie = concio.Tie("tie", "block", (-0.2, 0.2), "", (-2.2, 0.2), stiffness=k, yield_force=most)
    mass = 20.0 * 0.16 / G
    found = concio.dynamics(
        replace(model, ties=(tie,)), duration=0.4, step=2e-3, gravity=G, velocities={"block": (speed, 0.0)}
    )
    stretched = (0.5 * mass * speed**2 + 0.5 * most**2 / k) / most - most / k
    assert found.end.ties.plastic == pytest.approx(stretched, rel=1e-3)
    assert found.end.velocity[1, 0] == pytest.approx(-most / np.sqrt(k * mass), rel=1e-3)
    assert found.energy["crushing"][-1] == pytest.approx(most * stretched, rel=1e-3)
    assert found.energy.error < 1e-10


@pytest.mark.long
def test_a_tie_breaks_for_good():
    tie = concio.Tie("tie", "block", (-0.2, 0.2), "", (-2.2, 0.2), stiffness=100.0, break_elongation=0.02)
    mass, speed = 20.0 * 0.16 / G, 1.0
    found = concio.dynamics(
        replace(standing(height=0.4, friction=0.0), ties=(tie,)), duration=0.2, step=1e-3, gravity=G,
        velocities={"block": (speed, 0.0)},
    )  # fmt: skip
    assert found.end.ties.broken.all()
    left = np.sqrt(speed**2 - 100.0 * 0.02**2 / mass)
    assert found.end.velocity[1, 0] == pytest.approx(left, rel=0.01)
    assert found.energy.error < 1e-10


@pytest.mark.long
@pytest.mark.parametrize("damping", [{"stiffness_damping": 2e-4}, {"mass_damping": 20.0}][: sample(1, 2)])
def test_rayleigh_damping_against_the_closed_form_of_a_damped_mode(damping):
    """A block in flight rings in its softest mode: q = v / w_d exp(-z w t) sin w_d t, z w = (alpha + beta w^2) / 2."""
    body = concio.Body("b", [(0, 0), (0.5, 0), (0.5, 2), (0, 2)], kind="elastic", material="block")
    floor = concio.Body("floor", [(-5, -9), (5, -9), (5, -8), (-5, -8)], kind="fixed")
    model = concio.Model((floor, body), {"block": concio.Elastic(E=1e5, nu=0.2, unit_weight=20.0)},
                         {"joint": concio.JointLaw(0.5)}, mesh_size=0.25)  # fmt: skip
    reference = Reference.of(model, G)
    K, mass = reference.disc.shapes[0].K.toarray(), reference.mass
    root = np.sqrt(mass)
    squares, modes = np.linalg.eigh(K / np.outer(root, root))
    w, mode = np.sqrt(squares[3]), modes[:, 3] / root
    decay = 0.5 * (damping.get("mass_damping", 0.0) + damping.get("stiffness_damping", 0.0) * w**2)
    start, speed = MotionState.at_rest(reference), 1e-4
    start = replace(start, nodal=speed * mode.reshape(-1, 2))
    period = 2 * np.pi / w
    found = concio.dynamics(
        model, duration=2.0 * period, step=period / 200, gravity=G, start=start, every=period / 200, **damping
    )
    q = (found.shots.strain.reshape(len(found.shots), -1) * mass) @ mode
    damped, t = np.sqrt(w**2 - decay**2), found.shots.time
    exact = speed / damped * np.exp(-decay * t) * np.sin(damped * t)
    assert 0.05 < 1 - np.exp(-decay * t[-1]) < 0.95
    assert np.abs(q - exact).max() < 1e-3 * np.abs(exact).max()
    assert found.energy.error < 1e-6
    assert found.energy["damping"][-1] > 0


def test_a_motion_stops_where_everything_has_come_to_rest():
    found = concio.dynamics(
        standing(height=0.4, friction=0.3), duration=3.0, step=4e-3, gravity=G, velocities={"block": (1.0, 0.0)},
        stop_at_rest=True,
    )  # fmt: skip
    assert found.ending is Ending.AT_REST
    assert 1.0 / (0.3 * G) < found.end.time < 1.0


@pytest.mark.parametrize("base", first(1, ["inertia", "moving"]))
def test_what_a_support_holds_follows_the_ground(base):
    """A block glued to a support shakes with it: its reaction is its mass by the acceleration of the ground."""
    model = standing(height=0.4)
    hold = concio.Support("hold", "block", edge=((-0.2, 0.0), (0.2, 0.0)))
    pulse = concio.Pulse("sine", 0.5 * G, 0.4)
    found = concio.dynamics(replace(model, supports=(hold,)), pulse, 0.4, 2e-3, gravity=G, base=base)
    mass, acting = 20.0 * 0.16 / G, pulse.acceleration(found.steps.time - 1e-3)
    held = found.steps.reaction.sum(axis=1)[:, 0]
    assert np.abs(held - mass * acting).max() < 0.02 * mass * 0.5 * G
    assert found.certified
    assert np.abs(found.energy.total - found.energy.total[0]).max() < 1e-12


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "the ground does not move, and no duration is given"),
        ({"duration": 1.0, "step": -1.0}, "step = -1 must be positive"),
        ({"duration": 1.0, "theta": 0.3}, "theta = 0.3 must lie between"),
        ({"duration": 1.0, "restitution": 1.3}, "restitution = 1.3 must lie between"),
        ({"duration": 1.0, "velocities": {"blokc": (1.0, 0.0)}}, "no body called 'blokc'"),
        ({"duration": 1.0, "motion": "nowhere.at2"}, "there is no such file"),
        ({"duration": 1.0, "motion": {"z": None}}, "no component 'z'"),
        ({"duration": 1.0, "start": "rest"}, "start = 'rest'"),
    ],
)
def test_bad_arguments(arguments, words):
    with pytest.raises(concio.InputError, match=words):
        concio.dynamics(standing(), **arguments)


def test_step_larger_than_that_of_the_record_is_refused():
    record = concio.Record(np.zeros(100), 0.01)
    with pytest.raises(concio.InputError, match="larger than that of the record"):
        concio.dynamics(standing(), record, step=0.02)


def test_bodies_without_mass_are_refused():
    model = standing()
    light = {**model.materials, "stone": concio.Rigid(0.0)}
    with pytest.raises(concio.InputError, match="'block' has no mass"):
        concio.dynamics(concio.Model(model.bodies, light, model.laws, loads=model.loads), duration=1.0)


def test_pairs_that_slide_to_and_fro_stick(monkeypatch):
    """Rounds that turned sliding pairs round would come back to states of before, in 8 steps of these 100."""
    monkeypatch.setattr(step_solver, "FEW", 0)
    law = concio.JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=4e5)
    options = {"block_size": (1.0, 0.5), "thickness": 1.0, "friction": law, "side_walls": False}
    wall = concio.running_bond_panel(courses=6, blocks=6, block=concio.Rigid(unit_weight=20.0), **options)
    pulse = concio.Pulse("sine", 0.3 * 9.81, 0.5, cycles=20.0)
    found = concio.dynamics(wall, pulse, 0.4, 4e-3, adaptive=False)
    assert found.steps.shares() == {"active set": 1.0}
    assert found.steps.factorisations.max() <= 5
    assert found.energy.error < 1e-9


def test_energy_below_rounding_grows_with_weight_and_size():
    """A weight times a length: what lifts a model by a billionth of its size."""
    light = standing()
    heavy = replace(light, materials={n: replace(m, unit_weight=4 * m.unit_weight) for n, m in light.materials.items()})
    told = [concio.dynamics(m, duration=2e-3, step=1e-3).energy.rounding for m in (light, heavy)]
    weight, size = 20.0 * 0.4 * 1.2, float(np.ptp(np.concatenate([b.outline for b in light.bodies]), axis=0).max())
    assert told[1] == pytest.approx(4.0 * told[0])
    assert 0.9e-9 < told[0] / (weight * size) < 1.5e-9


def test_steps_without_loads_are_measured_by_the_momentum_of_the_step():
    """By mass times velocity over the step, and by one where nothing moves either; the velocity is what it brings."""
    body = concio.Body("b", [(0, 0), (0.5, 0), (0.5, 2), (0, 2)], kind="rigid", material="block")
    model = concio.Model((body,), {"block": concio.Rigid(unit_weight=20.0)}, {"joint": concio.JointLaw(0.5)})
    reference, h = Reference.of(model, G), 2e-3
    mass = 20.0 / G
    x0, idle = np.array([0.3, -0.4, 0.0]), np.zeros(3)
    force, speed = measures(reference, idle, x0, h)
    assert force == pytest.approx(0.7 * mass / h, rel=1e-12)
    assert speed == pytest.approx(0.7, rel=1e-12)
    assert measures(reference, idle, idle, h) == pytest.approx((1.0, h / mass))
    acting = np.array([0.0, -20.0, 0.0])
    assert measures(reference, acting, x0, h) == pytest.approx((20.0, h * G))


def test_records_that_begin_at_different_times_are_refused(tmp_path):
    """Both began with the motion: the vertical one came two seconds too early."""
    for name, begins in (("x.txt", 0.0), ("y.txt", 2.0)):
        rows = [f"{begins + 0.01 * k} {v}" for k, v in enumerate((0.0, 1.0, -1.0, 0.0))]
        (tmp_path / name).write_text("\n".join(rows))
    records = {axis: concio.read_record(tmp_path / f"{axis}.txt", unit="m/s2") for axis in "xy"}
    with pytest.raises(concio.InputError, match="begin at different times: 0 s along x, 2 s along y"):
        concio.dynamics(standing(), records, 0.01)


def test_a_motion_does_not_go_on_in_another_frame():
    """A block that goes with its base slid 4 mm on ground that had stopped without a word, or was left behind."""
    block, pulse = standing(width=1.2, height=0.3, friction=0.5), concio.Pulse("rectangular", 1.0, 0.2)
    moving = concio.dynamics(block, pulse, 0.2, 5e-3, base="moving", gravity=G)
    inertia = concio.dynamics(block, pulse, 0.2, 5e-3, gravity=G)
    with pytest.raises(concio.InputError, match=r"moved at 0.19\d* m/s at the end of the earlier motion"):
        concio.dynamics(block, pulse, 0.05, 5e-3, gravity=G, start=moving.end)
    with pytest.raises(concio.InputError, match=r"the ground moves at 0\.2 m/s at 0\.2 s"):
        concio.dynamics(block, pulse, 0.05, 5e-3, base="moving", gravity=G, start=inertia.end)
    on = concio.dynamics(block, pulse, 0.05, 5e-3, base="moving", gravity=G, start=moving.end)
    assert not on.notes
    assert on.end.centre[1] - moving.end.centre[1] == pytest.approx([0.01, 0.0], abs=3e-4)
    stopped = concio.dynamics(block, None, 0.05, 5e-3, base="moving", gravity=G, start=moving.end)
    assert "moves at 0 m/s from there on" in stopped.notes[0]
    again = concio.dynamics(block, concio.Pulse("sine", 1.0, 0.2), 0.05, 5e-3, gravity=G, start=inertia.end)
    assert not again.notes


LONG = [pytest.param(shape, marks=pytest.mark.long) for shape in ("sine", "ricker")]


@pytest.mark.parametrize("shape", ["half sine", "rectangular", *LONG])
def test_a_pulse_is_not_passed_over_by_a_step(shape):
    """A whole sine of 1 g within a step has the mean zero: a block that falls had "come to rest"."""
    pulse = concio.Pulse(shape, 9.81, 0.5)
    with pytest.raises(concio.InputError, match="a quarter of a half wave"):
        concio.dynamics(standing(), pulse, step=1.001 * pulse.step, gravity=G)
    coarse, fine = (concio.dynamics(standing(), pulse, step=h, gravity=G) for h in (pulse.step, 0.1 * pulse.step))
    assert coarse.ending is fine.ending
    assert coarse.verdict.exit_code == fine.verdict.exit_code
    peaks = [float(np.abs(found.ground).max()) for found in (coarse, fine)]
    assert peaks[0] == pytest.approx(9.81, rel=0.35)
    assert peaks[1] == pytest.approx(9.81, rel=0.02)


OTHERS = {
    "moved": lambda m: concio.place(m, (3.0, 0.0)),
    "wider": lambda m: concio.column(width=2.0, height=0.5, blocks=2, block="rigid"),
    "of three blocks": lambda m: concio.column(width=1.0, height=0.5, blocks=3, block="rigid"),
}


@pytest.mark.parametrize("other", OTHERS)
def test_a_motion_does_not_go_on_with_other_bodies(other: str) -> None:
    """A column 3 m away, or twice as wide, stood where the earlier one had stood, and "came to rest"."""
    model = concio.column(width=1.0, height=0.5, blocks=2, block="rigid")
    end = concio.dynamics(model, duration=0.05, step=5e-3, start="as described").end
    assert concio.dynamics(model, duration=0.05, step=5e-3, start=end).end.time == pytest.approx(0.1)
    with pytest.raises(InputError, match="belongs to another model"):
        concio.dynamics(OTHERS[other](model), duration=0.05, step=5e-3, start=end)


def test_bodies_of_a_state_are_kept_in_a_file_and_far_from_the_origin(tmp_path: Path) -> None:
    model = concio.place(concio.column(width=1.0, height=0.5, blocks=1, block="rigid"), (4.5e5, 0.0))
    first = concio.dynamics(model, duration=0.05, step=5e-3, start="as described")
    read = concio.load_motion(concio.save_motion(first, tmp_path / "m.npz"))
    assert isinstance(read, concio.DynamicsResult)
    assert concio.dynamics(model, duration=0.05, step=5e-3, start=read.end).end.time == pytest.approx(0.1)
    with pytest.raises(InputError, match="has another shape or place"):
        concio.dynamics(concio.place(model, (1.0, 0.0)), duration=0.05, step=5e-3, start=read.end)


@pytest.mark.parametrize(("law", "kind", "idle"), [
    (0.6, "rigid", ("mass_damping", "stiffness_damping")),
    (concio.JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=1e6), "rigid", ("mass_damping",)),
    (0.6, concio.Elastic(E=1e6, unit_weight=20.0), ()),
])  # fmt: skip
def test_damping_that_damps_nothing_is_said(law: object, kind: object, idle: tuple[str, ...]) -> None:
    """5 % of damping were stated for rigid blocks on hard joints, and left aside without a word."""
    column = concio.column(width=0.5, height=0.5, blocks=1, block=kind, friction=law)  # type: ignore[arg-type]
    for name in ("mass_damping", "stiffness_damping"):
        found = concio.dynamics(column, duration=0.02, step=0.01, **{name: 1e-3})  # type: ignore[arg-type]
        told = [line for line in found.verdict.attention if "nothing is damped by it" in line]
        assert len(told) == (1 if name in idle else 0)
    assert "damped" not in " ".join(concio.dynamics(column, duration=0.02, step=0.01).verdict.attention)


@pytest.mark.parametrize(("gravity", "odd"), [(9.81, False), (1.62, False), (9810.0, True), (0.00981, True)])
def test_a_gravity_in_other_units_is_said(gravity: float, odd: bool) -> None:
    """9,810 mm/s2 made masses a thousandth of theirs."""
    column = concio.column(width=0.5, height=0.5, blocks=1, block="rigid")
    told = concio.dynamics(column, duration=0.01, step=0.005, gravity=gravity).verdict.attention
    said = [line for line in told if line.startswith("masses are weights over a gravity of")]
    assert len(said) == odd
    assert all(piece.language == "it" for line in said for piece in italian(line))


@pytest.mark.parametrize("shape", ["half sine", "rectangular", "ricker"])
def test_cycles_of_a_pulse_that_is_no_sine_are_refused(shape: str) -> None:
    with pytest.raises(InputError, match="cycles = 3 are those of a sine"):
        concio.Pulse(shape, 1.0, 0.2, cycles=3.0)
    assert concio.Pulse("sine", 1.0, 0.2, cycles=3.0).duration == pytest.approx(0.6)


def test_texts_for_numbers_of_a_signal_are_refused_in_words() -> None:
    with pytest.raises(InputError, match=r"amplitude = '0\.1 g' is not a number"):
        concio.Pulse("sine", "0.1 g", 0.2)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="step = '10 ms' is not a number"):
        concio.Record(np.ones(5), "10 ms")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="a model is needed, list was given"):
        concio.merge([standing(), standing()])  # type: ignore[arg-type]
