"""Statics at large displacements: closed forms of blocks that are pushed over, and what is said of bad input."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.analysis.motion.push_result import PushEnding
from concio.analysis.motion.statics import Statics
from concio.solvers.stepping.solver import StepSolver
from models import box, model_of, weight
from motion_models import standing
from samples import first, sample

SLENDER = np.arctan(0.2)


@pytest.fixture(scope="module")
def pushed() -> concio.PushResult:
    return concio.push(standing(0.2, 1.0))


def test_pillar_loses_its_strength_where_its_centroid_is_above_its_toe(pushed):
    """The block turns about its toe: lambda = tan(atan(b / h) - theta) at every point of the curve."""
    theta = -pushed.rotation_of("block")
    assert pushed.certified
    assert pushed.ending is PushEnding.LOST
    assert (np.diff(theta) > 0).all()
    assert pushed.multiplier[1:] == pytest.approx(np.tan(SLENDER - theta[1:]), abs=1e-8)
    assert pushed.peak == pytest.approx(0.2, rel=2e-4)
    assert theta[-1] == pytest.approx(SLENDER, abs=1e-6)
    assert pushed.capacity == pytest.approx(0.1, rel=1e-3)  # the centroid moves by half the width, less what sinks in


def test_the_numbers_of_a_push_end_where_its_curve_does(pushed):
    told = pushed.summary()
    assert told["end"] == {"multiplier": pytest.approx(0.0, abs=1e-6), "displacement": pushed.capacity}
    assert told["curve"]["displacement"][-1] == told["capacity"] > told["peak"]["displacement"]
    assert np.array_equal(pushed.configuration().outline(1), pushed.configuration(len(pushed) - 1).outline(1))


def test_mechanism_of_the_pillar_is_its_rotation_about_the_toe(pushed):
    """Half way: a centroid at height z above the toe moves by z for a unit rotation, and the rate is per unit of it."""
    k = len(pushed) // 2
    velocity, rotation = pushed.mechanism(k)
    middle = 0.5 * (pushed.centre[k, 1, 1] + pushed.centre[k - 1, 1, 1])
    assert velocity[1, 0] == pytest.approx(1.0, rel=1e-9)
    assert rotation[1] == pytest.approx(-1.0 / middle, rel=1e-4)
    assert not velocity[0].any()


def test_the_block_lifts_at_its_heel_and_says_so(pushed):
    kinds = [(e.kind, e.bodies, round(e.at[0], 3)) for e in pushed.events]
    assert kinds == [("opens", ("floor", "block"), -0.1)]


def test_a_curve_is_followed_on_where_only_short_steps_arrive(pushed, monkeypatch):
    """A sixth of the step asked for arrives: longer ones are tried again, however often, while the curve goes on."""
    balance, whole = Statics.balance, float(np.diff(pushed.displacement).max())

    def short(self, state, multiplier, *, target=None, **options):
        found = balance(self, state, multiplier, target=target, **options)
        return found if target is None or target < whole / 6 else replace(found, found=False)

    monkeypatch.setattr(Statics, "balance", short)
    found = concio.push(standing(0.2, 1.0))
    assert found.ending is PushEnding.LOST
    assert found.capacity == pytest.approx(pushed.capacity, rel=1e-9)
    assert len(found) > 2 * len(pushed)


def test_what_does_not_arrive_by_any_step_ends_the_curve(pushed, monkeypatch):
    balance, tried, start = Statics.balance, [], pushed.centre[0, 1, 0]

    def lost(self, state, multiplier, *, target=None, **options):
        found = balance(self, state, multiplier, target=target, **options)
        tried.append(target)
        return replace(found, found=False) if found.state.centre[1, 0] - start > 0.05 else found

    monkeypatch.setattr(Statics, "balance", lost)
    found = concio.push(standing(0.2, 1.0))
    assert found.ending is PushEnding.NO_EQUILIBRIUM
    assert found.displacement[-1] == pytest.approx(0.05, rel=1e-5)
    assert len(tried) < 100


def test_left_is_the_mirror_of_right(pushed):
    left = concio.push(standing(0.2, 1.0), direction=-1)
    assert left.multiplier == pytest.approx(pushed.multiplier, abs=1e-9)
    assert left.rotation == pytest.approx(-pushed.rotation, abs=1e-9)


@pytest.mark.long
def test_any_control_follows_the_same_curve(pushed):
    """Points of the curve do not depend on what controls it."""
    top = concio.ControlPoint("block", (0.0, 1.0))
    by_top = concio.push(standing(0.2, 1.0), control=top, step=0.03)
    theta = -by_top.rotation_of("block")
    assert by_top.multiplier[2:] == pytest.approx(np.tan(SLENDER - theta[2:]), abs=1e-8)
    assert by_top.point(top) - by_top.point(top)[0] == pytest.approx(by_top.displacement, abs=1e-11)
    by_load = concio.push(standing(0.2, 1.0), control="load", step=0.02)
    assert by_load.ending is PushEnding.NO_LARGER_LOAD
    assert by_load.peak == pytest.approx(0.2, rel=2e-4)


def test_a_low_block_slides_at_its_friction():
    slid = concio.push(standing(1.0, 0.5, friction=0.3), until=0.2)
    assert slid.certified
    assert slid.ending is PushEnding.REACHED
    assert slid.displacement[-1] == pytest.approx(0.2)
    assert slid.multiplier[3:] == pytest.approx(0.3, abs=1e-9)
    assert {e.kind for e in slid.events} == {"slips"}


def test_a_point_load_high_on_the_block_turns_it_over_earlier():
    """H at height z on a block of weight W = 20 * 0.2 * 1 tips it at H z = W b / 2, and the arms change as it turns.

    With a factor of two the load is twice as large at the same multiplier.
    """
    model = standing(0.2, 1.0)
    load = concio.Load("point", (1.0, 0.0), bodies=("block",), at=(-0.1, 0.75), group="live")
    model = replace(model, loads=(*model.loads, load))
    found = concio.push(model, factors={"live": 2.0})
    theta = -found.rotation_of("block")
    c, s = np.cos(theta), np.sin(theta)
    arm_weight, arm_load = 0.1 * c - 0.5 * s, 0.75 * c + 0.2 * s  # of centroid and load point from the toe (0.1, 0)
    assert found.live == ("live",)
    assert found.multiplier[1:] == pytest.approx(2.0 * (arm_weight / arm_load)[1:], rel=1e-6)


def test_tie_adds_its_force_at_its_present_place():
    """A tie from the top to a wall on the left: moments about the toe with the elongation in the displaced state."""
    k, width, height = 30.0, 0.2, 1.0
    tie = concio.Tie("tie", "block", (-0.1, height), "", (-2.1, height), stiffness=k)
    model = replace(standing(width, height), ties=(tie,))
    found = concio.push(model, until=0.05)
    theta = -found.rotation_of("block")[-1]
    toe = np.array([0.1, 0.0])
    c, s = np.cos(theta), np.sin(theta)
    turn = np.array([[c, s], [-s, c]])
    end, centroid = toe + turn @ np.array([-0.2, 1.0]), toe + turn @ np.array([-0.1, 0.5])
    span = np.array([-2.1, height]) - end
    force = k * (np.linalg.norm(span) - 2.0) * span / np.linalg.norm(span)
    arm, W = end - toe, 4.0
    moment = arm[0] * force[1] - arm[1] * force[0]  # anticlockwise
    expected = (moment + W * (toe[0] - centroid[0])) / (W * centroid[1])
    assert found.multiplier[-1] == pytest.approx(expected, rel=1e-4)
    assert found.multiplier[-1] > 0.5  # far more than the block alone


def test_cohesion_holds_until_it_breaks_for_good():
    law = concio.JointLaw(0.3, cohesion=100.0, tensile_strength=0.0)
    model = replace(standing(1.0, 0.5), laws={"joint": law})
    found = concio.push(model, until=0.05)
    W = 10.0
    assert found.peak == pytest.approx(1.0 / 0.5, rel=1e-2)  # stuck: it turns over instead of sliding
    weak = replace(model, laws={"joint": concio.JointLaw(0.3, cohesion=4.0)})
    found = concio.push(weak, until=0.05)
    assert found.peak == pytest.approx(0.3 + 4.0 / W, rel=1e-2)
    assert found.multiplier[-1] == pytest.approx(0.3, abs=1e-9)
    lasting = concio.push(weak, until=0.05, brittle=False)
    assert lasting.multiplier[-1] == pytest.approx(0.3 + 4.0 / W, abs=1e-9)


@pytest.mark.long  # the elastic slab and pier
def test_elastic_pillar_tends_to_the_rigid_one():
    """Moments about the toe leave no choice: what differs is that a soft pillar is a little lower under its weight."""
    found = {}
    for E in (1e5, 1e7):
        model = standing(0.2, 1.0, kind="elastic", mesh_size=0.1)
        model = replace(model, materials={**model.materials, "block": concio.Elastic(E=E, nu=0.2, unit_weight=20.0)})
        result = concio.push(model, until=0.05, step=0.01)
        assert result.certified
        found[E] = result.multiplier[-1]
    rigid = concio.push(standing(0.2, 1.0), until=0.05, step=0.01).multiplier[-1]
    assert found[1e7] == pytest.approx(rigid, rel=1e-5)
    assert found[1e5] == pytest.approx(rigid, rel=1e-3)
    assert found[1e5] > rigid * (1 + 1e-4)


def test_an_elastic_pillar_without_weight_is_pushed_by_what_presses_on_it():
    """The frame of a body without mass was its moment over nothing: a force that is not finite, exit 2."""
    q = concio.Load("pressure", (50.0,), bodies=("block",), edge=((-0.1, 1.0), (0.1, 1.0)))
    model = standing(0.2, 1.0, kind="elastic", mesh_size=0.1)
    model = replace(model, materials={**model.materials, "block": concio.Elastic(E=1e7, nu=0.2)}, loads=(q,))
    found = concio.push(model, until=0.02, step=0.005)
    assert found.certified
    assert found.peak == pytest.approx(0.1 / 1.0, rel=1e-3)  # half the width over the height at which it acts


def test_what_does_not_stand_is_refused():
    leaning = model_of(
        box("floor", -5, 5, -1, 0, kind="fixed"),
        concio.Body("block", np.array([(0, 0), (1, 0), (4, 2), (3, 2)], dtype=float), kind="rigid", material="stone"),
        loads=(weight(),),
    )
    with pytest.raises(concio.NoEquilibriumError, match="does not stand"):
        concio.push(leaning)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"control": "displacement"}, "neither a ControlPoint nor 'load'"),
        ({"control": concio.ControlPoint("blokc", (0.0, 1.0))}, "did you mean 'block'"),
        ({"live": "liev"}, "there is no load group 'liev'"),
        ({"factors": {"daed": 2.0}}, "did you mean 'dead'"),
        ({"step": -1.0}, "step = -1 must be positive"),
        ({"until": 0.0}, "until = 0 must be positive"),
        ({"direction": (0.0, 0.0)}, "is not a direction"),
        ({"gravity": 0.0}, "gravity = 0 must be positive"),
    ],
)
def test_bad_arguments(arguments, words):
    with pytest.raises(concio.InputError, match=words):
        concio.push(standing(0.2, 1.0), **arguments)


def test_stopping_keeps_what_was_computed():
    calls = []
    found = concio.push(standing(0.2, 1.0), progress=lambda p: calls.append(p) or len(calls) >= 4)
    assert found.ending is PushEnding.STOPPED
    assert len(found) == 6  # the beginning, four points, and the peak between them
    assert found.multiplier[-1] > 0.19


def tied(stiffness, **options):
    model = standing(0.2, 1.0)
    tie = concio.Tie("tie", "block", (-0.1, 1.0), "", (-2.1, 1.0), stiffness=stiffness, **options)
    return replace(model, ties=(tie,))


@pytest.mark.long
def test_a_tie_yields_and_the_strength_ends_where_weight_and_tie_balance():
    """Peak: weight 4 and tie 1 about the toe; at the end the force of the tie holds what the weight overturns."""
    found = concio.push(tied(1e5, yield_force=1.0))
    assert found.peak == pytest.approx((4.0 * 0.1 + 1.0 * 1.0) / (4.0 * 0.5), rel=1e-3)
    theta = -found.rotation_of("block")[-1]
    toe, turn = np.array([0.1, 0.0]), np.array([[np.cos(theta), np.sin(theta)], [-np.sin(theta), np.cos(theta)]])
    end, centroid = turn @ (-0.2, 1.0), turn @ (-0.1, 0.5)
    pull = np.array([-2.1, 1.0]) - toe - end
    pull /= np.linalg.norm(pull)
    assert end[0] * pull[1] - end[1] * pull[0] == pytest.approx(4.0 * centroid[0], rel=1e-3)


@pytest.mark.long
def test_a_tie_that_breaks_leaves_the_block_alone():
    found = concio.push(tied(1e5, yield_force=1.0, break_elongation=0.02))
    assert found.capacity == pytest.approx(0.1, rel=1e-6)
    assert found.end.ties.broken.all()


@pytest.mark.long
def test_a_block_that_hangs_straight_on_a_stiff_tie_stretches_it():
    """Its foot is pulled away until it hangs in line with the tie: from then on the load is the tension."""
    k, W = 1e5, 4.0
    found = concio.push(tied(k), step=0.02, until=0.46)
    assert found.ending is PushEnding.REACHED
    assert found.certified
    slope = np.diff(found.multiplier) / np.diff(found.displacement)
    assert slope[-1] == pytest.approx(k / W, rel=1e-2)


def test_steps_that_nothing_solves_end_a_push_in_words(monkeypatch):
    """From some problem on no answer moves anything: the curve until there is kept, and few more are tried."""
    first, solve, asked = 80, StepSolver.step, []

    def fails(self, p, states, x, t):
        found = solve(self, p, states, x, t)
        asked.append(found)
        return found if len(asked) < first else replace(found, x=np.zeros_like(found.x), residual=1e-6)

    monkeypatch.setattr(StepSolver, "step", fails)
    curve = concio.push(standing(0.2, 1.0))
    assert curve.ending is PushEnding.NO_EQUILIBRIUM
    assert curve.certified
    assert len(curve) > 5
    theta = -curve.rotation_of("block")
    assert curve.multiplier[1:] == pytest.approx(np.tan(SLENDER - theta[1:]), abs=1e-8)
    assert first < len(asked) < first + 140


@pytest.mark.parametrize(("cap", "most"), first(1, [(50.0, 0.1195), (200.0, 0.180)]))
def test_a_crushing_toe_moves_the_hinge_inwards(cap, most):
    """At most 2 (b - a / 2) with the crushed length a = W / cap, were it resolved without error."""
    found = concio.push(standing(0.2, 1.0, friction=concio.JointLaw(1.0, compressive_strength=cap)))
    assert 0.9 * most < found.peak < 1.001 * most
    assert found.certified


@pytest.mark.long
def test_blocks_that_could_all_slide_part():
    """Every course slides at the same share of the weights; which block goes is decided by a millionth of them."""
    curve = concio.push(concio.wall(length=0.5, height=0.25, block="rigid", friction=0.6), step=0.005, until=1e-4)
    assert curve.ending is PushEnding.REACHED
    assert curve.multiplier[1:] == pytest.approx(0.6, abs=3e-6)


@pytest.mark.long
@pytest.mark.parametrize("E", [3e5, 1e7][: sample(1, 2)])
@pytest.mark.parametrize("elastic", first(1, [("pier", "slab"), ("pier",), ("slab",)], single=True))
def test_an_elastic_slab_that_leans_on_a_corner_stands_and_is_pushed_as_a_rigid_one(elastic: tuple[str, ...], E: float):
    """The corner meets the slab inside an element: no force acts where the corner is not.

    By hand: the slab turns about its foot when its weight and the load have no moment about it. At rest its foot
    neither slips nor lifts.
    """
    height, angle, length, thick = 1.5, 0.9, 2.3, 0.25
    along, across = np.array([-np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), np.cos(angle)])
    foot = np.array([0.8 + height / np.tan(angle), 0.0])
    slab = np.array([foot, foot + thick * across, foot + length * along + thick * across, foot + length * along])
    outlines = {"pier": np.array([[0.0, 0.0], [0.8, 0.0], [0.8, height], [0.0, height]]), "slab": slab}

    def made(soft: tuple[str, ...]) -> concio.Model:
        bodies = [
            concio.Body(name, outline, kind="elastic" if name in soft else "rigid",
                        material="block" if name in soft else "stone", mesh_size=0.4 if name in soft else None)
            for name, outline in outlines.items()
        ]  # fmt: skip
        materials = {"block": concio.Elastic(E=E, nu=0.2, unit_weight=20.0), "stone": concio.Rigid(20.0)}
        top = tuple(slab[2].tolist())
        live = concio.Load("point", (1.0, 0.3), bodies=("slab",), at=top, group="live")
        floor = concio.Body("floor", np.array([[-6, -0.5], [6, -0.5], [6, 0], [-6, 0]]), kind="fixed")
        laws = {"joint": concio.JointLaw(0.9)}
        return concio.Model((floor, *bodies), materials, laws, loads=(concio.Load("weight", (0.0, -1.0)), live))

    rigid = concio.push(made(()), until=0.002)
    found = concio.push(made(elastic), until=0.002)
    assert rigid.certified
    assert found.certified
    arm, at = slab.mean(axis=0) - foot, slab[2] - foot
    by_hand = 20.0 * length * thick * arm[0] / (at[0] * 0.3 - at[1] * 1.0)
    assert rigid.peak == pytest.approx(by_hand, rel=1e-3)
    assert found.peak == pytest.approx(by_hand, rel=2e-2)


@pytest.mark.long
def test_a_push_that_another_structure_ends_does_so_on_its_own_curve():
    """A wide pillar on springs leads, a narrow one beside it gives way: displacements stay proportional to loads."""
    law = concio.JointLaw(0.8, normal_stiffness=2e4, tangential_stiffness=1e4)
    wide = box("wide", -0.4, 0.4, 0.0, 1.0, kind="rigid", material="stone")
    narrow = box("narrow", 3.0, 3.2, 0.0, 1.0, kind="rigid", material="stone")
    floor = box("floor", -30.0, 30.0, -1.0, 0.0, kind="fixed")
    top = concio.ControlPoint("wide", at=(0.4, 1.0), direction=(1.0, 0.0))
    found = concio.push(model_of(floor, wide, narrow, law=law, loads=(weight(),)), control=top)
    assert found.certified
    assert found.ending is PushEnding.NO_EQUILIBRIUM
    assert 0.08 < found.multiplier[-1] <= concio.push(model_of(floor, narrow, law=law, loads=(weight(),))).peak
    flexibility = found.displacement[1:] / found.multiplier[1:]
    assert flexibility == pytest.approx(flexibility[0], rel=5e-4)


@pytest.mark.parametrize("dim", [2, pytest.param(3, marks=pytest.mark.long)])
@pytest.mark.parametrize("blocks", sample([3], [1, 3], [1, 2, 3, 6]))
def test_joints_that_are_open_at_first_close_before_the_push(blocks: int, dim: int) -> None:
    """It 'did not stand': the first step went through the joint. Half the width over the height of the mass, sunk."""
    wide, high, gap, law = 0.5, 0.4, 0.03, concio.JointLaw(0.6)
    boxes = [("ground", (-3.0, -1.0), (3.0, 0.0), "fixed")]
    boxes += [(f"b{k}", (0.0, k * high), (wide, (k + 1) * high), "rigid") for k in range(blocks)]
    bodies: tuple[concio.Body | concio.Polyhedron, ...]
    if dim == 2:
        bodies = tuple(box(name, low[0], up[0], low[1], up[1], kind=kind) for name, low, up, kind in boxes)
    else:
        bodies = tuple(
            concio.Polyhedron.box(name, (low[0], 0.0, low[1]), (up[0], 0.7, up[1]), kind=kind)
            for name, low, up, kind in boxes
        )
    model = concio.Model(
        bodies, {"block": concio.Rigid(20.0)}, {"joint": law}, rules=(concio.JointRule("joint", gap=gap),),
        loads=(concio.Load("weight", (0.0, -1.0) if dim == 2 else (0.0, 0.0, -1.0)),),
    )  # fmt: skip
    assert concio.solve(model).solved
    pushed = concio.push(model, direction=(1.0, 0.0, 0.0)[:dim], until=0.02)
    middle = blocks * high / 2 - (blocks - 1) * gap / 2
    assert pushed.multiplier.max() == pytest.approx(min(0.6, wide / 2 / middle), rel=1e-4)


@pytest.mark.parametrize("strength", [100.0, 400.0])
def test_a_push_of_joints_that_crush_prints_no_warning(strength: float) -> None:
    """Pairs without compliance were divided by the least number there is; the peak is that of a stress block."""
    law = concio.JointLaw(2.0, compressive_strength=strength)
    column = concio.column(width=0.5, height=1.0, blocks=1, block="rigid", unit_weight=20.0, horizontal=0.1,
                           friction=law)  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = concio.push(column)
    assert found.peak == pytest.approx(10.0 * (0.25 - 10.0 / (2.0 * strength)) / 0.5, rel=2e-3)
