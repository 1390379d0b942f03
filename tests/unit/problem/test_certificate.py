"""Each entry of the certificate, by hand, on one body with two springs and one pair."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
import scipy.sparse as sp

import concio
from concio.errors import InputError
from concio.model.materials import Elastic, JointLaw
from concio.model.model import Body, Load, Model, Support
from concio.problem.certificate import CERTIFIED, Certificate, certify, kinematics
from concio.problem.contact_problem import ContactProblem, Laws
from concio.problem.solution import Status, failed, judge
from concio.solvers.path.path_state import LinearPath


def one_pair(f=(3.0, -10.0), gap=0.0, origin=0.0, **laws):
    """A point on springs of 100 and 200 kN/m above a floor: u = (x, y), n = (0, 1), t = (-1, 0)."""
    table = {"friction": 0.5, "cohesion": 0.0, "tension": 0.0, "dilatancy": 0.0, "normal_compliance": 0.0,
             "tangential_compliance": 0.0, "cap": np.inf, **laws}  # fmt: skip
    return ContactProblem(
        K=sp.csr_array(np.diag([100.0, 200.0])),
        f=np.array(f, dtype=float),
        C_n=sp.csr_array([[0.0, 1.0]]),
        C_t=sp.csr_array([[-1.0, 0.0]]),
        gap=np.array([gap]),
        laws=Laws(**{k: np.array([v]) for k, v in table.items()}),
        R=sp.csc_array((2, 0)),
        bodies=np.array([0, 2]),
        slip_origin=np.array([[origin]]),
    )


def entries(problem, u, t_n, t_t):
    return certify(problem, np.array(u), np.array([t_n]), np.array([t_t]))


def test_complementarity_counts_from_the_tensile_strength():
    """An open pair that still pulls with 0.5 of its strength of 2 carries p = 1.5 where it should carry none."""
    problem = one_pair(f=(0.0, 100.5), tension=2.0, cohesion=1.0)
    c = entries(problem, (0.0, 0.5), -0.5, 0.0)
    assert c.equilibrium == 0.0
    assert c.complementarity == pytest.approx(1.5 / 100.5, rel=1e-12)
    assert entries(one_pair(f=(0.0, 102.0), tension=2.0, cohesion=1.0), (0.0, 0.5), -2.0, 0.0).complementarity == 0.0


def test_stick():
    """t_t acts along (-1, 0): t_t = 3 holds the push of 3; |3| <= 0.5 x 10."""
    c = entries(one_pair(), (0.0, 0.0), 10.0, 3.0)
    assert c.worst == 0.0
    assert c.certified


def test_slip():
    """Push 8, friction 5: u_x = 3/100, slip y_t = -0.03, t_t = +5 opposes it."""
    c = entries(one_pair((8.0, -10.0)), (0.03, 0.0), 10.0, 5.0)
    assert c.worst < 1e-16
    wrong_sign = entries(one_pair((-2.0, -10.0)), (0.03, 0.0), 10.0, -5.0)  # in equilibrium, but friction drives
    assert wrong_sign.equilibrium < 1e-16
    assert wrong_sign.slip_direction == pytest.approx(10.0 / 12.0)


def test_each_entry_by_hand():
    problem = one_pair()  # F = 13
    assert entries(problem, (0.0, 0.0), 9.0, 3.0).equilibrium == pytest.approx(1 / 13)
    assert entries(problem, (0.0, 0.0), 10.0, 5.5).cone == pytest.approx(0.5 / 13)
    assert entries(problem, (0.0, 0.0), -1.0, 0.0).cone == pytest.approx(1 / 13)
    sunk = entries(problem, (0.01, -0.002), 10.0, 0.0)  # U = 0.01
    assert sunk.penetration == pytest.approx(0.2)
    lifted = entries(problem, (0.01, 0.002), 10.0, 0.0)
    assert lifted.complementarity == pytest.approx(min(0.2, 10 / 13))
    creeping = entries(problem, (0.01, 0.0), 10.0, 0.0)  # slips without friction
    assert creeping.slip_direction == pytest.approx(5 / 13)


def test_cap_and_crushing():
    problem = one_pair((0.0, -10.0), cap=6.0)  # the springs take 4: u_y = -0.02, crushed by as much
    c = entries(problem, (0.0, -0.02), 6.0, 0.0)
    assert c.worst < 1e-15
    kin = kinematics(problem, np.array([0, -0.02]), np.array([6.0]), np.zeros((1, 1)))
    assert kin.crushing == pytest.approx([0.02])
    assert entries(problem, (0.0, 0.0), 10.0, 0.0).cone == pytest.approx(0.4)
    assert entries(problem, (0.0, -0.03), 4.0, 0.0).complementarity == pytest.approx(2 / 10)  # crushed below the cap


def test_tension_cohesion_dilatancy_compliance_and_origin():
    pulled = one_pair((0.0, 3.0), tension=4.0, cohesion=2.0)
    assert entries(pulled, (0.0, 0.0), -3.0, 0.0).worst == 0.0
    assert entries(pulled, (0.0, -0.005), -4.0, 0.0).penetration == pytest.approx(1.0, rel=1e-14)
    slid = one_pair((0.0, 0.0), cohesion=2.0, friction=0.0)
    assert entries(slid.with_loads(np.array([2.0, -1.0])), (0.0, 0.0), 1.0, 2.0).worst == 0.0
    rising = one_pair((8.0, -10.0 + 200 * 0.2 * 0.03), dilatancy=0.2)
    assert entries(rising, (0.03, 0.006), 10.0, 5.0).worst < 1e-15
    soft = one_pair((0.0, -10.0 - 200 * 0.02), normal_compliance=0.002)
    assert entries(soft, (0.0, -0.02), 10.0, 0.0).worst < 1e-15
    bent = one_pair((3.0 + 100 * 0.006, -10.0), tangential_compliance=0.002)
    assert entries(bent, (0.006, 0.0), 10.0, 3.0).worst < 1e-15
    history = one_pair((3.0 + 100 * 0.05, -10.0), origin=-0.05)  # slipped to u_x = 0.05 before
    assert entries(history, (0.05, 0.0), 10.0, 3.0).worst < 1e-15


def test_gap_open_and_closed():
    assert entries(one_pair((0.0, -10.0), gap=0.1), (0.0, -0.05), 0.0, 0.0).worst < 1e-15
    assert entries(one_pair((0.0, -10.0), gap=0.02), (0.0, -0.02), 6.0, 0.0).worst < 1e-15
    assert entries(one_pair((0.0, -10.0), gap=0.1), (0.0, -0.04), 2.0, 0.0).complementarity > 0.1


def test_not_a_number_is_never_certified():
    c = entries(one_pair(), (np.nan, 0.0), 10.0, 3.0)
    assert c.worst == np.inf
    assert not c.certified
    assert Certificate(np.nan, 0, 0, 0, 0).worst == np.inf
    assert not Certificate(0, 0, 0, 0, 1.01 * CERTIFIED).certified
    assert Certificate(0, 0, 0, 0, CERTIFIED).certified


def test_judge_calls_solved_only_what_is_certified():
    problem = one_pair()
    good = judge(problem, np.zeros(2), np.array([10.0]), np.array([3.0]), method="by hand")
    assert good.status is Status.SOLVED
    bad = judge(problem, np.zeros(2), np.array([10.0]), np.array([3.1]), method="by hand")
    assert bad.status is Status.GAVE_UP
    assert not bad.solved
    lost = failed(problem, Status.UNDECIDED, method="by hand")
    assert lost.status is Status.UNDECIDED
    assert [s.exit_code for s in (Status.SOLVED, Status.NO_EQUILIBRIUM, Status.UNDECIDED)] == [0, 3, 4]


def test_problems_that_make_no_sense():
    with pytest.raises(InputError, match="friction x tension"):
        one_pair(tension=5.0)
    with pytest.raises(InputError, match="f holds a value that is not finite"):
        one_pair((np.nan, 0.0))
    with pytest.raises(InputError, match="gap holds"):
        one_pair(gap=np.inf)
    with pytest.raises(InputError, match=r"friction of the joint laws has shape \(2,\), expected \(1,\)"):
        replace(one_pair(), laws=Laws.coulomb(0.5, 2))
    small = replace(one_pair().laws, tension=np.full(1, 3e-13), cohesion=np.zeros(1))  # none is too small
    with pytest.raises(InputError, match="friction x tension"):
        replace(one_pair(), laws=small)
    with pytest.raises(InputError, match="f has shape"):
        one_pair((1.0, 2.0, 3.0))


def floating_bar(stiffness=1.0, motion=(1.0, 1.0)):
    """Two nodes on a line, joined by a spring and floating; the first is pressed on a wall at its left."""
    k = stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]])
    R = np.array(motion)[:, None] / np.linalg.norm(motion)
    return ContactProblem(
        K=sp.csr_array(k),
        f=np.array([0.0, -1.0]),
        C_n=sp.csr_array([[1.0, 0.0]]),
        C_t=sp.csr_array([[0.0, 0.0]]),
        gap=np.zeros(1),
        laws=Laws(*(np.array([v]) for v in (0.5, 0.0, 0.0, 0.0, 0.0, 0.0, np.inf))),
        R=sp.csc_array(R),
        bodies=np.array([0, 2]),
    )


@pytest.mark.parametrize(("stiffness", "far"), [(1.0, 1e3), (1e3, 1e5)])
def test_rounding_excuses_no_resultant(stiffness, far):
    """A force on a floating body that nothing balances is an error, however far the body has gone."""
    problem = floating_bar(stiffness)
    assert entries(problem, (0.0, -1.0 / stiffness), 1.0, 0.0).worst <= 1e-16
    gone = entries(problem, (far, far - 1.0 / stiffness), 0.999, 0.0)
    assert gone.equilibrium >= 1e-3 * (1 - 1e-9)


def test_rounding_excuses_what_rounding_does_and_no_more():
    """A spring of 1e8 kN/m, its ends known to an eps of 1 m: some 1e-8 kN of its force are anybody's guess."""
    load = {"gap": np.array([-0.7]), "f": np.array([0.0, -0.3])}
    stiff, soft, stiffest = (replace(floating_bar(k), **load) for k in (1e8, 1.0, 1e12))
    u = np.array([0.7, 0.7 - 0.3e-8])
    assert 3e-10 < np.abs(stiff.K @ u - [0.3, -0.3]).max() < 3e-8
    assert entries(stiff, u, 0.3, 0.0).worst <= CERTIFIED
    assert entries(stiff, (0.7, 0.7 - 0.299e-8), 0.3, 0.0).equilibrium == pytest.approx(1e-3 / 0.3, rel=1e-2)
    assert entries(soft, u, 0.3, 0.0).equilibrium == pytest.approx(1.0)
    assert not entries(stiffest, (0.7, 0.7 - 0.3e-12), 0.3, 0.0).certified  # 1e-4 kN may hide: too much


def test_imposed_displacements_are_no_loads():
    """The springs that push a stiff body where it must go are not a measure of the forces that hold it."""
    block = Body("block", np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.0, 0.5)]), "stone")
    top = Body("top", np.array([(0.0, 0.5), (1.0, 0.5), (1.0, 1.0), (0.0, 1.0)]), "stone")
    model = Model(
        (block, top), {"stone": Elastic(E=1e7, nu=0.2, unit_weight=20.0)}, {"joint": JointLaw(0.6)},
        loads=(Load("weight", (0.0, -1.0)),),
        supports=(Support("sunk", "block", edge=((0.0, 0.0), (1.0, 0.0)), displacement=(0.0, -0.01)),),
    )  # fmt: skip
    result = concio.solve(model)
    problem, s = result.assembly.problem(), result.solution
    assert np.abs(problem.f).sum() > 1e3 * problem.total_load
    assert problem.total_load == pytest.approx(20.0, rel=0.2)  # without the share of the nodes that are supported
    assert result.joints.N[0] == pytest.approx(10.0, rel=1e-7)
    assert certify(problem, s.displacement, 0.999 * s.normal_force, s.friction_force).equilibrium > 1e-5


def test_motions_that_deform_a_body_are_refused():
    with pytest.raises(InputError, match="K R is not zero"):
        floating_bar(1.0, motion=(1.0, 0.9))


def test_total_load_along_a_path():
    """Interpolated where the path knows it, for its forces may impose displacements; else the sum of |f|."""
    start = replace(one_pair((3.0, -10.0)), load=5.0)
    rate = np.array([1000.0, 0.0])
    assert LinearPath(start, rate, total_rate=2.0).at(0.5).total_load == 6.0
    assert LinearPath(start, rate).at(0.5).total_load == 513.0
    assert start.with_loads(2 * start.f).total_load == 26.0


def test_motions_not_of_length_one_are_refused():
    with pytest.raises(InputError, match="length one"):
        replace(floating_bar(), R=sp.csc_array(np.array([[1.0], [1.0]])))


@pytest.mark.parametrize("which", range(3))
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_one_entry_that_is_no_number_is_no_certificate(which, value):
    """Also where other entries of the same array are numbers."""
    law = {f.name: np.repeat(getattr(one_pair().laws, f.name), 2) for f in fields(Laws)}
    problem = replace(
        one_pair(), C_n=sp.csr_array([[0.0, 1.0], [0.0, 1.0]]), C_t=sp.csr_array([[-1.0, 0.0], [-1.0, 0.0]]),
        gap=np.zeros(2), laws=Laws(**law), slip_origin=np.zeros((2, 1)), area=np.ones(2),
    )  # fmt: skip
    parts = [np.zeros(2), np.zeros(2), np.zeros((2, 1))]
    assert np.isfinite(certify(problem, *parts).worst)
    parts[which].flat[1] = value
    assert certify(problem, *parts).worst == np.inf
