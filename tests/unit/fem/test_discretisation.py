"""Numbering of unknowns, shared shapes, points that move with bodies."""

from __future__ import annotations

import numpy as np
import pytest

from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID, discretise
from concio.model.materials import Elastic
from models import box, model_of, on_ground, turned


def rigid_motion(disc, b, translation, rotation):
    """Unknowns of body b under a rigid motion about the origin."""
    if disc.shape_of[b] == RIGID:
        x, y = disc.centroids[b]
        return np.r_[np.array(translation) + rotation * np.array([-y, x]), rotation * disc.reach[b]]
    nodes = disc.nodes(b)
    return (np.array(translation) + rotation * np.column_stack([-nodes[:, 1], nodes[:, 0]])).ravel()


def test_equal_bodies_share_a_shape_and_unknowns_follow_bodies():
    model = on_ground(
        box("a", 0, 1, 0, 1, mesh_size=0.5),
        box("b", 1, 2, 0, 1, mesh_size=0.5),
        box("c", 2, 3, 0, 1, kind="rigid", material="stone"),
        box("d", 0.1, 1.1, 1, 2, mesh_size=0.25),
    )
    disc = discretise(model)
    assert disc.shape_of.tolist() == [FIXED, 0, 0, RIGID, 1]
    assert np.diff(disc.offsets).tolist() == [0, 18, 18, 3, 50]
    assert disc.unknowns == 89
    K = disc.stiffness()
    assert K.shape == (89, 89)
    np.testing.assert_allclose(K.toarray()[:18, :18], disc.shapes[0].K.toarray())
    np.testing.assert_allclose(K.toarray()[18:36, 18:36], disc.shapes[0].K.toarray())
    np.testing.assert_allclose(K.toarray()[39:, 39:], disc.shapes[1].K.toarray())
    assert not K.toarray()[36:39].any()
    assert abs(K).sum() == pytest.approx(2 * abs(disc.shapes[0].K).sum() + abs(disc.shapes[1].K).sum())


@pytest.mark.parametrize("change", ["material", "thickness", "size", "mesh"])
def test_different_bodies_do_not(change):
    second = {
        "material": box("b", 1, 2, 0, 1, material="other"),
        "thickness": box("b", 1, 2, 0, 1, thickness=0.9),
        "size": box("b", 1, 2.0001, 0, 1),
        "mesh": box("b", 1, 2, 0, 1, mesh_size=0.1),
    }[change]
    disc = discretise(on_ground(box("a", 0, 1, 0, 1), second, materials={"other": Elastic(1.0)}))
    assert len(disc.shapes) == 2


def test_noise_in_coordinates_does_not_multiply_shapes():
    """A thousand equal stones at places that are not round numbers mesh once."""
    stones = [box(f"s{k}", k / 3, (k + 1) / 3, k * 0.1, k * 0.1 + 1 / 7) for k in range(1000)]
    assert len(discretise(model_of(*stones)).shapes) <= 2


def test_breaks_are_part_of_the_shape():
    model = on_ground(box("a", 0, 1, 0, 1), box("b", 1, 2, 0, 1))
    none = [np.zeros(0)] * 4
    disc = discretise(model, {1: [np.array([0.3]), *none[1:]], 2: none})
    assert len(disc.shapes) == 2
    assert np.abs(disc.nodes(1) - [0.3, 0.0]).sum(1).min() < 1e-12


@pytest.mark.parametrize("element", ["Q4", "Q8", "T6"])
def test_points_move_with_their_body(element):
    model = on_ground(
        box("a", 0, 1, 0, 1),
        box("r", 1, 2, 0, 1, kind="rigid", material="stone"),
        element=element,
    )
    disc = discretise(turned(model, 0.3, (2.0, -1.0)))
    for b, inside in ((1, (0.37, 0.61)), (2, (1.2, 0.9))):
        c, s = np.cos(0.3), np.sin(0.3)
        point = np.array([[c, -s], [s, c]]) @ inside + [2.0, -1.0]
        dofs, rows = disc.point_operator(b, point)
        u = np.zeros(disc.unknowns)
        u[disc.offsets[b] : disc.offsets[b + 1]] = rigid_motion(disc, b, (0.2, 0.1), 0.5)
        np.testing.assert_allclose(rows @ u[dofs], np.array([0.2, 0.1]) + 0.5 * np.array([-point[1], point[0]]))
    assert disc.point_operator(0, np.zeros(2))[0].size == 0


def test_a_node_is_taken_alone_and_a_point_outside_refused():
    disc = discretise(on_ground(box("a", 0, 1, 0, 1, mesh_size=0.5)))
    dofs, rows = disc.point_operator(1, np.array([0.5, 1.0]))
    assert len(dofs) == 2
    np.testing.assert_allclose(rows, np.eye(2))
    with pytest.raises(InputError, match=r"block 'a'.*\(1.2, 0.5\).*outside"):
        disc.point_operator(1, np.array([1.2, 0.5]))


def test_sizes_that_cannot_be_meshed():
    with pytest.raises(InputError, match="mesh size"):
        discretise(on_ground(box("a", 0, 1, 0, 1, mesh_size=-1.0)))
    with pytest.raises(InputError, match=r"block 'a'.*unknowns"):  # before memory is asked for
        discretise(on_ground(box("a", 0, 1, 0, 1, mesh_size=1e-8)))


def test_the_whole_mesh_may_not_be_too_large(monkeypatch):
    monkeypatch.setattr("concio.fem.discretisation.LARGEST_UNKNOWNS", 100)
    discretise(on_ground(*[box(f"b{k}", k, k + 1, 0, 1) for k in range(2)]))
    with pytest.raises(InputError, match="150 unknowns, more than 100"):
        discretise(on_ground(*[box(f"b{k}", k, k + 1, 0, 1) for k in range(3)]))
