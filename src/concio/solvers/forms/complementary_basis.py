r"""From a generalised complementarity problem to a standard one, through a complementary basis.

A complementary basis takes one column of each pair ``(A_i, B_i)``, all independent. Exchanging the roles of t_i and
y_i where A_i was taken turns ``A t + B y = c`` into ``w = M z + q`` with ``M = -S^{-1} N``, ``q = S^{-1} c``, S the
columns taken and N the others.

Such a basis is a common independent set of two matroids (columns; pairs), found by augmenting paths: start from the
independent columns of B and A that a pivoted factorisation takes first, then exchange (Lawler, *Combinatorial
Optimization: Networks and Matroids*, 1976, chapter 8). Where the largest such set has fewer than n columns there is no
complementary basis, and the problem is reported as one the method does not apply to.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np
import scipy.linalg as sl

from concio.errors import MethodError
from concio.problem.contact_problem import Array
from concio.problem.solution import ProgressCallback
from concio.solvers.forms.lemke_method import LemkeResult, equilibrate, lemke
from concio.solvers.forms.linear_problem import GeneralisedComplementarity, LinearComplementarity

INDEPENDENT = 1e-9
"""Smallest pivot, in scaled columns, that makes a column independent of others."""


def standard_form(
    problem: GeneralisedComplementarity, start: Array | None = None
) -> tuple[LinearComplementarity, Callable[[Array, Array], tuple[Array, Array]], float]:
    """Turn a generalised problem into a standard one.

    Parameters
    ----------
    problem : GeneralisedComplementarity
    start : (n,) boolean array, optional
        True where the basis takes the column of A; searched for by default.

    Returns
    -------
    standard : LinearComplementarity
    back : callable
        Takes z, w of the standard problem and returns t, y.
    condition : float
        Condition number of the basis, columns and rows scaled (1-norm).

    Raises
    ------
    MethodError
        There is no complementary basis.
    """
    take_a = complementary_basis(problem) if start is None else np.asarray(start, dtype=bool)
    S = np.where(take_a, problem.A, problem.B)
    N = np.where(take_a, problem.B, problem.A)
    rows, columns, scaled = equilibrate(S)
    lu, piv = sl.lu_factor(scaled)
    right = np.column_stack([N, problem.c]) * rows[:, None]
    x = sl.lu_solve((lu, piv), right)
    x += sl.lu_solve((lu, piv), right - scaled @ x)
    x *= columns[:, None]
    inverse_norm = np.abs(sl.lu_solve((lu, piv), np.eye(problem.size))).sum(axis=0).max(initial=0.0)
    condition = float(np.abs(scaled).sum(axis=0).max(initial=0.0) * inverse_norm)

    def back(z: Array, w: Array) -> tuple[Array, Array]:
        return np.where(take_a, w, z), np.where(take_a, z, w)

    return LinearComplementarity(-x[:, :-1], x[:, -1]), back, condition


def lemke_generalised(
    problem: GeneralisedComplementarity,
    *,
    start: Array | None = None,
    limit: int | None = None,
    progress: ProgressCallback | None = None,
) -> tuple[LemkeResult, Array, Array]:
    """Solve A t + B y = c by Lemke's method; return its result (of the standard form) and t, y (n,).

    Raises
    ------
    MethodError
        There is no complementary basis.
    """
    standard, back, _ = standard_form(problem, start)
    result = lemke(standard, limit=limit, progress=progress)
    t, y = back(result.z, result.w)
    return result, t, y


def complementary_basis(problem: GeneralisedComplementarity) -> Array:
    """Return (n,) booleans, True where a complementary basis takes the column of A.

    Raises
    ------
    MethodError
        There is none.
    """
    n = problem.size
    columns = np.hstack([problem.B, problem.A])  # column j belongs to pair j % n
    size = np.abs(columns).max(axis=0)
    columns = columns / np.where(size > 0, size, 1.0)
    size = np.abs(columns).max(axis=1, keepdims=True)
    columns = columns / np.where(size > 0, size, 1.0)
    table = columns.copy()  # in terms of the basis; an entry of -1 in ``owner`` is a row no column owns yet
    owner = np.full(n, -1)

    def pivot(row: int, column: int) -> None:
        table[row] /= table[row, column]
        factor = table[:, column].copy()
        factor[row] = 0.0
        table[:] -= np.outer(factor, table[row])
        owner[row] = column

    for block in (0, n):  # greedy: columns of B first, the largest pivot left each time
        while True:
            held = {int(j) % n for j in owner if j >= 0}
            allowed = [block + i for i in range(n) if i not in held]
            free = np.flatnonzero(owner < 0)
            if not allowed or not free.size:
                break
            part = np.abs(table[np.ix_(free, np.array(allowed))])
            at = np.unravel_index(int(np.argmax(part)), part.shape)
            if part[at] <= INDEPENDENT:
                break
            pivot(int(free[at[0]]), allowed[int(at[1])])
    while (owner < 0).any():
        chosen = _augment(table, owner, n)
        if chosen is None:
            msg = "A t + B y = c has no complementary basis"
            raise MethodError(msg, hint="every choice of one column of each pair (A_i, B_i) is singular")
        table = columns.copy()
        owner[:] = -1
        for column in chosen:
            free = np.flatnonzero(owner < 0)
            pivot(int(free[np.argmax(np.abs(table[free, column]))]), column)
    taken = np.zeros(n, dtype=bool)
    taken[owner % n] = owner >= n
    return taken


def _augment(table: Array, owner: Array, n: int) -> list[int] | None:
    """Return the columns of a common independent set larger by one, or None: a shortest augmenting path."""
    basic = {int(j): r for r, j in enumerate(owner) if j >= 0}
    pair_owner = {j % n: j for j in basic}
    free_rows = np.flatnonzero(owner < 0)
    outside = [j for j in range(2 * n) if j not in basic]
    adds = {j for j in outside if np.abs(table[free_rows, j]).max() > INDEPENDENT}  # independent of all that are in
    previous: dict[int, int] = {j: -1 for j in outside if j % n not in pair_owner}
    queue = deque(previous)
    while queue:
        j = queue.popleft()
        if j not in basic:
            if j in adds:
                path, at = set(), j
                while at != -1:
                    path.add(at)
                    at = previous[at]
                return sorted(set(basic) ^ path)
            nearest = [i for i, r in basic.items() if abs(table[r, j]) > INDEPENDENT]
        else:
            nearest = [i for i in outside if i % n == j % n]
        for i in nearest:
            if i not in previous:
                previous[i] = j
                queue.append(i)
    return None
