"""Homogenised moduli: closed forms, invariance, an independent periodic computation, and where they hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from cells import moved, other_origin, periodic_elements, stress_matrix
from concio.analysis.cells.periodic_cell import PeriodicCell
from concio.contact.macroscopic_strain import STRAINS
from concio.errors import InputError
from samples import first


def running(a, b, kn, ks, kn_head, ks_head, **options):
    """A cell of rigid blocks b x a with compliant joints."""
    bed = concio.JointLaw(0.6, normal_stiffness=kn, tangential_stiffness=ks)
    head = concio.JointLaw(0.6, normal_stiffness=kn_head, tangential_stiffness=ks_head)
    return concio.cell(block="rigid", block_size=(b, a), friction=bed, head=head, **options)


def closed_form(a, b, kn, ks, kn_head, ks_head):
    """Moduli of running bond of rigid blocks with half a block of lap: joints as interfaces."""
    P, Q = b * ks_head + kn * b**2 / (4 * a), a * ks
    return np.diag([b * kn_head + ks * b**2 / (4 * a), a * kn, P * Q / (P + Q)])


def test_rigid_blocks_have_the_closed_form_in_200_random_directions():
    rng = np.random.default_rng(5)
    for _ in range(4):
        a, b = rng.uniform(0.05, 0.3), rng.uniform(0.1, 0.6)
        k = 10 ** rng.uniform(2, 7, 4)
        found = concio.homogenise(running(a, b, *k, thickness=rng.uniform(0.1, 2.0)))
        exact = closed_form(a, b, *k)
        for strain in rng.normal(size=(50, 3)):
            assert found.stress(strain) == pytest.approx(exact @ strain, rel=1e-10, abs=1e-10 * np.abs(exact).max())
    assert closed_form(0.06, 0.25, 3000, 1200, 2000, 700).diagonal() == pytest.approx([812.5, 180, 66.958425])


def test_blocks_turn_as_the_closed_form_says():
    a, b, kn, ks, ks_head = 0.06, 0.25, 3000.0, 1200.0, 700.0
    found = concio.homogenise(running(a, b, kn, ks, 2000.0, ks_head))
    P, Q = b * ks_head + kn * b**2 / (4 * a), a * ks
    own = PeriodicCell.of(found.cell)
    u = own.assembly.displacement(found.displacement[:, 2], {})
    turns = u[2::3] / own.assembly.disc.reach
    assert turns == pytest.approx(np.full(2, 0.5 * (P - Q) / (P + Q)))  # engineering shear 1: E_xy = 1/2


@pytest.mark.parametrize("repeat", first(1, [(3, 2), (2, 1), (1, 2)], single=True))
@pytest.mark.parametrize("bond", ["running", "flemish"])
def test_larger_cells_have_the_same_moduli(bond, repeat):
    block = concio.Elastic(E=4e6, nu=0.25)
    mortar = concio.Elastic(E=5e5, nu=0.1)
    options = {"bond": bond, "block_size": (0.23, 0.07), "joint": 0.012, "block": block, "mortar": mortar}
    one, many = (concio.homogenise(concio.cell(**options, repeat=r)).matrix for r in ((1, 1), repeat))
    assert many == pytest.approx(one, rel=1e-10, abs=1e-10 * one.max())
    rigid = {"kn": 3e5, "ks": 1e5, "kn_head": 2e5, "ks_head": 4e4}
    if bond == "running":
        a, b = (concio.homogenise(running(0.06, 0.25, **rigid, repeat=r)).matrix for r in ((1, 1), repeat))
        assert a == pytest.approx(b, rel=1e-10, abs=1e-10 * a.max())


LAW = concio.JointLaw(0.5, normal_stiffness=1e5, tangential_stiffness=4e4)
TILE = concio.Body("b", [[0, 0], [0.3, 0], [0.36, 0.1], [0.06, 0.1]], kind="rigid")
CELLS = {
    "leaning": concio.Model((TILE,), {"block": concio.Rigid()}, {"joint": LAW}, periods=((0.3, 0.0), (0.16, 0.1))),
    "rubble": concio.cell(bond="rubble", length=0.9, height=0.7, stone=0.3, seed=2, block="rigid", friction=LAW),
}


@pytest.mark.parametrize("name", CELLS)
def test_turning_mirroring_and_moving_the_cell_change_nothing(name):
    cell = CELLS[name]
    A = concio.homogenise(cell).matrix
    assert abs(A[0, 2]) > 1e-4 * A[2, 2], "a cell without symmetry, else turning the wrong way would go unseen"
    angle = 0.4
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    mirror = np.diag([-1.0, 1.0])
    for Q, shift in ((turn, (3.0, -1.0)), (mirror, (0.0, 0.0)), (turn @ mirror, (0.1, 7.0))):
        T = stress_matrix(Q)
        found = concio.homogenise(moved(cell, Q, shift)).matrix
        assert found == pytest.approx(T @ A @ T.T, rel=1e-9, abs=1e-9 * A.max())
    assert concio.homogenise(other_origin(cell, 3)).matrix == pytest.approx(A, rel=1e-10, abs=1e-10 * A.max())
    skew = replace(cell, periods=(cell.periods[0], tuple(np.add(cell.periods[0], cell.periods[1]))))
    assert concio.homogenise(skew).matrix == pytest.approx(A, rel=1e-10, abs=1e-10 * A.max())


def test_moduli_in_turned_axes_are_those_of_the_turned_cell():
    cell = CELLS["leaning"]
    found = concio.homogenise(cell)
    angle = 0.7
    back = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    turned = concio.homogenise(moved(cell, back))
    assert found.rotated(angle) == pytest.approx(turned.matrix, rel=1e-9, abs=1e-9 * found.matrix.max())
    assert found.uniaxial(0, angle)[:2] == pytest.approx((turned.E_x, turned.nu_xy), rel=1e-9)


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("ratio", [1.0, 5.0, 1000.0])
def test_bonded_brickwork_equals_an_independent_periodic_computation(ratio, plane):
    """Brick and mortar with stiff joints: one mesh by scikit-fem, periodic by elimination, no contact at all."""
    length, tall, joint, E = 0.21, 0.052, 0.01, 1.1e7
    brick, mortar = concio.Elastic(E=E, nu=0.2), concio.Elastic(E=E / ratio, nu=0.2)
    cell = concio.cell(block_size=(length, tall), joint=joint, block=brick, mortar=mortar, mesh_size=0.02, plane=plane)
    found = concio.homogenise(cell)

    def young(p):
        course, y = p[1] // (tall + joint), p[1] % (tall + joint)
        x = (p[0] + joint / 2 - (length + joint) / 2 * course) % (length + joint)
        return np.where((y < tall) & (x > joint), E, E / ratio)

    pitch = length + joint
    marks = np.unique(np.round(np.concatenate([b.grid[0] % pitch for b in cell.bodies]), 9))
    xs = np.concatenate([marks, [pitch + marks[0]]])
    ys = np.unique(np.round(np.concatenate([b.grid[1] for b in cell.bodies]), 9))
    other = periodic_elements(xs, ys, young, 0.2, plane)
    assert found.matrix == pytest.approx(other, rel=1e-9, abs=1e-9 * other.max())
    if ratio == 1.0 and plane == "stress":
        assert (found.E_x, found.E_y, found.nu_xy) == pytest.approx((E, E, 0.2))
        assert pytest.approx(E / 2.4) == found.G_xy


def test_one_block_with_joints_in_series():
    """Stack bond of elastic blocks on compliant joints, nu = 0: compliances along x and y simply add."""
    E, kn, ks, b, a = 4e6, 6e7, 2e7, 0.3, 0.1
    law = concio.JointLaw(0.6, normal_stiffness=kn, tangential_stiffness=ks)
    found = concio.homogenise(concio.cell(bond="stack", block_size=(b, a), block=concio.Elastic(E, 0.0), friction=law))
    assert pytest.approx(1 / (1 / E + 1 / (kn * b)), rel=1e-10) == found.E_x
    assert pytest.approx(1 / (1 / E + 1 / (kn * a)), rel=1e-10) == found.E_y
    assert found.nu_xy == pytest.approx(0.0, abs=1e-12)


def test_joints_that_are_missing_leave_no_stiffness():
    """Columns side by side that do not touch: nothing along x, and moduli all the same."""
    block = concio.Body("b", [[0, 0], [0.28, 0], [0.28, 0.1], [0, 0.1]])
    cell = concio.Model((block,), {"block": concio.Elastic(E=1e6, nu=0.3)}, {"joint": concio.JointLaw(0.6)},
                        periods=((0.3, 0.0), (0.0, 0.1)))  # fmt: skip
    found = concio.homogenise(cell)
    assert found.E_x == pytest.approx(0.0, abs=1e-6)
    assert pytest.approx(1e6 * 0.28 / 0.3, rel=1e-9) == found.E_y
    assert found.holds is None


def test_the_moduli_hold_as_long_as_no_joint_would_open_or_slip():
    bed = {"normal_stiffness": 3e5, "tangential_stiffness": 1e5}
    cell = concio.cell(block="rigid", block_size=(0.25, 0.06), friction=concio.JointLaw(
        0.6, cohesion=20.0, tensile_strength=5.0, compressive_strength=900.0, **bed))  # fmt: skip
    found = concio.homogenise(cell)
    faces = found.holds.reduced()
    assert 0 < len(faces) <= len(found.holds)
    law = found.cell.problem().laws
    rng = np.random.default_rng(1)
    inside = 0
    for stress in rng.normal(size=(200, 3)) * [60.0, 300.0, 20.0] - [0, 300, 0]:
        strain = np.linalg.solve(found.matrix, stress)
        t_n, t_t = found.normal_force @ strain, found.friction_force @ strain
        keeps = bool((t_n >= -law.tension).all() and (np.abs(t_t) <= law.cohesion + law.friction * t_n).all()
                     and (t_n <= law.cap).all())  # fmt: skip
        assert keeps == (faces.margin(stress) >= 0) == (found.holds.margin(stress) >= 0)
        inside += keeps
    assert 10 < inside < 190


def test_slipping_joints_have_moduli_that_need_not_be_symmetric():
    law = concio.JointLaw(0.6, normal_stiffness=3e5, tangential_stiffness=1e5)
    cell = concio.cell(block="rigid", block_size=(0.25, 0.06), friction=law)
    normal = PeriodicCell.of(cell).assembly.pairs.normal
    sliding = np.where(np.abs(normal[:, 1]) > 0.5, 1, 0)
    found = concio.homogenise(cell, sliding=sliding)
    assert not found.closed
    assert "slip" in found.states
    assert found.matrix[2, 1] == pytest.approx(0.6 * found.matrix[1, 1])  # friction against the slip, by the pressure
    assert abs(found.matrix[1, 2]) < 1e-9
    assert found.certificate.certified


def test_what_has_no_moduli_is_refused():
    with pytest.raises(InputError, match="rigid blocks on hard joints"):
        concio.homogenise(concio.cell(block="rigid"))
    with pytest.raises(InputError, match="no periods"):
        concio.homogenise(concio.running_bond_panel())
    with pytest.raises(InputError, match="contact must hold"):
        concio.homogenise(concio.cell(), contact=np.zeros(3))


def test_the_certificate_is_of_the_original_equations():
    found = concio.homogenise(concio.cell(joint=0.01, mortar=concio.Elastic(E=1e6, nu=0.2)))
    c = found.certificate
    assert c.certified
    assert 0 < c.worst < 1e-10
    from concio.analysis.cells.moduli import _certify

    cell, problem = found.cell, found.cell.problem(free=(False,) * 3)
    arrays = [found.matrix, found.displacement, found.normal_force, found.friction_force, found.contact, found.sliding]
    for k, row, entries in (
        (0, 0, {"mean_stress", "symmetry"}), (0, 1, {"mean_stress", "energy"}), (1, 5, {"equilibrium", "states"}),
        (2, 5, {"equilibrium"}), (3, 5, {"equilibrium"}),
    ):  # fmt: skip
        wrong = [a.copy() for a in arrays]
        wrong[k][row, 1] += 1e-4 * np.abs(wrong[k]).max()
        bad = vars(_certify(cell, problem, *wrong))
        assert entries <= {name for name, value in bad.items() if value > 1e-8}


def test_a_single_force_across_an_edge_turns_the_cell():
    own = PeriodicCell.of(concio.cell(bond="stack", block_size=(0.3, 0.1), thickness=0.5))
    normal, friction = np.zeros((2, len(own.assembly.pairs)))
    friction[0] = 2.0  # vertical, on the image at (0.3, 0)
    assert own.turning(normal, friction) == pytest.approx(-2.0 * 0.3 / (2 * 0.3 * 0.1 * 0.5))
    assert own.stress(normal, friction) == pytest.approx([0.0, 0.0, -2.0 * 0.3 / 2 / (0.3 * 0.1 * 0.5)])


def test_solving_under_a_strain_as_a_load_step():
    """The same seam: a macroscopic strain is a load group of an ordinary load step."""
    cell = concio.cell(block=concio.Elastic(E=4e6, nu=0.2), friction=0.7)
    strain = np.array([-1e-4, -2e-4, 0.5e-4])
    result = concio.solve(cell, factors=dict(zip(STRAINS, strain.tolist(), strict=True)))
    own = PeriodicCell.of(cell)
    contacts = result.contacts
    stress = own.stress(contacts.normal_force, np.ravel(contacts.friction_force))
    assert stress == pytest.approx(concio.homogenise(cell).stress(strain), rel=1e-8)
    assert result.reactions["origin"] == pytest.approx((0.0, 0.0), abs=1e-9)
