"""Where on a path in steps ties break or begin to yield: load steps whose shares follow curves that are known."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis import path_ties
from concio.problem.limits_of_work import BREAK_STEPS
from concio.problem.tolerances import BREAK_LOCATED, SLACK_TIE
from concio.solvers.path.record import Outcome

CURVES = {  # of the load parameter, with the one at which they are 1
    "straight": (lambda p: (p + 1) / 4, 3.0),
    "slow, then fast": (lambda p: (p / 3) ** 8, 3.0),
    "fast, then slow": (lambda p: np.sign(p) * np.abs(p / 3) ** 0.125, 3.0),
    "a bend": (lambda p: 0.5 + 0.01 * p if p < 2.5 else 0.525 + 0.95 * (p - 2.5), 3.0),
    "with a jump": (lambda p: 0.2 * p if p < 3.0 else 5.0 + p, 3.0),
}
MOST = {"straight": 1, "a bend": 12, "slow, then fast": 25, "fast, then slow": 20, "with a jump": BREAK_STEPS}
FINDERS = {
    "breaks": lambda before, after, share: path_ties._located(
        None, before, after, lambda s: np.array([share(s)]), None
    ),
    "yields": lambda before, after, share: path_ties._first_yield(None, before, after, share, None),
}


def steps_of(
    monkeypatch: pytest.MonkeyPatch, begin: float, *, outcome: Outcome = Outcome.REACHED, extra: int = 0
) -> list[float]:
    """Put load steps in place that end where they are asked to, in so many more states; return what they are asked."""
    asked: list[float] = []

    def follow(path: object, start: SimpleNamespace, *, until: float, steps: int, solver: object) -> SimpleNamespace:
        assert (start.parameter, steps) == (begin, 1)
        asked.append(until)
        ways = np.linspace(begin, until, 2 + extra).tolist()
        return SimpleNamespace(states=tuple(SimpleNamespace(parameter=p) for p in ways), outcome=outcome)

    monkeypatch.setattr(path_ties, "follow_in_steps", follow)
    return asked


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("finder", FINDERS)
def test_the_load_is_found_along_any_curve(
    monkeypatch: pytest.MonkeyPatch, finder: str, curve: str, sense: float
) -> None:
    shape, wanted = CURVES[curve]
    before, after = (SimpleNamespace(parameter=sense * p) for p in (0.5, 7.0))
    asked = steps_of(monkeypatch, before.parameter)
    found = FINDERS[finder](before, after, lambda state: float(shape(sense * state.parameter)))
    assert found.parameter == pytest.approx(sense * wanted, rel=1e-7)
    assert len(asked) <= MOST[curve]  # each of them is a load step to solve
    assert all(0.5 < sense * p < 7.0 for p in asked)
    share = shape(sense * found.parameter)
    if curve != "with a jump":
        assert share >= 1 - (SLACK_TIE if finder == "yields" else BREAK_LOCATED)
        assert share <= 1 + BREAK_LOCATED or abs(sense * found.parameter - wanted) <= BREAK_LOCATED * 6.5
    else:  # a tie that breaks is intact in the last state, one that yields has begun to in the first
        assert (share < 1) is (finder == "breaks")


@pytest.mark.parametrize("finder", FINDERS)
@pytest.mark.parametrize("fault", [{"outcome": Outcome.LOST}, {"extra": 1}, {"outcome": Outcome.LIMIT, "extra": 1}])
def test_a_load_that_no_single_step_reaches_is_not_looked_beyond(
    monkeypatch: pytest.MonkeyPatch, finder: str, fault: dict[str, object]
) -> None:
    """The states between would be missing on the path, on which each state follows from the one before."""
    before, after = (SimpleNamespace(parameter=p) for p in (0.5, 7.0))
    asked = steps_of(monkeypatch, before.parameter, **fault)
    found = FINDERS[finder](before, after, lambda state: state.parameter / 3)
    assert found is (after if finder == "yields" else None)
    assert len(asked) == 1
