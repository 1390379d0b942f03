"""Intervals of the checking program: they hold every number that their rounding and their parts allow."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from concio.proof.verify_equilibrium import Interval, enclosed, less, near, over

FEW = 6
"""Bits behind the point: so few that every rounding is seen."""
UNIT = Fraction(1, 2**FEW)

INTERVALS = st.tuples(st.integers(-400, 400), st.integers(0, 30))


def parts(interval: Interval) -> list[Fraction]:
    """Return both ends and the middle of an interval."""
    return [(interval[0] + share * interval[1]) * UNIT for share in (-1, 0, 1)]


def holds(interval: Interval, number: Fraction, bits: int = FEW) -> bool:
    return abs(number * 2**bits - interval[0]) <= interval[1]


@given(st.fractions(-50, 50), st.integers(0, 40))
def test_an_interval_near_a_fraction_holds_it(number: Fraction, bits: int) -> None:
    assert holds(near(number, bits), number, bits)
    assert near(number, bits)[1] <= 1


@settings(max_examples=200)
@given(INTERVALS, INTERVALS, INTERVALS)
def test_differences_hold_all_that_their_parts_allow(x: Interval, a: Interval, b: Interval) -> None:
    found = less(x, a, b, FEW)
    every = [u - v * w for u, v, w in product(parts(x), parts(a), parts(b))]
    assert all(holds(found, number) for number in every)
    assert found[1] <= (max(every) - min(every)) / UNIT + 4  # and are hardly wider


@settings(max_examples=200)
@given(INTERVALS, INTERVALS)
def test_quotients_hold_all_that_their_parts_allow(x: Interval, pivot: Interval) -> None:
    if abs(pivot[0]) <= pivot[1]:
        with pytest.raises(ValueError, match="pivot may be 0"):
            over(x, pivot, FEW)
        return
    found = over(x, pivot, FEW)
    every = [u / v for u, v in product(parts(x), parts(pivot))]
    assert all(holds(found, number) for number in every)
    assert found[1] <= 2 * (max(every) - min(every)) / UNIT + 2 * Fraction(abs(pivot[0]), abs(pivot[0]) - pivot[1]) + 2


@pytest.mark.parametrize("bits", [12, 16, 40])
@pytest.mark.parametrize("seed", range(4))
def test_solutions_by_elimination_are_enclosed(seed: int, bits: int) -> None:
    """Whatever the pivots, and to as many bits as are asked for: the right sides belong to solutions that are known."""
    rng = np.random.default_rng(seed)
    n = 6
    matrix = [[Fraction(int(v), 7) if rng.random() < 0.6 else Fraction(0) for v in row]
              for row in rng.integers(-9, 10, (n, n))]  # fmt: skip
    order = rng.permutation(n)
    for i in range(n):
        matrix[i][order[i]] += 12
    solution = [Fraction(int(v), 11) for v in rng.integers(-40, 40, n)]
    right = [sum((a * x for a, x in zip(row, solution, strict=True)), Fraction(0)) for row in matrix]
    rows = [{j: v for j, v in enumerate(row) if v} for row in matrix]
    pivots = [[int(i), int(order[i])] for i in rng.permutation(n)]
    found = enclosed(rows, right, pivots, bits)
    assert all(holds(one, x, bits) for one, x in zip(found, solution, strict=True))
    assert max(one[1] for one in found) < 2000  # digits that rounding takes, however many there are
    with pytest.raises(ValueError, match="one for each"):
        enclosed(rows, right, [pivots[0], *pivots[:-1]], bits)
