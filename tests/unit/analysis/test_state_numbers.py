"""The leading number of a state and its derivatives, beside closed forms and differences of solved states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.parameters import parameters_of, stiffnesses_of
from concio.analysis.state_numbers import SAME, LeadingNumber, leading_number
from concio.report.page import report_html
from samples import sample


def leading(model: concio.Model) -> LeadingNumber | None:
    result = concio.solve(model)
    return leading_number(result, concio.state_sensitivity(result))


@pytest.mark.long
@settings(max_examples=sample(4, 20), deadline=None)
@given(st.floats(0.5, 4.0), st.floats(5.0, 30.0), st.floats(1.0, 300.0))
def test_a_pillar_shortens_by_weight_and_pressure(height: float, weight: float, pressure: float) -> None:
    stone = concio.Elastic(E=2e6, nu=0.0)
    found = leading(concio.column(width=0.5, height=height, blocks=1, block=stone, unit_weight=weight,
                                  top_pressure=pressure, horizontal=0.0))  # fmt: skip
    assert found is not None
    assert found.kind == "settlement"
    own, top = weight * height**2 / 2 / 2e6, pressure * height / 2e6
    assert found.value == pytest.approx(own + top, rel=1e-9)
    shares = {"unit weight of block": own, "load of top": top, "stiffness of block": -own - top}
    for name, part in shares.items():
        assert found.sensitivity[name].per_percent[1] == pytest.approx(part / (own + top), abs=1e-8), name


@pytest.mark.long
@pytest.mark.parametrize("kind", ["settlement", "force"])
def test_derivatives_are_those_of_the_number_that_is_told(kind: str) -> None:
    """The number is read from results that are solved again, by its words alone."""
    if kind == "settlement":
        model = concio.arch(span=3.0, ring=0.4, voussoirs=6, friction=0.6, crown_load=2.0, unit_weight=25)
    else:
        model = concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), friction=0.5, horizontal=0.1, block="rigid")
    found = leading(model)
    assert found is not None
    assert found.kind == kind

    def told(other: concio.Model) -> float:
        result = concio.solve(other)
        if kind == "settlement":
            return result.max_settlement
        joints = result.tables.joints()
        names = [f"{a} | {b}" for a, b in zip(joints["body_a"], joints["body_b"], strict=True)]
        assert names.count(found.of) == 1
        return float(joints["normal_force"][names.index(found.of)])

    assert told(model) == pytest.approx(found.value, rel=1e-6)
    compared = 0
    for p in (*parameters_of(model), *stiffnesses_of(model)):
        if p.name not in {row.name for row in found.sensitivity.rows}:
            continue
        h = 1e-4 * p.value
        beside = [told(p.change(p.value + k * h)) for k in (-2, -1, 1, 2)]
        rate = (beside[0] - 8 * beside[1] + 8 * beside[2] - beside[3]) / (12 * h)
        assert found.sensitivity[p.name].rate == pytest.approx(rate, abs=1e-7 * found.value / p.value), p.name
        compared += 1
    assert compared >= 4


def test_forces_that_are_not_determined_have_no_derivative_and_displacements_have() -> None:
    """In a bonded elastic wall points of several joints fall together: their forces are shared in many ways."""
    wall = concio.wall(length=2.0, height=1.0, block_size=(0.5, 0.25), friction=0.5, horizontal=0.05)
    found = concio.state_sensitivity(concio.solve(wall))["unit weight of block"]
    assert found.above is not None
    assert np.isnan(found.above.normal_force).any()
    assert np.isfinite(found.above.displacement).all()


def test_the_force_of_the_joint_that_carries_most_is_told_where_it_is_determined() -> None:
    """A block on two piers: three quarters of a load stand on the nearer one; forces of other states are not told."""
    ground = concio.Body("ground", ((-2, -1), (4, -1), (4, 0), (-2, 0)), kind="fixed")
    piers = [concio.Body(name, ((x, 0), (x + 0.2, 0), (x + 0.2, 1), (x, 1)), kind="fixed")
             for name, x in (("near", 1.8), ("far", 0.0))]  # fmt: skip
    beam = concio.Body("beam", ((0, 1), (2, 1), (2, 1.5), (0, 1.5)), kind="rigid", material="stone")
    load = concio.Load("point", (0.0, -8.0), bodies=("beam",), at=(1.4, 1.25), group="live")
    model = concio.Model(
        (ground, *piers, beam), {"stone": concio.Rigid(0.0)}, {"joint": concio.JointLaw(0.5)}, loads=(load,)
    )
    result = concio.solve(model)
    found = concio.state_sensitivity(result)
    told = leading_number(result, found)
    assert told is not None
    assert (told.kind, set(told.of.split(" | "))) == ("force", {"near", "beam"})
    assert 8.0 * 1.4 / 2 <= told.value <= 8.0 * 1.4 / 1.8  # where in the joints the forces act is within their width
    heavy = concio.solve(model, factors={"live": 1e7})
    for of, numbers in ((result, found), (heavy, concio.state_sensitivity(heavy))):
        for share, same in ((1 + 0.3 * SAME, True), (1 - 3 * SAME, False), (1 + 3 * SAME, False), (np.nan, False)):
            other = replace(numbers, normal_force=share * numbers.normal_force)
            assert (leading_number(of, other) is not None) == same, share
    one_side = replace(found, rows=tuple(replace(row, below=None) for row in found.rows))
    told_of_one = leading_number(result, one_side)
    assert told_of_one is not None
    assert len(told_of_one.sensitivity.rows) == len(told.sensitivity.rows) > 0
    neither = replace(found, rows=tuple(replace(row, below=None, above=None) for row in found.rows))
    assert leading_number(result, neither) is None
    nothing = concio.solve(model, factors={"live": 0.0})
    assert leading_number(nothing, concio.state_sensitivity(nothing)) is None


def pillars(heights: dict[str, float], modulus: float, deep: int = 2) -> concio.Model:
    """Return elastic pillars beside each other, of different heights; in space they are 0.5 deep."""
    stone, blocks = {"stone": concio.Elastic(modulus, 0.0, unit_weight=20.0)}, []
    for k, (name, height) in enumerate(heights.items()):
        low, high = (float(k), 0.0), (k + 0.5, height)
        if deep == 3:
            blocks.append(concio.Polyhedron.box(name, (low[0], 0, 0), (high[0], 0.5, height), material="stone"))
        else:
            blocks.append(concio.Body(name, (low, (high[0], 0.0), high, (low[0], height)), material="stone"))
    ground = (
        concio.Polyhedron.box("ground", (-1, -1, -1), (5, 2, 0), kind="fixed") if deep == 3
        else concio.Body("ground", ((-1, -1), (5, -1), (5, 0), (-1, 0)), kind="fixed")
    )  # fmt: skip
    loads = (concio.Load("weight", (0.0, 0.0, -1.0)[3 - deep :]),)
    return concio.Model((ground, *blocks), stone, {"joint": concio.JointLaw(0.6)}, loads=loads)


@pytest.mark.long
@pytest.mark.parametrize("deep", [2, 3])
@pytest.mark.parametrize("first", ["tall", "low"])
def test_the_block_that_settles_most_is_named_with_what_it_depends_on(deep: int, first: str) -> None:
    """Each shortens by gamma h^2 / 2 E under its own weight alone."""
    heights = {"tall": 2.0, "low": 1.0}
    model = pillars({first: heights.pop(first), **heights}, 4e5, deep)
    found = leading(model)
    assert found is not None
    assert (found.kind, found.of) == ("settlement", "tall")
    assert found.value == pytest.approx(20.0 * 2.0**2 / 2 / 4e5, rel=1e-9)
    rows = {row.name: row.per_percent for row in found.sensitivity.rows}
    assert rows["unit weight of stone"] == pytest.approx((-1.0, 1.0), abs=1e-8)
    assert rows["stiffness of stone"] == pytest.approx((1.0, -1.0), abs=1e-8)
    sizes = [max(map(abs, per)) for per in rows.values()]
    assert sizes == sorted(sizes, reverse=True)
    idle = concio.solve(model, factors={"dead": 0.0})
    assert leading_number(idle, concio.state_sensitivity(idle)) is None


@pytest.mark.parametrize("deep", [2, 3])
def test_stresses_stand_where_their_block_does(deep: int) -> None:
    """Inside of it, evenly spread; above each there is on average the weight that it carries."""
    heights = {"tall": 2.0, "low": 1.0}
    result = concio.solve(pillars(heights, 4e5, deep))
    for name, height in heights.items():
        b = result.body_index(name)
        place, stress = result.stress.at_points(b)
        low, high = result.nodes(name).min(axis=0), result.nodes(name).max(axis=0)
        assert ((place > low) & (place < high)).all()
        assert place.mean(axis=0) == pytest.approx((low + high) / 2)
        assert (stress[:, deep - 1] + 20.0 * (height - place[:, -1])).mean() == pytest.approx(0.0, abs=1e-9)
        assert stress.mean(axis=0) == pytest.approx(result.stress.mean[b], abs=1e-9)
        falls = result.stress.at_nodes(b)[:, deep - 1] @ (result.nodes(name)[:, -1] - height / 2)
        assert falls > 0  # less pressed above


def test_of_a_hard_rigid_block_that_settles_most_a_force_is_told() -> None:
    """A rigid block on an elastic one: its own settlement is not that of a node."""
    model = pillars({"pillar": 1.0}, 4e5)
    cap = concio.Body("cap", ((0, 1), (0.5, 1), (0.5, 1.5), (0, 1.5)), kind="rigid", material="lead")
    soft = concio.JointLaw(0.6, normal_stiffness=1e3, tangential_stiffness=1e3)
    lead = {**model.materials, "lead": concio.Rigid(100.0)}
    on_joint = replace(model, bodies=(*model.bodies, cap), materials=lead, laws={"joint": soft})
    found = leading(on_joint)
    assert found is not None
    assert (found.kind, set(found.of.split(" | "))) == ("force", {"pillar", "ground"})
    assert found.value == pytest.approx(100.0 * 0.25 + 20.0 * 0.5, rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize(
    ("language", "heading", "words"),
    [("en", "What this state depends on", "derivatives of the certified state"),
     ("it", "Da che cosa dipende questo stato", "derivate dello stato certificato")],
)  # fmt: skip
def test_the_report_of_a_step_shows_bars_and_a_sentence(language: str, heading: str, words: str) -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=2, unit_weight=20.0, horizontal=0.05)
    page = report_html(concio.solve(pillar), language=language)  # type: ignore[arg-type]
    assert page.index(heading) < page.index(words)
    falls = replace(pillar, loads=(*pillar.loads, concio.Load("weight", (2.0, 0.0))))
    assert heading not in report_html(concio.solve(falls, on_failure="return"), language=language)  # type: ignore[arg-type]
