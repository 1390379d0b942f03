"""Points of capacity curves by virtual work: blocks turned by hand, forces and ties on the way between two places."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio import Tie
from concio.analysis.seismic.linkage import Linkage, Point
from seismic_walls import bending, overturning, site

STEP = 1e-5
"""Displacement of the control point to either side, in metres: differences are right to its square."""


def place(linkage: Linkage, q: np.ndarray, block: int, point: tuple[float, float] | np.ndarray) -> np.ndarray:
    """Return where a point of a macro-block is; a fixed point stays."""
    at = np.asarray(point, dtype=float)
    if block < 0:
        return at
    centre, (x, y, turn) = np.asarray(linkage.mechanics.blocks[block].centre), q[block]
    c, s = np.cos(turn), np.sin(turn)
    return np.asarray(centre + np.array([[c, -s], [s, c]]) @ (at - centre) + [x, y])


def work(linkage: Linkage, point: Point, kind: str) -> float:
    """Return the work of dead loads, of the push, or of the ties along the mechanism, by central differences."""
    at = float(linkage.controlled(point.q)[0])
    before, after = (linkage.moved(point.q, at + side) for side in (-STEP, STEP))
    assert before is not None
    assert after is not None
    if kind == "ties":
        ends = [(place(linkage, q, a, t.at_a), place(linkage, q, b, t.at_b))
                for q in (before, after) for t, a, b in linkage.ties]  # fmt: skip
        longer = np.diff([float(np.linalg.norm(b - a)) for a, b in ends][:: len(linkage.ties)])
        return -float(point.tie_force[0] * longer[0]) / (2 * STEP)
    forces = linkage.dead if kind == "dead" else linkage.push
    return sum(
        float(np.dot(f.force, place(linkage, after, f.block, f.point) - place(linkage, before, f.block, f.point)))
        for f in forces
    ) / (2 * STEP)


@pytest.mark.parametrize("seed", [1, *(pytest.param(k, marks=pytest.mark.long) for k in (0, 2, 3, 4, 5))])
def test_the_multiplier_of_every_point_does_no_work(seed: int) -> None:
    """alpha times the work of the push, that of all dead loads, and that of a tie that is stretched come to nothing."""
    rng = np.random.default_rng(seed)
    z, k = float(rng.uniform(2.0, 5.9)), float(10 ** rng.uniform(1.0, 2.5))
    prestress, most = float(rng.uniform(0.0, 2.0)), float(rng.uniform(4.0, 20.0))
    n = int(rng.integers(1, 4))
    block = f"c{int(np.ceil(z / (6.0 / n)))}"
    far = (4.0, z + float(rng.uniform(-1, 1)))
    tie = Tie("rod", block, (0.3, z), "", far, k, prestress=prestress, yield_force=most)
    found = concio.assess(overturning(n, ties=(tie,)), site=site(), direction="left", levels=["SLV"])
    checked = 0
    for m in (*found.mechanisms, *found.others):
        if not len(m.followed.points) or not m.linkage.ties:
            continue
        for p in m.followed.points[:-1:3]:
            left = p.multiplier * work(m.linkage, p, "push") + work(m.linkage, p, "dead") + work(m.linkage, p, "ties")
            assert left == pytest.approx(0.0, abs=1e-6 * abs(work(m.linkage, p, "dead")))
            stretched = min(max(prestress + k * p.elongation[0], 0.0), most)
            assert p.tie_force[0] == pytest.approx(stretched, rel=1e-9, abs=1e-9)
            checked += p.tie_force[0] > 0
    assert checked >= 3, "points at which the tie pulls"


@pytest.mark.parametrize("courses", [2, pytest.param(8, marks=pytest.mark.long)])
def test_a_wall_that_bends_does_no_work_either(courses: int) -> None:
    found = concio.assess(bending(courses), site=site(), direction="right", levels=["SLV"], live="live")
    assert found.worst is not None
    for p in found.worst.followed.points[:-1:4]:
        left = p.multiplier * work(found.worst.linkage, p, "push") + work(found.worst.linkage, p, "dead")
        assert left == pytest.approx(0.0, abs=1e-6 * abs(work(found.worst.linkage, p, "dead")))
