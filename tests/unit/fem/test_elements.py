"""Element families against exact fields: rigid motions, constant and quadratic strain, bending."""

from __future__ import annotations

import numpy as np
import pytest

from concio.errors import GeometryError, InputError
from concio.fem.constitutive import constitutive_matrix, principal
from concio.fem.edge_integral import edge_weights
from concio.fem.elements import FAMILIES, build, family
from concio.fem.mesh import tensor
from concio.fem.shape import Shape
from concio.kinematics.rigid import rigid_modes
from concio.model.materials import Elastic

STEEL = Elastic(E=2.0e5, nu=0.3)
OUTLINE = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])


def distorted(n=3, amount=0.18, seed=4):
    """Unit square of n x n quadrilaterals whose inner nodes are moved."""
    points, cells = tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    inner = ((points > 1e-9) & (points < 1 - 1e-9)).all(1)
    rng = np.random.default_rng(seed)
    points[inner] += amount / n * rng.uniform(-1, 1, (int(inner.sum()), 2))
    return points, cells


def shape_of(name, points, cells, plane="stress", outline=OUTLINE, thickness=0.7):
    D = constitutive_matrix(STEEL, plane)
    return Shape(outline, build(points, cells, name, D), D, thickness)


families = pytest.mark.parametrize("name", list(FAMILIES))


@families
@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_rigid_motions_cost_nothing_and_nothing_else_does(name, plane):
    shape = shape_of(name, *distorted(), plane)
    K = shape.K.toarray()
    scale = np.abs(K).max()
    assert np.abs(K @ shape.R).max() <= 1e-13 * scale
    np.testing.assert_allclose(shape.R.T @ shape.R, np.eye(3), atol=1e-14)
    values = np.linalg.eigvalsh(K) / scale
    assert np.count_nonzero(values < 1e-9) == 3
    assert values[3] > 1e-4
    assert (shape.K != shape.K.T).nnz == 0


@families
def test_a_single_element_has_three_rigid_motions_only(name):
    points, cells = distorted(1)
    if FAMILIES[name].cells == 3:
        points, cells = points[[0, 1, 3]], np.array([[0, 1, 2]])
    K = shape_of(name, points, cells).K.toarray()
    values = np.linalg.eigvalsh(K) / np.abs(K).max()
    assert np.count_nonzero(values < 1e-10) == 3


@families
def test_constant_strain_is_exact_on_distorted_meshes(name):
    """The patch test: linear boundary displacements give the linear field inside, and its stress everywhere."""
    shape = shape_of(name, *distorted())
    nodes = shape.elements.nodes
    gradient = np.array([[1.0, 0.4], [-0.3, 2.0]]) * 1e-3
    exact = (nodes @ gradient.T).ravel()
    edge = ((nodes < 1e-9) | (nodes > 1 - 1e-9)).any(1)
    held = np.repeat(edge, 2)
    K = shape.K.toarray()
    u = exact.copy()
    u[~held] = np.linalg.solve(K[np.ix_(~held, ~held)], -K[np.ix_(~held, held)] @ exact[held])
    np.testing.assert_allclose(u, exact, atol=1e-14)
    strain = np.array([gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]])
    stress = (shape.stress_operator @ u).reshape(-1, 3)
    np.testing.assert_allclose(stress, np.tile(shape.D @ strain, (len(stress), 1)), rtol=1e-11)
    np.testing.assert_allclose(shape.mean_stress_operator @ u, shape.D @ strain, rtol=1e-11)
    energy = 0.5 * u @ K @ u
    assert energy == pytest.approx(0.5 * 0.7 * strain @ shape.D @ strain, rel=1e-12)  # area 1


def bending_energy(name, points, cells, outline=OUTLINE):
    """Energy of pure bending sigma_x = E y in plane stress, exact nodal displacements, thickness 0.7."""
    shape = shape_of(name, points, cells, outline=outline)
    x, y = shape.elements.nodes.T
    u = np.column_stack([x * y, -(x**2) / 2 - STEEL.nu * y**2 / 2]).ravel()
    exact = 0.5 * 0.7 * STEEL.E * np.ptp(outline[:, 0]) * (outline[:, 1].max() ** 3 - outline[:, 1].min() ** 3) / 3
    return 0.5 * u @ shape.K @ u, exact


@pytest.mark.parametrize("name", ["Q8", "Q9", "T6"])
def test_quadratic_displacements_are_exact_in_quadratic_elements(name):
    points, cells = tensor(np.array([0, 0.3, 1.0]), np.array([0, 0.6, 1.0]))
    energy, exact = bending_energy(name, points, cells)
    assert energy == pytest.approx(exact, rel=1e-12)


def test_q9_is_exact_on_distorted_meshes_too():
    energy, exact = bending_energy("Q9", *distorted())
    assert energy == pytest.approx(exact, rel=1e-12)


def test_incompatible_modes_are_exact_in_pure_bending_and_q4_is_not():
    points, cells = tensor(np.array([0.0, 0.4, 1.0]), np.array([0.0, 1.0]))
    energy, exact = bending_energy("Q4I", points, cells)
    assert energy == pytest.approx(exact, rel=1e-12)
    stiff, _ = bending_energy("Q4", points, cells)
    assert stiff > 1.05 * exact


def cantilever(name, elements):
    """Tip deflection under a parabolic end shear of resultant 1; L = 10, h = 1, t = 0.7."""
    length = 10.0
    outline = np.array([(0, 0), (length, 0), (length, 1), (0, 1.0)])
    points, cells = tensor(np.linspace(0, length, elements + 1), np.linspace(0, 1, 3))
    shape = shape_of(name, points, cells, outline=outline)
    nodes = shape.elements.nodes
    f = np.zeros(shape.unknowns)
    edge = shape.edges[1]
    f[2 * edge.nodes + 1] = edge_weights(edge.at, edge.order, 0.0, 1.0)
    held = np.zeros(shape.unknowns, dtype=bool)
    held[2 * np.flatnonzero(nodes[:, 0] < 1e-9)] = True
    held[2 * np.flatnonzero((nodes[:, 0] < 1e-9) & (np.abs(nodes[:, 1] - 0.5) < 1e-9)) + 1] = True
    u = np.zeros(shape.unknowns)
    K = shape.K.toarray()
    u[~held] = np.linalg.solve(K[np.ix_(~held, ~held)], f[~held])
    inertia, shear_modulus = 0.7 / 12, STEEL.E / 2 / (1 + STEEL.nu)
    beam = length**3 / (3 * STEEL.E * inertia) + 6 / 5 * length / (shear_modulus * 0.7)  # Timoshenko
    return u[1::2][nodes[:, 0] > length - 1e-9].mean() / beam


def test_cantilever_against_beam_theory():
    assert cantilever("Q4I", 10) == pytest.approx(1.0, abs=0.01)
    assert cantilever("Q9", 10) == pytest.approx(1.0, abs=0.005)
    assert cantilever("Q8", 10) == pytest.approx(1.0, abs=0.005)
    assert cantilever("T6", 10) == pytest.approx(1.0, abs=0.01)
    assert cantilever("Q4", 10) < 0.85
    assert cantilever("T3", 10) < cantilever("Q4", 10)


@families
def test_weights_are_areas_and_loads(name):
    shape = shape_of(name, *distorted())
    assert shape.elements.weights.sum() == pytest.approx(1.0, rel=1e-13)
    assert shape.volume_weights.sum() == pytest.approx(0.7, rel=1e-13)
    moment = shape.volume_weights @ shape.elements.nodes  # first moments: centroid times volume
    np.testing.assert_allclose(moment, [0.35, 0.35], rtol=1e-12)


@families
@pytest.mark.parametrize("cells", [1, 2])
def test_nodal_stresses_reproduce_a_constant(name, cells):
    """Few elements, so that a mesh with fewer integration points than nodes would be found out."""
    points, quads = tensor(np.linspace(0, 1, cells + 1), np.array([0.0, 1.0]))
    shape = shape_of(name, points, quads)
    el = shape.elements
    constant = np.array([3.0, -7.0, 2.0])
    nodal = shape.projection @ (el.N.T @ (el.weights[:, None] * np.tile(constant, (len(el.weights), 1))))
    np.testing.assert_allclose(nodal, np.tile(constant, (len(el.nodes), 1)), rtol=1e-10)


def test_constitutive_matrices_by_hand():
    material = Elastic(E=100.0, nu=0.25)
    G = 100.0 / 2.5
    np.testing.assert_allclose(
        constitutive_matrix(material, "stress"),
        [[100 / 0.9375, 25 / 0.9375, 0], [25 / 0.9375, 100 / 0.9375, 0], [0, 0, G]],
        rtol=1e-14,
    )
    lame = 100 * 0.25 / (1.25 * 0.5)
    np.testing.assert_allclose(
        constitutive_matrix(material, "strain"),
        [[lame + 2 * G, lame, 0], [lame, lame + 2 * G, 0], [0, 0, G]],
        rtol=1e-14,
    )
    with pytest.raises(InputError, match="neither"):
        constitutive_matrix(material, "shell")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("stress", "s1", "s2", "angle"),
    [
        ((5.0, -3.0, 0.0), 5.0, -3.0, 0.0),
        ((-3.0, 5.0, 0.0), 5.0, -3.0, np.pi / 2),
        ((0.0, 0.0, 2.0), 2.0, -2.0, np.pi / 4),
        ((4.0, 1.0, 2.0), 5.0, 0.0, 0.5 * np.arctan2(2.0, 1.5)),
    ],
)
def test_principal_stresses(stress, s1, s2, angle):
    found = principal(np.array(stress))
    np.testing.assert_allclose(found, (s1, s2, angle), atol=1e-14)
    n = np.array([np.cos(found[2]), np.sin(found[2])])
    tensor_form = np.array([[stress[0], stress[2]], [stress[2], stress[1]]])
    np.testing.assert_allclose(tensor_form @ n, s1 * n, atol=1e-14)


def test_quadrilateral_family_takes_triangles_of_its_order():
    points, cells = np.array([(0, 0), (1, 0), (0, 1.0)]), np.array([[0, 1, 2]])
    D = constitutive_matrix(STEEL, "stress")
    assert len(build(points, cells, "Q9", D).nodes) == 6
    assert len(build(points, cells, "Q4I", D).nodes) == 3
    assert build(*tensor(np.array([0, 1.0]), np.array([0, 1.0])), "T6", D).cells.shape == (2, 3)


def test_unknown_family_and_folded_element():
    with pytest.raises(InputError, match=r"unknown element 'Q5'.*Q4I"):
        family("Q5")
    points = np.array([(0, 0), (1, 0), (0.4, 0.4), (0, 1.0)])  # re-entrant at one corner
    with pytest.raises(GeometryError, match="inside out"):
        build(points, np.array([[0, 1, 2, 3]]), "Q4", constitutive_matrix(STEEL, "stress"))


def test_rigid_motions_are_translations_and_a_small_rotation():
    points = np.array([(2.0, 1.0), (4.0, 1.0), (3.0, 5.0)])
    R = rigid_modes(points)
    turned = np.column_stack([-points[:, 1], points[:, 0]]).ravel()
    for motion in (np.tile([1.0, 0.0], 3), np.tile([0.0, 1.0], 3), turned):
        np.testing.assert_allclose(R @ (R.T @ motion), motion, atol=1e-13)
