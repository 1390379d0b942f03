"""Generalised minimal residuals with factors of a matrix nearby, for few iterations."""

from __future__ import annotations

from collections.abc import Callable
from math import hypot

import numpy as np

from concio.problem.contact_problem import Array

Product = Callable[[Array], Array]


def minimal_residuals(
    solve: Product, beyond: Product, b: Array, precise: float, most: int
) -> tuple[Array, int]:
    """Return a solution (N,) of (F + E) x = b, and the iterations that it took.

    Parameters
    ----------
    solve, beyond : callable
        Solve with F; multiply with E.
    b : (N,) array
    precise : float
        Share of the error at which iterations end.
    most : int
        Iterations at most.
    """
    size = float(np.linalg.norm(b))
    if not size > 0 or not np.isfinite(size):
        return np.zeros_like(b), 0
    V, Z = np.empty((most + 1, len(b))), np.empty((most, len(b)))
    V[0] = b / size
    columns: list[list[float]] = []
    turns: list[tuple[float, float]] = []
    right = [size]
    for j in range(most):
        Z[j] = solve(V[j])
        w = V[j] + beyond(Z[j])
        own = V[: j + 1]
        along = own @ w
        w -= along @ own
        again = own @ w
        w -= again @ own
        norm = float(np.linalg.norm(w))
        column = (along + again).tolist()
        for k, (c, s) in enumerate(turns):
            column[k], column[k + 1] = c * column[k] + s * column[k + 1], c * column[k + 1] - s * column[k]
        radius = hypot(column[j], norm)
        if not radius > 0:
            break
        c, s = column[j] / radius, norm / radius
        column[j] = radius
        columns.append(column)
        turns.append((c, s))
        right[j], rest = c * right[j], -s * right[j]
        right.append(rest)
        if abs(rest) <= precise * size or not norm > 0:
            break
        V[j + 1] = w / norm
    y = np.zeros(len(columns))
    for i in reversed(range(len(columns))):
        y[i] = (right[i] - sum(columns[k][i] * y[k] for k in range(i + 1, len(columns)))) / columns[i][i]
    return np.asarray(y @ Z[: len(y)]), len(y)
