"""How far a structure is from its limit, by admissible forces and by solving."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.analysis import limit as limits
from concio.analysis.margins import friction_by_solving, load_margin
from concio.problem.solution import Mechanism
from concio.solvers.statics.associated_limit import LimitLoad
from concio.verdict.limit_words import limit_lines


@pytest.fixture(scope="module")
def slender() -> concio.Model:
    """One block 0.5 x 1.0 that topples at 0.5 of its weight, or slides at its friction, whichever is less."""
    return concio.wall(length=0.5, height=1.0, block_size=(0.5, 1.0), friction=0.9, horizontal=0.3, block="rigid")


def test_both_answers_are_those_of_the_one_block(slender):
    """As given it carries 0.3 of its weight: the load may grow by 5/3, the friction fall to 0.3 of 0.9."""
    load, friction = load_margin(slender), friction_by_solving(slender)
    assert load.proven == pytest.approx(0.5 / 0.3, rel=1e-9)
    assert friction.proven == pytest.approx(0.3 / 0.9, rel=1e-6)
    assert load.proven * (1 - 2e-3) <= load.holds <= load.proven
    assert friction.proven <= friction.holds <= friction.proven + 2e-3
    assert load.solves < 15
    assert not load.fails <= load.holds
    assert not friction.fails >= friction.holds


def test_what_does_not_hold_as_given(slender):
    pushed = load_margin(slender).proven * 1.1
    found = friction_by_solving(slender, factor=pushed)
    assert np.isnan(found.holds)
    assert found.proven == np.inf  # it topples: no friction would do


def test_a_load_without_limit():
    pressed = concio.wall(length=1.0, height=0.5, friction=0.6, block="rigid", top_pressure=10.0)
    found = load_margin(pressed, "top")
    assert found.holds == np.inf
    assert found.solves > 0, "a bound that is locked says nothing of Coulomb friction"


def test_the_result_says_why_no_collapse_state_was_sought(slender, monkeypatch):
    found = concio.limit(slender, path=False)
    assert found.search == "not asked for"
    found = concio.limit(slender, path=False, search=True)
    assert found.collapse_state is not None
    assert found.collapse_state.multiplier == pytest.approx(0.5 / 0.3, rel=1e-9)
    assert found.path is None
    monkeypatch.setattr(limits, "LARGEST_SEARCH", 1)
    found = concio.limit(slender, path=False, search=True)
    assert found.collapse_state is None
    assert "more than 1" in found.search
    assert any("not tried" in line for line in limit_lines(found))
    assert found.summary()["collapse_state_search"] == found.search


def test_a_column_that_topples_moves_alike_in_both_theories():
    """About its toe as a whole: centres at heights of 0.5 and 1.5 m, half the width across."""
    column = concio.column(width=0.5, height=2.0, blocks=2, block="rigid", friction=0.9, horizontal=1.0)
    found = concio.limit(column, path=True)
    moved = found.collapse_motion().reshape(2, 3)
    assert moved[:, :2] / moved[1, 0] == pytest.approx(np.array([[1 / 3, 1 / 6], [1.0, 1 / 6]]), abs=1e-9)
    assert moved.ravel() == pytest.approx(found.mechanism(), abs=1e-9)
    assert concio.limit(column, path=False).collapse_motion() is None


def test_two_bounds_that_do_not_meet_are_both_told(slender):
    found = concio.limit(slender, path=False)
    still = Mechanism(np.zeros(3), 0.0, 0.0)
    apart = LimitLoad(0.4, 0.5, np.zeros(2), np.zeros((2, 1)), 1e-14, still)
    assert apart.bounds_hold
    assert not apart.checked
    text = "\n".join(limit_lines(replace(found, associated=apart)))
    assert "between 0.4, carried, and 0.5, not exceeded" in text
    loose = LimitLoad(0.4, 0.4, np.zeros(2), np.zeros((2, 1)), 1e-3, still)
    assert not loose.bounds_hold
