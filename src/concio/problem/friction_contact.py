r"""Contact problems from the two forms that the friction contact community exchanges (FCLIB, Siconos).

*Global*: with the mass or stiffness M of the bodies, the contact operator H, loads and gaps or free velocities,

.. math:: M v = q + H r, \qquad u = H^T v + b, \qquad \mathcal K^* \ni u + \mu |u_t| n \perp r \in \mathcal K_\mu

and *local*, on the contacts alone, :math:`u = W r + q` with the Delassus operator :math:`W = H^T M^{-1} H`. Of each
contact the normal component comes first, then the d - 1 tangential ones; gaps or velocities, forces or impulses are one
to the equations. The global form is a :class:`ContactProblem` as it stands: K = M, C = H'. The local form becomes one
without any inverse, and whether W is regular or not (it is not wherever contacts are redundant): with u on the contacts
and the forces s as further unknowns,

.. math::

    \begin{pmatrix} 0 & \kappa I \\ \kappa I & -\kappa^2 W \end{pmatrix} \begin{pmatrix} u \\ s/\kappa \end{pmatrix}
    = \begin{pmatrix} I \\ 0 \end{pmatrix} r , \qquad C = (I, 0)

says s = r and u = W r. This K is symmetric and sparse where W is, but not semidefinite: it holds a compliance.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.arguments import strict
from concio.errors import InputError
from concio.problem.contact_problem import ContactProblem, Laws

Array = np.ndarray


@strict
def local_problem(W: Any, q: Array, mu: Array | float, *, dim: int = 3) -> ContactProblem:
    """Return the contact problem of the local form u = W r + q.

    Parameters
    ----------
    W : (m d, m d) array or sparse matrix
        Delassus operator, symmetric positive semidefinite, of any rank; contact k has rows k d ... (k + 1) d - 1, the
        normal first.
    q : (m d,) array
        Free gaps and slips, or velocities.
    mu : (m,) array or float
        Coefficients of friction.
    dim : {2, 3}
        d.

    Returns
    -------
    ContactProblem
        ``normal_force`` and ``friction_force`` of its solution are r, ``gap`` and ``slip`` are u.

    Raises
    ------
    InputError
        Shapes do not fit, or W is not symmetric or has a diagonal that is not positive.
    """
    q = np.asarray(q, dtype=float)
    _check_dim(dim)
    W = sp.csr_array(W)
    n = q.size
    if q.ndim != 1 or n % dim or not n or W.shape != (n, n):
        msg = f"W of shape {W.shape} and q of shape {q.shape} are not a problem of contacts with {dim} components"
        raise InputError(msg, hint="both have d rows for each contact")
    scale = float(abs(W).max()) or 1.0
    if not math.isfinite(scale) or abs(W - W.T).max() > 1e-9 * scale:
        msg = "W is not symmetric" if math.isfinite(scale) else "W holds a value that is not finite"
        raise InputError(msg, hint="the local form is u = W r + q with W = H' M^-1 H")
    diagonal = W.diagonal()
    if not (diagonal > 0).all():
        msg = f"W[{int(np.argmin(diagonal))}, {int(np.argmin(diagonal))}] = {diagonal.min():g} must be positive"
        raise InputError(msg, hint="a contact whose force moves nothing is none")
    kappa = float(1.0 / np.exp(np.log(diagonal).mean()))
    one, nothing = sp.eye_array(n), sp.csr_array((n, n))
    K = sp.csr_array(sp.block_array([[None, kappa * one], [kappa * one, -(kappa**2) * W]]))
    return _problem(K, np.zeros(2 * n), sp.csr_array(sp.hstack([one, nothing])), q, mu, dim)


@strict
def global_problem(M: Any, H: Any, q: Array, b: Array, mu: Array | float, *, dim: int = 3) -> ContactProblem:
    """Return the contact problem of the global form M v = q + H r, u = H' v + b.

    Parameters
    ----------
    M : (N, N) sparse matrix
        Mass or stiffness, symmetric positive definite.
    H : (N, m d) sparse matrix
        Columns of contact k: normal, then tangential.
    q : (N,) array
        Loads.
    b : (m d,) array
        Free gaps and slips, or velocities.
    mu : (m,) array or float
    dim : {2, 3}
        d.

    Raises
    ------
    InputError
        Shapes do not fit, or M is not symmetric.
    """
    _check_dim(dim)
    M, H = sp.csr_array(M), sp.csr_array(H)
    q, b = np.asarray(q, dtype=float), np.asarray(b, dtype=float)
    n = q.size
    if M.shape != (n, n) or H.shape != (n, b.size) or b.size % dim or not b.size:
        msg = f"M {M.shape}, H {H.shape}, q {q.shape} and b {b.shape} do not fit together"
        raise InputError(msg, hint=f"M is (N, N), H (N, {dim} m), q (N,), b ({dim} m,) for m contacts")
    scale = float(abs(M).max()) or 1.0
    if not math.isfinite(scale) or abs(M - M.T).max() > 1e-9 * scale:
        msg = "M is not symmetric"
        raise InputError(msg)
    return _problem(M, q, sp.csr_array(H.T), b, mu, dim)


def _problem(K: sp.csr_array, f: Array, C: sp.csr_array, free: Array, mu: Array | float, dim: int) -> ContactProblem:
    m = free.size // dim
    friction = np.asarray(mu, dtype=float)
    if friction.shape not in ((), (m,)) or not np.isfinite(friction).all() or (friction < 0).any():
        msg = f"mu of shape {friction.shape} must be one coefficient, or one for each of {m} contacts, none negative"
        raise InputError(msg)
    rows = np.arange(m * dim).reshape(m, dim)
    return ContactProblem(
        K=K,
        f=f,
        C_n=sp.csr_array(C[rows[:, 0]]),
        C_t=sp.csr_array(C[rows[:, 1:].ravel()]),
        gap=free[rows[:, 0]],
        laws=Laws.coulomb(friction, m),
        R=sp.csc_array((K.shape[0], 0)),
        bodies=_parts(K),
        slip_origin=-free[rows[:, 1:]],
    )


def _parts(K: sp.csr_array) -> Array:
    """Return where the uncoupled blocks of K begin, or one block where they are not contiguous."""
    _, label = connected_components(K, directed=False)
    edges = np.flatnonzero(np.diff(label)) + 1
    blocks = np.concatenate([[0], edges, [K.shape[0]]])
    contiguous = len(blocks) - 1 == len(np.unique(label))
    return blocks if contiguous else np.array([0, K.shape[0]])


def _check_dim(dim: int) -> None:
    if dim not in (2, 3):
        msg = f"dim = {dim!r} must be 2 or 3"
        raise InputError(msg)
