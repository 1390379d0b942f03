"""The least tie, grout or load for a target, beside a bisection of multipliers that are solved again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio import InputError, Tie
from concio.contact.assembly import assemble
from concio.model.model import Model
from concio.solvers.statics.associated_limit import associated_limit
from samples import sample


def multiplier(model: Model) -> float:
    assembly = assemble(model)
    dead = assembly.problem({"live": 0.0})
    return associated_limit(dead, assembly.problem({"live": 1.0}).f - dead.f).multiplier


def bisected(made: Callable[[float], Model], target: float, high: float) -> float:
    """Return the least amount whose multiplier reaches the target, between nothing and ``high``."""
    low = 0.0
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (low, middle) if multiplier(made(middle)) >= target else (middle, high)
    return high


def wall(friction: float, at: float) -> Model:
    """Return a strip of six courses, pushed to the right, with a tie and a load on top."""
    made = concio.column(width=0.5, height=3.0, blocks=6, block="rigid", unit_weight=20.0, friction=friction,
                         horizontal=1.0)  # fmt: skip
    name = made.free_bodies[int(6 * at / 3.0 - 1e-9)].name
    left = float(min(made.free_bodies[0].vertices[:, 0]))
    rod = Tie("rod", name, (left + 0.5, at), "", (left - 3.0, at), stiffness=1e4, yield_force=3.0)
    roof = concio.Load("point", (0.0, -4.0), bodies=(made.free_bodies[-1].name,), at=(left + 0.2, 3.0), group="roof")
    return replace(made, ties=(rod,), loads=(*made.loads, roof))


@pytest.mark.long
@settings(max_examples=sample(2, 4, 10), deadline=None)
@given(st.floats(0.3, 0.9), st.floats(0.8, 2.9), st.floats(1.05, 1.6))
def test_the_least_tie_is_that_of_a_bisection(friction: float, at: float, more: float) -> None:
    model = wall(friction, at)
    found = concio.limit(model, path=False, search=False)
    bare = multiplier(replace(model, ties=()))
    least = found.least(more * bare, tie="rod")
    assert least.before == pytest.approx(bare, rel=1e-9)

    def tied(force: float) -> Model:
        return replace(model, ties=tuple(replace(t, yield_force=max(force, 1e-9)) for t in model.ties))

    if multiplier(tied(1e4)) < more * bare:
        assert least.amount == float("inf")
        return
    assert least.amount == pytest.approx(bisected(tied, more * bare, 1e3), rel=1e-6)
    assert least.reached >= more * bare * (1 - 1e-10)
    assert least.programmes < 20


@settings(max_examples=sample(2, 4, 8), deadline=None)
@given(st.floats(0.5, 0.9), st.lists(st.floats(0.3, 2.9), min_size=2, max_size=4, unique=True), st.floats(1.1, 1.5))
def test_the_best_height_of_a_tie_needs_the_least_of_all(friction: float, heights: list[float], more: float) -> None:
    """Each height by itself, drawn there; the tie moves with its block."""
    model = wall(friction, 2.9)
    bare = multiplier(replace(model, ties=()))
    placed = concio.limit(model, path=False, search=False).least(more * bare, tie="rod", heights=heights)
    assert list(placed.by_height) == heights
    for height, amount in placed.by_height.items():
        alone = concio.limit(wall(friction, height), path=False, search=False).least(more * bare, tie="rod")
        assert amount == pytest.approx(alone.amount, rel=1e-9)
    assert placed.amount == min(placed.by_height.values()) == placed.by_height[placed.height]


def test_heights_are_those_of_a_tie_that_meets_a_block() -> None:
    found = concio.limit(wall(0.6, 2.9), path=False, search=False)
    refused = (
        ({"tie": "rod", "heights": [9.0]}, "meets no body"), ({"tie": "rod", "heights": []}, "no height"),
        ({"load": "roof", "heights": [1.0]}, "those of a tie"),
    )  # fmt: skip
    for named, words in refused:
        with pytest.raises(InputError, match=words):
            found.least(0.3, **named)  # type: ignore[arg-type]


def test_grout_and_load_are_those_of_a_bisection() -> None:
    model = replace(wall(0.2, 2.9), ties=())
    found = concio.limit(model, path=False, search=False)
    bare = multiplier(model)

    def grouted(c: float) -> Model:
        return replace(model, laws={k: replace(v, cohesion=c) for k, v in model.laws.items()})

    law = next(iter(model.laws))
    grout = found.least(bare * 0.7, cohesion=law)
    assert grout.amount == 0.0
    high = min(0.95 * multiplier(grouted(1e3)), 1.3 * bare)
    if high > bare * 1.001:
        assert found.least(high, cohesion=law).amount == pytest.approx(bisected(grouted, high, 1e3), rel=1e-6)

    def loaded(factor: float) -> Model:
        loads = (replace(v, value=tuple(factor * x for x in v.value)) if v.group == "roof" else v for v in model.loads)
        return replace(model, loads=tuple(loads))

    none, much = multiplier(loaded(0.0)), multiplier(loaded(30.0))
    target = none + 0.6 * (much - none)
    assert much > none
    assert found.least(target, load="roof").amount == pytest.approx(bisected(loaded, target, 30.0), rel=1e-6)


def test_what_no_amount_does_is_infinite() -> None:
    """A tie at its foot does not keep a pillar from tipping."""
    model = wall(0.9, 2.9)
    low = replace(model.ties[0], at_a=(model.ties[0].at_a[0], 0.0), at_b=(model.ties[0].at_b[0], 0.0),
                  body_a=model.free_bodies[0].name)  # fmt: skip
    found = concio.limit(replace(model, ties=(low,)), path=False, search=False)
    assert found.least(0.5, tie="rod").amount == float("inf")


def test_one_strengthening_is_named() -> None:
    found = concio.limit(wall(0.6, 2.9), path=False, search=False)
    with pytest.raises(InputError, match="name one strengthening"):
        found.least(0.3)
    with pytest.raises(InputError, match="there is no tie 'rot'"):
        found.least(0.3, tie="rot")
