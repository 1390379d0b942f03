"""Assessments: the worked example and vertical bending to every digit, set-back, ties, heights, refused input."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio import Assessment, JointLaw, Load, Tie
from concio.analysis.seismic.local_mechanism import LocalMechanism
from concio.contact.applied import EARTHQUAKE, pushed
from concio.errors import InputError, NoEquilibriumError
from samples import sample
from seismic_walls import HAZARD, bending, courses, ground, overturning, site

OUTER = ("c1", (0.0, 6.0))


def worked(**more: Any) -> Assessment:
    given = {"site": site(), "direction": "left", "control": OUTER, "curve": "straight", **more}
    return concio.assess(overturning(), **given)


def weakest(found: Assessment) -> LocalMechanism:
    return next(m for m in found.mechanisms if m.name == "weakest of all")


def check(found: Assessment, level: str, kind: str, place: str = "ground") -> Any:
    assert found.worst is not None
    return next(c for c in found.worst.checks if (c.level, c.kind, c.place) == (level, kind, place))


def test_worked_example_of_simple_overturning() -> None:
    found = worked()
    worst = found.worst
    assert worst is not None
    assert found.confidence == 1.35
    assert worst.multiplier == pytest.approx(0.101106, abs=5e-7)
    assert worst.e_star == pytest.approx(0.945572, abs=5e-7)
    assert worst.onset == pytest.approx(0.776996, abs=5e-7)
    assert worst.followed.end == pytest.approx(0.603560, abs=5e-7)
    assert worst.followed.end == pytest.approx(6.0 * math.sin(0.1007638), abs=5e-7)
    assert worst.d0 == pytest.approx(0.341839, abs=5e-7)
    assert worst.limits["SLV"].d == pytest.approx(0.136736, abs=5e-7)
    assert worst.limits["SLC"].d == pytest.approx(0.205104, abs=5e-7)
    assert pytest.approx(2.85835, abs=5e-6) == worst.limits["SLV"].T
    assert pytest.approx(3.98127, abs=5e-6) == worst.limits["SLC"].T
    linear = check(found, "SLV", "linear")
    assert (linear.demand, linear.capacity) == (pytest.approx(1.1772, abs=5e-5), pytest.approx(0.7770, abs=5e-5))
    assert linear.ratio == pytest.approx(0.660, abs=5e-4)
    assert not linear.holds
    moved = check(found, "SLV", "displacement")
    assert moved.demand == pytest.approx(0.135969, abs=5e-7)
    assert moved.ratio == pytest.approx(1.0056, abs=5e-5)
    assert moved.holds


def test_the_followed_curve_of_one_block_is_that_of_its_turning_resultants() -> None:
    worst = worked(curve="followed").worst
    assert worst is not None
    d, alpha = worst.followed.displacement, worst.followed.multiplier
    theta0 = math.atan(27.42 / 271.2)
    assert alpha == pytest.approx(np.tan(theta0 - np.arcsin(d / 6.0)), abs=1e-9)
    # both curves end at the same displacement, so d_SLV is the same; in between the followed one is a little lower
    assert worst.straight is not None
    assert worst.limits["SLV"].d == pytest.approx(0.4 * worst.d0)
    inner = d[1:-1]
    assert (alpha[1:-1] < [worst.straight.at(x) for x in inner]).all()
    assert worst.limits["SLV"].T > 2.85835


@pytest.mark.parametrize(("n", "alpha"), [(20, 0.7644110), pytest.param(80, 0.7643824, marks=pytest.mark.long)])
def test_vertical_bending_finds_the_best_joint(n: int, alpha: float) -> None:
    worst = concio.assess(bending(n), site=site(), live="live", direction="right", levels=["SLV"]).worst
    assert worst is not None
    assert worst.multiplier == pytest.approx(alpha, abs=5e-8)
    W, N, t, h = 38.0, 20.0, 0.5, 4.0
    smooth = 2 * (math.sqrt((W + N) * t) + math.sqrt(N * t / 2)) ** 2 / (W * h)
    assert smooth == pytest.approx(0.764252, abs=5e-7)
    assert worst.multiplier >= smooth
    joint = next(j for j in worst.mechanics.joints if j.kind == "hinge" and j.a >= 0)
    assert abs(joint.point[1] / h - 0.706600) <= 0.5 / n
    assert len(worst.mechanics.blocks) == 2
    assert worst.followed.reason == "falls"


def test_vertical_bending_without_a_load_on_top_opens_the_highest_joint() -> None:
    worst = concio.assess(bending(8, N=0.0), site=site(), live="live", direction="right", levels=["SLV"]).worst
    assert worst is not None
    assert worst.multiplier == pytest.approx(2 * 0.5 / (4.0 * 7 / 8))


@pytest.mark.long
def test_thirty_courses_do_not_exceed_the_monolithic_wall() -> None:
    found = [weakest(concio.assess(overturning(n), site=site(), direction="left", levels=["SLD"])) for n in (1, 3, 30)]
    alpha = [m.multiplier for m in found]
    assert alpha[0] == pytest.approx(27.42 / 271.2, abs=1e-12)
    assert all(a <= alpha[0] + 1e-12 for a in alpha)
    assert alpha == pytest.approx([alpha[0]] * 3, abs=1e-9)
    shares = [m.e_star for m in found]
    assert shares == pytest.approx([shares[0]] * 3, abs=1e-9)  # courses that move together are one body of the code


def test_crushing_sets_the_hinge_back_by_half_the_crushed_length() -> None:
    found = concio.assess(overturning(strength=2000.0), site=site(), direction="left", knowledge="LC2")
    worst = found.worst
    assert worst is not None
    assert (found.confidence, found.confidence_by) == (1.20, "knowledge")
    back = 84.4 / (2 * 2000.0)
    assert worst.mechanics.joints[0].set_back == pytest.approx(back)
    assert worst.multiplier == pytest.approx((27.42 - 84.4 * back) / 271.2, abs=1e-12)
    assert worst.mechanics.joints[0].point[0] == pytest.approx(back)


@pytest.mark.parametrize("strength", [200.0, 60.0])
def test_a_joint_that_crushes_as_it_slides_carries_no_force_nearer_to_its_ends(strength: float) -> None:
    """W = 10 kN on 1 m: half of the crushed length W / f is between each end and the farthest resultant."""
    wall = courses(1, 0.5, 1.0)
    law = concio.JointLaw(0.3, compressive_strength=strength)
    model = concio.Model((ground(), *wall), {"block": concio.Rigid(20.0)}, {"joint": law},
                         loads=(concio.Load("weight", (0, -1)),))  # fmt: skip
    worst = concio.assess(model, site=site(), direction="left", knowledge="LC2").worst
    assert worst is not None
    assert worst.multiplier == pytest.approx(0.3, rel=1e-9)
    back = 10.0 / (2 * strength)
    points = sorted(j.point[0] for j in worst.mechanics.joints if j.kind == "roller")
    assert points == pytest.approx([back, 1.0 - back], rel=1e-9)


def test_the_confidence_factor_without_crushing_is_that_of_least_knowledge() -> None:
    found = worked(knowledge="LC3")
    assert (found.confidence, found.confidence_by) == (1.35, "crushing")
    assert worked(confidence=1.0).worst.onset == pytest.approx(0.776996 * 1.35, abs=1e-6)  # type: ignore[union-attr]


TIE = Tie("tie", "c1", (0.0, 5.5), "", (5.0, 5.5), stiffness=5000.0, yield_force=12.0)


def test_a_tie_adds_its_work_and_breaks() -> None:
    tied = concio.assess(overturning(ties=(TIE,)), site=site(), direction="left").worst
    assert tied is not None
    assert tied.multiplier == pytest.approx((27.42 + 12.0 * 5.5) / 271.2, abs=1e-9)
    assert tied.followed.multiplier[0] == pytest.approx(27.42 / 271.2)  # it pulls only as it gets longer
    assert tied.followed.multiplier.max() == pytest.approx(tied.multiplier, rel=0.02)
    brittle = replace(TIE, break_elongation=0.05)
    broken = concio.assess(overturning(ties=(brittle,)), site=site(), direction="left").worst
    assert broken is not None
    at = broken.followed.broken[0]
    assert at == pytest.approx(0.05 * 6.0 / 5.5, rel=0.02)
    assert broken.followed.at(at * (1 - 1e-6)) > 3 * broken.followed.at(at)
    assert broken.limits["SLV"].why == "ties"
    assert broken.limits["SLV"].control == pytest.approx(at)
    assert broken.limits["SLC"].why == "share"


def test_a_tie_that_gets_shorter_does_not_pull() -> None:
    inward = concio.assess(overturning(strength=2000.0, ties=(TIE,)), site=site(), direction="right").worst
    free = concio.assess(overturning(strength=2000.0), site=site(), direction="right").worst
    assert inward is not None
    assert free is not None
    assert inward.multiplier == pytest.approx(free.multiplier, abs=1e-12)
    assert inward.multiplier == pytest.approx(inward.found.associated.multiplier, rel=0.1)


def test_a_wall_against_a_rock_is_locked() -> None:
    model = overturning()
    rock = concio.Body("rock", np.array([[-1.0, 0.0], [0.0, 0.0], [0.0, 7.0], [-1.0, 7.0]]), kind="fixed", role="rock")
    found = concio.assess(replace(model, bodies=(*model.bodies, rock)), site=site(), direction="left")
    assert found.worst is None
    assert found.locked[0].sentence.startswith("locked")
    assert found.holds


def test_a_tie_that_does_not_yield_leaves_another_mechanism() -> None:
    strong = replace(TIE, yield_force=None, at_a=(0.0, 6.0), at_b=(5.0, 6.0))
    worst = concio.assess(overturning(ties=(strong,)), site=site(), direction="left").worst
    assert worst is not None
    # the head is held, the foot slides out: 0.8 (84.4 kN) at the foot against the push about the head
    assert worst.multiplier > 1.0
    assert any(j.kind == "bar" for j in worst.mechanics.joints)


def test_named_blocks_move_while_the_others_stand() -> None:
    model = overturning(6)
    found = concio.assess(
        model, site=site(), direction="left", mechanisms={"upper storey": {"above": 3.0}, "last": ["c6"]}
    )
    by_name = {m.name: m for m in found.mechanisms}
    # above the floor: 34.2 kN at (0.3, 1.5) and the roof, about (0, 3)
    assert by_name["upper storey"].multiplier == pytest.approx((34.2 * 0.3 + 6 * 0.4) / (34.2 * 1.5 + 6 * 3.0))
    assert by_name["upper storey"].level == pytest.approx(3.0)
    # the last course alone slides before it topples: friction 0.8 of a joint under 17.4 kN, of which all pushes
    assert by_name["last"].multiplier == pytest.approx((11.4 * 0.3 + 6 * 0.4) / (11.4 * 0.5 + 6 * 1.0), abs=1e-9)
    assert found.mechanisms[0].zeta <= found.mechanisms[-1].zeta


@pytest.mark.long
def test_a_joint_that_slides_is_checked_with_coulombs_flow() -> None:
    found = concio.assess(overturning(friction=0.05), site=site(), direction="left", levels=["SLV"])
    worst = found.worst
    assert worst is not None
    assert worst.found.flow == "Coulomb"
    assert worst.multiplier == pytest.approx(0.05)
    assert worst.followed.end != worst.followed.end  # friction does not fall: the multiplier never vanishes
    assert [c.kind for c in worst.checks] == ["linear"]
    slow = concio.assess(overturning(friction=0.05), site=site(hazard={"SLV": {"a_g": 0.01}, "SLC": {"a_g": 0.01}}),
                         direction="left")  # fmt: skip
    # it does not even begin to move: that is what the checks in displacements need not be made for
    assert [(c.level, c.kind) for c in slow.worst.checks] == [("SLV", "linear"), ("SLC", "onset")]  # type: ignore[union-attr]
    assert slow.zeta > 1
    fast = concio.assess(overturning(friction=0.05), site=site(hazard={"SLV": {"a_g": 0.05}, "SLC": {"a_g": 0.05}}),
                         direction="left")  # fmt: skip
    assert fast.worst.unchecked == ("SLC",)  # type: ignore[union-attr]
    assert fast.zeta > 1
    assert not fast.holds


@pytest.mark.long
def test_mechanisms_above_the_ground_meet_the_floor_spectrum() -> None:
    building = {"height": 6.0, "storeys": 2, "T1": 0.25, "xi": 10.0}
    found = concio.assess(overturning(6), site=site(building=building), direction="left",
                          mechanisms={"upper": {"above": 3.0}})  # fmt: skip
    upper = next(m for m in found.mechanisms if m.name == "upper")
    linear = [c for c in upper.checks if (c.level, c.kind) == ("SLV", "linear")]
    assert [c.place for c in linear] == ["ground", "height"]
    assert linear[1].demand == pytest.approx(2.881832 / 2.0, abs=5e-7)
    whole = next(m for m in found.mechanisms if m.name != "upper")
    assert {c.place for c in whole.checks} == {"ground"}


def test_the_acceleration_of_capacity_meets_demand() -> None:
    found = worked()
    for c in found.worst.checks:  # type: ignore[union-attr]
        again = concio.assess(
            overturning(), site=site(hazard={c.level: {**HAZARD[c.level], "a_g": c.a_g}}), direction="left",
            control=OUTER, curve="straight",
        )  # fmt: skip
        same = next(d for d in again.worst.checks if (d.level, d.kind) == (c.level, c.kind))  # type: ignore[union-attr]
        assert same.ratio == pytest.approx(1.0, abs=1e-9)


def test_a_table_of_return_periods_gives_the_period_of_the_capacity() -> None:
    rows = [{"T_R": T, "a_g": 0.05 * (T / 30.0) ** 0.5, "F0": 2.45, "Tc": 0.32} for T in (30, 101, 475, 2475)]
    outcome = worked(site=site(hazard=rows), levels=["SLV"]).worst.outcome("SLV")  # type: ignore[union-attr]
    assert pytest.approx(30.0 * (outcome.a_g / 0.05) ** 2, rel=1e-9) == outcome.T_R


@settings(max_examples=sample(2, 5), deadline=None)
@given(st.floats(2.0, 9.0), st.floats(0.3, 0.9))
def test_a_wall_alone_topples_at_its_slenderness(height: float, thickness: float) -> None:
    model = concio.Model(
        (ground(), *courses(1, height, thickness)), {"block": concio.Rigid(18.0)}, {"joint": JointLaw(2.0)},
        loads=(Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
    found = concio.assess(model, site=site(), direction="both", levels=["SLV"])
    for m in found.mechanisms:
        assert m.multiplier == pytest.approx(thickness / height)
        assert m.e_star == pytest.approx(1.0)
        assert m.followed.end == pytest.approx(height * math.sin(math.atan(thickness / height)), rel=1e-6)
    assert found.mechanisms[0].zeta == pytest.approx(found.mechanisms[1].zeta)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"control": ("c1", (3.0, 6.0))}, "lies outside 'c1'"),
        ({"control": ("ground", (0.0, 0.0))}, "is fixed"),
        ({"control": ("wall", (0.0, 0.0))}, "no body called 'wall'"),
        ({"levels": ["SLX"]}, "no limit state 'SLX'"),
        ({"levels": ["SLO"]}, "hazard of SLO is not given"),
        ({"levels": []}, "no limit state to check"),
        ({"knowledge": "LC4"}, "no level of knowledge 'LC4'"),
        ({"confidence": 0.9}, "at least 1"),
        ({"direction": "up"}, "no direction 'up'"),
        ({"mechanisms": {"roof": ["tiles"]}}, "'tiles' is not a body"),
        ({"mechanisms": {"roof": {"above": 9.0}}}, "no body that can move lies there"),
        ({"limits": {"SLC": 0.0}}, "must be positive"),
        ({"live": "wind"}, "no load group 'wind'"),
        ({"curves": "straight"}, "curves"),
    ],
)
def test_bad_input_is_refused_in_a_sentence(more: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as error:
        worked(**more)
    assert said in str(error.value)


def test_a_wall_that_does_not_stand_is_told_so() -> None:
    model = overturning()
    leaning = replace(model, loads=(*model.loads, Load("point", (-20.0, 0.0), bodies=("c1",), at=(0.0, 6.0))))
    with pytest.raises(NoEquilibriumError, match="does not stand"):
        concio.assess(leaning, site=site(), direction="left")


def test_an_assessment_prints_in_a_few_lines() -> None:
    shown = repr(worked(levels=["SLV"]))
    assert "zeta_E 1.004" in shown
    assert len(shown) < 300


def test_a_very_strong_site_asks_for_attention() -> None:
    found = worked(site=site(hazard={"SLV": {"a_g": 0.62}}))
    assert "check that g was meant" in found.notes[0]


def test_a_stout_wall_has_no_mechanism_below_two_g() -> None:
    model = concio.Model(
        (ground(-1, 9), *courses(1, 2.0, 5.0)), {"block": concio.Rigid(18.0)}, {"joint": JointLaw(3.0)},
        loads=(Load("weight", (0.0, -1.0)),),
    )  # fmt: skip
    found = concio.assess(model, site=site(), direction="left", elsewhere=("out of plane",))
    assert found.worst is None
    assert "no mechanism below 2 g" in found.locked[0].sentence
    assert found.summary()["zeta_E"] is None


def test_where_the_wall_stands_and_which_way_it_faces_changes_nothing() -> None:
    model = overturning(3, strength=3000.0, ties=(TIE,))
    left = concio.assess(model, site=site(), direction="left").worst

    def mirrored(p: Any) -> Any:
        return tuple(v * s + o for v, s, o in zip(p, (-1.0, 1.0), (7.0, 0.0), strict=True))

    turned = replace(
        model,
        bodies=tuple(replace(b, outline=b.outline[::-1] * [-1.0, 1.0] + [7.0, 0.0]) for b in model.outlines),
        loads=tuple(load if load.at is None else replace(load, at=mirrored(load.at)) for load in model.loads),
        ties=tuple(replace(t, at_a=mirrored(t.at_a), at_b=mirrored(t.at_b)) for t in model.ties),
    )
    right = concio.assess(turned, site=site(), direction="right").worst
    assert left is not None
    assert right is not None
    for name in ("multiplier", "e_star", "onset", "d0", "zeta"):
        assert getattr(right, name) == pytest.approx(getattr(left, name), rel=1e-9)


def test_the_spectrum_of_another_code() -> None:
    found = worked(site=concio.Site(hazard={"SLV": {"a_g": 0.20}}, soil="B", code="en1998"))
    linear = check(found, "SLV", "linear")
    assert linear.demand == pytest.approx(0.20 * 9.81 * 1.20 / 2)
    assert found.worst.multiplier == pytest.approx(0.101106, abs=5e-7)  # type: ignore[union-attr]
    T = found.worst.limits["SLV"].T  # type: ignore[union-attr]
    eta = (10 / 13) ** 0.5
    demand = 0.20 * 9.81 * 1.2 * eta * 2.5 * 0.5 * 2.0 / T**2 * (T / (2 * math.pi)) ** 2
    assert check(found, "SLV", "displacement").demand == pytest.approx(demand)


@pytest.mark.parametrize("n", [1, 6, pytest.param(30, marks=pytest.mark.long)])
def test_courses_that_crush_tend_to_the_monolithic_wall_from_below(n: int) -> None:
    """The hinge stands N / (2 f) from the edge: alpha_0 falls short of the closed form by 84.4^2 / (2 f 271.2)."""
    closed = 27.42 / 271.2
    found = []
    for strength in (500.0, 2000.0, 20_000.0, 200_000.0):
        worst = concio.assess(overturning(n, strength=strength), site=site(), direction="left", levels=["SLD"]).worst
        assert worst is not None
        found.append(worst.multiplier)
        assert closed - worst.multiplier == pytest.approx(84.4**2 / (2 * strength * 271.2), rel=1e-9)
    assert found == sorted(found)
    assert found[-1] < closed


@pytest.mark.long  # courses that crush do
def test_compliant_courses_tend_to_the_monolithic_wall_from_below() -> None:
    """Pushed at large displacements, a wall whose joints give peaks below alpha_0, the nearer the stiffer they are."""
    peaks = []
    for stiffness in (3e6, 1e7):
        model = replace(
            overturning(12), laws={"joint": JointLaw(0.8, normal_stiffness=stiffness, tangential_stiffness=stiffness)}
        )  # fmt: skip
        control = concio.ControlPoint("c12", (0.0, 6.0), (-1.0, 0.0))
        peaks.append(concio.push(pushed(model, [-1.0]), live=(EARTHQUAKE,), control=control, until=0.06).peak)
    closed = 27.42 / 271.2
    assert peaks[0] < peaks[1] < closed
    assert closed - peaks[1] == pytest.approx((closed - peaks[0]) * 0.3, rel=0.35)  # like one over the stiffness


@pytest.mark.long
def test_a_wall_with_a_door_is_assessed() -> None:
    model = concio.wall(
        length=2.0, height=1.25, block_size=(0.5, 0.25), friction=0.6, block="rigid",
        openings=[{"x": 0.75, "y": 0.0, "width": 0.5, "height": 0.75, "lintel": 0.25}],
    )  # fmt: skip
    worst = concio.assess(model, site=site(), direction="right", levels=["SLV"], elsewhere=("out of plane",)).worst
    assert worst is not None
    assert worst.found.flow == "Coulomb"
    assert worst.multiplier < worst.found.associated.multiplier
    assert len(worst.mechanics.blocks) >= 2
    assert worst.followed.reason == "falls"
    assert worst.complete
