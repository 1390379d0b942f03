"""The least force of a tie of a strip out of the plane: closed forms, and bisection of mechanisms sought again."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import concio
from concio import Body, JointLaw, Load, Model, Rigid
from concio.analysis.seismic.directions import pushes
from concio.analysis.seismic.sections import OutOfPlane, Strip, strips_of
from concio.analysis.seismic.strip_ties import carried_with, multiplier_needed, strip_tie, with_tie
from concio.errors import InputError
from samples import sample
from seismic_walls import ground, site


def whole(thickness: list[float], heights: list[float], *, roof: float = 0.0, friction: float = 0.9,
          held: OutOfPlane | None = None) -> Strip:  # fmt: skip
    """Return the strip of a facade of 6 m whose courses have these thicknesses and heights."""
    tops = np.cumsum(heights)
    bodies = [Body(f"s{k}", np.array([[0, z - h], [6, z - h], [6, z], [0, z]]), kind="rigid", thickness=t)
              for k, (t, h, z) in enumerate(zip(thickness, heights, tops, strict=True))]  # fmt: skip
    loads = [Load("weight", (0.0, -1.0))]
    if roof:
        loads.append(Load("point", (0.0, -roof), bodies=(bodies[-1].name,), at=(3.0, float(tops[-1]))))
    model = Model((ground(-1, 7), *bodies), {"block": Rigid(19.0)}, {"joint": JointLaw(friction)}, loads=tuple(loads))
    return strips_of(model, held or OutOfPlane(), [list(range(1, len(bodies) + 1))])[0]


def test_the_missing_moment_over_the_height() -> None:
    """One course of 0.5 x 4 m with a roof: F h = alpha (W h / 2 + N h) - (W + N) t / 2."""
    strip = whole([0.5], [4.0], roof=30.0)
    W, N, h, t = 19.0 * 6 * 4 * 0.5, 30.0, 4.0, 0.5
    found = strip_tie(strip, 0.3)
    assert found.before == pytest.approx((W + N) * t / 2 / (W * h / 2 + N * h), rel=1e-9)
    assert found.force == pytest.approx((0.3 * (W * h / 2 + N * h) - (W + N) * t / 2) / h, rel=1e-9)
    assert found.per_metre == pytest.approx(found.force / 6.0)
    assert found.holds
    assert strip_tie(strip, 0.5 * found.before).force == 0.0


def test_a_tie_below_does_not_hold_what_overturns_above_it() -> None:
    strip = whole([0.3] * 4, [1.0] * 4)
    found = strip_tie(strip, 0.25, [1.0, 2.0, 3.0, 4.0])
    assert found.by_height[1.0] == math.inf  # three courses above it overturn at 0.1
    assert found.by_height[2.0] == math.inf
    assert found.height in (3.0, 4.0)
    assert found.force == min(found.by_height.values())


@pytest.mark.long
@settings(max_examples=sample(3, 8, 30), deadline=None)
@given(
    st.lists(st.tuples(st.floats(0.25, 0.8), st.floats(0.4, 1.5)), min_size=2, max_size=6),
    st.floats(0.0, 60.0),
    st.floats(1.1, 2.5),
)
def test_a_bisection_of_mechanisms_gives_the_same_force(
    stones: list[tuple[float, float]], roof: float, more: float
) -> None:
    """Friction is high enough for nothing to slide, so that mechanisms sought at each force are proved."""
    strip = whole([t for t, _ in stones], [h for _, h in stones], roof=roof, friction=3.0)
    top = max(float(b.vertices[:, 1].max()) for b in strip.section.free_bodies)
    (push,) = pushes(strip.section, "left", ())
    held = with_tie(push.model, top)
    target = more * carried_with(held, push.groups, 1e-9)
    found = strip_tie(strip, target, [top])
    if not math.isfinite(found.force):
        assert carried_with(held, push.groups, 1e6) < target
        return
    assert found.reached == pytest.approx(target, rel=1e-8)
    low, high = 0.0, 2.0 * found.force
    while high - low > 1e-7 * found.force:
        middle = (low + high) / 2
        low, high = (low, middle) if carried_with(held, push.groups, middle) >= target else (middle, high)
    assert found.force == pytest.approx(high, rel=1e-6)


def test_sliding_is_told() -> None:
    """Courses slide at the friction whatever pulls at the top, and beyond it no force at one height is enough."""
    strip = whole([0.5] * 3, [0.5] * 3, friction=0.3)
    found = strip_tie(strip, 0.6)
    assert not found.holds


def test_a_height_outside_is_refused() -> None:
    with pytest.raises(InputError, match="meets no course"):
        strip_tie(whole([0.5], [4.0]), 0.3, [4.5])


def test_the_multiplier_that_is_asked_for() -> None:
    strip = whole([0.5], [4.0])
    place = site()
    onset = place.spectrum(place.at("SLD")).acceleration(0.0)
    linear = place.spectrum(place.at("SLV")).acceleration(0.0) / 2.0
    assert multiplier_needed(place, ["SLD"], strip, 1.35) == pytest.approx(float(onset) * 1.35 / 9.81, rel=1e-3)
    both = multiplier_needed(place, ["SLD", "SLV", "SLC"], strip, 1.35)
    assert both == pytest.approx(max(float(onset), float(linear)) * 1.35 / 9.81, rel=1e-3)
    assert multiplier_needed(place, ["SLC"], strip, 1.35) == 0.0
    high = concio.Site(place.hazard, soil="B", building={"height": 4.0, "storeys": 2})
    assert multiplier_needed(high, ["SLV"], strip, 1.35) > multiplier_needed(place, ["SLV"], strip, 1.35)


@pytest.mark.long
def test_the_report_of_a_facade_tells_the_forces(tmp_path: Path) -> None:
    spans = [(0.0, 2.0), (2.0, 4.0), (4.0, 6.0)]
    stones = tuple(
        Body(f"s{k}{j}", np.array([[a, k], [b, k], [b, k + 1], [a, k + 1]]) * 1.0, kind="rigid", thickness=0.5)
        for k in range(5) for j, (a, b) in enumerate(spans)
    )  # fmt: skip
    model = Model((ground(-1, 7), *stones), {"block": Rigid(19.0)}, {"joint": JointLaw(0.6)},
                  loads=(Load("weight", (0.0, -1.0)),))  # fmt: skip
    found = concio.assess(model, site=site(), levels=["SLV"], direction="right")
    (tie,) = found.strip_ties
    alpha = multiplier_needed(found.site, ["SLV"], tie.strip, found.confidence)
    W = 19.0 * 6 * 5 * 0.5
    assert tie.force == pytest.approx((alpha * W * 2.5 - W * 0.25) / 5.0, rel=1e-8)
    for language, words in (("en", "Least tie force"), ("it", "Forza minima")):
        text = found.report(tmp_path / f"{language}.html", language=language).read_text("utf-8")
        assert words in text
    assert f"{tie.force:.1f}".replace(".", ",") in text
