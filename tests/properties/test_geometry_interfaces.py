"""Interfaces do not depend on where the wall stands, how its blocks are numbered, or from which side it is seen."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from concio.model.generate.bonds import Course, head_joints
from concio.model.generate.rubble import rubble
from concio.model.generate.walls import wall
from concio.model.interfaces.detect import FACING_ANGLE, detect_interfaces
from concio.model.model import Body
from samples import sample


def copies(bodies, change, order=None):
    order = range(len(bodies)) if order is None else order
    return [Body(bodies[k].name, change(bodies[k].outline), kind=bodies[k].kind) for k in order]


def summary(bodies, found):
    """Names, length and gaps of each interface, in a fixed order."""
    rows = []
    for f in found.interfaces:
        names = tuple(sorted((bodies[f.a].name, bodies[f.b].name)))
        rows.append((*names, f.length, float(f.gap.max())))
    return sorted(rows)


def same(first, second):
    """Same names, and lengths and gaps equal to a millionth (rounded numbers may differ in the last figure)."""
    assert [row[:2] for row in first] == [row[:2] for row in second]
    np.testing.assert_allclose([row[2:] for row in first], [row[2:] for row in second], rtol=0, atol=1e-6)


@st.composite
def assemblies(draw):
    if draw(st.booleans()):
        model = rubble(length=2, height=1, stone=0.4, seed=draw(st.integers(0, 1000)))
    else:
        model = wall(length=1.5, height=0.5, bond=draw(st.sampled_from(["running", "english", "flemish"])))
    # a joint opens here and there
    rng = np.random.default_rng(draw(st.integers(0, 1000)))
    return [Body(b.name, b.outline + rng.choice([0, 0, 2e-3]) * np.array([0, 1]), kind=b.kind) for b in model.bodies]


@settings(max_examples=sample(8, 20), deadline=None)
@example(rubble(length=2, height=1, stone=0.4, seed=0).outlines, 1.7130895010113997e-304, (0.0, 0.0), 0.0)
@given(assemblies(), st.floats(0, 6.28), st.tuples(st.floats(-5, 5), st.floats(-5, 5)), st.sampled_from([0.0, 5e-3]))
def test_rigid_motion_changes_nothing(bodies, angle, move, reach):
    c, s = np.cos(angle), np.sin(angle)
    turned = copies(bodies, lambda x: x @ np.array([[c, s], [-s, c]]) + move)
    first = detect_interfaces(bodies, tolerance=1e-5, reach=reach)
    second = detect_interfaces(turned, tolerance=1e-5, reach=reach)
    same(summary(bodies, first), summary(turned, second))
    for f in second.interfaces:  # the frame turns with the wall; the edge of a leans from it by half the angle at most
        along = (f.end - f.start) / f.length
        np.testing.assert_allclose(along, [-f.normal[1], f.normal[0]], rtol=0, atol=np.sin(0.5 * FACING_ANGLE) + 1e-9)


@settings(max_examples=sample(8, 20), deadline=None)
@given(assemblies(), st.integers(0, 1000))
def test_renumbering_and_mirror_change_nothing(bodies, seed):
    order = np.random.default_rng(seed).permutation(len(bodies))
    first = detect_interfaces(bodies, tolerance=1e-5, reach=5e-3)
    for other in (copies(bodies, lambda x: x, order), copies(bodies, lambda x: (x * [-1, 1])[::-1])):
        same(summary(bodies, first), summary(other, detect_interfaces(other, tolerance=1e-5, reach=5e-3)))


@pytest.mark.parametrize(
    ("stones", "gaps", "names"),
    [(119, 590, ("s02", "s05")), (942, 402, ("s02", "s03")), (584, 711, ("s01", "s02"))],
)
def test_a_stone_does_not_hide_its_own_edge(stones, gaps, names):
    """The cut of the space between two edges with the stone they belong to came out whole, seen from one side only."""
    rng = np.random.default_rng(gaps)
    model = rubble(length=2, height=1, stone=0.4, seed=stones)
    bodies = [Body(b.name, b.outline + rng.choice([0, 0, 2e-3]) * np.array([0, 1]), kind=b.kind) for b in model.bodies]
    mirrored = copies(bodies, lambda x: (x * [-1, 1])[::-1])
    found = [summary(b, detect_interfaces(b, tolerance=1e-5, reach=5e-3)) for b in (bodies, mirrored)]
    same(*found)
    assert names in [row[:2] for row in found[0]]


@settings(max_examples=sample(8, 20), deadline=None)
@given(assemblies())
def test_normals_point_from_a_to_b(bodies):
    for f in detect_interfaces(bodies, tolerance=1e-5, reach=5e-3).interfaces:
        assert f.a < f.b
        middle = 0.5 * (f.start + f.end)
        step = min(1e-3, 0.1 * f.length)
        inside, outside = middle - step * f.normal, middle + (f.gap.mean() + step) * f.normal
        assert contains(bodies[f.a].outline, inside)
        assert contains(bodies[f.b].outline, outside)


def contains(outline, point):
    """Tell by the winding number whether a point lies in an outline."""
    p, q = outline - point, np.roll(outline, -1, axis=0) - point
    turn = np.arctan2(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0], (p * q).sum(1))
    return abs(turn.sum()) > np.pi


lengths = st.floats(0.25, 1.5)


@settings(max_examples=sample(40, 100), deadline=None)
@given(
    st.lists(lengths, min_size=1, max_size=3), st.lists(lengths, max_size=2), st.lists(lengths, max_size=2),
    st.floats(0.3, 20),
)  # fmt: skip
def test_head_joints_rise_from_end_to_end_with_no_short_piece(unit, left, right, length):
    lines = head_joints(Course(tuple(unit), tuple(left), tuple(right)), length)
    assert lines[0] == 0
    assert lines[-1] == length
    assert np.diff(lines).min() >= min(0.25, length) - 1e-9
