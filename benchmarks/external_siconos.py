"""Siconos on one contact problem; run by the system's Python (Debian package ``python3-siconos``).

    /usr/bin/python3 external_siconos.py problem.npz answer.npz lemke|admm|admm-tight

Knows nothing of concio: reads K, f, C_n, C_t, gap and friction, writes displacements, seconds and an outcome. K must be
definite. Two ways, as Siconos offers them:

``lemke``
    Siconos' lexicographic Lemke on the dense LCP of 3 m unknowns z = (t_n, s+, y-), w = (y_n, y+, s-), after
    condensing the displacements: F = C inv(K) C'. The time of the condensation is part of the seconds.
``admm``
    Siconos' ADMM for the global friction problem K u = f + H r, with sparse K. It is three-dimensional: every pair gets
    a second tangent with an unknown of its own that nothing loads. To 1e-6.
``admm-tight``
    The same to 1e-10, nearer to what the engine delivers.

Forces are divided by the mean load on a pair, lengths by that force times the mean flexibility (ADMM: over the mean
stiffness).
"""

import sys
import time

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
import siconos.numerics as sn


def sparse(data, name):
    """Return the CSC matrix ``name`` of the file."""
    parts = tuple(data[name + "_" + part] for part in ("data", "indices", "indptr"))
    return sp.csr_matrix(parts, shape=tuple(data[name + "_shape"])).tocsc()


def lemke(K, f, C_n, C_t, gap, mu):
    """Return (u, converged, note) by Siconos' Lemke on the condensed LCP."""
    m = len(gap)
    C = sp.vstack([C_n, C_t]).tocsc()
    factor = sla.splu(K)
    flexible = factor.solve(C.T.toarray())
    F = C @ flexible
    F = 0.5 * (F + F.T)
    force = np.abs(f).sum() / m
    soft = np.diag(F).mean()
    F /= soft
    free = (np.concatenate([gap, np.zeros(m)]) + C @ factor.solve(f)) / (soft * force)
    M = np.zeros((3 * m, 3 * m))
    M[:m, :m] = F[:m, :m] - F[:m, m:] * mu
    M[:m, m : 2 * m] = F[:m, m:]
    M[m : 2 * m, :m] = F[m:, :m] - F[m:, m:] * mu
    M[m : 2 * m, m : 2 * m] = F[m:, m:]
    M[m : 2 * m, 2 * m :] = np.eye(m)
    M[2 * m :, :m] = 2.0 * np.diag(mu)
    M[2 * m :, m : 2 * m] = -np.eye(m)
    q = np.concatenate([free, np.zeros(m)])
    problem = sn.LCP(M, q)
    z, w = np.zeros(3 * m), np.zeros(3 * m)
    options = sn.SolverOptions(sn.SICONOS_LCP_LEMKE)
    options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 100 * m
    options.dparam[sn.SICONOS_DPARAM_TOL] = 1e-10
    info = sn.linearComplementarity_driver(problem, z, w, options)
    w = M @ z + q
    residual = np.abs(np.minimum(z, w)).max()
    t = np.concatenate([z[:m], z[m : 2 * m] - mu * z[:m]]) * force
    pivots = int(options.iparam[sn.SICONOS_IPARAM_ITER_DONE])
    note = f"{pivots} pivots, LCP residual {residual:.0e}"
    if info:
        note += f", Siconos says info {info}"
    return factor.solve(f) + flexible @ t, residual < 1e-6, note


def admm(K, f, C_n, C_t, gap, mu, tolerance=1e-6):
    """Return (u, converged, note) by Siconos' ADMM on the global problem."""
    m, n = C_n.shape
    force = np.abs(f).sum() / m
    stiff = K.diagonal().mean()
    length = force / stiff
    K3 = sp.block_diag([K / stiff, sp.identity(m)]).tocsc()
    rows = np.arange(m)
    pick = [sp.csr_matrix((np.ones(m), (3 * rows + k, rows)), shape=(3 * m, m)) for k in range(3)]
    C = sp.hstack([pick[0] @ C_n + pick[1] @ C_t, pick[2]]).tocsc()
    problem = sn.GlobalFrictionContactProblem()
    problem.dimension = 3
    problem.numberOfContacts = m
    problem.M = K3
    problem.H = C.T.tocsc()
    problem.q = np.concatenate([f / force, np.zeros(m)])
    start = np.zeros(3 * m)
    start[::3] = gap / length
    problem.b = start
    problem.mu = mu.copy()
    reaction, relative, u = np.zeros(3 * m), np.zeros(3 * m), np.zeros(n + m)
    options = sn.SolverOptions(sn.SICONOS_GLOBAL_FRICTION_3D_ADMM)
    options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 100000
    options.dparam[sn.SICONOS_DPARAM_TOL] = tolerance
    info = sn.gfc3d_driver(problem, reaction, relative, u, options)
    iterations, residual = options.iparam[sn.SICONOS_IPARAM_ITER_DONE], options.dparam[sn.SICONOS_DPARAM_RESIDU]
    note = f"{iterations} iterations, residual {residual:.0e}"
    return u[:n] * length, info == 0, note


def tight(*arguments):
    """Return (u, converged, note) by ADMM to 1e-10."""
    return admm(*arguments, tolerance=1e-10)


def main():
    """Solve the problem of the first file, write the answer to the second."""
    data = np.load(sys.argv[1])
    arguments = [sparse(data, name) for name in ("K", "C_n", "C_t")]
    way = {"lemke": lemke, "admm": admm, "admm-tight": tight}[sys.argv[3]]
    begin = time.perf_counter()
    u, converged, note = way(arguments[0], data["f"], arguments[1], arguments[2], data["gap"], data["friction"])
    seconds = time.perf_counter() - begin
    np.savez(sys.argv[2], u=u, converged=bool(converged), seconds=seconds, note=note)


if __name__ == "__main__":
    main()
