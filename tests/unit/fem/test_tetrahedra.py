"""Meshes of tetrahedra: filled, as fine as asked for on faces and inside, no finer."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from concio.fem.tetrahedra import shape_of, tetrahedra
from concio.model.interfaces.near_space import distance_to_surface
from concio.model.polyhedron import Polyhedron
from solids import box, l_block, turned


@pytest.mark.parametrize(("block", "size"), [(l_block("l"), 0.3), (turned(box("b", (0, 0, 0), (1.6, 1.2, 0.8))), 0.25)])
def test_nodes_cover_faces_and_inside_at_the_distance_asked_for(block: Polyhedron, size: float) -> None:
    """No point of a face or of the inside is much further from a node than the size, and nodes are not crowded."""
    points, cells = tetrahedra(block, size)
    x = points[cells]
    volume = np.linalg.det(x[:, 1:] - x[:, :1]) / 6
    assert volume.min() > 0
    assert volume.sum() == pytest.approx(block.volume, rel=1e-9)
    tree = cKDTree(points)
    assert tree.query(points, k=2)[0][:, 1].min() > 0.25 * size
    for face, normal in enumerate(block.normals):
        on = points[np.abs(points @ normal - block.offsets[face]) < 1e-9]
        corner = block.vertices[list(block.faces[face])]
        if len(corner) == 4:  # a rectangle
            a, b = (v.ravel()[:, None] for v in np.meshgrid(np.linspace(0, 1, 25), np.linspace(0, 1, 25)))
            grid = corner[0] + a * (corner[1] - corner[0]) + b * (corner[3] - corner[0])
            assert cKDTree(on).query(grid)[0].max() < 0.85 * size
    inside = np.einsum("kc,tcd->tkd", np.full((1, 4), 0.25), x).reshape(-1, 3)
    assert tree.query(inside)[0].max() < 0.95 * size


@pytest.mark.parametrize("height", [0.2, 0.25, 0.28])
@pytest.mark.parametrize("is_turned", [False, True])
def test_nodes_inside_of_a_thin_block_stay_clear_of_its_faces(height: float, is_turned: bool) -> None:
    """As thin as one or two elements: where nodes inside are moved for better elements, a node at a face spoils one.

    Where all nodes but a few stand on two parallel faces many elements are flat at first, however the block is turned.
    """
    for plain in (box("b", (0, 0, 0), (1.0, 0.7, height)), l_block("l", height=height)):
        block = turned(plain) if is_turned else plain
        points, cells = tetrahedra(block, 0.2)
        away = distance_to_surface(block, points)
        inside = away > 1e-9
        assert inside.any() or not is_turned
        assert away[inside].min(initial=1.0) > (0.24 if height > 0.2 else 0.1) * 0.2
        assert shape_of(points, cells).min() > 0.12
