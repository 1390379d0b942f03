"""What touches only through fixed bodies is another problem: it changes no digit of the rest, and no verdict.

Each structure stands beside another one of any size and weight. And a block that nothing presses falls, however stiff
the joints are in which forces could be chosen at will to hold it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import concio
from concio.analysis.lent_compliance import lent_assembly
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Body, Load, Model, Polyhedron
from concio.model.rules import JointRule
from concio.problem.certificate import certify
from concio.problem.solution import Status
from concio.solvers.relaxation.free_motion import free_motion
from concio.studies.compare import compare
from samples import sample

few = settings(max_examples=sample(4, 12, 40), deadline=None)

FALLS = (Status.NO_EQUILIBRIUM, Status.COLLAPSES, Status.NO_COULOMB_STATE)

LAWS = {
    "hard": JointLaw(0.6),
    "stiff": JointLaw(0.6, normal_stiffness=1e9, tangential_stiffness=4e8),
    "cohesive": JointLaw(0.5, cohesion=3.0, tensile_strength=1.0),
}


def box(dim, name, low, high, kind="rigid", material="stone"):
    """A block of a plane model from x, z, or of one in space, as deep as it is high, from x, z."""
    (x0, z0), (x1, z1) = low, high
    if dim == 2:
        return Body(name, [(x0, z0), (x1, z0), (x1, z1), (x0, z1)], material=material, kind=kind)
    return Polyhedron.box(name, (x0, 0.0, z0), (x1, z1 - z0 or 1.0, z1), kind=kind, material=material)


def same(found, wanted):
    """Equal but for the last bit or two: where an array lies in memory decides the order in which BLAS adds."""
    np.testing.assert_allclose(found, wanted, rtol=1e-14, atol=1e-14 * np.abs(wanted).max(initial=0.0))


def stack(dim, kind):
    """Two blocks on a ground, the upper one off its middle."""
    return [
        box(dim, "ground", (-1, -1), (3, 0), "fixed"),
        box(dim, "low", (0, 0), (1, 0.7), kind),
        box(dim, "high", (0.2, 0.7), (0.9, 1.3), kind),
    ]


def hanging(dim, kind, h=1.0):
    """A block between two walls that nothing presses."""
    return [
        box(dim, "left", (-h, 0), (0, h), "fixed"),
        box(dim, "right", (h, 0), (2 * h, h), "fixed"),
        box(dim, "block", (0, 0), (h, h), kind),
    ]


def another(dim, size, at, kind):
    """A block of any size on a ground of its own."""
    return [
        box(dim, "other ground", (at, -size), (at + 2 * size, 0), "fixed", "other"),
        box(dim, "other", (at, 0), (at + 1.3 * size, size), kind, "other"),
    ]


def model(dim, bodies, kind, law, horizontal=0.0, weight=20.0):
    materials = {
        "stone": Rigid(20.0) if kind == "rigid" else Elastic(E=1e6, nu=0.2, unit_weight=20.0),
        "other": Rigid(weight),
    }
    down = (horizontal, -1.0) if dim == 2 else (horizontal, 0.0, -1.0)
    return Model(
        tuple(bodies), materials, {"joint": LAWS[law]}, loads=(Load("weight", down),), mesh_size=0.5
    )  # fmt: skip


@pytest.mark.long
@few
@given(
    st.sampled_from([2, 2, 2, 3]), st.sampled_from(["rigid", "elastic"]), st.sampled_from(list(LAWS)),
    st.sampled_from([stack, hanging]), st.floats(-3, 2), st.floats(-6, 6), st.booleans(),
    st.sampled_from([0.0, 0.1, 0.4]),
)  # fmt: skip
def test_an_unconnected_body_changes_no_digit_of_the_rest(dim, kind, law, build, size, weight, first, horizontal):
    here, there = build(dim, kind), another(dim, 10.0**size, 7.0, "rigid")
    alone = concio.solve(model(dim, here, kind, law, horizontal), on_failure="return")
    bodies = [*there, *here] if first else [*here, *there]
    both = concio.solve(model(dim, bodies, kind, law, horizontal, 10.0**weight), on_failure="return")
    names = [b.name for b in both.model.bodies]
    of_rest = np.array([names[b] not in ("other", "other ground") for b in both.assembly.pairs.body_b])
    assert both.status is alone.status
    for name in ("normal_force", "friction_force", "gap", "slip"):
        same(getattr(both.solution, name)[of_rest], getattr(alone.solution, name))
    told = {names[int(b)]: part for part in both.solution.parts for b in part.bodies}
    assert told["other"].status is Status.SOLVED
    assert told[here[-1].name].status is alone.status
    assert both.certificate.worst == max(part.certificate.worst for part in both.solution.parts)
    if alone.status in FALLS:
        assert alone.mechanism is not None
        still = both.node_displacement("other", both.mechanism_velocity)
        assert not still.any(), "what stands has no part in the motion"
        moves = both.node_displacement(here[-1].name, both.mechanism_velocity)
        same(moves, alone.node_displacement(here[-1].name, alone.mechanism_velocity))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("h", sample([1e-3, 100.0], [1e-3, 100.0], [1e-3, 0.02, 1.0, 100.0]))
def test_a_block_that_nothing_presses_falls_at_any_stiffness(dim, h):
    """Whatever closes under its weight: 1e-4 m or 1e-15 m; and whether or not joints give way along themselves."""
    for k in sample([1e12, 1e15], 10.0 ** np.arange(5, 16)):
        for k_t in sample([None], [k, 0.4 * k, None]):
            bodies = hanging(dim, "rigid", h)
            loose = replace(
                model(dim, bodies, "rigid", "hard"),
                laws={"joint": JointLaw(0.6, normal_stiffness=k, tangential_stiffness=k_t)},
            )
            found = concio.solve(loose, on_failure="return")
            assert found.status in FALLS, (k, k_t)
            assert found.mechanism.violation <= 1e-9


def test_a_motion_that_nothing_touches_is_found_where_no_step_of_slow_motion_is():
    """Joints a thousand times softer along themselves than across: every pair stands at the tip of its cone."""
    law = JointLaw(0.6, normal_stiffness=1e15)
    loose = replace(model(3, hanging(3, "rigid"), "rigid", "hard"), laws={"joint": law})
    found = concio.solve(loose, on_failure="return")
    assert found.solution.info["strategy"] == "free motion"
    moves = found.node_displacement("block", found.mechanism_velocity)
    np.testing.assert_allclose(moves, np.broadcast_to([0.0, 0.0, -1.0], moves.shape), atol=1e-12)


@few
@given(st.sampled_from([2, 3]), st.floats(-3, 2), st.floats(5, 15), st.sampled_from([stack, hanging]))
def test_what_falls_freely_is_held_by_nothing(dim, size, k, build):
    """A stack presses its ground: its bodies do not move as if nothing touched them. Nor do those pushed aside."""
    law = JointLaw(0.6, normal_stiffness=10.0**k, tangential_stiffness=10.0**k)
    bodies = build(dim, "rigid") if build is stack else hanging(dim, "rigid", 10.0**size)
    for aside in (0.0, 0.3):
        problem = concio.assemble(
            replace(model(dim, bodies, "rigid", "hard", aside), laws={"joint": law})
        ).problem()
        found = free_motion(problem)
        assert (found is not None) == (build is hanging and aside == 0.0)
        if found is not None:
            assert found.certified
            assert not found.normal_force.any()


def towers(soil, joint, block=0.3):
    """Two heavy towers on a soft ground, and a small block between them that nothing presses."""
    bodies = [
        box(2, "ground", (-10, -1), (20, 0), "fixed"),
        box(2, "left", (-10, 0), (0, 10)),
        box(2, "right", (block, 0), (10 + block, 10)),
        box(2, "small", (0, 5), (block, 5 + block)),
    ]
    soft = JointLaw(0.6, normal_stiffness=soil, tangential_stiffness=soil)
    return replace(
        model(2, bodies, "rigid", "hard"), laws={"joint": joint, "soil": soft},
        rules=(JointRule("joint"), JointRule("soil", ("ground", "*"))),
    )  # fmt: skip


@few
@given(st.sampled_from([2, 2, 3]), st.floats(5, 15), st.lists(st.floats(0.0, 1.0), min_size=2, max_size=4))
def test_forces_chosen_at_will_in_joints_that_give_way_are_not_certified(dim, k, shares):
    law = JointLaw(0.6, normal_stiffness=10.0**k, tangential_stiffness=10.0**k)
    loose = replace(model(dim, hanging(dim, "rigid"), "rigid", "hard"), laws={"joint": law})
    problem = concio.assemble(loose).problem()
    m = problem.pairs
    t_n = 2.0 * 20.0 / m * (1.0 + np.resize(shares, m))
    down = problem.C_t @ np.eye(problem.unknowns)[dim - 1]
    t_t = (20.0 / m * down).reshape(m, dim - 1)
    found = certify(problem, np.zeros(problem.unknowns), t_n, t_t)
    assert found.equilibrium < 1e-12 or not np.allclose(shares, shares[0]), "by their sum they hold it"
    assert found.complementarity > 1e-3


@pytest.mark.long
@few
@example(3.0, 12.0, 0.03)
@given(st.floats(3, 6), st.floats(7, 12), st.sampled_from([0.03, 0.3, 1.0]))
def test_nor_are_they_where_all_around_moves_far(soil, k, block):
    """The towers go down by up to a metre and the small block with them: what its joints close is little beside it."""
    law = JointLaw(0.6, normal_stiffness=10.0**k, tangential_stiffness=10.0**k)
    loose = towers(10.0**soil, law, block)
    assert concio.solve(loose, on_failure="return").status in FALLS
    alone = replace(loose, bodies=loose.bodies[:3])
    standing = concio.solve(alone)
    assembly = concio.assemble(loose)
    problem, kept = assembly.problem(), len(standing.assembly.pairs)
    names = [b.name for b in loose.bodies]
    small = np.array(["small" in (names[a], names[b]) for a, b in zip(*bodies_of(assembly), strict=True)])
    assert (~small).sum() == kept
    u = np.r_[standing.solution.displacement, standing.solution.displacement[:2], 0.0]
    t_n, t_t = np.zeros(problem.pairs), np.zeros((problem.pairs, 1))
    t_n[~small], t_t[~small] = standing.solution.normal_force, standing.solution.friction_force
    weight = 20.0 * block**2
    t_n[small] = weight
    t_t[small, 0] = weight / small.sum() * (problem.C_t @ np.eye(problem.unknowns)[-2])[small]
    assert certify(problem, u, t_n, t_t).complementarity > 1e-7, "whether or not the rest balances"


def bodies_of(assembly):
    return assembly.pairs.body_a, assembly.pairs.body_b


@pytest.mark.long  # test_a_block_that_nothing_presses_falls_at_any_stiffness
def test_rigid_joints_beside_a_soft_ground():
    """Hard joints are given a compliance that is vanishing beside the ground's, and the block still falls."""
    for soil in (1e3, 1e5):
        for block in (0.03, 0.3):
            assert concio.solve(towers(soil, JointLaw(0.6), block), on_failure="return").status in FALLS, (soil, block)


def test_the_answer_names_the_part_that_falls():
    found = concio.solve(
        model(2, [*another(2, 2.0, 7.0, "rigid"), *hanging(2, "rigid")], "rigid", "hard"), on_failure="return"
    )
    assert "This is about block: 1 of 2 parts" in found.sentence
    assert "the others are in equilibrium" in found.sentence
    alone = concio.solve(model(2, hanging(2, "rigid"), "rigid", "hard"), on_failure="return")
    assert found.self_stress.load == alone.self_stress.load, "what stands has no part in the forces that could hold it"
    assert found.self_stress.compression == pytest.approx(alone.self_stress.compression, rel=1e-12)
    assert "This is about" not in concio.solve(model(2, stack(2, "rigid"), "rigid", "hard")).sentence


def test_every_method_and_command_decides_the_same_regularised_problem():
    """Two blocks in a slot, nothing below: without the compliance every force within friction would be an answer."""
    bodies = [
        box(2, "left", (-1, -0.5), (0, 1.5), "fixed"), box(2, "right", (1, -0.5), (2, 1.5), "fixed"),
        box(2, "b1", (0, 0), (0.5, 1)), box(2, "b2", (0.5, 0), (1, 1)),
    ]  # fmt: skip
    slot = model(2, bodies, "rigid", "hard")
    assert concio.solve(slot, on_failure="return").status in FALLS
    excluded = concio.solve(slot, "exhaustive", on_failure="return")
    assert excluded.status is Status.NO_COULOMB_STATE
    assert "with a compliance of" in excluded.sentence
    compared = compare(lent_assembly(slot).problem(), ["exhaustive", "lemke", "sparse-lemke", "alart-curnier"])
    assert all(row.outcome != "solved" for row in compared.rows)


def test_a_body_too_light_for_its_own_part_is_named():
    """A block between two rigid towers that nothing presses: it falls, or the verdict says that it cannot see it."""
    for share in (1e-3, 1e-11):
        bodies = [
            box(2, "ground", (-5, -1), (10, 0), "fixed"), box(2, "left", (-3, 0), (0, 3)),
            box(2, "right", (1, 0), (4, 3)), box(2, "small", (0, 1), (1, 2), material="other"),
        ]  # fmt: skip
        found = concio.solve(model(2, bodies, "rigid", "hard", weight=20.0 * share), on_failure="return")
        told = found.verdict
        assert found.status in FALLS or (told.exit_code == 4 and "small" in " ".join(told.unchecked)), share
