"""Pairs of whole models: frames, areas, gaps, laws; rigid motions leave them alone; counts of the benchmark walls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import concio
from concio.contact.assembly import assemble
from concio.contact.loads import _line_load
from concio.errors import InputError
from concio.fem.discretisation import FIXED, RIGID
from concio.model.generate.walls import wall_of_courses
from concio.model.materials import Elastic, JointLaw
from concio.model.model import Body, JointRule, Load
from models import box, model_of, on_ground, turned, weight
from rigid_walls import FERRIS_TIN_LOI

STONE = {"kind": "rigid", "material": "stone"}


def move_everything(assembly, translation, rotation):
    """Unknowns (N,) of a rigid motion of all bodies about the origin."""
    disc = assembly.disc
    u = np.zeros(disc.unknowns)
    for b, s in enumerate(disc.shape_of):
        own = slice(disc.offsets[b], disc.offsets[b + 1])
        if s == RIGID:
            x, y = disc.centroids[b]
            u[own] = [translation[0] - rotation * y, translation[1] + rotation * x, rotation * disc.reach[b]]
        elif s != FIXED:
            x, y = disc.nodes(b).T
            u[own] = np.column_stack([translation[0] - rotation * y, translation[1] + rotation * x]).ravel()
    return u


MIXED = (
    box("a", 0, 1, 0, 1, mesh_size=0.5),
    box("b", 1, 2, 0, 1, mesh_size=0.3),
    box("c", 2, 3, 0, 1, **STONE),
    box("d", 0.4, 2.3, 1, 2, mesh_size=0.4),  # T-joints with a, b and c
    box("e", 2.3, 3, 1, 2, **STONE),
    box("f", 0.4, 3, 2, 3, grid=(np.linspace(0.4, 3, 4), np.array([2, 2.5, 3]))),  # mesh that ignores the joints below
)
"""Elastic on elastic, rigid on elastic, matching and not, cut elements."""


@pytest.mark.parametrize("element", ["Q4", "Q9", "T6"])
@pytest.mark.parametrize("angle", [0.0, 0.6])
def test_a_motion_of_the_whole_structure_opens_nothing(element, angle):
    model = model_of(*MIXED, box("far", 0, 3, -9, -8, kind="fixed"), element=element)
    if angle:
        model = turned(model, angle, (3.0, 7.0))  # grids fall away: all meshes are then free ones
    assembly = assemble(model)
    assert {(int(a), int(b)) for a, b in zip(assembly.pairs.body_a, assembly.pairs.body_b, strict=True)} == {
        (0, 1), (0, 3), (1, 2), (1, 3), (2, 3), (2, 4), (3, 4), (3, 5), (4, 5),
    }  # fmt: skip
    u = move_everything(assembly, (0.3, -0.2), 0.5)
    assert np.abs(assembly.pairs.C_n @ u).max() < 1e-12 * np.abs(u).max()
    assert np.abs(assembly.pairs.C_t @ u).max() < 1e-12 * np.abs(u).max()


@pytest.mark.parametrize("element", ["Q4", "Q9", "T6"])
def test_uniform_pressure_is_in_balance_through_every_joint(element):
    """Forces p w n on all pairs give each side the consistent forces of a uniform pressure."""
    assembly = assemble(model_of(*MIXED, box("far", 0, 3, -9, -8, kind="fixed"), element=element))
    pairs, disc = assembly.pairs, assembly.disc
    f = pairs.C_n.T @ pairs.area
    expected = np.zeros(disc.unknowns)
    for face in assembly.detection.interfaces:
        for b, edge, sign in ((face.a, face.edge_a, -1.0), (face.b, face.edge_b, 1.0)):
            corner = disc.model.bodies[b].outline[edge]
            at = sorted(np.linalg.norm(p - corner) for p in (face.start, face.end))
            _line_load(disc, b, edge, tuple(at), sign * face.normal, expected)
    np.testing.assert_allclose(f, expected, atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.6])
def test_joints_begin_and_end_at_nodes(angle):
    """Bodies without a grid of their own are meshed so that no joint ends inside an element edge."""
    assembly = assemble(turned(model_of(*MIXED[:5], box("far", 0, 3, -9, -8, kind="fixed")), angle))
    ends = 0
    for face in assembly.detection.interfaces:
        for b in (face.a, face.b):
            if assembly.disc.shape_of[b] >= 0:
                for end in (face.start, face.end):
                    assert np.hypot(*(assembly.disc.nodes(b) - end).T).min() < 1e-9
                    ends += 1
    assert ends > 15


def test_frames_areas_and_order():
    lines = np.array([0.0, 0.3, 1.0]), np.array([0.0, 1.0])
    assembly = assemble(on_ground(box("a", 0, 1, 0, 1, thickness=0.4, grid=lines)))
    p = assembly.pairs
    assert len(p) == 3
    np.testing.assert_allclose(p.normal, [[0, 1]] * 3, atol=1e-15)  # from the ground to the block
    np.testing.assert_allclose(p.tangent, [[-1, 0]] * 3, atol=1e-15)
    order = np.argsort(p.point[:, 0])
    np.testing.assert_allclose(p.point[order, 0], [0, 0.3, 1], atol=1e-14)
    np.testing.assert_allclose(p.length[order], [0.15, 0.5, 0.35])
    np.testing.assert_allclose(p.area, 0.4 * p.length)
    lift = move_everything(assembly, (0.3, 0.1), 0.0)
    np.testing.assert_allclose(p.C_n @ lift, 0.1)
    np.testing.assert_allclose(p.C_t @ lift, -0.3)


def test_gaps_of_geometry_and_of_rules():
    # a wedge: the block's lower edge rises from 1 mm to 3 mm over 1 m
    wedge = box("b", 0, 1, 0, 1, **STONE)
    outline = wedge.outline + np.array([[0, 1e-3], [0, 3e-3], [0, 0], [0, 0]])
    model = on_ground(replace(wedge, outline=outline), gap_reach=5e-3)
    pairs = assemble(model).pairs
    order = np.argsort(pairs.point[:, 0])
    np.testing.assert_allclose(pairs.point[order, 0], [0, 1], atol=5e-6)
    across = np.cos(np.arctan(2e-3) / 2)  # gaps are measured across the bisector of the two edges
    np.testing.assert_allclose(pairs.gap[order], np.array([1e-3, 3e-3]) / across, rtol=1e-9)
    ruled = replace(model, rules=(JointRule("joint"), JointRule("joint", ("ground", "*"), 2e-3)))
    np.testing.assert_allclose(assemble(ruled).pairs.gap, pairs.gap + 2e-3, rtol=1e-12)


def test_laws_are_multiplied_by_areas():
    law = JointLaw(
        0.5, cohesion=30.0, tensile_strength=20.0, dilatancy=0.1, normal_stiffness=1e6, tangential_stiffness=4e5,
        compressive_strength=500.0,
    )  # fmt: skip
    assembly = assemble(on_ground(box("a", 0, 1, 0, 1, thickness=0.4, mesh_size=0.5), law=law))
    area, laws = assembly.pairs.area, assembly.laws
    np.testing.assert_allclose(laws.friction, 0.5)
    np.testing.assert_allclose(laws.dilatancy, 0.1)
    np.testing.assert_allclose(laws.cohesion, 30 * area)
    np.testing.assert_allclose(laws.tension, 20 * area)
    np.testing.assert_allclose(laws.cap, 500 * area)
    np.testing.assert_allclose(laws.normal_compliance, 1 / (1e6 * area))
    np.testing.assert_allclose(laws.tangential_compliance, 1 / (4e5 * area))
    hard = assemble(on_ground(box("a", 0, 1, 0, 1))).laws
    assert not hard.normal_compliance.any()
    assert np.isinf(hard.cap).all()
    assert not any(v.any() for v in (hard.cohesion, hard.tension, hard.dilatancy, hard.tangential_compliance))


@pytest.mark.parametrize(
    ("between", "expected"),
    [
        (("a", "b"), {("a", "b")}),
        (("b", "a"), {("a", "b")}),
        (("lintel", "*"), {("b", "c"), ("a", "b"), ("ground", "b")}),
        (("*", "top"), {("b", "c"), ("ground", "c")}),
        (("clay", "block"), {("a", "b")}),
        (("block", "block"), {("a", "b"), ("b", "c")}),  # the role of a, the material of b and c
    ],
)
def test_rules_choose_by_name_role_layer_and_material(between, expected):
    model = on_ground(
        box("a", 0, 1, 0, 1, material="clay"), box("b", 1, 2, 0, 1, role="lintel"),
        box("c", 2, 3, 0, 1, role="other", layer="top"), materials={"clay": Elastic(1e3)},
    )  # fmt: skip
    model = replace(
        model,
        laws={"joint": JointLaw(0.5), "new": JointLaw(0.9)},
        rules=(JointRule("joint"), JointRule("new", between)),
    )
    pairs = assemble(model).pairs
    chosen = pairs.law == pairs.law_names.index("new")
    bodies = model.bodies
    found = {(bodies[a].name, bodies[b].name) for a, b in zip(pairs.body_a[chosen], pairs.body_b[chosen], strict=True)}
    assert found == expected


def test_a_joint_without_a_law_is_named():
    model = replace(on_ground(box("a", 0, 1, 0, 1), box("b", 1, 2, 0, 1)), rules=(JointRule("joint", ("ground", "*")),))
    with pytest.raises(InputError, match=r"'a' and 'b'"):
        assemble(model)


@pytest.mark.parametrize(("name", "interfaces"), [("wall 1", 83), ("wall 2", 141), ("wall 3", 102)])
def test_interfaces_of_the_ferris_and_tin_loi_walls(name, interfaces):
    """Ferris and Tin-Loi (2001), Int. J. Mech. Sci. 43, 209-224, table of examples."""
    model = wall_of_courses(courses=FERRIS_TIN_LOI[name], block_size=(0.4, 0.175))
    assert len(assemble(model).detection.interfaces) == interfaces


def test_gaps_of_a_wedge_are_where_they_are():
    """A stone beside a leaning wall: 1 mm at its foot, 9 mm at its head, whichever way its edges run."""
    wall = Body("wall", np.array([(1.001, 0), (2, 0), (2, 1), (1.009, 1)], dtype=float), kind="fixed")
    for stone in (STONE, {"mesh_size": 0.3}):
        pairs = assemble(on_ground(box("stone", 0, 1, 0, 1, **stone), wall, gap_reach=0.02)).pairs
        side = np.abs(pairs.normal[:, 0]) > 0.9
        assert side.sum() >= 2
        height = pairs.point[side, 1]
        assert np.ptp(height) > 0.9
        assert pairs.gap[side] == pytest.approx(0.001 + 0.008 * height, rel=1e-4)
        assert not pairs.gap[~side].any()


@pytest.mark.parametrize(("start", "end"), [(3, 3.6), (3.4, 4)])
def test_joints_that_begin_alike_and_end_elsewhere_have_their_own_pairs(start, end):
    """Two equal stones, one on a wide base, one on a base under a part of it: same edge, same start, other lengths."""
    lines = np.linspace(0, 1, 5)
    model = model_of(
        box("wide", 0, 1, -1, 0, kind="fixed"), box("first", 0, 1, 0, 1, grid=(lines, lines)),
        box("narrow", start, end, -1, 0, kind="fixed"), box("second", 3, 4, 0, 1, grid=(3 + lines, lines)),
    )  # fmt: skip
    pairs = assemble(model).pairs
    reach = [pairs.length[pairs.interface == k].sum() for k in range(2)]
    assert reach == pytest.approx([1.0, 0.6], rel=1e-12)


def test_weighted_gaps_and_gaps_of_outlines():
    """Where meshes do not match the certificate's gap is a weighted mean; the result says how far outlines differ."""
    base, below = box("base", 0, 1, -1, 0, kind="fixed"), box("below", 0, 1, 0, 0.3, mesh_size=0.26)
    load = Load("point", (-5.0, -40.0), bodies=("above",), at=(0.5, 0.5))
    differences = []
    for size in (0.26, 0.13, 0.11, 0.055):
        above = box("above", 0, 1, 0.3, 0.5, mesh_size=size)
        result = concio.solve(model_of(base, below, above, law=0.6, loads=(weight(), load)))
        pairs, gap = result.assembly.pairs, np.zeros(len(result.assembly.pairs))
        for k in range(len(pairs)):  # by interpolation inside the linear elements, body by body
            for b, sign in ((int(pairs.body_a[k]), -1.0), (int(pairs.body_b[k]), 1.0)):
                dofs, rows = result.assembly.disc.point_operator(b, pairs.point[k])
                gap[k] += sign * pairs.normal[k] @ (rows @ result.displacement[dofs])
        away = np.abs(gap - (result.contacts.gap - pairs.gap)).max()
        largest = np.abs(result.displacement).max()
        assert result.outline_gap_difference == pytest.approx(away, abs=1e-12 * largest)
        assert result.summary()["outline_gap_difference"] == result.outline_gap_difference
        differences.append(away / largest)
    assert differences[0] <= 1e-12
    assert 1e-4 < max(differences[1:]) < 0.05
