"""Plane models swept into space: the same interfaces, forces and motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as sla

import concio
from concio import Elastic, InputError, JointLaw, Load, Model, Rigid, Support, Tie
from concio.contact.assembly import Assembly
from concio.kinematics.frames import turned_left
from concio.model.stages import ControlPoint, Stage

T = 0.37

MODELS = {
    "wall": lambda: concio.wall(length=1.5, height=1.0, block="rigid", horizontal=0.1, top_pressure=5.0),
    "arch": lambda: concio.arch(span=4, ring=0.5, voussoirs=9, block="rigid", crown_load=3.0, load_at=0.3),
    "flemish wall with a window": lambda: concio.wall(
        length=2, height=1.25, bond="flemish", block="rigid",
        openings=[{"x": 0.6, "y": 0.2, "width": 0.5, "height": 0.5}],
    ),
    "buttress": lambda: concio.buttress(base=1.2, top=0.5, height=2, courses=6, block_length=0.4, thrust=4.0,
                                        block="rigid"),
    "rubble": lambda: concio.rubble(length=1.5, height=1.0, stone=0.3, block="rigid", seed=3),
}  # fmt: skip


@pytest.mark.parametrize("name", list(MODELS))
def test_the_interfaces_are_those_of_the_plane(name: str) -> None:
    plane = MODELS[name]()
    space = concio.extrude(plane, T)
    a, b = concio.assemble(plane), concio.assemble(space)
    assert [(i.a, i.b) for i in a.detection.segments] == [(i.a, i.b) for i in b.detection.patches]
    for i, j in zip(a.detection.segments, b.detection.patches, strict=True):
        assert j.area == pytest.approx(T * i.length, rel=1e-9)
        assert np.allclose(j.normal, (i.normal[0], 0, i.normal[1]), atol=1e-9)
    for p, s in zip(plane.outlines, space.polyhedra, strict=True):
        assert s.volume == pytest.approx(T * p.area, rel=1e-12)
        assert np.allclose(s.centroid, (p.centroid[0], 0, p.centroid[1]), atol=1e-12)


def resultants(assembly: Assembly, group: str) -> dict[str, np.ndarray]:
    """Force and moment about the origin of each rigid body, (x, vertical, moment) in the sense of the plane."""
    disc, d = assembly.disc, assembly.model.dim
    found = {}
    for b, body in enumerate(assembly.model.bodies):
        own = assembly.loads[group][disc.offsets[b] : disc.offsets[b + 1]]
        if not own.size:
            continue
        force, c = own[:d], disc.centroids[b]
        if d == 2:
            found[body.name] = np.array([*force, own[2] * disc.reach[b] + turned_left(c) @ force])
        else:
            moment = own[3:] * disc.reach[b] + np.cross(c, force)
            assert np.allclose(moment[[0, 2]], 0, atol=1e-12)
            assert abs(force[1]) < 1e-12
            found[body.name] = np.array([force[0], force[2], -moment[1]])
    return found


@pytest.mark.parametrize("name", list(MODELS))
def test_the_forces_are_those_of_the_plane_wherever_thickness_is_in_them(name: str) -> None:
    plane = MODELS[name]()
    thick = concio.extrude(plane)
    a, b = concio.assemble(plane), concio.assemble(thick)
    assert a.loads.keys() == b.loads.keys()
    for group in a.loads:
        one, other = resultants(a, group), resultants(b, group)
        assert one.keys() == other.keys()
        for body, force in one.items():
            assert np.allclose(other[body], force, atol=1e-10), (group, body)


def test_supports_ties_and_stages_go_along() -> None:
    block = concio.Body("a", np.array([[0, 0], [2, 0], [2, 1], [0, 1]]), "rock", "rigid", thickness=T)
    plane = Model(
        (block,), {"rock": Rigid(20.0)}, {"joint": JointLaw(0.6)},
        supports=(
            Support("foot", "a", ((0, 0), (1, 0)), displacement=(0.01, -0.02), rotation=0.03),
            Support("roller", "a", ((2, 0), (2, 0)), directions="y"),
        ),
        ties=(Tie("rod", "a", (2, 1), "", (5, 5), 100.0, 3.0),),
        loads=(Load("weight", (0.1, -1.0)), Load("point", (2.0, 3.0), ("a",), at=(1.5, 1.0), group="live")),
        stages=(Stage("push", {"live": 2.0}, ControlPoint("a", (2, 1), (0, -1)), until=0.1),),
    )  # fmt: skip
    space = concio.extrude(plane)
    foot, roller = space.supports
    assert foot.directions == "xyz"
    assert foot.displacement == (0.01, 0.0, -0.02)
    assert foot.rotation == (0.0, -0.03, 0.0)
    assert {p[1] for p in foot.polygon or ()} == {-T / 2, T / 2}
    assert roller.directions == "z"
    assert roller.edge == ((2.0, -T / 2, 0.0), (2.0, T / 2, 0.0))
    assert space.ties[0].at_b == (5.0, 0.0, 5.0)
    control = space.stages[0].control
    assert control is not None
    assert (control.at, control.direction) == ((2.0, 0.0, 1.0), (0.0, 0.0, -1.0))
    for group in ("dead", "live"):
        free = replace(plane, supports=(Support("pin", "a", ((0, 0), (0, 0)), directions="x"),))
        one, other = (resultants(concio.assemble(m), group)["a"] for m in (free, concio.extrude(free)))
        assert np.allclose(one, other, atol=1e-12)


def test_a_rotation_of_the_plane_moves_points_as_in_the_plane() -> None:
    plane = concio.column(width=1, height=2, blocks=2, block="rigid")
    plane = Model(plane.bodies, plane.materials, plane.laws,
                  supports=(Support("s", "ground", displacement=(0.1, 0.2), rotation=0.3),))  # fmt: skip
    a, b = concio.assemble(plane), concio.assemble(concio.extrude(plane))
    (n2, t2), (n3, t3) = a.moved["settlement"], b.moved["settlement"]
    at = {(round(x, 9), round(y, 9)): k for k, (x, y) in enumerate(a.pairs.point)}
    for k, point in enumerate(b.pairs.point):
        other = at[round(point[0], 9), round(point[2], 9)]
        assert n3[k] == pytest.approx(n2[other], abs=1e-14)
        along = t3[k] @ b.pairs.tangents[k]
        assert np.allclose(along, t2[other, 0] * np.array([a.pairs.tangent[other][0], 0, a.pairs.tangent[other][1]]))


@pytest.mark.long  # blocks of one element and rigid ones
def test_plane_strain_of_elastic_blocks() -> None:
    """With all joints stuck, held faces and the same lines in the plane, nodes move as those of the plane do."""
    plane = concio.wall(length=0.5, height=0.25, block=Elastic(1e5, 0.2, 20.0), plane="strain", horizontal=0.2)
    space = concio.extrude(plane, 1.0, held=True)
    found = []
    for model in (plane, space):
        assembly = concio.assemble(model)
        problem = assembly.problem()
        stiff = sp.diags_array(np.tile(1e10 * problem.area, model.dim))
        C = sp.vstack([problem.C_n, *(problem.C_t[k :: model.dim - 1] for k in range(model.dim - 1))])
        stuck = C.T @ stiff @ C
        u = assembly.displacement(sla.spsolve((problem.K + stuck).tocsc(), problem.f))
        found.append((assembly, u))
    (a, u), (b, v) = found
    for k, body in enumerate(plane.bodies):
        if body.kind == "fixed":
            continue
        flat, solid = a.disc.nodes(k), b.disc.nodes(k)
        own = u[a.disc.offsets[k] : a.disc.offsets[k + 1]].reshape(-1, 2)
        other = v[b.disc.offsets[k] : b.disc.offsets[k + 1]].reshape(-1, 3)
        near = np.argmin(np.linalg.norm(solid[:, None, [0, 2]] - flat, axis=2), axis=1)
        assert np.allclose(solid[:, [0, 2]], flat[near], atol=1e-12)
        assert np.abs(other[:, [0, 2]] - own[near]).max() <= 1e-7 * np.abs(u).max()
        assert np.abs(other[:, 1]).max() <= 1e-10 * np.abs(u).max()  # rounding of the stiff joints


def test_what_cannot_be_extruded() -> None:
    solid = concio.extrude(concio.column(width=1, height=2, blocks=2), 0.5)
    with pytest.raises(InputError, match="this is for models in the plane"):
        concio.extrude(solid)
    with pytest.raises(InputError, match="a periodic cell is plane"):
        concio.extrude(concio.cell())
    with pytest.raises(InputError, match="thickness = -1"):
        concio.extrude(concio.column(width=1, height=2, blocks=2), -1.0)


def test_where_nothing_holds_a_block_only_its_place_is_open() -> None:
    """Frictionless: any place along the joints is an equilibrium, and what each block chose is apart from the rest."""
    size = {"width": 0.4, "height": 0.6, "blocks": 2, "mesh_size": 0.25}
    plane = concio.column(plane="strain", friction=0.0, element="Q9", **size)
    flat, solid = concio.solve(plane), concio.solve(concio.extrude(plane, 0.3, held=True))
    largest = np.abs(flat.displacement).max()
    for b, body in enumerate(plane.bodies):
        if body.kind == "fixed":
            continue
        at, x = flat.nodes(b), solid.nodes(b)[:, [0, 2]]
        near = np.argmin(np.linalg.norm(x[:, None] - at, axis=2), axis=1)
        apart = solid.node_displacement(b)[:, [0, 2]] - flat.node_displacement(b)[near]
        assert np.abs(apart - [apart[:, 0].mean(), 0.0]).max() < 1e-12 * largest
