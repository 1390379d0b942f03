"""A vehicle on a bridge: the search over positions, what the answer is owed to, the verdict and the command."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import concio
from commands import run
from concio.analysis.bridges.mexe import mexe, mexe_of
from concio.analysis.bridges.service import service_state
from concio.analysis.bridges.sweep import Sweep, search
from concio.analysis.bridges.two_vehicles import second_vehicle, worst_apart
from concio.analysis.bridges.variants import _data, parts
from concio.analysis.limit import dead_and_live
from concio.analysis.motion.push_result import PushEnding
from concio.errors import InputError
from concio.model.body import Body
from concio.model.crossing import Axle, Vehicle
from concio.model.fill import Fill
from concio.model.road.earth import ground_of, with_fill, with_vehicle, without_pressure
from concio.model.road.vehicles import axles_of
from concio.solvers.statics.associated_limit import associated_limit
from concio.verdict.bridge_verdict import bridge_lines, bridge_verdict
from concio.verdict.bridge_words import TEXTS

FILL = Fill(cover=0.3, unit_weight=20.0, passive=1.0)


def small(fill: Fill = FILL, load: float = 10.0, **more: object) -> concio.Model:
    """Return a small bridge of rigid voussoirs under one axle that may stand anywhere."""
    options: dict[str, object] = {"span": 3.0, "rise": 0.75, "ring": 0.215, "voussoirs": 12, "width": 2.0}
    options |= {"block": "rigid", "unit_weight": 22.0, "friction": 0.6}
    model = with_fill(concio.bridge(**(options | more)), fill)  # type: ignore[arg-type]
    return with_vehicle(model, Vehicle("one axle", (Axle(0.0, load),)))


def without_fill(model: concio.Model) -> concio.Model:
    """Return its masonry alone."""
    return replace(model, fill=None, vehicle=None, loads=model.loads[:1], ties=())


def placed(model: concio.Model, x: float) -> concio.Model:
    """Return it with the vehicle at x."""
    assert model.vehicle is not None
    return with_vehicle(model, replace(model.vehicle, position=x))


def test_a_position_of_the_sweep_is_the_limit_load_of_the_model_with_the_vehicle_there() -> None:
    model = small()
    sweep = Sweep(model)
    for x in (0.4, 0.9, 2.2):
        dead, live = dead_and_live(concio.assemble(placed(model, x)), "live")
        found = sweep.at(x)
        assert found is not None
        assert found.multiplier == pytest.approx(associated_limit(dead, live).multiplier, rel=1e-9)


def test_the_search_finds_the_least_of_a_fine_grid_and_is_symmetrical() -> None:
    sweep = Sweep(small())
    found = search(sweep, step=0.15, fine=0.01)
    best = min(s.multiplier for s in found)
    assert best <= min(s.multiplier for x in np.arange(0.3, 2.7, 0.05) if (s := sweep.at(float(x)))) * (1 + 1e-3)
    left, right = sweep.at(0.7), sweep.at(3.0 - 0.7)
    assert left is not None
    assert right is not None
    assert left.multiplier == pytest.approx(right.multiplier, rel=1e-6)


@pytest.mark.parametrize(("x", "size"), [(10.0, 1e-3), (20.0, 1.0), (1000.0, 100.0), (-8.0, 1e-3)])
@pytest.mark.parametrize("first", [True, False])
def test_a_structure_beside_a_bridge_is_refused_where_the_road_would_hang_in_the_air(
    x: float, size: float, first: bool
) -> None:
    """An axle in the gap would press on the near end of the bridge with all its weight, or on nothing."""
    bare = without_fill(small())
    block = Body("other", x + size * np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), material="block", kind="rigid")
    ground = Body("other ground", x + size * np.array([[0, -1], [1, -1], [1, 0], [0, 0]]) , kind="fixed")
    beside = tuple(replace(b, outline=b.outline - [0.0, x], thickness=2.0) for b in (ground, block))
    bodies = (*beside, *bare.bodies) if first else (*bare.bodies, *beside)
    with pytest.raises(InputError, match="nothing lies below the road from x"):
        with_fill(replace(bare, bodies=bodies), FILL)


def test_what_does_not_reach_the_masonry_is_told() -> None:
    model = small()
    low, _ = Sweep(model).reach()
    found = Sweep(model).at(low)
    assert found is not None
    assert found.on_masonry + found.elsewhere == pytest.approx(10.0)
    assert found.elsewhere > 0
    assert Sweep(model).at(float(ground_of(model)[1].line[0, 0])) is None


def test_the_bound_is_built_up_from_ring_weight_spread_and_pressure() -> None:
    model = small()
    found = parts(model, 0.75, "right")
    values = list(found.values())
    assert values == sorted(values)
    alone = Sweep(without_pressure(model)).at(0.75)
    assert alone is not None
    assert values[2] == pytest.approx(alone.multiplier)


def test_a_vehicle_travels_both_ways() -> None:
    model = small()
    uneven = Vehicle("uneven", (Axle(0.0, 10.0), Axle(1.0, 3.0)), direction="both")
    sweep = Sweep(with_vehicle(model, uneven))
    assert sweep.directions == ("right", "left")
    there, back = sweep.at(0.7, "right"), sweep.at(3.0 - 0.7, "left")
    assert there is not None
    assert back is not None
    assert there.multiplier == pytest.approx(back.multiplier, rel=1e-6)
    assert Sweep(small()).directions == ("right",)


@pytest.fixture(scope="module")
def assessed() -> concio.BridgeResult:
    """Return an assessment of the small bridge."""
    return concio.assess_bridge(small(), step=0.3, fine=0.05, worst=1, checked=5, sensitivity=True)


def test_coulomb_states_are_at_or_below_the_associated_bound(assessed: concio.BridgeResult) -> None:
    assert assessed.design <= assessed.worst.multiplier * (1 + 1e-9)
    assert assessed.verdict.holds
    assert assessed.permissible_axle == pytest.approx(10.0 * assessed.design)


def test_the_verdict_names_vehicle_kilonewtons_and_what_it_rests_on(assessed: concio.BridgeResult) -> None:
    verdict = assessed.verdict
    assert "one axle" in verdict.question.asked
    assert "10 kN" in verdict.question.asked
    acting = {a.group: a for a in verdict.question.acting}
    assert acting["live"].role == "multiplied"
    assert acting["live"].asked == 1.0
    assert set(acting) == {"dead", "fill", "live"}
    assert any("due to the pressure of the soil" in line for line in verdict.limits)
    assert any("crushing" in line for line in verdict.unchecked)


def test_an_answer_that_rests_on_the_soil_says_so() -> None:
    """Between the bound with and without the pressure of the soil the answer is another one, and is reported to be."""
    found = concio.assess_bridge(small(), step=0.3, fine=0.05, worst=1, checked=0, sensitivity=False)
    assert found.without_soil is not None
    between = 0.5 * (found.worst.multiplier + found.without_soil.multiplier)
    rests = [bridge_verdict(replace(found, required=r)).attention for r in (between, 0.5)]
    assert any("depends on the pressure of the soil" in line for line in rests[0])
    assert not any("depends on the pressure of the soil" in line for line in rests[1])


def test_the_share_owed_to_the_soil_is_what_the_bound_loses_without_its_pressure(
    assessed: concio.BridgeResult,
) -> None:
    x = min(assessed.standings, key=lambda s: s.multiplier).position
    alone, pressed = Sweep(without_pressure(small())).at(x), Sweep(small()).at(x)
    assert alone is not None
    assert pressed is not None
    assert assessed.owed_to_soil == pytest.approx(1 - alone.multiplier / pressed.multiplier, abs=1e-6)
    assert 0 < assessed.owed_to_soil < 1


def test_more_than_the_bound_fails_and_no_coulomb_states_leave_it_open() -> None:
    found = concio.assess_bridge(small(), step=0.3, fine=0.05, worst=1, checked=0, sensitivity=False)
    assert found.verdict.outcome is concio.Outcome.INCOMPLETE
    top = found.worst.multiplier * 1.01
    failed = replace(found, required=top).verdict
    assert failed.outcome is concio.Outcome.FAILS
    assert failed.exit_code == 3


def test_sensitivities_go_the_right_way(assessed: concio.BridgeResult) -> None:
    found = {c.name: c for c in assessed.changes}
    assert found["ring"].at_low < assessed.worst.multiplier < found["ring"].at_high
    ring = found["ring"]
    assert (ring.low, ring.high) == pytest.approx((ring.value - 0.01, ring.value + 0.01))
    assert found["cover"].at_low < found["cover"].at_high
    assert found["passive"].at_low < found["passive"].at_high
    assert found["friction 'joint'"].at_low <= found["friction 'joint'"].at_high * (1 + 1e-9)


def test_the_deflection_is_what_the_vehicle_adds_under_it() -> None:
    """None where nothing deforms; elsewhere the most of all that blocks go down, here at the axle above the crown."""
    assert math.isnan(service_state(placed(small(), 1.5)).deflection)
    model = placed(small(load=5.0, block="elastic", mesh_size=0.3), 1.5)
    found = service_state(model)
    full, bare = concio.solve(model), concio.solve(model, factors={model.vehicle.group: 0.0})
    down = {
        b.name: float((bare.node_displacement(b.name) - full.node_displacement(b.name))[:, 1].max())
        for b in model.free_bodies
    }
    assert found.deflection == pytest.approx(max(down.values()), rel=1e-9)
    assert max(down, key=down.__getitem__) in ("v06", "v07"), "the axle stands above them"
    assert found.deflection > 0


def test_both_languages_say_the_same_things() -> None:
    assert set(TEXTS["en"]) == set(TEXTS["it"])
    import string

    for key, text in TEXTS["en"].items():
        names = [{n for _, n, _, _ in string.Formatter().parse(t) if n} for t in (text, TEXTS["it"][key])]
        assert names[0] == names[1], key


def test_mexe_is_the_formula_within_its_limits_and_says_where_it_does_not_apply() -> None:
    found = mexe(6.0, 1.5, 1.1, 0.45, 0.4)
    assert found.axle == pytest.approx(740 * 0.85**2 / 6**1.3 * 9.81)
    assert np.isnan(mexe(6.0, 1.2, 0.9, 0.45, 0.4).axle)
    assert mexe(6.0, 1.2, 0.9, 0.45, 0.4, span_rise=0.8).axle == pytest.approx(0.8 * found.axle)
    assert mexe(2.0, 1.0, 0.75, 1.0, 0.7).provisional == pytest.approx(70 * 9.81)
    assert np.isnan(mexe(30.0, 10.0, 7.5, 0.8, 0.4).axle)


@pytest.mark.parametrize("at", [(0.0, 0.0), (12.0, 4.0), (5e5, 300.0)])
@pytest.mark.parametrize("mirror", ["", "x"])
def test_mexe_takes_rise_and_profile_from_the_bridge_where_it_stands(at: tuple[float, float], mirror: str) -> None:
    """Of a semicircle r_q / r_c = sqrt(3) / 2. Without this the formula crashed away from x = 0."""
    masonry = concio.bridge(span=4.0, rise=2.0, ring=0.3, voussoirs=90, width=2.0, block="rigid")
    model = with_fill(concio.place(masonry, at, mirror=mirror), Fill(cover=0.4))
    found = mexe_of(model)
    assert found is not None
    assert found.provisional == pytest.approx(740 * 0.7**2 / 4**1.3 * 9.81)
    assert found.profile == pytest.approx(2.3 * (1 - math.sqrt(0.75)) ** 0.6, rel=1e-3)
    assert found.axle == pytest.approx(found.provisional * found.profile)


def written(tmp_path: Path, more: str = "") -> Path:
    path = tmp_path / "bridge.toml"
    path.write_text(
        "[bridge]\nspan = 3.0\nrise = 0.75\nring = 0.215\nvoussoirs = 12\nwidth = 2.0\nblock = 'rigid'\n"
        f"[fill]\ncover = 0.3\npassive = 1.0\n[vehicle]\naxles = [[0.0, 100.0]]\n{more}"
    )
    return path


@pytest.mark.long
def test_the_command_prints_one_object_and_leaves_with_the_verdict(tmp_path: Path) -> None:
    path = written(tmp_path)
    options = ("--step", "0.5 m", "--fine", "0.1 m", "--worst", "1", "--checked", "3", "--no-sensitivity")
    code, out, err = run("bridge", path, *options, "--json")
    told = json.loads(out)
    assert code == told["verdict"]["exit_code"] == 0, err
    sweep = Sweep(concio.load(path))
    least = min(sweep.at(float(x)).multiplier for x in np.arange(0.2, 2.9, 0.1))
    worst = told["worst"]["position"]
    assert sweep.at(worst).multiplier == pytest.approx(told["load_factor"]["associated"], rel=1e-9)
    assert told["load_factor"]["associated"] <= least * (1 + 1e-3)
    assert told["load_factor"]["design"] <= told["load_factor"]["associated"]
    code, out, _ = run("bridge", path, *options, "--required", "50")
    assert code == 3
    assert "not carried" in out


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        ("", ("--settle", "left abutment"), "names no distance"),
        ("", ("--settle", "north pier=10 mm"), "not a fixed body"),
        ("", ("--required", "0"), "must be positive"),
        ("", ("--step", "0 m"), "not a distance of positions"),
        ("", ("--step", "100"), "passes over the worst positions"),
        ("", ("--vehicle", "tank"), "no vehicle 'tank'"),
        ("", ("--apart", "8 m"), "no second vehicle"),
        ("", ("--second", "same"), "needs distances"),
        ("", ("--second", "same", "--apart", "8 kN"), "--apart"),
        ("", ("--second", "same", "--apart", "8,5 m"), "two ways"),
        ("", ("--settle", "left abutment=10"), "would settle by 10 m"),
        ("", ("--fine", "0"), "fine = 0 must be positive"),
        ("", ("--worst", "-1"), "worst = -1 must not be negative"),
        ("", ("--checked", "-5"), "checked = -5 must not be negative"),
        ("", ("--mexe-factor", "-0.7"), "must be positive"),
    ],
)
def test_bad_options_are_refused_in_words(text: str, options: tuple[str, ...], words: str, tmp_path: Path) -> None:
    code, _, err = run("bridge", written(tmp_path, text), "--step", "0.8 m", "--fine", "0.4 m", "--checked", "0",
                       "--no-sensitivity", *options)  # fmt: skip
    assert code == 2
    assert words in err
    assert "Traceback" not in err


def test_a_cover_in_millimetres_and_axles_with_commas_are_refused_with_what_to_write() -> None:
    with pytest.raises(concio.InputError, match="deeper than fill") as refused:
        Fill(cover=400.0, unit_weight=20.0)
    assert "400 mm" in str(refused.value.hint)
    with pytest.raises(concio.InputError, match="not a pair") as refused:
        axles_of([[0, 65, 93, 2]])
    assert "a point, not a comma" in str(refused.value.hint)


def test_a_model_without_fill_or_vehicle_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bare.toml"
    path.write_text("[bridge]\nspan = 3.0\nrise = 0.75\nring = 0.215\nvoussoirs = 12\nblock = 'rigid'\n")
    code, _, err = run("bridge", path)
    assert code == 2
    assert "no vehicle" in err


@pytest.mark.long
def test_the_same_fill_acts_in_one_step_in_a_path_and_in_a_push() -> None:
    """Soil presses in all of them: with it each carries what the ring alone does not."""
    model = placed(small(load=165.0), 0.7)
    alone = without_pressure(model)
    assert concio.solve(model).verdict.holds
    assert not concio.solve(alone, on_failure="return").verdict.holds
    stages = [concio.Stage("fill", {"dead": 1.0, "fill": 1.0}), concio.Stage("axle", {"live": 1.0})]
    assert concio.run_path(model, stages).verdict.holds
    assert not concio.run_path(alone, stages).verdict.holds
    most = associated_limit(*dead_and_live(concio.assemble(model), "live")).multiplier
    pushed, bare = concio.push(model, until=0.003), concio.push(alone, until=0.003)
    assert pushed.certified
    assert pushed.ending is PushEnding.REACHED
    assert bare.peak < 1.0 < pushed.peak < most
    assert pushed.multiplier[-1] < pushed.peak  # every element of the soil that yields is within a step of the curve


@pytest.mark.long
def test_a_study_varies_ring_and_fill_with_the_bridge_as_its_model(tmp_path: Path) -> None:
    variables = [
        concio.variable("ring", "uniform", keys="bridge.ring", low=0.20, high=0.23),
        concio.variable("k", "uniform", keys="fill.passive", low=0.0, high=1.5),
    ]
    found = concio.study(written(tmp_path), variables, ["bridge_load_factor", "bridge_axle"], "one-at-a-time")
    factors = found.values("bridge_load_factor")
    assert np.isfinite(factors).all()
    assert np.ptp(factors) > 0
    assert found.values("bridge_axle") == pytest.approx(100.0 * factors)
    acting = {a.group: a.role for a in found.verdict.question.acting}
    assert acting == {"dead": "constant", "fill": "constant", "live": "multiplied"}


@pytest.mark.long
def test_brackets_are_at_positions_that_are_least_in_their_neighbourhood() -> None:
    found = concio.assess_bridge(small(), step=0.15, fine=0.05, worst=5, checked=0, sensitivity=False)
    curve = [(s.position, s.multiplier) for s in found.standings]
    for bracket in found.brackets:
        k = next(i for i, (x, _) in enumerate(curve) if x == bracket.standing.position)
        assert bracket.standing.multiplier <= min(m for _, m in curve[max(k - 1, 0) : k + 2])
    assert len(found.brackets) == 2  # the mirror images of one


@pytest.mark.long
@pytest.mark.parametrize(("axle", "outcome"), [(100.0, "holds"), (400.0, "fails")])
def test_run_and_bridge_give_one_answer(axle: float, outcome: str, tmp_path: Path) -> None:
    path = written(tmp_path)
    path.write_text(path.read_text().replace("100.0", f"{axle}") + "position = 0.7\n")
    options = ("--step", "1 m", "--fine", "1 m", "--worst", "1", "--checked", "1", "--no-sensitivity")
    for command, more in (("run", ()), ("bridge", options)):
        code, out, _ = run(command, path, *more, "--json")
        told = json.loads(out)
        assert told["verdict"]["outcome"] == outcome, command
        assert told["verdict"]["exit_code"] == code
    assert run("bridge", path, *options, "--quiet")[1] == ""


def test_bad_names_are_refused_before_anything_is_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("concio.analysis.bridges.assess_bridge.search", None)
    for more in ({"others": ["tank"]}, {"settled": {"north pier": 0.01}}):
        with pytest.raises(concio.InputError):
            concio.assess_bridge(small(), **more)  # type: ignore[arg-type]


def two_spans() -> concio.Model:
    """Return two slender spans on a pier that tips, under one axle."""
    made = concio.bridge(span=[3.0, 3.0], rise=0.75, ring=0.215, voussoirs=8, width=2.0, block="rigid", friction=0.6,
                         unit_weight=22.0, pier_width=0.6, pier_height=3.0)  # fmt: skip
    return with_vehicle(with_fill(made, FILL), Vehicle("one axle", (Axle(0.0, 10.0),)))


@pytest.mark.long
def test_a_second_vehicle_is_put_where_both_are_worst() -> None:
    model = two_spans()
    options = {"step": 0.6, "fine": 0.3, "worst": 1, "checked": 1, "sensitivity": False}
    found = concio.assess_bridge(model, second="same", apart=[0.5, 3.6], **options)  # type: ignore[arg-type]
    assert list(found.apart) == [0.5, 3.6]
    for d, least in found.apart.items():
        both = Vehicle("two", (Axle(0.0, 10.0), Axle(d, 10.0)))
        places = search(Sweep(with_vehicle(model, both)), step=0.6, fine=1.0)
        assert least == pytest.approx(min(s.multiplier for s in places))
    worst = min(found.apart, key=lambda d: found.apart[d])
    assert [a.at for a in found.vehicle.axles] == [0.0, worst]
    assert found.worst.multiplier <= found.apart[worst] * (1 + 1e-9)
    assert any("0.5 m, 3.6 m" in line for line in found.verdict.limits)
    assert found.summary()["apart"][0]["distance"] == 0.5


def test_a_second_vehicle_unlike_the_first_goes_before_and_behind_it_with_its_axles_alone() -> None:
    other = second_vehicle(small(), "LM1 lane 1", [4.0])
    assert len(other.axles) == 2
    _, found = worst_apart(small(), other, [1.5], step=1.0)
    assert list(found) == [-1.5, 1.5]
    for name, apart, words in (("SW/0", [4.0], "axles"), ("same", [], "needs"), ("same", [-1.0], "positive")):
        with pytest.raises(concio.InputError, match=words):
            second_vehicle(small(), name, apart)


def test_every_datum_is_changed_by_what_the_report_says_and_alone() -> None:
    """Ten millimetres of ring, five centimetres of cover, five degrees, a tenth of friction, a fifth of strengths."""
    fill = Fill(cover=0.08, unit_weight=18.0, friction_angle=35.0, mobilised=0.5)
    law = concio.JointLaw(0.6, compressive_strength=5000.0)
    model = replace(small(fill), laws={"joint": law})
    rows = {name: (unit, value, step, changed) for name, unit, value, step, changed in _data(model)}
    told = {name: (unit, pytest.approx(value), pytest.approx(step)) for name, (unit, value, step, _) in rows.items()}
    assert told == {
        "ring": ("m", 0.215, 0.010), "cover": ("m", 0.08, 0.04), "fill unit weight": ("kN/m3", 18.0, 1.8),
        "friction angle": ("deg", 35.0, 5.0), "mobilised": ("-", 0.5, 0.1), "friction 'joint'": ("-", 0.6, 0.1),
        "strength 'joint'": ("kN/m2", 5000.0, 1000.0),
    }  # fmt: skip
    read = {
        "cover": lambda m: m.fill.cover, "fill unit weight": lambda m: m.fill.unit_weight,
        "friction angle": lambda m: m.fill.friction_angle, "mobilised": lambda m: m.fill.mobilised,
        "friction 'joint'": lambda m: m.laws["joint"].friction,
        "strength 'joint'": lambda m: m.laws["joint"].compressive_strength,
    }  # fmt: skip
    for name in read:
        _, value, step, changed = rows[name]
        made = changed(value + step)
        for other, its in read.items():
            assert its(made) == pytest.approx(value + step if other == name else its(model)), (name, other)
    thicker = rows["ring"][3](0.225)
    heights = [np.ptp(m.bodies[-1].vertices, axis=0) for m in (model, thicker)]
    assert not np.allclose(*heights)
    assert [step for name, _, _, step, _ in _data(small(replace(FILL, cover=0.3))) if name == "cover"] == [0.05]


@pytest.fixture(scope="module")
def two_brackets() -> concio.BridgeResult:
    """Return an assessment of two positions with brackets, and of few with Coulomb states, with a dynamic factor."""
    model = small(load=30.0)
    vehicle = replace(model.vehicle, axles=(Axle(0.0, 30.0), Axle(1.0, 10.0)), dynamic=1.5, factor=1.2)  # type: ignore[type-var]
    return concio.assess_bridge(
        with_vehicle(model, vehicle), step=0.3, fine=0.3, worst=2, checked=2, sensitivity=False
    )  # fmt: skip


def test_what_is_carried_stands_with_the_position_where_it_is(two_brackets: concio.BridgeResult) -> None:
    """The least of all brackets was said to be carried "there", at the position of the least bound."""
    first, second = two_brackets.brackets
    assert first.limit.design < second.limit.design
    other = replace(
        two_brackets, brackets=(replace(first, limit=second.limit), replace(second, limit=first.limit))
    )
    for language, there, least in (("en", "there", "The least that"), ("it", "vi porta", "Il minimo che")):
        plain, told = (bridge_verdict(found, language).answer for found in (two_brackets, other))  # type: ignore[arg-type]
        assert least not in plain
        at_worst, rest = told.split(least)
        assert there in at_worst
        assert f"{second.limit.design:.5g}".replace(".", "," if language == "it" else ".") in at_worst
        assert f"{first.limit.design:.5g}".replace(".", "," if language == "it" else ".") in rest


def test_positions_without_a_coulomb_state_are_not_left_out(two_brackets: concio.BridgeResult) -> None:
    """Two of a dozen positions were asked for: the others stood in no line."""
    checked, every = len(two_brackets.coulomb), len(two_brackets.standings)
    assert checked < every
    said = f"Coulomb friction at {every - checked} of {every} positions"
    assert any(line.startswith(said) for line in two_brackets.verdict.unchecked)


def test_loads_of_a_vehicle_have_their_factors_in_json(two_brackets: concio.BridgeResult) -> None:
    """'total' had the factors and 'heaviest_axle' beside it had not: the one axle weighed less than its share."""
    told = two_brackets.summary()["vehicle"]
    assert told["heaviest_axle"] / told["total"] == pytest.approx(30.0 / 40.0)
    assert two_brackets.summary()["axle"] == pytest.approx(two_brackets.design * told["heaviest_axle"])


def test_a_bridge_without_brackets_has_no_permissible_axle(two_brackets: concio.BridgeResult) -> None:
    lines = bridge_lines(replace(two_brackets, brackets=()))
    assert not [line for line in lines if line.startswith("  permissible") or "–" in line]
