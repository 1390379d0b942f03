"""The matrix of a step, which many steps have in common, with what they need of it worked out once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array

FEW = 40
"""Unknowns up to which dense products are cheaper than everything around sparse ones."""


@dataclass(frozen=True, eq=False)
class StepMatrix:
    """A positive definite matrix.

    Parameters
    ----------
    sparse : (N, N) CSR array
    """

    sparse: sp.csr_array

    @cached_property
    def diagonal(self) -> Array:
        """Diagonal (N,)."""
        return np.asarray(self.sparse.diagonal())

    @cached_property
    def inverse_diagonal(self) -> Array:
        """Inverse of the diagonal with a zero behind (N + 1,), for unknowns that do not move."""
        return np.append(1.0 / self.diagonal, 0.0)

    @cached_property
    def times(self) -> Any:
        """What multiplies fastest: dense where unknowns are few."""
        return self.sparse.toarray() if self.sparse.shape[0] <= FEW else self.sparse
