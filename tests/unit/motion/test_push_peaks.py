"""The peak of a push does not depend on its step, and what happens between two steps is located."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.motion.located import _bound, highest
from concio.analysis.motion.push_result import PushEnding
from models import box, model_of, weight
from samples import sample

DRY = 0.8


def pillar(rng, ties=()):
    """A leaning pillar pushed by a group, or by its weight."""
    half, high, lean = rng.uniform(0.1, 0.3), rng.uniform(1.0, 2.0), rng.uniform(-0.08, 0.08)
    outline = [(-half, 0.0), (half, 0.0), (half + lean, high), (-half + lean, high)]
    body = concio.Body("pillar", outline, kind="rigid", material="stone")
    floor = box("floor", -3.0, 3.0, -0.5, 0.0, kind="fixed")
    loads = (weight(), concio.Load("weight", (1.0, 0.0), group="live")) if rng.random() < 0.5 else (weight(),)
    return model_of(floor, body, law=DRY, loads=loads, ties=ties)


def tied(rng):
    most, stiffness = rng.uniform(1.0, 6.0), rng.uniform(500.0, 5000.0)
    rod = concio.Tie("rod", "pillar", (0.0, 0.9), "", (-2.0, 0.9), stiffness=stiffness, yield_force=most,
                     break_elongation=most / stiffness * rng.uniform(0.6, 3.0))  # fmt: skip
    return pillar(rng, (rod,))


def stack(rng):
    return concio.column(width=rng.uniform(0.3, 0.5), height=1.2, blocks=int(rng.integers(2, 5)), block="rigid",
                         friction=rng.uniform(0.15, 0.7))  # fmt: skip


def neighbours(rng, gap=None):
    """A pillar that leans on its neighbour once it has turned far enough: it carries more then."""
    gap = rng.uniform(2e-3, 2e-2) if gap is None else gap
    floor = box("floor", -3.0, 4.0, -0.5, 0.0, kind="fixed")
    first = box("first", -0.4, 0.0, 0.0, 1.2, kind="rigid", material="stone")
    other = box("other", gap, gap + 0.6, 0.0, 1.2, kind="rigid", material="stone")
    return model_of(floor, first, other, law=DRY, loads=(weight(),))


def arch(rng):
    return concio.arch(span=3.0, ring=rng.uniform(0.35, 0.5), voussoirs=7, friction=0.7, unit_weight=25, block="rigid")


CASES = [
    *((kind, seed) for kind in (pillar, tied) for seed in range(sample(1, 2, 6))),
    *(pytest.param(kind, seed, marks=pytest.mark.long)
      for kind in (neighbours, stack, arch) for seed in range(sample(1, 1, 6))),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "seed"), CASES, ids=lambda v: getattr(v, "__name__", str(v)))
def test_the_peak_does_not_depend_on_the_step(kind, seed):
    """Within a millionth, with steps from a sixth of the usual one to its double."""
    rng = np.random.default_rng(seed)
    model = kind(rng)
    usual = concio.push(model, until=0.06)
    for factor in (2.0, 1 / 6):
        found = concio.push(model, step=factor * 0.05 * 0.3, until=0.06)
        assert found.certified
        assert found.peak == pytest.approx(usual.peak, rel=1e-6)
        kinds = [e.kind for e in found.events if "tie" in str(e)]
        assert kinds == [e.kind for e in usual.events if "tie" in str(e)]


def test_a_peak_is_as_hand_statics_says_but_for_what_joints_give_way():
    """Before, the first step decided: 0.249979 of 0.25."""
    floor = box("floor", -3.0, 3.0, -0.5, 0.0, kind="fixed")
    body = box("pillar", -0.2, 0.2, 0.0, 1.6, kind="rigid", material="stone")
    model = model_of(floor, body, law=DRY, loads=(weight(),))
    for step in (None, 0.03):
        assert concio.push(model, step=step).peak == pytest.approx(0.25, rel=1e-5)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(sample(1, 3, 8)))
def test_bodies_meet_where_they_do(seed):
    """The top corner of a pillar that turns about its toe has moved by the gap; nothing is carried across before.

    The toe of a hard joint gives way by what is added to it, half a micrometre here, whatever the gap.
    """
    rng = np.random.default_rng(seed)
    gap = rng.uniform(2e-3, 2e-2)
    model = neighbours(rng, gap)
    angle = np.arcsin(gap / 1.2)
    for step in (0.015, 0.004):
        found = concio.push(model, step=step, until=0.02)
        between = [e for e in found.events if set(e.bodies) == {"first", "other"} and e.kind in ("touches", "closes")]
        met = min(e.step for e in between)
        turned = np.abs(found.rotation[: met + 1, 1])
        assert 1.2 * np.sin(turned[met]) == pytest.approx(gap, abs=1e-6)
        assert (turned[:met] < angle * (1 + 1e-6)).all()
        assert found.multiplier[met + 1] > 1.1 * found.multiplier[met]


def test_stacks_are_followed_until_nothing_is_carried():
    """Slips that iterations sum along the tangents they pass are not errors: they differ to the third order."""
    found = concio.push(concio.column(width=0.4, height=1.2, blocks=3, block="rigid", friction=0.5))
    assert found.ending is PushEnding.LOST
    assert found.displacement[-1] == pytest.approx(0.2, rel=1e-3)


@pytest.mark.parametrize("seed", range(sample(4, 40)))
def test_tops_are_found(seed):
    """Of kinks and of smooth functions that rise and fall, from three values."""
    rng = np.random.default_rng(seed)
    top, left, right = rng.uniform(0.1, 0.9), 10 ** rng.uniform(-1, 5), 10 ** rng.uniform(-3, 1)
    smooth = rng.random() < 0.5

    def at(x):
        away = x - top
        return 1.0 - (left * away**2 if smooth else max(-left * away, right * away))

    middle = rng.uniform(0.3, 0.7)
    known = [(0.0, at(0.0)), (middle, at(middle)), (1.0, at(1.0))]
    if at(middle) <= max(at(0.0), at(1.0)):
        assert highest(at, known, 1e-9) is None
        return
    found = highest(at, known, 1e-9)
    assert at(found) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_kink_beyond_the_largest_known_value_is_found(mirrored):
    """A chord drawn on past the largest value bounds the last interval, of which only one side has a neighbour."""
    kink, sign = (0.2, -1.0) if mirrored else (0.8, 1.0)

    def at(x):
        away = sign * (x - kink)
        return -max(-away, 10.0 * away)

    found = highest(at, [(x, at(x)) for x in (0.0, 0.5, 1.0)], 1e-9)
    assert found == pytest.approx(kink, abs=1e-8)


def test_the_bound_between_two_points_of_a_concave_curve_is_where_lines_of_its_neighbours_meet():
    points = [(0.0, 0.0), (1.0, 3.0), (4.0, 6.0), (6.0, 5.0), (8.0, 2.0)]
    assert _bound(points[1:], 0)[0] == pytest.approx(6.0 + 0.5 * 3.0)  # only the line on the right, back to the end
    assert _bound(points, 1)[0] == pytest.approx(3.0 + 3.0 * 9.0 / 7.0)  # 3 x = 6 - 0.5 (x - 4)
    assert _bound(points, 3)[0] == pytest.approx(5.0 - 0.5 * 2.0)  # only the line on the left, on to the right end
    assert _bound(points[:2], 0)[0] == np.inf
    rng = np.random.default_rng(0)
    for _ in range(50):
        at = np.sort(rng.uniform(-4.0, 4.0, 6))
        top, steep = rng.uniform(-4.0, 4.0), rng.uniform(0.1, 3.0)
        curve = [(float(x), float(-steep * (x - top) ** 2)) for x in at]
        k = int(np.argmax([y for _, y in curve]))
        for i in (k - 1, k) if 0 < k < 5 else ():
            fine = np.linspace(at[i], at[i + 1], 50)
            assert _bound(curve, i)[0] >= (-steep * (fine - top) ** 2).max() - 1e-9
