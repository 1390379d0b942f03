"""Patch tests through the whole program: uniform pressure passes joints of any kind unchanged, to rounding.

Blocks with nu = 0 or free to slide sideways (no friction), so that the exact state is uniform uniaxial stress.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio.model.materials import Elastic, JointLaw, Rigid
from concio.model.model import Load, Support
from models import box, model_of, turned
from samples import sample

few = settings(max_examples=sample(5, 10), deadline=None)
Q = 30.0


def table(nu=0.0):
    return {"soft": Elastic(1e4, nu), "hard": Elastic(3e5, nu), "stone": Rigid()}


def pressed(bodies, top, width, *, law=0.6, nu=0.0, **options):
    ground = box("ground", 0, width, -1, 0, kind="fixed", role="ground")
    load = Load("pressure", (Q,), edge=((0, top), (width, top)))
    return model_of(ground, *bodies, law=law, materials=table(nu), loads=(load,), **options)


def check_uniform(model, *, corners=False, direction=(0.0, 1.0)):
    """Solve and compare stresses, and pressures except where a corner of three pairs shares its force in many ways."""
    result = concio.solve(model)
    n = np.array(direction)
    exact = -Q * np.array([n[0] ** 2, n[1] ** 2, n[0] * n[1]])
    for b, body in enumerate(model.bodies):
        if body.kind == "elastic":
            _, stress = result.stress.at_points(b)
            np.testing.assert_allclose(stress, np.tile(exact, (len(stress), 1)), atol=1e-10 * Q)
    if not corners:
        loaded = np.abs(result.contacts.pairs.normal @ n) > 0.9
        np.testing.assert_allclose(result.contacts.pressure[loaded], Q, rtol=1e-9)
        np.testing.assert_allclose(result.contacts.shear[loaded], 0.0, atol=1e-9 * Q)
    assert result.certificate.worst <= 1e-10
    return result


@pytest.mark.parametrize("element", ["Q4", "Q4I", "Q8", "Q9", "T3", "T6"])
def test_non_matching_meshes_and_different_moduli(element):
    """Two blocks pressed on each other, 0.5 and 0.3 m elements, E in the ratio 30."""
    bodies = (
        box("a", 0, 1.2, 0, 1, material="soft", mesh_size=0.5),
        box("b", 0, 1.2, 1, 1.7, material="hard", mesh_size=0.29),
    )
    result = check_uniform(pressed(bodies, 1.7, 1.2, element=element))
    entries = np.diff(result.assembly.pairs.C_n.indptr)[result.assembly.pairs.body_a > 0]
    assert entries.max() > 2  # the meshes really do not match
    assert result.max_settlement == pytest.approx(Q * (1 / 1e4 + 0.7 / 3e5), rel=1e-10)


@pytest.mark.parametrize("element", ["Q4", "Q8", "T6"])
def test_poisson_strain_with_smooth_joints(element):
    bodies = (
        box("a", 0, 1.2, 0, 1, material="soft", mesh_size=0.5),
        box("b", 0, 1.2, 1, 1.7, material="hard", mesh_size=0.29),
    )
    model = pressed(bodies, 1.7, 1.2, law=0.0, nu=0.3, element=element)
    still = tuple(Support(f"s{b}", b, ((0, y), (0, y)), "x") for b, y in (("a", 0), ("b", 1)))
    result = check_uniform(concio.Model(**{**vars(model), "supports": still}))
    assert np.ptp(result.node_displacement("a")[:, 0]) == pytest.approx(0.3 * Q / 1e4 * 1.2)


def test_rigid_on_elastic_on_rigid():
    bodies = (
        box("a", 0, 1.2, 0, 0.5, kind="rigid", material="stone"),
        box("b", 0, 1.2, 0.5, 1, material="soft", mesh_size=0.29),
        box("c", 0, 1.2, 1, 1.2, kind="rigid", material="stone"),
    )
    result = check_uniform(pressed(bodies, 1.2, 1.2))
    np.testing.assert_allclose(result.node_displacement("c")[:, 1], -Q * 0.5 / 1e4, rtol=1e-10)


def test_t_joints():
    """Running bond of blocks of three sizes: joints end in the middle of edges above and below."""
    bodies = (
        box("a", 0, 0.7, 0, 0.4, material="soft", mesh_size=0.3),
        box("b", 0.7, 2, 0, 0.4, material="soft", mesh_size=0.21),
        box("c", 0, 1.1, 0.4, 0.8, material="soft", mesh_size=0.25),
        box("d", 1.1, 2, 0.4, 0.8, material="soft", mesh_size=0.4),
        box("e", 0, 2, 0.8, 1.1, material="hard", mesh_size=0.17),
    )
    check_uniform(pressed(bodies, 1.1, 2.0), corners=True)


def test_elements_cut_by_the_end_of_a_joint():
    """Grids that ignore where the joints are: the segment ends inside elements on one side or on both."""
    xs = np.array([0, 0.31, 0.8, 1.37, 2.0])
    bodies = (
        box("a", 0, 0.7, 0, 0.4, material="soft", mesh_size=0.3),
        box("b", 0.7, 2, 0, 0.4, material="soft", mesh_size=0.21),
        box("c", 0, 2, 0.4, 0.9, material="soft", grid=(xs, np.array([0.4, 0.6, 0.9]))),
    )
    for element in ("Q4", "Q9"):
        result = concio.solve(pressed(bodies, 0.9, 2.0, element=element))
        u, nodes = result.node_displacement("c"), result.nodes("c")
        np.testing.assert_allclose(u[:, 1], -Q * nodes[:, 1] / 1e4, rtol=1e-9, atol=1e-12)


@few
@given(
    sizes=st.tuples(*[st.floats(0.12, 0.6)] * 3), cut=st.floats(0.2, 0.8), ratio=st.floats(1e-2, 1e2),
    angle=st.floats(0.0, 6.3), skew=st.floats(-0.2, 0.2),
)  # fmt: skip
def test_any_sizes_moduli_and_directions(sizes, cut, ratio, angle, skew):
    """Two blocks with a head joint under one that covers both and has a slanted side, turned."""
    a = concio.Body("a", np.array([(0, 0), (cut, 0), (cut, 0.5), (0, 0.5)]), "soft", mesh_size=sizes[0])
    right = np.array([(cut, 0), (1, 0), (1, 0.5), (cut, 0.5)])
    b = concio.Body("b", right, "soft", mesh_size=sizes[1])
    c = concio.Body("c", np.array([(0, 0.5), (1, 0.5), (1 + skew, 1), (0, 1)]), "mid", mesh_size=sizes[2])
    ground = box("ground", 0, 1, -1, 0, kind="fixed")
    # uniform uniaxial stress needs no traction on the slanted side beyond n . sigma: load it with that traction
    side = np.array([skew, 0.5])
    normal = np.array([side[1], -side[0]]) / np.hypot(*side)
    loads = (
        Load("pressure", (Q,), edge=((0, 1), (1 + skew, 1))),
        Load("traction", tuple(-Q * np.array([0.0, normal[1]])), edge=((1, 0.5), (1 + skew, 1))),
    )
    model = model_of(
        ground, a, b, c, law=0.6, loads=loads, materials={"soft": Elastic(1e4, 0.0), "mid": Elastic(1e4 * ratio, 0.0)}
    )
    check_uniform(turned(model, angle), corners=True, direction=(-np.sin(angle), np.cos(angle)))


SPRINGS = JointLaw(0.6, normal_stiffness=1e5, tangential_stiffness=1e5)
GLUED = JointLaw(0.6, cohesion=5, tensile_strength=5)


@pytest.mark.parametrize("law", [SPRINGS, GLUED], ids=["springs", "glued"])
def test_other_laws_pass_it_too(law):
    bodies = (
        box("a", 0, 1.2, 0, 1, material="soft", mesh_size=0.5),
        box("b", 0, 1.2, 1, 1.7, material="hard", mesh_size=0.29),
    )
    result = check_uniform(pressed(bodies, 1.7, 1.2, law=law))
    spring = 0.0 if law.normal_stiffness is None else 2 * Q / 1e5
    assert result.max_settlement == pytest.approx(Q * (1 / 1e4 + 0.7 / 3e5) + spring, rel=1e-9)
