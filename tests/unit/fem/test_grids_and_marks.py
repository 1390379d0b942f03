"""Grids of hexahedra and the marks of joints on their faces."""

from __future__ import annotations

import numpy as np

from concio.fem.solid_mesh import Mark, _grid_mesh


def test_a_grid_of_hexahedra_has_nodes_along_the_sides_of_marks() -> None:
    """A joint covers a part of the upper face of a box that is divided into cells of 0.4: its sides are edges too."""
    sides = [(0.3, 0.2, 0.4), (0.9, 0.2, 0.4), (0.9, 0.8, 0.4), (0.3, 0.8, 0.4)]
    x, y, z = np.meshgrid([0.0, 1.2], [0.0, 0.8], [0.0, 0.4], indexing="ij")
    points, _ = _grid_mesh(np.stack([x, y, z], axis=-1), 0.4, 1, [Mark(5, np.array(sides))])
    assert {0.0, 0.3, 0.9, 1.2} <= set(np.round(points[:, 0], 9).tolist())
    assert {0.0, 0.2, 0.8} <= set(np.round(points[:, 1], 9).tolist())
    assert {0.0, 0.4} <= set(np.round(points[:, 2], 9).tolist())
