"""Uniform load of a vehicle: how it spreads, and where on the road it is unfavourable."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
from test_bridge_assessment import FILL, small, without_fill

import concio
from concio.analysis.bridges.sweep import Sweep
from concio.analysis.bridges.unfavourable import moved_down
from concio.analysis.limit import dead_and_live
from concio.errors import InputError
from concio.model.crossing import Axle, Vehicle
from concio.model.fill import Fill
from concio.model.plausibility import implausible
from concio.model.road.earth import ground_of, spread_under, with_fill, with_vehicle
from concio.model.road.spread import spread_rules
from concio.model.road.vehicles import axles_of, vehicles
from concio.solvers.statics.associated_limit import associated_limit
from concio.verdict.bridge_verdict import _loads, bridge_verdict, heaviest_words
from concio.verdict.bridge_words import Words
from samples import first

LANE = Vehicle("lane", axles_of([[0.0, 60.0]], [[-100.0, 100.0, 27.0]]), unfavourable=True)


def crossed(vehicle: Vehicle = LANE) -> concio.Model:
    """Return the small bridge under a vehicle with uniform load."""
    return with_vehicle(small(), vehicle)


@pytest.mark.parametrize("rule", spread_rules())
def test_far_from_its_ends_uniform_load_reaches_the_masonry_as_it_is_on_the_road(rule: str) -> None:
    """Of every rule; those with a footprint of their own put all of a train into the middle of the bridge."""
    x = np.linspace(0.0, 12.0, 49)
    blocks = tuple(
        concio.Body(f"b{k}", np.array([[a, 0.0], [b, 0.0], [b, 1.0], [a, 1.0]]), kind="rigid")
        for k, (a, b) in enumerate(pairwise(x.tolist()))
    )
    flat = with_fill(concio.Model(blocks, {"block": concio.Rigid(20.0)}, {"joint": concio.JointLaw(0.5)}),
                     Fill(cover=0.5, spread=rule))  # fmt: skip
    model = with_vehicle(flat, Vehicle("train", axles_of([], [[-4.0, 4.0, 80.0]])))
    found = spread_under(model, 6.0)
    assert found.force.sum() == pytest.approx(80.0 * 8.0, rel=1e-12)
    inside = np.abs(found.at[:, 0] - 6.0) < 2.5
    assert inside.sum() == 20
    assert found.force[inside] == pytest.approx(80.0 * 0.25, rel=1e-3)


@pytest.mark.parametrize("rule", spread_rules())
def test_a_stretch_is_the_sum_of_its_parts(rule: str) -> None:
    model = with_fill(without_fill(small()), replace(FILL, spread=rule, passive=0.0))
    line = ground_of(model)[1].line
    middle = 0.5 * float(line[0, 0] + line[-1, 0])
    whole, left, right = (
        _forces(with_vehicle(model, Vehicle("lane", axles_of([], [lane])), whole=False), middle)
        for lane in ([-100.0, 100.0, 27.0], [-100.0, 0.0, 27.0], [0.0, 100.0, 27.0])
    )
    assert left + right == pytest.approx(whole, abs=1e-9)


def _forces(model: concio.Model, x: float) -> np.ndarray:
    found = spread_under(model, x, whole=False)
    force = np.zeros(len(ground_of(model)[0]))
    force[found.piece] = found.force
    return force


@pytest.mark.parametrize("x", first(1, [0.6, 0.9, 2.0]))
def test_no_part_of_the_road_is_worse_than_the_one_that_is_found(x: float) -> None:
    """Of all single parts on a grid; and all of the road carries twice as much."""
    sweep = Sweep(crossed())
    found = sweep.at(x)
    assert found is not None
    assert found.loaded is not None
    ends = np.linspace(-1.0, 4.0, 11)
    tried = [sweep._under(x, "right", ((float(a), float(b)),)) for a, b in combinations(ends, 2)]
    least = min(s.multiplier for s in tried if s is not None)
    assert found.multiplier <= least * (1 + 1e-9)
    assert found.limit.checked
    whole = Sweep(crossed(replace(LANE, unfavourable=False))).at(x)
    assert whole is not None
    assert whole.loaded is None
    assert whole.multiplier > 1.2 * found.multiplier


def test_the_mechanism_moves_the_loaded_part_down_and_nothing_else_of_the_road() -> None:
    sweep = Sweep(crossed())
    found = sweep.at(0.8)
    assert found is not None
    assert found.limit.checked
    assert found.limit.mechanism is not None
    pieces, loads = sweep.pieces
    assert moved_down(pieces, loads @ found.limit.mechanism.velocity) == found.loaded
    assert moved_down(np.array([[0.0, 1.0], [1.0, 2.0], [3.0, 4.0], [4.0, 5.0]]), np.array([1.0, 2.0, -1.0, 3.0])) == (
        (0.0, 2.0), (4.0, 5.0),
    )  # fmt: skip


@pytest.mark.long
def test_the_model_at_the_worst_position_has_the_load_that_the_search_found_and_is_saved_with_it() -> None:
    found = concio.assess_bridge(crossed(), step=0.4, fine=0.1, worst=1, checked=3, sensitivity=False)
    assert found.vehicle.loaded == found.worst.loaded
    again = concio.loads(concio.dumps(found.model))
    assert again.vehicle == found.vehicle
    for model in (found.model, again):
        limit = associated_limit(*dead_and_live(concio.assemble(model), "live"))
        assert limit.multiplier == pytest.approx(found.worst.multiplier, rel=1e-9)
    assert found.summary()["worst"]["loaded"] == [list(part) for part in found.worst.loaded or ()]
    assert any("least favourable" in line for line in found.verdict.limits)
    assert any("meno favorevole" in line for line in bridge_verdict(found, "it").limits)
    assert "where it is unfavourable" in found.verdict.question.asked


def test_uniform_load_alone_is_worst_on_one_side() -> None:
    lane = Vehicle("lane", axles_of([], [[-100.0, 100.0, 27.0]]), unfavourable=True)
    found, whole = (Sweep(crossed(v)).at(1.5) for v in (lane, replace(lane, unfavourable=False)))
    assert found is not None
    assert whole is not None
    assert found.multiplier < 0.2 * whole.multiplier
    assert found.loaded is not None
    assert all(b < 1.9 or a > 1.1 for a, b in found.loaded)


@pytest.mark.parametrize("vehicle", [LANE, Vehicle("lorry", (Axle(0.0, 60.0), Axle(-9.0, 40.0)))])
def test_a_road_that_goes_on_beyond_the_masonry_changes_nothing(vehicle: Vehicle) -> None:
    """What stands further out than the abutments reaches none of them; drawings have such roads."""
    short = with_vehicle(small(), vehicle)
    height = float(ground_of(short)[1].line[0, 1])
    road = ((-40.0, height), (45.0, height))
    long = with_vehicle(with_fill(without_fill(small()), replace(FILL, cover=None, road=road)), vehicle)
    for x in (0.4, 0.7):
        one, other = Sweep(short).at(x), Sweep(long).at(x)
        assert one is not None
        assert other is not None
        assert other.multiplier == pytest.approx(one.multiplier, rel=1e-9)
        assert (other.on_masonry, other.elsewhere) == pytest.approx((one.on_masonry, one.elsewhere))


def test_traffic_models_of_codes_load_where_it_is_unfavourable_and_trains_of_fixed_length_do_not() -> None:
    known = vehicles()
    assert {name for name, v in known.items() if v.unfavourable} == {
        name for name, v in known.items() if v.uniform and not name.startswith("SW")
    }  # fmt: skip
    for lane in (1, 2, 3):  # NTC 2018 has the loads of EN 1991-2
        one, other = known[f"NTC 2018 schema 1 corsia {lane}"], known[f"LM1 lane {lane}"]
        assert (one.axles, one.footprint, one.width) == (other.axles, other.footprint, other.width)


@pytest.mark.parametrize(("loaded", "words"), [((1.0,), "not a part"), ((2.0, 1.0), "goes from 2 to 1")])
def test_parts_that_are_none_are_refused(loaded: tuple[float, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        replace(LANE, loaded=(loaded,))  # type: ignore[arg-type]


def test_a_vehicle_that_stands_says_that_its_uniform_load_is_everywhere() -> None:
    told = " ".join(implausible(crossed(replace(LANE, position=1.0))))
    assert "stands on the whole road" in told
    here = replace(LANE, position=1.0)
    for other in (LANE, replace(here, loaded=((0.0, 1.0),)), replace(here, axles=(Axle(0, 90.0),))):
        assert "whole road" not in " ".join(implausible(crossed(other)))


def test_no_part_at_all_is_read_back() -> None:
    model = crossed(replace(LANE, position=1.0, loaded=()))
    assert concio.loads(concio.dumps(model)).vehicle == model.vehicle
    assert spread_under(model, 1.0).force.sum() == pytest.approx(60.0)


def test_the_loads_of_a_vehicle_are_told_with_all_their_factors() -> None:
    """Axles of 60 and 40 kN and 27 kN/m, of which each has a dynamic factor of 1.2 and a factor of 0.5."""
    words = Words("en", crossed().report)
    axles, strip = [[0.0, 60.0], [2.0, 40.0]], [[-100.0, 100.0, 27.0]]
    for points, spread, told in (
        (axles, [], "heaviest axle 36 kN, 60 kN in all"),
        (axles, strip, "heaviest axle 36 kN, 60 kN in axles, and a uniform load of up to 16.2 kN/m"),
        ([], strip, "a uniform load of up to 16.2 kN/m"),
    ):
        vehicle = Vehicle("v", axles_of(points, spread), dynamic=1.2, factor=0.5)
        assert _loads(vehicle, words).startswith(told)
        assert _loads(replace(vehicle, unfavourable=True), words).startswith(told)
        assert heaviest_words(vehicle, 2.0, words)[1] == ("72 kN" if points else "32.4 kN/m")
