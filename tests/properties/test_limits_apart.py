"""A limit load is the least of those of the connected parts: what carries more elsewhere changes nothing of it.

Each structure stands beside another one of any size and weight; both live loads are multiplied together.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_parts_apart import another, stack
from test_paths_apart import column, pushed

import concio
from concio.verdict.verdict import Outcome
from samples import sample

few = settings(max_examples=sample(1, 4, 8), deadline=None)


@cache
def alone_of(dim, kind, law):
    return concio.limit(pushed(dim, stack(dim, kind), kind, law))


@pytest.mark.long
@few
@given(
    st.sampled_from([2, 2, 3]), st.sampled_from(["rigid", "elastic"]), st.sampled_from(["hard", "stiff"]),
    st.floats(-3, 2), st.floats(-6, 6), st.booleans(),
)  # fmt: skip
def test_what_carries_as_much_elsewhere_changes_nothing(dim, kind, law, size, weight, first):
    here, there = stack(dim, kind), another(dim, 10.0**size, 7.0, "rigid")
    alone = alone_of(dim, kind, law)
    bodies = [*there, *here] if first else [*here, *there]
    both = concio.limit(pushed(dim, bodies, kind, law, 10.0**weight))
    assert both.associated.multiplier == pytest.approx(alone.associated.multiplier, rel=1e-9)
    assert both.associated.checked
    assert both.verdict.outcome is alone.verdict.outcome is Outcome.HOLDS
    assert both.collapse_shown == alone.collapse_shown
    if alone.path is not None:
        assert both.path is not None
        assert both.path.peak == pytest.approx(alone.path.peak, rel=1e-9)
    if alone.steps is not None:
        assert both.steps is not None
        assert both.steps.carried == pytest.approx(alone.steps.carried, rel=1e-9)


@pytest.mark.parametrize("weight", sample([1e-6], [1e-9, 1e6], [1e-9, 1e-6, 1.0, 1e6]))
@pytest.mark.parametrize("size", sample([1e-3], [1e-3, 100.0], [1e-3, 1.0, 100.0]))
def test_the_least_part_decides_however_light_it_is(size, weight):
    """A column that tips at a tenth of its weight, beside a stack that slides at 0.6."""
    found = concio.limit(pushed(2, [*stack(2, "rigid"), *column(size, 13.0)], "rigid", "hard", weight=weight))
    assert found.associated.multiplier == pytest.approx(0.1, rel=1e-9)
    assert found.associated.checked
    assert found.path is not None
    assert found.path.peak == pytest.approx(0.1, rel=1e-9)
    assert found.collapse_state is not None
    assert found.collapse_state.multiplier == pytest.approx(0.1, rel=1e-9)
    moves = np.abs(found.associated.mechanism.velocity) > 0
    stays = np.abs(found.collapse_state.velocity) == 0
    assert moves.sum() == 3, "the column alone"
    np.testing.assert_array_equal(moves, ~stays)


def test_a_part_without_live_load_only_stands():
    """The load of the stack alone is multiplied; a column beside it carries its weight at any multiplier."""
    model = pushed(2, [*stack(2, "rigid"), *column(1.0, 13.0)], "rigid", "hard")
    dead, live = model.loads
    found = concio.limit(replace(model, loads=(dead, replace(live, bodies=("low", "high")))))
    alone = concio.limit(pushed(2, stack(2, "rigid"), "rigid", "hard"))
    assert found.associated.multiplier == pytest.approx(alone.associated.multiplier, rel=1e-12)
    assert found.collapse_state is not None
    assert alone.collapse_state is not None
    assert found.collapse_state.multiplier == pytest.approx(alone.collapse_state.multiplier, rel=1e-12)
    assert found.path is not None
    assert found.path.peak == pytest.approx(0.6, rel=1e-9)
