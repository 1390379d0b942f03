"""Where a step of a motion is cut because a tie begins to yield or breaks: elongations that follow known curves."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest

from concio.analysis.motion.tie_cuts import CLOSE, MOST, where_ties_give_way

STIFF = np.array([2e4, 1e3])
PULLED = np.array([0.0, 5.0])
"""Prestress: the second tie is 5 mm shorter than the distance it spans."""


def ties(
    most: tuple[float, float] = (np.inf, np.inf), breaks: tuple[float, float] = (np.inf, np.inf)
) -> SimpleNamespace:
    return SimpleNamespace(most=np.array(most), prestress=PULLED, stiffness=STIFF, breaks=np.array(breaks))


def state(held: SimpleNamespace, longer: np.ndarray) -> SimpleNamespace:
    """Return the state of ties that have become so much longer: yielded, or broken, where that is too much."""
    plastic = np.maximum(longer + PULLED / STIFF - held.most / STIFF, 0.0)
    now = SimpleNamespace(plastic=plastic, sunk=plastic - longer - PULLED / STIFF, broken=longer >= held.breaks)
    return SimpleNamespace(ties=now)


def cut(
    held: SimpleNamespace, longer: Callable[[float], tuple[float, float]], whole: float, least: float = 1e-9
) -> tuple[float | None, int]:
    """Return the length of the step that ends where a tie gives way, and how many were tried."""
    tried: list[float] = []

    def at(length: float) -> tuple[SimpleNamespace, float]:
        tried.append(length)
        return state(held, np.array(longer(length))), length

    before, after = (state(held, np.array(longer(time))) for time in (0.0, whole))
    found = where_ties_give_way(held, before, after, at, whole, least)  # type: ignore[arg-type]
    return (None if found is None else found[1]), len(tried)


CURVES = {  # of the share of the step that is over, 0.4 of which it takes to reach 1
    "straight": lambda t: t / 0.4,
    "fast, then slow": lambda t: (t / 0.4) ** 0.25,
    "slow, then fast": lambda t: (t / 0.4) ** 6,
}


@pytest.mark.parametrize("whole", [1e-3, 0.02])
@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("kind", ["yields", "yields with prestress", "breaks"])
def test_the_step_ends_where_the_tie_gives_way(kind: str, curve: str, whole: float) -> None:
    shape = CURVES[curve]
    if kind == "yields":  # 20 kN over 20,000 kN/m
        held, far = ties(most=(20.0, np.inf)), (1e-3, 0.0)
    elif kind == "breaks":
        held, far = ties(breaks=(np.inf, 0.02)), (1e-3, 0.02)
    else:  # 25 kN, of which 5 are there before
        held, far = ties(most=(np.inf, 25.0)), (0.0, 0.02)
    length, count = cut(held, lambda t: tuple(part * shape(t / whole) for part in far), whole)  # type: ignore[arg-type, return-value]
    assert length is not None
    assert 1.0 <= shape(length / whole) <= 1.0 + CLOSE
    assert count <= (1 if curve == "straight" else MOST)


def test_the_first_of_two_ties_counts() -> None:
    held = ties(most=(20.0, 25.0))
    assert cut(held, lambda t: (1e-3 * t / 0.7, 0.02 * t / 0.3), 1.0)[0] == pytest.approx(0.3, rel=1e-6)
    assert cut(held, lambda t: (1e-3 * t / 0.3, 0.02 * t / 0.7), 1.0)[0] == pytest.approx(0.3, rel=1e-6)
    both = ties(most=(np.inf, 25.0), breaks=(np.inf, 0.015))  # breaks before it yields
    assert cut(both, lambda t: (0.0, 0.02 * t / 0.8), 1.0)[0] == pytest.approx(0.6, rel=1e-6)


def test_a_tie_that_gives_way_at_either_end_of_a_step_cuts_none() -> None:
    held = ties(most=(20.0, np.inf))
    assert cut(held, lambda t: (1e-3 * (1.0 + 0.5 * CLOSE) * t, 0.0), 1.0) == (None, 0)
    assert cut(held, lambda t: (1e-3 * (1.0 + t), 0.0), 1.0) == (None, 0)
    assert cut(held, lambda t: (1e-3 * t / 0.01, 0.0), 1.0, least=0.02)[0] is None
    assert cut(held, lambda t: (1e-3 * t / 0.03, 0.0), 1.0, least=0.02)[0] == pytest.approx(0.03, rel=1e-6)


def test_a_tie_that_gave_way_before_says_nothing_of_the_other_one() -> None:
    for held in (ties(most=(20.0, 25.0)), ties(most=(np.inf, 25.0), breaks=(1e-3, np.inf))):
        assert cut(held, lambda t: (2e-3 + t, 0.02 * t / 0.6), 1.0)[0] == pytest.approx(0.6, rel=1e-6)
