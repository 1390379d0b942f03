"""The verdict of a limit load: what it is asked, what to design with, and what a locked bound does not say."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import concio
from concio import JointLaw, JointRule, Load, Model, Polyhedron, Rigid
from concio.analysis.limit_torsion import twisting
from concio.cli.main import app
from concio.problem.solution import PROVEN_FAILURES
from concio.report.limit_page import _numbers
from concio.verdict.italian import italian
from concio.verdict.limit_words import limit_lines
from concio.verdict.verdict import Outcome
from models import box, model_of
from samples import sample

DEAD = Load("weight", (0.0, -1.0))


def slot(width: float = 0.5, friction: float = 0.6, kind: str = "rigid", live: float = 10.0) -> Model:
    """Return two blocks between two fixed walls, nothing below: weight, and a pressure from above, pull them down."""
    material = Rigid(20.0) if kind == "rigid" else concio.Elastic(5e6, 0.2, 20.0)
    return model_of(
        box("left", -1.0, 0.0, -0.5, 1.5, kind="fixed"),
        box("right", 2 * width, 2 * width + 1, -0.5, 1.5, kind="fixed"),
        box("b1", 0.0, width, 0.0, 1.0, kind=kind),
        box("b2", width, 2 * width, 0.0, 1.0, kind=kind),
        law=friction,
        materials={"block": material},
        loads=(DEAD, Load("point", (0.0, -live), bodies=("b1",), at=(width / 2, 1.0), group="live")),
    )


def pillar(direction: tuple[float, float], at: float = 1.6, friction: float = 0.7) -> Model:
    """Return a pillar of 0.4 x 1.6 m, 12.8 kN, on the ground, with a force on its right side or its top."""
    return model_of(
        box("floor", -3, 3, -0.5, 0, kind="fixed"),
        box("pillar", -0.2, 0.2, 0, 1.6, kind="rigid"),
        law=friction,
        materials={"block": Rigid(20.0)},
        loads=(DEAD, Load("point", direction, bodies=("pillar",), at=(0.0 if at == 1.6 else 0.2, at), group="live")),
    )


@pytest.mark.long
@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_what_falls_out_of_a_slot_is_not_carried_though_its_bound_is_locked(kind: str) -> None:
    """`run` proves that it collapses; "friction and geometry carry any multiple", checked, exit 0, was the answer."""
    model = slot(kind=kind)
    assert concio.solve(model, on_failure="return", factors={"live": 0.0}).status in PROVEN_FAILURES
    found = concio.limit(model, search=False)
    verdict = found.verdict
    assert found.associated.locked
    assert verdict.outcome is Outcome.FAILS
    assert verdict.exit_code == 3
    assert verdict.sentence.startswith("Nothing can be added: under dead (20 kN) alone")
    assert found.design == 0.0
    assert "any multiple" not in "\n".join(limit_lines(found))


def test_a_load_that_nothing_carries_is_not_carried_at_any_multiple() -> None:
    """Without self-weight all multiples are alike: one proof is that of every other."""
    model = replace(slot(), loads=(slot().loads[1],))
    found = concio.limit(model, search=False, path=False, steps=True)
    assert found.associated.locked
    assert found.verdict.outcome is Outcome.FAILS
    assert "No multiple of 'live' is carried" in found.verdict.sentence
    assert found.design == 0.0


@pytest.mark.parametrize("far", [False, True])
@pytest.mark.parametrize("seed", range(sample(3, 10, 40)))
def test_a_load_without_any_other_is_carried_at_any_multiple_or_at_none(seed: int, far: bool) -> None:
    """A stone without weight under an inclined force: friction carries it or not, whatever stands far away."""
    rng = np.random.default_rng([61, seed])
    friction, carried = float(rng.uniform(0.2, 0.9)), bool(seed % 2)
    across = friction * float(rng.uniform(0.1, 0.95) if carried else rng.uniform(1.05, 2.0)) * rng.choice([-1.0, 1.0])
    size = float(rng.choice([0.5, 3.0, 100.0]))
    bodies = [box("ground", -3, 3, -1, 0, kind="fixed"), box("stone", -2, 2, 0, 0.2, kind="rigid")]
    loads = [Load("point", (across, -1.0), bodies=("stone",), at=(0.0, 0.2), group="live")]
    materials = {"block": Rigid(0.0)}
    if far:
        bodies += [
            box("far ground", 1e3 - 2 * size, 1e3 + 2 * size, -1, 0, kind="fixed"),
            replace(box("far stone", 1e3 - size, 1e3 + size, 0, size, kind="rigid"), material="heavy"),
        ]
        loads += [Load("weight", (0.0, -1.0), bodies=("far stone",))]
        materials["heavy"] = Rigid(20.0)
    model = model_of(*bodies, law=friction, materials=materials, loads=tuple(loads))
    for asked in ({}, {"path": False, "steps": False}, {"path": False, "steps": True, "search": False}):
        found = concio.limit(model, "live", **asked)
        if not carried:
            assert found.verdict.outcome is Outcome.FAILS
            assert found.verdict.headline == "No multiple of 'live' is carried."
            assert "a mechanism proves that none is in equilibrium" in found.verdict.sentence
            assert {piece.language for piece in italian(found.verdict.answer)} == {"it"}
            assert found.design == 0.0
            assert not any("what Coulomb friction carries" in line for line in found.verdict.unchecked)
            assert not any(re.search(r"(?<![e\d])-0(?![.\d])", line) for line in limit_lines(found))
        else:
            assert found.associated.locked
            if asked.get("steps", True):
                assert found.verdict.headline == "The load can grow without bound."
    assert concio.solve(model, on_failure="return").solved == carried


@pytest.mark.parametrize("scale", [1e-14, 1.0, 1e14])
@pytest.mark.parametrize("carried", [True, False])
def test_the_size_of_the_load_as_given_decides_nothing(scale: float, carried: bool) -> None:
    """A pillar of 12.8 kN tips over at 2 kN; without weight it carries nothing."""
    model = pillar((scale, 0.0), at=1.2)
    if not carried:
        model = replace(model, loads=model.loads[1:])
    found = concio.limit(model, path=False, search=False)
    if carried:
        assert found.associated.multiplier * scale == pytest.approx(12.8 * 0.2 / 1.2, rel=1e-6)
        assert found.verdict.outcome is Outcome.HOLDS
    else:
        assert found.verdict.headline == "No multiple of 'live' is carried."


def test_where_locking_is_right_it_is_said_why() -> None:
    found = concio.limit(pillar((0.0, -1.0)))
    assert found.endless
    assert found.verdict.outcome is Outcome.HOLDS
    assert "certified at any length, since no joint changes its state" in found.verdict.sentence
    assert found.summary()["grows_without_end"]
    assert found.summary()["design_multiplier"] is None


BRIDGE = """
[bridge]
span = 6.0
rise = 1.5
ring = 0.45
voussoirs = {voussoirs}
width = 4.0
block = "rigid"
unit_weight = 22.0
{law}
[fill]
cover = 0.4
unit_weight = 19.0
friction_angle = 30.0
mobilised = 0.33
[vehicle]
name = "CS 454 double 2 x 9.5 t"
position = 3.0
"""


@pytest.mark.long
@pytest.mark.parametrize("voussoirs", [8, 20])
def test_what_only_joints_that_never_crush_carry_is_no_design_value(voussoirs: int) -> None:
    """A ring of 0.45 m holds by wedging at midspan; at 5 MPa its thrust is at most 9 MN, and bounds the load."""
    hard = concio.loads(BRIDGE.format(voussoirs=voussoirs, law="friction = 0.6"))
    found = concio.limit(hard, path=False, steps=True, search=False)
    assert found.verdict.outcome is Outcome.INCOMPLETE
    assert found.verdict.headline == "No limit of 'live' was found."
    assert "Design with" not in found.verdict.sentence
    assert "give them a compressive strength" in found.verdict.answer
    assert {piece.language for piece in italian(found.verdict.answer)} == {"it"}
    assert found.summary()["design_multiplier"] is None
    assert "design value</th>" not in _numbers(found)
    law = 'friction = { friction = 0.6, compressive_strength = "5 MPa" }'
    soft = concio.limit(concio.loads(BRIDGE.format(voussoirs=voussoirs, law=law)), path=False, steps=True, search=False)
    assert soft.verdict.headline.startswith("Design with")
    assert "design value</th>" in _numbers(soft)
    assert soft.design * 186.4 <= 2 * 5e3 * 0.45 * 4.0


@pytest.mark.long
@pytest.mark.parametrize("size", sample([10.0], [0.1, 10.0], [1e-3, 0.1, 10.0, 1e3]))
@pytest.mark.parametrize("strength", [None, "5 MPa"])
def test_what_stands_far_away_does_not_make_a_design_value(size: float, strength: str | None) -> None:
    """A block on ground of its own, as heavy as 4e9 kN, whose joint may crush: the ratio was over all of the model."""
    hard = concio.loads(BRIDGE.format(voussoirs=8, law="friction = 0.6"))
    ground = box("far ground", 1e4 - size, 1e4 + size, -size, 0, kind="fixed")
    block = box("far block", 1e4 - size / 2, 1e4 + size / 2, 0, 2 * size, kind="rigid")
    law = JointLaw(0.6, compressive_strength=None if strength is None else 1e6 * size)
    both = replace(
        hard,
        bodies=(*hard.bodies, replace(block, material="far"), replace(ground, material="far")),
        materials={**hard.materials, "far": Rigid(20.0)},
        laws={**hard.laws, "far": law},
        rules=(*hard.rules, JointRule("far", between=("far ground", "far block"))),
    )
    alone, beside = (concio.limit(model, path=False, steps=True, search=False) for model in (hard, both))
    assert beside.verdict.headline == alone.verdict.headline == "No limit of 'live' was found."
    assert beside.verdict.outcome is Outcome.INCOMPLETE


@pytest.mark.parametrize("seed", range(sample(2, 8, 16)))
def test_locked_structures_agree_with_one_step_at_a_large_factor(seed: int) -> None:
    """A pillar pressed by a force that leans within its friction cone, or a block in a slot: limit against run."""
    rng = np.random.default_rng(seed)
    if seed % 2:
        lean = rng.uniform(-0.1, 0.1)
        model = pillar((lean, -1.0), at=1.6, friction=rng.uniform(0.3, 0.9))
    else:
        model = slot(rng.uniform(0.3, 0.7), rng.uniform(0.2, 0.9), live=rng.uniform(1.0, 30.0))
    found = concio.limit(model, search=False, path=False, steps=True)
    far = concio.solve(model, factors={"live": 3e3}, on_failure="return").status
    if found.endless:
        assert far.name == "SOLVED"
    if found.verdict.outcome is Outcome.FAILS:
        assert far in PROVEN_FAILURES
    assert found.endless or not found.associated.locked or found.verdict.outcome is not Outcome.HOLDS


def test_the_question_says_what_is_multiplied_and_what_acts_constantly() -> None:
    found = concio.limit(pillar((1.0, 0.0), at=0.8), path=True)
    (dead, live) = found.verdict.question.acting
    assert (dead.group, dead.role, dead.force) == ("dead", "constant", pytest.approx((0.0, -12.8)))
    assert (live.group, live.role, live.force) == ("live", "multiplied", pytest.approx((1.0, 0.0)))
    assert live.factor == pytest.approx(found.design)
    assert found.design == pytest.approx(3.2, rel=1e-6)
    assert "(3.2 kN) at most" in found.verdict.sentence
    assert found.summary()["verdict"] == found.verdict.as_dict()


@pytest.mark.long
def test_a_dead_load_that_is_not_carried_stands_first(tmp_path: Path) -> None:
    file = tmp_path / "slot.toml"
    concio.save(slot(), file)
    done = CliRunner().invoke(app, ["limit", str(file), "--no-search", "--no-friction", "--json"])
    assert done.exit_code == 3
    told = json.loads(done.output)
    assert told["verdict"]["outcome"] == "fails"
    assert told["dead_load_alone"] == "collapses"
    assert told["status"] == "collapses"


def test_what_is_odd_about_the_model_is_told() -> None:
    """A friction of 31, an angle in degrees: `run` warned, `limit` did not."""
    found = concio.limit(concio.wall(length=1.0, height=0.25, friction=31, block="rigid", horizontal=1.0), path=False)
    assert any("88.2 degrees" in line for line in found.verdict.attention)
    assert any("88.2 degrees" in line for line in limit_lines(found))


def footing(points: str | int) -> Model:
    """Return a square block of 10 kN on the ground under a couple about the vertical: 1.530 for an even pressure."""
    return Model(
        (
            Polyhedron.box("g", (-5, -5, -1), (5, 5, 0), kind="fixed"),
            Polyhedron.box("b", (0, 0, 0), (1, 1, 0.5), kind="rigid"),
        ),
        {"block": Rigid(20.0)},
        {"joint": JointLaw(0.4)},
        loads=(
            Load("weight", (0, 0, -1)),
            Load("point", (0, 1.0, 0), bodies=("b",), at=(1, 0.5, 0), group="live"),
            Load("point", (0, -1.0, 0), bodies=("b",), at=(0, 0.5, 0), group="live"),
        ),
        contact_points=points,
    )


EVEN = 0.4 * 10.0 * (np.sqrt(2) + np.log(1 + np.sqrt(2))) / 6


@pytest.mark.parametrize("points", ["auto", *(pytest.param(n, marks=pytest.mark.long) for n in (4, 8))])
def test_a_footing_that_twists_is_designed_with_an_even_pressure_whatever_its_points(points: str | int) -> None:
    """2.83, 1.26 and 0.59 with corners, 4 x 4 and 8 x 8 points; an even pressure carries 1.530."""
    found = concio.limit(footing(points))
    assert pytest.approx(1.5303, abs=1e-4) == EVEN
    assert found.design == pytest.approx(EVEN, rel=0.02)
    assert found.associated.multiplier == pytest.approx(2 * np.sqrt(2), rel=1e-6)
    if points == "auto":
        assert found.twisting == 1
        assert found.spread is not None
        assert "6 x 6 points" in found.verdict.sentence
    else:
        assert not found.state_counts
        assert "is not counted" in "\n".join(found.verdict.limits)


@pytest.mark.parametrize("points", ["corners", 4, 6, 8, 12][: sample(1, 3, 5)])
def test_the_headline_of_a_twisted_footing_lies_within_a_thousandth_of_even_pressure(points: str | int) -> None:
    """It went 1.503, 1.547, 1.503 with the grid, steps being a hundredth of a bound of 2.83; now both are given."""
    found = concio.limit(footing(points), search=False)
    assert found.spread is not None
    assert found.design == found.spread.carried
    assert EVEN * (1 - 1e-3) < found.spread.carried < EVEN * (1 + 2e-5)
    assert EVEN * (1 - 2e-5) < found.spread.not_reached < found.spread.carried * (1 + 2e-3)
    assert f"{found.spread.not_reached:.6g} was tried and not reached" in found.verdict.sentence
    summary = found.summary()
    assert summary["coulomb_spread_steps_carry"] == found.spread.carried
    assert summary["coulomb_spread_steps_fail"] == found.spread.not_reached


@pytest.mark.parametrize(("most", "more"), [(15_000, "on request (--steps)"), (15, "too large")])
def test_a_design_value_of_corners_that_twist_is_subject_to_torsion(
    monkeypatch: pytest.MonkeyPatch, most: int, more: str
) -> None:
    """Where the pressure was not spread the headline said "Design with 2.83" of a footing that carries 1.53."""
    monkeypatch.setattr("concio.analysis.limit.UNASKED_SPREAD", 0)
    monkeypatch.setattr("concio.verdict.torsion_of_limits.LARGEST_SEARCH", most)
    found = concio.limit(footing("auto"))
    verdict = found.verdict
    assert found.spread is None
    assert found.design > 1.5 * EVEN
    for said in (verdict.headline, verdict.answer):
        assert "at most, unless torsion governs (1 joint twists)" in said
    (open_,) = [said for said in verdict.unchecked if said.startswith("whether torsion governs")]
    assert more in open_
    assert "up to 1.85 times better" in open_
    corners = "1 joint with contact at its corners twists", "98 joints with contact at their corners twist"
    for said in (verdict.headline, open_):
        for text in (said, said.replace(*corners).replace("1 joint twists", "98 joints twist")):
            assert {piece.language for piece in italian(text)} == {"it"}


def test_a_bound_alone_is_subject_to_torsion_too() -> None:
    """2.83 was said of a footing that an even pressure turns at 1.53, without a word of torsion."""
    found = concio.limit(footing("auto"), path=False, steps=False, search=False)
    (open_,) = [said for said in found.verdict.unchecked if said.startswith("whether torsion governs")]
    assert "all numbers may be too large; load steps with that pressure are taken on request (--steps)" in open_
    assert np.isnan(found.design)


def test_load_steps_with_spread_pressure_that_carry_nothing_are_not_offered_again() -> None:
    found = concio.limit(footing("auto"), search=False)
    assert found.spread is not None
    none = replace(found.spread, steps=replace(found.spread.steps, multipliers=()))
    locked = replace(found.associated, multiplier=np.inf)
    for lost in (replace(found, spread=none), replace(found, spread=None, associated=locked)):
        (open_,) = [said for said in lost.verdict.unchecked if said.startswith("whether torsion governs")]
        assert "no load steps with that pressure were found; contact_points = 4" in open_
        for text in (open_, open_.replace("1 joint with contact at its corners twists", "7 joints with contact at "
                                          "their corners twist")):  # fmt: skip
            assert {piece.language for piece in italian(text)} == {"it"}


def test_a_block_that_slides_or_tips_twists_no_joint() -> None:
    assembly = concio.assemble(footing("corners"))
    reach = assembly.disc.reach[1]
    for motion, twists in (
        ([1.0, 0.3, 0, 0, 0, 0], 0), ([0.0, 0, 0.5, 0, reach, 0], 0), ([0.2, 0, 0, 0, 0, reach], 1),
    ):  # fmt: skip
        assert len(twisting(assembly, np.array(motion))) == twists


def walls(seed: int) -> Model:
    rng = np.random.default_rng(seed)
    kind = seed % 3
    options = {"friction": rng.uniform(0.3, 0.9), "block": "rigid", "horizontal": 1.0}
    if kind == 0:
        return concio.wall(length=0.5, height=0.25, block_size=(0.25, 0.125), **options)
    if kind == 1:
        return concio.column(width=rng.uniform(0.2, 0.6), height=1.0, blocks=2, **options)
    return concio.wall(length=rng.uniform(0.3, 0.6), height=0.5, block_size=(0.3, 0.25), **options)


@pytest.mark.parametrize("seed", range(sample(1, 6, 30)))
def test_what_to_design_with_is_least_and_below_the_bound(seed: int) -> None:
    found = concio.limit(walls(seed), path=True, steps=True, search=True)
    low, top = found.bracket
    assert low <= top * (1 + 1e-6)
    assert found.carried <= top * (1 + 1e-6)
    state = found.collapse_state
    if state is not None:
        assert low <= state.multiplier <= top * (1 + 1e-6)
    if not np.isnan(found.carried):
        assert low <= found.carried * (1 + 1e-12)
    text = found.verdict.sentence
    assert text.count("Design with") == 1
    assert f"Design with {low:.6g} times" in text
    assert "not carried" not in text


@pytest.mark.parametrize("seed", range(sample(1, 4, 12)))
def test_a_load_s_times_as_large_has_one_s_th_of_the_multiplier_and_the_same_kN(seed: int) -> None:
    model = walls(seed)
    s = float(np.exp(np.random.default_rng(seed).uniform(-3, 3)))
    grown = {"live": s, "dead": 1.0}
    larger = replace(
        model, loads=tuple(replace(x, value=tuple(grown[x.group] * v for v in x.value)) for x in model.loads)
    )
    one, two = concio.limit(model, search=False), concio.limit(larger, search=False)
    assert two.design * s == pytest.approx(one.design, rel=1e-6)
    assert two.associated.multiplier * s == pytest.approx(one.associated.multiplier, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 4, 12)))
def test_names_of_groups_and_a_block_elsewhere_change_nothing(seed: int) -> None:
    model = walls(seed)
    one = concio.limit(model, search=False)
    renamed = replace(
        model,
        loads=tuple(replace(x, group={"live": "quake", "dead": "g"}[x.group]) for x in model.loads),
        stages=(),
    )
    two = concio.limit(renamed, "quake", search=False)
    assert two.design == pytest.approx(one.design, rel=1e-9)
    names = tuple(body.name for body in model.bodies if body.kind != "fixed")
    apart = replace(
        model,
        bodies=(
            *model.bodies,
            box("far ground", 50, 52, -1, 0, kind="fixed"),
            box("far", 50.5, 51, 0, 0.1, kind="rigid", material="heavy"),
        ),
        materials={**model.materials, "heavy": Rigid(5.0)},
        loads=(*(replace(x, bodies=names) for x in model.loads), Load("weight", (0.0, -1.0), bodies=("far",))),
        stages=(),
    )
    three = concio.limit(apart, search=False)
    assert three.design == pytest.approx(one.design, rel=1e-6)
    assert three.associated.multiplier == pytest.approx(one.associated.multiplier, rel=1e-6)


def tied(*ties: concio.Tie) -> Model:
    """Return a pillar that tips at 3.2 kN at half its height, held by ties."""
    return replace(pillar((1.0, 0.0), at=0.8), ties=ties)


def rod(name: str, stiffness: float, breaks: float, yields: float) -> concio.Tie:
    return concio.Tie(
        name, "pillar", (-0.2, 1.2), "", (-2.0, 1.2), stiffness=stiffness, yield_force=yields, break_elongation=breaks
    )


def test_ties_that_break_one_after_the_other_are_not_added_up() -> None:
    """By hand 3.2 kN, and 1.5 times a tie: the stiff one breaks at 1 kN when the soft one has taken 0.01 kN."""
    stiff, soft = rod("stiff", 1000.0, 1e-3, 5.0), rod("soft", 10.0, 0.1, 5.0)
    found = concio.limit(tied(stiff, soft))
    assert found.associated.multiplier == pytest.approx(3.2 + 1.5 * 2.0, rel=1e-6)
    assert found.untied is not None
    assert found.untied.multiplier == pytest.approx(3.2, rel=1e-6)
    assert found.design == pytest.approx(3.2 + 1.5 * 1.01, rel=1e-3)
    assert "with all ties intact; then one breaks" in found.verdict.sentence
    assert any("2 ties that can break" in line and "the first breaks at" in line for line in found.verdict.limits)
    unknown = concio.limit(tied(stiff, soft), path=False)
    assert unknown.design <= 3.2 * (1 + 1e-9)


def test_one_tie_that_breaks_holds_until_it_does() -> None:
    found = concio.limit(tied(rod("one", 1000.0, 1e-3, 5.0)))
    assert found.design == pytest.approx(3.2 + 1.5, rel=1e-6)


def test_a_load_on_the_edge_of_what_can_grow_is_locked_in_space_as_in_the_plane() -> None:
    """Two blocks in a corner, pressed into it: what 64 points balance to rounding was "in balance with no multiple"."""
    joint = JointLaw(0.2509639805296092, normal_stiffness=6.3e7, tangential_stiffness=2.8e7)
    model = model_of(
        box("floor", -6.0, 6.0, -0.5, 0.0, kind="fixed"), box("wall", -1.0, 0.0, 0.0, 3.0, kind="fixed"),
        box("low", 0.0, 0.5445, 0.0, 0.4269, kind="rigid", material="stone"),
        box("high", 0.0, 0.5294, 0.4269, 0.7424, kind="rigid", material="stone"),
        law=joint,
        loads=(DEAD, Load("point", (-0.8104, -4.9151), bodies=("low",), at=(0.5445, 0.4269), group="live")),
    )  # fmt: skip
    for made in (model, concio.extrude(model, 1.0)):
        found = concio.limit(made, path=False, search=False, steps=True)
        assert found.associated.locked
        assert found.associated.checked
        assert found.endless
        assert found.verdict.holds


def test_a_bound_that_was_not_found_is_no_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither the words nor the outcome say that nothing is in balance where the programme gave no answer."""
    from concio.analysis import limit as module
    from concio.solvers.statics.associated_limit import LimitLoad

    nothing = LimitLoad(np.nan, np.nan, np.zeros(0), np.zeros((0, 1)), np.inf, None)
    monkeypatch.setattr(module, "associated_limit", lambda *_: nothing)
    found = concio.limit(tied(rod("one", 1000.0, 1e-3, 5.0)))
    assert found.verdict.outcome is Outcome.UNDECIDED
    assert np.isnan(found.design)
    said = " ".join((*found.verdict.lines(), found.verdict.sentence, *limit_lines(found)))
    assert "nan" not in said
    assert "is in balance" not in said
    assert any("at most the bound without them; once they are broken" in line for line in found.verdict.limits)


def test_loads_that_are_not_multiplied_are_not_called_the_dead_load() -> None:
    """Where 'dead' is multiplied, what cannot be carried alone is the push: it was called "the dead load"."""
    leaning = concio.column(width=0.5, height=1.0, blocks=1, block="rigid", unit_weight=20.0, horizontal=0.1)
    with pytest.raises(concio.NoEquilibriumError, match=r"the constant loads alone .*factors=\{'dead': 0\}") as caught:
        concio.limit(leaning, "dead")
    assert caught.value.verdict is not None
    assert "dead load" not in caught.value.verdict.answer


def test_a_group_that_is_named_twice_is_named_once() -> None:
    leaning = concio.column(width=0.5, height=1.0, blocks=1, block="rigid", unit_weight=20.0, horizontal=0.1)
    found = concio.limit(leaning, ["live", "live"])
    assert found.groups == ("live",)
    assert concio.push(leaning, live=("live", "live")).live == ("live",)
