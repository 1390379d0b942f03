"""Joints that crush near an edge: N = f_c t (w - 2 e) by hand, in the plane and in space, and what the points cost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely

import concio
from concio import JointLaw, Load, Model, Polyhedron, Rigid
from concio.analysis.limit import dead_and_live
from concio.contact.joint_points import edge, graded_error, graded_half, graded_rule, joint_rule, points_along
from concio.contact.patch_points import CRUSHING, _together, spread_points
from concio.model.interfaces.patches import Patch
from concio.solvers.statics.associated_limit import associated_limit
from samples import sample

OUTLINES = (
    [(0, 0), (2, 0), (2, 1), (0, 1)],
    [(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)],
    [(0, 0), (1, 0), (0, 2)],
    [(0, 0), (2, 0), (3, 1), (1, 3), (-1, 1)],
    [(0, 0), (3, 0), (2, 1), (0, 1)],
)
WIDTH, DEPTH, STRENGTH = 0.5, 0.4, 2000.0


def pressed(eccentricity: float, dim: int, points: str | int = "auto", width: float = WIDTH) -> Model:
    """Return a block without weight on the ground, pressed by a unit force at a distance from its middle."""
    law = JointLaw(0.5, compressive_strength=STRENGTH)
    at = width / 2 + eccentricity
    bodies: tuple[concio.Body | Polyhedron, ...]
    if dim == 2:
        rectangle = [(n, np.array([[a, b], [c, b], [c, d], [a, d]])) for n, a, b, c, d in (
            ("ground", -1.0, -0.3, width + 1, 0.0), ("b", 0.0, 0.0, width, 1.0))]  # fmt: skip
        bodies = tuple(
            concio.Body(n, x, thickness=DEPTH, kind="fixed" if n == "ground" else "rigid") for n, x in rectangle
        )
        load = Load("point", (0, -1), bodies=("b",), at=(at, 1.0), group="live")
    else:
        bodies = (
            Polyhedron.box("ground", (-1, -1, -0.3), (width + 1, 2, 0), kind="fixed"),
            Polyhedron.box("b", (0, 0, 0), (width, DEPTH, 1.0), kind="rigid"),
        )
        load = Load("point", (0, 0, -1), bodies=("b",), at=(at, DEPTH / 2, 1.0), group="live")
    return Model(bodies, {"block": Rigid(0.0)}, {"joint": law}, loads=(load,), contact_points=points)


def carried(model: Model) -> float:
    return associated_limit(*dead_and_live(concio.assemble(model), "live")).multiplier


@pytest.mark.parametrize("share", [0.0, 0.1, 0.3, 0.40, 0.42, 0.44, 0.46, 0.48])
def test_near_an_edge_the_plane_crushes_at_the_strength_by_hand(share: float) -> None:
    """With 9 equal points 0.67 at .44 and 1.24 at .48 of the hand value were certified."""
    by_hand = STRENGTH * DEPTH * WIDTH * (1 - 2 * share)
    assert carried(pressed(share * WIDTH, 2)) == pytest.approx(by_hand, rel=0.02)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.40, 0.44, 0.46, 0.48])
def test_near_an_edge_space_crushes_within_the_error_told(share: float) -> None:
    """With 12 points a side, whose outer share was 2.8 % of the width, 1.11 of the hand value were certified at .48."""
    by_hand = STRENGTH * DEPTH * WIDTH * (1 - 2 * share)
    assert carried(pressed(share * WIDTH, 3)) == pytest.approx(by_hand, rel=graded_error(CRUSHING))


def test_more_points_in_space_reach_the_edge() -> None:
    by_hand = STRENGTH * DEPTH * WIDTH * 0.04
    assert carried(pressed(0.48 * WIDTH, 3, 20)) == pytest.approx(by_hand, rel=0.021)


@pytest.mark.parametrize("points", [8, 10, 12, 16, 20])
def test_the_strength_of_a_graded_rule_is_within_its_error_and_beyond_it_within_the_first_share(points: int) -> None:
    """The largest N whose centroid is d from the edge, against 2 d; filled from the edge, c the shares."""
    x, share = graded_rule(points)
    full, moment = np.concatenate([[0], np.cumsum(share)]), np.concatenate([[0], np.cumsum(share * x)])
    for d in np.linspace(1e-4, 0.5, 300):
        N = np.linspace(0.0, 1.0, 20_001)
        most = N[np.flatnonzero(np.interp(N, full, moment) <= N * d + 1e-12)[-1]]
        if d >= edge(points):
            assert most == pytest.approx(2 * d, rel=1.2 * graded_error(points))
        assert most - 2 * d < max(edge(points), graded_error(points) * 2 * d) + 1e-4


@pytest.mark.parametrize("points", [2, 5, 8, 12, 20])
def test_rules_along_a_joint_have_its_length_its_middle_and_both_ends(points: int) -> None:
    x, share = joint_rule(points)
    assert (x[0], x[-1]) == (0.0, 1.0)
    assert (np.diff(x) > 0).all()
    assert (share > 0).all()
    assert share.sum() == pytest.approx(1.0, rel=1e-14)
    assert share @ x == pytest.approx(0.5, rel=1e-14)
    if points > 2:
        assert share @ (x - 0.5) ** 2 == pytest.approx(1 / 12, rel=1e-12)


def test_half_a_rule_has_the_moments_of_its_length_about_the_middle() -> None:
    x, share = graded_half(10)
    assert share.sum() == pytest.approx(1.0)
    assert share @ (1 - x) ** 2 == pytest.approx(1 / 3)


@pytest.mark.parametrize("n", [8, 12, 13])
def test_graded_points_over_a_patch_keep_its_area_and_centroid(n: int) -> None:
    for outline in OUTLINES:
        ring = np.column_stack([np.array(outline, dtype=float), np.zeros(len(outline))])
        zero, area = np.zeros(len(ring)), shapely.Polygon(ring[:, :2]).area
        patch = Patch(0, 1, 0, 0, ring, np.array([0, 0, 1.0]), zero, zero, area, ())
        x, w = spread_points(patch, n, graded=True)
        assert (w > 0).all()
        assert w.sum() == pytest.approx(patch.area, rel=1e-12)
        assert np.allclose(w @ x / w.sum(), patch.middle, atol=1e-12)


@pytest.mark.parametrize("seed", range(sample(5, 25)))
def test_crushing_scales_with_the_joint(seed: int) -> None:
    """The share of the strength is a function of e / w alone, whatever the width."""
    rng = np.random.default_rng(seed)
    share, width = rng.uniform(0.0, 0.48), float(np.exp(rng.uniform(-2, 2)))
    one = carried(pressed(share * width, 2, width=width)) / (STRENGTH * DEPTH * width)
    assert one == pytest.approx(1 - 2 * share, rel=0.021)


def test_only_joints_that_crush_have_many_points() -> None:
    assert [points_along(None, None), points_along(None, 1e5), points_along(2e3, 1e5)] == [2, 5, 20]
    with pytest.raises(ValueError, match="cannot be graded"):
        graded_rule(7)


def test_how_well_crushing_is_told_stands_in_the_verdict() -> None:
    plane = concio.solve(pressed(0.1, 2), factors={"live": 10.0})
    assert any("right to 2 %" in line for line in plane.verdict.limits)
    space = concio.solve(pressed(0.1, 3), factors={"live": 10.0})
    assert any("14 x 14 points: their strength is right to 5 %" in line for line in space.verdict.limits)
    few = concio.solve(pressed(0.1, 3, 4), factors={"live": 10.0})
    assert any("too few points" in line for line in few.verdict.limits)
    tied = concio.Tie("tie", "b", (0.0, 0.5), "", (-1.0, 0.5), stiffness=1e3, yield_force=5.0)
    hard = replace(pressed(0.1, 2), laws={"joint": JointLaw(0.5)}, ties=(tied,))
    assert not any("crush" in line for line in concio.solve(hard, factors={"live": 10.0}).verdict.limits)


@pytest.mark.parametrize("size", [1e-4, 1.0, 1e4])
def test_points_that_parts_share_are_one_whatever_the_size_of_the_joint(size: float) -> None:
    """A grid of nine points, each three times but for rounding: their areas are added, none is lost."""
    grid = size * np.array([(x, y) for x in (0.0, 0.4, 1.0) for y in (0.0, 0.5, 0.9)])
    rng = np.random.default_rng(0)
    points = np.vstack([grid + 1e-13 * size * rng.uniform(-1, 1, grid.shape) for _ in range(3)])
    found, weights = _together(points, np.tile(np.arange(1.0, 10.0), 3))
    assert len(found) == 9
    assert sorted(weights.tolist()) == [3.0 * k for k in range(1, 10)]
