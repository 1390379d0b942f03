"""Convex pieces of blocks: together the block, nothing twice, with the directions of its own edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from concio.model.convex_pieces import ConvexPiece, convex_pieces
from concio.model.interfaces.near_space import winding
from concio.model.polyhedron import Polyhedron
from concio.model.surfaces import prism
from solids import TURN, box, frame_block, l_block, turned, voussoir


def scaled(block: Polyhedron, unit: float) -> Polyhedron:
    """Return a block in another unit of length."""
    return replace(block, vertices=block.vertices * unit)


def plate(thickness: float) -> Polyhedron:
    """Return an L of 2 x 2 that is thin."""
    return l_block("plate", height=thickness)


def u_block() -> Polyhedron:
    """Return a prism over a U, which takes two cuts."""
    base = [[0, 0, 0], [3, 0, 0], [3, 2, 0], [2, 2, 0], [2, 0.7, 0], [1.2, 0.7, 0], [1.2, 1.5, 0], [0, 1.5, 0]]
    return prism("u", [np.array(base, dtype=float)], np.array([0, 0, 1.1]))


def stands_out(piece: ConvexPiece, points: np.ndarray) -> np.ndarray:
    """Return how far points (n, 3) stand out of the planes of a piece [m]."""
    return np.asarray((points @ piece.normals.T - piece.offsets).max(axis=1))


BLOCKS = {
    "l": l_block("l"), "frame": frame_block("frame"), "u": u_block(), "thin": plate(2e-4),
    "box": box("b", (0, 0, 0), (1, 2, 3)), "small": scaled(l_block("l"), 1e-3),
    "large": scaled(frame_block("frame"), 1e3),
}  # fmt: skip


@pytest.mark.parametrize("name", BLOCKS)
@pytest.mark.parametrize("is_turned", [False, True])
def test_pieces_fill_a_prism_once(name: str, is_turned: bool) -> None:
    """Volumes add up; a point of the block is in one piece, one outside in none."""
    block = turned(BLOCKS[name]) if is_turned else BLOCKS[name]
    pieces = convex_pieces(block)
    assert pieces is not None
    assert (len(pieces) > 1) == (name != "box")
    size = float(np.ptp(block.vertices, axis=0).max())
    volumes = [ConvexHull(p.vertices).volume for p in pieces]
    assert sum(volumes) == pytest.approx(block.volume, rel=1e-6, abs=1e-9 * size**3)
    assert all(np.abs(stands_out(p, p.vertices)).max() <= 1e-6 * size for p in pieces)
    rng = np.random.default_rng(3)
    low, high = block.vertices.min(axis=0), block.vertices.max(axis=0)
    points = low + rng.random((400, 3)) * (high - low)
    clear = np.all([np.abs(stands_out(p, points)) > 1e-5 * size for p in pieces], axis=0)
    inside = np.sum([stands_out(p, points) < 0 for p in pieces], axis=0)
    np.testing.assert_array_equal(inside[clear], (winding(block, points) > 0.5)[clear])
    assert inside.max() == 1 or name == "thin"


@pytest.mark.parametrize("name", BLOCKS)
@pytest.mark.parametrize("is_turned", [False, True])
def test_edges_of_pieces_of_a_right_prism_have_its_three_directions(name: str, is_turned: bool) -> None:
    block = turned(BLOCKS[name]) if is_turned else BLOCKS[name]
    pieces = convex_pieces(block)
    assert pieces is not None
    axes = TURN.T if is_turned else np.eye(3)
    for piece in pieces:
        assert len(piece.directions) == 3
        assert np.abs(piece.directions @ axes.T).max(axis=1) == pytest.approx(np.ones(3), abs=1e-6)


def test_cells_of_a_grid_are_its_pieces_as_they_are() -> None:
    """A piece of a dome of two cells: folded outside, each cell convex enough or cut up with the same volume."""
    block = voussoir()
    pieces = convex_pieces(block)
    assert pieces is not None
    assert sum(ConvexHull(p.vertices).volume for p in pieces) == pytest.approx(block.volume, rel=0.02)
