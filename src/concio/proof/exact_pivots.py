r"""The last pivots of a linear programme, in fractions.

A basis that is optimal in floating point may not be so exactly: where a corner has several bases, as in an arch that is
symmetric to rounding, a share may be negative by 1e-17 or a ray resist by as little. A few pivots of the simplex method
in fractions lead on from there. The programme is: the largest last unknown x of

.. math:: \sum_j a_j p_j + a_{last}\, x = b, \qquad p \ge 0,

with the dual y, y.a_last = 1 and y.a_j >= 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from concio.proof.exact_solve import Row, solve_exactly

MOST_PIVOTS = 30

Pair = tuple[dict[int, Fraction], dict[int, Fraction]]


def pivoted(columns: Sequence[Row], right: Sequence[Fraction], used: Sequence[int]) -> Pair | None:
    """Return shares by column and dual by row of an optimal basis, from one that is nearly so; None where none is near.

    Parameters
    ----------
    columns : sequence of {row: entry}
        The last is that of the unknown that is largest.
    right : sequence of Fraction
    used : sequence of int
        Columns of the first basis, as many as there are rows.
    """
    basis, last = list(used), len(columns) - 1
    for _ in range(MOST_PIVOTS):
        found = _solved(columns, right, basis)
        if found is None:
            return None
        shares, dual = found
        low = [i for i, j in enumerate(basis) if j != last and shares[j] < 0]
        resist = [j for j in range(last) if j not in shares and _along(columns[j], dual) < 0]
        if not low and not resist:
            return found
        step = _leaving(columns, basis, shares, dual, low) if low else _entering(columns, basis, shares, dual, resist)
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


def _solved(columns: Sequence[Row], right: Sequence[Fraction], basis: Sequence[int]) -> Pair | None:
    matrix = square(columns, basis, range(len(right)))
    primal = solve_exactly(matrix, right)
    dual = solve_exactly(transposed(matrix), [Fraction(int(j == len(columns) - 1)) for j in basis])
    if primal is None or dual is None:
        return None
    return dict(zip(basis, primal, strict=True)), dict(enumerate(dual))


def _leaving(
    columns: Sequence[Row], basis: Sequence[int], shares: Mapping[int, Fraction], dual: Mapping[int, Fraction],
    low: Sequence[int],
) -> tuple[int, int] | None:  # fmt: skip
    """Return the place of the most negative share and the column that takes it, by the dual ratio test."""
    place = min(low, key=lambda i: shares[basis[i]])
    matrix = transposed(square(columns, basis, range(len(basis))))
    row = solve_exactly(matrix, [Fraction(int(i == place)) for i in range(len(basis))])
    if row is None:
        return None
    across = dict(enumerate(row))
    rates = [(j, _along(columns[j], across)) for j in range(len(columns) - 1) if j not in shares]
    able = [(_along(columns[j], dual) / -rate, j) for j, rate in rates if rate < 0]
    return (place, min(able)[1]) if able else None


def _entering(
    columns: Sequence[Row], basis: Sequence[int], shares: Mapping[int, Fraction], dual: Mapping[int, Fraction],
    resist: Sequence[int],
) -> tuple[int, int] | None:  # fmt: skip
    """Return the place that the ray which resists most takes, by the ratio test, and that ray."""
    ray = min(resist, key=lambda j: _along(columns[j], dual))
    matrix = square(columns, basis, range(len(basis)))
    change = solve_exactly(matrix, [columns[ray].get(i, Fraction(0)) for i in range(len(basis))])
    if change is None:
        return None
    free = len(columns) - 1
    able = [(shares[j] / w, i) for i, (j, w) in enumerate(zip(basis, change, strict=True)) if j != free and w > 0]
    return (min(able)[1], ray) if able else None


def _along(column: Row, y: Mapping[int, Fraction]) -> Fraction:
    return sum((v * y[i] for i, v in column.items()), Fraction(0))
