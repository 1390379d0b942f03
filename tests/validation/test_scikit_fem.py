"""Stiffness and stresses against scikit-fem's own elasticity (https://github.com/kinnala/scikit-fem), plane strain.

concio takes shape functions and quadrature from scikit-fem but writes constitutive matrix, strain operator, stiffness
and stresses itself. Here scikit-fem's ready-made form does the same from the same mesh with the same order of
quadrature, so that agreement is to rounding.
"""

from __future__ import annotations

import numpy as np
import pytest
import skfem
from skfem.models.elasticity import lame_parameters, linear_elasticity, linear_stress

import concio

E, NU = 3e6, 0.27
FAMILIES = {
    "Q4": (skfem.MeshQuad, skfem.ElementQuad1, 3),
    "Q9": (skfem.MeshQuad, skfem.ElementQuad2, 5),
    "T3": (skfem.MeshTri, skfem.ElementTriP1, 1),
    "T6": (skfem.MeshTri, skfem.ElementTriP2, 2),
}


def one_block(element):
    outline = np.array([[0.0, 0.0], [1.0, 0.1], [0.9, 0.8], [0.1, 0.6]])
    ground = np.array([[-0.2, -0.3], [1.2, -0.3], [1.0, 0.1], [0.0, 0.0]])
    model = concio.Model(
        bodies=(concio.Body("ground", ground, kind="fixed"), concio.Body("block", outline, mesh_size=0.3)),
        materials={"block": concio.Elastic(E=E, nu=NU)},
        laws={"joint": concio.JointLaw(friction=0.6)},
        plane="strain",
        element=element,
    )
    disc = concio.assemble(model).disc
    return disc, disc.shapes[disc.shape_of[1]], 1


def reference(shape, element):
    """scikit-fem's basis on the same mesh, and its unknown of each of ours."""
    mesh_type, family, order = FAMILIES[element]
    cells = shape.elements.cells
    used, back = np.unique(cells, return_inverse=True)
    mesh = mesh_type(shape.elements.nodes[used].T.copy(), back.reshape(cells.shape).T.copy())
    basis = skfem.Basis(mesh, skfem.ElementVector(family()), intorder=order)
    place = {(*np.round(x, 9), c): i for i, (x, c) in enumerate(zip(basis.doflocs.T, component(basis), strict=True))}
    ours = [(*np.round(x, 9), c) for x in shape.elements.nodes for c in (0, 1)]
    return basis, np.array([place[key] for key in ours])


def component(basis):
    """Direction 0 or 1 of each unknown of a vector basis."""
    found = np.empty(basis.N, dtype=int)
    for direction, unknowns in enumerate(basis.split_indices()):
        found[unknowns] = direction
    return found


@pytest.mark.parametrize("element", FAMILIES)
def test_stiffness(element):
    _, shape, _ = one_block(element)
    basis, order = reference(shape, element)
    theirs = linear_elasticity(*lame_parameters(E, NU)).assemble(basis).toarray()[np.ix_(order, order)]
    assert np.abs(shape.K.toarray() - theirs).max() <= 1e-12 * np.abs(theirs).max()


@pytest.mark.parametrize("element", FAMILIES)
def test_stresses(element):
    """Stresses of an arbitrary displacement, averaged over each element."""
    disc, shape, _ = one_block(element)
    basis, order = reference(shape, element)
    rng = np.random.default_rng(5)
    u = rng.normal(size=shape.unknowns)
    theirs_u = np.zeros_like(u)
    theirs_u[order] = u
    stress = linear_stress(*lame_parameters(E, NU))(skfem.helpers.sym_grad(basis.interpolate(theirs_u)))
    area = basis.dx.sum(axis=1)
    theirs = np.stack([(s * basis.dx).sum(axis=1) / area for s in (stress[0, 0], stress[1, 1], stress[0, 1])], axis=1)
    el = shape.elements
    at_points = (shape.stress_operator @ u).reshape(-1, 3)
    ours = np.stack([np.bincount(el.cell_of_point, el.weights * s) for s in at_points.T], axis=1)
    ours /= np.bincount(el.cell_of_point, el.weights)[:, None]
    assert np.abs(ours - theirs).max() <= 1e-11 * np.abs(theirs).max()
    assert disc.unknowns == len(u)
