"""Impacts against their closed forms: what a restitution gives back, to rounding or to the first order of the step."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from models import box, model_of, weight
from motion_models import G, standing
from samples import first, sample

FAR = box("far", -90.0, -89.0, -90.0, -89.0, kind="fixed")


def dropped(height=0.2, width=1.0, restitution=0.0, step=1e-3, duration=0.7, friction=0.7, scale=1.0):
    """A block dropped on its flat foot; its height above the floor after every step [m], and the motion."""
    block = box("b", -0.5 * width * scale, 0.5 * width * scale, height * scale, (height + 0.4) * scale, kind="rigid",
                material="stone")  # fmt: skip
    floor = box("floor", -6.0 * scale, 6.0 * scale, -scale, 0.0, kind="fixed")
    found = concio.dynamics(
        model_of(floor, block, law=friction, loads=(weight(),)), duration=duration, step=step, gravity=G,
        start="as described", restitution=restitution, every=step,
        points=(concio.ControlPoint("b", (0.0, height * scale), (0.0, 1.0)),),
    )  # fmt: skip
    return np.asarray(found.point(0)) + height * scale, found


def rebound(restitution, step, height=0.2, scale=1.0):
    """Height of the first rebound over that of the fall."""
    fall = np.sqrt(2 * height * scale / G)
    y, found = dropped(height, restitution=restitution, step=step, duration=2.05 * fall, scale=scale)
    assert found.certified
    assert found.energy.error < 1e-9
    return float(y[found.steps.time > fall + 2 * step].max() / (height * scale))


@pytest.mark.long
@pytest.mark.parametrize("step", [1e-3, 4e-4][: sample(1, 2)])
def test_what_returns_everything_returns_to_its_height_at_any_step(step):
    assert rebound(1.0, step) == pytest.approx(1.0, abs=1e-5)  # the highest point lies between two steps


@pytest.mark.long
def test_half_the_velocity_returns_to_a_quarter_of_the_height_at_first_order():
    steps = (2e-3, 2.5e-4 * sample(3, 1))
    off = [abs(rebound(0.5, step) - 0.25) for step in steps]
    assert off[0] < 6.5 * steps[0]  # (1 - e^2 + 1 - e) g over the velocity of the impact is 6.2 per second
    assert off[1] < 6.5 * steps[1]


@pytest.mark.long
def test_restitution_over_random_drops():
    """Whatever falls from wherever: e squared of the height, to the first order of the step; no energy is made."""
    rng = np.random.default_rng(25)
    for _ in range(sample(2, 5)):
        e, height, scale = rng.uniform(0, 1), rng.uniform(0.05, 0.4), 10 ** rng.uniform(-1, 1)
        step = 2.5e-3 * np.sqrt(height * scale)
        got = rebound(e, step, height, scale)
        assert abs(got - e * e) < 4.5 * np.sqrt(G / (2 * height * scale)) * step, (e, height, scale)


def reg(x, y, radius, sides, turn):
    angle = turn + 2 * np.pi * np.arange(sides) / sides
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])


def collision(rng, friction, restitution, step=1e-3):
    """Two polygons that meet in flight, nothing else acting."""
    bodies = [
        concio.Body(name, reg(x, y, r, int(rng.integers(3, 7)), rng.uniform(0, 6)), kind="rigid", material="stone")
        for name, x, y, r in (("a", 0.0, 0.0, 0.35), ("b", 1.2, rng.uniform(-0.3, 0.3), 0.4))
    ]
    found = concio.dynamics(
        model_of(FAR, *bodies, law=friction, loads=(weight(),)), duration=0.45, step=step, gravity=G, every=step,
        factors={"dead": 0.0}, start="as described", restitution=restitution, stop_overturned=False,
        velocities={"a": (rng.uniform(1, 3), 0.0, rng.uniform(-6, 6)), "b": (-1.0, 0.1, rng.uniform(-6, 6))},
    )  # fmt: skip
    assert found.certified
    return found


def moment(found, state_velocity, spin, centre):
    """Angular momentum of all bodies about the origin [t m2/s]."""
    reference = found.reference
    total = 0.0
    for b in reference.free.tolist():
        m, reach = reference.body_mass[b], reference.disc.reach[b]
        x, v = centre[b], state_velocity[b]
        total += m * (x[0] * v[1] - x[1] * v[0] + reach**2 * spin[b])
    return total


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 2, 4)))
def test_free_collisions_that_return_everything_keep_energy_and_angular_momentum(seed):
    found = collision(np.random.default_rng(seed), friction=0.0, restitution=1.0)
    kinetic = found.energy["kinetic"]
    assert np.ptp(kinetic) < 1e-8 * kinetic[0]
    before = moment(found, (found.shots.centre[1] - found.shots.centre[0]) / found.shots.time[1],
                    (found.shots.rotation[1] - found.shots.rotation[0]) / found.shots.time[1],
                    0.5 * (found.shots.centre[1] + found.shots.centre[0]))  # fmt: skip
    after = moment(found, found.end.velocity, found.end.spin, found.end.centre)
    turns = np.abs(found.reference.body_mass * found.reference.disc.reach**2 * found.end.spin).sum()
    assert after == pytest.approx(before, abs=2e-4 * turns)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 3, 6)))
def test_impacts_never_give_energy(seed):
    rng = np.random.default_rng(100 + seed)
    found = collision(rng, friction=float(rng.choice([0.3, 1.0, 2.0])), restitution=float(rng.uniform(0, 1)))
    kinetic, impact = found.energy["kinetic"], found.energy["impact"]
    assert np.diff(impact).min() > -1e-12 * kinetic[0]
    assert np.diff(found.energy["friction"]).min() > -1e-12 * kinetic[0]
    assert np.diff(kinetic).max() < 1e-6 * kinetic[0]


def bouncing(step):
    """When a block dropped from 1 m with e = 0.8 is last faster than 2 mm/s [s]; it bounces for 2 ms more."""
    y, found = dropped(1.0, restitution=0.8, step=step, duration=4.6)
    return float(found.steps.time[np.flatnonzero(np.abs(np.diff(y)) > 2e-3 * np.diff(found.steps.time))[-1]])


@pytest.mark.long
def test_bouncing_ends_where_the_series_does():
    exact = np.sqrt(2 / G) * 1.8 / 0.2
    off = [abs(bouncing(step) - exact) for step in (4e-3, 1e-3)]
    assert off[0] < 0.04
    assert off[1] < 0.01


def trilith(share, half=0.2, high=0.6):
    """Two columns under a loose lintel, tilted by a share of their critical angle; and the ratio of the velocities.

    An impact keeps (1 - 1.5 sin^2 a + 3 gamma cos 2a) / (1 + 3 gamma) of them.
    """
    alpha = np.arctan(half / high)
    c, s = np.cos(-share * alpha), np.sin(-share * alpha)
    columns = []
    for name, x in (("left", 0.0), ("right", 2.0)):
        outline = np.array([(x - half, 0), (x + half, 0), (x + half, 2 * high), (x - half, 2 * high)])
        foot = np.array([x + half, 0.0])
        turned = (outline - foot) @ np.array([[c, s], [-s, c]]) + foot
        columns.append(concio.Body(name, turned, kind="rigid", material="stone"))
    x, y = columns[0].vertices[3]
    lintel = box("lintel", x, x + 2.0 + 2 * half, y, y + 0.4, kind="rigid", material="stone")
    floor = box("floor", -30.0, 30.0, -1.0, 0.0, kind="fixed")
    gamma = (2.0 + 2 * half) * 0.4 / (2 * 4 * half * high)
    kept = (1 - 1.5 * np.sin(alpha) ** 2 + 3 * gamma * np.cos(2 * alpha)) / (1 + 3 * gamma)
    return model_of(floor, *columns, lintel, law=1.5, loads=(weight(),)), kept, share * alpha


def kept_by(share, step):
    """Share of the angular velocity that the first impact of a trilith keeps, and what it should."""
    model, wanted, tilt = trilith(share)
    found = concio.dynamics(model, duration=0.45, step=step, every=step, start="as described", gravity=G)
    assert found.certified
    kinetic = found.energy["kinetic"]
    turned = found.rotation("left") - tilt
    k = int(np.flatnonzero(turned > 0)[0])
    before, after = kinetic[k - 4 : k - 2].mean(), kinetic[k + 2 : k + 4].mean()
    return float(np.sqrt(after / before)), wanted


@pytest.mark.long
@pytest.mark.parametrize("share", [0.22, 0.25][: sample(1, 2)])
def test_a_lintel_is_hit_when_the_feet_are(share):
    got, wanted = kept_by(share, 5e-4)
    assert wanted == pytest.approx(0.8125, abs=1e-12)
    assert got == pytest.approx(wanted, abs=0.012)


@pytest.mark.long
@pytest.mark.parametrize("share", sample([0.2], [0.15, 0.22, 0.5], [0.15, 0.2, 0.22, 0.25, 0.3, 0.5]))
def test_what_a_trilith_keeps_tends_to_its_closed_form(share):
    got, wanted = kept_by(share, 2.5e-4)
    assert got == pytest.approx(wanted, abs=0.006)


@pytest.mark.parametrize(("friction", "dilatancy", "thrown"), first(1, [(0.4, 0.1, 0.5), (0.6, 0.3, 0.4)]))
def test_a_block_on_a_dilatant_joint_slips_as_far_as_it_does_uphill(friction, dilatancy, thrown):
    """Thrown at v, it is at once thrown up too; it slips v^2 / (2 mu g (1 + mu tan psi)), and rises tan psi of it."""
    law = concio.JointLaw(friction, dilatancy=dilatancy)
    found = concio.dynamics(
        standing(height=0.4, friction=law), duration=0.2, step=1e-3, gravity=G, velocities={"block": (thrown, 0.0)}
    )
    slip = thrown**2 / (2 * friction * G * (1 + friction * dilatancy))
    assert found.certified
    moved = found.end.centre[1] - np.array([0.0, 0.2])
    assert moved == pytest.approx([slip, dilatancy * slip], rel=1e-3)
    assert np.abs(found.shots.slip[-1]) == pytest.approx([slip], rel=1e-3)


def test_a_block_that_is_pushed_on_a_dilatant_joint_slips_from_rest():
    """A pulse of 0.8 g for 0.1 s on friction 0.4: it slips with the pulse and after it, and rises as it slips."""
    found = concio.dynamics(
        standing(height=0.4, friction=concio.JointLaw(0.4, dilatancy=0.1)),
        concio.Pulse("rectangular", -0.8 * G, 0.1), 0.3, 1e-3, gravity=G,
    )  # fmt: skip
    share = 1 + 0.4 * 0.1  # m a = 0.8 m g - mu N, N = m (g + a tan psi)
    speed = (0.8 - 0.4) * G / share * 0.1
    slip = 0.5 * speed * 0.1 + speed**2 / (2 * 0.4 * G / share)
    moved = found.end.centre[1] - np.array([0.0, 0.2])
    assert moved == pytest.approx([slip, 0.1 * slip], rel=5e-3)
