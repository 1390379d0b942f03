r"""Linear complementarity problems as immutable objects that measure any candidate answer.

Standard:      :math:`w = M z + q,\quad 0 \le z \perp w \ge 0`.

Generalised (horizontal), the paper's (33):      :math:`A t + B y = c,\quad 0 \le t \perp y \ge 0`.

With B regular the second is the first with ``M = -B^{-1} A``, ``q = B^{-1} c``; the force method gives a singular B,
and then any *complementary basis* (one column of each pair ``A_i, B_i``, all independent) does the same service, that
of the isostatic structure for instance (:mod:`.force_method`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import scipy.sparse as sp

from concio.errors import InputError
from concio.problem.contact_problem import Array

Matrix: TypeAlias = Any
"""A dense array or a CSR array."""


@dataclass(frozen=True, eq=False)
class LinearComplementarity:
    """Standard problem w = M z + q, 0 <= z, w >= 0, z'w = 0.

    Parameters
    ----------
    M : (n, n) array or CSR array
    q : (n,) array
    """

    M: Matrix
    q: Array

    def __post_init__(self) -> None:
        n = self.q.shape[0]
        if self.M.shape != (n, n):
            msg = f"M has shape {self.M.shape}, expected ({n}, {n})"
            raise InputError(msg)
        _finite("M", self.M)
        _finite("q", self.q)

    @property
    def size(self) -> int:
        """Number n of complementary pairs."""
        return int(self.q.shape[0])

    def slack(self, z: Array) -> Array:
        """Return w = M z + q, (n,)."""
        w: Array = self.M @ z + self.q
        return w

    def residual(self, z: Array) -> float:
        """Return max |min(z, M z + q)|, zero exactly at a solution."""
        return float(np.abs(np.minimum(z, self.slack(z))).max(initial=0.0))


@dataclass(frozen=True, eq=False)
class GeneralisedComplementarity:
    """Generalised problem A t + B y = c, 0 <= t, y >= 0, t'y = 0 (33).

    Parameters
    ----------
    A, B : (n, n) arrays
    c : (n,) array
    """

    A: Array
    B: Array
    c: Array

    def __post_init__(self) -> None:
        n = self.c.shape[0]
        for name in ("A", "B"):
            if getattr(self, name).shape != (n, n):
                msg = f"{name} has shape {getattr(self, name).shape}, expected ({n}, {n})"
                raise InputError(msg)
            _finite(name, getattr(self, name))
        _finite("c", self.c)

    @property
    def size(self) -> int:
        """Number n of complementary pairs."""
        return int(self.c.shape[0])

    def residual(self, t: Array, y: Array) -> float:
        """Return the larger of max |A t + B y - c| and max |min(t, y)|, zero exactly at a solution."""
        rows = np.abs(self.A @ t + self.B @ y - self.c).max(initial=0.0)
        return float(max(rows, np.abs(np.minimum(t, y)).max(initial=0.0)))


def is_sparse(matrix: Matrix) -> bool:
    """Return whether a matrix is stored sparsely."""
    return bool(sp.issparse(matrix))


def _finite(name: str, value: Matrix) -> None:
    data = value.data if is_sparse(value) else value
    if not np.isfinite(np.asarray(data)).all():
        msg = f"{name} holds a value that is not finite"
        raise InputError(msg)
