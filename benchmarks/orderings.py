"""Fill-reducing orderings for the engine's matrix, compared in one run: ``python benchmarks/orderings.py``.

The matrix is K + C'C of walls of growing size; every row is one SuperLU factorisation in symmetric mode. Static
condensation of nodes inside blocks is the last column: how many unknowns it would remove, and what share of the fill
they own. They are eliminated first by any good ordering, so condensing them by hand saves next to nothing.
"""

from __future__ import annotations

import time

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from wall_family import wall

from concio.solvers.algebra.scaled import scale
from concio.solvers.algebra.sparse_factor import nested_dissection


def factorise(matrix: sp.csc_matrix, spec: str) -> tuple[float, int, sla.SuperLU]:
    """Return seconds, entries of L and U, and the factors."""
    begin = time.perf_counter()
    lu = sla.splu(matrix, permc_spec=spec, diag_pivot_thresh=0.01, options={"SymmetricMode": True})
    return time.perf_counter() - begin, lu.L.nnz + lu.U.nnz, lu


def main() -> None:
    """Print the table."""
    print(f"{'wall':12s}{'unknowns':>10s}{'mmd s':>8s}{'fill M':>8s}{'colamd/mmd':>12s}{'nd/mmd':>8s}{'fill M':>8s}")
    for units, courses in ((30, 14), (50, 40), (70, 60)):
        problem = wall(units, courses, 0.3)
        scaled = scale(problem)
        matrix = sp.csc_matrix(scaled.K + problem.C.T @ problem.C)
        mmd, fill, _ = factorise(matrix, "MMD_AT_PLUS_A")
        colamd, _, _ = factorise(matrix, "COLAMD")
        order, name = nested_dissection(sp.csr_array(matrix))
        nd, less, _ = factorise(sp.csc_matrix(matrix[order][:, order]), "NATURAL")
        touched = np.asarray(abs(problem.C).sum(axis=0)).ravel() > 0
        inside = 1 - touched.mean()
        print(
            f"{units} x {courses:<7d}{problem.unknowns:10d}{mmd:8.2f}{fill / 1e6:8.2f}{colamd / mmd:12.2f}"
            f"{nd / mmd:8.2f}{less / 1e6:8.2f}   {name}; {100 * inside:.0f} % of the unknowns lie inside blocks"
        )


if __name__ == "__main__":
    main()
