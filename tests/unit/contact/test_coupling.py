"""Coupling along a segment: node pairs where meshes match, dual mortar elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.contact.coupling import Coupling, Line, couple, cut, match
from concio.fem.edge_integral import edge_weights


def line(at, order=1, first=0):
    at = np.asarray(at, dtype=float)
    return Line(first + np.arange(len(at)), at, order)


def value(coupling: Coupling, side, nodal):
    """Displacement of one side at each pair from a function of position (rigid sides) or nodal values."""
    if side is None:
        return nodal(coupling.at)
    total = np.zeros(len(coupling.at))
    np.add.at(total, side.pair, side.weight * nodal(side.node))
    return total


def check_linear_fields_and_forces(coupling, a, b, length):
    """Linear displacements are read alike on both sides; a uniform pressure becomes consistent nodal forces."""
    for side, mesh in ((coupling.a, a), (coupling.b, b)):
        for field in (np.ones_like, lambda x: 0.3 + 2.0 * x):
            at_nodes = field if side is None else (lambda n, m=mesh, f=field: f(m.at)[n - m.nodes[0]])
            np.testing.assert_allclose(value(coupling, side, at_nodes), field(coupling.at), atol=1e-12)
        if side is not None:
            nodal = np.bincount(side.node - mesh.nodes[0], side.weight * coupling.length[side.pair], len(mesh.at))
            np.testing.assert_allclose(nodal, edge_weights(mesh.at, mesh.order, 0.0, length), atol=1e-12)
    assert coupling.length.sum() == pytest.approx(length)
    assert coupling.length @ coupling.at == pytest.approx(length**2 / 2)  # their resultant is in the middle
    assert (coupling.length > 0).all()
    assert coupling.at.min() > -1e-12 * length, "a force beyond an end has an arm that the contact does not have"
    assert coupling.at.max() < (1 + 1e-12) * length


def test_matching_meshes_give_node_pairs():
    a, b = line([0, 0.5, 1.2]), line([0, 0.5, 1.2], first=7)
    c = couple(a, b, 1.2)
    assert c.a.node.tolist() == [0, 1, 2]
    assert c.b.node.tolist() == [7, 8, 9]
    assert (c.a.weight == 1).all()
    assert (c.b.weight == 1).all()
    np.testing.assert_allclose(c.at, a.at)
    np.testing.assert_allclose(c.length, [0.25, 0.6, 0.35])


def test_meshed_side_on_a_rigid_one_gives_its_nodes():
    c = couple(None, line([0, 0.5, 1.2]), 1.2)
    assert c.a is None
    assert c.b.node.tolist() == [0, 1, 2]
    np.testing.assert_allclose(c.b.weight, 1.0)
    np.testing.assert_allclose(c.at, [0, 0.5, 1.2], atol=1e-15)


@pytest.mark.parametrize("order", [1, 2])
def test_what_matches(order):
    at = [0, 0.2, 0.4, 0.7, 1.0]
    assert match(line(at, order), line(at, order), 1.0)
    assert not match(line(at, order), line([0, 0.21, 0.42, 0.71, 1.0], order), 1.0)
    assert not match(line(at, order), line(at, 3 - order), 1.0)
    assert not match(line(at, order), line(at, order), 1.1)


@pytest.mark.parametrize(
    ("a", "b"),
    [
        (line([0, 0.5, 1]), line(np.linspace(0, 1, 4))),
        (line([0, 0.5, 1]), line(np.linspace(0, 1, 6))),
        (line([0, 1]), line([0, 0.1, 0.15, 0.7, 1])),
        (line([0, 0.5, 1], 2), line(np.linspace(0, 1, 7), 2)),
        (line([0, 0.5, 1], 2), line(np.linspace(0, 1, 4))),
        (line([-0.3, 0.2, 0.6, 1.4]), line(np.linspace(0, 1, 5))),  # one side cut at both ends
        (line([-0.3, 0.2, 0.6, 1.4]), line([-0.6, 0.4, 1.1])),  # both
        (line([-0.3, 0.2, 0.6, 1.4]), None),
        (None, line([-0.3, 0.2, 0.6, 1.4])),
        (None, line([-0.4, 0, 0.4, 0.7, 1.0], 2)),
        (line([-0.4, -0.1, 0.2, 0.8, 1.4], 2), line([0, 0.3, 1.0])),
        (line([-5, 5]), line([-2, 0.999, 3])),
        (line([0, 0.3, 1.0]), None),
    ],
)
def test_any_meshes_carry_linear_fields_and_uniform_pressure(a, b):
    c = couple(a, b, 1.0)
    a, b = (None if m is None else cut(m, 1.0) for m in (a, b))
    check_linear_fields_and_forces(c, a, b, 1.0)


def test_pairs_stand_on_the_finer_side():
    coarse, fine = line([0, 1]), line(np.linspace(0, 1, 5))
    assert len(couple(coarse, fine, 1.0).at) == 5
    assert len(couple(fine, coarse, 1.0).at) == 5


def test_cut_drops_elements_beyond_the_segment():
    whole = line([-2, -1, 0.5, 0.8, 2, 3])
    np.testing.assert_allclose(cut(whole, 1.0).at, [-1, 0.5, 0.8, 2])
    np.testing.assert_allclose(cut(line([-1, 0, 1, 2]), 1.0).at, [0, 1])
    np.testing.assert_allclose(cut(line([-2, -1, 0, 0.5, 1.0], 2), 1.0).at, [0, 0.5, 1])


@pytest.mark.parametrize("points", [2, 5, 9])
def test_between_rigid_sides(points):
    c = couple(None, None, 3.0, points)
    assert len(c.at) == points
    assert c.length.sum() == pytest.approx(3.0)
    assert c.length @ c.at == pytest.approx(4.5)
    if points > 2:
        assert c.length @ c.at**3 == pytest.approx(81 / 4)  # Simpson


def test_forces_of_whole_quadratic_edges_are_lumped_as_their_shape_functions():
    """Against a rigid side: one to four to one; where an edge is cut, as linear ones."""
    assert couple(line([0.0, 0.5, 1.0], order=2), None, 1.0).length == pytest.approx([1 / 6, 4 / 6, 1 / 6])
    assert couple(line([0.0, 0.5, 1.0]), None, 1.0).length == pytest.approx([1 / 4, 1 / 2, 1 / 4])


def test_nodes_near_a_cut_are_those_within_a_thousandth_of_the_shortest_element() -> None:
    """Elements of 0.1 and of 3 m: a node 2 mm from the cut is a point of its own, one of 0.05 mm is not."""
    for near, points in ((2e-3, [0.0, 2e-3, 1.0]), (5e-5, [0.0, 1.0])):
        at = np.array([near - 0.1, near, near + 3.0])
        found = couple(line(at), None, 1.0)
        assert len(found.at) == len(points)
        assert found.length.sum() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ([0, 0.11, 0.23, 0.34], [0, 0.06, 0.2, 0.34]),  # as many nodes, at other places
        ([-0.05, 0.1, 0.2, 0.34], [0, 0.1, 0.2, 0.34]),
        ([0, 0.1, 0.34], [0, 0.06, 0.2, 0.34]),
    ],
)
def test_the_order_of_the_bodies_does_not_choose_the_side_with_the_pairs(a, b):
    a, b = line(a), line(b, first=10)
    one, other = couple(a, b, 0.34), couple(b, a, 0.34)
    np.testing.assert_array_equal(one.at, other.at)
    np.testing.assert_array_equal(one.a.node, other.b.node)
    np.testing.assert_array_equal(one.b.weight, other.a.weight)


def brick(name, xs, low, high):
    """A block of hexahedra with corners at the places ``xs``."""
    grid = np.stack(np.meshgrid(xs, [0.0, 0.2, 0.4], [low, (low + high) / 2, high], indexing="ij"), -1)
    return replace(concio.Polyhedron.box(name, (xs[0], 0.0, low), (xs[-1], 0.4, high)), grid=grid)


def test_nor_does_it_in_space():
    ground = concio.Polyhedron.box("ground", (-1, -1, -0.3), (2, 2, 0), kind="fixed")
    blocks = [brick("even", [0, 0.2, 0.4, 0.6], 0, 0.3), brick("uneven", [0, 0.1, 0.35, 0.6], 0.3, 0.6)]
    materials, laws = {"block": concio.Elastic(1e5, 0.2, 20.0)}, {"joint": concio.JointLaw(0.6)}
    for order in (blocks, blocks[::-1]):
        model = concio.Model((ground, *order), materials, laws, loads=(concio.Load("weight", (0, 0, -1)),))
        pairs = concio.assemble(model).pairs
        between = (pairs.body_a > 0) & (pairs.body_b > 0)
        assert set(pairs.point[between, 0].round(9)) == {0.0, 0.2, 0.4, 0.6}
