"""Pushes of pillars against hand statics: moved supports, the side pushed to, ties that break, weightless blocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from models import box, model_of, weight
from samples import first, sample
from seismic_walls import site

B, H = 0.4, 1.6


def turned(points, angle):
    c, s = np.cos(angle), np.sin(angle)
    return [(c * x - s * y, s * x + c * y) for x, y in points]


def pillar(lean=0.0, supports=(), loads=(), ties=(), friction=0.7, unit_weight=20.0):
    floor = box("floor", -3.0, 3.0, -0.5, 0.0, kind="fixed")
    outline = [(-B / 2, 0.0), (B / 2, 0.0), (B / 2 + lean, H), (-B / 2 + lean, H)]
    body = concio.Body("pillar", outline, kind="rigid", material="stone")
    model = model_of(floor, body, law=friction, loads=(weight(), *loads))
    stone = {"stone": concio.Rigid(unit_weight=unit_weight)}
    return replace(model, supports=tuple(supports), ties=tuple(ties), materials={**model.materials, **stone})


def on_a_floor_turned_by(angle, **kw):
    return pillar(supports=(concio.Support("turn", "floor", rotation=angle),), **kw)


@pytest.mark.long
@pytest.mark.parametrize("angle", np.deg2rad([8.0, -10.0, -5.0, 2.0][: sample(2, 4)]))
def test_a_pillar_on_a_floor_that_has_turned_carries_what_hand_statics_says(angle):
    """tan(atan(b/h) + angle) to the right, tan(atan(b/h) - angle) to the left; as one drawn on a turned floor does."""
    for side in (1.0, -1.0):
        found = concio.push(on_a_floor_turned_by(angle), direction=side)
        assert found.certified
        assert found.peak == pytest.approx(np.tan(np.arctan(B / H) + side * angle), rel=3e-4)
        assert found.rotation[0] == pytest.approx([angle, angle], abs=1e-5)


@pytest.mark.long
def test_a_floor_turned_beyond_the_critical_angle_carries_nothing():
    with pytest.raises(concio.NoEquilibriumError, match=r"supports have moved by 0\.70"):
        concio.push(on_a_floor_turned_by(np.deg2rad(20.0)))


def test_a_support_that_the_growing_load_moves_is_refused():
    live = concio.Load("weight", (1.0, 0.0), group="live")
    support = concio.Support("turn", "floor", rotation=0.05, group="live")
    with pytest.raises(concio.InputError, match="moves support 'turn'"):
        concio.push(pillar(supports=(support,), loads=(live,)))


@pytest.mark.long
@pytest.mark.parametrize(("side", "toe"), first(2, [(None, 0.25), (-1.0, 0.15), (1.0, 0.25), ((-2.0, 0.0), 0.15)]))
def test_the_side_pushed_to_is_obeyed_where_a_live_group_grows(side, toe):
    """The centroid of the leaning pillar is 0.25 from its right toe, 0.15 from its left one, 0.8 above both."""
    live = concio.Load("weight", (1.0, 0.0), group="live")
    for model in (pillar(lean=-0.1), pillar(lean=-0.1, loads=(live,))):
        found = concio.push(model, direction=side)
        assert found.peak == pytest.approx(toe / 0.8, rel=3e-4)
        assert np.sign(found.force[0]) == (1.0 if toe == 0.25 else -1.0)


def test_a_direction_aside_of_the_live_loads_is_refused():
    live = concio.Load("weight", (1.0, 0.0), group="live")
    with pytest.raises(concio.InputError, match="no resultant along"):
        concio.push(pillar(loads=(live,)), direction=(0.0, 1.0))


@pytest.mark.long
def test_motion_that_is_mirrored_is_the_mirrored_motion():
    """Everything mirrored, ties and floor too: the same curve."""
    rod = concio.Tie("rod", "pillar", (-0.2, 1.2), "", (-2.0, 1.2), stiffness=3000.0, yield_force=3.0,
                     break_elongation=4e-3)  # fmt: skip
    other = replace(rod, at_a=(0.2, 1.2), at_b=(2.0, 1.2))
    right = concio.push(on_a_floor_turned_by(-0.03, ties=(rod,)), direction=1.0)
    left = concio.push(on_a_floor_turned_by(0.03, ties=(other,)), direction=-1.0)
    assert len(left) == len(right)
    assert left.multiplier == pytest.approx(right.multiplier, rel=1e-6)
    assert [e.kind for e in left.events if "tie" in str(e)] == [e.kind for e in right.events if "tie" in str(e)]


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 3)))
def test_a_tie_pulls_to_its_elongation_at_break_whatever_the_step(seed):
    """A low block that slides with a tie along its motion: friction, and stiffness times the elongation at break."""
    rng = np.random.default_rng(seed)
    mu, breaks, stiffness = rng.uniform(0.05, 0.3), rng.uniform(2e-4, 4e-3), rng.uniform(200, 4000)
    rod = concio.Tie("rod", "low", (0.0, 0.1), "", (-1.0, 0.1), stiffness=stiffness, yield_force=1e3,
                     break_elongation=breaks)  # fmt: skip
    low = concio.Body("low", [(0, 0), (1, 0), (1, 0.4), (0, 0.4)], kind="rigid", material="stone")
    loads = (weight(), concio.Load("point", (1.0, 0.0), bodies=("low",), at=(0.0, 0.1), group="live"))
    model = replace(model_of(box("floor", -3.0, 6.0, -0.5, 0.0, kind="fixed"), low, law=mu, loads=loads), ties=(rod,))
    model = replace(model, materials={**model.materials, "stone": concio.Rigid(unit_weight=20.0)})
    for step in (None, 0.013, 0.31 * breaks):
        until = 3 * breaks if step == 0.31 * breaks else 0.05
        found = concio.push(model, step=step, until=until)
        assert found.certified
        assert found.peak == pytest.approx(mu * 20.0 * 0.4 + stiffness * breaks, rel=1e-5)
        assert found.displacement[found.peak_step] == pytest.approx(breaks, rel=1e-4)
        (event,) = [e for e in found.events if e.kind == "breaks"]
        assert event.bodies == ("tie rod", "low")
        assert event.step == found.peak_step
        assert found.multiplier[-1] == pytest.approx(mu * 20.0 * 0.4, rel=1e-5)  # and not a step longer
        assert not any("above the peak" in line for line in found.verdict.limits)  # the fall is that of the tie


@pytest.mark.long
def test_a_tie_that_yields_says_so_where_it_does():
    rod = concio.Tie("rod", "pillar", (-0.2, 1.2), "", (-2.0, 1.2), stiffness=3000.0, yield_force=3.0)
    found = concio.push(pillar(ties=(rod,)), step=0.01)
    (event,) = [e for e in found.events if e.kind == "yields"]
    d = found.point(concio.ControlPoint("pillar", (-0.2, 1.2), (1.0, 0.0)))[event.step]
    assert d == pytest.approx(1e-3, rel=1e-3)


def test_a_block_without_weight_under_a_point_load_is_pushed():
    """10 kN down and 0.6 friction: 6 kN to the side, through a block that weighs nothing."""
    loads = (
        concio.Load("point", (0.0, -10.0), bodies=("pillar",), at=(0.0, H)),
        concio.Load("point", (1.0, 0.0), bodies=("pillar",), at=(-0.2, 0.01), group="live"),
    )
    model = pillar(friction=0.6, unit_weight=0.0)
    found = concio.push(replace(model, loads=loads), until=0.02)
    assert found.certified
    assert found.peak == pytest.approx(6.0, rel=1e-4)


@pytest.mark.long
def test_a_push_of_the_weights_has_the_multiplier_of_an_assessment():
    """A wall that carries a floor: half its width over the height of all weights, by hand, by push, by assess."""
    floor = 24.0
    load = concio.Load("point", (0.0, -floor), bodies=("pillar",), at=(0.0, H), group="floor")
    model = pillar(loads=(load,))
    own = 20.0 * B * H
    wanted = (own + floor) * B / 2 / (own * H / 2 + floor * H)
    assert wanted < 0.9 * B / H  # self-weights alone would carry more
    found = concio.push(model, live=())
    assert found.peak == pytest.approx(wanted, rel=3e-4)
    (weights,) = [a for a in found.verdict.question.acting if a.role == "multiplied"]
    assert weights.size == pytest.approx(own + floor)
    assert f"dead {own:.4g} kN, floor {floor:.4g} kN" in weights.what
    checked = concio.assess(model, site=site(), direction="right", levels=["SLV"])
    assert min(m.multiplier for m in checked.mechanisms) == pytest.approx(found.peak, rel=3e-4)
    doubled = concio.push(model, live=(), factors={"floor": 2.0}).peak
    assert doubled == pytest.approx((own + 2 * floor) * B / 2 / (own * H / 2 + 2 * floor * H), rel=3e-4)


@pytest.mark.parametrize("cap", [2.0, 9.0][: sample(1, 2)])
def test_a_pillar_pushed_into_soil_carries_what_hand_statics_says(cap):
    """About the toe: weight, and soil that presses with its stiffness times the shortening up to its cap."""
    height, far, stiffness = 1.2, 10.0, 4000.0
    soil = concio.Tie(
        "soil", "pillar", (B / 2, height), "", (B / 2 + far, height), stiffness, yield_force=cap, kind="soil"
    )
    model = pillar(ties=(soil,))
    found = concio.push(model, direction=1.0)
    weighs = 20.0 * B * H * model.bodies[1].thickness
    angle = -found.rotation[1:, 1]
    sine, cosine = np.sin(angle), np.cos(angle)
    at = np.column_stack([height * sine, height * cosine])  # from the toe, about which it turns
    centroid = np.column_stack([-B / 2 * cosine + H / 2 * sine, B / 2 * sine + H / 2 * cosine])
    back = at - np.array([far, height])
    length = np.hypot(*back.T)
    force = (np.minimum(stiffness * (far - length), cap) / length)[:, None] * back
    turning = at[:, 0] * force[:, 1] - at[:, 1] * force[:, 0] - weighs * centroid[:, 0]
    carried = turning / (weighs * centroid[:, 1])
    assert found.certified
    assert found.ending.name == "LOST"
    assert (np.diff(angle) > 0).all()
    beyond = angle > 2 * cap / stiffness / height  # hard joints of rigid blocks give way by a millionth of a width
    assert beyond.sum() > 10
    assert found.multiplier[1:][beyond] == pytest.approx(carried[beyond], abs=1e-6)
    assert found.peak > B / H + 0.9 * cap * height / (weighs * H / 2)
