"""Contacts between convex pieces in any placement: against distances of an independent method, and invariances."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from concio import Body, Polyhedron
from concio.contact.convex_bodies import ConvexBodies, pairs_of
from concio.contact.edge_contacts import _middle
from concio.contact.meeting_features import CORNER, EDGE
from concio.contact.narrow_phase import Contacts, find_contacts
from concio.kinematics.placement import Placement
from samples import sample

Array = np.ndarray
BOX = Polyhedron.box("b", (0, 0, 0), (1, 1, 1))
SEEDS = range(sample(8, 40, 120))


def body(name: str, points: Array) -> Body | Polyhedron:
    """The convex hull of points."""
    hull = ConvexHull(points)
    if points.shape[1] == 2:
        return Body(name, points[hull.vertices])
    triangles = []
    for corners, plane in zip(hull.simplices, hull.equations, strict=True):
        p, q, r = points[corners]
        triangles.append(corners if np.cross(q - p, r - p) @ plane[:3] > 0 else corners[::-1])
    return Polyhedron(name, points, [tuple(t.tolist()) for t in triangles])


def contacts(bodies: list, reach: float, **options) -> Contacts:
    pieces = ConvexBodies.of(bodies)
    return find_contacts(pieces, pairs_of(pieces, reach, np.zeros(len(bodies), dtype=bool)), reach, **options)


def signed_distance(p: Array, q: Array) -> float:
    """Distance of two convex hulls, minus the depth where they overlap: from the hull of the differences of corners.

    Outside of it the origin is as far as from the nearest of its faces, edges and corners; inside, as deep as below the
    nearest face.
    """
    apart = (q[:, None] - p[None]).reshape(-1, p.shape[1])
    hull = ConvexHull(apart)
    height = hull.equations[:, -1].max()
    if height <= 0:
        return float(height)
    return min(_to_simplex(apart[corners]) for corners in hull.simplices)


def _to_simplex(corners: Array) -> float:
    """Distance of the origin from a segment or a triangle: from the nearest of its parts whose foot lies inside it."""
    found = []
    for count in range(1, len(corners) + 1):
        for some in combinations(range(len(corners)), count):
            base, sides = corners[some[0]], corners[list(some[1:])] - corners[some[0]]
            share = np.linalg.lstsq(sides.T, -base, rcond=None)[0] if count > 1 else np.zeros(0)
            if share.sum() <= 1.0 and (share >= 0.0).all():
                found.append(float(np.linalg.norm(base + share @ sides)))
    return min(found)


def random_pair(seed: int, dim: int) -> tuple[Array, Array]:
    """Corners of two random convex bodies that come near each other."""
    rng = np.random.default_rng(seed)
    shapes = []
    for _ in range(2):
        if rng.random() < 0.5:
            corners = BOX.vertices[:, :dim] - 0.5
            corners = np.unique(corners, axis=0) * rng.uniform(0.3, 2.0, dim)
        else:
            corners = rng.normal(size=(int(rng.integers(dim + 1, 14)), dim))
        shapes.append(corners @ turn(rng, dim).T)
    p, q = shapes
    way = rng.normal(size=dim)
    way /= np.linalg.norm(way)
    far = (p @ way).max() - (q @ way).min()
    q = q + (far + 3) * way
    for _ in range(60):  # up to a small distance, by as much as is surely free
        distance = signed_distance(p, q)
        if distance < 1e-3:
            break
        q = q - 0.9 * distance * way
    return p, q + 0.2 * rng.normal() * way * rng.integers(0, 2)


def turn(rng: np.random.Generator, dim: int) -> Array:
    if dim == 3:
        return Rotation.random(random_state=int(rng.integers(1 << 30))).as_matrix()
    angle = rng.uniform(0, 2 * np.pi)
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_the_least_gap_is_the_distance_and_the_largest_depth_the_penetration(seed: int, dim: int) -> None:
    """Where no feature lies along a face (facing 0) a patch has one point, and its gap is the distance."""
    p, q = random_pair(seed, dim)
    distance = signed_distance(p, q)
    found = contacts([body("p", p), body("q", q)], 10.0, facing=0.0)
    assert len(found) == 1
    if distance > -0.05:
        assert found.gap.min() == pytest.approx(distance, rel=1e-7, abs=1e-9)
    assert np.linalg.norm(found.normals, axis=1) == pytest.approx(1.0)
    inside = (found.on_a @ ConvexHull(p).equations[:, :-1].T + ConvexHull(p).equations[:, -1]).max()
    assert inside <= max(1e-9, -distance + 1e-9)
    if distance > 1e-6:
        none = contacts([body("p", p), body("q", q)], 0.999 * distance)
        assert not len(none)


@pytest.mark.parametrize("facing", [0.0, 0.01])
@pytest.mark.parametrize("seed", SEEDS)
def test_the_features_named_hold_the_points_of_their_patch(seed: int, facing: float) -> None:
    """A point lies on the edge, in the plane of the face or at the corner by which its patch is known."""
    p, q = random_pair(seed, 3)
    pieces = ConvexBodies.of([body("p", p), body("q", q)])
    found = find_contacts(pieces, pairs_of(pieces, 10.0, np.zeros(2, dtype=bool)), 10.0, facing=facing)
    for k in range(len(found)):
        for side, place in enumerate((found.on_a, found.on_b)):
            points, number = place[found.first[k] : found.first[k + 1]], found.feature[k, side]
            if found.dims[k, side] == CORNER:
                off = np.linalg.norm(points - pieces.points[number], axis=1)
            elif found.dims[k, side] == EDGE:
                start, end = pieces.points[pieces.edges[number]]
                share = np.clip((points - start) @ (end - start) / ((end - start) @ (end - start)), 0.0, 1.0)
                off = np.linalg.norm(points - start - share[:, None] * (end - start), axis=1)
            else:
                corner = pieces.points[pieces.loops.values[pieces.loops.first[number]]]
                off = np.abs((points - corner) @ pieces.normals[number])
            assert off.max() < 1e-6


def test_directions_that_come_twice_count_once_in_the_middle_of_all() -> None:
    """Corners that touch at right angles part along the diagonal, by however many edges each way is found."""
    way = np.array([[(1.0, 0.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)]])
    middle = _middle(way, np.array([[0.0, 0.0, 0.0, -1.0]]), np.array([1e-9]))
    assert middle == pytest.approx(np.full((1, 2), np.sqrt(0.5)))


def described(found: Contacts, back: Array | None = None, shift: Array | float = 0.0, scale: float = 1.0) -> Array:
    """Points, normals, gaps and shares in an order of their own, moved back."""
    dim = found.normal.shape[1]
    back = np.eye(dim) if back is None else back
    power = dim - 1
    of = found.of
    share = found.share / np.where((found.dims[of] == power).all(1), scale**power, scale)
    return np.column_stack([
        (found.on_a / scale - shift) @ back.T, (found.on_b / scale - shift) @ back.T, found.normals @ back.T,
        found.normal[of] @ back.T, found.gap / scale, share,
    ])  # fmt: skip


def same_rows(one: Array, other: Array, tolerance: float = 1e-8) -> bool:
    """Whether two sets of rows are equal, in whatever order."""
    if one.shape != other.shape or not len(one):
        return one.shape == other.shape
    away = np.abs(one[:, None] - other[None]).max(2)
    return bool((away.min(0) < tolerance).all() and (away.min(1) < tolerance).all())


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_turned_mirrored_scaled_and_swapped_bodies_have_the_same_patches(seed: int, dim: int) -> None:
    rng = np.random.default_rng(seed + 1000)
    p, q = random_pair(seed, dim)
    first = described(contacts([body("p", p), body("q", q)], 0.3))
    matrix, shift, scale = turn(rng, dim), rng.uniform(-3, 3, dim), 10.0 ** rng.uniform(-2, 2)
    matrix = matrix @ np.diag([rng.choice([-1.0, 1.0]), *np.ones(dim - 1)])
    moved = [body(name, scale * (x @ matrix.T + shift)) for name, x in (("p", p), ("q", q))]
    found = contacts(moved, 0.3 * scale)
    assert same_rows(described(found, matrix.T, shift, scale), first)
    swapped = described(contacts([body("q", q), body("p", p)], 0.3))
    d = dim
    back = np.column_stack([swapped[:, d : 2 * d], swapped[:, :d], -swapped[:, 2 * d : 4 * d], swapped[:, 4 * d :]])
    assert same_rows(back, first)


@pytest.mark.parametrize("tilt", [0.0, 1e-9, 1e-6, 1e-4, 1e-2, 0.1, 0.3])
def test_a_tilted_cube_touches_along_an_edge_of_a_patch_whose_gap_grows_with_the_tilt(tilt: float) -> None:
    ground = Polyhedron.box("g", (-5, -5, -1), (5, 5, 0))
    leaning = Rotation.from_rotvec([0, tilt, 0]).as_matrix()
    corners = BOX.vertices @ leaning.T
    corners[:, 2] -= corners[:, 2].min()
    found = contacts([ground, Polyhedron("c", corners, BOX.faces)], 0.1)
    assert found.kinds == ("face-face",)
    assert np.sort(found.gap) == pytest.approx([0, 0, np.sin(tilt), np.sin(tilt)], abs=1e-12)
    assert found.normals == pytest.approx(np.tile([0, 0, 1.0], (4, 1)), abs=1e-12)  # corners on the ground's face
    assert found.share.sum() == pytest.approx(np.cos(tilt / 2), rel=1e-9)


def test_patches_change_as_little_as_a_body_turns() -> None:
    """Every point of a patch moves by at most a few times the motion while one cube turns on another."""
    lower = Polyhedron.box("a", (-1, -1, -1), (1, 1, 0))
    before: Contacts | None = None
    for k in range(200):
        lean = Rotation.from_rotvec([1e-3 * k, 2e-3 * k, 3e-3 * k]).as_matrix()
        corners = (BOX.vertices - [0.5, 0.5, 0.0]) @ lean.T
        corners[:, 2] -= corners[:, 2].min()
        now = contacts([lower, Polyhedron("c", corners, BOX.faces)], 0.05, previous=before)
        if before is not None and np.arccos(lean[2, 2]) < np.deg2rad(20):
            assert now.kinds == before.kinds == ("face-face",)
            away = np.linalg.norm(now.on_b[:, None] - before.on_b[None], axis=2)
            assert max(away.min(0).max(), away.min(1).max()) < 0.01
        before = now


def box(name: str, low: tuple, high: tuple) -> Polyhedron:
    return Polyhedron.box(name, low, high)


ROOF = Polyhedron("r", [(-0.2, -1, -0.5), (0.2, -1, -0.5), (0, -1, 0), (-0.2, 2, -0.5), (0.2, 2, -0.5), (0, 2, 0)],
                  [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)])  # fmt: skip
TURNED = Polyhedron("t", ROOF.vertices[:, [1, 0, 2]] * [1, 1, -1], ROOF.faces)  # two mirrors: a turn
CASES = {
    "face-face": (box("a", (0, 0, 0), (1, 1, 1)), box("b", (0.5, 0.2, 1), (1.5, 0.8, 2)), (0, 0, 1), 4),
    "edge-face": (ROOF, box("b", (-1, 0, 0), (1, 1, 1)), (0, 0, 1), 2),
    "edge-edge": (ROOF, TURNED, (0, 0, 1), 1),
    "edge-edge along": (box("a", (0, 0, 0), (1, 1, 1)), box("b", (1, 0.2, 1), (2, 1.2, 2)), (1, 0, 1), 2),
    "corner-corner": (box("a", (0, 0, 0), (1, 1, 1)), box("b", (1, 1, 1), (2, 2, 2)), (1, 1, 1), 1),
    "face-corner": (box("a", (-1, -1, -1), (1, 1, 0)),
                    body("b", np.array([(0, 0, 0), (1, 0, 1), (0, 1, 1), (-1, -1, 1.0)])), (0, 0, 1), 1),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("gap", [0.0, 1e-7, 1e-3])
def test_each_kind_in_space(name: str, gap: float) -> None:
    a, b, normal, count = CASES[name]
    unit = np.array(normal) / np.linalg.norm(normal)
    moved = Polyhedron("m", b.vertices + gap * unit, b.faces)
    found = contacts([a, moved], 0.01)
    assert found.kinds == (name.split()[0],)
    assert found.normal[0] == pytest.approx(unit, abs=1e-7)
    assert found.gap == pytest.approx(np.full(count, gap), abs=1e-12)


def test_kinds_in_the_plane_and_bodies_that_are_not_convex() -> None:
    ell = Body("l", [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    block = Body("c", [(1, 1), (1.5, 1), (1.5, 1.5), (1, 1.5)])
    found = contacts([ell, block], 0.01)
    assert sorted(map(tuple, found.normal.round(12))) == [(0.0, 1.0), (1.0, 0.0)]
    assert set(found.kinds) == {"face-face"}
    assert found.share.sum() == pytest.approx(1.0)
    tip = Body("k", [(0.8, -1), (1.2, -1), (1, 0)])
    found = contacts([tip, Body("b", [(0, 0), (3, 0), (3, 1), (0, 1)])], 0.01)
    assert found.kinds == ("corner-face",)
    assert found.normal[0] == pytest.approx([0, 1])
    found = contacts([tip, Body("b", [(1, 0), (0, 2), (2, 2)])], 0.01)
    assert found.kinds == ("corner-corner",)
    assert found.normal[0] == pytest.approx([0, 1])


def test_a_stone_on_a_frame_in_space_meets_each_face_once_and_no_seam() -> None:
    """A table of a slab and two legs in one body stands on the ground with both feet and carries a box on its top."""
    profile = [(0, 0), (1, 0), (1, 2), (4, 2), (4, 0), (5, 0), (5, 3), (0, 3)]
    n = len(profile)
    corners = [(x, y, z) for y in (0.0, 1.0) for x, z in profile]
    sides = [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)]
    table = Polyhedron("t", corners, [tuple(range(n)), tuple(range(2 * n - 1, n - 1, -1)), *[s[::-1] for s in sides]])
    ground = box("g", (-5, -5, -1), (9, 5, 0))
    load = box("b", (0.5, 0, 3), (4.5, 1, 3.5))
    found = contacts([ground, table, load], 0.01)
    assert np.abs(found.normal[:, 2]) == pytest.approx(1.0)
    of = found.of
    feet, top = (found.share[(found.body_b[of] == k)].sum() for k in (1, 2))
    assert feet == pytest.approx(2.0)
    assert top == pytest.approx(4.0)


def test_bodies_that_stand_elsewhere_are_found_where_they_stand() -> None:
    bodies = [box("a", (0, 0, 0), (1, 1, 1)), box("b", (4, 0, 0), (5, 1, 1))]
    centre = np.array([b.centroid for b in bodies])
    lean = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix()
    placement = Placement(centre + np.array([(0, 0, 0), (-2.9, 0.2, 0.3)]), np.array([np.eye(3), lean]))
    pieces = ConvexBodies.of(bodies).placed(placement, centre)
    i, j = pairs_of(pieces, 1.0, np.zeros(2, dtype=bool))
    found = find_contacts(pieces, (i, j), 1.0)
    corners = placement.centre[1] + (bodies[1].vertices - centre[1]) @ lean.T
    again = contacts([bodies[0], Polyhedron("b", corners, bodies[1].faces)], 1.0)
    assert same_rows(described(found), described(again))
    far = pairs_of(ConvexBodies.of(bodies), 1.0, np.zeros(2, dtype=bool))
    assert not len(far[0])
    assert not len(pairs_of(pieces, 1.0, np.ones(2, dtype=bool))[0])


def test_a_wall_has_a_patch_for_each_joint() -> None:
    """Running bond, 20 courses of 20: every brick rests on two halves, and stands beside its neighbours."""
    bricks = [
        box(f"{k}-{i}", (i + 0.5 * (k % 2), 0, 0.3 * k), (i + 1 + 0.5 * (k % 2), 0.4, 0.3 * k + 0.3))
        for k in range(20) for i in range(20)
    ]  # fmt: skip
    found = contacts(bricks, 0.01)
    faces = np.array(found.kinds) == "face-face"
    assert faces.all()
    level = np.abs(found.normal[:, 2]) > 0.5
    assert level.sum() == 19 * 39
    assert (~level).sum() == 20 * 19
    assert all(p < q for p, q in pairwise(found.first))


@pytest.mark.parametrize("high", [0.0, 1e-3])
@pytest.mark.parametrize("face", range(6))
def test_a_face_in_pieces_is_one_face(face: int, high: float) -> None:
    """Two triangles of one plane, as files have them, touch like the face that they are."""
    loop = BOX.faces[face]
    cut = (loop[:3], (loop[0], *loop[2:]))
    pieces = Polyhedron("b", BOX.vertices, (*BOX.faces[:face], *cut, *BOX.faces[face + 1 :]))
    floor = Polyhedron.box("floor", (-2.0, -2.0, -1.0), (2.0, 2.0, -high))
    beside = Polyhedron.box("beside", (1.0 + high, 0.25, 0.25), (2.0, 0.75, 2.0))
    one, other = (described(contacts([b, floor, beside], 0.01)) for b in (BOX, pieces))
    assert len(one) == 8
    assert same_rows(one, other)
