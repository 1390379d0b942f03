"""What every method asks of factors: solves with a matrix that has a small block of stiffness for each pair."""

from __future__ import annotations

from typing import Protocol

import scipy.sparse as sp

from concio.problem.contact_problem import Array

Springs = Array | float | sp.csr_array
"""What ties unknowns to a place: the diagonal of a matrix, or all of it."""


class Solves(Protocol):
    """Solves with a matrix, whether it was factorised or updated since."""

    def solve(self, b: Array) -> Array:
        """Return the solution for the right-hand side b, (N,) or (N, k)."""
        ...


class Factor(Solves, Protocol):
    """Factors of A + C' D C + springs for blocks D (m, d, d), which change; A and C are its own."""

    @property
    def D(self) -> Array | None:
        """Blocks of the factors at hand; None before there are any."""
        ...

    @property
    def diagonal(self) -> Springs | None:
        """Springs that were added with them."""
        ...

    @property
    def count(self) -> int:
        """Number of factorisations made."""
        ...

    def factorise(self, D: Array, diagonal: Springs = 0.0) -> None:
        """Factorise; raises SingularMatrixError where a pivot is zero or not finite."""
        ...
