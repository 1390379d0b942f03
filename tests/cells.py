"""Helpers for tests of periodic cells: cells turned, mirrored, moved; and a periodic finite element computation.

The latter shares nothing with concio but numpy: one mesh over the whole cell, scikit-fem's quadrilaterals, bonded
everywhere, periodic by elimination.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import spsolve
from skfem.helpers import ddot, sym_grad

import concio

Array = np.ndarray


def moved(cell: concio.Model, matrix: Array, shift: Array | tuple[float, float] = (0.0, 0.0)) -> concio.Model:
    """Return a cell whose points x are at ``matrix`` x + ``shift``; mesh lines are lost where it is not a shift."""
    matrix = np.asarray(matrix, dtype=float)
    same = np.array_equal(matrix, np.eye(2))

    def grid(body: concio.Body) -> tuple[Array, Array] | None:
        return (body.grid[0] + shift[0], body.grid[1] + shift[1]) if same and body.grid is not None else None

    bodies = tuple(replace(b, outline=b.outline @ matrix.T + np.array(shift), grid=grid(b)) for b in cell.bodies)
    p = np.asarray(cell.periods) @ matrix.T
    return replace(cell, bodies=bodies, periods=(tuple(p[0]), tuple(p[1])))


def other_origin(cell: concio.Model, seed: int = 0) -> concio.Model:
    """Return the same periodic wall cut into cells elsewhere: each body replaced by one of its images, in new order."""
    rng = np.random.default_rng(seed)
    p = np.asarray(cell.periods)
    bodies = []
    for body in cell.bodies:
        away = rng.integers(-2, 3, 2) @ p
        grid = None if body.grid is None else (body.grid[0] + away[0], body.grid[1] + away[1])
        bodies.append(replace(body, outline=body.outline + away, grid=grid))
    return replace(cell, bodies=tuple(bodies[k] for k in rng.permutation(len(bodies))))


def stress_matrix(turn: Array) -> Array:
    """Return T (3, 3): components xx, yy, xy of Q S Q' from those of S, for an orthogonal matrix Q (2, 2)."""
    columns = []
    for k in range(3):
        s = np.zeros(3)
        s[k] = 1.0
        S = turn @ np.array([[s[0], s[2]], [s[2], s[1]]]) @ turn.T
        columns.append([S[0, 0], S[1, 1], S[0, 1]])
    return np.array(columns).T


def periodic_elements(xs: Array, ys: Array, young: Callable[[Array], Array], nu: float, plane: str = "stress") -> Array:
    """Return the homogenised moduli (3, 3) of a bonded cell, by bilinear elements on one mesh.

    Parameters
    ----------
    xs, ys : arrays
        Mesh lines from one side of the cell to the other.
    young : callable
        Young's modulus (e,) at element centres (2, e).
    nu : float
        Poisson's ratio everywhere.
    """
    mesh = skfem.MeshQuad.init_tensor(xs, ys)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad1()), intorder=2)
    E = young(mesh.p[:, mesh.t].mean(1))
    ratio = nu / (1 - nu) if plane == "strain" else nu
    scale = E / (1 - nu**2) if plane == "strain" else E
    mu = scale / (2 * (1 + ratio)) * np.ones_like(E)
    lam = scale * ratio / (1 - ratio**2)
    at = {"lam": skfem.Basis(mesh, skfem.ElementQuad0(), intorder=2)}
    fields = {name: at["lam"].interpolate(v) for name, v in (("lam", lam), ("mu", mu))}

    @skfem.BilinearForm
    def stiffness(u, v, w):
        e = sym_grad(u)
        trace = e[0, 0] + e[1, 1]
        identity = np.array([[np.ones_like(trace), 0 * trace], [0 * trace, np.ones_like(trace)]])
        return ddot(w["lam"] * trace * identity + 2 * w["mu"] * e, sym_grad(v))

    K = stiffness.assemble(basis, **fields)
    dofs = basis.nodal_dofs  # (2, nodes)
    x, y = mesh.p
    width, height = xs[-1] - xs[0], ys[-1] - ys[0]
    home = {}
    for node, place in enumerate(zip(np.round((x - xs[0]) % width, 9) % round(width, 9),
                                     np.round((y - ys[0]) % height, 9) % round(height, 9), strict=True)):  # fmt: skip
        home.setdefault(place, []).append(node)
    column = np.zeros(mesh.nvertices, dtype=int)
    for k, nodes in enumerate(home.values()):
        column[nodes] = k
    n = len(home)
    rows = np.concatenate([dofs[0], dofs[1]])
    columns = np.concatenate([2 * column, 2 * column + 1])
    P = sp.csr_array((np.ones(len(rows)), (rows, columns)), shape=(2 * mesh.nvertices, 2 * n))
    free = np.arange(2, 2 * n)
    affine = np.zeros((2 * mesh.nvertices, 3))
    for k, (exx, eyy, gxy) in enumerate(np.eye(3)):
        affine[dofs[0], k] = exx * x + 0.5 * gxy * y
        affine[dofs[1], k] = 0.5 * gxy * x + eyy * y
    Kp = (P.T @ K @ P)[free][:, free]
    u = affine.copy()
    for k in range(3):
        q = np.zeros(2 * n)
        q[free] = spsolve(sp.csc_matrix(Kp), -(P.T @ (K @ affine[:, k]))[free])
        u[:, k] += P @ q
    return u.T @ (K @ u) / (width * height)
