r"""Rigid motions split into two nonnegative parts (Stavroulakis, Panagiotopoulos and Al-Fahed 1991; Lee 1994).

``alpha = alpha+ - alpha-``, and equilibrium ``0 = E z + e`` is written as two inequalities, ``-(E z + e) >= 0`` against
alpha+ and ``E z + e >= 0`` against alpha-. Six unknowns more for each free body in the plane, twelve in space; in
exchange the matrix keeps its sparsity, and its copositivity: the new blocks are skew.

References
----------
G. E. Stavroulakis, P. D. Panagiotopoulos, A. M. Al-Fahed, On the rigid body displacements and rotations in
unilateral contact problems and applications, *Computers & Structures* 40 (1991) 599-614. S.-S. Lee, A computational
method for frictional contact problem using finite element method, *Int. J. Numer. Methods Engrg.* 37 (1994) 217-228.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from concio.problem.contact_problem import Array
from concio.solvers.lcp.linear_problem import LinearComplementarity
from concio.solvers.methods.forms.forms import MixedForm

NEGLIGIBLE = 1e-14
"""Entries of the scaled matrix that are rounding."""


def split(form: MixedForm) -> LinearComplementarity:
    """Return the standard problem in (z, alpha+, alpha-), sparse; entries below ``NEGLIGIBLE`` are dropped."""
    M = np.where(np.abs(form.M) > NEGLIGIBLE, form.M, 0.0)
    N, E = sp.csr_array(form.N), sp.csr_array(form.E)
    blocks: list[list[Any]] = [[sp.csr_array(M), N, -N], [-E, None, None], [E, None, None]]
    matrix: Any = sp.block_array(blocks)
    return LinearComplementarity(sp.csr_array(matrix), np.concatenate([form.q, -form.e, form.e]))


def join(form: MixedForm, z: Array) -> tuple[Array, Array]:
    """Return z (n,) of the form and alpha (r,) from a solution of the split problem."""
    n, r = form.size, form.motions
    return z[:n], z[n : n + r] - z[n + r :]
