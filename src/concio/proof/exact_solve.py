"""Linear systems with whole numbers, solved exactly with the help of a factor in floating point.

The solution is a vector of fractions with one denominator. A factor in double precision gives some thirty bits of it
at a time: the residual is kept in whole numbers, each correction is rounded to whole numbers of a smaller unit, and
nothing is lost. Once enough bits are known the common denominator follows by continued fractions, and the solution is
put into the equations, exactly. Only that last check counts.

Reference: Wan, An algorithm to solve integer linear systems exactly using numerical methods, J. Symb. Comput.
41 (2006).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from math import lcm

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from concio.errors import SolverError
from concio.problem.limits_of_work import MOST_BITS

Row = dict[int, Fraction]


class LongFractionsError(SolverError):
    """A solution has fractions with too many digits."""

    def __init__(self) -> None:
        digits = round(MOST_BITS / 2 * math.log10(2), -3)
        msg = f"the exact solution has fractions of more than {digits:,.0f} digits: they are not sought"
        super().__init__(msg, hint="'concio limit' and 'concio run' certify the result in floating point; coordinates "
                         "with few digits make fractions shorter, as --numbers decimal does")  # fmt: skip

BITS = 24
"""Bits of a correction that are taken at a time."""
HALF = 1 << BITS - 1
ROOM = 3
"""Bits by which each correction is smaller than the one before, at least."""
AGREES = 32
"""Last bits of what is known of a solution that a fraction may miss."""
FIRST_BITS = 256
SINGULAR = 1e200
"""Correction, rows and columns scaled, from which a matrix counts as singular."""


def solve_exactly(rows: Sequence[Row], right: Sequence[Fraction]) -> list[Fraction] | None:
    """Return the solution of a square system of fractions; None where its matrix is singular or nearly so.

    Raises
    ------
    LongFractionsError
        The fractions have more digits than are sought.

    Parameters
    ----------
    rows : sequence of {column: entry}
        A row each; entries that are not named are 0.
    right : sequence of Fraction
    """
    n = len(rows)
    whole, b = _whole(rows, right)
    if not all(whole):
        return None
    scaled, columns = _floats(whole, n)
    try:
        factor = sla.splu(scaled)
    except RuntimeError:
        return None
    residual = _Residual(whole, b)
    taken, wanted, last = 0, FIRST_BITS, math.inf
    while taken < MOST_BITS:
        if residual.vanishes:
            return _checked(whole, b, [Fraction(p, 1 << taken) for p in residual.parts()])
        step = factor.solve(residual.shares()) / columns
        if not np.isfinite(step).all():
            return None
        now = float(np.abs(step).max())
        if now > min(last * 2.0 ** (BITS - ROOM), SINGULAR):
            return None  # the matrix is singular to rounding, or the factor is too rough for its corrections to shrink
        last = max(now, 1.0)
        residual.take(np.rint(step * 2.0**BITS))
        taken += BITS
        if taken >= wanted:
            found = _reconstructed(residual.parts(), taken)
            if found is not None and _checked(whole, b, found) is not None:
                return found
            wanted *= 2
    raise LongFractionsError


class _Residual:
    """What is left of a right side, and the corrections so far, in digits of ``BITS`` bits from minus half to half.

    Digits of all equations stand in arrays, the last ones first: a shift by ``BITS`` is one by a place, and digits of
    the matrix times those of a correction are whole numbers below 2**63.
    """

    def __init__(self, whole: Sequence[dict[int, int]], b: Sequence[int]) -> None:
        n = len(whole)
        i = np.repeat(np.arange(n), [len(row) for row in whole])
        j = np.array([j for row in whole for j in row])
        self.matrix = sp.vstack(
            [sp.csr_array((d, (i, j)), shape=(n, n)) for d in _digits([v for row in whole for v in row.values()])],
            format="csr",
        )
        self.left = _digits(b)
        self.largest = [max(abs(v) for v in row.values()) for row in whole]
        self.taken: list[np.ndarray] = []
        self.weights = np.zeros((0, n))

    @property
    def vanishes(self) -> bool:
        """Whether nothing is left."""
        return not self.left.any()

    def shares(self) -> np.ndarray:
        """Return what is left as a share of the largest entry of each row (n,)."""
        places = range(len(self.left))
        if len(self.weights) < len(places):
            self.weights = np.array([[_over(1 << BITS * k, v) for v in self.largest] for k in places])
        there = self.left != 0  # a weight beyond all floats belongs to no digit that is there
        shares = np.zeros(self.left.shape)
        np.multiply(self.left, self.weights[: len(places)], out=shares, where=there)
        total: np.ndarray = shares.sum(axis=0)
        return total

    def take(self, correction: np.ndarray) -> None:
        """Take the matrix times a correction, of whole numbers, from what is left times 2**BITS."""
        digits = _digits(correction)
        n = self.left.shape[1]
        products = [(self.matrix @ d).reshape(-1, n) for d in digits]
        left = np.zeros((max(len(self.left) + 1, len(products) - 1 + len(products[0])), n), dtype=np.int64)
        left[1 : len(self.left) + 1] = self.left
        for k, product in enumerate(products):
            left[k : k + len(product)] -= product
        self.left = _carried(left)
        self.taken.append(digits)

    def parts(self) -> list[int]:
        """Return the sum of all corrections as whole numbers, the last correction in units."""
        count = len(self.taken)
        total = np.zeros((count + max(map(len, self.taken), default=0), self.left.shape[1]), dtype=np.int64)
        for k, digits in enumerate(self.taken):
            total[count - 1 - k : count - 1 - k + len(digits)] += digits
        return _numbers(_carried(total))


def _over(a: int, b: int) -> float:
    """Return the quotient of two whole numbers; infinity where it is too large."""
    try:
        return a / b
    except OverflowError:
        return math.inf


def _digits(values: Sequence[int] | np.ndarray) -> np.ndarray:
    """Return the digits (places, n) of whole numbers, the last ones first."""
    if isinstance(values, np.ndarray) and np.abs(values).max(initial=0.0) < 2.0**62:
        return _carried(values.astype(np.int64)[None])
    left = [int(v) for v in values]
    found: list[list[int]] = []
    while any(left) or not found:
        found.append([((v + HALF) & (2 * HALF - 1)) - HALF for v in left])
        left = [(v - d) >> BITS for v, d in zip(left, found[-1], strict=True)]
    return np.array(found, dtype=np.int64)


def _carried(values: np.ndarray) -> np.ndarray:
    """Return digits within half of 2**BITS from sums of digits (places, n)."""
    while True:
        carry = (values + HALF) >> BITS
        if not carry.any():
            used = np.flatnonzero(values.any(axis=1))
            return values[: used[-1] + 1 if len(used) else 1]
        more = np.zeros((len(values) + bool(carry[-1].any()), values.shape[1]), dtype=np.int64)
        more[: len(values)] = values - (carry << BITS)
        more[1 : len(values) + 1] += carry[: len(more) - 1]
        values = more


def _numbers(digits: np.ndarray) -> list[int]:
    """Return the whole numbers that have given digits (places, n)."""
    rows = digits + HALF  # none below zero
    low = np.ascontiguousarray(rows.T, dtype="<u4").view(np.uint8).reshape(rows.shape[1], len(rows), 4)
    shift = HALF * (((1 << BITS * len(rows)) - 1) // ((1 << BITS) - 1))
    return [int.from_bytes(row[:, : BITS // 8].tobytes(), "little") - shift for row in low]


def scaled(rows: Sequence[Row], right: Sequence[Fraction]) -> sp.csc_array:
    """Return the matrix of a system of fractions in floating point, rows and columns with a largest entry of 1.

    Raises
    ------
    RuntimeError
        An equation or an unknown is empty.
    """
    whole, _ = _whole(rows, right)
    held = set().union(*whole)
    if not all(whole) or len(held) < len(rows):
        msg = "an equation or an unknown is empty"
        raise RuntimeError(msg)
    return _floats(whole, len(rows))[0]


def _whole(rows: Sequence[Row], right: Sequence[Fraction]) -> tuple[list[dict[int, int]], list[int]]:
    """Return the rows and the right side times a whole number that takes their denominators away."""
    whole, b = [], []
    for row, value in zip(rows, right, strict=True):
        common = lcm(value.denominator, *(v.denominator for v in row.values()))
        whole.append({j: int(v * common) for j, v in row.items() if v})
        b.append(int(value * common))
    return whole, b


def _rows(whole: Sequence[dict[int, int]]) -> np.ndarray:
    return np.array([float(max((abs(v) for v in row.values()), default=1)) for row in whole])


def _floats(whole: Sequence[dict[int, int]], n: int) -> tuple[sp.csc_array, np.ndarray]:
    """Return the matrix in floating point with rows and columns scaled to a largest entry of 1, and column scales."""
    size = _rows(whole)
    entries = [(i, j, v / s) for (i, row), s in zip(enumerate(whole), size, strict=True) for j, v in row.items()]
    i, j, v = (np.array(x) for x in zip(*entries, strict=True))
    columns = np.zeros(n)
    np.maximum.at(columns, j, np.abs(v))
    columns[columns == 0] = 1.0
    return sp.csc_array((v / columns[j], (i, j)), shape=(n, n)), columns


def _reconstructed(parts: Sequence[int], bits: int) -> list[Fraction] | None:
    """Return fractions of small denominators that agree with parts / 2**bits; None where an unknown has none."""
    found, common, most, unit = [], 1, 1 << (bits // 2 - 8), 1 << bits
    for part in parts:
        value = part * common  # of unit: a fraction whose denominator is small once those before have been found
        near = Fraction(value, unit).limit_denominator(most // common or 1)
        apart = abs(near.numerator * unit - value * near.denominator)
        if apart > near.denominator * common << AGREES:
            return None  # too few bits are known
        found.append(near / common)
        common = lcm(common, found[-1].denominator)
        if common > most:
            return None
    return found


def _checked(whole: Sequence[dict[int, int]], b: Sequence[int], x: list[Fraction]) -> list[Fraction] | None:
    """Return the solution if it satisfies every equation, of whole numbers, exactly."""
    common = lcm(*(v.denominator for v in x))
    top = [v.numerator * (common // v.denominator) for v in x]
    holds = all(sum(v * top[j] for j, v in row.items()) == r * common for row, r in zip(whole, b, strict=True))
    return x if holds else None
