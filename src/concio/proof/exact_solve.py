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
    parts = [0] * n
    largest = [max(abs(v) for v in row.values()) for row in whole]
    residual, taken, wanted, last = b, 0, FIRST_BITS, math.inf
    while taken < MOST_BITS:
        if not any(residual):
            return _checked(whole, b, [Fraction(p, 1 << taken) for p in parts])
        step = factor.solve(np.array([r / s for r, s in zip(residual, largest, strict=True)])) / columns
        if not np.isfinite(step).all():
            return None
        now = float(np.abs(step).max())
        if now > min(last * 2.0 ** (BITS - ROOM), SINGULAR):
            return None  # the matrix is singular to rounding, or the factor is too rough for its corrections to shrink
        last = max(now, 1.0)
        delta = [round(float(s) * 2.0**BITS) for s in step]
        parts = [(p << BITS) + d for p, d in zip(parts, delta, strict=True)]
        residual = [
            (r << BITS) - sum(v * delta[j] for j, v in row.items()) for r, row in zip(residual, whole, strict=True)
        ]
        taken += BITS
        if taken >= wanted:
            found = _reconstructed(parts, taken)
            if found is not None and _checked(whole, b, found) is not None:
                return found
            wanted *= 2
    raise LongFractionsError


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
