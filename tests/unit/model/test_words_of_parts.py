"""Words of a part, such as roles and layers, find the bodies of that part alone when parts are put together."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.model.body import called
from samples import sample

WORDS = ("ground", "wall", "arch", "north", "stone", "brick")
NAMES = ("p", "q", "wall")
"""Of blocks, one of which is called as others are by their role."""


@st.composite
def parts(draw: st.DrawFn) -> concio.Model:
    """Return a stack of three blocks on a fixed one, with roles, layers, materials, loads and rules in any order."""
    materials = {name: concio.Rigid(unit_weight=draw(st.sampled_from([20.0, 22.0]))) for name in ("stone", "brick")}
    fixed = concio.Body("g", [(0, -1), (1, -1), (1, 0), (0, 0)], kind="fixed", role="ground")
    blocks = [
        concio.Body(
            name,
            [(0, k), (1, k), (1, k + 1), (0, k + 1)],
            material=draw(st.sampled_from(["stone", "brick"])),
            kind="rigid",
            role=draw(st.sampled_from(["wall", "arch"])),
            layer=draw(st.sampled_from(["", "north"])),
        )
        for k, name in enumerate(NAMES)
    ]
    bodies = (fixed, *blocks)
    known = [w for w in WORDS if any(w in (b.role, b.layer, b.material) for b in bodies)]
    word = st.sampled_from([*known, *NAMES, "g", "*", "p*", "wall*"])
    word = word.filter(lambda w: "*" not in w or any(called(w, b) for b in bodies))
    laws = {name: concio.JointLaw(draw(st.sampled_from([0.3, 0.5, 0.7]))) for name in ("a", "b", "c")}
    rule = st.builds(concio.JointRule, st.sampled_from("abc"), st.tuples(word, word), st.sampled_from([0.0, 0.001]))
    general = concio.JointRule(draw(st.sampled_from(["a", "a", "a", "b"])))
    rules = [*draw(st.lists(rule, max_size=2)), general, *draw(st.lists(rule, max_size=4))]
    acted = [w for w in (*known, *NAMES) if any(w in (b.name, b.role, b.layer) for b in blocks)]
    some = st.lists(st.sampled_from(acted), min_size=1, max_size=2, unique=True).map(tuple)
    loads = tuple(
        concio.Load(kind, (0.0, -1.0), bodies=draw(some), group=kind)
        for kind in draw(st.lists(st.sampled_from(["weight", "body"]), max_size=2))
    )
    warm = tuple(concio.Temperature(10.0, bodies=draw(some)) for _ in range(draw(st.integers(0, 1))))
    return concio.Model(bodies, materials, laws, rules=tuple(rules), loads=loads, temperatures=warm)


def acting(model: concio.Model, *, prefix: str = "") -> dict[str, list[tuple[object, ...]]]:
    """Return the loads and temperatures that name each body whose name begins so."""
    found: dict[str, list[tuple[object, ...]]] = {}
    for body in model.free_bodies:
        if body.name.startswith(prefix):
            found[body.name.removeprefix(prefix)] = sorted(
                (thing.group, type(thing).__name__)
                for thing in (*model.loads, *model.temperatures)
                if any(called(word, body) for word in thing.bodies)
            )
    return found


@settings(max_examples=sample(40, 150, 600), deadline=None)
@given(st.lists(parts(), min_size=2, max_size=3), st.booleans())
def test_joints_and_loads_of_a_part_are_those_it_had(models: list[concio.Model], same: bool) -> None:
    """A rule on "ground" gave its friction to the ground of all parts, a load on "block" acted on every part twice."""
    models = [models[0]] * len(models) if same else models
    prefixes = [f"part{k}-" for k in range(len(models))]
    placed = [concio.place(m, at=(5.0 * k, 0), name=prefixes[k][:-1]) for k, m in enumerate(models)]
    whole = concio.merge(*placed)
    for prefix, part in zip(prefixes, models, strict=True):
        assert acting(whole, prefix=prefix) == acting(part)
        for a in part.bodies:
            for b in part.bodies:
                if a.name < b.name:
                    own = part.rule_between(a, b)
                    made = whole.rule_between(whole.body(prefix + a.name), whole.body(prefix + b.name))
                    assert (whole.laws[made.law], made.gap) == (part.laws[own.law], own.gap)


@pytest.mark.long
@given(st.floats(0.1, 0.45), st.floats(0.1, 0.45))
def test_a_part_slides_at_its_own_friction_beside_another(one: float, two: float) -> None:
    """tan(phi) of each: the least of both, whatever their order."""
    ground = concio.Body("g", [(-1, -1), (2, -1), (2, 0), (-1, 0)], kind="fixed", role="ground")
    block = concio.Body("b", [(0, 0), (1, 0), (1, 0.4), (0, 0.4)], material="stone", kind="rigid")
    loads = (
        concio.Load("weight", (0.0, -1.0), bodies=("block",)),
        concio.Load("weight", (1.0, 0.0), bodies=("block",), group="live"),
    )
    models = [
        concio.Model(
            (ground, block), {"stone": concio.Rigid(unit_weight=20.0)},
            {"dry": concio.JointLaw(0.6), "base": concio.JointLaw(mu)},
            rules=(concio.JointRule("dry"), concio.JointRule("base", ("ground", "*"))), loads=loads,
        )
        for mu in (one, two)
    ]  # fmt: skip
    for order in (models, models[::-1]):
        whole = concio.merge(*(concio.place(m, at=(5.0 * k, 0), name=f"p{k}") for k, m in enumerate(order)))
        found = concio.limit(whole, ["live"], path=False, steps=False, search=False, friction=False)
        assert found.associated.multiplier == pytest.approx(min(one, two))
        assert sum(size for _, size in whole_weights(whole)) == pytest.approx(16.0)


def whole_weights(model: concio.Model) -> list[tuple[str, float]]:
    """Return group and size of the vertical forces of a model [kN]."""
    assembly = concio.assemble(model)
    return [("dead", -float(assembly.problem({"dead": 1.0, "live": 0.0}).f.sum()))]
