"""The answer does not depend on where the wall stands, how its blocks are numbered, units, or the side it is seen from.

Walls on a full base with moderate friction: their displacements are unique (forces at corners are not, their resultants
on each body are).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.result import Result
from concio.model.materials import JointLaw
from concio.model.model import Load, Support, Tie
from models import corner_displacements, in_units, mirrored, renumbered, turned
from samples import sample

few = settings(max_examples=sample(5, 12), deadline=None)

LAWS = {
    "coulomb": JointLaw(0.6),
    "cohesive": JointLaw(0.5, cohesion=3.0, tensile_strength=1.0),
    "compliant": JointLaw(0.6, normal_stiffness=2e6, tangential_stiffness=8e5),
    "dilatant": JointLaw(0.5, dilatancy=0.2),
}


def walls(*elements):
    """Choices from which :func:`build` makes a wall; small values are printed where a test fails."""
    return st.fixed_dictionaries(
        {
            "law": st.sampled_from(list(LAWS)),
            "length": st.sampled_from([0.75, 1.0]),
            "height": st.sampled_from([0.25, 0.375]),
            "horizontal": st.sampled_from([0.0, 0.15, 0.25]),
            "top_pressure": st.sampled_from([0.0, 12.0]),
            "mesh_size": st.sampled_from([0.07, 0.125]),
            "element": st.sampled_from(elements or ["Q4", "Q4I", "T3"]),
            "settle": st.booleans(),
            "turn": st.sampled_from([0.0, 5e-4]),
            "tied": st.booleans(),
        }
    )


def build(wall):
    """A small wall by polygons only, without a grid, so that it can be turned."""
    options = {k: v for k, v in wall.items() if k not in ("law", "settle", "turn", "tied")}
    block = concio.Elastic(E=1e5, nu=0.2, unit_weight=20.0)
    model = concio.wall(friction=LAWS[wall["law"]], block=block, **options)
    if wall["settle"]:
        model = replace(
            model, supports=(Support("settle", "ground", displacement=(0.0, -1e-3), rotation=wall["turn"]),)
        )
    if wall["tied"]:
        top = model.free_bodies[-1]
        x, y = top.outline[2]
        push = Load("point", (-0.2, -0.5), bodies=(top.name,), at=(x, y), group="live")
        tie = Tie("rod", top.name, tuple(top.outline[0]), "ground", (x - 1.5, -0.01), 500.0, 0.3)
        model = replace(model, loads=(*model.loads, push), ties=(tie,))
    return model


def same(first, second, tolerance):
    assert first.keys() == second.keys()
    size = max(np.abs(v).max() for v in first.values())
    for name, value in first.items():
        np.testing.assert_allclose(second[name], value, atol=tolerance * size, rtol=0)


def body_forces(result: Result):
    """Resultant (x, y) of contact forces on each free body: unique by equilibrium."""
    pairs, force = result.contacts.pairs, result.contacts.force_on_b
    return {
        b.name: force[pairs.body_b == k].sum(0) - force[pairs.body_a == k].sum(0)
        for k, b in enumerate(result.model.bodies)
        if b.kind != "fixed"
    }


@few
@given(walls(), st.floats(0, 6.3), st.tuples(st.floats(-100, 100), st.floats(-100, 100)))
def test_rigid_placement(wall, angle, move):
    model = build(wall)
    first, second = concio.solve(model), concio.solve(turned(model, angle, move))
    c, s = np.cos(angle), np.sin(angle)
    back = np.array([[c, -s], [s, c]])
    moved = {name: u @ back for name, u in corner_displacements(second).items()}
    same(corner_displacements(first), moved, 1e-7)
    same(body_forces(first), {name: f @ back for name, f in body_forces(second).items()}, 1e-7)
    np.testing.assert_allclose(second.stress.principal[:2], first.stress.principal[:2], atol=1e-6 * 20, rtol=1e-6)


@few
@given(walls(), st.integers(0, 10**6))
def test_renumbering(wall, seed):
    model = build(wall)
    order = np.random.default_rng(seed).permutation(len(model.bodies))
    first, second = concio.solve(model), concio.solve(renumbered(model, order))
    same(corner_displacements(first), corner_displacements(second), 1e-8)
    same(body_forces(first), body_forces(second), 1e-8)
    assert second.reactions["ground"] == pytest.approx(first.reactions["ground"], rel=1e-8, abs=1e-9)


@few
@given(walls("Q4", "Q4I", "Q8"))  # triangles cut a rectangle along one diagonal
def test_mirror(wall):
    model = build(wall)
    first, second = concio.solve(model), concio.solve(mirrored(model))
    turned_back = {name: (u * [-1, 1])[::-1] for name, u in corner_displacements(second).items()}
    same(corner_displacements(first), turned_back, 1e-8)
    same(body_forces(first), {n: f * [-1, 1] for n, f in body_forces(second).items()}, 1e-8)


@few
@given(walls(), st.sampled_from([(1e3, 1e3), (1e-3, 1.0), (1.0, 39.37), (0.2248, 3.281)]))
def test_units(wall, units):
    """kN, m against N, mm and others: numbers change by the factors of the units and by nothing else."""
    model = build(wall)
    force, length = units
    first, second = concio.solve(model), concio.solve(in_units(model, force, length))
    assert second.certificate.worst <= 1e-9
    size = np.abs(first.displacement).max()
    np.testing.assert_allclose(second.displacement / length, first.displacement, atol=1e-10 * size, rtol=0)
    same(body_forces(first), {name: f / force for name, f in body_forces(second).items()}, 1e-10)


@few
@given(walls(), st.floats(0.1, 10.0))
def test_positive_homogeneity(wall, factor):
    """With zero gaps, no prestress and no strengths, loads and movements scaled together scale the answer."""
    model = build(wall)
    assume(not model.ties and not model.laws["joint"].cohesion)
    first = concio.solve(model)
    factors = dict.fromkeys(first.assembly.groups, factor)
    second = concio.solve(first.assembly, factors=factors)
    size = np.abs(first.displacement).max()
    np.testing.assert_allclose(second.displacement / factor, first.displacement, atol=1e-9 * size, rtol=0)


def test_mirror_symmetric_panel_has_a_mirror_symmetric_answer():
    for joint in (0.0, 0.02):
        result = concio.solve(
            concio.running_bond_panel(courses=3, blocks=3, joint=joint, top_pressure=10.0, friction=0.6)
        )
        width = result.model.generator["width"]
        table = {}
        for b in result.model.free_bodies:
            for x, u in zip(result.nodes(b.name), result.node_displacement(b.name), strict=True):
                where = tuple(b.outline.mean(0).round(6) * [1, 1])
                table[(*where, *x.round(6))] = u
        size = max(np.abs(u).max() for u in table.values())
        checked = 0
        for (cx, cy, x, y), u in table.items():
            other = table[tuple(np.round([width - cx, cy, width - x, y], 6))]
            np.testing.assert_allclose(other, u * [-1, 1], atol=1e-9 * size)
            checked += 1
        assert checked > 100
        left, right = result.reactions["left wall"], result.reactions["right wall"]
        assert left == pytest.approx((-right[0], right[1]), rel=1e-9)


@few
@given(walls())
def test_every_answer_is_complementary(wall):
    """Gaps, forces and slips of the results themselves, not of the certificate."""
    model = build(wall)
    result = concio.solve(model)
    c, law = result.contacts, result.assembly.laws
    force, length = np.abs(c.force_on_b).max(), np.abs(result.displacement).max()
    assert c.gap.min() >= -1e-9 * length
    assert (c.normal_force + law.tension).min() >= -1e-9 * force
    assert np.minimum(c.gap / length, (c.normal_force + law.tension) / force).max() <= 1e-8
    strength = law.cohesion + law.friction * c.normal_force
    friction, slip = c.friction_force[:, 0], c.slip[:, 0]
    assert (np.abs(friction) - strength).max() <= 1e-9 * force
    slipping = np.abs(slip) > 1e-7 * length
    np.testing.assert_allclose(friction[slipping], -np.sign(slip[slipping]) * strength[slipping], atol=1e-8 * force)
    assert (friction * slip).max() <= 1e-9 * force * length


def leaning(seed):
    """Two courses of elastic trapezia whose meshes do not match, with a tie and a force at points inside of one."""
    rng = np.random.default_rng(seed)
    cuts = [[0.0, *(0.6 + 0.15 * rng.uniform(-1, 1, 1)), 1.2], [0.0, *([0.3, 0.9] + 0.1 * rng.uniform(-1, 1, 2)), 1.2]]
    lean, height = 0.1 * rng.uniform(-1, 1, 4), [0.0, 0.4 + 0.05 * rng.uniform(-1, 1), 0.8]
    bodies = [concio.Body("ground", [(-1, -0.5), (2, -0.5), (2, 0), (-1, 0)], kind="fixed")]
    for j, at in enumerate(cuts):
        e = [0.0, *lean[2 * j : 2 * j + len(at) - 2], 0.0]
        for k in range(len(at) - 1):
            low, high = height[j], height[j + 1]
            foot, head = (at[k] - e[k], at[k + 1] - e[k + 1]), (at[k + 1] + e[k + 1], at[k] + e[k])
            points = [(foot[0], low), (foot[1], low), (head[0], high), (head[1], high)]
            bodies.append(concio.Body(f"c{j}{k}", points, thickness=0.4))
    at = tuple(float(v) for v in bodies[-1].centroid)
    return concio.Model(
        tuple(bodies),
        {"block": concio.Elastic(E=1e5, nu=0.2, unit_weight=20.0)},
        {"joint": JointLaw(0.6, normal_stiffness=2e5, tangential_stiffness=8e4)},
        loads=(Load("weight", (0.0, -1.0)), Load("point", (0.4, -1.0), bodies=(bodies[-1].name,), at=at)),
        ties=(Tie("rod", bodies[-1].name, at, "", (3.0, 1.0), 500.0, 0.5),),
    )


@pytest.mark.parametrize("seed", range(3))
def test_points_inside_elastic_blocks_and_meshes_that_do_not_match(seed):
    model = leaning(seed)
    first = concio.solve(model)
    second = concio.solve(mirrored(model))
    same(body_forces(first), {n: f * [-1, 1] for n, f in body_forces(second).items()}, 1e-9)
    third = concio.solve(renumbered(model, np.random.default_rng(seed).permutation(len(model.bodies))))
    same(corner_displacements(first), corner_displacements(third), 1e-9)
