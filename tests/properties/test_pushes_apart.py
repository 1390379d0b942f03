"""A push of a structure is its own: what stands elsewhere changes no digit of its curve, while it carries more.

Each structure is pushed beside another one of any size and weight, which shares the multiplier and nothing else.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from test_motions_apart import same
from test_parts_apart import LAWS, another, box, model, stack

import concio
from concio.analysis.motion.push_result import PushEnding
from samples import sample

few = settings(max_examples=sample(1, 4, 8), deadline=None)


def numbers(found, names):
    return [k for k, b in enumerate(found.model.bodies) if b.name in names]


@pytest.mark.long
@few
@given(
    st.sampled_from(["rigid", "rigid", "elastic"]), st.sampled_from(list(LAWS)), st.floats(-3, 2), st.floats(-6, 6),
    st.booleans(), st.sampled_from([None, "load", "point"]),
)  # fmt: skip
@example(kind="rigid", law="cohesive", size=0.0, weight=2.0, first=False, control="point")  # the other gives way
def test_an_unconnected_body_changes_no_digit_of_a_push(kind, law, size, weight, first, control):
    asked = {"until": 0.1} if control != "load" else {"until": 0.3, "step": 0.1}
    if control is not None:
        asked["control"] = concio.ControlPoint("high", (0.2, 1.3)) if control == "point" else control
    here, there = stack(2, kind), another(2, 10.0**size, 7.0, "rigid")
    alone = concio.push(model(2, here, kind, law), **asked)
    bodies = [*there, *here] if first else [*here, *there]
    both = concio.push(model(2, bodies, kind, law, weight=10.0**weight), **asked)
    assert both.certified
    if control != "point" and any("around 'other'" in line for line in both.verdict.limits):
        assert both.peak <= alone.peak * (1 + 1e-9), "the one with the least peak leads"
        return
    if control == "point" and both.ending is PushEnding.NO_EQUILIBRIUM is not alone.ending:
        only = concio.push(model(2, there, kind, law, weight=10.0**weight), until=0.1)
        assert both.peak <= only.peak * (1 + 1e-9) < alone.peak, "the other carries less than the curve asks for"
        assert both.verdict.exit_code == 4
        return
    assert both.ending is alone.ending
    if control != "load":
        same(both.displacement, alone.displacement)
    same(both.multiplier, alone.multiplier)
    own = numbers(both, ("ground", "low", "high"))
    same(both.centre[:, own], alone.centre)
    same(both.rotation[:, own], alone.rotation)
    same(both.reaction[:, both.reactions_of.index("ground")], alone.reaction[:, 0])
    events = [(e.step, e.kind, e.bodies) for e in both.events if "other" not in e.bodies]
    assert events == [(e.step, e.kind, e.bodies) for e in alone.events]


@pytest.mark.long
@pytest.mark.parametrize("first", [False, True][: sample(1, 2)])
def test_the_structure_with_the_least_peak_leads_and_the_other_is_unloaded(first):
    """A block 0.5 m x 2 m turns over at 0.25 and falls at 0.25 m; one of 1 m x 2 m beside it would at 0.5."""
    slender = [box(2, "ground", (-1, -1), (1, 0), "fixed"), box(2, "slender", (-0.25, 0), (0.25, 2))]
    stout = [box(2, "other ground", (6, -1), (9, 0), "fixed"), box(2, "stout", (7, 0), (8, 2), material="other")]
    bodies = [*slender, *stout] if first else [*stout, *slender]
    found = concio.push(model(2, bodies, "rigid", "hard", weight=2e5))
    assert found.peak == pytest.approx(0.25, rel=2e-4)
    assert found.capacity == pytest.approx(0.25, rel=2e-4)
    assert found.ending is PushEnding.LOST
    k = numbers(found, ("stout",))[0]
    assert np.abs(found.rotation[:, k]).max() < 1e-3
    assert any("around 'slender'" in line for line in found.verdict.limits)
    at = found.reactions_of.index("other ground")
    weight = 2e5 * 2.0
    np.testing.assert_allclose(-found.reaction[:, at, 0], weight * found.multiplier, atol=1e-6 * weight)
    np.testing.assert_allclose(found.reaction[:, at, 1], weight, rtol=1e-9)
    led = concio.push(found.model, control=concio.ControlPoint("stout", (7.5, 1.0)))
    assert led.peak == pytest.approx(0.25, rel=1e-3), "it cannot carry more than the slender one"
    assert led.ending is PushEnding.NO_EQUILIBRIUM


@pytest.mark.long
def test_what_leans_on_another_is_pushed_with_it():
    """A slender block turns over towards a stout one 0.25 m away, which then holds it up."""
    slender, stout = box(2, "slender", (0, 0), (0.4, 2)), box(2, "stout", (0.65, 0), (2.65, 2))
    found = concio.push(model(2, [box(2, "ground", (-1, -1), (4, 0), "fixed"), slender, stout], "rigid", "hard"))
    assert len(found.structures) == 1
    assert found.certified
    assert any(e.kind == "touches" and set(e.bodies) == {"slender", "stout"} for e in found.events)
    assert found.peak > 0.3, "alone it turns over at 0.2"
