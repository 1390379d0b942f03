"""How much the order of motions changes the readings of a diagnosis: the largest change of all orders reached."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from concio.analysis.cracks.diagnose import _Case


def orders(*ends: tuple[list[float], bool], chosen: tuple[int, ...] = (0, 1)) -> float:
    """Return the change where the motions in one order and in the other lead to these readings."""
    left = iter(ends)

    def in_order(parts: Any) -> Any:
        values, reached = next(left)
        return SimpleNamespace(values=np.array(values), reached=reached)

    own: Any = SimpleNamespace(
        candidates=[None] * 3,
        fitter=SimpleNamespace(forward=SimpleNamespace(in_order=in_order), error=np.array([0.5, 2.0])),
    )
    best: Any = SimpleNamespace(chosen=chosen, motions=np.array([1.0, 2.0, 3.0]), predicted=np.array([1.0, 4.0]))
    return _Case.orders(own, best)


def test_the_largest_change_of_both_orders_counts() -> None:
    first, second = ([1.5, 4.0], True), ([1.0, -4.0], True)  # by one error, and by four
    assert orders(first, second) == orders(second, first) == pytest.approx(4.0)
    assert orders(first, ([9.0, 9.0], False)) == pytest.approx(1.0)
    assert orders(([9.0, 9.0], False), ([9.0, 9.0], False)) == np.inf
    assert orders(chosen=(1,)) == 0.0
