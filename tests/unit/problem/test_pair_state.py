"""States of pairs: one encoding, its views, and how they are read off an answer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import concio
from concio.problem.pair_state import Normal, PairState, PairStates
from concio.problem.solution import pair_states
from concio.solvers.methods import find
from contact_problems import wall
from models import box, on_ground, weight


def test_codes_and_views() -> None:
    states = PairStates.plane([0, 1, 1, 1, 2, 2, 0], [0, 0, 1, -1, 0, -1, 1])
    named = (PairState.OPEN, PairState.STICK, PairState.SLIP, PairState.SLIP, *2 * [PairState.CRUSHED], PairState.OPEN)
    np.testing.assert_array_equal(states.code, named)
    np.testing.assert_array_equal(states.sign, [0, 0, 1, -1, 0, -1, 1])
    np.testing.assert_array_equal(states.slips, [False, False, True, True, False, True, True])
    np.testing.assert_array_equal(states.closed, states.normal == Normal.CLOSED)
    np.testing.assert_array_equal(states[[2, 4]].code, [PairState.SLIP, PairState.CRUSHED])
    other = PairStates.plane([0, 1, 1, 1, 2, 2, 0], [0, 0, 1, 1, 0, -1, 1])
    np.testing.assert_array_equal(np.flatnonzero(states.differ(other)), [3])
    assert states.key() != other.key()
    assert states.key() == PairStates(states.normal, -1.0 * -states.direction).key()  # -0.0 is not a direction


def test_read_off_a_pushed_wall_with_a_cap() -> None:
    problem = wall(3, 3, mu=0.4, alpha=0.3)
    answer = find("interior-point")(problem)
    states = pair_states(problem, answer)
    assert set(states.code) == {PairState.OPEN, PairState.STICK, PairState.SLIP}
    slips = states.slips
    np.testing.assert_array_equal(states.sign[slips], np.sign(answer.slip[slips, 0]))
    np.testing.assert_allclose(np.abs(answer.friction_force[slips, 0]), 0.4 * answer.normal_force[slips], rtol=1e-9)
    cap = np.where(np.arange(problem.pairs) == answer.normal_force.argmax(), 0.9 * answer.normal_force.max(), np.inf)
    capped = replace(problem, laws=replace(problem.laws, cap=cap))
    crushed = pair_states(capped, find("interior-point")(capped))
    np.testing.assert_array_equal(np.flatnonzero(crushed.crushed), [answer.normal_force.argmax()])


def test_crushed_pairs_are_told_and_drawn() -> None:
    """A stiff block on a joint whose compressive strength its weight uses up under one corner."""
    law = concio.JointLaw(0.5, compressive_strength=45.0, normal_stiffness=1e4, tangential_stiffness=1e4)
    push = concio.Load("point", (0.0, -10.0), bodies=("b",), at=(0.5, 1.0), group="push")
    model = on_ground(box("b", -0.5, 0.5, 0.0, 1.0, mesh_size=0.25), loads=(weight(), push), law=law)
    result = concio.solve(model)
    assert result.solved
    assert result.contacts.count("crushed") > 0
    assert "crushed" in result.contacts.counted
    assert result.summary()["pairs"]["crushed"] == result.contacts.count("crushed")
    legend = result.plot.deformed().get_legend()
    assert "crushed" in [text.get_text() for text in legend.get_texts()]
    assert result.contacts.slip_direction.shape == result.contacts.slip.shape == (len(result.contacts), 1)
