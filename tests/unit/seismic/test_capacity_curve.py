"""Values of a capacity curve between its points, where it is below half after a tie broke, where it is cut."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from concio.analysis.seismic.curve import FARTHEST, CapacityCurve, not_followed, straight
from concio.analysis.seismic.sequence import JAMS, follow_in_steps


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


class Rising:
    """A mechanism whose multiplier is a line: ``follow_in_steps`` asks for its states, and says where it stops."""

    size = 1.0

    def __init__(self, first: float, slope: float, ties: tuple[object, ...] = ()) -> None:
        self.first, self.slope, self.ties = first, slope, ties
        self.contacts = SimpleNamespace(force=np.zeros(0))
        self.asked: list[float] = []

    def near(self) -> Rising:
        return self

    def at_rest(self) -> SimpleNamespace:
        return SimpleNamespace(centre=np.zeros((1, 2)), d=0.0)

    def state(self, q: SimpleNamespace, *forces: object) -> SimpleNamespace:
        self.asked.append(self.first + self.slope * q.d)
        history = SimpleNamespace(next_event=lambda *elongations: None)
        return SimpleNamespace(
            q=q, multiplier=self.asked[-1], tie_force=np.zeros(len(self.ties)), normal_force=np.zeros(0),
            history=history, elongation=np.zeros(len(self.ties)), velocity=np.zeros((1, 3)),
        )  # fmt: skip

    def masses(self, first: np.ndarray, q: SimpleNamespace) -> float:
        return float(q.d)

    def room(self, state: SimpleNamespace) -> float:
        return math.inf

    def step(self, state: SimpleNamespace, length: float) -> SimpleNamespace:
        return SimpleNamespace(centre=np.zeros((1, 2)), d=state.q.d + length)

    def controlled(self, q: SimpleNamespace) -> float:
        return float(q.d)

    def elongations(self, q: SimpleNamespace) -> np.ndarray:
        return np.zeros(len(self.ties))


@given(st.floats(0.01, 1.0), st.floats(0.0, 20.0), st.floats(0.3, 3.0))
def test_a_curve_is_cut_where_blocks_jam(first: float, growth: float, share: float) -> None:
    """No point lies above twice the larger of alpha_0 and of the first multiplier; what was above is no capacity."""
    onset = share * first
    most = JAMS * max(first, onset)
    sequence = Rising(first, growth * first)
    found = follow_in_steps(sequence, onset)  # type: ignore[arg-type]
    jams = first * (1.0 + growth * FARTHEST) > most * (1.0 + 0.05 * growth)  # by a step at least, the longest 0.05
    assert max(sequence.asked[:-1]) <= most
    if jams:
        assert found.reason == "jams"
        assert found.multiplier[-1] == 0.0
        assert found.end == found.displacement[-1]
        before = (most / first - 1.0) / growth
        assert before - 0.05 - 1e-9 <= found.end <= before + 1e-9
    elif found.reason != "jams":
        assert found.reason == "far"
        assert math.isnan(found.end)
    assert found.multiplier.max() <= max(onset, first) * (1.0 + 1e-6)
    assert found.multiplier[0] == pytest.approx(min(first, onset) if found.reduced == 1.0 else onset)


def test_a_curve_that_rises_as_ties_pull_is_not_cut() -> None:
    tie = SimpleNamespace(break_elongation=None)
    found = follow_in_steps(Rising(0.1, 1.0, ((tie, None, None),)), 0.1)  # type: ignore[arg-type]
    assert found.reason == "far"
    assert found.multiplier.max() == pytest.approx(0.1 + FARTHEST, rel=0.05)
