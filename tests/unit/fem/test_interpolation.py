"""Weights of the nodes of a mesh at a point: they give the point back and depend on no numbering."""

from __future__ import annotations

import numpy as np
import pytest

from concio.fem.interpolation import CUBE, interpolated

TURNS = {  # other numberings of the corners of one element: from another corner, and of its mirror image
    4: [(1, 2, 3, 0), (3, 2, 1, 0), (0, 3, 2, 1)],
    8: [(1, 2, 3, 0, 5, 6, 7, 4), (4, 5, 6, 7, 0, 1, 2, 3), (3, 2, 1, 0, 7, 6, 5, 4)],
}


def element(corners, seed):
    """One distorted element: its nodes (c, d) and a point inside it."""
    rng = np.random.default_rng(seed)
    d = 2 if corners == 4 else 3
    nodes = CUBE[:corners, :d] + 0.15 * rng.uniform(-1, 1, (corners, d))
    return nodes, rng.dirichlet(np.ones(corners)) @ (0.5 * nodes + 0.5 * nodes.mean(axis=0))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("corners", [4, 8])
def test_the_weights_depend_on_no_numbering(corners, seed):
    nodes, point = element(corners, seed)
    first, weights = interpolated(nodes, np.arange(corners)[None], point)
    assert weights.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(weights @ nodes[first], point, atol=1e-12)
    for order in TURNS[corners]:
        others, same = interpolated(nodes, np.array([order]), point)
        np.testing.assert_allclose(same[np.argsort(others)], weights[np.argsort(first)], atol=1e-10)


@pytest.mark.parametrize("corners", [4, 8])
def test_the_middle_of_an_element_is_shared_by_all_its_corners(corners):
    nodes, _ = element(corners, 3)
    number, weights = interpolated(nodes, np.arange(corners)[None], nodes.mean(axis=0))
    assert sorted(number) == list(range(corners))
    np.testing.assert_allclose(weights, 1.0 / corners, atol=1e-12)


def test_a_point_on_an_edge_belongs_to_its_two_nodes():
    nodes, _ = element(4, 1)
    number, weights = interpolated(nodes, np.arange(4)[None], 0.3 * nodes[1] + 0.7 * nodes[2])
    assert dict(zip(number.tolist(), weights.round(9).tolist(), strict=True)) == {1: 0.3, 2: 0.7}


def test_outside_there_are_no_nodes():
    nodes, _ = element(4, 0)
    assert not len(interpolated(nodes, np.arange(4)[None], np.array([3.0, 0.5]))[0])


@pytest.mark.parametrize("far", [1e3, 1e6])
@pytest.mark.parametrize("corners", [4, 8])
def test_far_from_the_origin_they_are_still_those_of_the_element(corners, far):
    nodes, point = element(corners, 2)
    number, weights = interpolated(nodes, np.arange(corners)[None], point)
    others, same = interpolated(nodes + far, np.arange(corners)[None], point + far)
    assert sorted(others) == sorted(number) == list(range(corners))
    np.testing.assert_allclose(same[np.argsort(others)], weights[np.argsort(number)], atol=1e-14 * far)
