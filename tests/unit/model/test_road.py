"""Fill, road and vehicles on a model: what reaches the masonry, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.errors import InputError
from concio.model.crossing import Axle, Vehicle
from concio.model.fill import Fill, Layer
from concio.model.plausibility import implausible
from concio.model.road.earth import (
    ground_of,
    spread_under,
    stress_at,
    width_used,
    with_fill,
    with_vehicle,
    without_pressure,
)
from concio.model.road.spread import spread, spread_rules
from concio.model.road.vehicles import convoy, find_vehicle, vehicles
from samples import sample


def arch(**more: object) -> concio.Model:
    """Return a small bridge of rigid voussoirs."""
    return concio.bridge(span=3.0, rise=0.75, ring=0.215, voussoirs=16, block="rigid", unit_weight=22.0, width=2.0,
                         **more)  # type: ignore[arg-type]  # fmt: skip


def covered(fill: Fill | None = None, **more: object) -> concio.Model:
    """Return it with fill on it."""
    return with_fill(arch(**more), fill or Fill(cover=0.3, unit_weight=20.0, passive=1.0))


@pytest.mark.parametrize("rule", spread_rules())
def test_the_total_is_the_axle_for_every_rule_and_position(rule: str) -> None:
    model = covered(Fill(cover=0.3, spread=rule, gradient=0.05))
    low, high = ground_of(model)[1].line[[0, -1], 0]
    model = with_vehicle(model, Vehicle("two", (Axle(0.0, 70.0), Axle(0.0, 30.0, length=0.9))))
    for x in np.linspace(low, high, sample(7, 60)):
        found = spread_under(model, float(x))
        assert found.force.sum() == pytest.approx(100.0, rel=1e-13)
        assert (found.force > 0).all()


@pytest.mark.parametrize("rule", spread_rules())
def test_on_a_flat_surface_the_load_is_centred_below_the_axle_and_as_long_as_the_rule_says(rule: str) -> None:
    block = concio.Body("slab", np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [0.0, 1.0]]), kind="rigid")
    flat = concio.Model((block,), {"block": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.5)})
    model = with_vehicle(with_fill(flat, Fill(cover=0.5, spread=rule)), Vehicle("one", (Axle(0.0, 10.0),)))
    found = spread_under(model, 4.0)
    assert found.at[:, 0] == pytest.approx([4.0], abs=1e-12)
    one = spread_rules()[rule]
    length = one.base(0.3) + 0.5 * one.along
    inside = one.pressure(np.array([0.499, 0.501]) * length, np.array([0.5, 0.5]), one.base(0.3))
    assert inside[0] > 0
    assert inside[1] == 0


def test_weight_of_the_fill_is_the_area_between_extrados_and_road() -> None:
    layers = (Layer(0.1, 23.0), Layer(0.05, 25.0))
    model = covered(Fill(cover=0.3, unit_weight=18.0, layers=layers))
    surface, road = ground_of(model)
    found = -sum(load.value[1] for load in model.loads if load.group == "fill")
    free = [k for k in range(len(surface)) if model.bodies[surface.body[k]].kind != "fixed"]
    x = np.linspace(surface.start[free[0], 0], surface.end[free[-1], 0], 20_001)
    middle = 0.5 * (x[1:] + x[:-1])
    depth = road.height(middle) - surface.height(middle)
    by_hand = 2.0 * (x[1] - x[0]) * (0.1 * 23 + 0.05 * 25 + 18.0 * (depth - 0.15)).sum()
    assert found == pytest.approx(by_hand, rel=1e-6)
    assert stress_at(model.fill, np.array([0.05, 0.12, 0.4])) == pytest.approx(  # type: ignore[arg-type]
        [1.15, 2.3 + 0.5, 2.3 + 1.25 + 18 * 0.25]
    )


def test_stress_below_a_fill_line_is_the_weight_of_what_lies_above() -> None:
    """Surfacing to the fill line, fill from there on; within the surfacing there is none of the fill."""
    fill = Fill(cover=0.4, unit_weight=18.0, fill_line=((-9.0, 0.5), (9.0, 0.7)), surfacing_weight=25.0)
    depth, surfacing = np.array([0.0, 0.1, 0.3, 0.3, 0.9]), np.array([0.2, 0.2, 0.2, 0.0, 0.5])
    by_hand = [0.0, 25 * 0.1, 25 * 0.2 + 18 * 0.1, 18 * 0.3, 25 * 0.5 + 18 * 0.4]
    assert stress_at(fill, depth, surfacing) == pytest.approx(by_hand)


def test_soil_pushes_inwards_up_to_its_passive_pressure_and_never_pulls() -> None:
    model = covered()
    soil = [t for t in model.ties if t.kind == "soil"]
    assert len(soil) == 16
    assembly = concio.assemble(model)
    for tie, normal, C in zip(soil, assembly.pairs.normal[assembly.ties], assembly.pairs.C_n[assembly.ties].toarray(),
                              strict=True):  # fmt: skip
        side = 1.0 if tie.at_a[0] < 1.5 else -1.0
        assert -normal == pytest.approx([side, 0.0])  # force on the voussoir
        body = [b.name for b in model.bodies].index(tie.body_a)
        assert C[assembly.disc.offsets[body]] == pytest.approx(side)  # moving away from the soil opens the gap
    assert without_pressure(model).ties == ()


def test_passive_pressure_follows_rankine_and_cohesion() -> None:
    fill = Fill(cover=0.3, friction_angle=30.0, mobilised=0.5, cohesion=4.0)
    assert fill.passive_coefficient == pytest.approx(1.5)
    assert fill.passive_cohesion == pytest.approx(0.5 * 2 * 4 * np.sqrt(3.0))
    assert Fill(cover=0.3, friction_angle=30.0, pressure="active").initial_coefficient == pytest.approx(1 / 3)
    assert Fill(cover=0.3, friction_angle=30.0, pressure="at rest").initial_coefficient == pytest.approx(0.5)


def test_pressure_at_rest_acts_before_anything_moves_and_active_pressure_never_falls_away() -> None:
    at_rest = covered(Fill(cover=0.3, friction_angle=30.0, pressure="at rest"))
    assert all(t.prestress > 0 for t in at_rest.ties)
    active = covered(Fill(cover=0.3, friction_angle=30.0, pressure="active"))
    sideways = [load.value[0] for load in active.loads if load.group == "fill" and load.value[0]]
    assert len(sideways) == 16
    assert sum(sideways) == pytest.approx(0.0, abs=1e-12)  # left and right balance
    caps = sum(t.yield_force or 0.0 for t in active.ties) + sum(map(abs, sideways))
    assert caps == pytest.approx(sum(t.yield_force or 0.0 for t in at_rest.ties))


def test_a_model_with_fill_and_vehicle_is_saved_and_read_back() -> None:
    own = {"along": 0.8, "across": 0.8, "shape": "sine"}
    fill = Fill(cover=0.4, layers=(Layer(0.1, 23.0),), spread=own, friction_angle=32.0, mobilised=0.4)
    model = with_vehicle(covered(fill), replace(find_vehicle("CS 454 double 2 x 9.5 t"), position=1.0))
    back = concio.loads(concio.dumps(model))
    assert concio.dumps(back) == concio.dumps(model)
    assert back.loads == model.loads
    assert back.ties == model.ties
    assert back.vehicle == model.vehicle


def test_stretches_of_uniform_load_count_as_far_as_the_road_reaches() -> None:
    model = with_vehicle(covered(), find_vehicle("LM71"))
    low, high = ground_of(model)[1].line[[0, -1], 0]
    found = spread_under(model, 1.5, whole=False)
    on_road = 80.0 * ((1.5 - 3.2 - low if low < 1.5 - 3.2 else 0.0) + (high - 4.7 if high > 4.7 else 0.0))
    axles = 250.0 * sum(low <= 1.5 + a <= high for a in (-2.4, -0.8, 0.8, 2.4))
    assert found.force.sum() == pytest.approx(axles + on_road)


def test_vehicles_carry_their_sources_and_convoys_add_up() -> None:
    assert all(v.source for v in vehicles().values())
    first = find_vehicle("CS 454 single 11.5 t")
    both = convoy(first, [(find_vehicle("CS 454 single 9 t"), -5.0)])
    assert [a.at for a in both.axles] == [0.0, -5.0]
    assert both.total == pytest.approx(112.8 + 88.3)
    left = Vehicle("one", (Axle(1.0, 10.0),), direction="left")
    assert left.footprints(5.0)[0][0] == 4.0


def test_each_vehicle_of_a_convoy_keeps_its_own_factors() -> None:
    """A convoy has the factors of its first vehicle; what each axle presses with is what it pressed with alone."""
    first = Vehicle("first", (Axle(0.0, 60.0), Axle(3.0, 90.0)), dynamic=1.4, factor=1.3)
    second = Vehicle("second", (Axle(0.0, 40.0), Axle(2.0, 70.0)), dynamic=1.1, factor=0.7, footprint=0.5)
    third = Vehicle("third", (Axle(1.0, 20.0),), dynamic=1.8, factor=2.2)
    whole = convoy(first, [(second, 8.0), (third, -6.0)])
    assert whole.total == pytest.approx(first.total + second.total + third.total, rel=1e-14)
    pressed = {a.at: whole.dynamic * whole.factor * a.load for a in whole.axles}
    alone = {shift + a.at: v.dynamic * v.factor * a.load
             for v, shift in ((first, 0.0), (second, 8.0), (third, -6.0)) for a in v.axles}  # fmt: skip
    assert pressed == pytest.approx(alone, rel=1e-14)
    assert [a.length for a in whole.axles] == [None, None, 0.5, 0.5, None]


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("[fill]\nunit_weight = 20.0", "road in [bridge_drawing]"),
        ("[fill]\ncover = -0.1", "road would lie below the crown"),
        ("[fill]\ncover = 0.3\ngradient = 0.4", "below the masonry"),
        ("[fill]\nroad = [[-1.0, 0.5], [4.0, 0.5]]", "road line runs from"),
        ("[fill]\nroad = [[-9.0, 0.9], [9.0, 0.9]]", "below the masonry"),
        ("[fill]\ncover = 0.3\nlayers = [{ depth = 0.4, unit_weight = 23 }]", "layers are 0.4 m deep"),
        ("[fill]\ncover = 0.3\nfriction_angle = 0.52", "implausible"),
        ("[fill]\ncover = 0.3\nmobilised = 3.0", "between 0 and 1"),
        ("[fill]\ncover = 0.3\nspread = 'uniform 2:1'", "no spread rule"),
        ("[fill]\ncover = 0.3\nspread = { along = 1.0 }", "across"),
        ("[fill]\ncover = 0.3\n[vehicle]\naxles = [[0.0, '11.5 t']]", "not a force"),
        ("[fill]\ncover = 0.3\n[vehicle]\nname = 'single axle'\nposition = 40.0", "outside the road"),
        ("[fill]\ncover = 0.3\n[vehicle]\nname = 'CS454'", "no vehicle 'CS454'"),
        ("[fill]\ncover = 0.3\n[vehicle]\naxles = [[0.0, -10.0]]", "must be positive"),
        ("[vehicle]\nname = 'single axle'\nposition = 1.0", "no fill"),
    ],
)
def test_bad_input_is_refused_in_words(table: str, words: str) -> None:
    text = "[bridge]\nspan = 3.0\nrise = 0.75\nring = 0.215\nvoussoirs = 16\nblock = 'rigid'\n" + table
    with pytest.raises(InputError) as caught:
        concio.loads(text)
    assert words in str(caught.value)
    assert "Traceback" not in str(caught.value)


def test_width_by_rule_is_reported_and_at_most_that_of_the_bridge() -> None:
    narrow = with_fill(concio.bridge(span=3.0, rise=0.75, ring=0.215, voussoirs=16, block="rigid", width=9.0),
                       Fill(cover=0.4, spread="CS 454", width="rule"))  # fmt: skip
    assert narrow.body("v01").thickness == pytest.approx(1.8 + 1.5 + 0.4)
    wide = with_fill(arch(), Fill(cover=0.4, spread="CS 454", width="rule"))
    assert wide.body("v01").thickness == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("[0.0, 90.0]", "[0.0, 11.5]"), "if tonnes were meant, write '11.5 tf'"),
        (("[0.0, 90.0]", "[0.0, 90.0], [1300, 90.0]"), "1300 m apart"),
        (("[0.0, 90.0]", "[0.0, 112800]"), "if newtons were meant, write '112800 N'"),
        (("width = 2.0", "width = 1.5"), "is 1.8 m wide, the structure below it 1.5 m"),
        (("unit_weight = 19.0", "unit_weight = 1900"), "'1900 kg/m3'"),
        (("unit_weight = 19.0", "unit_weight = 1.9"), "'1.9 t/m3'"),
        (("unit_weight = 23.0", "unit_weight = 2300"), "layer 'surfacing' weighs 2300"),
        (("cover = 0.3", "cover = 30"), "a cover of 30 m"),
        (("ring = 0.215", "ring = 2.15"), "a ring of 2.15 m in a span of 3 m"),
    ],
)
def test_numbers_in_other_units_are_told(change: tuple[str, str], words: str) -> None:
    text = (
        "[bridge]\nspan = 3.0\nrise = 0.75\nring = 0.215\nvoussoirs = 16\nblock = 'rigid'\nwidth = 2.0\n"
        "[fill]\ncover = 0.3\nunit_weight = 19.0\nlayers = [{ depth = 0.1, unit_weight = 23.0 }]\n"
        "[vehicle]\naxles = [[0.0, 90.0]]\n"
    )
    assert not implausible(concio.loads(text))
    assert words in " ".join(implausible(concio.loads(text.replace(*change))))
    for unit, value in (("t/m3", 1.9), ("kg/m3", 1900)):  # what the message suggests can be read
        read = concio.loads(text.replace("unit_weight = 19.0", f"unit_weight = '{value} {unit}'"))
        assert read.fill is not None
        assert read.fill.unit_weight == pytest.approx(1.9 * 9.80665, rel=1e-3)


@pytest.mark.parametrize(("vehicle", "wide"), [("single axle", 1.8), ("LM1 lane 1", 2.4), ("LM71", 2.6)])
def test_the_width_of_the_rule_is_that_of_the_vehicle_that_crosses(vehicle: str, wide: float) -> None:
    """In a file the fill comes before the vehicle: width, weight and soil are those of the vehicle's width."""
    text = (
        "[bridge]\nspan = 3.0\nrise = 0.75\nring = 0.215\nvoussoirs = 16\nblock = 'rigid'\nwidth = 9.0\n"
        "[fill]\ncover = 0.4\npassive = 1.0\nspread = 'uniform 1:2'\nwidth = 'rule'\n"
    )
    model = concio.loads(f"{text}[vehicle]\nname = '{vehicle}'\n")
    right = wide + 0.4
    direct = concio.loads(text.replace("'rule'", f"{right}"))
    assert model.fill is not None
    assert width_used(model, model.fill, model.vehicle)[0] == pytest.approx(right)
    assert [b.thickness for b in model.bodies] == pytest.approx([right] * len(model.bodies))
    assert len(model.loads) == len(direct.loads)
    for one, other in zip(model.loads, direct.loads, strict=True):
        assert one.value == pytest.approx(other.value)
    assert [t.yield_force for t in model.ties] == pytest.approx([t.yield_force for t in direct.ties])
    assert concio.loads(concio.dumps(model)).fill == model.fill


RULE = (
    "[bridge]\nspan = 3.0\nrise = 0.75\nring = 0.215\nvoussoirs = 16\nblock = 'rigid'\nwidth = 9.0\n"
    "[fill]\ncover = 0.4\nspread = 'uniform 1:2'\nwidth = 'rule'\n"
)


def test_the_width_of_the_rule_is_that_of_the_narrowest_axle() -> None:
    """A width of an axle of its own was left aside, and that of a second vehicle: the first decided alone."""
    own = concio.loads(f"{RULE}[vehicle]\naxles = [{{ at = 0.0, load = 90.0, width = 0.6 }}, [1.3, 90.0]]\n")
    assert own.bodies[0].thickness == pytest.approx(0.6 + 0.4)
    wide, narrow = (concio.find_vehicle(name) for name in ("LM71", "single axle"))
    for one, other in ((wide, narrow), (narrow, wide)):
        both = concio.with_vehicle(concio.loads(RULE), convoy(one, [(other, 8.0)]))
        assert both.bodies[0].thickness == pytest.approx(1.8 + 0.4)


def test_spandrel_walls_take_their_share_of_width_and_weigh_with_their_parapets() -> None:
    bare, walled = (covered(Fill(cover=0.3, unit_weight=20.0, passive=1.0, **more))  # type: ignore[arg-type]
                    for more in ({}, {"spandrels": 0.4, "spandrel_weight": 22.0, "parapet": 1.0}))  # fmt: skip
    down = [-sum(x.value[1] for x in m.loads if x.group == "fill") for m in (bare, walled)]
    over = float(np.ptp(np.vstack([b.vertices for b in bare.free_bodies])[:, 0]))
    assert down[1] == pytest.approx(down[0] * (1.2 * 20 + 0.8 * 22) / (2.0 * 20) + 0.8 * 22 * 1.0 * over, rel=1e-9)
    caps = [sum(t.yield_force or 0.0 for t in m.ties) for m in (bare, walled)]
    assert caps[1] == pytest.approx(0.6 * caps[0])
    for more, words in (({"spandrels": 1.0}, "leave no fill"), ({"spandrels": 0.3, "width": "rule"}, "narrower")):
        with pytest.raises(InputError, match=words):
            covered(Fill(cover=0.3, **more))  # type: ignore[arg-type]


def test_a_fill_line_is_the_layer_that_lies_above_it() -> None:
    model = arch()
    top = float(np.vstack([b.vertices for b in model.free_bodies])[:, 1].max()) + 0.4
    line = ((-9.0, top - 0.1), (9.0, top - 0.1))
    lined = covered(Fill(cover=0.4, passive=1.0, fill_line=line, surfacing_weight=24.0))
    layered = covered(Fill(cover=0.4, passive=1.0, layers=(Layer(0.1, 24.0),)))
    assert [x.value for x in lined.loads] == [pytest.approx(x.value) for x in layered.loads]
    assert [t.yield_force for t in lined.ties] == pytest.approx([t.yield_force for t in layered.ties])
    sloped = covered(Fill(cover=0.4, fill_line=((-9.0, top - 0.3), (1.5, top - 0.05), (9.0, top)), unit_weight=0.0))
    total = -sum(load.value[1] for load in sloped.loads if load.group == "fill")
    ends = np.vstack([b.vertices for b in sloped.free_bodies])[:, 0]
    x = np.linspace(ends.min(), ends.max(), 20_001)
    deep = top - np.interp(x, [-9.0, 1.5, 9.0], [top - 0.3, top - 0.05, top])
    assert total == pytest.approx(2.0 * 23.0 * np.trapezoid(deep, x), rel=1e-4)
    assert concio.loads(concio.dumps(lined)).fill == lined.fill
    for at, words in ((top + 0.1, "above the road"), (top - 0.5, "below the masonry")):
        with pytest.raises(InputError, match=words):
            covered(Fill(cover=0.4, fill_line=((-9.0, at), (9.0, at))))


@pytest.mark.parametrize("direction", ["right", "left"])
def test_footprints_press_with_all_factors_of_their_vehicle(direction: str) -> None:
    lorry = Vehicle(
        "lorry", (Axle(0.0, 60.0), Axle(-4.0, 90.0, length=0.5)), direction=direction, factor=1.5, dynamic=1.2
    )  # fmt: skip
    (x, length, load, stretch), (x2, length2, load2, _) = lorry.footprints(10.0)
    assert (x, x2) == (10.0, 6.0 if direction == "right" else 14.0)
    assert (length, length2) == (lorry.footprint, 0.5)
    assert (load, load2) == pytest.approx((60.0 * 1.8, 90.0 * 1.8))
    assert not stretch


@pytest.mark.parametrize("rule", spread_rules())
def test_forces_on_each_voussoir_are_the_integral_of_the_pressure(rule: str) -> None:
    """Against a sum over 100,000 strips of each piece, which knows nothing of where the pressure bends."""
    surface, road = ground_of(covered(Fill(cover=0.25, spread=rule, gradient=0.07)))
    one, x, footprint = spread_rules()[rule], 0.87, 0.3
    found = spread(one, surface, road, ((x, footprint, 10.0),))
    at = (np.arange(100_000) + 0.5) / 100_000
    shares = np.zeros(len(surface))
    for k, (start, end) in enumerate(zip(surface.start, surface.end, strict=True)):
        points = start + at[:, None] * (end - start)
        value = one.pressure(points[:, 0] - x, road.height(points[:, 0]) - points[:, 1], one.base(footprint))
        shares[k] = value.mean() * (end[0] - start[0])
    force = np.zeros(len(surface))
    force[found.piece] = found.force
    assert force == pytest.approx(10.0 * shares / shares.sum(), abs=2e-4)
    assert found.force.min() > 0


@pytest.mark.parametrize(
    ("name", "words"),
    [("Linee Guida 2020 schema A", "for want of a source"), ("RA7 axle", "3, 5, 8 and 10"), ("LM3", "LM2")],
)
def test_vehicles_whose_loads_have_no_source_are_named_with_the_reason(name: str, words: str) -> None:
    with pytest.raises(concio.InputError) as caught:
        concio.find_vehicle(name)
    assert words in (caught.value.hint or "")
    assert "your own is axles" in (caught.value.hint or "")


@pytest.mark.parametrize("key", ["cohesion", "mobilised"])
def test_strength_of_a_fill_without_an_angle_is_not_left_aside(key: str) -> None:
    """A cohesion of 10 kPa without an angle of friction pressed nothing, without a word."""
    with pytest.raises(InputError, match=f"{key} is given without friction_angle"):
        Fill(cover=0.3, **{key: 0.5})  # type: ignore[arg-type]
    undrained = Fill(cover=0.3, friction_angle=0.0, cohesion=10.0)
    assert undrained.passive_cohesion == pytest.approx(20.0)  # 2 c
    assert Fill(cover=0.3, passive=1.0, cohesion=10.0).passive_cohesion == pytest.approx(20.0)


def test_a_direction_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match="direction = 'west'"):
        Vehicle("own", (Axle(0.0, 10.0),), direction="west")  # type: ignore[arg-type]


def test_the_width_of_the_rule_without_a_vehicle_is_that_of_a_lorry() -> None:
    """Wheels 1.8 m apart, and the spread on either side of them."""
    model = concio.loads(RULE)
    assert model.fill is not None
    assert width_used(model, model.fill)[0] == pytest.approx(1.8 + 0.4)
