"""Blocks in space that several tests use; none is symmetric in all three axes."""

from __future__ import annotations

import numpy as np

from concio.kinematics.rigid import rotation_matrix
from concio.model.polyhedron import BOX, Polyhedron
from concio.model.surfaces import from_grid, prism

TURN = rotation_matrix(np.array([0.3, -0.5, 0.8]))
"""A rotation about no axis in particular."""


def box(name: str, low: tuple[float, ...], high: tuple[float, ...], **fields: object) -> Polyhedron:
    """Return a box."""
    return Polyhedron.box(name, low, high, **fields)


def l_block(name: str, height: float = 1.0, low: float = 0.0, **fields: object) -> Polyhedron:
    """Return a prism over an L of 2 x 2 with legs 1 wide, area 3."""
    base = np.array([[0, 0, low], [2, 0, low], [2, 1, low], [1, 1, low], [1, 2, low], [0, 2, low]], dtype=float)
    return prism(name, [base], np.array([0, 0, height]), **fields)


def frame_block(name: str, height: float = 1.0, low: float = 0.0, **fields: object) -> Polyhedron:
    """Return a prism of 3 x 2 with a hole of 1 x 0.5 that is not in the middle, area 5.5."""
    outer = np.array([[0, 0, low], [3, 0, low], [3, 2, low], [0, 2, low]], dtype=float)
    inner = np.array([[0.5, 0.5, low], [0.5, 1, low], [1.5, 1, low], [1.5, 0.5, low]], dtype=float)
    return prism(name, [outer, inner], np.array([0, 0, height]), **fields)


def voussoir(name: str = "voussoir", **fields: object) -> Polyhedron:
    """Return a piece of a dome of two cells along the parallel: its faces are folded, it is not convex."""
    r, lon, lat = np.meshgrid([5.0, 5.6], [-0.2, 0.0, 0.2], [0.1, 0.35], indexing="ij")
    at = np.stack([r * np.cos(lat) * np.cos(lon), r * np.cos(lat) * np.sin(lon), r * np.sin(lat)], -1)
    return from_grid(name, at, **fields)


def tetrahedron(name: str, corners: np.ndarray, **fields: object) -> Polyhedron:
    """Return the tetrahedron of four right-handed corners."""
    return Polyhedron(name, corners, ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)), **fields)


def turned(block: Polyhedron, turn: np.ndarray = TURN, shift: tuple[float, ...] = (0.7, -1.3, 2.1)) -> Polyhedron:
    """Return a block turned and moved as a whole."""
    def placed(points: np.ndarray) -> np.ndarray:
        return points @ turn.T + np.array(shift)

    grid = None if block.grid is None else placed(block.grid)
    return Polyhedron(
        block.name, placed(block.vertices), block.faces, block.material, block.kind, block.role, block.layer,
        block.holes, grid, block.mesh_size,
    )  # fmt: skip


__all__ = ["BOX", "TURN", "box", "frame_block", "l_block", "tetrahedron", "turned", "voussoir"]
