"""What is written: names, signs, places and frames are those of the result, in the plane and in space alike.

A structure that is turned and mirrored with its loads has the same answer, turned and mirrored: scalars stay, vectors
follow. A plane structure of a thickness has the forces of its extrusion.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import concio
from concio import Body, Elastic, JointLaw, Load, Model, Rigid
from concio.analysis.result import Result
from concio.io.csv_table import write_csv
from concio.io.paraview import VECTORS, bodies_grid, contacts_grid
from concio.io.vtu import Grid
from concio.kinematics.rigid import rotation_matrix
from concio.post.result_tables import KINDS, UNITS
from samples import sample

Array = np.ndarray
LAWS = {"joint": JointLaw(0.7, normal_stiffness=1e6, tangential_stiffness=4e5)}
THICKNESS = 0.3
AXIAL = ("moment", "rotation")
"""Vectors that a mirror turns the other way."""


def stack(seed: int, *, rigid: bool) -> Model:
    """Return three blocks of random sizes on the ground, loaded along x and y; no bed joint is in the middle."""
    rng = np.random.default_rng(seed)
    left, height = np.concatenate([[0.0], rng.uniform(0.0, 0.12, 2)]), rng.uniform(0.2, 0.35, 3)
    top = np.concatenate([[0.0], np.cumsum(height)])
    blocks = [
        Body(
            f"b{k}", [(x, top[k]), (x + 0.6, top[k]), (x + 0.6, top[k + 1]), (x, top[k + 1])],
            kind="rigid" if rigid else "elastic", thickness=THICKNESS, mesh_size=None if rigid else 0.3,
        ) for k, x in enumerate(left.tolist())
    ]  # fmt: skip
    ground = Body("ground", [(-1, -1), (2, -1), (2, 0), (-1, 0)], kind="fixed", thickness=THICKNESS)
    push = rng.uniform(-0.15, 0.15)
    loads = (
        Load("weight", (push, -1.0)),
        Load("point", (0.3 * rng.uniform(-1, 1), -1.0), bodies=("b2",), at=(float(left[2]) + 0.25, float(top[3]))),
    )
    stone = Rigid(unit_weight=20.0) if rigid else Elastic(E=1e6, nu=0.2, unit_weight=20.0)
    return Model((ground, *blocks), {"block": stone}, LAWS, loads=loads)


def motion(dim: int, seed: int, mirrored: bool) -> tuple[dict, Array]:
    """Return a random turn with or without a mirror, as arguments of place and as a matrix.

    The vertical part of weights stays with the world, so that space is turned about the vertical only, and the plane
    is mirrored only.
    """
    rng = np.random.default_rng([1, seed])
    mirror = np.diag([-1.0] + [1.0] * (dim - 1)) if mirrored else np.eye(dim)
    found: dict = {"mirror": "x"} if mirrored else {}
    if dim == 2:
        return found, mirror
    angle = float(rng.uniform(20.0, 340.0))
    return {**found, "turn": angle}, rotation_matrix(np.radians(angle) * np.array([0.0, 0.0, 1.0])) @ mirror


def vectors_of(table: dict[str, Array], dim: int) -> dict[str, Array]:
    """Return the vectors of a table (n, d) by the head of their columns; "" is the place."""
    axes = "xyz"[:dim]
    heads = {name[:-1] for name in table if name[-1:] == "x" and all(name[:-1] + a in table for a in axes)}
    return {head: np.column_stack([table[head + a] for a in axes]) for head in heads - {"s_"}}


def close(a: Array, b: Array, scale: float | None = None) -> bool:
    size = float(np.nan_to_num(np.abs(b)).max(initial=0.0)) if scale is None else scale
    return bool(np.allclose(a, b, rtol=0.0, atol=1e-7 * max(size, 1e-12), equal_nan=True))


FRAMES = ("t_", "t1_", "t2_")
ALONG = ("shear_force", "eccentricity", "friction_force", "shear", "slip", "angle", "t_xy", "moment")
"""Components along tangents and axes: they follow their frame, not the structure."""


@pytest.mark.parametrize("rigid", [True, False])
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("seed", range(sample(1, 6)))
def test_tables_of_a_moved_structure_are_moved(seed: int, dim: int, rigid: bool) -> None:
    model = stack(seed, rigid=rigid)
    model = concio.extrude(model) if dim == 3 else model
    words, Q = motion(dim, seed, mirrored=dim == 2 or seed % 2 == 0)
    there, here = concio.solve(model), concio.solve(concio.place(model, **words))
    sign = np.linalg.det(Q)
    for name, table in there.tables.all().items():
        other = here.tables.all()[name]
        order, same = rows(table, Q), rows(other, np.eye(dim))
        vectors = vectors_of(table, dim)
        for head, value in vectors.items():
            if head in FRAMES:
                continue
            turned = value @ Q.T * (sign if head.rstrip("_") in AXIAL else 1.0)
            assert close(vectors_of(other, dim)[head][same], turned[order]), (name, head)
        components = {head + a for head in vectors for a in "xyz"[:dim]}
        for column in table.keys() - components:
            if column.rstrip("_12") in ALONG or column in {"s_x", "s_y", "s_z", "t_yz", "t_zx", "rotation", "torsion"}:
                continue
            a, b = table[column][order], other[column][same]
            assert (a == b).all() if a.dtype.kind in "Ubi" else close(a, b), (name, column)
    names = ("s_x", "s_y", "t_xy") if dim == 2 else ("s_x", "s_y", "s_z", "t_xy", "t_yz", "t_zx")
    tensor = [voigt(np.column_stack([r.tables.bodies()[n] for n in names]), dim) for r in (there, here)]
    assert close(tensor[1], Q @ tensor[0] @ Q.T)
    if dim == 3:
        assert close(here.tables.joints()["torsion"], sign * there.tables.joints()["torsion"], 1.0)


def rows(table: dict[str, Array], Q: Array) -> Array:
    """Return an order of rows that a motion does not change: by names, then by place."""
    axes = "xyz"[: len(Q)]
    if "x" not in table:
        return np.arange(len(next(iter(table.values()))))
    place = np.column_stack([table[a] for a in axes]) @ Q.T
    keys = [np.round(place[:, k], 6) + 0.0 for k in range(len(Q))]
    names = [np.unique(table[key], return_inverse=True)[1] for key in ("body_b", "body_a", "body") if key in table]
    return np.lexsort([*keys, *names])


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("seed", range(sample(1, 6)))
def test_components_along_the_told_tangents_make_up_the_vectors(seed: int, dim: int) -> None:
    model = stack(seed, rigid=True)
    result = concio.solve(concio.extrude(model) if dim == 3 else model)
    contacts = result.tables.contacts()
    vectors = vectors_of(contacts, dim)
    grid = contacts_grid(result).point_data
    tails = [""] if dim == 2 else ["_1", "_2"]
    told = [vectors["t_"]] if dim == 2 else [vectors["t1_"], vectors["t2_"]]
    for name, vector in VECTORS.items():
        total = sum(contacts[name + tail][:, None] * t for tail, t in zip(tails, told, strict=True))
        assert close(grid[vector], total)
        for tail, t in zip(tails, told, strict=True):
            assert (grid[f"{name}{tail}"] == contacts[f"{name}{tail}"]).all()
            assert (grid[f"tangent{tail}"] == t).all()
    assert close(grid["force"], grid["normal_force"][:, None] * grid["normal"] + grid["friction_vector"])
    for values in grid.values():
        assert values.ndim == 1 or values.shape[1] == dim  # what has two entries in space would be drawn along x and y
    joints = result.tables.joints()
    of_joint = vectors_of(joints, dim)
    force = np.zeros((len(joints["x"]), dim))
    moment = np.zeros((len(force), 1 if dim == 2 else 3))
    for k, f, p in zip(contacts["interface"], grid["force"], result.contacts.point, strict=True):
        force[k] += f
        arm = p - of_joint[""][k]
        moment[k] += np.atleast_1d(arm[0] * f[1] - arm[1] * f[0] if dim == 2 else np.cross(arm, f))
    resultant = joints["normal_force"][:, None] * of_joint["n_"] + of_joint["shear_"]
    assert close(resultant, force)
    assert close(joints["shear_size"], np.linalg.norm(of_joint["shear_"], axis=1))
    arm = of_joint["at_"] - of_joint[""]
    if dim == 2:
        assert close(of_joint["shear_"], joints["shear_force"][:, None] * of_joint["t_"])
        assert close(arm, joints["eccentricity"][:, None] * of_joint["t_"])
        assert close(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0], moment[:, 0])
        assert close(joints["moment"], moment[:, 0])
    else:
        assert close(of_joint["moment_"], moment)
        pressing = np.cross(arm, joints["normal_force"][:, None] * of_joint["n_"])
        assert close(pressing + joints["torsion"][:, None] * of_joint["n_"], moment)


@pytest.mark.parametrize("seed", range(sample(2, 12)))
def test_a_plane_structure_of_a_thickness_is_its_extrusion(seed: int) -> None:
    model = stack(seed, rigid=True)
    plane, space = concio.solve(model), concio.solve(concio.extrude(model))
    thin = concio.solve(concio.extrude(model, 1.0))
    p, s, unit = (r.tables.joints() for r in (plane, space, thin))
    for a, b in (("x", "x"), ("y", "z"), ("n_x", "n_x"), ("n_y", "n_z"), ("shear_x", "shear_x"), ("shear_y", "shear_z"),
                 ("at_x", "at_x"), ("at_y", "at_z"), ("normal_force", "normal_force"), ("shear_size", "shear_size"),
                 ("open_share", "open_share")):  # fmt: skip
        assert close(s[b], p[a], float(np.abs(p["normal_force"]).max()) if "force" in a or "shear" in a else None), a
    assert close(p["length"] * THICKNESS, s["area"])
    assert close(p["area"], s["area"])
    assert close(p["moment"], -s["moment_y"])
    assert close(s["area"], THICKNESS * unit["area"])
    assert close(s["moment_y"], p["normal_force"] * p["eccentricity"])  # the plane seen from -y, tangents turned left
    segments = plane.assembly.detection.segments
    assert close(vectors_of(p, 2)[""], np.array([0.5 * (i.start + i.end) for i in segments]))
    held = [r.tables.reactions() for r in (plane, space)]
    assert close(held[1]["force_x"], held[0]["force_x"])
    assert close(held[1]["force_z"], held[0]["force_y"])


def moved_grids(dim: int, rigid: bool, seed: int) -> tuple[Grid, Grid, Array]:
    model = stack(seed, rigid=rigid)
    model = concio.extrude(model) if dim == 3 else model
    words, Q = motion(dim, seed, mirrored=False) if dim == 3 else motion(2, seed, mirrored=True)
    there, here = concio.solve(model), concio.solve(concio.place(model, **words))
    return bodies_grid(there), bodies_grid(here), Q


def pairing(points: Array, others: Array, moved: Array, of: Array) -> Array:
    """Return for each point the number of the other one of its body at the same place with the same displacement."""
    both = np.linalg.norm(points[:, None] - others[None], axis=2) + 1e3 * (of[:, None] != moved[None])
    assert both.min(axis=1).max() < 1e-9
    return np.asarray(both.argmin(axis=1))


def body_of_points(grid: Grid) -> Array:
    of = np.zeros(len(grid.points), dtype=int)
    of[grid.connectivity] = np.repeat(grid.cell_data["body"], np.diff(np.concatenate([[0], grid.offsets])))
    return of


@pytest.mark.parametrize("rigid", [True, False])
@pytest.mark.parametrize("dim", [2, 3])
def test_bodies_for_paraview_move_with_the_structure(dim: int, rigid: bool) -> None:
    there, here, Q = moved_grids(dim, rigid, seed=4)
    number = pairing(there.points @ Q.T, here.points, body_of_points(here), body_of_points(there))
    moved = here.point_data["displacement"][number]
    assert close(moved, there.point_data["displacement"] @ Q.T)
    tensor = [voigt(g.point_data["stress"], dim) for g in (there, here)]
    assert close(tensor[1][number], Q @ tensor[0] @ Q.T)
    if not rigid:
        assert np.isfinite(tensor[0]).any()
    for name in [f"body_s_{k}" for k in range(1, dim + 1)]:
        assert close(np.sort(here.cell_data[name]), np.sort(there.cell_data[name]))


def voigt(s: Array, dim: int) -> Array:
    """Return tensors (n, d, d) of components in the order that the exports tell."""
    order = [[0, 2], [2, 1]] if dim == 2 else [[0, 3, 5], [3, 1, 4], [5, 4, 2]]
    return np.asarray(s[:, np.array(order)])


@pytest.mark.parametrize("dim", [2, 3])
def test_every_number_of_a_csv_table_has_its_unit(dim: int, tmp_path: Path) -> None:
    model = stack(3, rigid=False)
    result = concio.solve(concio.extrude(model) if dim == 3 else model)
    for name, table in result.tables.all().items():
        path = write_csv(table, tmp_path / f"{name}.csv")
        with path.open(encoding="utf-8", newline="") as file:
            heading, *lines = list(csv.reader(file))
        for k, (column, values) in enumerate(table.items()):
            if values.dtype.kind == "f":
                assert heading[k] == f"{column} [{UNITS[column]}]"
                assert column in KINDS or column == "volume"
                read = np.array([float(line[k]) if line[k] else np.nan for line in lines])
                np.testing.assert_array_equal(read, values)
            else:
                assert heading[k] == column


def glb(path: Path) -> dict[str, Array]:
    """Return the corners (n, 3) of each block in a binary glTF file, in the axes of its scene."""
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    scene, body = json.loads(data[20 : 20 + length]), data[28 + length :]
    root = scene["nodes"][scene["scenes"][0]["nodes"][0]]
    *v, w = root["rotation"]
    turn = rotation_matrix(2 * np.arctan2(np.linalg.norm(v), w) * np.array(v) / np.linalg.norm(v))
    found = {}
    for child in root["children"]:
        node = scene["nodes"][child]
        part = scene["meshes"][node["mesh"]]["primitives"][0]["attributes"]["POSITION"]
        view = scene["bufferViews"][scene["accessors"][part]["bufferView"]]
        values = np.frombuffer(body, "<f4", view["byteLength"] // 4, view["byteOffset"]).reshape(-1, 3)
        found[node["name"]] = (values + node["translation"]) @ turn.T
    return found


@pytest.mark.parametrize("rigid", [True, False])
def test_solids_are_written_where_the_result_has_them(rigid: bool, tmp_path: Path) -> None:
    """The corners of displaced blocks in glTF and DXF are those of the result; glTF has y upwards, right-handed."""
    result: Result = concio.solve(concio.extrude(stack(5, rigid=rigid)))
    scale = 0.1 / float(np.abs(result.displacement).max())
    for end in ("glb", "dxf"):
        concio.write_solids(tmp_path / f"all.{end}", result, scale=scale)
    scene = glb(tmp_path / "all.glb")
    ezdxf = pytest.importorskip("ezdxf")
    meshes = [np.array(e.vertices) for e in ezdxf.readfile(tmp_path / "all.dxf").modelspace().query("MESH")]
    assert len(meshes) == len(result.model.bodies)
    for b, body in enumerate(result.model.bodies):
        moved = result.nodes(b) + scale * result.node_displacement(b)
        low, high = moved.min(axis=0), moved.max(axis=0)
        corners = scene[body.name]
        back = np.column_stack([corners[:, 0], -corners[:, 2], corners[:, 1]])
        assert np.abs(np.array([back.min(axis=0) - low, back.max(axis=0) - high])).max() < 1e-6
        assert np.abs(np.array([meshes[b].min(axis=0) - low, meshes[b].max(axis=0) - high])).max() < 1e-9


def test_a_joint_that_carries_nothing_has_its_resultant_in_the_middle() -> None:
    """Rounding of forces that are none is not a centre of pressure: blocks side by side, joined and not pressed."""
    ground = Body("ground", [(-1, -1), (2, -1), (2, 0), (-1, 0)], kind="fixed")
    corners = np.array([(0.0, 0.0), (0.4, 0.0), (0.4, 0.3), (0.0, 0.3)])
    blocks = [Body(f"b{k}", corners + np.array([0.4 * k, 0.0]), kind="rigid") for k in range(2)]
    law = JointLaw(1.0, cohesion=100.0, tensile_strength=100.0, normal_stiffness=1e6, tangential_stiffness=4e5)
    weight = Load("weight", (0.0, -1.0))
    model = Model((ground, *blocks), {"block": Rigid(unit_weight=20.0)}, {"joint": law}, loads=(weight,))
    plane, space = concio.solve(model), concio.solve(concio.place(concio.extrude(model), turn=31.0))
    empty = np.isnan(plane.joints.eccentricity)
    assert empty.sum() == 1
    resultants = space.joints_in_space
    lost = np.abs(resultants.N) < 1e-9
    assert lost.sum() == 1
    assert (plane.joints.point[empty] == plane.joints.middle[empty]).all()
    assert (resultants.point[lost] == resultants.middle[lost]).all()


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_cells_of_a_volume_say_of_which_face_they_are_and_elements_of_none(kind: str) -> None:
    """Triangles of a rigid block lie in the plane of the face whose number they have; the ground is drawn likewise."""
    ground = concio.Polyhedron.box("ground", (-1, -1, -1), (2, 2, 0), kind="fixed")
    block = concio.Polyhedron.box("b", (0, 0, 0), (1, 1, 1), kind=kind, mesh_size=None if kind == "rigid" else 1.0)
    stone = Rigid(unit_weight=20.0) if kind == "rigid" else Elastic(E=1e6, nu=0.2, unit_weight=20.0)
    model = Model((ground, block), {"block": stone}, LAWS, loads=(Load("weight", (0, 0, -1)),))
    grid = bodies_grid(concio.solve(model))
    ends = np.cumsum(np.diff(grid.offsets, prepend=0))
    for k, (end, face, body) in enumerate(zip(ends, grid.cell_data["face"], grid.cell_data["body"], strict=True)):
        if body == 1 and kind == "elastic":
            assert face == -1
            continue
        own = model.bodies[body]
        corners = grid.points[grid.connectivity[(ends[k - 1] if k else 0) : end]]
        assert len(corners) == 3
        assert corners @ own.normals[face] == pytest.approx(np.full(3, own.offsets[face]), abs=1e-12)
