"""Numbers of limit loads that stand beside others: where ties break, what torsion takes off, how margins are told."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis import limit_ties
from concio.analysis.limit_torsion import SpreadSteps
from concio.problem.solution import Status
from concio.verdict.limit_words import margin_line, one_step_lines
from concio.verdict.odd_weights import _first, _has


@pytest.mark.parametrize("whole", [1e9, 0.0])
@pytest.mark.parametrize(
    ("path", "wanted"),
    [
        ([(0.0, (0.1, 0.0)), (2.0, (0.6, 0.2)), (3.0, (0.9, 0.4))], math.nan),  # none breaks
        ([(0.0, (0.2, 0.0)), (2.0, (0.6, 0.2)), (4.0, (1.4, 0.4))], 3.0),  # 0.4 of 0.8 to go
        ([(0.0, (0.2, 0.0)), (2.0, (0.6, 0.9)), (4.0, (1.4, 1.3))], 2.5),  # the second one breaks first
        ([(0.0, (0.2, 0.0)), (5.0, (0.5, 0.2)), (3.0, (1.5, 0.4))], 5.0),  # the load had been larger before
        ([(0.0, (1.2, 0.0)), (5.0, (1.5, 0.2))], 0.0),  # broken from the beginning
        ([(0.0, (0.2, 0.6)), (2.0, (0.6, 0.3)), (4.0, (1.0, 0.4))], 4.0),  # at a state itself; the other one shortens
    ],
)
def test_a_path_goes_to_where_the_first_tie_breaks(
    path: list[tuple[float, tuple[float, float]]], wanted: float, whole: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Shares of the elongation at which each tie breaks grow in a straight line between states."""
    factors = []

    def shares(assembly: object, state: SimpleNamespace, start: dict[str, float], end: dict[str, float]) -> np.ndarray:
        factors.append((start, end))
        return np.array(state.share)

    monkeypatch.setattr(limit_ties, "shares", shares)
    monkeypatch.setattr(limit_ties, "break_elongations", lambda assembly: np.array([np.inf, 0.01]))
    states = [SimpleNamespace(parameter=parameter, share=share) for parameter, share in path]
    assembly = SimpleNamespace(groups=("dead", "live"))
    found = limit_ties.whole_up_to(assembly, SimpleNamespace(states=states), ["live"])
    assert found == pytest.approx(wanted, nan_ok=True)
    assert factors[0] == ({"dead": 1.0, "live": 0.0}, {"dead": 1.0, "live": 1.0})
    assert math.isnan(limit_ties.whole_up_to(assembly, None, ["live"]))
    monkeypatch.setattr(limit_ties, "break_elongations", lambda assembly: np.array([np.inf, np.inf]))
    assert math.isnan(limit_ties.whole_up_to(assembly, SimpleNamespace(states=states), ["live"]))


def test_what_points_resist_too_well_is_taken_off() -> None:
    found = SpreadSteps(SimpleNamespace(carried=3.0, failed=4.0), points=9, pairs=100, error=0.25)
    assert (found.carried, found.not_reached) == pytest.approx((2.4, 3.2))
    even = SpreadSteps(SimpleNamespace(carried=3.0, failed=math.nan), points=9, pairs=100)
    assert even.carried == 3.0
    assert math.isnan(even.not_reached)


@pytest.mark.parametrize(
    ("factor", "below", "settled", "words"),
    [
        (0.0, 0.0, True, "without any"),
        (math.inf, 0.5, True, "no friction carries"),
        (math.inf, 0.0, True, "undecided"),
        (1.25, 0.0, False, "within 1.25 times the coefficients given; none is shown"),
        (1.25, 0.75, False, "within 1.25 times the coefficients given; 0.75 is shown to be too little"),
        (0.8, 0.8, True, "at least 0.8 times"),
    ],
)
def test_a_friction_margin_says_what_was_shown(factor: float, below: float, settled: bool, words: str) -> None:
    assert words in margin_line(SimpleNamespace(factor=factor, below=below, settled=settled))


def told(**changed: object) -> list[str]:
    given = {"failed": 2.0, "carried": 1.5, "outcome": None, "dim": 3, "bound": 4.0, "state": None} | changed
    state = None if given["state"] is None else SimpleNamespace(multiplier=given["state"])
    steps = SimpleNamespace(failed=given["failed"], carried=given["carried"], outcome=given["outcome"])
    return one_step_lines(SimpleNamespace(
        steps=steps, assembly=SimpleNamespace(model=SimpleNamespace(dim=given["dim"])), collapse_state=state,
        associated=SimpleNamespace(multiplier=given["bound"]),
    ))  # fmt: skip


def test_a_load_in_one_step_is_told_in_space_below_the_bound_alone() -> None:
    assert told(dim=2) == told(bound=2.0) == told(failed=math.nan) == []
    assert "a collapse state below it" not in told()[0]
    assert "a collapse state below it" not in told(state=1.6)[0]
    assert "since a collapse state below it is known" in told(state=1.5)[0]
    assert "also has an equilibrium" in told(outcome=Status.SOLVED)[0]
    assert "is not carried: no equilibrium" in told(outcome=Status.NO_EQUILIBRIUM)[0]
    assert "is left open: " in told(outcome=Status.GAVE_UP)[0]


def test_names_are_listed_up_to_a_few() -> None:
    assert (_has(["a"]), _has(["a", "b"])) == ("has", "have")
    few, many = _first(["a", "b"]), _first([f"b{k}" for k in range(1234)])
    assert few == "'a', 'b'"
    listed = many.split(" and ")[0].count(",") + 1
    assert many.endswith(f" and {1234 - listed:,} more")
