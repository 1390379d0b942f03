"""Vertices of polyhedra of stresses, beside those of all triples of faces."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from concio.analysis.cells.half_spaces import HalfSpaces


def of_triples(faces: HalfSpaces) -> np.ndarray:
    """Return the points in which three faces meet and that lie inside all others, each once (v, 3)."""
    found: list[np.ndarray] = []
    size = np.abs(faces.offsets).max()
    for three in combinations(range(len(faces)), 3):
        normals = faces.normals[list(three)]
        if abs(np.linalg.det(normals)) < 1e-9:
            continue
        point = np.linalg.solve(normals, faces.offsets[list(three)])
        far = size + np.abs(point).max()
        if faces.margin(point) > -1e-9 * far and all(np.abs(point - other).max() > 1e-7 * far for other in found):
            found.append(point)
    return np.array(found)


def alike(faces: HalfSpaces) -> int:
    """Compare the vertices, each of which is found once; return how many there are."""
    points, own = faces.vertices
    wanted = of_triples(faces)
    apart = np.abs(points[own][:, None] - wanted).max(axis=2) / (faces.size + np.abs(wanted).max(axis=1))
    assert len(wanted) == own.sum()
    assert apart.min(axis=0).max() < 1e-9
    assert apart.min(axis=1).max() < 1e-9
    return len(wanted)


@pytest.mark.parametrize("size", [1.0, 1e-4, 1e6])
@pytest.mark.parametrize("seed", range(3))
def test_vertices_are_those_of_all_triples_of_faces(seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    normals, middle = rng.normal(size=(9, 3)), rng.normal(size=3)
    faces = HalfSpaces.of(normals, size * (normals @ middle + rng.uniform(0.2, 2.0, 9)))
    assert alike(faces) >= 1
    assert alike(faces.reduced()) == len(of_triples(faces))


def test_vertices_far_out_on_one_ray_are_two() -> None:
    """A flat prism on an edge through the origin, between x = 1.5 and 4: all faces pass the origin nearer than that."""
    slope = 0.3
    normals = [(0, 0, 1), (0, 0, -1), (0, -1, 0), (-slope, 1, 0), (slope, 1, 0)]
    faces = HalfSpaces.of(np.array(normals, dtype=float), np.array([0.0, 0.2, 0.0, -1.5 * slope, 4.0 * slope]))
    points, own = faces.vertices
    assert faces.size < 1.5
    for x in (1.5, 4.0):
        assert np.abs(points[own] - [x, 0.0, 0.0]).max(axis=1).min() < 1e-9
    assert alike(faces) == 6
