"""The modified MEXE formula by hand, with every factor away from one, and the ends of its ranges."""

from __future__ import annotations

import math

import numpy as np
import pytest

from concio.analysis.bridges.mexe import _underside, mexe


@pytest.mark.parametrize("span", [1.6, 4.0, 9.0, 17.5])
@pytest.mark.parametrize(("share", "profile"), [(0.7, 1.0), (0.75, 1.0), (0.8, 2.3 * 0.2**0.6), (0.9, 2.3 * 0.1**0.6)])
def test_the_axle_is_the_product_of_the_formula(span: float, share: float, profile: float) -> None:
    ring, depth, rise = 0.3, 0.25, 0.4 * span
    found = mexe(span, rise, share * rise, ring, depth, factors=0.85)
    provisional = 9.81 * min(740.0 * 0.55**2 / span**1.3, 70.0)
    assert found.provisional == pytest.approx(provisional)
    assert found.profile == pytest.approx(min(profile, 1.0))
    assert found.axle == pytest.approx(provisional * min(profile, 1.0) * 0.85)
    assert found.factors == pytest.approx(0.85)
    assert found.limits == ()
    flat = mexe(span, 0.1 * span, 0.1 * share * span, ring, depth, span_rise=0.6, factors=0.85)
    assert flat.axle == pytest.approx(found.axle * 0.6)
    assert flat.factors == pytest.approx(0.51)


@pytest.mark.parametrize(
    ("span", "rise", "ring", "depth", "words"),
    [
        (1.5, 0.5, 0.2, 0.1, ()), (1.49, 0.5, 0.2, 0.1, ("a span of 1.49 m",)), (18.0, 6.0, 0.9, 0.9, ()),
        (18.1, 6.0, 0.9, 0.9, ("a span of 18.1 m",)), (6.0, 2.0, 0.15, 0.1, ()),
        (6.0, 2.0, 0.15, 0.09, ("d + h = 0.24",)), (6.0, 2.0, 1.0, 0.81, ("d + h = 1.81",)), (6.0, 1.5, 0.4, 0.4, ()),
        (6.0, 1.49, 0.4, 0.4, ("span over rise is 4.03",)),
        (20.0, 4.0, 1.5, 1.5, ("a span of 20 m", "d + h = 3 m", "span over rise is 5")),
    ],
)  # fmt: skip
def test_outside_of_its_ranges_the_formula_gives_nothing_and_says_why(
    span: float, rise: float, ring: float, depth: float, words: tuple[str, ...]
) -> None:
    found = mexe(span, rise, 0.7 * rise, ring, depth, factors=0.9)
    assert math.isnan(found.axle) == bool(words)
    assert len(found.limits) == len(words)
    assert all(text in line for text, line in zip(words, found.limits, strict=True))
    assert mexe(span, rise, 0.7 * rise, ring, depth).limits[-1].startswith("material, joint and condition factors")


def test_the_underside_is_the_least_height_over_a_place() -> None:
    low = np.array([(0.0, 1.0), (4.0, 3.0), (4.0, 5.0), (0.0, 2.0)])
    high = np.array([(0.0, 9.0), (8.0, 9.0), (8.0, 7.0), (0.0, 7.0)])
    assert _underside([high, low], 1.0) == pytest.approx(1.5)
    assert _underside([high, low], 3.5) == pytest.approx(2.75)
    assert _underside([high, low], 6.0) == pytest.approx(7.0)
