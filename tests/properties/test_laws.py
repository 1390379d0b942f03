"""Every joint law against one- and two-block examples solved by hand, for any numbers that fit the case."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.contact.assembly import assemble
from concio.model.generate.panel import running_bond_panel
from concio.model.materials import JointLaw, Rigid
from concio.model.model import JointRule, Load, Tie
from concio.problem.certificate import certify
from concio.solvers.statics.mechanism import proves, verify_mechanism
from models import box, model_of, on_ground, weight
from samples import sample

few = settings(max_examples=sample(5, 12), deadline=None)
STONE = {"kind": "rigid", "material": "stone", "thickness": 0.5}
ELASTIC = {"kind": "elastic", "material": "block", "thickness": 0.5, "mesh_size": 0.5}
W = 20.0 * 2 * 0.6 * 0.5
"""Weight of the block 2 x 0.6 x 0.5 m [kN]; it stands on 1 m2."""


def block(kind, *loads, law, **options):
    return on_ground(box("b", -1, 1, 0, 0.6, **kind), loads=(weight(), *loads), law=law, **options)


def at_base(x, y=0.0):
    """A force on the middle of the block's base: no moment."""
    return Load("point", (x, y), bodies=("b",), at=(0.0, 0.0), group="live")


def fails(model):
    """True where a mechanism, checked once more, proves that there is no equilibrium."""
    result = concio.solve(model, on_failure="return")
    if result.solved:
        return False
    assert result.status is concio.Status.NO_EQUILIBRIUM
    problem = result.assembly.problem(result.factors)
    again = verify_mechanism(problem, result.mechanism.velocity)
    assert proves(problem, again)
    return True


kinds = pytest.mark.parametrize("kind", [STONE, ELASTIC], ids=["rigid", "elastic"])
coefficients = st.floats(0.1, 1.5)


@kinds
@few
@given(mu=coefficients, share=st.floats(0.05, 0.98), sign=st.sampled_from([-1, 1]))
def test_coulomb_sticks_until_the_push_is_mu_times_the_weight(kind, mu, share, sign):
    push = sign * share * mu * W
    result = concio.solve(block(kind, at_base(push), law=mu))
    assert result.contacts.count("open") == 0
    assert result.joints.N.sum() == pytest.approx(W, rel=1e-9)
    assert result.joints.V.sum() == pytest.approx(push, rel=1e-9)  # t = (-1, 0), friction opposes the push
    if kind is STONE:
        assert np.abs(result.node_displacement("b")).max() < 1e-12
    assert fails(block(kind, at_base(sign * 1.001 * mu * W), law=mu))


@kinds
@few
@given(mu=st.just(0.0) | st.floats(0.01, 1.5), cohesion=st.floats(1.0, 50.0), sign=st.sampled_from([-1, 1]))
def test_cohesion_adds_to_the_sliding_strength(kind, mu, cohesion, sign):
    strength = mu * W + cohesion * 1.0  # on 1 m2
    law = JointLaw(mu, cohesion=cohesion)
    held = concio.solve(block(kind, at_base(sign * 0.99 * strength), law=law))
    assert held.joints.V.sum() == pytest.approx(sign * 0.99 * strength, rel=1e-9)
    assert fails(block(kind, at_base(sign * 1.001 * strength), law=law))


@kinds
@few
@given(mu=st.just(0.0) | st.floats(0.01, 1.2), tension=st.floats(1.0, 60.0))
def test_tensile_strength_holds_a_pull(kind, mu, tension):
    law = JointLaw(mu, cohesion=1.2 * tension * max(mu, 0.1), tensile_strength=tension)
    held = concio.solve(block(kind, at_base(0.0, W + 0.99 * tension), law=law))
    assert held.joints.N.sum() == pytest.approx(-0.99 * tension, rel=1e-9)
    assert fails(block(kind, at_base(0.0, W + 1.001 * tension), law=law))
    assert fails(
        block(kind, at_base(0.0, 1.001 * W), law=JointLaw(mu, cohesion=tension))
    )  # cohesion alone pulls nothing


@few
@given(mu=st.floats(0.1, 1.0), part=st.floats(0.0, 1.0), more=st.floats(1.1, 3.0))
def test_dilatancy_lifts_what_slides(mu, part, more):
    """Pushed beyond friction against a rod: slip (H - mu W)/k, and tan(psi) times that upwards."""
    rod = Tie("rod", "", (-4.0, 0.0), "b", (0.0, 0.0), stiffness=500.0)
    push = more * mu * W
    law = JointLaw(mu, dilatancy=part * mu)
    result = concio.solve(block(STONE, at_base(push), law=law, ties=(rod,)))
    slip = (push - mu * W) / 500.0
    u = result.node_displacement("b")
    np.testing.assert_allclose(u, np.tile([slip, part * mu * slip], (4, 1)), rtol=1e-8, atol=1e-12)
    assert result.contacts.count("slip") == 2


@few
@given(kn=st.floats(1e4, 1e7), ratio=st.floats(0.2, 1.0), share=st.floats(-0.9, 0.9))
def test_compliant_joint_is_a_bed_of_springs(kn, ratio, share):
    """Vertical W/(kn A), sliding T/(ks A), rotation M/(kn I) with I = b3 t/12, all pairs closed."""
    law = JointLaw(5.0, normal_stiffness=kn, tangential_stiffness=ratio * kn)
    push = share * W  # at mid height: moment about the base 0.3 push, closed up to W b/6
    middle = Load("point", (push, 0.0), bodies=("b",), at=(0.0, 0.3), group="live")
    result = concio.solve(block(STONE, middle, law=law))
    turn = -0.3 * push / (kn * 0.5 * 2**3 / 12)
    x, y = result.nodes("b").T
    expected = np.column_stack([push / (ratio * kn) - turn * y, -W / kn + turn * x])
    np.testing.assert_allclose(result.node_displacement("b"), expected, rtol=1e-8, atol=1e-9 * W / kn)


@few
@given(cap=st.floats(5.0, 100.0), more=st.floats(1.1, 3.0), kn=st.sampled_from([None, 1e5]))
def test_compressive_cap_yields_and_the_rod_takes_the_rest(cap, more, kn):
    law = JointLaw(0.5, compressive_strength=cap, normal_stiffness=kn)
    hanger = Tie("rod", "", (0.0, 5.0), "b", (0.0, 0.6), stiffness=1e3)
    load = at_base(0.0, W - more * cap)  # total more * cap on 1 m2
    result = concio.solve(block(STONE, load, law=law, ties=(hanger,)))
    sink = (more - 1) * cap / 1e3
    if kn is not None and sink < cap / kn:
        return  # not yet crushed
    u = result.node_displacement("b")[:, 1]  # all pairs at their cap: a small rotation would cost nothing
    assert u.mean() == pytest.approx(-sink, rel=1e-8)
    assert result.joints.N.sum() == pytest.approx(cap, rel=1e-9)
    np.testing.assert_allclose(result.contacts.pressure[:-1], cap, rtol=1e-9)
    crushed = result.solution.kinematics.crushing[:-1]
    assert crushed.mean() == pytest.approx(sink - (0.0 if kn is None else cap / kn), rel=1e-6)
    assert fails(block(STONE, load, law=law))


@kinds
@few
@given(mu=st.just(0.0) | st.floats(0.01, 0.8), gap=st.floats(1e-4, 1e-2), more=st.floats(1.1, 3.0))
def test_a_side_gap_closes_and_the_wall_takes_the_rest(kind, mu, gap, more):
    push = more * max(mu, 0.1) * W
    model = model_of(
        box("ground", -5, 5, -1, 0, kind="fixed"), box("b", -1, 1, 0, 0.6, **kind),
        box("wall", 1 + gap, 2, 0, 0.6, kind="fixed"), law=mu, gap_reach=0.02, loads=(weight(), at_base(push)),
        materials={"block": concio.Elastic(E=1e7, nu=0.0, unit_weight=20.0)},
    )  # fmt: skip
    smooth = {**model.laws, "smooth": JointLaw(0.0)}
    model = replace(model, laws=smooth, rules=(*model.rules, JointRule("smooth", ("wall", "*"))))
    result = concio.solve(model)
    thrust = push - mu * W
    assert result.reactions["wall"][0] == pytest.approx(-thrust, rel=1e-6)
    right = np.isclose(result.nodes("b")[:, 0], 1.0)
    np.testing.assert_allclose(result.node_displacement("b")[right, 0].max(), gap, rtol=1e-6)


def walls_of_each_law():
    """One wall for each law."""
    laws = {
        "coulomb": JointLaw(0.6),
        "cohesion": JointLaw(0.6, cohesion=2.0),
        "tension": JointLaw(0.6, cohesion=2.0, tensile_strength=2.0),
        "dilatancy": JointLaw(0.6, dilatancy=0.2),
        "compliance": JointLaw(0.6, normal_stiffness=1e6, tangential_stiffness=5e5),
        "cap": JointLaw(0.6, compressive_strength=25.0, normal_stiffness=1e6),
    }
    walls = []
    for name, law in laws.items():
        model = running_bond_panel(
            courses=2,
            blocks=2,
            friction=law,
            unit_weight=20.0,
            horizontal=0.3,
            top_pressure=10.0,
            elements_per_block=(2, 1),
        )
        walls.append(pytest.param(model, id=name))
    return walls


@pytest.mark.parametrize("model", walls_of_each_law())
def test_certificate_catches_wrong_answers_of_each_law(model):
    result = concio.solve(model)
    problem, s = result.assembly.problem(), result.solution
    answer = (s.displacement, s.normal_force, s.friction_force[:, 0])
    assert certify(problem, *answer).worst <= 1e-10
    rng = np.random.default_rng(1)
    sizes = [np.abs(a).max() for a in answer]
    for size in (1e-3, 1e-6):
        for _ in range(5):
            for part in range(3):  # displacements, normal forces, friction forces, each alone
                wrong = [a.copy() for a in answer]
                k = rng.integers(len(wrong[part]))
                wrong[part][k] += size * sizes[part] * rng.choice([-1, 1])
                assert not certify(problem, *wrong).certified
    # consistent forces, wrong law: the same answer under another friction, cap or stiffness is refused
    laws = problem.laws
    closed = np.abs(s.normal_force).max()
    other = {
        "friction": 0.5 * laws.friction,
        "tension": laws.tension - 1.5 * closed,
        "cap": np.full(len(s.gap), 0.5 * closed),
        "normal_compliance": laws.normal_compliance + 0.1 * sizes[0] / closed,
    }  # fmt: skip
    refused = 0
    for name, value in other.items():
        changed = replace(problem, laws=replace(laws, **{name: value}))
        refused += not certify(changed, *answer).certified
    assert refused == 4


@pytest.mark.parametrize("model", walls_of_each_law())
def test_friction_does_no_positive_work(model):
    result = concio.solve(model)
    c = result.contacts
    work = c.friction_force * c.slip
    scale = np.abs(c.friction_force).max() * np.abs(c.slip).max()
    assert work.max() <= 1e-9 * scale
    law = result.assembly.laws
    if not law.tangential_compliance.any():
        assert work.min() < -1e-3 * scale  # something did slip: the test says something


def test_one_law_of_each_kind_in_one_wall():
    """Different laws in base, side walls and between blocks, each holding where it should."""
    model = running_bond_panel(
        courses=2, blocks=2, friction=0.6, wall_friction=0.0, base_friction=0.3, unit_weight=20.0, top_pressure=10.0
    )
    result = concio.solve(model)
    c = result.contacts
    assert assemble(model).laws.friction.tolist() == result.assembly.laws.friction.tolist()
    assert (np.abs(c.friction_force[:, 0]) <= result.assembly.laws.friction * c.normal_force + 1e-12).all()
    assert isinstance(model.materials["block"], concio.Elastic)
    assert not isinstance(model.materials["block"], Rigid)
