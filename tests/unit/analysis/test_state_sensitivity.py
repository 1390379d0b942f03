"""Derivatives of certified states, beside differences of states that are solved again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.linearised_state import LinearisedState, Rates
from concio.analysis.parameters import Parameter, parameters_of, stiffnesses_of
from concio.analysis.state_sensitivity import _row
from concio.contact.assembly import assemble_beside
from concio.errors import InputError
from samples import sample

STEP = 1e-4
CENTRAL = {-2: 1 / 12, -1: -8 / 12, 1: 8 / 12, 2: -1 / 12}
FORWARD = {0: -25 / 12, 1: 48 / 12, 2: -36 / 12, 3: 16 / 12, 4: -3 / 12}


def numbers_of(model: concio.Model) -> tuple[Parameter, ...]:
    return (*parameters_of(model), *stiffnesses_of(model))


def answer(model: concio.Model, parts: tuple[str, ...]) -> dict[str, np.ndarray]:
    found = concio.solve(model).solution
    return {name: np.asarray(getattr(found, name)) for name in parts}


def compare(model: concio.Model) -> int:
    """Compare all derivatives that there are with differences and return how many."""
    result, told = concio.solve(model), 0
    found = concio.state_sensitivity(result)
    if len(found.about_to_change):
        return 0
    rigid = bool(result.lent_compliance)
    parts = ("normal_force", "friction_force") if rigid else ("displacement", "normal_force", "friction_force")
    for p in numbers_of(model):
        row = found[p.name]
        if row.above is None:  # the mesh changes with the number
            assert p.kind == "length"
            continue
        assert not row.one_sided
        h = STEP * (abs(p.value) or 1.0)
        beside = {k: answer(p.change(p.value + k * h), parts) for k in CENTRAL}
        for name in parts:
            wanted = sum(c * beside[k][name] for k, c in CENTRAL.items()) / h
            own, size = getattr(row.above, name), np.abs(beside[1][name]).max() / (abs(p.value) or 1.0)
            known = np.isfinite(own)
            off = np.abs(own - wanted)[known].max(initial=0.0)
            assert off <= 1e-8 * max(size, float(np.abs(wanted).max())), (p.name, name)
            told += int(known.any())
    return told


@pytest.mark.long
@settings(max_examples=sample(1, 2, 5), deadline=None)
@given(st.floats(0.42, 0.7), st.floats(0.0, 0.14))
def test_walls_of_rigid_blocks(friction: float, horizontal: float) -> None:
    compare(concio.wall(length=2.0, height=0.75, block_size=(0.5, 0.25), friction=friction, horizontal=horizontal,
                        block="rigid"))  # fmt: skip


@pytest.mark.long
@settings(max_examples=sample(1, 2, 5), deadline=None)
@given(st.floats(0.4, 0.8), st.floats(0.5, 4.0), st.integers(5, 7))
def test_elastic_arches_that_slip_and_open(friction: float, load: float, voussoirs: int) -> None:
    compare(concio.arch(span=3.0, ring=0.4, voussoirs=voussoirs, friction=friction, crown_load=load, unit_weight=25))


@pytest.mark.long
def test_an_elastic_wall_with_slip_and_open_joints_has_derivatives() -> None:
    wall = concio.wall(length=1.5, height=0.75, block_size=(0.5, 0.25), friction=0.4, horizontal=0.2)
    assert compare(wall) >= 6
    arch = concio.arch(span=3.0, ring=0.4, voussoirs=5, friction=0.6, crown_load=2.0, unit_weight=25)
    assert compare(arch) >= 12


@pytest.mark.long
def test_a_block_in_space_that_slides_on_a_spring() -> None:
    """Friction turns with the slip: the derivative of its direction counts."""
    ground = concio.Polyhedron.box("ground", (-1, -1, -1), (2, 2, 0), kind="fixed")
    block = concio.Polyhedron.box("block", (0, 0, 0), (1, 1, 1), kind="rigid", material="stone")
    stone = {"stone": concio.Rigid(20.0)}
    joint = {"joint": concio.JointLaw(0.3, normal_stiffness=1e5, tangential_stiffness=5e4)}
    ends = (((1, 0.5, 0.5), (3, 0.5, 0.5)), ((0.5, 1, 0.5), (0.5, 3, 0.5)))
    ties = tuple(concio.Tie(f"t{k}", "block", end[0], "", end[1], stiffness=2e3) for k, end in enumerate(ends))
    loads = (concio.Load("weight", (0, 0, -1)), concio.Load("weight", (-0.4, -0.3, 0.0), group="push"))
    assert compare(concio.Model((ground, block), stone, joint, loads=loads, ties=ties)) >= 3


def pushed(force: float) -> concio.Model:
    """Return a block on the ground that touches a wall on its right, and is pushed that way."""
    ground = concio.Body("ground", ((-2, -1), (3, -1), (3, 0), (-2, 0)), kind="fixed")
    wall = concio.Body("wall", ((1, 0), (2, 0), (2, 1), (1, 1)), kind="fixed")
    block = concio.Body("block", ((0, 0), (1, 0), (1, 1), (0, 1)), kind="rigid", material="stone")
    law = concio.JointLaw(0.5, normal_stiffness=1e5, tangential_stiffness=4e4)
    loads = (concio.Load("weight", (0, -1)), concio.Load("point", (force, 0.0), bodies=("block",), at=(0.5, 0.1)))
    return concio.Model((ground, wall, block), {"stone": concio.Rigid(20.0)}, {"joint": law}, loads=loads)


def test_a_pair_about_to_change_gives_a_derivative_to_each_side() -> None:
    result = concio.solve(pushed(0.0))
    found = concio.state_sensitivity(result, {"push": pushed})
    joint = result.assembly.pairs.interface
    wall = np.flatnonzero(joint == joint[found.about_to_change[0]])
    assert found.about_to_change.tolist() == wall.tolist()  # all points of the joint with the wall, and no other
    row, h = found["own of push"], 1e-3
    assert row.one_sided
    parts = ("normal_force", "friction_force", "displacement")
    for sign, side in ((1.0, row.above), (-1.0, row.below)):
        assert isinstance(side, Rates)
        beside = {k: answer(pushed(sign * k * h), parts) for k in FORWARD}
        for name in parts:
            wanted = sign * sum(c * beside[k][name] for k, c in FORWARD.items()) / h
            assert getattr(side, name) == pytest.approx(wanted, abs=1e-8 * max(np.abs(wanted).max(), 1e-9)), name
    against = found.about_to_change
    assert row.below is not None
    assert row.above is not None
    assert np.abs(row.below.normal_force[against]).max() < 1e-15 * row.above.normal_force[against].sum()
    assert row.above.normal_force[against].sum() > 0.1


def test_a_stiffer_pillar_is_shorter_and_a_state_that_is_none_has_no_derivatives() -> None:
    pillar = concio.column(width=0.5, height=2.0, blocks=1, unit_weight=20.0, horizontal=0.0)
    row = concio.state_sensitivity(concio.solve(pillar))["stiffness of block"]
    assert row.above is not None
    settled = concio.solve(pillar).solution.displacement
    assert row.value * row.above.displacement == pytest.approx(-settled, abs=1e-9 * np.abs(settled).max())
    falls = concio.solve(replace(pillar, loads=(*pillar.loads, concio.Load("weight", (2.0, 0.0)))), on_failure="return")
    with pytest.raises(InputError, match="no certified state"):
        concio.state_sensitivity(falls)


def test_what_the_equations_are_linear_in_takes_two_models(monkeypatch: pytest.MonkeyPatch) -> None:
    """Friction and weights; four where they are not, and the derivatives are those of differences all the same."""
    made: list[concio.Model] = []

    def counted(known, model):
        made.append(model)
        return assemble_beside(known, model)

    monkeypatch.setattr("concio.analysis.state_sensitivity.assemble_beside", counted)
    model = concio.column(width=0.5, height=2.0, blocks=3, block="rigid", horizontal=0.1)
    laws = {k: replace(v, normal_stiffness=1e6, tangential_stiffness=4e5) for k, v in model.laws.items()}
    model = replace(model, laws=laws)
    taken: dict[str, int] = {}
    result = concio.solve(model)
    here = LinearisedState.of(result)
    assert not here.about.any()
    for p in numbers_of(model):
        made.clear()
        row = _row(p, result, here)
        taken[p.kind] = len(made)
        h = STEP * p.value
        beside = {k: concio.solve(p.change(p.value + k * h)).solution.displacement for k in CENTRAL}
        wanted = sum(c * beside[k] for k, c in CENTRAL.items()) / h
        assert row.above is not None
        assert np.abs(row.above.displacement - wanted).max() <= 1e-8 * np.abs(beside[1]).max() / p.value, p.name
    assert [taken[k] for k in ("friction", "unit weight", "normal stiffness", "length")] == [2, 2, 4, 4]


@pytest.mark.parametrize("unit", [1e-5, 1e6])
def test_a_number_in_another_unit_has_the_same_derivatives_to_each_side(unit: float) -> None:
    """The models beside a state at a change are found as near to it whatever the number is measured in."""
    result = concio.solve(pushed(0.0))
    here = LinearisedState.of(result)
    plain = _row(Parameter("own", "push", 1.0, "", lambda v: pushed(v - 1.0)), result, here)
    other = _row(Parameter("own", "push", unit, "", lambda v: pushed(v / unit - 1.0)), result, here)
    for name in ("normal_force", "friction_force", "displacement"):
        for a, b in ((plain.below, other.below), (plain.above, other.above)):
            assert a is not None
            assert b is not None
            size = np.abs(getattr(plain.above, name)).max()
            assert np.abs(getattr(b, name) * unit - getattr(a, name)).max() < 1e-9 * size, name
    assert np.abs(plain.below.normal_force - plain.above.normal_force).max() > 0.1
