r"""Newton's equations of the plane interior point, each pair's eliminated to a 2 x 2 matrix.

What remains is :math:`(K + C^T D C)\,\delta u = r`, sparse and of one pattern, regular although K is singular: one
factorisation for each point, one back-substitution for each right-hand side.
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array
from concio.solvers.algebra.scaled import LOOSE, Scaled
from concio.solvers.algebra.sparse_factor import SingularMatrixError
from concio.solvers.interior.iterate import Iterate, Residuals
from concio.solvers.states.given import times


class Newton:
    """Newton's equations at a point: eliminated, factorised, and solved for one right-hand side after another.

    Parameters
    ----------
    s : Scaled
    z : Iterate
    rest : Residuals
    dilatancy : (m,) array
    used : (4, m) array
        One where a product is there, else zero.

    Raises
    ------
    SingularMatrixError
        There is no direction: the path turns back, or the matrix cannot be factorised.
    """

    def __init__(self, s: Scaled, z: Iterate, rest: Residuals, dilatancy: Array, used: Array) -> None:
        self.s, self.z, self.rest, self.dilatancy, self.used = s, z, rest, dilatancy, used
        rough, mu = s.rough, s.cone.friction
        # how stiff each law is: dual over slack, zero where the law is not there
        self.ratio = z.dual / z.slack * used
        opens, plus, minus, crush = self.ratio
        h_nn = opens + s.compliance[:, 0] + crush + dilatancy * mu * (plus + minus)
        lean = plus - minus
        h_tt = np.where(rough, plus + minus + s.compliance[:, 1], 1.0)
        det = h_nn * h_tt - dilatancy * lean * mu * lean
        if not det.all():
            msg = "the equations of a pair are singular"
            raise SingularMatrixError(msg)
        self.D = np.empty((s.pairs, 2, 2))
        self.D[:, 0, 0], self.D[:, 0, 1] = h_tt / det, -dilatancy * lean / det
        self.D[:, 1, 0], self.D[:, 1, 1] = -mu * lean / det, np.where(rough, h_nn / det, 0.0)
        if not s.factor.has(self.D, LOOSE):  # it has where the iteration begins
            s.factor.factorise(self.D, LOOSE)

    def direction(self, change: Array) -> Iterate:
        """Return the direction that changes the products by ``change`` (4, m), to first order."""
        s, z, r, mu = self.s, self.z, self.rest, self.s.cone.friction
        # dual parts: d dual = change / slack - ratio d slack, with ds+ = mu dt_n + dt_t + r+, ..., dq = r_q - dt_n
        free = change / z.slack * self.used
        plus, minus = free[1] - self.ratio[1] * r.p, free[2] - self.ratio[2] * r.m
        b = np.empty((s.pairs, 2))
        b[:, 0] = r.n - free[0] - self.dilatancy * (plus + minus) + free[3] - self.ratio[3] * r.q
        b[:, 1] = r.t - plus + minus
        du = s.factor.solve(-r.u - s.pull(times(self.D, b)))
        dt = times(self.D, b + s.along(du))
        slack = np.empty_like(z.slack)
        slack[0] = dt_n = -dt[:, 0]
        dt_t = -dt[:, 1] * self.used[1]
        slack[1], slack[2], slack[3] = mu * dt_n + dt_t + r.p, mu * dt_n - dt_t + r.m, r.q - dt_n
        slack *= self.used
        return Iterate(du, dt_t, slack, free - self.ratio * slack)
