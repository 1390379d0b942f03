"""The state of a displaced mechanism: which contacts stay is what their own velocities and forces say."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import concio
from concio.analysis.seismic.macro_blocks import GROUND
from concio.analysis.seismic.macro_contacts import contacts_of
from concio.analysis.seismic.sequence import Sequence, State
from concio.analysis.seismic.tie_history import TieHistory
from concio.contact.face_points import FacePoints, stated
from concio.contact.points import NOWHERE
from concio.problem.contact_problem import Laws
from seismic_walls import overturning, site


@pytest.mark.long
@pytest.mark.parametrize(("friction", "slides"), [(0.8, False), (0.02, True)])
def test_contacts_that_press_and_do_not_slide_stay(friction: float, slides: bool) -> None:
    """A wall that turns over keeps its toe; one that slides on all of its foot keeps nothing."""
    worst = concio.assess(overturning(2, friction=friction), site=site(), direction="left", levels=["SLV"]).worst
    assert worst is not None
    linkage = worst.linkage
    contacts = contacts_of(worst.assembly, worst.mechanics, worst.found.normal_force)
    sequence = Sequence(worst.mechanics, contacts, linkage.dead, linkage.push, linkage.ties, linkage.control)
    state = sequence.state(sequence.at_rest(), np.ones(len(contacts.point)), TieHistory.none(0))
    assert state is not None
    assert state.multiplier == pytest.approx(worst.multiplier, rel=1e-6)
    block, point, along = sequence.control
    centre = sequence.at_rest().centre[block]
    vx, vy, turn = state.velocity[block]
    arm = np.asarray(point) - centre
    assert np.array([vx - turn * arm[1], vy + turn * arm[0]]) @ along == pytest.approx(1.0)  # the control point
    arms = contacts.point - centre  # one macro-block on the ground
    speed = np.hypot(vx - turn * arms[:, 1], vy + turn * arms[:, 0])
    assert len(worst.mechanics.blocks) == 1
    presses = state.normal_force > 1e-9 * state.normal_force.max()
    np.testing.assert_array_equal(state.stays, presses & (speed < 1e-8))
    assert state.stays.any() != slides
    assert presses.any()


def on_its_foot(d: int, unit: float) -> Sequence:
    """Return a block of 1 x 3 (depth 2) on the ground and its twin, contacts at their corners in turn; any unit."""
    foot = unit * (np.array([[0.0, 0.0], [1.0, 0.0]]) if d == 2 else
                   np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 2.0, 0.0]]))  # fmt: skip
    foot = np.stack([foot + 4.0 * unit * np.eye(d)[0], foot], axis=1).reshape(-1, d)
    m, up = len(foot), np.eye(d)[-1]
    contacts = FacePoints(
        np.full(m, NOWHERE), (np.arange(m) + 1) % 2, np.zeros(m, dtype=int), foot, np.tile(up, (m, 1)),
        np.tile(np.eye(d)[:-1], (m, 1, 1)), np.full((m, d - 1), -np.inf), np.full((m, d - 1), np.inf),
        Laws.coulomb(0.5, m), np.ones(m),
    )  # fmt: skip
    centre = unit * (np.array([0.5, 1.5]) if d == 2 else np.array([0.5, 1.0, 1.5]))
    blocks = [SimpleNamespace(centre=centre), SimpleNamespace(centre=centre + 4.0 * unit * np.eye(d)[0])]
    mechanics = SimpleNamespace(blocks=blocks, reach=lambda points: 2.5 * unit)
    return Sequence(mechanics, contacts, (), (), (), (0, centre, np.eye(d)[0]))


def moving(sequence: Sequence, velocity: np.ndarray, presses: np.ndarray, stays: np.ndarray) -> State:
    """Return the state at rest of the first block with a velocity; some contacts press, some do not slide."""
    q = sequence.at_rest()
    now, none = stated(sequence.contacts, q, sequence.size), np.zeros(0)
    both, forces = np.array([velocity, 0.0 * velocity]), presses.astype(float)
    return State(q, 0.1, both, forces, stays, now, none, none, TieHistory.none(0))


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("unit", [2e-3, 1.0, 500.0])
def test_a_step_puts_back_what_presses_and_what_sticks(d: int, unit: float) -> None:
    """A block turns about the right end of its foot, but for what a step leaves: it lifts, and slides along and across.

    One corner of the toe sticks. Where the block stands afterwards is that of the turn alone, but for the square of
    what was wrong.
    """
    sequence = on_its_foot(d, unit)
    toe = sequence.contacts.point[:, 0] == unit
    sticks = np.arange(len(toe)) == len(toe) - 1
    centre = sequence.mechanics.blocks[0].centre
    spin = np.array([-1.0]) if d == 2 else np.array([0.0, 1.0, 0.0])
    arm = centre - unit * np.eye(d)[0]
    along = np.array([arm[-1], *(d - 2) * [0.0], -arm[0]])
    turns = np.concatenate([along, spin])
    exact = sequence.at_rest().moved(np.array([turns, 0.0 * turns]), 0.01)
    astray = 1e-3 * unit * np.array([0.6, 0.5] if d == 2 else [0.6, -0.4, 0.5])
    last = moving(sequence, np.concatenate([along + astray, spin]), toe, sticks)
    found = sequence.step(last, 0.01)
    assert found is not None
    now = stated(sequence.contacts, found, sequence.size)
    assert np.abs(now.gap[toe]).max() <= 1e-9 * unit
    assert np.abs(now.drift[sticks]).max() <= 1e-9 * unit
    assert now.gap[(sequence.contacts.b == 0) & ~toe] == pytest.approx(unit * np.sin(0.01), rel=1e-3)
    assert found.centre == pytest.approx(exact.centre, abs=1e-4 * unit)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("unit", [2e-3, 1.0, 500.0])
def test_contacts_without_a_force_do_not_sink_in_a_step(d: int, unit: float) -> None:
    """The left end of the foot presses; the right one touches, and would sink by a hundredth of the way."""
    sequence = on_its_foot(d, unit)
    left = sequence.contacts.point[:, 0] == 0.0
    velocity = np.zeros(d + (1 if d == 2 else 3))
    velocity[0], velocity[d - 1] = 1.0, -5e-3  # slides, and turns about the left end
    velocity[d if d == 2 else d + 1] = (-0.01 if d == 2 else 0.01) / unit
    last = moving(sequence, velocity, left, np.zeros(len(left), dtype=bool))
    length = 1e-4 * unit
    moved = stated(sequence.contacts, last.q.moved(last.velocity, length), sequence.size)
    own = sequence.contacts.b == 0
    assert moved.gap[own & ~left].max() < -0.5e-6 * unit
    found = sequence.step(last, length)
    assert found is not None
    now = stated(sequence.contacts, found, sequence.size)
    assert np.abs(now.gap).max() <= 1e-9 * unit
    assert now.drift[:, 0] == pytest.approx(length * own, rel=1e-3, abs=1e-9 * unit)


@pytest.mark.parametrize("d", [2, 3])
def test_a_tie_between_two_blocks_pulls_both_with_its_force(d: int) -> None:
    """Along itself, against each other, whichever end is written first; one to the ground pulls its block alone."""
    base = on_its_foot(d, 1.0)
    first, second = (tuple(float(v) for v in b.centre + 0.3 * np.eye(d)[-1]) for b in base.mechanics.blocks)

    def pulled(a: str, at_a: tuple[float, ...], b: str, at_b: tuple[float, ...], of: tuple[int, int]) -> np.ndarray:
        bar = concio.Tie("bar", a, at_a, b, at_b, stiffness=100.0, prestress=2.5)
        sequence = replace(base, ties=((bar, *of),))
        forces, longer, load = sequence.pulls(sequence.at_rest(), TieHistory.none(1))
        assert forces == pytest.approx([2.5])
        assert longer == pytest.approx([0.0])
        found: np.ndarray = load.reshape(2, -1)
        return found

    both, swapped = pulled("0", first, "1", second, (0, 1)), pulled("1", second, "0", first, (1, 0))
    np.testing.assert_allclose(both, swapped, atol=1e-15)
    np.testing.assert_allclose(both[0, :d], 2.5 * np.eye(d)[0], atol=1e-15)
    np.testing.assert_allclose(both[1, :d], -2.5 * np.eye(d)[0], atol=1e-15)
    np.testing.assert_allclose(pulled("0", first, "", second, (0, GROUND))[0], both[0], atol=1e-15)
    np.testing.assert_allclose(pulled("", second, "0", first, (GROUND, 0))[0], both[0], atol=1e-15)
    assert not pulled("", second, "0", first, (GROUND, 0))[1].any()
