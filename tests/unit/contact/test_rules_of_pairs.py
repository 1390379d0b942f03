"""The law of every joint is that of the last rule that matches its two bodies, whatever words the rules use."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.contact.laws import RuleBook
from samples import sample

WORD = st.sampled_from(["*", "n-*", "s-*", "*-1", "?-*1", "n-1", "ground", "wall", "arch", "top", "stone", "brick"])
LAW = st.sampled_from(["a", "b", "c"])
LAWS = {"a": concio.JointLaw(0.7), "b": concio.JointLaw(0.5), "c": concio.JointLaw(0.3)}


def block(name: str, left: float, role: str, layer: str, material: str) -> concio.Body:
    corners = [(left, 0.0), (left + 1, 0.0), (left + 1, 0.4), (left, 0.4)]
    return concio.Body(name, corners, material=material, kind="rigid", role=role, layer=layer)


@st.composite
def models(draw: st.DrawFn, *, alike: bool = False) -> concio.Model:
    floor = concio.Body("g", [(-1, -1), (20, -1), (20, 0), (-1, 0)], kind="fixed", role="ground")
    choice = [st.sampled_from(words) for words in (("wall", "arch"), ("", "top"), ("stone", "brick"))]
    names = ("n-1", "n-2", "s-1", "s-2", "w")
    first = [draw(words) for words in choice]
    blocks = [block(name, 2.0 * k, *(first if alike else map(draw, choice))) for k, name in enumerate(names)]
    bodies = (floor, *blocks)
    materials = {name: concio.Rigid(unit_weight=20.0) for name in ("stone", "brick")}
    known = {word for b in bodies for word in (b.role, b.layer, b.material if b.kind != "fixed" else "", b.name)}
    word = WORD.filter(lambda w: "*" in w or w in known)
    rule = st.builds(concio.JointRule, LAW, st.tuples(word, word), st.sampled_from([0.0, 0.001]))
    rules = (concio.JointRule("a"), *draw(st.lists(rule, max_size=4)))
    loads = (concio.Load("weight", (0.0, -1.0)), concio.Load("weight", (1.0, 0.0), group="live"))
    return concio.Model(bodies, materials, LAWS, rules=rules, loads=loads)


@settings(max_examples=sample(100, 300, 1000), deadline=None)
@given(models())
def test_the_last_rule_that_matches_decides(model: concio.Model) -> None:
    a, b = np.array(list(itertools.permutations(range(len(model.bodies)), 2))).T
    law, opening = RuleBook(model).find(a, b)
    wanted = [model.rule_between(model.bodies[i], model.bodies[j]) for i, j in zip(a, b, strict=True)]
    assert [list(model.laws)[k] for k in law] == [rule.law for rule in wanted]
    assert opening.tolist() == [rule.gap for rule in wanted]


@settings(max_examples=sample(5, 20, 60), deadline=None)
@given(models(alike=True), st.booleans())
def test_the_first_block_to_slide_is_the_one_with_the_least_friction(model: concio.Model, space: bool) -> None:
    """The friction of the first block with such a role was that of all: "n-*" at 0.3 was carried to 0.7."""
    rules = [concio.JointRule(rule.law, rule.between) for rule in model.rules]  # without openings
    flat = concio.Model(model.bodies, model.materials, model.laws, rules=tuple(rules), loads=model.loads)
    whole = concio.extrude(flat, 0.5) if space else flat
    least = min(flat.laws[flat.rule_between(flat.body("g"), b).law].friction for b in flat.free_bodies)
    found = concio.limit(whole, ["live"], path=False, steps=False, search=False, friction=False)
    assert found.associated.multiplier == pytest.approx(least, rel=1e-6)
