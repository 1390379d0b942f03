"""Values of a capacity curve between its points, and where it is below half after a tie has broken."""

from __future__ import annotations

import math

import numpy as np
import pytest

from concio.analysis.seismic.curve import CapacityCurve, not_followed, straight


def curve(points: list[tuple[float, float]], broken: tuple[float, ...] = ()) -> CapacityCurve:
    d, alpha = np.array(points, dtype=float).T
    return CapacityCurve("followed", d, alpha, float(d[-1]), "falls", broken)


def test_alpha_between_points_is_linear_and_after_a_break_the_lower_one() -> None:
    found = curve([(0, 0.4), (0.5, 0.3), (0.5, 0.1), (1.5, 0.0)], (0.5,))
    at = [found.at(d) for d in (-1.0, 0.0, 0.2, 0.5, 0.75, 1.5, 9.0)]
    assert at == pytest.approx([0.4, 0.4, 0.36, 0.1, 0.075, 0.0, 0.0])
    assert found.ends
    line = straight(0.2, 3.0)
    assert [line.at(d) for d in (0.0, 1.5, 3.0)] == pytest.approx([0.2, 0.1, 0.0])
    assert not not_followed("no state").ends


@pytest.mark.parametrize(
    ("points", "broken", "wanted"),
    [
        ([(0, 0.4), (0.5, 0.3), (1.5, 0.1), (2.0, 0.0)], (), math.inf),  # no tie breaks
        ([(0, 0.4), (0.5, 0.3), (0.5, 0.1), (2.0, 0.0)], (0.5,), 0.5),  # the break itself takes it below
        ([(0, 0.4), (0.5, 0.35), (0.5, 0.3), (1.5, 0.1), (2.0, 0.0)], (0.5,), 1.0),  # 0.2 lies between two points
        ([(0, 0.4), (0.5, 0.3), (1.0, 0.1), (1.2, 0.1), (1.2, 0.05), (2.0, 0.0)], (1.2,), 1.2),  # below before
        ([(0, 0.4), (0.3, 0.1), (0.5, 0.3), (0.5, 0.25), (1.0, 0.05), (2.0, 0.0)], (0.5,), 0.625),
        ([(0, 0.4), (0.5, 0.3), (0.5, 0.25), (0.9, 0.21)], (0.5,), math.inf),  # never below half
        ([(0.5, 0.4), (1.0, 0.1)], (0.5,), 0.5 + 0.5 * 2 / 3),
    ],
)
def test_where_alpha_is_below_half_after_a_break(
    points: list[tuple[float, float]], broken: tuple[float, ...], wanted: float
) -> None:
    assert curve(points, broken).first_below_half_after_a_break() == pytest.approx(wanted, rel=1e-12)
