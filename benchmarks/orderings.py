"""Orderings for the engine's matrix, compared in one run: ``python benchmarks/orderings.py [--small]``.

The matrix is K + C'C of walls of growing size; every row is one SuperLU factorisation in symmetric mode. Static
condensation of nodes inside blocks is the last column: how many unknowns it would remove, and what share of the fill
they own. They are eliminated first by any good ordering, so condensing them by hand saves next to nothing.

``--small``: LAPACK's factorisation of the band against SuperLU in nested dissection, on structures of some blocks to
some hundred and on a slender one; least of thirty, in milliseconds, and which of the two the engine takes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from wall_family import panel, wall

import concio
from concio.problem.contact_problem import ContactProblem
from concio.solvers.algebra.scaled import scale
from concio.solvers.algebra.sparse_factor import PANEL, narrow_band, nested_dissection


def factorise(matrix: sp.csc_matrix, spec: str) -> tuple[float, int, sla.SuperLU]:
    """Return seconds, entries of L and U, and the factors."""
    begin = time.perf_counter()
    lu = sla.splu(matrix, permc_spec=spec, diag_pivot_thresh=0.01, options={"SymmetricMode": True})
    return time.perf_counter() - begin, lu.L.nnz + lu.U.nnz, lu


def least(work: Callable[[], object], times: int = 30) -> float:
    """Return the least of some wall-clock times [ms]."""
    best = np.inf
    for _ in range(times):
        begin = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begin)
    return 1e3 * best


def rigid(units: int, courses: int) -> ContactProblem:
    """Return a dry wall of rigid blocks."""
    size, block = (1.0, 0.5), concio.Rigid(20.0)
    return concio.assemble(
        concio.running_bond_panel(
            courses=courses, blocks=units, block_size=size, block=block, friction=0.6, side_walls=False, horizontal=0.1
        )
    ).problem()


def structures() -> Iterator[tuple[str, ContactProblem]]:
    """Give the small structures and their names."""
    for courses, blocks, joint in ((3, 3, 0.0), (3, 3, 0.01), (4, 8, 0.0), (5, 5, 0.0), (5, 5, 0.01), (10, 10, 0.0)):
        yield f"panel {courses} x {blocks}{', mortar' if joint else ''}", panel(courses, blocks, joint, 1.0)
    for units, courses in ((8, 6), (20, 20), (30, 14)):
        yield f"rigid wall {units} x {courses}", rigid(units, courses)
    yield "elastic wall 30 x 14", wall(30, 14, 0.3)
    slender = concio.column(width=1.0, height=500.0, blocks=1000, friction=0.6)
    yield "column of 1,000", concio.assemble(slender).problem()


def sparse(matrix: sp.csc_matrix) -> sla.SuperLU:
    """Factorise a matrix in the order it is in, as the engine does."""
    return sla.splu(
        matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, panel_size=PANEL, options={"SymmetricMode": True}
    )


def small() -> None:
    """Print the table of small structures."""
    print("| structure | unknowns | half band | SuperLU | a solve | band | a solve | taken |\n" + "|---" * 8 + "|")
    for name, problem in structures():
        scaled = scale(problem)
        matrix = sp.csr_array(scaled.K + scaled.C.T @ scaled.C + 1e-6 * sp.eye_array(problem.unknowns))
        n, b = problem.unknowns, np.ones(problem.unknowns)
        order, _ = nested_dissection(matrix)
        permuted = sp.csc_matrix(matrix[order][:, order])
        lu = sparse(permuted)
        order, taken = narrow_band(matrix)
        entries = sp.coo_array(matrix[order][:, order])
        w = int(np.abs(entries.row - entries.col).max())
        band = np.zeros((3 * w + 1, n), order="F")
        band[2 * w + entries.row - entries.col, entries.col] = entries.data
        factors, pivots, _ = sl.lapack.dgbtrf(band, w, w)
        times = (
            least(lambda m=permuted: sparse(m)),
            least(lambda lu=lu, b=b: lu.solve(b)),
            least(lambda band=band, w=w: sl.lapack.dgbtrf(band, w, w)),
            least(lambda f=factors, p=pivots, w=w, b=b: sl.lapack.dgbtrs(f, w, w, b, p)),
        )
        chosen = "SuperLU" if taken is None else "band"
        print(f"| {name} | {n} | {w} | " + " | ".join(f"{t:.3f}" for t in times) + f" | {chosen} |")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--small", action="store_true")
    if parser.parse_args().small:
        small()
        return
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
