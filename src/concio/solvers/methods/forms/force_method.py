r"""Force method with rigid coordinates (26-33): the gaps of chosen contacts stand for the rigid motions.

As many components I are chosen as there are rigid motions, with N_I regular. Their gaps w_I become the rigid
coordinates, ``alpha = N_I^{-1}(w_I - M_I z - q_I)``, and with H = N_E N_I^{-1} (E: the other rows)

.. math::

    w_E - H w_I &= (M_E - H M_I)\,z + q_E - H q_I                                        &(31, 32)\\
    0 &= E z + e, \qquad\text{that is}\quad t_I = t_0 - H^T t_E                           &(26)

which is the generalised problem ``A z + B w = c`` of (33), n rows and no unknown for rigid motions: six fewer for each
free body in the plane than the split form. Taking z_I from equilibrium makes it a standard problem, whose matrix holds
the flexibility ``P F P'`` of the isostatic structure, P = [identity, -H].

The paper takes I among the normal gaps. Where normals alone do not hold the bodies (a block on a flat base may slide)
tangential components join. I is found by a pivoted QR factorisation of the rows, scaled to order one; its condition
number is recorded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg as sl

from concio.errors import MethodError
from concio.problem.contact_problem import Array
from concio.solvers.lcp.linear_problem import GeneralisedComplementarity, LinearComplementarity
from concio.solvers.methods.forms.forms import MixedForm

NORMAL_ONLY = 1e4
"""Largest condition number at which normal gaps alone are taken, as in the paper."""

RANK = 1e-10
"""Pivots below this, relative to the first, mean that the contacts do not hold all rigid motions."""


@dataclass(frozen=True, eq=False)
class ForceMethod:
    """A form whose rigid motions are expressed by the gaps of chosen contacts.

    Parameters
    ----------
    form : MixedForm
    chosen, others : integer arrays
        Rows I (r,) and E (n - r,) of the form.
    condition : float
        Condition number of N_I with columns scaled.
    normal_only : bool
        Whether I holds normal gaps alone.
    """

    form: MixedForm
    chosen: Array
    others: Array
    condition: float
    normal_only: bool

    def _ratio(self) -> Array:
        form = self.form
        if not form.motions:
            return np.zeros((form.size, 0))
        H: Array = sl.solve(form.N[self.chosen].T, form.N[self.others].T).T
        return H

    def generalised(self) -> GeneralisedComplementarity:
        """Return A z + B w = c (33), rows E first, then equilibrium."""
        form, I, E, H = self.form, self.chosen, self.others, self._ratio()
        n = form.size
        A, B = np.zeros((n, n)), np.zeros((n, n))
        A[: E.size] = form.M[E] - H @ form.M[I]
        B[np.arange(E.size), E] = -1.0
        B[: E.size, I] = H
        A[E.size :] = sl.solve(form.E[:, I], form.E) if form.motions else form.E
        start = sl.solve(form.E[:, I], form.e) if form.motions else form.e
        return GeneralisedComplementarity(A, B, np.concatenate([H @ form.q[I] - form.q[E], -start]))

    def basis(self) -> Array:
        """Return the complementary basis of the isostatic structure: True where z (a force of I) is taken."""
        taken = np.zeros(self.form.size, dtype=bool)
        taken[self.chosen] = True
        return taken

    def standard(self) -> tuple[LinearComplementarity, Callable[[Array, Array], tuple[Array, Array]]]:
        """Return the standard problem, z_I taken from equilibrium, and what maps its (z, w) back to the form."""
        form, I, E, H = self.form, self.chosen, self.others, self._ratio()
        n, r = form.size, form.motions
        if r:
            solved = sl.solve(form.E[:, I], np.column_stack([form.E[:, E], form.e]))
        else:
            solved = np.zeros((0, n + 1))
        by, start = solved[:, :-1], solved[:, -1]  # z_I = -start - by z_E
        M_t = form.M[E] - H @ form.M[I]
        M, q = np.zeros((n, n)), np.zeros(n)
        M[np.ix_(E, E)] = M_t[:, E] - M_t[:, I] @ by
        M[np.ix_(E, I)] = H
        M[np.ix_(I, E)] = -by
        q[E] = form.q[E] - H @ form.q[I] - M_t[:, I] @ start
        q[I] = -start

        def back(z: Array, w: Array) -> tuple[Array, Array]:
            z, w = z.copy(), w.copy()
            z[I], w[I] = w[I].copy(), z[I].copy()
            return z, w

        return LinearComplementarity(M, q), back


def force_method(form: MixedForm, *, normal_only: bool | None = None) -> ForceMethod:
    """Choose the rigid coordinates of a form.

    Parameters
    ----------
    form : MixedForm
    normal_only : bool, optional
        True: normal gaps alone, as in the paper; False: the best conditioned choice; by default normal gaps where they
        serve with a condition number below 1e4.

    Raises
    ------
    MethodError
        The contacts asked for do not hold all rigid motions.
    """
    m, k, r = form.reduction.pairs, form.reduction.rough.size, form.motions
    if not r:
        return ForceMethod(form, np.arange(0), np.arange(form.size), 1.0, True)
    candidates = form.reduction.G
    reach = np.abs(candidates).max(axis=0)
    candidates = candidates / np.where(reach > 0, reach, 1.0)
    chosen, condition = _independent(candidates[:m], r)
    alone = chosen is not None and (normal_only or condition <= NORMAL_ONLY)
    if normal_only and chosen is None:
        msg = "normal gaps alone do not hold all rigid motions"
        raise MethodError(msg, hint="let tangential components join: normal_only=False")
    if (not alone or normal_only is False) and form.name != "normal":
        chosen, condition = _independent(candidates[: m + k], r)
    if chosen is None:
        msg = "the contacts do not hold all rigid motions: some body touches too little"
        raise MethodError(msg, hint="use lee, sparse-lemke or interior-point")
    others = np.setdiff1d(np.arange(form.size), chosen)
    return ForceMethod(form, chosen, others, condition, bool((chosen < m).all()))


def _independent(rows: Array, r: int) -> tuple[Array | None, float]:
    """Return r independent rows found by pivoted QR and their condition number; None where there are not so many."""
    if rows.shape[0] < r:
        return None, np.inf
    triangle, pivots = sl.qr(rows.T, mode="r", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    if diagonal[r - 1] <= RANK * diagonal[0]:
        return None, np.inf
    chosen = np.sort(pivots[:r])
    return chosen, float(np.linalg.cond(rows[chosen]))
