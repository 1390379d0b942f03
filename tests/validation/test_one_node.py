"""One node, large friction (Klarbring 1990): several solutions, and a path that jumps."""

from __future__ import annotations

from hypothesis import assume, given, settings
from hypothesis import strategies as st
from validation_cases import one_node
from validation_cases.row import check

from concio.solvers.path.event_path import Outcome
from samples import sample


def test_rows():
    check(one_node.rows())


@settings(max_examples=sample(20, 60), deadline=None)
@given(st.floats(0.0, 3.0), st.floats(-4.0, 4.0))
def test_an_answer_is_always_one_of_the_solutions(mu, load):
    assume(mu == 0.0 or mu > 1e-3)
    assume(abs(mu - one_node.K_TT / one_node.C) > 0.01)  # there the slip equation is singular
    assume(abs(abs(load) - mu * one_node.Q) > 1e-3)  # at the cone's edge with u = 0: nothing to measure errors against
    solution = one_node.answer(mu, load)
    assert solution.solved
    assert one_node.distance(mu, load, "auto") <= 1e-8 * (1 + abs(load)) / abs(1 - mu)


def test_the_path_jumps_where_only_a_distant_state_is_left():
    """From stick to open at large friction; at small friction it slips, then opens, without a jump."""
    rough, fair = one_node.path(2.0, 5.0), one_node.path(0.5, 5.0)
    assert rough.outcome is Outcome.REACHED
    assert [(e.kind, e.step) for e in rough.events] == [("jumps", 2), ("opens", 2)]
    assert fair.outcome is Outcome.REACHED
    assert not fair.jumps
