"""Ties that yield, shorten, stretch again and break along a mechanism."""

from __future__ import annotations

import math

import numpy as np
import pytest

from concio.analysis.seismic.tie_history import TieHistory, together, yields_at
from concio.model.actions import Tie


def tie(prestress: float = 2.0, yield_force: float | None = 10.0, breaks: float | None = None, k: float = 400.0) -> Tie:
    return Tie("t", "a", (0.0, 0.0), "", (4.0, 0.0), stiffness=k, prestress=prestress, yield_force=yield_force,
               break_elongation=breaks)  # fmt: skip


def history(longest: float, *, broken: bool = False) -> TieHistory:
    return TieHistory(np.array([longest]), np.array([broken]))


def test_a_tie_yields_keeps_what_it_yielded_and_unloads_along_its_stiffness() -> None:
    """It yields at 8/400 = 0.02 m; stretched to 0.05 m, 0.03 m stay."""
    bar = tie()
    assert yields_at(bar) == pytest.approx(0.02)
    assert yields_at(tie(yield_force=None)) == math.inf
    forces = {0.0: 2.0, 0.01: 6.0, 0.02: 10.0, 0.05: 10.0, -0.004: 0.4, -0.01: 0.0}
    assert [history(0.0).force(0, bar, e) for e in forces] == pytest.approx(list(forces.values()))
    forces = {0.05: 10.0, 0.04: 6.0, 0.03: 2.0, 0.025: 0.0, 0.0: 0.0, 0.07: 10.0}
    assert [history(0.05).force(0, bar, e) for e in forces] == pytest.approx(list(forces.values()))
    assert history(0.0, broken=True).force(0, bar, 0.01) == 0.0


def test_what_was_reached_is_remembered() -> None:
    found = TieHistory.none(2).after(np.array([0.03, -0.1])).after(np.array([0.01, 0.2]), breaking=[1])
    assert found.longest.tolist() == [0.03, 0.2]
    assert found.broken.tolist() == [False, True]


@pytest.mark.parametrize(
    ("longest", "before", "after", "breaks", "wanted"),
    [
        (0.0, 0.0, 0.03, None, (0, 0.02, False)),
        (0.0, 0.0, 0.02, None, (0, 0.02, False)),  # it is reached
        (0.0, 0.0, 0.019, None, None),
        (0.02, 0.02, 0.05, None, None),  # it yields already
        (0.02, 0.01, 0.05, None, None),  # it had yielded, shortened and stretches again
        (0.0, 0.03, 0.01, None, None),  # it shortens
        (0.0, 0.0, 0.09, 0.06, (0, 0.02, False)),  # it yields first
        (0.03, 0.03, 0.09, 0.06, (0, 0.06, True)),
        (0.0, 0.0, 0.09, 0.015, (0, 0.015, True)),  # it breaks before it yields
        (0.05, 0.05, 0.06, 0.06, (0, 0.06, True)),
        (0.05, 0.06, 0.07, 0.06, None),
    ],
)
def test_the_next_event_of_a_tie(
    longest: float, before: float, after: float, breaks: float | None, wanted: tuple[int, float, bool] | None
) -> None:
    found = history(longest).next_event([tie(breaks=breaks)], np.array([before]), np.array([after]))
    if wanted is None:
        assert found is None
    else:
        assert found == (wanted[0], pytest.approx(wanted[1]), wanted[2])
    gone = history(longest, broken=True).next_event([tie(breaks=breaks)], np.array([before]), np.array([after]))
    assert gone is None


def test_of_two_ties_that_which_is_reached_first_on_the_way() -> None:
    """One has 2/3 of its way to go until it yields, the other, which stretches faster, a quarter."""
    ties = [tie(), tie(k=200.0)]
    found = TieHistory.none(2).next_event(ties, np.array([0.0, 0.02]), np.array([0.03, 0.10]))
    assert found == (1, pytest.approx(0.04), False)
    assert TieHistory.none(2).next_event(ties, np.zeros(2), np.array([0.03, 0.05])) == (0, pytest.approx(0.02), False)


def test_ties_together_do_the_most_work_at_one_displacement() -> None:
    """The first yields at 0.02 m / 1 and breaks at 0.03 m; the second, half as fast, yields at 0.08 m."""
    ties, rates = [tie(breaks=0.03), tie(k=200.0)], np.array([1.0, 0.5])
    best, forces = together(ties, rates)
    assert best == pytest.approx(0.03)
    assert forces == pytest.approx([10.0, 2.0 + 200.0 * 0.015])
    best, forces = together(ties, np.array([1.0, 3.0]))
    assert best == pytest.approx(0.02)
    assert forces == pytest.approx([10.0, 10.0])
    best, forces = together(ties, np.array([-1.0, 0.5]))
    assert (best, forces.tolist()) == (pytest.approx(0.08), [0.0, pytest.approx(10.0)])
    assert together(ties, np.array([0.0, -1.0]))[1].tolist() == [0.0, 0.0]
