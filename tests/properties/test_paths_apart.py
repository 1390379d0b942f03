"""A path of a structure is that of each of its connected parts: what stands elsewhere changes no digit of it.

Each structure stands beside another one of any size and weight; the path of both has the corners of each alone, and
ends where the first one ends.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_parts_apart import LAWS, another, model, same, stack

import concio
from concio.model.model import Load, Tie
from concio.model.stages import ControlPoint, Stage
from concio.problem.parts import connected_parts, parts_of
from concio.solvers.path.paths_apart import put_together, state_of_part
from concio.solvers.path.record import Outcome
from samples import sample

few = settings(max_examples=sample(2, 12, 40), deadline=None)
NAMES = ("normal_force", "friction_force", "slip", "offset")


def column(size, height=4.0):
    """Another structure: a column on a ground of its own, which tips at 1.3 / height of its weight."""
    ground, block = another(2, size, 7.0, "rigid")
    corners = ((0, 0), (1.3, 0), (1.3, height), (0, height))
    return [ground, replace(block, outline=[(7.0 + x * size, z * size) for x, z in corners])]


def pushed(dim, bodies, kind, law, weight=20.0, ties=()):
    """A model whose weights act downwards as dead and sideways as live load."""
    found = model(dim, bodies, kind, law, weight=weight)
    down, side = ((0.0, -1.0), (1.0, 0.0)) if dim == 2 else ((0.0, 0.0, -1.0), (1.0, 0.0, 0.0))
    return replace(found, loads=(Load("weight", down, group="dead"), Load("weight", side, group="live")), ties=ties)


@cache
def exact(kind, law, live):
    """The path of the stack alone."""
    return concio.run_path(pushed(2, stack(2, kind), kind, law), stages(live))


def stages(live, control=None):
    until = 5e-3 if control else 0.0
    return (Stage("dead", {"dead": 1.0}), Stage("live", {"live": live}, control=control, until=until))


def of_rest(path):
    """Return the pairs and the unknowns of the bodies that do not belong to the other structure."""
    names = [b.name for b in path.assembly.model.bodies]
    pairs = np.array([names[b] not in ("other", "other ground") for b in path.assembly.pairs.body_b])
    parts = connected_parts(path.assembly.problem())
    unknowns = np.isin(parts.of_unknown, parts.of_pair[pairs])
    return pairs, unknowns


def at_corners(alone, both):
    """Compare every state of the rest at the corners of its own path; return how many were compared."""
    pairs, unknowns = of_rest(both)
    compared = 0
    for step in alone.steps:
        found = [s for s in both.steps if s.stage == step.stage and abs(s.parameter - step.parameter) < 1e-13]
        found = [s for s in found if np.array_equal(s.state.contact[pairs], step.state.contact)] or found
        last = both.steps[-1]
        if not found:
            assert (step.stage, step.parameter) > (last.stage, last.parameter * (1 - 1e-12)), "it has ended before"
            continue
        error = min(np.abs(s.state.displacement[unknowns] - step.state.displacement).max() for s in found)
        assert error <= 1e-13 * np.abs(step.state.displacement).max()
        for name in NAMES:
            values = [getattr(s.state, name)[pairs] for s in found]
            wanted = getattr(step.state, name)
            nearest = min(values, key=lambda v, w=wanted: float(np.abs(v - w).max(initial=0.0)))
            unit = step.state.displacement if name in ("slip", "offset") else step.state.normal_force
            np.testing.assert_allclose(nearest, wanted, rtol=1e-13, atol=1e-13 * np.abs(unit).max(initial=0.0))
        compared += 1
    return compared


def events_of(path, *, without=("other", "other ground")):
    return [(e.stage, e.kind, e.bodies, e.at) for e in path.events if not set(e.bodies) & set(without)]


@pytest.mark.long
@few
@given(
    st.sampled_from(["rigid", "elastic"]), st.sampled_from(list(LAWS)), st.floats(-3, 2), st.floats(-6, 6),
    st.booleans(), st.sampled_from([0.2, 3.0]),
)  # fmt: skip
def test_an_unconnected_body_changes_no_digit_of_an_exact_path(kind, law, size, weight, first, live):
    here, there = stack(2, kind), column(10.0**size)
    alone = exact(kind, law, live)
    other = concio.run_path(pushed(2, there, "rigid", law, 10.0**weight), stages(live))
    bodies = [*there, *here] if first else [*here, *there]
    both = concio.run_path(pushed(2, bodies, kind, law, 10.0**weight), stages(live))
    assert at_corners(alone, both) >= 2
    assert both.certified
    assert both.energy_error < 1e-9
    ends = sorted([alone, other], key=lambda p: (p.complete, p.steps[-1].parameter))
    assert both.outcomes[-1] is ends[0].outcomes[-1]
    assert both.steps[-1].factors["live"] == pytest.approx(ends[0].steps[-1].factors["live"], rel=1e-12)
    assert both.verdict.outcome is ends[0].verdict.outcome
    if ends[0] is alone:
        assert events_of(both) == events_of(alone)
    if alone.collapsed and ends[0] is alone:
        _, unknowns = of_rest(both)
        same(both.direction[unknowns], alone.direction)
        assert not both.direction[~unknowns].any(), "what stands has no part in the motion"


@few
@given(
    st.sampled_from(["rigid", "elastic"]), st.sampled_from(["stiff", "cohesive"]), st.floats(-3, 2), st.floats(-6, 6)
)  # fmt: skip
def test_nor_of_a_path_under_the_motion_of_a_point(kind, law, size, weight):
    """The load goes up and down with the structure that holds the point; the other follows it."""
    top = ControlPoint("high", (0.2, 1.3))
    here, there = stack(2, kind), column(10.0**size, 0.1)
    alone = concio.run_path(pushed(2, here, kind, law), stages(1.0, top))
    both = concio.run_path(pushed(2, [*here, *there], kind, law, 10.0**weight), stages(1.0, top))
    _, load = alone.load()
    if both.outcomes[-1] is alone.outcomes[-1] and both.steps[-1].parameter == alone.steps[-1].parameter:
        assert events_of(both) == events_of(alone)
    else:
        assert both.steps[-1].factors["live"] <= load.max()
    assert at_corners(alone, both) >= 2
    assert both.certified


@few
@given(
    st.sampled_from([2, 3]), st.sampled_from(["rigid", "elastic"]), st.sampled_from(list(LAWS)), st.floats(-3, 2),
    st.floats(-6, 6), st.booleans(),
)  # fmt: skip
def test_an_unconnected_body_that_stands_changes_no_digit_of_load_steps(dim, kind, law, size, weight, first):
    """In plane and space; one that changes so much that it asks for smaller steps makes those of all smaller."""
    here, there = stack(dim, kind), another(dim, 10.0**size, 7.0, "rigid")
    asked = (Stage("dead", {"dead": 1.0}, steps=2), Stage("live", {"live": 0.1}, steps=2))
    alone = concio.run_path(pushed(dim, here, kind, law), asked, method="steps")
    other = concio.run_path(pushed(dim, there, "rigid", law, 10.0**weight), asked, method="steps")
    bodies = [*there, *here] if first else [*here, *there]
    both = concio.run_path(pushed(dim, bodies, kind, law, 10.0**weight), asked, method="steps")
    assert both.certified
    assert both.complete == (alone.complete and other.complete)
    if len(both.steps) == len(alone.steps):
        assert at_corners(alone, both) == len(alone.steps)
    else:
        assert len(other.steps) > 4, "steps are smaller where the other one needs smaller ones"


def test_a_part_that_snaps_or_has_no_load_of_its_own_follows():
    """One part without weight, one tied to nothing else, one that is loaded in the second stage only."""
    light = another(2, 1.0, 7.0, "rigid")
    both = pushed(2, [*stack(2, "rigid"), *light], "rigid", "stiff", 1e-30)
    alone = concio.run_path(pushed(2, stack(2, "rigid"), "rigid", "stiff"), stages(0.2))
    found = concio.run_path(both, stages(0.2))
    assert at_corners(alone, found) == len(alone.steps)


def test_a_tie_that_breaks_is_found_at_the_same_load():
    tie = Tie("bar", "high", (0.2, 1.3), body_b="", at_b=(-1.0, 1.3), stiffness=1000.0, break_elongation=2e-3)
    alone = concio.run_path(pushed(2, stack(2, "rigid"), "rigid", "stiff", ties=(tie,)), stages(3.0))
    held = Tie("held", "other", (7.0, 2.0), body_b="", at_b=(-9.0, 2.0), stiffness=1e6)  # it would slide before
    both = concio.run_path(
        pushed(2, [*column(50.0, 0.1), *stack(2, "rigid")], "rigid", "stiff", 1e3, ties=(tie, held)), stages(3.0)
    )
    breaks = [[e.parameter for e in p.events if e.kind == "breaks"] for p in (alone, both)]
    assert len(breaks[0]) == 1
    assert breaks[1] == pytest.approx(breaks[0], rel=1e-12)


@few
@given(st.sampled_from([2, 3]), st.integers(0, 99))
def test_states_come_apart_and_together_again(dim, seed):
    assembly = concio.assemble(pushed(dim, [*stack(dim, "rigid"), *another(dim, 1.0, 7.0, "rigid")], "rigid", "stiff"))
    problem = assembly.problem()
    rng = np.random.default_rng(seed)
    rest = concio.solvers.path.path_state.at_rest(problem)
    m, s = problem.pairs, dim - 1
    state = replace(
        rest, displacement=rng.normal(size=problem.unknowns), normal_force=rng.normal(size=m),
        friction_force=rng.normal(size=(m, s)), slip=rng.normal(size=(m, s)), offset=rng.normal(size=m), work=3.0,
    )  # fmt: skip
    parts = parts_of(problem)
    assert len(parts) == 2
    whole = put_together(replace(rest, work=3.0), parts, [state_of_part(state, p) for p in parts])
    for name in ("displacement", *NAMES):
        np.testing.assert_array_equal(getattr(whole, name), getattr(state, name))
    assert whole.work == 3.0


@pytest.mark.long
def test_the_first_part_to_end_ends_the_path():
    """A column of 1.3 x 4 tips at 0.325, the stack holds up to 0.6."""
    ends = {}
    for name, bodies in (("stack", stack(2, "rigid")), ("block", column(1.0))):
        ends[name] = concio.run_path(pushed(2, bodies, "rigid", "hard"), stages(3.0))
    both = concio.run_path(pushed(2, [*stack(2, "rigid"), *column(1.0)], "rigid", "hard"), stages(3.0))
    limits = {name: p.steps[-1].factors["live"] for name, p in ends.items()}
    assert limits["block"] == pytest.approx(1.3 / 4.0)
    assert both.outcomes[-1] in (Outcome.LIMIT, Outcome.MECHANISM)
    assert both.steps[-1].factors["live"] == pytest.approx(min(limits.values()), rel=1e-12)
