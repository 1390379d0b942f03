"""From a model in space to its contact problem: frames, areas, rigid operators, loads, supports, ties, patch tests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

import concio
from concio import Elastic, GeometryError, InputError, JointLaw, Load, Model, Polyhedron, Rigid, Support, Tie
from concio.analysis.stress import Stress
from concio.contact.assembly import Assembly
from concio.contact.patch_points import corner_points, spread_points
from concio.fem.constitutive import principal_in_space, solid_matrix
from concio.fem.elements import SOLID_FAMILIES
from concio.fem.tetrahedra import GOOD, _lattice, shape_of, tetrahedra
from concio.kinematics.frames import tangents
from concio.model.interfaces.patch import Patch
from concio.model.surfaces import from_grid
from samples import first, sample
from solids import TURN, box, frame_block, l_block, turned

STONE = Elastic(1e6, 0.25, 22.0)
GROUND = box("ground", (-5, -5, -1), (5, 5, 0), kind="fixed")


def model(*blocks: Polyhedron, **fields: object) -> Model:
    laws = {"joint": fields.pop("law", JointLaw(0.6))}
    return Model(blocks, {"block": STONE, "rock": Rigid(22.0)}, laws, **fields)  # type: ignore[arg-type]


def rigid(name: str, low: tuple[float, ...], high: tuple[float, ...]) -> Polyhedron:
    return box(name, low, high, kind="rigid", material="rock")


def polygon(*flat: tuple[float, float], holes: tuple[np.ndarray, ...] = ()) -> Patch:
    points = np.column_stack([np.array(flat), np.zeros(len(flat))])
    rings = tuple(np.column_stack([h, np.zeros(len(h))]) for h in holes)
    area = shapely.Polygon(points[:, :2], list(holes)).area
    zero = np.zeros(len(points))
    return Patch(0, 1, 0, 0, points, np.array([0, 0, 1.0]), zero, zero, area, rings)


HOLE = np.array([[1, 1], [1, 2], [2.5, 2], [2.5, 1]], dtype=float)
PATCHES = [
    polygon((0, 0), (2, 0), (2, 1), (0, 1)),
    polygon((0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)),
    polygon((0, 0), (1, 0), (0, 2)),
    polygon((0, 0), (2, 0), (3, 1), (1, 3), (-1, 1)),
    polygon((0, 0), (3, 0), (3, 4), (0, 3), holes=(HOLE,)),
]


def test_corners_share_the_area_and_keep_its_centroid() -> None:
    points, share, count = corner_points(PATCHES)
    ends = np.cumsum(count)[:-1]
    for patch, x, w in zip(PATCHES, np.split(points, ends), np.split(share, ends), strict=True):
        assert (w > 0).all()
        assert w.sum() == pytest.approx(patch.area, rel=1e-13)
        assert np.allclose(w @ x / w.sum(), patch.middle, atol=1e-13)
    assert share[:4].tolist() == pytest.approx([0.5] * 4)


@pytest.mark.parametrize("size", [2.0**-12, 2.0**12])
def test_points_and_shares_of_a_patch_are_the_same_at_any_size(size: float) -> None:
    """Lengths go with the size, areas with its square; a power of two changes no digit."""

    def sized(patch: Patch) -> Patch:
        holes = tuple(size * hole for hole in patch.holes)
        return replace(patch, polygon=size * patch.polygon, holes=holes, area=size**2 * patch.area)

    large = [sized(patch) for patch in PATCHES]
    for a, b, power in zip(corner_points(PATCHES), corner_points(large), (1, 2, 0), strict=True):
        assert np.abs(size**power * a - b).max() <= 1e-14 * np.abs(b).max()
    for patch, other in zip(PATCHES, large, strict=True):
        for graded in (False, True):
            x, w = spread_points(patch, 8, graded=graded)
            y, v = spread_points(other, 8, graded=graded)
            assert np.abs(size * x - y).max() <= 1e-13 * np.abs(y).max()
            assert np.abs(size**2 * w - v).max() <= 1e-12 * v.max()


@pytest.mark.parametrize("n", [2, 3, 4, 6])
def test_points_over_a_patch_integrate_linear_pressures(n: int) -> None:
    for patch in PATCHES:
        x, w = spread_points(patch, n)
        assert (w > 0).all()
        assert w.sum() == pytest.approx(patch.area, rel=1e-13)
        assert np.allclose(w @ x / w.sum(), patch.middle, atol=1e-12)


def test_points_over_a_square_carry_the_torsion_of_uniform_pressure() -> None:
    square = polygon((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
    exact = (np.sqrt(2) + np.log(1 + np.sqrt(2))) / 6

    def torsion(points: np.ndarray, weights: np.ndarray) -> float:
        return float(weights @ np.linalg.norm(points, axis=1))

    assert exact == pytest.approx(0.382598, abs=1e-6)
    assert torsion(*spread_points(square, 4)) == pytest.approx(exact, rel=0.025)
    assert torsion(*spread_points(square, 12)) == pytest.approx(exact, rel=0.002)
    x, w, _ = corner_points([square])
    assert torsion(x, w) == pytest.approx(1 / np.sqrt(2))


def test_second_moments_of_points_over_a_rectangle_are_exact() -> None:
    x, w = spread_points(polygon((0, 0), (2, 0), (2, 1), (0, 1)), 4)
    arm = x - [1, 0.5, 0]
    assert w @ arm[:, 0] ** 2 == pytest.approx(8 / 12)
    assert w @ arm[:, 1] ** 2 == pytest.approx(2 / 12)
    assert w @ (arm[:, 0] * arm[:, 1]) == pytest.approx(0.0, abs=1e-15)


def test_rigid_blocks_by_hand() -> None:
    assembly = concio.assemble(model(GROUND, rigid("a", (0, 0, 0), (2, 1, 1)), rigid("b", (1, 0, 1), (3, 1, 2)),
                                     loads=(Load("weight", (0, 0, -1)),)))  # fmt: skip
    problem = assembly.problem()
    assert (problem.dim, problem.pairs, problem.unknowns, problem.rigid_motions) == (3, 8, 12, 12)
    assert assembly.pairs.contact_model == {"corners of the patch": 8}
    assert assembly.pairs.area.tolist() == pytest.approx([0.5] * 4 + [0.25] * 4)
    assert problem.f[[2, 8]].tolist() == pytest.approx([-44.0, -44.0])
    # b falls by 0.1, moves by 0.2 along x and turns by 0.3 about y
    reach = assembly.disc.reach[2]
    u = np.concatenate([np.zeros(6), [0.2, 0, -0.1, 0, 0.3 * reach, 0]])
    upper = assembly.pairs.interface == 1
    arm = assembly.pairs.point[upper] - assembly.disc.centroids[2]
    moved = np.array([0.2, 0, -0.1]) + np.cross([0, 0.3, 0], arm)
    assert np.allclose((problem.C_n @ u)[upper], moved[:, 2])
    slip = (problem.C_t @ u).reshape(-1, 2)[upper]
    assert np.allclose(np.einsum("mt,mtd->md", slip, assembly.pairs.tangents[upper]), moved * [1, 1, 0])


def test_frames_are_right_handed_and_point_from_a_to_b() -> None:
    blocks = [turned(b) for b in (GROUND, rigid("a", (0, 0, 0), (2, 1, 1)), rigid("b", (2, 0, 0), (3, 1, 2)))]
    pairs = concio.assemble(model(*blocks)).pairs
    t1, t2 = pairs.tangents[:, 0], pairs.tangents[:, 1]
    assert np.allclose(np.cross(t1, t2), pairs.normal, atol=1e-14)
    assert np.allclose(np.linalg.norm(t1, axis=1), 1)
    expected = np.array([[0, 0, 1.0], [0, 0, 1], [1, 0, 0]]) @ TURN.T
    assert np.allclose(pairs.normal, np.repeat(expected, 4, axis=0), atol=1e-13)


def test_the_choice_of_contact_points_is_stated() -> None:
    blocks = (GROUND, rigid("a", (0, 0, 0), (2, 1, 1)))
    for choice, law, name, number in (
        ("auto", JointLaw(0.6), "corners of the patch", 4),
        ("auto", JointLaw(0.6, normal_stiffness=1e6), "points over the patch", 16),
        ("auto", JointLaw(0.6, compressive_strength=1e3), "points over the patch", 196),
        ("corners", JointLaw(0.6, normal_stiffness=1e6), "corners of the patch", 4),
        (5, JointLaw(0.6), "points over the patch", 25),
    ):
        pairs = concio.assemble(model(*blocks, law=law, contact_points=choice)).pairs
        assert pairs.contact_model == {name: number}
        assert pairs.area.sum() == pytest.approx(2.0)
    with pytest.raises(InputError, match="contact_points = 'middle'"):
        model(*blocks, contact_points="middle")


LONG = box("a", (0, 0, 0), (1, 1, 1), mesh_size=0.5)
OTHER = box("b", (0, 0, 1), (1, 1, 2), mesh_size=0.35)
ASKEW = Polyhedron(
    "b", (OTHER.vertices - [0.5, 0.5, 0]) @ np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]]) + [0.5, 0.5, 0],
    OTHER.faces, mesh_size=0.35,
)  # fmt: skip
PAIRS = {
    "same mesh": (LONG, box("b", (0, 0, 1), (1, 1, 2), mesh_size=0.5)),
    "finer above": (LONG, OTHER),
    "shifted": (LONG, box("b", (0.3, 0.2, 1), (1.3, 1.2, 2), mesh_size=0.35)),
    "askew": (LONG, ASKEW),
    "not convex": (l_block("a", mesh_size=0.6), box("b", (0.2, 0.1, 1), (1.7, 1.6, 2), mesh_size=0.4)),
    "with a hole": (frame_block("a", mesh_size=0.8), box("b", (0.2, 0.1, 1), (2.7, 1.6, 2), mesh_size=0.6)),
}


@pytest.mark.parametrize("element", first(2, list(SOLID_FAMILIES)))
@pytest.mark.parametrize("name", list(PAIRS))
def test_a_uniform_stress_passes_through_any_two_meshes(name: str, element: str) -> None:
    """Every component of stress at once, the whole turned: relative displacements and all nodal forces vanish."""
    stress = np.array([3.0, -2.0, 5.0, 1.2, -0.7, 0.4])
    strain = np.linalg.solve(solid_matrix(STONE), stress)
    index = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
    E, S = strain[index] * (0.5 + 0.5 * np.eye(3)), stress[index]
    blocks = [turned(b) for b in PAIRS[name]]
    assembly = concio.assemble(
        model(*blocks, box("far", (50, 50, 50), (51, 51, 51), kind="fixed"), element=element, gap_tolerance=1e-6)
    )
    pairs, disc = assembly.pairs, assembly.disc
    assert ("node pairs" in pairs.contact_model) == (name == "same mesh" and element != "T10")
    u = np.concatenate([(disc.nodes(b) @ E).ravel() for b in (0, 1)])
    size = np.abs(u).max()
    assert np.abs(pairs.C_n @ u).max() <= 1e-12 * size
    assert np.abs(pairs.C_t @ u).max() <= 1e-12 * size
    force = -(pairs.normal @ S) * pairs.area[:, None]
    t_n = (force * pairs.normal).sum(1)
    t_t = np.einsum("md,mtd->mt", force, pairs.tangents).ravel()
    rest = assembly.K @ u - pairs.C_n.T @ t_n - pairs.C_t.T @ t_t - free_surface(assembly, S)
    assert np.abs(rest).max() <= 1e-11 * np.abs(force).max()
    nodal = Stress(disc, u).at_nodes(0)
    assert np.allclose(nodal, stress, atol=1e-9)


def free_surface(assembly: Assembly, S: np.ndarray) -> np.ndarray:
    """Nodal forces of the traction S n on all that no patch covers."""
    disc, f = assembly.disc, np.zeros(assembly.disc.unknowns)
    for b in (0, 1):
        body = assembly.model.polyhedra[b]
        for face, normal in enumerate(body.normals):
            axes, origin = tangents(normal), body.vertices[body.faces[face][0]]
            rings = [(body.vertices[list(loop)] - origin) @ axes.T for loop in body.loops_of(face)]
            shape = shapely.Polygon(rings[0], rings[1:])
            for p in assembly.detection.patches:
                if (b, face) in ((p.a, p.face_a), (p.b, p.face_b)):
                    holes = [(h - origin) @ axes.T for h in p.holes]
                    shape = shape.difference(shapely.Polygon((p.polygon - origin) @ axes.T, holes))
            if shape.area > 1e-9:
                nodes, weights = disc.shapes[disc.shape_of[b]].face_weights(face, shape, origin - disc.origins[b], axes)
                np.add.at(f, disc.offsets[b] + 3 * nodes[:, None] + np.arange(3), np.outer(weights, S @ normal))
    return f


@pytest.mark.long
@pytest.mark.parametrize("element", first(1, ["T10", "H27"]))
def test_quadratic_blocks_of_a_corner_meet_pair_by_pair(element: str) -> None:
    """Each node of the finer side enters hardly more than its own pair; with linear weights no method found an end."""
    lines = [((0, 0), (0, 1)), ((0, 0), (1, 0))]
    wall = concio.walls(
        lines=lines, height=0.5, block_size=(0.5, 0.25, 0.25), friction=0.5, element=element, horizontal=1.0,
        towards=(-1, 0),
    )  # fmt: skip
    result = concio.solve(wall, method="interior-point", factors={"live": 0.2})
    assert result.status is concio.Status.SOLVED
    pairs = result.assembly.pairs
    ground = pairs.C_n[np.flatnonzero(pairs.body_a == pairs.body_a.min())]
    assert np.asarray((ground > 1e-9).sum(axis=1) == 1).all()


def test_matching_blocks_of_a_bond_share_their_nodes() -> None:
    blocks = [box("a", (0, 0, 0), (2, 1, 1)), box("b", (2, 0, 0), (4, 1, 1)), box("c", (1, 0, 1), (3, 1, 2))]
    pairs = concio.assemble(model(GROUND, *blocks)).pairs
    above = pairs.interface >= 3
    assert {name for name, n in pairs.contact_model.items() if n} == {"node pairs", "dual mortar"}
    assert (pairs.rule[above] == 2).all()
    assert pairs.area.sum() == pytest.approx(4 + 1 + 2)


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
@pytest.mark.parametrize("element", ["H8I", "T10"])
def test_loads_have_their_resultants(kind: str, element: str) -> None:
    block = box("a", (0, 0, 0), (2, 1, 1), kind=kind, material="rock" if kind == "rigid" else "block")
    top = ((0.5, 0.25, 1), (1.5, 0.25, 1), (1.5, 1, 1), (0.5, 1, 1))
    loads = (
        Load("weight", (0, 0.1, -1), group="w"),
        Load("body", (1, 2, 3), group="b"),
        Load("pressure", (8.0,), polygon=top, group="p"),
        Load("traction", (1, -2, 0.5), polygon=top, group="t"),
        Load("point", (4, 5, 6), bodies=("a",), at=(0.3, 0.6, 1), group="f"),
    )
    wanted = {
        "w": ((0, 4.4, -44), (1, 0.5, 0.5)), "b": ((2, 4, 6), (1, 0.5, 0.5)), "p": ((0, 0, -6), (1, 0.625, 1)),
        "t": ((0.75, -1.5, 0.375), (1, 0.625, 1)), "f": ((4, 5, 6), (0.3, 0.6, 1)),
    }  # fmt: skip
    assembly = concio.assemble(model(GROUND, block, loads=loads, element=element))
    disc = assembly.disc
    for group, (force, at) in wanted.items():
        f = assembly.loads[group]
        if kind == "rigid":
            total = f[:3]
            moment = f[3:] * disc.reach[1] + np.cross(disc.centroids[1], total)
        else:
            nodal = f.reshape(-1, 3)
            total, moment = nodal.sum(0), np.cross(disc.nodes(1), nodal).sum(0)
        assert np.allclose(total, force, atol=1e-11), group
        assert np.allclose(moment, np.cross(at, force), atol=1e-10), group


def test_loads_that_cannot_be_are_refused() -> None:
    block = rigid("a", (0, 0, 0), (2, 1, 1))
    off = ((0, 0, 3), (1, 0, 3), (1, 1, 3))
    bent = ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1.2))
    for load, words in (
        (Load("pressure", (8.0,)), "needs a polygon"),
        (Load("pressure", (8.0,), polygon=off), r"on the polygon from \(0, 0, 3\) lies on no face"),
        (Load("pressure", (8.0,), polygon=bent), "not planar: a vertex stands 50.48 mm"),
        (Load("traction", (1, 2), polygon=off), "takes three components"),
        (Load("pressure", (8.0,), polygon=((0, 0, 1), (1, 1, 1), (1, 0, 1), (0, 1, 1))), "crosses itself"),
    ):
        with pytest.raises(InputError, match=words):
            concio.assemble(model(GROUND, block, loads=(load,)))


def test_supports_move_in_six_ways() -> None:
    block = rigid("a", (0, 0, 0), (2, 1, 1))
    support = Support("jack", "ground", displacement=(0.01, 0.02, 0.03), rotation=(0.1, 0.2, 0.3))
    assembly = concio.assemble(model(GROUND, block, supports=(support,)))
    pairs = assembly.pairs
    normal, tangential = assembly.moved["settlement"]
    moved = np.array([0.01, 0.02, 0.03]) + np.cross([0.1, 0.2, 0.3], pairs.point - GROUND.centroid)
    assert np.allclose(normal, -moved[:, 2])
    assert np.allclose(np.einsum("mt,mtd->md", tangential, pairs.tangents), -moved * [1, 1, 0], atol=1e-15)
    problem = assembly.problem({"settlement": 2.0})
    assert np.allclose(problem.gap, 2 * normal)
    assert np.allclose(problem.slip_origin, -2 * tangential)


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_a_held_face_imposes_its_motion(kind: str) -> None:
    block = box("a", (0, 0, 0), (2, 1, 1), kind=kind, material="rock" if kind == "rigid" else "block")
    top = ((0, 0, 1), (2, 0, 1), (2, 1, 1), (0, 1, 1))
    support = Support("jack", "a", polygon=top, displacement=(0.01, 0.0, 0.03), rotation=(0, 0, 0.2))
    assembly = concio.assemble(model(GROUND, block, supports=(support,)))
    u = assembly.imposed()
    dofs, rows = assembly.disc.point_operator(1, np.array([2.0, 1.0, 1.0]))
    assert np.allclose(rows @ u[dofs], np.array([0.01, 0, 0.03]) + np.cross([0, 0, 0.2], [1, 0.5, 0.5]))
    assert assembly.supported.R.shape[1] == 0
    roller = Support("roller", "a", polygon=top, directions="z")
    held = concio.assemble(model(GROUND, block, supports=(roller,)))
    assert held.supported.R.shape[1] == 3


def test_ties_pull_along_their_line() -> None:
    block = rigid("a", (0, 0, 0), (2, 1, 1))
    tie = Tie("rod", "a", (2, 0.5, 1), "", (5, 4.5, 1), stiffness=500.0, prestress=10.0)
    assembly = concio.assemble(model(GROUND, block, ties=(tie,)))
    pairs = assembly.pairs
    assert pairs.contact_model == {"corners of the patch": 4, "tie": 1}
    assert np.allclose(pairs.normal[-1], [-0.6, -0.8, 0])
    assert pairs.gap[-1] == pytest.approx(-10 / 500)
    stretch = pairs.C_n[[4]] @ np.concatenate([[-0.3, -0.4, 0.7], np.zeros(3)])
    assert stretch == pytest.approx([-0.5])
    assert pairs.C_t.shape == (10, 6)


def test_what_does_not_fit_the_dimension_is_told() -> None:
    block = rigid("a", (0, 0, 0), (2, 1, 1))
    plane = concio.Body("p", np.array([[0, 0], [1, 0], [1, 1]]), kind="fixed")
    for words, build in (
        ("'ground' is in space, 'p' in the plane", lambda: model(GROUND, plane)),
        (r"displacement = \[0.1, 0.2\]: 3 numbers expected", lambda: model(
            GROUND, block, supports=(Support("s", "a", displacement=(0.1, 0.2)),))),
        (r"rotation = \[0.1\]: 3 numbers expected", lambda: model(
            GROUND, block, supports=(Support("s", "a", rotation=0.1),))),
        (r"at = \[1.0, 2.0\]: 3 numbers expected", lambda: model(
            GROUND, block, loads=(Load("point", (1, 2, 3), bodies=("a",), at=(1.0, 2.0)),))),
        ("unknown element 'Q8' for a model in space", lambda: model(GROUND, block, element="Q8")),
        ("this is for models in the plane; the model is in space", lambda: model(GROUND, block).outlines),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            build()


def test_principal_stresses_and_their_directions() -> None:
    values, directions = principal_in_space(np.array([[3.0, -2.0, 5.0, 1.2, -0.7, 0.4], [np.nan] * 6]))
    tensor = np.array([[3, 1.2, 0.4], [1.2, -2, -0.7], [0.4, -0.7, 5]])
    assert (np.diff(values[0]) <= 0).all()
    for s, n in zip(values[0], directions[0], strict=True):
        assert np.allclose(tensor @ n, s * n)
    assert np.isnan(values[1]).all()


def test_a_fine_grid_is_meshed_as_it_is() -> None:
    """The size of the mesh is judged by the nodes of the grid, and its faces find their marks."""
    x = np.linspace(0.0, 1.0, 11)
    block = from_grid("a", np.stack(np.meshgrid(x, x, x, indexing="ij"), -1))
    assembly = concio.assemble(model(GROUND, block, mesh_size=1.0))
    assert assembly.disc.unknowns == 3 * 11**3
    assert len(assembly.pairs) == 11**2


def test_a_load_along_a_line_is_shared_by_the_nodes_on_it() -> None:
    """Three linear elements of one length: a sixth, two thirds and a sixth of each length's load, node by node."""
    block = box("a", (0, 0, 0), (3, 1, 1), mesh_size=1.0)
    load = Load("traction", (0.0, 0.0, -7.0), edge=((0, 0, 1), (3, 0, 1)), bodies=("a",))
    assembly = concio.assemble(model(GROUND, block, loads=(load,), element="H8"))
    nodes, force = assembly.disc.nodes(1), assembly.load().reshape(-1, 3)
    on = np.flatnonzero((nodes[:, 1] == 0) & (nodes[:, 2] == 1))
    on = on[np.argsort(nodes[on, 0])]
    assert nodes[on, 0] == pytest.approx([0, 1, 2, 3])
    assert force[on, 2] == pytest.approx([-3.5, -7.0, -7.0, -3.5])
    assert force.sum(0) == pytest.approx([0, 0, -21.0])


@pytest.mark.parametrize(("first", "last"), [(0.4, 2.3), (0.2, 0.9), (1.0, 2.0)])
def test_a_load_along_a_part_of_an_edge_has_its_total_and_its_middle(first: float, last: float) -> None:
    """Nodes before and behind the line are no marks of it."""
    block = box("a", (0, 0, 0), (3, 1, 1), mesh_size=1.0)
    load = Load("traction", (0.0, 0.0, -7.0), edge=((first, 0, 1), (last, 0, 1)), bodies=("a",))
    assembly = concio.assemble(model(GROUND, block, loads=(load,), element="H8"))
    nodes, force = assembly.disc.nodes(1), assembly.load().reshape(-1, 3)
    assert force.sum(0) == pytest.approx([0, 0, -7.0 * (last - first)])
    assert force[:, 2] @ nodes == pytest.approx(-7.0 * (last - first) * np.array([0.5 * (first + last), 0, 1]))


@pytest.mark.parametrize(("block", "size"), [(frame_block("f"), 0.6), (l_block("l"), 0.35)])
def test_slivers_of_a_mesh_of_tetrahedra_are_taken_away(block: Polyhedron, size: float) -> None:
    """The points of these meshes alone leave flat tetrahedra; moved a little, they leave none."""
    points, cells = tetrahedra(block, size)
    shape = shape_of(points, cells)
    assert shape.min() > GOOD
    assert shape.max() <= 1.0


def test_elements_that_do_not_fill_their_block_are_refused() -> None:
    """Its faces stand higher than the mesh: the outer sides of the upper elements lie on none of them."""
    assembly = concio.assemble(model(GROUND, box("a", (0, 0, 0), (1, 1, 1), mesh_size=0.5)))
    shape = assembly.disc.shapes[assembly.disc.shape_of[1]]
    assert len(shape.facets) == 6
    with pytest.raises(GeometryError, match="the mesh leaves the faces of the block"):
        _ = replace(shape, vertices=shape.vertices * (1.0, 1.0, 1.5)).facets


def test_blocks_of_one_shape_and_two_mesh_sizes_have_meshes_of_their_own() -> None:
    a, b = box("a", (0, 0, 0), (1, 1, 1), mesh_size=0.5), box("b", (3, 0, 0), (4, 1, 1), mesh_size=0.25)
    disc = concio.assemble(model(GROUND, a, b)).disc
    assert len(disc.nodes(2)) > 3 * len(disc.nodes(1))


@pytest.mark.parametrize("seed", range(sample(1, 8, 20)))
def test_pairs_do_not_depend_on_how_a_structure_is_turned(seed: int) -> None:
    """Facets of different meshes cut each other; corners that a cut leaves on a straight side must not matter.

    Pair by pair: areas, places, and what a displacement opens and slips. The overlay may move vertices by its grid, the
    2**-42 of the largest coordinate (some 2 m), which changes an area of 0.01 m2 within 0.5 m by 2e-11 of it at most.
    """
    rng = np.random.default_rng(seed)
    axis, angle = (1.0, 2.0, 3.0) if seed == 0 else rng.normal(size=3), 37.0 if seed == 0 else rng.uniform(0, 360)
    dome = concio.dome(span=4, ring=0.6, courses=2, blocks=6, mesh_size=0.6)
    (there, disc), (turned, new) = (
        (a.pairs, a.disc) for a in map(concio.assemble, (dome, concio.place(dome, turn=angle, axis=tuple(axis))))
    )
    R = Rotation.from_rotvec(np.deg2rad(angle) * np.asarray(axis) / np.linalg.norm(axis)).as_matrix()
    assert (turned.interface == there.interface).all()
    assert np.abs(turned.area / there.area - 1).max() < 1e-10
    size = np.abs(there.point).max()
    assert np.abs(turned.point - there.point @ R.T).max() < 1e-10 * size
    assert np.abs(turned.normal - there.normal @ R.T).max() < 1e-12
    u = rng.normal(size=(disc.unknowns // 3, 3))
    assert new.unknowns == disc.unknowns
    moved = (u @ R.T).ravel()
    assert np.abs(turned.C_n @ moved - there.C_n @ u.ravel()).max() < 1e-10
    both = (there, u.ravel()), (turned, moved)
    slip, same = (np.einsum("mt,mtd->md", (p.C_t @ v).reshape(-1, 2), p.tangents) for p, v in both)
    assert np.abs(same - slip @ R.T).max() < 1e-10


def test_equal_blocks_share_their_shape_wherever_they_stand() -> None:
    """Meshed, cut by marks or from a grid: what stands elsewhere is the same; what is longer or turned is not."""
    x = np.linspace(0.0, 1.0, 3)
    grid = np.stack(np.meshgrid(x, x, 0.5 * x, indexing="ij"), -1)
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    brick = box("brick", (0, 0, 0), (1, 0.7, 0.5), mesh_size=0.5)
    taller, aside, moved = np.array([1, 1, 2]), np.array([4.0, 0, 0]), np.array([2.0, 0.5, 0.0])
    blocks = [
        from_grid("a", grid), from_grid("b", grid + moved), from_grid("c", grid * taller + aside),
        *(replace(brick, name=n, vertices=brick.vertices + move) for n, move in (("d", -moved), ("e", [[2, -3, 0]]))),
        replace(brick, name="f", vertices=brick.vertices @ quarter.T + np.array([4, -2, 0])),
    ]  # fmt: skip
    a, b, c, d, e, f = concio.assemble(model(GROUND, *blocks)).disc.shape_of[1:]
    assert a == b
    assert d == e
    assert len({a, c, d, f}) == 4


def test_points_of_a_face_are_a_triangular_lattice_in_its_middle() -> None:
    """Each inner one has six neighbours at the distance asked for, and none of the face is far from one."""
    face = shapely.Polygon([(-6, -3), (-1, -3), (-1, 2.5), (-6, 2.5)])
    flat = _lattice(face, 0.4)
    assert np.allclose(flat.mean(0), face.centroid.coords[0], atol=0.05)
    inner = flat[shapely.distance(face.boundary, shapely.points(flat)) > 0.61]
    distance, _ = cKDTree(flat).query(inner, k=7)
    assert len(inner) > 30
    assert np.allclose(distance[:, 1:], 0.4)
    sides = np.stack(np.meshgrid(np.linspace(-6, -1, 51), np.linspace(-3, 2.5, 56)), -1).reshape(-1, 2)
    assert cKDTree(flat).query(sides)[0].max() < 2 * 0.4
    low, high = flat.min(0) - [-6, -3], [-1, 2.5] - flat.max(0)
    row = np.array([1.0, 0.75**0.5]) * 0.4
    assert (low >= 0.2).all()  # half a side of a cell from the edges, where no further row has room
    assert (low < 0.2 + row).all()
    assert (high < 0.2 + row).all()
    for wide, tall, size in ((4.1, 2.05, 0.4), (3.1, 3.0, 0.5), (2.3, 1.1, 0.3), (0.75, 3.1, 0.2)):
        flat = _lattice(shapely.box(2.0, -1.0, 2.0 + wide, tall - 1.0), size)
        assert flat.min(0) - [2.0, -1.0] == pytest.approx([2.0 + wide, tall - 1.0] - flat.max(0))  # as far from both


def test_a_gap_of_a_rule_is_added_to_that_of_the_outlines() -> None:
    """A block 3 mm above the ground in a rule of 2 mm, and one beside it on the ground in none."""
    ground = Polyhedron.box("ground", (-1, -1, -1), (6, 3, 0), kind="fixed")
    high = Polyhedron.box("high", (0, 0, 0.003), (1, 2, 1.5), kind="rigid")
    low = Polyhedron.box("low", (3, 0, 0), (4, 1, 0.5), kind="rigid")
    rules = (concio.JointRule("joint"), concio.JointRule("joint", ("ground", "high"), 0.002))
    laws, materials = {"joint": JointLaw(0.5)}, {"block": Rigid(20.0)}
    pairs = concio.assemble(Model((ground, high, low), materials, laws, rules=rules, gap_reach=0.01)).pairs
    assert set(pairs.body_b) == {1, 2}
    assert pairs.gap == pytest.approx(np.where(pairs.body_b == 1, 0.005, 0.0), abs=1e-15)


@pytest.mark.parametrize("turn", [None, TURN])
def test_pairs_of_elastic_blocks_lie_on_their_joints(turn: np.ndarray | None) -> None:
    """Inside the patch, and with the resultant of a uniform pressure in its middle, wherever it is in space."""
    bodies = (GROUND, box("a", (1.0, 2.0, 0.0), (2.5, 3.0, 1.0)), box("b", (1.5, 2.25, 1.0), (3.0, 4.0, 1.5)))
    assembly = concio.assemble(model(*(bodies if turn is None else (turned(b, turn) for b in bodies))))
    pairs = assembly.pairs
    assert len(assembly.detection.interfaces) == 2
    for k, patch in enumerate(assembly.detection.interfaces):
        mine = pairs.interface == k
        place, share = pairs.point[mine], pairs.area[mine]
        assert share.sum() == pytest.approx(patch.area, rel=1e-9)
        np.testing.assert_allclose(share @ place / share.sum(), patch.middle, atol=1e-9)
        low, high = patch.polygon.min(axis=0), patch.polygon.max(axis=0)
        assert (place >= low - 1e-9).all()
        assert (place <= high + 1e-9).all()
