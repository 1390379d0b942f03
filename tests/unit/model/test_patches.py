"""Interfaces in space: areas in closed form, whatever the rotation, and everything that nearly was one told."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from concio import InputError, Polyhedron
from concio.model import convex_pieces
from concio.model.interfaces.detect import Detection
from concio.model.interfaces.near_space import distance_to_surface
from concio.model.interfaces.patches import detect_patches
from concio.model.surfaces import prism
from solids import TURN, box, frame_block, l_block, tetrahedron, turned

A = box("a", (0, 0, 0), (1, 1, 1))
C_SHAPE = np.array([[0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [3, 2], [3, 3], [0, 3]], dtype=float)


def found(*blocks: Polyhedron, tolerance: float = 1e-6, **options: float) -> Detection:
    plain = detect_patches(blocks, tolerance=tolerance, **options)
    moved = detect_patches([turned(b) for b in blocks], tolerance=tolerance, **options)
    assert [(p.a, p.b, p.face_a, p.face_b) for p in plain.patches] == [
        (p.a, p.b, p.face_a, p.face_b) for p in moved.patches
    ]
    for p, q in zip(plain.patches, moved.patches, strict=True):
        assert q.area == pytest.approx(p.area, rel=1e-12)
        assert np.allclose(p.normal @ TURN.T, q.normal, atol=1e-12)
        assert np.allclose(p.gap.max(), q.gap.max(), atol=1e-12)
        assert np.allclose(p.middle @ TURN.T + (0.7, -1.3, 2.1), q.middle, atol=1e-12)
        assert len(p.polygon) == len(q.polygon)
    assert [m.kind for m in plain.near_misses] == [m.kind for m in moved.near_misses]
    assert len(plain.overlaps) == len(moved.overlaps)
    return plain


def areas(detection: Detection) -> list[float]:
    return [round(p.area, 9) for p in detection.patches]


def prism_of(flat: np.ndarray, low: float, high: float, name: str) -> Polyhedron:
    return prism(name, [np.column_stack([flat, np.full(len(flat), low)])], np.array([0, 0, high - low]))


def test_a_corner_of_a_face() -> None:
    detection = found(A, box("b", (0.5, 0.25, 1), (1.5, 1.5, 2)))
    (patch,) = detection.patches
    assert patch.area == pytest.approx(0.375, rel=1e-14)
    assert patch.normal.tolist() == [0, 0, 1]
    assert (patch.face_a, patch.face_b) == (1, 0)
    assert np.allclose(patch.middle, (0.75, 0.625, 1))
    assert not detection.report()


def test_the_normal_points_from_a_to_b_and_the_boundary_turns_about_it() -> None:
    for patch in found(box("up", (0, 0, 1), (1, 1, 2)), A, box("side", (1, 0, 0), (2, 0.5, 0.5))).patches:
        blocks = (box("up", (0, 0, 1), (1, 1, 2)), A, box("side", (1, 0, 0), (2, 0.5, 0.5)))
        assert (blocks[patch.b].centroid - blocks[patch.a].centroid) @ patch.normal > 0
        x = patch.polygon
        around = np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(0)
        assert np.allclose(around, 2 * patch.area * patch.normal)


def test_faces_that_are_not_convex_meet_in_several_pieces() -> None:
    c = prism_of(C_SHAPE, 0, 1, "c")
    assert areas(found(c, box("bar", (2, 0, 1), (3, 3, 2)))) == [1.0, 1.0]
    assert areas(found(c, prism_of(C_SHAPE, 1, 2, "c2"))) == [7.0]
    assert areas(found(l_block("l"), l_block("l2", low=1.0))) == [3.0]
    assert areas(found(l_block("l"), box("b", (1, 1, 0), (2, 2, 1)))) == [1.0, 1.0]


def test_faces_with_holes() -> None:
    (patch,) = found(frame_block("f"), frame_block("g", low=1.0)).patches
    assert patch.area == pytest.approx(5.5, rel=1e-14)
    assert len(patch.holes) == 1
    assert areas(found(frame_block("f"), box("peg", (0.5, 0.5, 0), (1.5, 1, 1)))) == [0.5, 1.0, 0.5, 1.0]


def test_a_gap_is_told_or_kept() -> None:
    above = box("b", (0, 0, 1.002), (1, 1, 2))
    detection = found(A, above)
    assert not detection.patches
    (miss,) = detection.near_misses
    assert miss.kind == "gap"
    assert miss.gap == pytest.approx(2e-3)
    assert "'a' (face 2) and 'b' (face 1) face each other over 1 m2" in miss.sentence
    assert "with a gap of 2 mm" in miss.sentence
    (patch,) = found(A, above, reach=0.01).patches
    assert patch.gap == pytest.approx(np.full(4, 2e-3))
    assert patch.gap_at(np.array([[0.3, 0.6, 1.0]])) == pytest.approx([2e-3])
    assert not found(A, box("far", (0, 0, 1.06), (1, 1, 2))).report()


def tilted(degrees: float) -> Polyhedron:
    rise = np.tan(np.deg2rad(degrees))
    points = box("t", (0, 0, 1), (1, 1, 3)).vertices.copy()
    points[[1, 3], 2] += rise
    return Polyhedron("t", points, A.faces)


def test_a_wedge_shaped_gap_is_cut_where_the_reach_ends() -> None:
    detection = found(A, tilted(3), reach=0.02)
    (patch,) = detection.patches
    depth = 0.02 / np.tan(np.deg2rad(3))
    assert patch.area == pytest.approx(depth, rel=1e-2)
    assert patch.gap.max() == pytest.approx(0.02, rel=1e-9)
    assert patch.gap.min() == 0.0
    assert [m.kind for m in detection.near_misses] == ["partial"]


def test_faces_that_touch_and_are_turned_a_little_are_joined_with_the_gap_between_them() -> None:
    for degrees in (0.01, 0.1, 3, 4.9, 5.1, 19):
        (patch,) = found(A, tilted(degrees)).patches
        half = np.deg2rad(degrees) / 2
        assert patch.area == pytest.approx(1.0, rel=2 * half)
        assert sorted(patch.gap)[:2] == [0, 0]
        assert sorted(patch.gap)[2:] == pytest.approx([2 * np.sin(half)] * 2, rel=1e-2)


def test_faces_at_an_angle_are_told() -> None:
    for degrees, options in ((3, {"reach": 0.0}), (10, {"facing_angle": np.deg2rad(5)})):
        detection = found(A, tilted(degrees), **options)
        assert not detection.patches
        assert "turned by" in detection.report()[0]
        assert detection.near_misses[0].angle == pytest.approx(np.deg2rad(degrees))


def test_a_sliver_is_dropped_and_told() -> None:
    detection = found(A, box("b", (0, 0.9995, 1), (1, 2, 2)))
    assert not detection.patches
    assert "share a strip only 0.4998 mm wide" in detection.report()[0]


@pytest.mark.parametrize(
    ("blocks", "words", "depth"),
    [
        ((A, box("b", (0.2, 0.2, 0.9), (0.8, 0.7, 2))), "'a' and 'b' overlap .* by 0.03 m3, 100 mm deep", 0.1),
        ((A, box("b", (0.2, 0.3, 0.2), (0.8, 0.8, 0.5))), "'b' lies inside 'a'", 0.5),
        ((A, box("b", (0, 0, 0), (1, 1, 1))), "'a' and 'b' are the same block twice", 1.0),
        ((l_block("l"), box("b", (0.9, 0.9, 0), (2, 2, 1))), "'l' and 'b' overlap", 0.1),
        ((l_block("l"), l_block("again")), "the same block twice", 0.0),
        ((l_block("l"), box("b", (0.2, 0.3, 0.2), (0.8, 0.8, 0.5))), "'b' lies inside 'l'", 0.0),
        ((l_block("l"), box("b", (0.5, 0.3, 0.9), (0.8, 0.8, 3))), "'l' and 'b' overlap .* 100 mm deep", 0.1),
    ],
)
def test_overlaps_are_told_with_their_depth(blocks: tuple[Polyhedron, ...], words: str, depth: float) -> None:
    detection = found(*blocks)
    (overlap,) = detection.overlaps
    assert re.search(words, overlap.sentence)
    assert overlap.depth >= 0.99 * depth
    assert not detection.patches


@pytest.mark.parametrize(
    ("other", "twice"),
    [(l_block("again"), True), (turned(l_block("moved"), np.eye(3), (0.1, 0.1, 0.1)), False),
     (box("bar", (0.2, 0.2, -1), (0.4, 0.4, 2)), False)],
)  # fmt: skip
def test_bodies_of_too_many_pieces_are_the_same_twice_where_their_corners_are(
    monkeypatch: pytest.MonkeyPatch, other: Polyhedron, twice: bool
) -> None:
    monkeypatch.setattr(convex_pieces, "MOST_PIECES", 1)
    block = l_block("l")
    assert block.pieces is None
    (overlap,) = found(block, other).overlaps
    assert ("the same block twice" in overlap.sentence) == twice
    assert ("overlap" in overlap.sentence) != twice


def test_a_bar_through_a_body_of_too_many_pieces_overlaps_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wheel with valleys, one along each half of the x axis: a bar through it, and bars that stand in the valleys."""
    monkeypatch.setattr(convex_pieces, "MOST_PIECES", 10)
    turns = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    radius = np.where(np.arange(40) % 2, 1.0, 0.8)
    wheel = prism_of(np.column_stack([radius * np.cos(turns), radius * np.sin(turns)]), 0.0, 1.0, "wheel")
    assert wheel.pieces is None
    (overlap,) = found(wheel, box("bar", (-0.4, -0.03, -3.0), (-0.3, 0.02, 1.4))).overlaps
    assert overlap.depth == pytest.approx(0.5)
    assert not found(wheel, box("right", (0.9, -2e-3, 0.2), (1.4, 2e-3, 0.3))).overlaps
    assert not found(wheel, box("left", (-1.4, -2e-3, 0.2), (-0.9, 2e-3, 0.3))).overlaps


@pytest.mark.parametrize("off", [0.0, 1e-13, -1e-13, 1e-11, -1e-11, 1e-9, -1e-9, 1e-7, -1e-7])
def test_faces_that_miss_one_plane_by_rounding_leave_no_flat_pieces(off: float) -> None:
    """A leg as high as a step beside it, but for ``off``: what is cut along one is cut along the other."""
    outline = [(0, 0), (5, 0), (5, 10), (4, 10), (4, 1), (3, 1), (3, 0.5), (1, 0.5), (1, 1 + off), (0, 1 + off)]
    pieces = prism_of(np.array(outline, dtype=float), 0.0, 1.0, "stair").pieces
    assert pieces is not None
    assert len(pieces) == 4
    for piece in pieces:
        assert (piece.offsets - (piece.vertices @ piece.normals.T).min(0)).min() > 0.4
    volume = sum(ConvexHull(piece.vertices).volume for piece in pieces)
    assert volume == pytest.approx(5 * 0.5 + 1 * 0.5 + 2 * 0.5 + 9, abs=1e-5)


@pytest.mark.parametrize("seed", range(20))
def test_the_pieces_of_a_block_have_its_volume(seed: int) -> None:
    """Blocks of reentrant corners, and with a corner that hardly turns, as where a spandrel meets an arch."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(5, 12))
    angle, radius = np.sort(rng.uniform(0, 2 * np.pi, count)), rng.uniform(0.3, 1, count)
    outline = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    at, share = int(rng.integers(0, count)), rng.uniform(0.2, 0.8)
    edge = outline[(at + 1) % count] - outline[at]
    turns = 10.0 ** rng.integers(-14, -2) * rng.normal(size=2)
    outline = np.insert(outline, at + 1, outline[at] + share * edge + turns, axis=0)
    block = prism_of(outline, 0.0, 0.7, "block")
    assert block.pieces is not None
    volume = sum(ConvexHull(piece.vertices, qhull_options="QJ").volume for piece in block.pieces)
    assert volume == pytest.approx(block.volume, rel=2e-5)


def test_the_pieces_of_a_spandrel_have_its_volume() -> None:
    outline = [(0, 0.35), (0, 0), (0.57, 0), (0.575, 0.017), (0.805, 0.268), (0.807, 0.27), (0.9, 0.35)]
    block = prism_of(np.array(outline), 0.0, 0.8, "spandrel")
    assert block.pieces is not None
    volume = sum(ConvexHull(piece.vertices).volume for piece in block.pieces)
    assert volume == pytest.approx(block.volume, rel=1e-9)


def test_overlaps_are_found_among_bodies_of_several_shapes() -> None:
    """Two of each shape, turned about: a pair is reported whichever of them comes first."""
    post = tetrahedron("post", np.array([[0.2, 0.2, 0.5], [0.6, 0.2, 0.5], [0.2, 0.5, 0.5], [0.3, 0.3, 1.5]]))
    bar = box("bar", (0.9, 0.3, 0.2), (1.3, 0.7, 0.6))
    far = l_block("far", low=0.2)
    far = turned(far, np.eye(3), (1.2, 0.4, 0.0))
    detection = found(A, post, bar, far)
    told = {frozenset((o.a, o.b)) for o in detection.overlaps}
    assert told == {frozenset(("a", "post")), frozenset(("a", "bar")), frozenset(("bar", "far"))}
    again = found(far, bar, post, A)
    assert {frozenset((o.a, o.b)) for o in again.overlaps} == told


def test_blocks_side_by_side_do_not_overlap_however_they_stand() -> None:
    blocks = [box(f"{i}{j}{k}", (i, j, k), (i + 1, j + 1, k + 1)) for i in range(3) for j in range(3) for k in range(2)]
    detection = found(*blocks)
    assert len(detection.patches) == 2 * 3 * 2 * 2 + 9
    assert not detection.report()


def test_a_ridge_and_a_corner_on_a_face_are_told() -> None:
    sides = [[0.3, 0.2, 1.5], [0.7, 0.2, 1.5], [0.3, 0.8, 1.5], [0.7, 0.8, 1.5]]
    points = np.array([[0.3, 0.5, 1], [0.7, 0.5, 1], *sides])
    faces = [(0, 1, 3, 2), (0, 4, 5, 1), (2, 3, 5, 4), (0, 2, 4), (1, 5, 3)]
    for stretch, length in ((1.0, 0.4), (3.0, 1.0)):
        ridge = Polyhedron("ridge", (points - (0.5, 0, 0)) * (stretch, 1, 1) + (0.5, 0, 0), faces)
        (miss,) = found(A, ridge).near_misses
        assert miss.kind == "edge"
        assert miss.length == pytest.approx(length)
        assert miss.at == pytest.approx([0.5, 0.5, 1.0])
        assert f"along an edge of {length:g} m only" in miss.sentence
        assert miss.place == "'a' on 'ridge' at (0.5, 0.5, 1) m"


def test_fixed_bodies_do_not_meet_each_other() -> None:
    detection = found(box("g", (0, 0, -1), (1, 1, 0), kind="fixed"), box("h", (1, 0, -1), (2, 1, 0), kind="fixed"))
    assert not detection.patches


def test_bad_tolerances() -> None:
    with pytest.raises(InputError, match="gap tolerance = 0"):
        detect_patches([A], tolerance=0.0)
    with pytest.raises(InputError, match="gap reach = -1"):
        detect_patches([A], tolerance=1e-6, reach=-1.0)


def test_the_distance_from_a_box_is_that_of_its_nearest_place() -> None:
    """Beside faces, beyond edges and corners, and inside, where the nearest face counts."""
    low, high = np.array([-1.0, 2.0, 0.5]), np.array([2.0, 3.0, 1.1])
    body = Polyhedron.box("a", tuple(low), tuple(high))
    points = np.random.default_rng(4).uniform(low - 3.0, high + 3.0, (400, 3))
    points[:100] = np.random.default_rng(5).uniform(low, high, (100, 3))
    points[100:200, 1:] = low[1:]  # on the lines of edges, beyond their ends
    outside = np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0.0), axis=1)
    inside = np.minimum(points - low, high - points).min(axis=1)
    assert distance_to_surface(body, points) == pytest.approx(np.where(inside > 0, inside, outside), abs=1e-14)
