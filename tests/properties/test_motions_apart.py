"""A motion of a structure is its own: what stands elsewhere changes no digit of it, until the two come near each other.

Each structure moves beside another one of any size and weight, which may rock, slide and rattle itself.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_parts_apart import LAWS, another, box, model, stack

import concio
from concio.analysis.motion.dynamics_result import Ending
from concio.analysis.motion.structures import near_now, structures_of, together
from concio.contact.reference import Reference
from concio.model.materials import JointLaw
from concio.model.model import Load, Tie
from concio.model.rules import JointRule
from samples import first, sample

few = settings(max_examples=sample(2, 4, 8), deadline=None)
SHAKEN = {"duration": 0.3, "step": 4e-3, "every": 4e-3, "stop_overturned": False}


def pulse(amplitude):
    return concio.Pulse("sine", amplitude, 0.25)


def same(found, wanted):
    """Equal but for rounding: where an array lies in memory decides the order in which BLAS adds, steps pass it on."""
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-8 * np.abs(wanted).max(initial=0.0))


def of_rest(found):
    """Return the numbers of the bodies that do not belong to the other structure."""
    return [k for k, b in enumerate(found.model.bodies) if b.name not in ("other", "other ground")]


def compared(alone, both):
    """Compare the rest at every time that both keep, and at the end; return how many times."""
    own = of_rest(both)
    times = np.intersect1d(np.round(alone.shots.time, 9), np.round(both.shots.time, 9))
    a, b = (np.isin(np.round(found.shots.time, 9), times) for found in (alone, both))
    for name in ("centre", "rotation"):
        same(getattr(both.shots, name)[b][:, own], getattr(alone.shots, name)[a])
    joints = [k for k, pair in enumerate(both.joints) if "other" not in pair]
    same(both.shots.opening[b][:, joints], alone.shots.opening[a])
    same(both.shots.slip[b][:, joints], alone.shots.slip[a])
    return len(times)


@pytest.mark.long
@few
@given(
    st.sampled_from(["rigid", "rigid", "elastic"]), st.sampled_from(list(LAWS)), st.floats(-3, 2), st.floats(-6, 6),
    st.booleans(), st.sampled_from([3.0, 9.0]),
)  # fmt: skip
def test_an_unconnected_body_changes_no_digit_of_a_motion(kind, law, size, weight, first, amplitude):
    here, there = stack(2, kind), another(2, 10.0**size, 7.0, "rigid")
    alone = concio.dynamics(model(2, here, kind, law), pulse(amplitude), **SHAKEN)
    bodies = [*there, *here] if first else [*here, *there]
    both = concio.dynamics(model(2, bodies, kind, law, weight=10.0**weight), pulse(amplitude), **SHAKEN)
    assert both.ending is alone.ending is Ending.COMPLETE
    assert both.certified
    assert compared(alone, both) > 60
    assert both.stands is alone.stands is True
    at = both.reactions_of.index("ground")
    same(both.steps.reaction[-1, at], alone.steps.reaction[-1, 0])
    on = {**SHAKEN, "duration": 0.05}
    compared(concio.dynamics(alone.model, start=alone.end, **on), concio.dynamics(both.model, start=both.end, **on))


@pytest.mark.long  # test_what_meets_becomes_one
def test_a_structure_that_rattles_makes_the_steps_of_no_other_smaller():
    """A slender stack rocks and hits so hard that its steps are halved; the other one slides along its floor."""
    here = stack(2, "rigid")
    low, high = box(2, "other", (7.0, 0.0), (7.2, 0.9)), box(2, "top", (7.0, 0.9), (7.2, 1.5))
    there = [box(2, "other ground", (6, -1), (9, 0), "fixed"), low, high]
    alone = concio.dynamics(model(2, here, "rigid", "hard"), pulse(5.0), **SHAKEN)
    rattles = concio.dynamics(model(2, there, "rigid", "hard"), pulse(5.0), **SHAKEN)
    assert len(rattles.steps) > len(alone.steps), "the other one makes more steps"
    both = concio.dynamics(model(2, [*here, *there], "rigid", "hard"), pulse(5.0), **SHAKEN)
    own = [k for k, b in enumerate(both.model.bodies) if b.name in ("ground", "low", "high")]
    same(both.end.centre[own], alone.end.centre)
    same(both.end.rotation[own], alone.end.rotation)
    k = [j for j in range(len(both.model.bodies)) if j not in own]
    np.testing.assert_allclose(both.end.centre[k], rattles.end.centre, atol=1e-12)
    assert both.certified
    np.testing.assert_allclose(both.energy.total, both.energy.total[0], atol=1e-9 * both.energy.turned_over)


@pytest.mark.parametrize("restitution", first(1, [0.0, 1.0]))
def test_what_meets_becomes_one(restitution):
    """A block slides without friction against another one of twice its mass, some way off."""
    bodies = [
        box(2, "ground", (-1, -1), (9, 0), "fixed"), box(2, "a", (0, 0), (1, 1)), box(2, "b", (1.4, 0), (3.4, 1)),
        box(2, "c", (20, 0), (21, 1)), box(2, "far", (19, -1), (22, 0), "fixed"),
    ]  # fmt: skip
    smooth = replace(model(2, bodies, "rigid", "hard"), laws={"joint": JointLaw(0.0)})
    assert len(structures_of(Reference.of(smooth))) == 3
    found = concio.dynamics(
        smooth, duration=0.4, step=4e-3, velocities={"a": (2.0, 0.0)}, restitution=restitution,
        stop_overturned=False, stop_at_rest=False,
    )  # fmt: skip
    v = found.end.velocity[:, 0]
    e = restitution
    assert v[1] + 2 * v[2] == pytest.approx(2.0, abs=1e-9), "momentum stays"
    np.testing.assert_allclose(v[1:4], [2 * (1 - 2 * e) / 3, 2 * (1 + e) / 3, 0.0], atol=2e-3)
    assert found.certified
    assert found.end.centre[2, 0] - found.end.centre[1, 0] > 1.5 - 1e-4, "they do not go through each other"


def test_a_tie_makes_one_of_two_and_loads_go_where_they_are_named():
    here, there = stack(2, "rigid"), another(2, 1.0, 7.0, "rigid")
    both = model(2, [*here, *there], "rigid", "hard")
    loads = (
        *both.loads, Load("point", (1.0, 0.0), bodies=("hi*",), at=(0.2, 1.0)),
        Load("pressure", (2.0,), edge=((7.0, 1.0), (8.3, 1.0)), group="snow"),
    )  # fmt: skip
    rules = (JointRule("joint"), JointRule("joint", between=("other", "*")))
    whole = Reference.of(replace(both, loads=loads, rules=rules))
    first, second = structures_of(whole)
    assert [b.name for b in first.reference.model.bodies] == ["ground", "low", "high"]
    assert [load.kind for load in first.reference.model.loads] == ["weight", "point"]
    assert [load.kind for load in second.reference.model.loads] == ["weight", "pressure"]
    assert len(first.reference.model.rules) == 1
    tie = Tie("bar", "high", (0.9, 1.0), "other", (7.0, 0.5), stiffness=100.0)
    assert len(structures_of(Reference.of(replace(both, ties=(tie,))))) == 1


def test_a_state_is_that_of_its_structures():
    """Taken apart and put together again, whatever is remembered; names of pairs are those of the whole."""
    both = model(2, [*stack(2, "elastic"), *another(2, 0.1, 7.0, "rigid")], "elastic", "stiff")
    found = concio.dynamics(both, pulse(9.0), **{**SHAKEN, "duration": 0.1})
    structures = structures_of(found.reference)
    again = together(structures, [one.part(found.end) for one in structures], found.end)
    order = [np.argsort(state.memory.key) for state in (again, found.end)]
    for name in ("key", "force", "stretch", "stored", "slid"):
        a, b = (getattr(s.memory, name)[k] for s, k in zip((again, found.end), order, strict=True))
        np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(again.strain, found.end.strain)
    assert near_now(structures, found.end) == structures
    edges = found.reference.edges
    body = edges.body[np.array(np.divmod(found.end.memory.key // 64, len(edges.body)))]
    other = np.array([b.name.startswith("other") for b in both.bodies])
    assert (other[body[0]] == other[body[1]]).all()


def test_what_is_light_is_seen_where_it_moves_by_itself():
    here = model(2, [*stack(2, "rigid"), *another(2, 0.1, 7.0, "rigid")], "rigid", "hard", weight=1e-8)
    assert concio.dynamics(here, duration=0.3, step=4e-3).verdict.unchecked == ()
    dust = box(2, "dust", (2.05, 0.0), (2.1, 0.05), material="other")  # near the stack, but touching its floor alone
    beside = concio.dynamics(model(2, [*stack(2, "rigid"), dust], "rigid", "hard", weight=1e-8), duration=0.02)
    near = box(2, "dust", (1.004, 0.0), (1.05, 0.05), material="other")
    found = concio.dynamics(model(2, [*stack(2, "rigid"), near], "rigid", "hard", weight=1e-8), duration=0.02)
    assert not any("dust" in line for line in beside.verdict.unchecked)
    assert any("dust" in line for line in found.verdict.unchecked), "they are solved as one"
