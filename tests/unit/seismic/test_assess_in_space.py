"""Assessments in space: the worked example as a wall with a length, named parts, curves in steps, the report."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import concio
from concio import JointLaw, Load, Model, Polyhedron, Rigid, Tie
from concio.analysis.seismic.assessment import Assessment
from concio.analysis.seismic.macro_contacts import contacts_of
from concio.analysis.seismic.sequence import Sequence, follow_in_steps
from concio.errors import InputError
from concio.report.assessment_page import AssessmentReport
from seismic_walls import bending, overturning, site


def wall(ties: tuple[Tie, ...] = (), **fields: Any) -> Model:
    """Return the wall of the worked example, 6.0 x 0.60 m, 2 m long, with twice its loads."""
    bodies = (
        Polyhedron.box("ground", (-1, -1, -0.2), (2, 3, 0), kind="fixed"),
        Polyhedron.box("wall", (0, 0, 0), (0.6, 2, 6), kind="rigid", role="facade"),
    )
    loads = (
        Load("weight", (0, 0, -1)),
        Load("traction", (0, -0.0, -10.0), edge=((0.45, 0, 3.0), (0.45, 2, 3.0)), bodies=("wall",)),
        Load("point", (0, 0, -12.0), bodies=("wall",), at=(0.40, 1.0, 6.0)),
    )
    return Model(bodies, {"block": Rigid(19.0)}, {"joint": JointLaw(0.8)}, loads=loads, ties=ties, **fields)


@cache
def worked_in_space() -> Assessment:
    return concio.assess(wall(), site=site(), direction="-x", control=("wall", (0.0, 1.0, 6.0)), curve="straight")


@pytest.mark.long
def test_worked_example_as_a_wall_in_space() -> None:
    """All numbers of the plane, with a curve followed in steps in place of a linkage."""
    found = worked_in_space()
    worst = found.worst
    assert worst is not None
    assert worst.multiplier == pytest.approx(0.101106, abs=5e-7)
    assert worst.e_star == pytest.approx(0.945572, abs=5e-7)
    assert worst.onset == pytest.approx(0.776996, abs=5e-7)
    assert worst.followed.kind == "steps"
    assert worst.followed.end == pytest.approx(0.603560, abs=5e-7)
    assert worst.d0 == pytest.approx(0.341839, abs=5e-7)
    assert worst.limits["SLV"].d == pytest.approx(0.136736, abs=5e-7)
    assert pytest.approx(2.85835, abs=5e-6) == worst.limits["SLV"].T
    ratios = {(c.level, c.kind): c.ratio for c in worst.checks}
    assert ratios["SLV", "linear"] == pytest.approx(0.660, abs=5e-4)
    assert ratios["SLV", "displacement"] == pytest.approx(1.0056, abs=5e-5)


def test_every_way_is_looked_at_unless_one_is_asked_for() -> None:
    found = concio.assess(wall(), site=site(), levels=["SLD"])
    assert {m.direction for m in found.mechanisms} == {"+x", "-x", "+y", "-y"}
    thin = {m.direction: m.multiplier for m in found.mechanisms}
    # along its length (136.8 1.0 + 20 1.0 + 12 1.0) over the same moments of the pushes
    assert thin["+y"] == pytest.approx((136.8 + 20 + 12) / (136.8 * 3 + 20 * 3 + 12 * 6))
    askew = concio.assess(wall(), site=site(), levels=["SLD"], direction=(-3.0, 4.0)).worst
    assert askew is not None
    assert askew.direction == "(-0.6, 0.8)"
    assert askew.multiplier == pytest.approx(thin["-x"] / 0.6)


def test_a_load_of_the_model_says_which_way() -> None:
    model = wall()
    live = (*model.loads, Load("weight", (-1, 0, 0), group="live"))
    model = Model(model.bodies, model.materials, model.laws, loads=live)
    found = concio.assess(model, site=site(), levels=["SLD"], direction="-x", live="live")
    assert [m.direction for m in found.mechanisms] == ["-x"]
    with pytest.raises(InputError, match="pushes along -x, not along"):
        concio.assess(model, site=site(), direction="+y", live="live")


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"direction": "up"}, "no direction 'up'"),
        ({"direction": (0.0, 0.0)}, "is not a direction"),
        ({"control": ("wall", (0.0, 6.0))}, "lies outside 'wall'"),
        ({"mechanisms": {"roof": {"above": 9.0}}}, "no body that can move lies there"),
    ],
)
def test_bad_input_in_space(more: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        concio.assess(wall(), site=site(), **more)


@pytest.mark.long
def test_ties_in_space_pull_and_break() -> None:
    tie = Tie("tie", "wall", (0.0, 1.0, 5.5), "", (5.0, 1.0, 5.5), stiffness=5000.0, yield_force=24.0,
              break_elongation=0.05)  # fmt: skip
    worst = concio.assess(wall((tie,)), site=site(), levels=["SLV"], direction="-x").worst
    assert worst is not None
    assert worst.multiplier == pytest.approx((2 * 27.42 + 24.0 * 5.5) / (2 * 271.2), abs=1e-7)
    assert worst.followed.broken[0] == pytest.approx(0.05 * 6.0 / 5.5, rel=0.02)
    assert worst.limits["SLV"].why == "ties"


@pytest.mark.long
def test_the_corner_of_two_walls_is_sought_whole_and_above() -> None:
    model = concio.walls(
        lines=[((0, 0), (0, 1.0)), ((0, 0), (1.0, 0))], height=0.5, block_size=(0.5, 0.25, 0.25), block="rigid",
        friction=0.6,
    )  # fmt: skip
    found = concio.assess(
        model, site=site(), levels=["SLD"], direction="-x", mechanisms={"top course": {"above": 0.25}}
    )
    by_name = {m.name: m for m in found.mechanisms}
    whole = by_name["weakest of all"]
    assert whole.found.flow == "Coulomb"
    assert whole.multiplier < whole.found.associated.multiplier
    assert whole.multiplier <= by_name["top course"].multiplier + 1e-6
    assert by_name["top course"].level == pytest.approx(0.25)
    assert {c.kind for m in found.mechanisms for c in m.checks} == {"onset"}


@pytest.mark.long
def test_report_in_space() -> None:
    found = worked_in_space()
    for language, said in (("en", ("towards -x", "step by step")), ("it", ("verso -x", "passo dopo passo"))):
        text = AssessmentReport(found, language=language).html()
        assert text.count("<figure") == 4
        assert all(words in text for words in said)
        assert "thickness modelled" not in text


@pytest.mark.long
@pytest.mark.parametrize(
    ("model", "way", "end"), [(overturning(2), "left", 0.603560), (bending(8), "right", None)]
)
def test_steps_meet_the_linkage(model: Model, way: str, end: float | None) -> None:
    """Limit analysis of the displaced blocks, which keeps no joints, finds the curve of the joints kept."""
    live = "live" if way == "right" else None
    worst = concio.assess(model, site=site(), direction=way, levels=["SLV"], live=live).worst
    assert worst is not None
    assert worst.followed.kind == "followed"
    kept = worst.linkage
    contacts = contacts_of(worst.assembly, worst.mechanics, worst.found.normal_force)
    steps = follow_in_steps(Sequence(worst.mechanics, contacts, kept.dead, kept.push, kept.ties, kept.control))
    assert steps.reason == "falls"
    assert steps.end == pytest.approx(worst.followed.end, rel=1e-6)
    assert end is None or steps.end == pytest.approx(end, abs=5e-7)
    met = np.interp(steps.displacement[1:-1], worst.followed.displacement, worst.followed.multiplier)
    assert steps.multiplier[1:-1] == pytest.approx(met, abs=2e-5)


@pytest.mark.long  # above the same steps meet a linkage
def test_a_dry_wall_whose_courses_slide_is_followed_in_steps() -> None:
    model = concio.wall(length=1.0, height=2.0, block_size=(0.5, 0.25), friction=0.6, block="rigid")
    worst = concio.assess(model, site=site(), direction="right", levels=["SLV"]).worst
    assert worst is not None
    assert worst.found.flow == "Coulomb"
    assert worst.followed.kind == "steps"
    assert worst.multiplier == pytest.approx(0.42615, abs=1e-4)
    # equilibria at large displacements of the elastic-frictional structure peak at 0.42688
    assert worst.followed.at(0.1) < worst.followed.at(0.05) < worst.multiplier
    assert not worst.unchecked


def test_corners_are_pushed_along_their_diagonals() -> None:
    from concio.analysis.seismic.directions import pushes

    corner = concio.walls(lines=[((0, 0), (0, 1)), ((0, 0), (1, 0))], height=0.5, block_size=(0.5, 0.25, 0.25),
                          block="rigid", friction=0.6, unit_weight=20.0)  # fmt: skip
    made = pushes(corner, "corners", ())
    weight = 20.0 * sum(b.volume for b in corner.free_bodies)
    totals = [sum(force for force, _ in p.by_group().values()) for p in made]
    assert [p.way for p in made] == ["(0.707, 0.707)", "(-0.707, 0.707)", "(-0.707, -0.707)", "(0.707, -0.707)"]
    for total, sides in zip(totals, ((1, 1), (-1, 1), (-1, -1), (1, -1)), strict=True):
        assert np.asarray(total)[:2] == pytest.approx(np.array(sides) * weight / np.sqrt(2.0), rel=1e-12)
    assert len(pushes(corner, "every", ())) == 8
    (one,) = pushes(corner, "-x-y", ())
    assert one.way == "(-0.707, -0.707)"
