r"""Lemke's complementary pivoting for standard linear complementarity problems.

With a positive covering vector d the problem :math:`w = M z + q + d z_0` is solved by ``z = 0`` for large ``z_0``; the
method follows the path of almost complementary solutions from there until ``z_0`` leaves the basis (a solution) or the
path ends on a *secondary ray*, which is returned as data. For copositive-plus M a ray proves that the problem has no
feasible point; in general it proves nothing.

* Rows and columns are scaled to order one by powers of two (no digit is lost), q by one more.
* Ties of the ratio test are broken by a symbolic perturbation ``q + eps p`` with one generic ``p > 0``: its image
  ``B^{-1} p`` is carried along and compared where ratios tie. For a generic p every perturbed vertex is nondegenerate,
  which is what the lexicographic rule ensures with n vectors. p is drawn from a fixed seed: runs repeat.
* The basis is refactorised every ``refresh`` pivots, and the vertex is computed afresh with iterative refinement.
* A "ray" at which z0 is already zero is a solution. A pivot that is small beside its column is never taken from a basis
  that was not just refactorised.

References
----------
C. E. Lemke, Bimatrix equilibrium points and mathematical programming, *Management Science* 11 (1965) 681-689. R. W.
Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, 1992, sections 4.4 and 4.9.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Literal

import numpy as np
import scipy.sparse as sp

from concio.errors import InputError
from concio.problem.contact_problem import Array
from concio.problem.solution import Progress, ProgressCallback
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.lcp.lemke_basis import Basis, Columns, ExplicitInverse, ProductForm
from concio.solvers.lcp.linear_problem import LinearComplementarity, Matrix, is_sparse

PIVOT = 1e-9
"""Entries of a column below this, relative to its largest, do not take part in the ratio test."""

TIE = 1e-12
"""Ratios that differ by less than this, relative to the size of the vertex, tie."""

EQUILIBRATIONS = 4
"""Rounds in which rows and columns are brought to one size."""

SOLVED = 1e-11
"""z0, relative to its largest value on the path, that counts as zero."""


PRODUCT = 250
"""Size from which the product form is faster than the dense inverse (``benchmarks/lcp_forms.py``)."""


class Outcome(Enum):
    """How Lemke's method ended."""

    SOLVED = "solution"
    RAY = "secondary ray"
    LIMIT = "limit of pivots reached"
    CANCELLED = "stopped on request"
    BROKEN = "the basis became singular"
    LOST = "rounding took a wrong turn: the path came back on itself"


@dataclass(frozen=True, eq=False)
class Ray:
    """A secondary ray z + s dz, w + s dw, z0 + s dz0 for all s >= 0, almost complementary throughout.

    Parameters
    ----------
    z, w : (n,) arrays
        Its origin.
    z0 : float
    dz, dw : (n,) arrays
        Its direction.
    dz0 : float
    """

    z: Array
    w: Array
    z0: float
    dz: Array
    dw: Array
    dz0: float


@dataclass(frozen=True, eq=False)
class LemkeResult:
    """Outcome of Lemke's method.

    Parameters
    ----------
    outcome : Outcome
    z, w : (n,) arrays
        The solution, or the last vertex.
    pivots, factorisations : int
    ray : Ray or None
    residual : float
        max |min(z, M z + q)| of the original problem.
    """

    outcome: Outcome
    z: Array
    w: Array
    pivots: int
    factorisations: int
    ray: Ray | None
    residual: float


def lemke(
    problem: LinearComplementarity,
    *,
    cover: Array | None = None,
    limit: int | None = None,
    refresh: int = 64,
    basis: Literal["auto", "inverse", "product"] = "auto",
    seed: int = 0,
    progress: ProgressCallback | None = None,
) -> LemkeResult:
    """Solve a standard linear complementarity problem by Lemke's method.

    Parameters
    ----------
    problem : LinearComplementarity
    cover : (n,) array, optional
        Positive covering vector d of w = M z + q + d z0, in the units of q; by default ones after scaling.
    limit : int, optional
        Largest number of pivots; default 50 n + 1000.
    refresh : int
        Pivots between refactorisations.
    basis : {"auto", "inverse", "product"}
        How the basis is kept; "auto" takes the product form for n > 250.
    seed : int
        Of the symbolic perturbation.
    progress : callable, optional
        Called every 64 pivots with z0 as the residual.

    Raises
    ------
    InputError
        The covering vector is not positive, or an option is unknown.
    """
    n = problem.size
    d = np.ones(n) if cover is None else np.asarray(cover, dtype=float)
    if d.shape != (n,) or not (d > 0).all():
        msg = "the covering vector must be positive"
        raise InputError(msg, hint=f"give {n} positive numbers, or leave it out")
    if basis not in ("auto", "inverse", "product"):
        msg = f"unknown basis '{basis}'"
        raise InputError(msg, hint="auto, inverse or product")
    if n == 0 or problem.q.min() >= 0.0:
        return LemkeResult(Outcome.SOLVED, np.zeros(n), problem.q.copy(), 0, 0, None, 0.0)
    rows, columns, matrix = equilibrate(problem.M)
    size = float(np.abs(rows * problem.q).max())
    covering = d if cover is None else rows * d / float((rows * d).max())
    path = _Path(matrix, rows * problem.q / size, covering, refresh, basis, seed)
    outcome, ray = path.follow(limit or 50 * n + 1000, progress)
    w, z = path.read()
    z, w = z * columns * size, w / rows * size
    if outcome is Outcome.SOLVED:
        w = problem.slack(z)
    if ray is not None:
        back_z, back_w = columns * size, size / rows
        ray = Ray(z, w, ray.z0 * size, ray.dz * back_z, ray.dw * back_w, ray.dz0 * size)
    return LemkeResult(outcome, z, w, path.pivots, path.factorisations, ray, problem.residual(z))


def equilibrate(M: Matrix) -> tuple[Array, Array, Matrix]:
    """Return powers of two r, c and diag(r) M diag(c) whose rows and columns have largest entries near one."""
    n = M.shape[0]
    r: Array = np.ones(n)
    c: Array = np.ones(n)
    size: Matrix = abs(sp.csr_array(M)) if is_sparse(M) else np.abs(M)
    for _ in range(EQUILIBRATIONS):
        scaled: Matrix = size.multiply(r[:, None]).multiply(c[None, :]) if is_sparse(size) else size * r[:, None] * c
        across = _largest(scaled, 1)
        down = _largest(scaled, 0)
        r /= np.sqrt(np.where(across > 0, across, 1.0))
        c /= np.sqrt(np.where(down > 0, down, 1.0))
    r, c = 2.0 ** np.round(np.log2(r)), 2.0 ** np.round(np.log2(c))
    if is_sparse(M):
        return r, c, sp.csr_array(sp.diags_array(r) @ M @ sp.diags_array(c))
    return r, c, M * r[:, None] * c


def _largest(a: Matrix, axis: int) -> Array:
    found: Matrix = a.max(axis=axis)
    largest: Array = (found.toarray() if is_sparse(found) else found).ravel()
    return largest


class _Path:
    """The almost complementary path of a scaled problem."""

    def __init__(self, M: Matrix, q: Array, d: Array, refresh: int, basis: str, seed: int) -> None:
        self.n = n = q.size
        self.q = q
        product = basis == "product" or (basis == "auto" and n > PRODUCT)
        self._kind: type[ProductForm] | type[ExplicitInverse] = ProductForm if product else ExplicitInverse
        self.columns = Columns(M if product or not is_sparse(M) else M.toarray(), d)
        self.refresh = refresh
        self.p = 0.5 + np.random.default_rng(seed).random(n)
        self.pivots, self.factorisations = 0, 0
        key = q / d
        tied = np.flatnonzero(key <= key.min() + TIE * abs(key.min()))
        row = int(tied[np.argmin(self.p[tied] / d[tied])])
        self.basis = np.arange(n)
        self.leaving = row
        self.basis[row] = 2 * n
        self.pivots = 1
        self.inverse: Basis = self._factorise()
        self.top = float(self.x[row])

    def _factorise(self) -> Basis:
        """Factorise the basis and compute the vertex and its perturbation afresh, with iterative refinement."""
        self.factorisations += 1
        inverse: Basis = self._kind(self.columns, self.basis)
        matrix = self.columns.matrix(self.basis)
        vertex = []
        for target in (self.q, self.p):
            x = inverse.solve(target)
            for _ in range(2):
                x = x + inverse.solve(target - matrix @ x)
            vertex.append(x)
        self.x, self.xp = vertex
        if not (np.isfinite(self.x).all() and np.isfinite(self.xp).all()):
            msg = "the basis is singular"
            raise SingularMatrixError(msg)
        return inverse

    def follow(self, limit: int, progress: ProgressCallback | None) -> tuple[Outcome, Ray | None]:
        """Pivot until the path ends."""
        try:
            return self._follow(limit, progress)
        except SingularMatrixError:
            return Outcome.BROKEN, None

    def _follow(self, limit: int, progress: ProgressCallback | None) -> tuple[Outcome, Ray | None]:
        n = self.n
        tokens = np.random.default_rng(0).integers(1, 2**62, 2 * n + 1).tolist()
        key = 0
        for j in self.basis.tolist():
            key ^= tokens[j]
        visited = {key}  # of bases: none is met twice on a path
        while self.pivots < limit:
            entering = self.leaving + n if self.leaving < n else self.leaving - n
            if self.inverse.updates >= self.refresh:
                self.inverse = self._factorise()
            column = self.inverse.solve(self.columns.column(entering))
            row = self._ratio_test(column)
            old = self.inverse.updates
            if old and (row < 0 or (old > 8 and abs(column[row]) < 1e-5 * np.abs(column).max())):
                self.inverse = self._factorise()
                column = self.inverse.solve(self.columns.column(entering))
                row = self._ratio_test(column)
            if row < 0:
                at = int(np.flatnonzero(self.basis == 2 * n)[0])
                if self.x[at] <= SOLVED * self.top:
                    return Outcome.SOLVED, None
                return Outcome.RAY, self._ray(column, entering, at)
            self._pivot(row, entering, column)
            key ^= tokens[entering] ^ tokens[self.leaving]
            if self.leaving == 2 * n:
                self.inverse = self._factorise()
                return Outcome.SOLVED, None
            if key in visited:
                return Outcome.LOST, None
            visited.add(key)
            if progress and self.pivots % 64 == 0:
                z0 = float(self.x[self.basis == 2 * n][0])
                if progress(Progress("lemke", self.pivots, z0, f"z0 = {z0:.2e}")):
                    return Outcome.CANCELLED, None
        return Outcome.LIMIT, None

    def _ratio_test(self, column: Array) -> int:
        """Return the row that leaves, -1 where none does."""
        rows = np.flatnonzero(column > PIVOT * max(1.0, float(np.abs(column).max())))
        if not rows.size:
            return -1
        x, by = np.maximum(self.x[rows], 0.0), column[rows]
        ratio = x / by
        slack = TIE * max(1.0, float(np.abs(self.x).max()))
        tied = np.flatnonzero(ratio <= ((x + slack) / by).min())
        z0 = [i for i in tied if self.basis[rows[i]] == 2 * self.n]
        if z0:
            return int(rows[z0[0]])
        tied = tied[by[tied] >= 1e-6 * by[tied].max()]
        return int(rows[tied[np.argmin(self.xp[rows[tied]] / by[tied])]])

    def _pivot(self, row: int, entering: int, column: Array) -> None:
        step, small = max(self.x[row], 0.0) / column[row], self.xp[row] / column[row]
        self.x = self.x - step * column
        self.xp = self.xp - small * column
        self.x[row], self.xp[row] = step, small
        self.inverse.replace(row, column)
        self.leaving = int(self.basis[row])
        self.basis[row] = entering
        self.pivots += 1

    def _ray(self, column: Array, entering: int, at: int) -> Ray:
        n = self.n
        direction = np.zeros(2 * n + 1)
        direction[self.basis] = -column
        direction[entering] = 1.0
        empty = np.zeros(0)
        return Ray(empty, empty, float(self.x[at]), direction[n : 2 * n], direction[:n], float(direction[-1]))

    def read(self) -> tuple[Array, Array]:
        """Return w and z (n,) of the vertex, tiny negative values cut off."""
        values = np.zeros(2 * self.n + 1)
        values[self.basis] = np.maximum(self.x, 0.0)
        return values[: self.n], values[self.n : -1]
