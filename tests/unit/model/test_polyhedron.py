"""Polyhedra: closed forms, what is refused and how it is reported."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from concio import GeometryError, InputError, Polyhedron
from concio.model.polyhedron_check import MOST_VERTICES, polyhedron_faults
from concio.model.surfaces import grid_surface, merged_faces, welded
from solids import BOX, box, frame_block, l_block, tetrahedron, turned, voussoir

CORNERS = np.array([[0.0, 0, 0], [2, 0.1, 0], [0.3, 1.5, 0.2], [0.4, 0.2, 1.1]])


def test_a_box_by_its_corners() -> None:
    block = box("b", (0.5, -1, 2), (1.5, 1, 5))
    assert block.volume == pytest.approx(6.0, rel=1e-14)
    assert np.allclose(block.centroid, (1.0, 0.0, 3.5), atol=1e-14)
    assert np.allclose(np.diag(block.moments.inertia), 6.0 / 12 * np.array([4 + 9, 1 + 9, 1 + 4]), rtol=1e-13)
    assert sorted(block.face_areas.tolist()) == pytest.approx([2, 2, 3, 3, 6, 6])
    assert np.allclose(block.normals[[0, 1]], [[0, 0, -1], [0, 0, 1]])
    assert block.offsets.tolist() == pytest.approx([-2, 5, 1, 1, -0.5, 1.5])
    assert block.convex
    assert block.size == pytest.approx(6 ** (1 / 3))


@pytest.mark.parametrize(
    ("block", "volume", "convex"),
    [(l_block("l"), 3.0, False), (frame_block("f", 2.0), 11.0, False), (box("b", (0, 0, 0), (1, 2, 3)), 6.0, True)],
)
def test_volumes_survive_any_rotation(block: Polyhedron, volume: float, convex: bool) -> None:
    moved = turned(block)
    assert block.volume == pytest.approx(volume, rel=1e-13)
    assert moved.volume == pytest.approx(volume, rel=1e-13)
    assert moved.convex == convex
    assert np.allclose(np.sort(np.linalg.eigvalsh(moved.moments.inertia)),
                       np.sort(np.linalg.eigvalsh(block.moments.inertia)), rtol=1e-12)  # fmt: skip


def test_a_tetrahedron_against_its_determinant() -> None:
    block = tetrahedron("t", CORNERS)
    assert block.volume == pytest.approx(np.linalg.det(CORNERS[1:] - CORNERS[0]) / 6, rel=1e-13)
    assert np.allclose(block.centroid, CORNERS.mean(0), atol=1e-14)


def test_the_second_moments_of_a_block_with_a_hole_against_its_parts() -> None:
    block = frame_block("f", 2.0)
    whole, hole = box("w", (0, 0, 0), (3, 2, 2)), box("h", (0.5, 0.5, 0), (1.5, 1, 2))
    centre = (whole.volume * whole.centroid - hole.volume * hole.centroid) / (whole.volume - hole.volume)

    def about(b: Polyhedron, point: np.ndarray) -> np.ndarray:
        arm = b.centroid - point
        return b.moments.second + b.volume * np.outer(arm, arm)

    assert np.allclose(block.centroid, centre, atol=1e-13)
    assert np.allclose(block.moments.second, about(whole, centre) - about(hole, centre), atol=1e-12)


def test_triangles_cover_the_faces_and_turn_outwards() -> None:
    for block in (l_block("l"), frame_block("f"), voussoir()):
        cells, face = block.triangles
        a, b, c = (block.vertices[cells[:, k]] for k in range(3))
        area = 0.5 * np.cross(b - a, c - a)
        assert ((area * block.normals[face]).sum(1) > 0).all()
        assert np.allclose(np.bincount(face, np.linalg.norm(area, axis=1)), block.face_areas, rtol=1e-12)


def test_a_folded_grid_keeps_its_folds_and_a_flat_one_has_six_faces() -> None:
    assert len(voussoir().faces) == 10
    assert not voussoir().convex
    grid = np.stack(np.meshgrid([0, 1, 3.0], [0, 1, 2.0], [0, 1.0], indexing="ij"), -1)
    points, faces, holes = grid_surface(grid)
    assert len(points) == 8
    assert len(faces) == 6
    assert not holes


def test_triangulated_faces_are_put_together_holes_included() -> None:
    block = frame_block("f")
    cells, _ = block.triangles
    points, faces, holes = merged_faces(block.vertices, [tuple(c) for c in cells.tolist()])
    again = Polyhedron("again", points, faces, holes=holes)
    assert len(again.faces) == len(block.faces) == 10
    assert len(again.holes) == 2
    assert again.volume == pytest.approx(block.volume, rel=1e-13)
    assert sorted(again.face_areas.tolist()) == pytest.approx(sorted(block.face_areas.tolist()))


def test_welding_puts_faces_of_their_own_vertices_together() -> None:
    block = turned(l_block("l"))
    loops = [list(face) for face in block.faces]
    points = np.concatenate([block.vertices[loop] for loop in loops])
    first = np.cumsum([0] + [len(loop) for loop in loops])
    faces = [tuple(range(a, b)) for a, b in pairwise(first)]
    with pytest.raises(GeometryError, match="vertices coincide with others"):
        Polyhedron("loose", points, faces)
    assert Polyhedron("welded", *welded(points, faces, 1e-9)).volume == pytest.approx(3.0)


CUBE = box("c", (0, 0, 0), (1, 1, 1)).vertices
RAISED = CUBE + 0.02 * np.eye(8, 3)[::-1][:, ::-1]
OUT = CUBE.copy()
OUT[7, 2] += 0.005
PIERCED = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 1], [1, 1, -1]])


@pytest.mark.parametrize(
    ("points", "faces", "words"),
    [
        (CUBE, BOX[:5], "open: the edge from vertex 1 to vertex 3 at .* belongs to one face only, and 3 more such"),
        (CUBE, [f[::-1] for f in BOX], "the faces point inwards: the volume they enclose is -1 m3"),
        (CUBE, [BOX[0][::-1], *BOX[1:]], "faces 1 and 3 run the same way along the edge"),
        (CUBE, [(0, 3, 2, 1), *BOX[1:]], r"face 1 crosses itself at \(0.5, 0.5, 0\) m"),
        (OUT, BOX, r"face 2 is not planar: vertex \d at .* stands 1.25 mm off its plane"),
        (np.zeros((10**6, 3)), BOX, f"1,000,000 vertices are more than the {MOST_VERTICES:,}"),
        (CUBE, [*BOX[:5], (1, 3, 9, 5)], "face 6 uses vertex 9, but there are 8 vertices"),
        (CUBE, [*BOX[:5], (1, 3, -1, 5)], "face 6 uses vertex -1, but there are 8 vertices"),
        (CUBE, [*BOX[:5], (1, 3, 3, 5)], "face 6 meets vertex 3 twice"),
        (CUBE, BOX[:3], "3 faces close no volume"),
        (CUBE * [1, 1, 0], BOX, "face 3 has no area"),
        (np.where(CUBE == 1, np.nan, CUBE), BOX, "not finite"),
        (CUBE[:, :2], BOX, r"vertices have shape \(8, 2\)"),
    ],
)  # fmt: skip
def test_what_is_no_block_is_told(points: np.ndarray, faces: list[tuple[int, ...]], words: str) -> None:
    with pytest.raises(GeometryError, match=words) as caught:
        Polyhedron("stone 7", points, faces)
    assert caught.value.where == "block 'stone 7'"
    assert caught.value.hint


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_surface_through_itself_is_told(scale: float) -> None:
    # an upper and a lower pyramid over the same square, the lower apex pulled up through the upper sides
    points = PIERCED.copy()
    points[5] = (1.9, 1, 0.6)
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (1, 0, 5), (2, 1, 5), (3, 2, 5), (0, 3, 5)]
    faults = polyhedron_faults(scale * points, faces)
    assert [f.kind for f in faults] == ["piercing"]
    assert "runs through itself" in faults[0].sentence


def test_faces_that_are_no_lists_and_other_slips() -> None:
    with pytest.raises(InputError, match="faces = 5 must be a sequence"):
        Polyhedron("b", CUBE, 5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="kind 'soft'"):
        Polyhedron("b", CUBE, BOX, kind="soft")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="mesh size -1"):
        Polyhedron("b", CUBE, BOX, mesh_size=-1.0)
    with pytest.raises(GeometryError, match="not the lower and the upper corner"):
        box("b", (0, 0, 0), (1, -1, 1))


def test_vertices_no_face_uses_are_left_out() -> None:
    block = Polyhedron("b", np.vstack([[9.0, 9, 9], CUBE]), [tuple(v + 1 for v in f) for f in BOX])
    assert len(block.vertices) == 8
    assert block.volume == pytest.approx(1.0)


def test_repr_is_short() -> None:
    assert repr(l_block("corner stone")) == "Polyhedron('corner stone', 12 vertices, 8 faces, volume 3 m3, elastic)"
