"""Shapes: boundary nodes of each edge, and integrals along them."""

from __future__ import annotations

import numpy as np
import pytest

from concio.errors import InputError
from concio.fem.constitutive import constitutive_matrix
from concio.fem.edge_integral import edge_weights, lagrange, pieces
from concio.fem.elements import FAMILIES, build
from concio.fem.mesh import is_rectangle, merged, mesh_body, tensor
from concio.fem.shape import Shape
from concio.model.generate.spacing import subdivided
from concio.model.materials import Elastic
from concio.model.model import Body
from concio.model.polyhedron import Polyhedron

D = constitutive_matrix(Elastic(E=1.0, nu=0.0), "stress")
TRAPEZIUM = np.array([(0, 0), (2, 0), (1.5, 1), (0.2, 1.0)])


@pytest.mark.parametrize("name", list(FAMILIES))
def test_edge_nodes_run_along_the_outline(name):
    body = Body("b", TRAPEZIUM)
    points, cells = mesh_body(body, 0.4, 1, [np.array([0.7]), np.zeros(0), np.zeros(0), np.zeros(0)])
    shape = Shape(TRAPEZIUM, build(points, cells, name, D), D, 1.0)
    assert len(shape.edges) == 4
    for e, edge in enumerate(shape.edges):
        a, b = TRAPEZIUM[e], TRAPEZIUM[(e + 1) % 4]
        length = np.linalg.norm(b - a)
        np.testing.assert_allclose(shape.elements.nodes[edge.nodes], a + np.outer(edge.at / length, b - a), atol=1e-12)
        assert edge.at[0] == pytest.approx(0, abs=1e-12)
        assert edge.at[-1] == pytest.approx(length)
        assert (np.diff(edge.at) > 0).all()
        assert len(edge.at) % edge.order == (1 if edge.order == 2 else 0)
        for nodes in pieces(edge.at, edge.order):  # middle nodes in the middle
            at = edge.at[nodes]
            np.testing.assert_allclose(at, np.linspace(at[0], at[-1], edge.order + 1))
        assert edge_weights(edge.at, edge.order, 0, length).sum() == pytest.approx(length)
    assert np.abs(shape.edges[0].at - 0.7).min() < 1e-12


def test_weights_of_part_of_an_edge_by_hand():
    # linear: hats at 0, 1, 3; over [0.5, 2]
    np.testing.assert_allclose(edge_weights(np.array([0, 1, 3.0]), 1, 0.5, 2.0), [0.125, 0.375 + 0.75, 0.25])
    # quadratic over the whole: Simpson's 1, 4, 1
    np.testing.assert_allclose(edge_weights(np.array([0, 1, 2.0]), 2, 0, 2), np.array([1, 4, 1]) / 3)
    # outside: nothing
    assert not edge_weights(np.array([0, 1.0]), 1, 2.0, 3.0).any()


def test_lagrange_polynomials():
    nodes = np.array([0.0, 0.4, 1.0])
    np.testing.assert_allclose(lagrange(nodes, nodes), np.eye(3), atol=1e-15)
    x = np.linspace(-1, 2, 7)
    np.testing.assert_allclose(lagrange(nodes, x).sum(0), 1.0)
    np.testing.assert_allclose(nodes**2 @ lagrange(nodes, x), x**2, atol=1e-14)


def test_grid_lines():
    np.testing.assert_allclose(subdivided(np.array([0, 1.0, 1.5]), 0.5), [0, 0.5, 1, 1.5])
    np.testing.assert_allclose(subdivided(np.array([0, 1.0]), 0.5, 2), [0, 0.25, 0.5, 0.75, 1])
    np.testing.assert_allclose(merged(np.array([1.0, 0.0, 1.0 + 1e-9, 0.5]), 1e-6), [0, 0.5, 1.0])
    points, cells = tensor(np.array([0, 1, 3.0]), np.array([0, 2.0]))
    np.testing.assert_allclose(points[cells[1]], [(1, 0), (3, 0), (3, 2), (1, 2)])


def test_rectangle_marks_become_mesh_lines():
    outline = np.array([(1, 1), (3, 1), (3, 2), (1, 2.0)])
    breaks = [np.array([0.3]), np.zeros(0), np.array([0.3]), np.array([0.25])]  # from the first vertex of each edge
    points, _ = mesh_body(Body("b", outline), 10.0, 1, breaks)
    np.testing.assert_allclose(np.unique(points[:, 0].round(12)), [1, 1.3, 2.7, 3])
    np.testing.assert_allclose(np.unique(points[:, 1].round(12)), [1, 1.75, 2])
    assert is_rectangle(outline)
    assert not is_rectangle(TRAPEZIUM)
    assert not is_rectangle(np.array([(0, 0), (1, 1), (0, 2), (-1, 1.0)]))


def test_refinement_of_a_polygon_shortens_its_edges_as_much():
    outline = np.array([(0, 0), (1.2, 0), (1.4, 0.8), (0.5, 1.3), (-0.2, 0.7)])
    coarse, fine = (len(mesh_body(Body("b", outline), 0.4, k, [np.zeros(0)] * 5)[1]) for k in (1, 3))
    assert fine == pytest.approx(9 * coarse, rel=0.4)


def test_refinement_splits_each_element():
    outline = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])
    none = [np.zeros(0)] * 4
    coarse, fine = (mesh_body(Body("b", outline), 0.5, k, none)[1] for k in (1, 3))
    assert len(fine) == 9 * len(coarse)


@pytest.mark.parametrize("size", [0.0, -0.1, np.inf, np.nan])
def test_a_size_of_elements_that_is_none_is_refused(size):
    with pytest.raises(InputError, match=r"block 'a'.*mesh size"):
        Body("a", TRAPEZIUM, mesh_size=size)
    with pytest.raises(InputError, match=r"block 'a'.*mesh size"):
        Polyhedron.box("a", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), mesh_size=size)
