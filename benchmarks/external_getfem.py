"""GetFEM on one contact problem; run by the system's Python (Debian package ``python3-getfem``).

    /usr/bin/python3 external_getfem.py problem.npz answer.npz

Knows nothing of concio: reads K, f, C_n, C_t, gap and friction, writes displacements, seconds and an outcome. GetFEM
gets the matrices as they are (explicit matrix brick, basic contact brick on node pairs) and solves by Newton's method
on Alart and Curnier's augmented Lagrangian (version 1, not symmetric). Its parameter r has to be chosen by hand: here
the values of ``FACTORS`` times the mean diagonal entry of K are tried in that order, and the first that converges is
timed; the note says which, and how long the trials before it took. Forces and lengths are scaled as for Siconos.

Two more things had to be found by hand. Newton starts from pressed joints (every normal force the mean load on a pair):
from zero it sees blocks in free fall, and does not come back. And every pair has a compliance ``COMPLIANCE`` over the
mean diagonal entry of K: where three pairs meet at a corner for two relative motions, the matrix is singular without.
"""

import sys
import time

import getfem as gf
import numpy as np
import scipy.sparse as sp
from scipy.io import mmwrite

FACTORS = (0.1, 1.0, 0.01, 10.0)
COMPLIANCE = 1e-8


def csr(data, name):
    """Return the CSR matrix ``name`` of the file."""
    parts = tuple(data[name + "_" + part] for part in ("data", "indices", "indptr"))
    return sp.csr_matrix(parts, shape=tuple(data[name + "_shape"]))


def to_getfem(matrix):
    """Return GetFEM's sparse matrix, through a MatrixMarket file in the working directory, to the last digit."""
    mmwrite("matrix.mtx", sp.coo_matrix(matrix), precision=17, symmetry="general")
    return gf.Spmat("load", "mm", "matrix.mtx")


def newton(K, f, B_n, B_t, soft, gap, mu, r):
    """Return (u, converged, iterations) with augmentation parameter r; matrices are GetFEM's, B_n = -C_n."""
    m, n = len(gap), len(f)
    model = gf.Model("real")
    model.add_variable("u", n)
    model.add_variable("ln", m)
    model.add_variable("lt", m)
    model.add_explicit_matrix("u", "u", K, 1, 1)
    model.add_explicit_rhs("u", f)
    model.add_explicit_matrix("ln", "ln", soft)
    model.add_explicit_matrix("lt", "lt", soft)
    model.add_initialized_data("r", [r])
    model.add_initialized_data("mu", mu)
    model.add_initialized_data("gap", gap)
    model.add_initialized_data("alpha", np.ones(m))
    model.add_basic_contact_brick("u", "ln", "lt", "r", B_n, B_t, "mu", "gap", "alpha", 1)
    model.set_variable("ln", -np.ones(m))  # pressed joints to begin with: from zero, Newton sees blocks in free fall
    iterations, converged = model.solve("max_res", 1e-9, "max_iter", 100, "lsearch", "simplest")
    return model.variable("u"), bool(converged), int(iterations)


def main():
    """Solve the problem of the first file, write the answer to the second."""
    data = np.load(sys.argv[1])
    K, C_n, C_t = (csr(data, name) for name in ("K", "C_n", "C_t"))
    f, gap, mu = data["f"], data["gap"], data["friction"]
    force = np.abs(f).sum() / len(gap)
    stiff = K.diagonal().mean()
    length = force / stiff
    matrices = to_getfem(K / stiff), to_getfem(-C_n), to_getfem(C_t), to_getfem(-COMPLIANCE * sp.identity(len(gap)))
    lost = 0.0
    for factor in FACTORS:
        begin = time.perf_counter()
        try:
            u, converged, iterations = newton(matrices[0], f / force, *matrices[1:], gap / length, mu, factor)
        except RuntimeError as error:
            print(error)
            u, converged, iterations = np.full(len(f), np.nan), False, 0
        seconds = time.perf_counter() - begin
        if converged:
            break
        lost += seconds
    note = f"r = {factor:g}: {iterations} Newton steps; {lost:.1f} s on other r"
    np.savez(sys.argv[2], u=u * length, converged=converged, seconds=seconds, note=note)


if __name__ == "__main__":
    main()
