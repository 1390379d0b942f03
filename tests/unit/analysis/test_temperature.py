"""Changes of temperature: free and held bodies, friction that gives way, ratchets by cycles, closed forms for each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio import InputError, Temperature
from concio.proof.statement import refuse
from models import box, model_of, weight
from samples import sample

ALPHA, DT, MU = 8e-6, 30.0, 0.6
E, WEIGHT = 1e6, 20.0


def warmed(*bodies, material, law, loads=None, change=None, **options):
    """Bodies of the material "stone" whose temperature rises."""
    changes = (change or Temperature(DT),)
    loads = (weight(),) if loads is None else loads
    stones = {"stone": material, "heavy": concio.Rigid()}
    return model_of(*bodies, law=law, materials=stones, loads=loads, temperatures=changes, **options)


def between_abutments(law, *, kind="elastic", clearance=0.0):
    """A block of 2 m by 1 m on a floor between two abutments."""
    material = concio.Elastic(E, 0.0, WEIGHT, ALPHA) if kind == "elastic" else concio.Rigid(WEIGHT, ALPHA)
    return warmed(
        box("left", -1, 0, 0, 1, kind="fixed"), box("right", 2 + clearance, 3, 0, 1, kind="fixed"),
        box("floor", 0, 2, -1, 0, kind="fixed"), box("a", 0, 2, 0, 1, kind=kind, material="stone"),
        material=material, law=law,
        gap_reach=2 * clearance or None,
    )  # fmt: skip


@pytest.mark.parametrize("gradient", [(), (4.0, -7.0)])
@pytest.mark.parametrize("element", ["Q4", "Q8", "T6"])
def test_a_body_that_is_free_to_expand_has_no_stress(element, gradient) -> None:
    alone = warmed(
        box("floor", -1, 3, -1, 0, kind="fixed"), box("a", 0, 2, 0, 1, material="stone"),
        material=concio.Elastic(E, 0.2, 0.0, ALPHA), law=concio.JointLaw(0.0), loads=(),
        change=Temperature(DT, gradient=gradient), element=element, mesh_size=0.25,
    )  # fmt: skip
    pin, roller = [((x, 0.0), (x, 0.0)) for x in (0.0, 2.0)]
    held = (concio.Support("pin", "a", pin), concio.Support("roller", "a", roller, "y"))
    result = concio.solve(replace(alone, supports=held, bodies=(alone.bodies[1],)))
    assert result.solved
    _, stress = result.stress.at_points(0)
    np.testing.assert_allclose(stress, 0.0, atol=1e-9 * E * ALPHA * DT)
    grown = result.node_displacement(0)[np.argmax(result.nodes(0) @ (1.0, 1e-3))]
    assert np.linalg.norm(grown) > 0.5 * ALPHA * DT


def test_a_block_between_abutments_is_pressed_by_e_alpha_dt() -> None:
    result = concio.solve(between_abutments(concio.JointLaw(0.0)))
    assert result.certificate.worst < 1e-9
    assert result.reactions["left"][0] == pytest.approx(E * ALPHA * DT, rel=1e-9)
    assert result.stress.mean[3, 0] == pytest.approx(-E * ALPHA * DT, rel=1e-9)


def test_a_clearance_takes_its_share_of_the_force() -> None:
    clearance = 0.2e-3
    result = concio.solve(between_abutments(concio.JointLaw(0.0), clearance=clearance))
    assert result.reactions["left"][0] == pytest.approx(E * (ALPHA * DT - clearance / 2), rel=1e-6)


def test_a_rigid_block_presses_on_joints_with_stiffness() -> None:
    k = 1e6
    result = concio.solve(between_abutments(concio.JointLaw(0.0, normal_stiffness=k), kind="rigid"))
    assert result.reactions["left"][0] == pytest.approx(k * ALPHA * DT * 2 / 2, rel=1e-9)


@pytest.mark.parametrize("share", [0.5, 0.99, 1.01, 3.0])
def test_a_block_that_friction_holds_is_pressed_by_e_alpha_dt_until_it_slips_at_mu_n(share) -> None:
    """It lies on a smooth floor between a wall and a rigid stop, which a load N presses on a rough floor."""
    top = 100.0
    slips = MU * top / (E * ALPHA)
    model = warmed(
        box("wall", -1, 0, 0, 1, kind="fixed"), box("smooth", 0, 2, -1, 0, kind="fixed"),
        box("rough", 2, 3, -1, 0, kind="fixed"), box("a", 0, 2, 0, 1, material="stone"),
        box("stop", 2, 3, 0, 1, kind="rigid", material="heavy"),
        material=concio.Elastic(E, 0.0, 0.0, ALPHA), law=concio.JointLaw(0.0),
        change=Temperature(share * slips, ("a",)),
        loads=(concio.Load("pressure", (top,), ("stop",), edge=((2.0, 1.0), (3.0, 1.0))),),
    )  # fmt: skip
    model = replace(
        model, laws={**model.laws, "rough": concio.JointLaw(MU)},
        rules=(*model.rules, concio.JointRule("rough", ("stop", "rough"))),
    )  # fmt: skip
    result = concio.solve(model)
    assert result.certificate.worst < 1e-9
    assert result.reactions["wall"][0] == pytest.approx(min(share, 1.0) * MU * top, rel=1e-9)


def slope(height, friction, *, kind="rigid", elements=4):
    """A block 1 m long on a floor that rises by 10 degrees to the right."""
    turn = concio.place
    stone = {"rigid": concio.Rigid(WEIGHT, ALPHA), "elastic": concio.Elastic(1e8, 0.0, WEIGHT, ALPHA)}[kind]
    level = warmed(
        box("floor", -1, 2, -1, 0, kind="fixed"), box("a", 0, 1, 0, height, kind=kind, material="stone"),
        material=stone, law=concio.JointLaw(friction), mesh_size=1.0 / elements,
    )  # fmt: skip
    return turn(level, turn=10.0, loads="world")


def descent(model, times, steps=10):
    """How far the block has come down the slope."""
    seasons = concio.cycles("temperature", times=times, steps=steps)
    path = concio.run_path(model, [concio.Stage("weight", {"dead": 1.0}), *seasons])
    assert path.complete
    assert path.certificate < 1e-9
    down = -np.array([np.cos(np.deg2rad(10.0)), np.sin(np.deg2rad(10.0))])
    return float((path.result(-1).node_displacement(1) @ down).mean())


@pytest.mark.parametrize(("height", "friction"), [(0.1, 0.6), (1.0, 0.6), (1.5, 0.8), (2.0, 0.6)])
def test_a_stone_on_a_slope_goes_down_by_alpha_dt_l_a_cycle_or_not_at_all(height, friction) -> None:
    """It rests on two edges; where mu h < L the lower slides as it warms and the upper as it cools."""
    walks = friction * height < 1.0
    came = [descent(slope(height, friction), times) for times in (1, 3)]
    np.testing.assert_allclose(came, np.array([1.0, 3.0]) * ALPHA * DT * walks, atol=1e-3 * ALPHA * DT)


@pytest.mark.parametrize("elements", sample([10], [10, 20, 30]))
def test_a_bar_on_a_slope_creeps_as_lead_on_a_roof(elements) -> None:
    """By alpha dT L tan(slope) / mu a cycle, to one element (H. Moseley, Proc. Royal Society 7, 1855)."""
    friction = 0.5
    bar = slope(0.02, friction, kind="elastic", elements=elements)
    share = (descent(bar, 2) - descent(bar, 1)) / (ALPHA * DT)
    assert abs(share - np.tan(np.deg2rad(10.0)) / friction) < 1.0 / elements


def test_places_units_and_files_keep_a_change_of_temperature() -> None:
    text = """
        [materials.stone]
        kind = "rigid"
        unit_weight = 20
        expansion = "8e-6 1/K"
        [joints.dry]
        friction = 0.6
        [[rules]]
        law = "dry"
        [[blocks]]
        name = "floor"
        rectangle = [[0, -1], [1, 0]]
        kind = "fixed"
        [[blocks]]
        name = "a"
        rectangle = [[0, 0], [1, 1]]
        material = "stone"
        kind = "rigid"
        [[temperatures]]
        change = "-12 K"
        gradient = [0.0, "0.1 K/cm"]
        bodies = ["a"]
    """
    model = concio.loads(text)
    assert model.temperatures == (Temperature(-12.0, ("a",), (0.0, 10.0)),)
    again = concio.loads(concio.dumps(model))
    assert again.temperatures == model.temperatures
    assert again.materials == model.materials
    turned = concio.place(model, turn=90.0, name="part")
    np.testing.assert_allclose(turned.temperatures[0].gradient, (-10.0, 0.0), atol=1e-12)
    assert turned.temperatures[0].bodies == ("part-a",)
    both = concio.merge(turned, concio.place(model, at=(5.0, 0.0), name="other"))
    assert [t.bodies for t in both.temperatures] == [("part-a",), ("other-a",)]
    assert concio.extrude(model).temperatures[0].gradient == (0.0, 0.0, 10.0)


@pytest.mark.parametrize("kind", ["elastic", "rigid"])
def test_a_model_in_space_expands_as_its_section(kind) -> None:
    law = concio.JointLaw(0.0, normal_stiffness=1e6, tangential_stiffness=1e6)
    plane = between_abutments(law, kind=kind)
    forces = [concio.solve(m).reactions["left"][0] for m in (plane, concio.extrude(plane, 1.0))]
    assert forces[0] > 100.0
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-6)


def test_a_structure_turned_with_its_gradient_opens_the_same() -> None:
    model = replace(slope(0.5, 0.6), temperatures=(Temperature(5.0, gradient=(20.0, -40.0)),))
    turned = concio.place(model, turn=-10.0, at=(3.0, 4.0), loads="body")
    stages = [concio.Stage("weight", {"dead": 1.0}), concio.Stage("warm", {"temperature": 1.0})]
    gaps = []
    for one in (model, concio.place(turned, turn=10.0, loads="body")):
        gaps.append(concio.run_path(one, stages).result(-1).contacts.gap)
    np.testing.assert_allclose(gaps[0], gaps[1], atol=1e-9)


@pytest.mark.parametrize(
    ("change", "material", "words"),
    [
        (Temperature(10.0), concio.Rigid(20.0), "do not expand"),
        (Temperature(10.0, ("b",)), concio.Rigid(20.0, ALPHA), "changes in 'b'"),
        (Temperature(10.0, ("floor",)), concio.Rigid(20.0, ALPHA), "changes in 'floor'"),
        (Temperature(float("inf")), concio.Rigid(20.0, ALPHA), "not finite"),
    ],
)
def test_a_change_that_cannot_act_is_refused(change, material, words) -> None:
    model = warmed(
        box("floor", 0, 1, -1, 0, kind="fixed"), box("a", 0, 1, 0, 1, kind="rigid", material="stone"),
        material=material, law=concio.JointLaw(MU), change=change,
    )  # fmt: skip
    with pytest.raises(InputError, match=words):
        concio.solve(model)


@pytest.mark.parametrize(("key", "value"), [("change", "20 kN"), ("change", "warm"), ("gradient", ("3 m",))])
def test_a_change_in_another_unit_is_refused(key, value) -> None:
    with pytest.raises(InputError, match="load group 'temperature'"):
        Temperature(**{"change": 1.0, key: value})


def test_an_expansion_in_a_mistaken_unit_is_refused() -> None:
    with pytest.raises(InputError, match="for each kelvin"):
        concio.Rigid(20.0, expansion=8.0)


def test_what_does_not_state_temperatures_refuses_them() -> None:
    model = slope(0.1, MU)
    with pytest.raises(InputError, match="temperature"):
        concio.dynamics(model, duration=0.1)
    with pytest.raises(InputError, match="temperature"):
        refuse(concio.assemble(model))


def test_the_question_of_a_verdict_names_the_change() -> None:
    result = concio.solve(slope(0.1, MU))
    told = [acting.what for acting in result.verdict.question.acting if acting.group == "temperature"]
    assert told == ["1 change of temperature"]


def test_no_cycle_is_refused() -> None:
    with pytest.raises(InputError, match="not a cycle"):
        concio.cycles("temperature", 1.0, times=0)
