"""Results of whole models against analysis by hand: columns, panels, blocks pushed, reference panels, summaries."""

from __future__ import annotations

import json
from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

import concio
from concio.cli.lines import result_lines
from concio.errors import InputError, NoEquilibriumError, SolverError
from concio.model.materials import Elastic, JointLaw
from concio.model.model import Load
from concio.problem.solution import Status
from concio.solvers.statics.mechanism import proves, verify_mechanism
from concio.verdict.step_verdict import step_verdict as verdict
from models import box, on_ground, weight

STONE = {"kind": "rigid", "material": "stone"}


def test_column_under_its_own_weight():
    """gamma H^2 / 2E at the top for nu = 0 and any number of blocks; stress grows linearly downwards."""
    height, gamma, E = 3.0, 20.0, 1e4
    stone = {"block": Elastic(E, 0.0, gamma)}
    for parts in (1, 3):
        h = height / parts
        blocks = [box(f"b{k}", 0, 1, k * h, (k + 1) * h, mesh_size=0.25) for k in range(parts)]
        result = concio.solve(on_ground(*blocks, loads=(weight(),), materials=stone))
        assert result.max_settlement == pytest.approx(gamma * height**2 / (2 * E), rel=1e-10)
        for k in range(parts):
            middle = height - (k + 0.5) * h
            np.testing.assert_allclose(result.stress.mean[k + 1], [0, -gamma * middle, 0], atol=1e-9)
        assert pytest.approx([gamma * (height - k * h) for k in range(parts)]) == result.joints.N
        assert result.reactions["ground"] == pytest.approx((0.0, gamma * height), abs=1e-9)
        assert result.total_load == pytest.approx((0.0, -gamma * height))


@pytest.mark.parametrize("joint", [0.0, 0.02])
def test_panel_without_lateral_strain_settles_as_a_bar(joint):
    """nu = 0: q H / E, whatever the friction and the joints."""
    q, E = 10.0, 1e5
    model = concio.running_bond_panel(
        courses=3, blocks=3, joint=joint, friction=0.7, top_pressure=q, block=Elastic(E, 0.0), mortar=Elastic(E, 0.0)
    )
    result = concio.solve(model)
    assert result.max_settlement == pytest.approx(q * model.generator["height"] / E, rel=1e-10)
    stress = result.stress.mean[[b.kind != "fixed" for b in model.bodies]]
    np.testing.assert_allclose(stress, [[0, -q, 0]] * len(stress), atol=1e-8)
    assert result.contacts.count("slip") == 0


def test_soft_mortar_settles_as_bars_in_series():
    q, E, soft = 10.0, 1e5, 1e4
    model = concio.running_bond_panel(
        courses=2, blocks=1, joint=0.02, friction=0.7, top_pressure=q, block=Elastic(E, 0.0), mortar=Elastic(soft, 0.0),
        side_walls=False,
    )  # fmt: skip
    # only the first course is one whole block: settle it alone between its faces
    result = concio.solve(model)
    u, nodes = result.node_displacement("c1-b1"), result.nodes("c1-b1")
    assert -u[nodes[:, 1] > 0.0999, 1].mean() == pytest.approx(q * 0.1 / E, rel=1e-9)
    bed = result.node_displacement("bed1")
    assert bed[:, 1].max() - bed[:, 1].min() == pytest.approx(q * 0.02 / soft, rel=1e-9)


@pytest.mark.parametrize("mu", [0.3, 0.8])
def test_block_pressed_and_pushed(mu):
    """Sticks until T = mu N; beyond it there is no equilibrium, and the mechanism holds up to a check of its own."""
    block = box("b", 0, 1, 0, 0.4, mesh_size=0.2)
    press = Load("pressure", (50.0,), edge=((0, 0.4), (1, 0.4)), group="press")
    push = Load("traction", (50.0, 0.0), edge=((0, 0), (1, 0)), group="push")  # in the sliding plane: no moment
    model = on_ground(block, loads=(press, push), law=mu, materials={"block": Elastic(1e4, 0.0)})
    for share in (0.2, 0.999):
        result = concio.solve(model, factors={"push": share * mu})
        assert result.contacts.count("slip") == 0
        assert result.contacts.count("stick") == len(result.contacts)
        assert result.reactions["ground"] == pytest.approx((-share * mu * 50, 50.0))
    with pytest.raises(NoEquilibriumError):
        concio.solve(model, factors={"push": 1.001 * mu})
    gone = concio.solve(model, factors={"push": 1.001 * mu}, on_failure="return")
    assert gone.status is Status.NO_EQUILIBRIUM
    problem = gone.assembly.problem({"push": 1.001 * mu})
    assert proves(problem, verify_mechanism(problem, gone.mechanism.velocity))
    velocity = gone.node_displacement("b", gone.mechanism_velocity)
    # no Coulomb state moves it up by less than mu times its slip: the associated mechanism slides and rises
    assert velocity[:, 0].min() > 0
    assert (velocity[:, 1] >= mu * velocity[:, 0] - 1e-9).all()


REFERENCE = [
    ({"blocks": 3, "friction": 0.6}, "2.909e-05", "2.8292e-05", None),
    ({"blocks": 3, "friction": 1.0}, "2.8974e-05", "2.7865e-05", None),
    ({"blocks": 3, "friction": 1.0, "joint": 0.02}, "3.2702e-05", "3.1585e-05", None),
    ({"blocks": 6, "friction": 0.6, "base": "none"}, "0.0037131", "0.002224", "1.5796"),
]
"""Largest and mean settlement of the top nodes [m], thrust on each wall [kN]. Source: GetFEM (augmented Lagrangian) and
an independent Lemke code agree; panels of three courses, E = 1e5 kN/m2, nu = 0.15, 10 kN/m2 on top, plane stress."""


def to_the_last_digit(text):
    """What rounds to the decimal number written."""
    return pytest.approx(float(text), abs=0.5001 * 10.0 ** Decimal(text).as_tuple().exponent)


@pytest.mark.parametrize("method", ["auto", "lemke"])
@pytest.mark.parametrize(("options", "largest", "mean", "thrust"), REFERENCE)
def test_reference_panels(options, largest, mean, thrust, method):
    model = concio.running_bond_panel(courses=3, top_pressure=10.0, **options)
    result = concio.solve(model, method=method)
    assert result.certificate.worst <= 1e-10
    top = model.generator["height"]
    settled = np.concatenate(
        [-result.node_displacement(b.name)[np.isclose(result.nodes(b.name)[:, 1], top), 1] for b in model.free_bodies]
    )
    assert settled.max() == to_the_last_digit(largest)
    assert settled.mean() == to_the_last_digit(mean)
    if thrust is not None:
        assert result.reactions["left wall"][0] == to_the_last_digit(thrust)
        assert -result.reactions["right wall"][0] == to_the_last_digit(thrust)
    total = np.sum(list(result.reactions.values()), axis=0)
    np.testing.assert_allclose(total, [0.0, 10.0 * model.generator["width"] * 0.1], atol=1e-10)


def test_mean_stress_is_the_virial_of_the_boundary_tractions():
    """V mean(sigma) = sum x (x) f over all forces on a body without body forces, here contact forces and pressure."""
    model = concio.running_bond_panel(courses=3, blocks=3, friction=0.5, top_pressure=10.0, joint=0.02)
    result = concio.solve(model)
    assembly, disc = result.assembly, result.assembly.disc
    s = result.solution
    forces = assembly.load() + assembly.pairs.C_n.T @ s.normal_force + assembly.pairs.C_t.T @ s.friction_force[:, 0]
    for b, body in enumerate(model.bodies):
        if body.kind == "fixed":
            continue
        f = forces[disc.offsets[b] : disc.offsets[b + 1]].reshape(-1, 2)
        virial = disc.nodes(b).T @ f / (body.area * body.thickness)
        sx, sy, txy = result.stress.mean[b]
        np.testing.assert_allclose(virial, [[sx, txy], [txy, sy]], atol=1e-8)


def test_joint_resultants_find_the_eccentricity():
    """A rigid block under an eccentric force: N, V, and N / e from statics."""
    push = Load("point", (3.0, -20.0), bodies=("b",), at=(0.25, 1.0))
    result = concio.solve(on_ground(box("b", -1, 1, 0, 1, **STONE), loads=(weight(), push)))
    (N,), (V,), (e,) = result.joints.N, result.joints.V, result.joints.eccentricity
    assert pytest.approx(60.0) == N
    assert pytest.approx(3.0) == V  # t = (-1, 0)
    # moment about the middle of the base: weight none, 20 at +0.25, 3 at height 1: both to the right
    assert -e == pytest.approx((20 * 0.25 + 3 * 1.0) / 60.0)
    np.testing.assert_allclose(result.joints.middle, [[0, 0]], atol=1e-12)
    assert result.joints.length == pytest.approx([2.0])
    assert not result.joints.slipping[0]


def test_open_share_and_pressure():
    """Overturning opens half of the joint: an elastic block of three nodes below."""
    push = Load("point", (11.0, 0.0), bodies=("b",), at=(-1.0, 1.0), group="push")
    model = on_ground(box("b", -1, 1, 0, 1, mesh_size=0.5), loads=(weight(), push), law=0.9)
    result = concio.solve(model)
    c = result.contacts
    assert c.count("open") > 0
    assert result.joints.open_share[0] == pytest.approx(c.pairs.length[c.state == 0].sum() / 2.0)
    np.testing.assert_allclose(c.pressure * c.pairs.area, c.normal_force)
    assert c.force_on_b.sum(0) == pytest.approx([-11.0, 40.0])


def test_settlement_counts_rigid_and_elastic_corners():
    tall = on_ground(
        box("a", 0, 1, 0, 1, mesh_size=0.5), box("b", 0, 1, 1, 2, **STONE), loads=(weight(),),
        materials={"block": Elastic(1e3, 0.0, 20.0)},
    )  # fmt: skip
    result = concio.solve(tall)
    top = (20 * 1 + 20 / 2) / 1e3
    assert result.max_settlement == pytest.approx(top)
    np.testing.assert_allclose(result.node_displacement("b")[:, 1], -top)
    assert np.isnan(result.stress.mean[2]).all()


def test_summary_holds_plain_numbers():
    model = concio.running_bond_panel(top_pressure=10.0)
    data = json.loads(json.dumps(concio.solve(model).summary()))
    for key in ("status", "method", "bodies", "contacts", "unknowns", "certificate", "iterations", "seconds",
                "max_settlement", "reactions"):  # fmt: skip
        assert key in data
    assert data["status"] == "solved"
    assert set(data["certificate"]) == {
        "equilibrium", "penetration", "cone", "slip_direction", "complementarity", "worst",
    }  # fmt: skip
    pushed = on_ground(box("b", 0, 1, 0, 0.2, **STONE), loads=(weight(), weight(0.9, 0.0)))
    failed = concio.solve(pushed, on_failure="return").summary()
    assert failed["status"] == "no_equilibrium"
    assert failed["mechanism"]["power"] > 0
    assert "max_settlement" not in failed
    json.dumps(failed)


@pytest.mark.parametrize(("free", "large"), [(0.03, False), (0.05, True)])
def test_joint_that_moves_most_beside_its_length_is_named(free, large):
    """A block pushed harder than friction holds slides until it meets a stop, and the ground is what it slid on."""
    stone = {"kind": "rigid", "material": "stone"}
    model = on_ground(
        box("block", 0.0, 0.4, 0.0, 0.2, **stone), box("stop", 0.4 + free, 0.6, 0.0, 0.2, kind="fixed"),
        loads=(weight(), Load("weight", (0.7, 0.0))), gap_reach=0.1,
    )  # fmt: skip
    result = concio.solve(model)
    moved = result.joint_motion
    assert moved.joint == "ground|block"
    assert moved.motion == pytest.approx(free, rel=1e-9)
    assert moved.share == pytest.approx(free / 0.4, rel=1e-9)
    assert moved.large is large
    assert result.summary()["joint_motion"]["share"] == moved.share
    told = "\n".join(result_lines(result))
    assert ("attention    joint ground|block opens or slides by 50 mm, 12.5 % of its length" in told) is large
    assert ("Joint ground|block opens or slides" in verdict(result).next_steps[0]) is large


def test_failures_raise_or_return_and_names_are_checked():
    model = on_ground(box("b", 0, 1, 0, 0.2, **STONE), loads=(weight(), weight(0.9, 0.0)))
    with pytest.raises(NoEquilibriumError, match="mechanism"):
        concio.solve(model)
    stopped = concio.solve(model, progress=lambda _: True, on_failure="return")
    assert stopped.status is Status.CANCELLED
    with pytest.raises(SolverError):
        concio.solve(model, progress=lambda _: True)
    good = concio.solve(on_ground(box("b", 0, 1, 0, 0.2, **STONE), loads=(weight(),)))
    with pytest.raises(InputError, match="no body called 'c'"):
        good.nodes("c")


@pytest.mark.parametrize("call", [concio.solve, concio.assemble, concio.limit, concio.run_path, concio.rock])
@pytest.mark.parametrize(("given", "told"), [("w.toml", "'w.toml'"), (Path("w.toml"), "'w.toml'"), (3, "int")])
def test_what_is_no_model_is_refused_in_one_sentence(call, given, told):
    with pytest.raises(InputError, match=f"a model is needed, .*{told} was given .*concio.load"):
        call(given)


def test_stress_at_points_and_nodes_of_a_uniform_state():
    q = 30.0
    model = on_ground(
        box("b", 0, 1, 0, 1, mesh_size=0.5),
        loads=(Load("pressure", (q,), edge=((0, 1), (1, 1))),),
        law=JointLaw(0.0),
        materials={"block": Elastic(1e4, 0.3)},
    )
    for element in ("Q4", "Q4I", "Q8", "Q9", "T3", "T6"):
        result = concio.solve(replace(model, element=element))
        points, stress = result.stress.at_points(1)
        np.testing.assert_allclose(stress, [[0, -q, 0]] * len(points), atol=1e-8)
        np.testing.assert_allclose(result.stress.at_nodes(1), [[0, -q, 0]] * len(result.nodes("b")), atol=1e-7)
        s1, s2, angle = (v[1] for v in result.stress.principal)
        assert (s1, s2) == pytest.approx((0.0, -q), abs=1e-8)
        assert abs(np.sin(angle)) < 1e-6  # s1 lies along x
        across = result.node_displacement("b")[:, 0]
        assert np.ptp(across) == pytest.approx(0.3 * q / 1e4, rel=1e-8)  # Poisson, free to slide


def test_a_gap_that_was_there_is_no_motion():
    """A stone 5 cm from a wall that nothing moves: its joints open and slide by no more than it settles."""
    wall = box("wall", 1.05, 2, 0, 1, kind="fixed")
    stone = box("stone", 0, 1, 0, 1, mesh_size=0.5)
    result = concio.solve(on_ground(stone, wall, loads=(weight(),), gap_reach=0.1))
    assert result.contacts.gap.max() == pytest.approx(0.05, rel=0.01)
    assert result.joint_motion.motion < 0.01
