"""A structure of any size has the same shape: generators, joints, meshes, contact points, in millimetres as in metres.

Lengths are scaled by powers of two, which change no digit. A tolerance that is not measured by the size of the model
makes another model of it, and so does a length that is taken twice or not at all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import concio
from concio import generate
from concio.fem.polygon_mesh import mesh_polygon
from concio.fem.tetrahedra import tetrahedra
from concio.model.convex_pieces import convex_pieces
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron
from concio.model.surfaces import merged_faces
from samples import sample
from solids import l_block, prism

SCALES = [2.0**-9, 2.0**9]
LARGEST = {"bridge": 2.0**5, "bridge of rings": 2.0**5}  # spans longer than any of masonry are refused
DOOR = {"x": 1.1, "y": 0.0, "width": 0.9, "height": 1.3, "lintel": 0.25, "bearing": 0.15}
WINDOW = {"x": 0.4, "y": 0.6, "width": 0.63, "height": 0.52}


@dataclass(frozen=True)
class Made:
    """A generator, its arguments that are lengths (also in lists and tables), and the others."""

    kind: Callable[..., Model]
    lengths: Mapping[str, Any]
    others: Mapping[str, Any] = field(default_factory=dict)
    forces: Mapping[str, float] = field(default_factory=dict)
    """What acts on an area, and on more of it in proportion."""

    def __call__(self, scale: float) -> Model:
        """Return the model with all lengths times a factor."""
        lengths = {k: scaled(v, scale) for k, v in self.lengths.items()}
        forces = {k: v * scale**2 for k, v in self.forces.items()}
        return self.kind(**lengths, **self.others, **forces, block="rigid")


def scaled(value: Any, scale: float) -> Any:
    """Return numbers in lists and tables times a factor."""
    if isinstance(value, dict):
        return {k: scaled(v, scale) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [scaled(v, scale) for v in value]
    return value * scale


CASES = {
    "wall": Made(generate.wall, {"length": 3.1, "height": 2.0, "block_size": (0.5, 0.25), "openings": [DOOR]}),
    "english wall": Made(
        generate.wall, {"length": 2.0, "height": 1.5, "block_size": (0.4, 0.2), "openings": [WINDOW]},
        {"bond": "english", "lap": 0.25, "side_walls": True, "top_pressure": 3.0},
    ),
    "panels": Made(
        generate.wall,
        {"block_size": (0.5, 0.25), "panels": [
            {"at": (0, 0), "length": 2.0, "height": 1.0}, {"at": (0, 1.0), "length": 1.5, "height": 0.5}]},
    ),
    "courses": Made(
        generate.wall_of_courses, {"block_size": (0.4, 0.2)}, {"courses": [[1, 1, 1], [0.5, 1, 1, 0.5], [1, -1, 1]]}
    ),
    "rubble": Made(
        generate.rubble, {"length": 2.0, "height": 1.2, "stone": 0.4}, {"seed": 3, "top_pressure": 5.0}
    ),
    "semicircular arch": Made(generate.arch, {"span": 2.0, "ring": 0.3}, {"voussoirs": 7, "crown_load": 1.0}),
    "segmental arch": Made(
        generate.arch, {"span": 2.0, "ring": 0.3, "rise": 0.5}, {"voussoirs": 7, "shape": "segmental", "load_at": 0.2,
                                                                 "crown_load": 1.0}
    ),
    "pointed arch": Made(generate.arch, {"span": 2.0, "ring": 0.3}, {"voussoirs": 9, "shape": "pointed"}),
    "flat arch": Made(generate.arch, {"span": 2.0, "ring": 0.4}, {"voussoirs": 7, "shape": "flat"}),
    "arch of chords": Made(
        generate.arch, {"span": 2.0, "ring": 0.3, "chord_tolerance": 0.004}, {"voussoirs": 8}
    ),
    "arch on piers": Made(
        generate.arch_on_piers, {"span": 2.0, "ring": 0.3, "pier_width": 0.8, "pier_height": 2.0, "fill": 0.2},
        {"voussoirs": 9, "pier_courses": 4, "top_pressure": 2.0},
    ),
    "segmental arch on piers": Made(
        generate.arch_on_piers,
        {"span": 3.0, "ring": 0.3, "rise": 0.7, "pier_width": 1.1, "pier_height": 1.5, "fill": 0.15, "course": 0.2,
         "block_length": 0.45},
        {"voussoirs": 12, "pier_courses": 3, "shape": "segmental"},
    ),
    "bridge": Made(
        generate.bridge,
        {"span": [5.0, 6.0], "rise": [1.2, 1.5], "ring": 0.4, "pier_width": 1.2, "pier_height": 3.0, "backing": 0.5},
        {"voussoirs": 14, "pier_courses": 2},
    ),
    "bridge of rings": Made(
        generate.bridge, {"span": 6.0, "rise": 1.5, "ring": [0.2, 0.25]},
        {"voussoirs": [14, 17], "shape": "elliptical"},
    ),
    "column": Made(
        generate.column, {"width": 0.5, "height": 2.0, "eccentricity": 0.1}, {"blocks": 4, "top_force": 2.0}
    ),
    "buttress": Made(
        generate.buttress, {"base": 1.2, "top": 0.7, "height": 3.0, "block_length": 0.5, "thrust_at": 2.3},
        {"courses": 5, "thrust": 1.0},
    ),
    "cell": Made(generate.cell, {"block_size": (0.25, 0.125)}, {"bond": "running", "repeat": (2, 1)}),
    "cell of rubble": Made(
        generate.cell, {"length": 1.0, "height": 1.0, "stone": 0.35}, {"bond": "rubble", "seed": 2}
    ),
    "barrel": Made(generate.barrel, {"span": 2.0, "ring": 0.2, "length": 3.0}, {"voussoirs": 7, "blocks": 3}),
    "skew barrel": Made(
        generate.barrel, {"span": 2.0, "ring": 0.2, "length": 3.0, "rise": 0.6},
        {"voussoirs": 5, "blocks": 2, "shape": "segmental", "skew": 20.0},
    ),
    "dome": Made(
        generate.dome, {"span": 4.0, "ring": 0.4, "oculus": 0.7, "spread": 0.01},
        {"courses": 2, "blocks": 8}, {"lantern": 2.0},
    ),
    "drums": Made(
        generate.drums, {"diameter": 1.0, "height": 3.0, "top_diameter": 0.8, "eccentricity": (0.1, 0.05)},
        {"drums": 3, "sides": 8, "top_force": 1.0},
    ),
    "cloister vault": Made(
        generate.cloister_vault, {"span": 3.0, "ring": 0.3, "block_length": 1.0}, {"courses": 3}
    ),
    "cross vault": Made(
        generate.cross_vault, {"span": 3.0, "ring": 0.3, "block_length": 1.0}, {"courses": 2, "springing": 50.0}
    ),
    "walls in plan": Made(
        generate.walls,
        {"lines": [((0, 0), (2, 0)), ((0, 0), (0, 2))], "height": 0.75, "block_size": (0.5, 0.25, 0.25)},
        {"top_pressure": 2.0},
    ),
    "tower": Made(
        generate.tower,
        {"width": 3.0, "depth": 2.4, "height": 1.5, "block_size": (0.6, 0.3, 0.3),
         "openings": [[{"x": 1.0, "y": 0.3, "width": 0.7, "height": 0.6}]]},
    ),
}  # fmt: skip


def at_scales(scales: list[float]) -> list[tuple[str, float]]:
    """Return cases with the scales at which they are made."""
    return [(case, min(scale, LARGEST.get(case, scale))) for case in CASES for scale in scales]


def corners(body: Any) -> np.ndarray:
    """Return the corners of a body of the plane or of space."""
    return np.asarray(body.vertices if isinstance(body, Polyhedron) else body.outline)


@pytest.mark.parametrize(("case", "scale"), at_scales(SCALES))
def test_what_is_generated_has_its_shape_at_any_size(case: str, scale: float) -> None:
    one, other = CASES[case](1.0), CASES[case](scale)
    assert [(b.name, b.kind, b.layer) for b in one.bodies] == [(b.name, b.kind, b.layer) for b in other.bodies]
    for a, b in zip(one.bodies, other.bodies, strict=True):
        assert corners(b) / scale == pytest.approx(corners(a), abs=1e-9 * one.size)
    for a, b in zip(one.loads, other.loads, strict=True):
        assert (a.kind, a.bodies, a.group) == (b.kind, b.bodies, b.group)
        assert b.value == pytest.approx(a.value)
        if a.at is not None:
            assert np.asarray(b.at) / scale == pytest.approx(np.asarray(a.at), abs=1e-9 * one.size)


@pytest.mark.parametrize(("case", "scale"), at_scales(SCALES[: sample(1, 2)]))
def test_joints_and_contact_points_are_the_same_at_any_size(case: str, scale: float) -> None:
    """Their areas grow with the size, in space with its square; of the plane the thickness stays."""
    one, other = (concio.assemble(CASES[case](s)) for s in (1.0, scale))
    assert len(one.detection.near_misses) == len(other.detection.near_misses)
    assert len(one.detection.not_made) == len(other.detection.not_made)
    p, q = one.pairs, other.pairs
    assert np.array_equal(p.body_a, q.body_a)
    assert np.array_equal(p.body_b, q.body_b)
    assert q.point / scale == pytest.approx(p.point, abs=1e-9 * one.model.size)
    assert q.normal == pytest.approx(p.normal, abs=1e-9)
    area = scale ** (one.model.dim - 1)
    assert q.area / area == pytest.approx(p.area, rel=1e-9)
    assert q.gap / scale == pytest.approx(p.gap, abs=1e-9 * one.model.size)


TRAPEZIUM = np.array([(0, 0), (1, 0), (0.8, 0.6), (0.1, 0.5)])
L_SHAPE = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2.0)])
SLENDER = np.array([(0, 0), (4, 0), (4, 0.1), (2, 0.08), (0, 0.1)])


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize(("outline", "size"), [(TRAPEZIUM, 0.2), (L_SHAPE, 0.35), (SLENDER, 0.07)])
def test_a_polygon_has_the_same_mesh_at_any_size(outline: np.ndarray, size: float, scale: float) -> None:
    breaks = [np.array([0.3]), *[np.zeros(0)] * (len(outline) - 1)]
    points, cells = mesh_polygon(outline, size, breaks)
    other, same = mesh_polygon(scale * outline, scale * size, [scale * b for b in breaks])
    assert np.array_equal(cells, same)
    assert other / scale == pytest.approx(points, abs=1e-9)


@pytest.mark.parametrize("scale", SCALES)
def test_a_solid_has_the_same_mesh_at_any_size(scale: float) -> None:
    block = l_block("l")
    points, cells = tetrahedra(block, 0.3)
    other, same = tetrahedra(Polyhedron("l", scale * block.vertices, block.faces), scale * 0.3)
    assert np.array_equal(cells, same)
    assert other / scale == pytest.approx(points, abs=1e-9)


@pytest.mark.parametrize("scale", SCALES)
def test_triangles_of_one_plane_are_put_together_at_any_size(scale: float) -> None:
    """And those of planes that differ are not: a pyramid as flat as a hundredth keeps its four slopes."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 0.01)])
    faces = [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    points, merged, _ = merged_faces(scale * corners, faces)
    assert sorted(len(face) for face in merged) == [3, 3, 3, 3, 4]
    assert len(points) == 5


@pytest.mark.parametrize("scale", [2.0**-24, 2.0**-12, 2.0**12, 2.0**24])
def test_a_block_of_any_size_is_cut_into_the_same_convex_pieces(scale: float) -> None:
    base = np.array([[0, 0, 0], [2, 0, 0], [2.2, 1.1, 0], [1, 0.8, 0], [0, 2, 0]], dtype=float)
    body = prism("arrow", [base], np.array([0.0, 0.0, 1.0]))
    large = Polyhedron("arrow", np.asarray(body.vertices) * scale, body.faces)
    pieces, found = convex_pieces(body), convex_pieces(large)
    assert pieces is not None
    assert found is not None
    assert len(found) == len(pieces) > 1
    for one, other in zip(pieces, found, strict=True):
        np.testing.assert_allclose(other.vertices / scale, one.vertices, atol=1e-8)
        np.testing.assert_allclose(other.offsets / scale, one.offsets, atol=1e-8)


@pytest.mark.parametrize("scale", [2.0**-6, 1.0, 2.0**4])
@pytest.mark.parametrize("wrong", [0.0, 1e-4, -1e-4])
def test_headers_fill_two_wythes_or_do_not_at_any_size(wrong: float, scale: float) -> None:
    size = (0.5 * scale, 0.25 * scale * (1 + wrong), 0.25 * scale)
    made = {"lines": [((0, 0), (2.0 * scale, 0))], "height": 0.5 * scale, "block_size": size, "wythes": 2}
    for bond in ({"bond": "english"}, {"bond": "running", "headers": 2}):
        if wrong:
            with pytest.raises(concio.InputError, match="do not fill two wythes"):
                concio.walls(**made, **bond, friction=0.6)
        else:
            assert concio.walls(**made, **bond, friction=0.6).bodies
