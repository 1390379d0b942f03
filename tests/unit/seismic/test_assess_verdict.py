"""What an assessment answers: what pushes, the weakest of all that there is, what ties carry, what was not checked."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from commands import run
from concio import Assessment, JointLaw, Load, Model, Polyhedron, Rigid, Tie
from concio.analysis.seismic.tie_history import TieHistory, together
from concio.analysis.seismic.variations import tie_force
from concio.cli.assess_command import assess_lines
from concio.contact.applied import sideways
from concio.display import number
from concio.errors import InputError, NoEquilibriumError
from concio.report.assessment_page import AssessmentReport
from concio.verdict.assessment_verdict import _gap, assessment_verdict, grounds
from concio.verdict.assessment_words import EN, IT
from concio.verdict.verdict import Outcome
from samples import sample
from seismic_walls import courses, ground, overturning, site

ONE = {"direction": "left", "levels": ["SLV"]}
HIGH = {**ONE, "elsewhere": ("height",)}


def assessed(model: Model, **more: Any) -> Assessment:
    given = {"site": site(), **ONE, **more}
    return concio.assess(model, **given)


def strip(n: int = 1, height: float = 4.0, thickness: float = 0.5, *, x: float = 0.0, word: str = "c") -> list[Any]:
    """Return n courses from x on."""
    shift = np.array([x, 0.0])
    made = courses(n, height, thickness)
    return [replace(b, name=b.name.replace("c", word), outline=b.outline + shift) for b in made]


def plain(*bodies: Any, loads: tuple[Load, ...] = (), ties: tuple[Tie, ...] = ()) -> Model:
    return Model((ground(-2, 20), *bodies), {"block": Rigid(20.0)}, {"joint": JointLaw(0.8)},
                 loads=(Load("weight", (0, -1)), *loads), ties=ties)  # fmt: skip


def rod(stiffness: float = 5000.0, most: float | None = 12.0, longest: float | None = None) -> Tie:
    return Tie("rod", "c1", (0.5, 3.5), "", (3.5, 3.5), stiffness=stiffness, yield_force=most, break_elongation=longest)


# -- what pushes ------------------------------------------------------------------------------------------------------


@settings(max_examples=sample(2, 4, 12), deadline=None)
@given(st.lists(st.sampled_from(["live", "wind", "earthquake", "q", "roof"]), min_size=3, max_size=3, unique=True),
       st.floats(0.0, 0.3))  # fmt: skip
def test_what_groups_are_called_changes_nothing(names: list[str], wind: float) -> None:
    """A group called live was taken for the earthquake, whatever it was."""
    def named(words: list[str]) -> Model:
        base = overturning()
        wall = Load("pressure", (wind + 0.01,), bodies=("c1",), edge=((0.6, 0.0), (0.6, 6.0)), group=words[2])
        groups = ("dead", *words[:2])
        return replace(base, loads=(*(replace(v, group=g) for v, g in zip(base.loads, groups, strict=True)), wall))

    first, second = (assessed(named(words)) for words in (["a", "b", "c"], names))
    assert second.worst.multiplier == pytest.approx(first.worst.multiplier, rel=1e-12)  # type: ignore[union-attr]
    assert second.zeta == pytest.approx(first.zeta, rel=1e-12)


@settings(max_examples=sample(2, 4, 12), deadline=None)
@given(st.floats(0.01, 0.35))
def test_wind_along_the_push_reduces_what_is_left(pressure: float) -> None:
    gust = Load("pressure", (pressure,), bodies=("c1",), edge=((0.6, 0.0), (0.6, 6.0)), group="live")
    model = overturning()
    calm, windy = assessed(model), assessed(replace(model, loads=(*model.loads, gust)))
    assert windy.zeta < calm.zeta
    assert windy.worst.multiplier == pytest.approx((27.42 - pressure * 18.0) / 271.2, abs=1e-9)  # type: ignore[union-attr]


def test_wind_that_topples_the_wall_topples_it() -> None:
    gust = Load("pressure", (1.6,), bodies=("c1",), edge=((0.6, 0.0), (0.6, 6.0)), group="live")
    model = overturning()
    with pytest.raises(NoEquilibriumError, match="does not stand"):
        assessed(replace(model, loads=(*model.loads, gust)))


def test_the_question_says_what_pushes_with_how_many_kn() -> None:
    found = assessed(overturning(), levels=["SLD"])
    said = found.verdict.question.loads()
    assert any(line.startswith("push left: multiplied") and "84.4 kN" in line for line in said)
    assert any(line.startswith("dead: constant") for line in said)
    assert "moltiplica 84,4 kN" in AssessmentReport(found, language="it").top()
    assert "multiplies 84.4 kN" in AssessmentReport(found).top()
    assert "multiplied" in found._repr_html_()


def test_what_pushes_up_is_no_weight() -> None:
    model = plain(*strip(), loads=(Load("pressure", (5.0,), bodies=("c1",), edge=((0.0, 4.0), (0.5, 4.0))),))
    assert len(sideways(model, [-1.0])[0]) == 2  # the weight, and what rests on the top
    up = Load("traction", (0.0, 5.0), bodies=("c1",), edge=((0.0, 4.0), (0.5, 4.0)))
    lifted = replace(model, loads=(model.loads[0], up))
    assert len(sideways(lifted, [-1.0])[0]) == 1


# -- the weakest ------------------------------------------------------------------------------------------------------


@pytest.mark.long
@settings(max_examples=sample(2, 4, 12), deadline=None)
@given(st.integers(2, 4), st.data())
def test_naming_a_part_never_worsens_the_outcome(n: int, data: st.DataObject) -> None:
    """The least multiplier is not always the least zeta_E: parts that nobody names are sought as well."""
    names = data.draw(st.lists(st.sampled_from([f"c{k + 1}" for k in range(n)]), min_size=1, unique=True))
    roof = Load("point", (-0.2, -6.0), bodies=(f"c{n}",), at=(0.2, 4.0), group="roof")
    model = plain(*strip(n), loads=(roof,))
    alone, named = (assessed(model, **{**HIGH, "mechanisms": more}) for more in (None, {"some": names}))
    assert named.zeta >= alone.zeta * (1 - 1e-6)
    assert alone.verdict.outcome is named.verdict.outcome
    every = next(m for m in named.mechanisms if m.name == "weakest of all")
    assert all(every.multiplier <= m.multiplier * (1 + 1e-9) for m in named.mechanisms)


def test_the_headline_is_the_least_zeta_at_the_ultimate_limit_state() -> None:
    """A storey with 1.38 times the multiplier of the whole is worse off."""
    found = assessed(overturning(3))
    every = next(m for m in found.mechanisms if m.name == "weakest of all")
    assert found.worst is not every
    assert found.worst.multiplier > every.multiplier  # type: ignore[union-attr]
    assert found.zeta < 1 < every.zeta
    assert found.verdict.headline == f"Not verified: zeta_E = {found.zeta:.4g} at SLV"
    assert found.sought == 3
    assert "searches made: 3" in " ".join(found.verdict.limits)


@pytest.mark.long
@settings(max_examples=sample(2, 4, 12), deadline=None)
@given(st.floats(2.0, 6.0), st.floats(0.25, 0.6), st.floats(2.0, 6.0), st.floats(0.25, 0.6))
def test_structures_side_by_side_do_not_change_each_other(h1: float, t1: float, h2: float, t2: float) -> None:
    one, other = strip(1, h1, t1), strip(1, h2, t2, x=8.0, word="d")
    apart = [assessed(plain(*bodies)).zeta for bodies in (one, other)]
    assert assessed(plain(*one, *other)).zeta == pytest.approx(min(apart), rel=1e-6)


@pytest.mark.long  # above a storey of a strip
def test_a_corner_that_fails_fails_without_a_name() -> None:
    model = concio.walls(
        lines=[((0, 0), (0, 2.0)), ((0, 0), (1.5, 0))], height=3.0, block_size=(0.8, 0.3, 0.3), block="rigid",
        unit_weight=18.0, friction=0.6,
    )  # fmt: skip
    found = concio.assess(model, site=site(), direction="-x", levels=["SLV"])
    every = next(m for m in found.mechanisms if m.name == "weakest of all")
    assert every.multiplier == pytest.approx(0.18687, abs=1e-4)  # among all motions the search ended at 0.2501
    assert every.multiplier <= found.bounds["-x"].upper
    assert found.verdict.outcome is Outcome.FAILS
    assert "no collapse under push -x lies above 0.261" in found.verdict.proof


# -- ties -------------------------------------------------------------------------------------------------------------


@settings(max_examples=sample(2, 4, 12), deadline=None)
@given(st.floats(2e3, 2e4), st.floats(0.4, 34.0), st.floats(1.1, 20.0))
def test_a_tie_carries_at_most_what_it_has_when_it_breaks(stiffness: float, force: float, more: float) -> None:
    """Above 36 kN at its top the strip no longer overturns, it slides: the test beside this one."""
    longest = force / stiffness
    brittle = assessed(plain(*strip(), ties=(rod(stiffness, more * force, longest),)))
    equal = assessed(plain(*strip(), ties=(rod(stiffness, force, longest),)))
    worst = brittle.worst
    assert worst is not None
    assert worst.multiplier == pytest.approx((40 * 0.25 + 3.5 * force) / 80, rel=1e-9)
    assert worst.multiplier == pytest.approx(equal.worst.multiplier, rel=1e-12)  # type: ignore[union-attr]
    assert brittle.zeta == pytest.approx(equal.zeta, rel=1e-6)
    assert worst.followed.broken[0] == pytest.approx(longest * 4 / 3.5, rel=0.02)
    assert 0.97 * worst.multiplier < worst.followed.multiplier.max() <= worst.multiplier
    assert "breaks before it yields" in " ".join(brittle.verdict.limits)


@settings(max_examples=sample(2, 4, 12), deadline=None)
@given(st.floats(30.0, 42.0))
def test_a_strong_tie_leaves_sliding_as_the_least(force: float) -> None:
    """Overturning about the toe needs (10 + 3.5 F) / 80, sliding at friction 0.8 needs 0.8 + F / 40."""
    worst = assessed(plain(*strip(), ties=(rod(1e4, force, force / 1e4),))).worst
    assert worst is not None
    assert worst.multiplier == pytest.approx(min((40 * 0.25 + 3.5 * force) / 80, 0.8 + force / 40), rel=1e-9)


@settings(max_examples=sample(2, 4, 12), deadline=None)
@given(st.floats(3.0, 20.0), st.floats(0.005, 0.04))
def test_rows_and_summary_say_the_same(most: float, longest: float) -> None:
    """A displacement that is not met stood above a zeta_E of 2: the wall moves before its tie pulls."""
    found = assessed(plain(*strip(), ties=(rod(5000.0, most, longest),)))
    for m in found.mechanisms:
        for outcome in m.outcomes:
            rows = [c for c in m.checks if c.level == outcome.level and m.decided_by(c)]
            assert outcome.holds == all(c.holds for c in rows)


@pytest.mark.long  # no yield force helps a tie in the plane
def test_a_wall_in_space_with_a_tie_is_the_wall_in_the_plane() -> None:
    """The peak was 0.163 of 0.2124, the break at 0.60 mm of 0.457, and d_SLV 2.5 times too large."""
    flat = assessed(plain(*strip(), ties=(rod(longest=4e-4),))).worst
    bodies = (
        Polyhedron.box("ground", (-2, -2, -0.3), (2, 3, 0), kind="fixed"),
        Polyhedron.box("c1", (0, 0, 0), (0.5, 1, 4), kind="rigid"),
    )
    tie = replace(rod(longest=4e-4), at_a=(0.5, 0.5, 3.5), at_b=(3.5, 0.5, 3.5))
    weight = Load("weight", (0, 0, -1))
    solid = Model(bodies, {"block": Rigid(20.0)}, {"joint": JointLaw(0.8)}, loads=(weight,), ties=(tie,))
    deep = assessed(solid, direction="-x").worst
    assert flat is not None
    assert deep is not None
    # about the toe: 40 kN at 0.25 m and 2 kN at 3.5 m against 40 kN at 2 m
    assert deep.multiplier == pytest.approx(17 / 80, rel=1e-6)
    assert deep.followed.multiplier.max() == pytest.approx(flat.followed.multiplier.max(), rel=1e-6)
    assert deep.followed.broken[0] == pytest.approx(flat.followed.broken[0], rel=1e-6)
    assert deep.followed.broken[0] == pytest.approx(4e-4 * 4 / 3.5, rel=1e-3)
    assert deep.limits["SLV"].d == pytest.approx(flat.limits["SLV"].d, rel=1e-2)
    assert deep.zeta == pytest.approx(flat.zeta, rel=1e-2)


def test_ties_that_do_not_pull_together_do_not_count_together() -> None:
    brittle = replace(rod(50_000.0, 10.0, 3e-4), name="brittle")
    soft = replace(rod(500.0, 10.0), name="soft", at_a=(0.5, 3.0), at_b=(3.5, 3.0))
    worst = assessed(plain(*strip(), ties=(brittle, soft))).worst
    assert worst is not None
    each = (10 + 10 * 3.5 + 10 * 3.0) / 80
    assert worst.multiplier < 0.75 * each
    assert worst.followed.multiplier.max() == pytest.approx(worst.multiplier, rel=0.05)
    d, forces = together((brittle, soft), np.array([3.5 / 4, 3.0 / 4]))
    assert forces[0] * 3.5 + forces[1] * 3.0 == pytest.approx(80 * worst.multiplier - 10, rel=1e-9)
    assert d == pytest.approx(3e-4 / (3.5 / 4))  # the brittle one yields before, and is about to break


def test_a_broken_tie_stays_broken_and_a_yielded_one_unloads() -> None:
    tie = rod(1000.0, 5.0, 0.02)
    new = TieHistory.none(1)
    assert new.force(0, tie, 0.004) == pytest.approx(4.0)
    yielded = new.after(np.array([0.012]))
    assert yielded.force(0, tie, 0.012) == pytest.approx(5.0)
    assert yielded.force(0, tie, 0.009) == pytest.approx(2.0)
    assert yielded.after(np.array([0.02]), [0]).force(0, tie, 0.001) == 0.0
    assert new.next_event([tie], np.array([0.0]), np.array([0.03])) == (0, 0.005, False)
    assert yielded.next_event([tie], np.array([0.012]), np.array([0.03])) == (0, 0.02, True)


@pytest.mark.long
def test_no_yield_force_helps_a_tie_that_breaks_first() -> None:
    found = tie_force(plain(*strip(), ties=(rod(longest=4e-4),)), "rod", site=site(), **ONE)
    assert math.isinf(found.force)
    assert found.reached < 1
    said = assess_lines(found.assessment, found)[-1]
    assert said.endswith(f"zeta_E {number(found.reached, 4)}, of 'weakest of all', push left")


# -- what was not checked ---------------------------------------------------------------------------------------------


def parapet(*, E: float = 1.2) -> Model:
    roof = concio.Body("roof", np.array([[-0.5, 8.5], [1, 8.5], [1, 9], [-0.5, 9.0]]), kind="fixed")
    block = concio.Body("c1", np.array([[0, 9], [0.3, 9], [0.3, 9 + E], [0, 9 + E]]), kind="rigid")
    return Model((roof, block), {"block": Rigid(18.0)}, {"joint": JointLaw(0.7)}, loads=(Load("weight", (0, -1)),))


QUIET = {"SLV": {"a_g": 0.15, "F0": 2.45, "Tc": 0.32}}


def test_a_parapet_is_not_verified_on_the_ground() -> None:
    open_ = assessed(parapet(), site=site(hazard=QUIET))
    assert open_.verdict.outcome is Outcome.INCOMPLETE
    assert open_.zeta == pytest.approx(1.119, abs=1e-3)
    assert "[site.building]" in open_.verdict.sentence
    assert not open_.holds
    high = assessed(parapet(), site=site(hazard=QUIET, building={"height": 9.0, "storeys": 3}))
    assert high.verdict.outcome is Outcome.FAILS
    assert high.zeta < 1
    answered = assessed(parapet(), site=site(hazard=QUIET), elsewhere=["height"])
    assert answered.verdict.outcome is Outcome.HOLDS
    assert "answers for it: amplification at height" in " ".join(answered.verdict.limits)
    page = AssessmentReport(answered, language="it").html()
    assert "che ne risponde: l&#x27;amplificazione in quota" in page.replace("'", "&#x27;")
    assert "<th>assunto</th><td>spessore 1 m, valore predefinito" in page
    with pytest.raises(InputError, match="no check that is made elsewhere 'heights'"):
        assessed(parapet(), elsewhere=["heights"])


@pytest.mark.parametrize(("height", "words"), [(9000.0, "altezza di 9000 m"), (6.0, "finisce a 6 m"), (12.0, "")])
def test_a_height_of_a_building_that_is_no_height_asks_for_attention(height: float, words: str) -> None:
    """Millimetres for metres would take away the amplification at the height of 9 m; 6 m lie below the mechanism."""
    for language in ("en", "it"):
        found = assessed(parapet(), site=site(hazard=QUIET, building={"height": height, "storeys": 3}))
        told = [x for x in assessment_verdict(found, language).attention if "[site.building]" in x]
        assert len(told) == bool(words)
        assert not words or (words in told[0]) == (language == "it")


@pytest.mark.long  # test_out_of_plane
def test_a_facade_in_elevation_can_leave_its_plane() -> None:
    wide = plain(*strip(1, 1.5, 4.0))
    found = assessed(wide, site=site(hazard=QUIET))
    assert found.worst is not None
    assert found.worst.multiplier == pytest.approx(1.0 / 1.5, rel=1e-9)  # thickness over height
    pushed = replace(wide, loads=(*wide.loads, Load("weight", (1.0, 0.0), group="masses")))
    in_plane = assessed(pushed, site=site(hazard=QUIET), live="masses")
    assert in_plane.open[-1].kind == "out of plane"
    assert "without 'live' it is searched out of its plane" in in_plane.verdict.unchecked[-1]
    answered = assessed(wide, site=site(hazard=QUIET), elsewhere=["out of plane"])
    assert answered.verdict.outcome is Outcome.HOLDS


def test_a_tie_without_yield_force_is_no_verified_tie() -> None:
    weak = site(hazard={"SLV": {**QUIET["SLV"], "a_g": 0.01}})
    found = assessed(plain(*strip(), ties=(rod(most=None, longest=0.3),)), site=weak)
    assert found.least > 1
    assert [item.kind for item in found.open] == ["tie"]
    assert found.verdict.exit_code == 4
    assert "1500 kN" in found.verdict.unchecked[0]


def test_limit_states_without_hazard_and_numbers_of_no_site() -> None:
    found = assessed(overturning(), site=site(hazard={"SLV": {"a_g": 0.05}}), levels=None)
    assert [item.kind for item in found.open] == ["levels", "hazard"]
    assert found.verdict.unchecked[0].startswith("SLD, SLC: no hazard")
    assert found.verdict.unchecked[1].startswith("F0, Tc of SLV were not given")
    assert found.verdict.outcome is Outcome.INCOMPLETE
    fixed = assessed(overturning(), site=concio.Site(hazard={"SLV": {"a_g": 0.05}}, code="en1998"))
    assert not fixed.open  # its spectra have no such numbers
    with pytest.raises(InputError, match=r"a_g = 0\.2 g of SLD is larger than a_g = 0\.08 g of SLV"):
        site(hazard={"SLD": {"a_g": 0.2}, "SLV": {"a_g": 0.08}})


def test_a_confidence_factor_of_the_author_is_not_that_of_the_level() -> None:
    found = assessed(overturning(), confidence=1.0)
    assert any("that of LC1 would be 1.35" in line for line in found.verdict.attention)


def test_zeta_beside_capacity_over_demand_has_its_sentence() -> None:
    found = assessed(overturning(), site=site(hazard={"SLV": {"a_g": 0.35, "F0": 2.45, "Tc": 0.32}}))
    check = found.worst.decisive.check  # type: ignore[union-attr]
    assert abs(found.zeta / check.ratio - 1) > 0.01
    assert any("is a ratio of accelerations" in line for line in found.verdict.limits)


@pytest.mark.long
def test_a_part_that_decides_above_the_bound_of_the_whole_has_a_bound_of_its_own() -> None:
    """What decides by zeta_E may begin to move later than the whole: the bound of the whole says nothing of it."""
    found = assessed(overturning(3, friction=0.08), levels=["SLV"])
    assert found.worst is not None
    assert found.worst.found.flow == "Coulomb"
    assert "associated limit over all motions" in found.verdict.proof
    bounds = {way: replace(bound, upper=0.5 * found.worst.multiplier) for way, bound in found.bounds.items()}
    proof = replace(found, bounds=bounds).verdict.proof
    assert "no such collapse of these blocks" in proof
    assert f"lies above {number(found.worst.found.associated.upper, 4)} " in proof
    named = replace(found, mechanisms=(replace(found.worst, name="above z = 2 m"),))
    assert not any(line.startswith("the weakest of all is one") for line in named.verdict.limits)


def test_what_only_friction_locks_is_left_open() -> None:
    """Wedged between two walls a block takes any push if its joints open as they slide; Coulomb's do not."""
    left = concio.Body("left", np.array([[-1, 0], [0, 0], [0, 7], [-1, 7.0]]), kind="fixed")
    model = overturning()
    found = assessed(replace(model, bodies=(*model.bodies, left)))
    assert found.worst is None
    assert found.verdict.outcome is Outcome.HOLDS  # a smooth rock holds it too
    assert not found.locked[0].doubtful


def test_both_languages_have_the_same_words() -> None:
    import re

    assert list(EN) == list(IT)
    for key, text in EN.items():
        assert set(re.findall(r"\{(\w+)\}", text)) == set(re.findall(r"\{(\w+)\}", IT[key])), key


PARAPET = """
[materials.wall]
kind = "rigid"
unit_weight = "18 kN/m3"
[joints.bed]
friction = 0.7
[[blocks]]
name = "roof"
kind = "fixed"
rectangle = [[-0.5, 8.5], [1.0, 9.0]]
[[blocks]]
name = "parapet"
material = "wall"
rectangle = [[0.0, 9.0], [0.30, 10.2]]
[[loads]]
kind = "weight"
value = [0, -1]
[site]
soil = "B"
[site.hazard]
SLV = { a_g = 0.15, F0 = 2.45, Tc = 0.32 }
[assessment]
direction = "left"
levels = ["SLV"]
"""


@pytest.mark.long
def test_the_command_ends_with_the_exit_code_of_the_verdict(tmp_path: Path) -> None:
    for more, code, word in (("", 4, "incomplete"), ('elsewhere = ["height"]\n', 0, "verified")):
        path = tmp_path / f"{word}.toml"
        path.write_text(PARAPET + more, encoding="utf-8")
        ended, shown, _ = run("assess", path, "--json")
        told = json.loads(shown)
        assert (ended, told["status"], told["verdict"]["exit_code"]) == (code, word, code)
        assert told["verdict"]["question"]["acting"][0]["role"] == "multiplied"
        _, lines, _ = run("assess", path)
        assert lines.splitlines()[1] == told["verdict"]["sentence"]
        assert lines.splitlines()[3].strip().startswith("acts")


@pytest.mark.parametrize(
    ("was", "comes", "said"),
    [
        ("a_g = 0.15", "a_g = 2.6", "a_g = 2.6 g is not an acceleration"),
        ('soil = "B"', 'soil = "F"', "no soil 'F'"),
        ("", "", ""),
    ],
)
def test_a_fault_of_a_site_is_found_by_check(was: str, comes: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "site.toml"
    assert was in PARAPET
    path.write_text(PARAPET.replace(was, comes), encoding="utf-8")
    code, out, err = run("check", path)
    assert code == (2 if said else 0)
    assert said in err
    assert "joint law" in out
    assert run("assess", path)[2] == err if said else not err


def test_a_gap_is_never_told_smaller_than_rounding() -> None:
    assert [_gap(gap) for gap in (3.2e-7, 1e-16, 9e-17, 0.0, -1e-18)] == ["3e-07", "1e-16", *["< 1e-16"] * 3]


@pytest.mark.parametrize("language", ["en", "it"])
def test_the_largest_difference_of_checks_by_hand_is_told_and_how_many_differ(language: str) -> None:
    """Of three mechanisms: 2e-9, 5e-7 and 1e-12; where one does not agree, how many do not."""
    for wrong in (0, 2):
        checks = [
            SimpleNamespace(alpha=0.25, program=0.25, difference=d, agrees=k >= wrong)
            for k, d in enumerate((2e-9, 5e-7, 1e-12))
        ]
        bounds = {
            "left": SimpleNamespace(checked=True, multiplier=0.123456789, gap=3e-11),
            "right": SimpleNamespace(checked=False, multiplier=0.7, gap=3e-11),
            "up": SimpleNamespace(checked=True, multiplier=math.inf, gap=3e-11),
        }
        mechanisms = [SimpleNamespace(name=f"m{k}") for k in range(3)]
        found = SimpleNamespace(hand_checks=checks, mechanisms=mechanisms, bounds=bounds, open=["a", "b"])
        told = grounds(found, language)
        assert len(told) == 4
        assert "m0" in told[0]
        assert "2e-09" in told[0]
        assert ("5e-07" in told[1], ("3" if not wrong else "2") in told[1].replace("5e-07", "")) == (True, True)
        assert (("differ by" in told[1]) or ("differiscono" in told[1])) == bool(wrong)
        assert "0.123457" in told[2]
        assert "3e-11" in told[2]
        assert "2" in told[3]
        alone = SimpleNamespace(hand_checks=checks[2:], mechanisms=mechanisms[:1], bounds={}, open=[])
        assert len(grounds(alone, language)) == 1
        assert len(grounds(SimpleNamespace(hand_checks=[], mechanisms=[], bounds={}, open=[]), language)) == 0


def test_numbers_of_a_hazard_that_do_not_count_are_said() -> None:
    """F0 = 3 and Tc = 0.9 beside a code with fixed spectra were left aside without a word."""
    for numbers, said in (({}, False), ({"F0": 3.0}, True), ({"F0": 3.0, "Tc": 0.9}, True)):
        found = assessed(overturning(), site=concio.Site(hazard={"SLV": {"a_g": 0.05, **numbers}}, code="en1998"))
        lines = [line for line in found.verdict.attention if "SLV do not count" in line]
        assert bool(lines) is said
        assert all(key in lines[0] for key in numbers)
    stated = concio.Site(hazard={"SLV": {"a_g": 0.05, "F0": 2.5, "Tc": 0.3}})
    assert not [line for line in assessed(overturning(), site=stated).verdict.attention if "do not count" in line]


@pytest.mark.parametrize("kind", ["2", "9"])
def test_a_type_of_spectrum_that_a_code_has_not_is_refused(kind: str) -> None:
    with pytest.raises(concio.InputError, match="has no types of spectra"):
        concio.Site(hazard={"SLV": {"a_g": 0.05}}, spectrum_type=kind)
    assert concio.Site(hazard={"SLV": {"a_g": 0.05}}, code="en1998", spectrum_type="2").spectrum_type == "2"


@pytest.mark.parametrize(("breaks", "limited"), [(None, False), (0.04, True)])
def test_where_a_broken_tie_sets_the_limit_it_is_told(breaks: float | None, limited: bool) -> None:
    """A tie that breaks early makes zeta_E less than that of the wall without it, as the code counts."""
    tie = concio.Tie("tie", "c1", (0.0, 5.5), "", (5.0, 5.5), stiffness=5e3, yield_force=10.0, break_elongation=breaks)
    bare, tied = (concio.assess(overturning(ties=ties), site=site(), direction="left", levels=["SLV"])
                  for ties in ((), (tie,)))  # fmt: skip
    assert (tied.zeta < bare.zeta) == limited
    for language, said in (("en", "ties have broken"), ("it", "catene sono rotte")):
        lines = assessment_verdict(tied, language).limits
        assert any(said in line for line in lines) == limited
    assert not any("ties have broken" in line for line in bare.verdict.limits)
