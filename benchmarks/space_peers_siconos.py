"""Siconos on one contact problem in space; run by the system's Python (Debian package ``python3-siconos``).

    /usr/bin/python3 space_peers_siconos.py problem.npz answer.npz admm|newton|gauss-seidel TOLERANCE

Knows nothing of concio: reads K, f, C (rows normal, first, second tangent of each pair), gap and friction, writes
displacements, forces, seconds and an outcome. K must be definite. Forces are divided by the mean load on a pair,
lengths by that force over the mean stiffness.
"""

import sys
import time

import numpy as np
import scipy.sparse as sp
import siconos.numerics as sn

WAYS = {
    "admm": (sn.SICONOS_GLOBAL_FRICTION_3D_ADMM, 100_000),
    "newton": (sn.SICONOS_GLOBAL_FRICTION_3D_NSN_AC, 500),
    "gauss-seidel": (sn.SICONOS_GLOBAL_FRICTION_3D_NSGS_WR, 100_000),
}


def main():
    """Solve the problem of the first file, write the answer to the second."""
    data = np.load(sys.argv[1])
    way, limit = WAYS[sys.argv[3]]
    K, C = (
        sp.csr_matrix((data[k + "_data"], data[k + "_indices"], data[k + "_indptr"]), shape=tuple(data[k + "_shape"]))
        for k in ("K", "C")
    )
    m = len(data["gap"])
    begin = time.process_time()
    force, stiff = np.abs(data["f"]).sum() / m, K.diagonal().mean()
    problem = sn.GlobalFrictionContactProblem()
    problem.dimension = 3
    problem.numberOfContacts = m
    problem.M = (K / stiff).tocsc()
    problem.H = C.T.tocsc()
    problem.q = data["f"] / force
    start = np.zeros(3 * m)
    start[::3] = data["gap"] / (force / stiff)
    problem.b = start
    problem.mu = data["friction"].copy()
    t, y, u = np.zeros(3 * m), np.zeros(3 * m), np.zeros(K.shape[0])
    options = sn.SolverOptions(way)
    options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = limit
    options.dparam[sn.SICONOS_DPARAM_TOL] = float(sys.argv[4])
    info = sn.gfc3d_driver(problem, t, y, u, options)
    seconds = time.process_time() - begin
    note = f"{options.iparam[sn.SICONOS_IPARAM_ITER_DONE]} iterations"
    np.savez(sys.argv[2], u=u * force / stiff, t=t * force, converged=info == 0, seconds=seconds, note=note)


if __name__ == "__main__":
    main()
