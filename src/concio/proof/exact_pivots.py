r"""The last pivots of a linear programme, in fractions.

A basis that is optimal in floating point may not be so exactly: where a corner has several bases, as in an arch that is
symmetric to rounding, a share may be negative by 1e-17 or a ray resist by as little. A few pivots of the simplex method
in fractions lead on from there. The programme is: the largest last unknown x of

.. math:: \sum_j a_j p_j + a_{last}\, x = b, \qquad p \ge 0,

with the dual y, y.a_last = 1 and y.a_j >= 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import Literal

from concio.proof.exact_solve import Row, solve_exactly

MOST_PIVOTS, FEW_PIVOTS = 30, 3
"""Bases examined, at most, and in any case."""
MOST_PIVOTED_ROWS = 500
"""Rows times bases at most beyond those few: each solves systems whose fractions have thousands of digits, and where
three pivots do not decide, thirty hardly do."""

Pair = tuple[dict[int, Fraction] | None, dict[int, Fraction] | None]
Need = Literal["both", "shares", "dual"]


def pivoted(columns: Sequence[Row], right: Sequence[Fraction], used: Sequence[int], need: Need = "both") -> Pair | None:
    """Return shares by column and dual by row of a basis near a given one that is feasible; None where none is near.

    Parameters
    ----------
    columns : sequence of {row: entry}
        The last is that of the unknown that is largest.
    right : sequence of Fraction
    used : sequence of int
        Columns of the first basis, as many as there are rows.
    need : {"both", "shares", "dual"}
        What is to be feasible: both make the basis optimal; shares that are not negative bound the last unknown from
        below and need no dual, a dual that no column resists bounds it from above and needs no shares.
    """
    basis, last, whole = list(used), len(columns) - 1, _Whole.of(columns)
    for _ in range(max(FEW_PIVOTS, min(MOST_PIVOTS, MOST_PIVOTED_ROWS // max(len(right), 1)))):
        matrix = square(columns, basis, range(len(right)))
        shares = None if need == "dual" else _shares(matrix, right, basis)
        low = _negative(shares, basis, last)
        if need == "shares" and shares is not None and not low:
            return shares, None
        dual = _dual(matrix, basis, last)
        if dual is None:
            return None
        work = _along(whole, dual)
        resist = [j for j in range(last) if j not in set(basis) and work[j] < 0]
        if need == "dual" and not resist:
            return None, dual
        shares = _shares(matrix, right, basis) if shares is None else shares
        if shares is None:
            return None
        low = _negative(shares, basis, last)
        if not low and not resist:
            return shares, dual
        if low:
            step = _leaving(columns, whole, basis, shares, work, low)
        else:
            step = _entering(columns, basis, shares, work, resist)
        if step is None:
            return None
        basis[step[0]] = step[1]
    return None


def square(columns: Sequence[Row], used: Sequence[int], rows: Sequence[int]) -> list[Row]:
    """Return the rows of the square matrix of some columns and rows."""
    place = {row: i for i, row in enumerate(rows)}
    found: list[Row] = [{} for _ in rows]
    for j, column in enumerate(used):
        for row, value in columns[column].items():
            if row in place:
                found[place[row]][j] = value
    return found


def transposed(matrix: Sequence[Row]) -> list[Row]:
    """Return the rows of the transposed of a square matrix."""
    turned: list[Row] = [{} for _ in matrix]
    for i, row in enumerate(matrix):
        for j, value in row.items():
            turned[j][i] = value
    return turned


def _shares(matrix: Sequence[Row], right: Sequence[Fraction], basis: Sequence[int]) -> dict[int, Fraction] | None:
    found = solve_exactly(matrix, right)
    return None if found is None else dict(zip(basis, found, strict=True))


def _dual(matrix: Sequence[Row], basis: Sequence[int], last: int) -> dict[int, Fraction] | None:
    found = solve_exactly(transposed(matrix), [Fraction(int(j == last)) for j in basis])
    return None if found is None else dict(enumerate(found))


def _negative(shares: Mapping[int, Fraction] | None, basis: Sequence[int], last: int) -> list[int]:
    """Return the places of negative shares in a basis."""
    return [i for i, j in enumerate(basis) if j != last and shares[j] < 0] if shares is not None else []


@dataclass(frozen=True)
class _Whole:
    """Columns of fractions over one denominator each: sums of many products then need no common divisors.

    Parameters
    ----------
    entries : list of {row: int}
    under : list of int
        Denominator of each column.
    """

    entries: list[dict[int, int]]
    under: list[int]

    @classmethod
    def of(cls, columns: Sequence[Row]) -> _Whole:
        """Take columns apart."""
        under = [lcm(*(v.denominator for v in column.values())) for column in columns]
        entries = [
            {i: v.numerator * (d // v.denominator) for i, v in column.items()}
            for column, d in zip(columns, under, strict=True)
        ]
        return cls(entries, under)


def _along(columns: _Whole, y: Mapping[int, Fraction]) -> list[Fraction]:
    """Return the products of all columns with a vector, times one positive number: their signs, order and ratios."""
    common = lcm(*(v.denominator for v in y.values()))
    top = {i: v.numerator * (common // v.denominator) for i, v in y.items()}
    return [
        Fraction(sum(v * top[i] for i, v in column.items()), d)
        for column, d in zip(columns.entries, columns.under, strict=True)
    ]


def _leaving(
    columns: Sequence[Row], whole: _Whole, basis: Sequence[int], shares: Mapping[int, Fraction],
    work: Sequence[Fraction], low: Sequence[int],
) -> tuple[int, int] | None:  # fmt: skip
    """Return the place of the most negative share and the column that takes it, by the dual ratio test."""
    place = min(low, key=lambda i: shares[basis[i]])
    matrix = transposed(square(columns, basis, range(len(basis))))
    row = solve_exactly(matrix, [Fraction(int(i == place)) for i in range(len(basis))])
    if row is None:
        return None
    rates = _along(whole, dict(enumerate(row)))
    able = [(work[j] / -rates[j], j) for j in range(len(columns) - 1) if j not in shares and rates[j] < 0]
    return (place, min(able)[1]) if able else None


def _entering(
    columns: Sequence[Row], basis: Sequence[int], shares: Mapping[int, Fraction], work: Sequence[Fraction],
    resist: Sequence[int],
) -> tuple[int, int] | None:  # fmt: skip
    """Return the place that the ray which resists most takes, by the ratio test, and that ray."""
    ray = min(resist, key=work.__getitem__)
    matrix = square(columns, basis, range(len(basis)))
    change = solve_exactly(matrix, [columns[ray].get(i, Fraction(0)) for i in range(len(basis))])
    if change is None:
        return None
    free = len(columns) - 1
    able = [(shares[j] / w, i) for i, (j, w) in enumerate(zip(basis, change, strict=True)) if j != free and w > 0]
    return (min(able)[1], ray) if able else None
