r"""What the multiplier of a collapse state of Coulomb friction depends on: its derivatives, by virtual work.

In the state with forces t, motion v and multiplier lambda, the forces of equilibrium
R^T (f + lambda g + C^T t) = 0 have as many free numbers as there are equations: normal forces of the joints that are
pressed, friction where they stick; where they slip it is -(c + mu t_n) s. The virtual motion y on which none of these
numbers does work, y . g = 1, gives

.. math:: \frac{d\lambda}{dp} = - y \cdot \frac{\partial}{\partial p} (f + \lambda g + C^T t(p)) .

In the joints that slip, y opens by the friction coefficient; v does not. Where there are several y, a derivative is
given where it is that of all of them: it is then the same as the number falls and as it grows. In space nothing is
returned where joints slide under pressure, for the direction of slips turns there; nor is it where joints crush.

Source: P. Vermeer, R. de Borst, Heron 29 (1984) no. 3, on limit loads without normality.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from concio.analysis.parameters import Parameter
from concio.analysis.sensitivity import LARGEST_NULL_SPACE, STEP, ProblemOf, Sensitivity, SensitivityRow, rowless
from concio.errors import ConcioError, InputError
from concio.problem.contact_problem import ContactProblem
from concio.solvers.statics.collapse_state import CollapseState, Motion

Array = np.ndarray

PRESSED = 1e-7
"""Forces above this share of the largest are there."""
ALONE = 1e-9
"""Singular values below this share of the largest are none."""
SAME = 1e-7
"""Derivatives of several virtual motions that differ by less, relative to the largest of a model, are one."""


def coulomb_sensitivity(
    problem: ContactProblem, push: Array, state: CollapseState, problem_of: ProblemOf, parameters: Sequence[Parameter]
) -> Sensitivity | None:
    """Return the derivatives of the multiplier of a collapse state.

    Parameters
    ----------
    problem : ContactProblem
        Under the constant loads.
    push : (N,) array
        The loads that are multiplied.
    state : CollapseState
    problem_of : callable
        Returns problem and push of another model.
    parameters : sequence of Parameter

    Returns
    -------
    Sensitivity or None
        None where the multiplier depends on more than the forces of the state.
    """
    virtual = _Virtual.of(problem, push, state)
    if virtual is None:
        return None
    found = [_row(p, problem_of, virtual) for p in parameters]
    rows = sorted((r for r in found if r is not None), key=lambda r: -abs(r.per_percent[1]))
    return Sensitivity(state.multiplier, tuple(rows), rowless(parameters, found, state.multiplier)) if rows else None


class _Virtual:
    """Virtual motions (k, r) of a collapse state, in coordinates of rigid motions, and the forces that they weigh."""

    def __init__(
        self, problem: ContactProblem, state: CollapseState, slips: Array, along: Array, motions: Array
    ) -> None:
        self.problem, self.state, self.slips, self.along, self.motions = problem, state, slips, along, motions

    @classmethod
    def of(cls, problem: ContactProblem, push: Array, state: CollapseState) -> _Virtual | None:
        """Return those of a state; None where the forces of the state do not settle them."""
        flow, s = Motion.of(problem, state.velocity), problem.dim - 1
        size = float(np.abs(state.normal_force).max(initial=0.0))
        pressed = state.normal_force > PRESSED * size
        if flow.crushes.any() or problem.R.shape[1] > LARGEST_NULL_SPACE or (s > 1 and (pressed & flow.slips).any()):
            return None
        pull = np.linalg.norm(state.friction_force.reshape(problem.pairs, s), axis=1)
        strength = problem.laws.friction * state.normal_force + problem.laws.cohesion
        full = pressed & ~flow.slips & (strength - pull <= PRESSED * size)
        if s > 1 and (full & (strength > 0)).any():
            return None
        along = np.where(flow.slips[:, None], flow.direction, 0.0)
        at = np.flatnonzero(full & (pull > 0))
        along[at] = -state.friction_force.reshape(problem.pairs, s)[at] / pull[at][:, None]
        normal = np.asarray((problem.C_n @ problem.R).todense())
        sideways = np.asarray((problem.C_t @ problem.R).todense()).reshape(problem.pairs, s, -1)
        fixed = flow.slips | full
        free = normal - problem.laws.friction[:, None] * np.einsum("ps,psk->pk", along, sideways)
        sticks = pressed & ~fixed
        rows = np.vstack([free[pressed & fixed], normal[sticks], sideways[sticks].reshape(-1, normal.shape[1])])
        null = scipy.linalg.null_space(rows, rcond=ALONE)
        power = np.asarray(problem.R.T @ push) @ null
        size = float(power @ power)
        if not size > 0:
            return None
        least, draw = null @ power / size, np.random.default_rng(7)
        motions = [least]
        for _ in range(2 if null.shape[1] > 1 else 0):
            other = draw.standard_normal(null.shape[1])
            other -= power * float(power @ other) / size
            motions.append(least + null @ (other * float(np.linalg.norm(least)) / float(np.linalg.norm(other))))
        return cls(problem, state, fixed, along, np.array(motions))

    def power(self, problem: ContactProblem, push: Array) -> Array:
        """Return the powers (k,) of the forces of the state on the virtual motions, in a model near this one.

        Raises
        ------
        InputError
            It has other joints.
        """
        if problem.pairs != self.problem.pairs or problem.R.shape != self.problem.R.shape:
            msg = "models beside this one have other joints"
            raise InputError(msg)
        t_n, law, y = self.state.normal_force, problem.laws, problem.R @ self.motions.T
        slid = -(law.friction * t_n + law.cohesion)[:, None] * self.along
        t_t = np.where(self.slips[:, None], slid, self.state.friction_force.reshape(slid.shape))
        work = y.T @ (problem.f + self.state.multiplier * push)
        return np.asarray(work + (problem.C_n @ y).T @ t_n + (problem.C_t @ y).T @ t_t.ravel())


def _row(p: Parameter, problem_of: ProblemOf, virtual: _Virtual) -> SensitivityRow | None:
    """Return the derivative with respect to one number; None where there are several, or other joints beside."""
    h = STEP * (abs(p.value) or 1.0)
    try:
        read = [virtual.power(*problem_of(p.change(p.value + k * h))) for k in (-2, -1, 1, 2)]
    except (ConcioError, ValueError):
        return None
    rate = -(read[0] - 8 * read[1] + 8 * read[2] - read[3]) / (12 * h)
    if np.ptp(rate) > SAME * max(float(np.abs(rate).max()), virtual.state.multiplier / (abs(p.value) or 1.0)):
        return None
    one = float(rate[0])
    return SensitivityRow(p.name, p.kind, p.of, p.value, p.unit, one, one, virtual.state.multiplier)
