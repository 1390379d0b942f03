r"""What the collapse load of a path depends on: its derivative with respect to every number of a plane model.

At the collapse with Coulomb friction the structure moves on at a constant load factor lambda, with velocities v. Pairs
open, slip or stay together as v says, and the equations r(z, lambda, p) = 0 of the state have a matrix J = dr/dz that v
makes singular. With y, J^T y = 0 and y . dr/dlambda = 1,

.. math:: \frac{d\lambda}{dp} = -\, y \cdot \frac{\partial r}{\partial p} .

y is a virtual motion of rigid parts: in the joints that slip it opens by the friction coefficient, which v does not.
With the forces of the state its power is the balance that fixes lambda. No path is followed again.

In space the direction of slips turns with the numbers, and there is no such formula without the derivative of v.
Where pairs are at their strength without moving, or y strains bodies and compliant joints, the collapse depends on
more than the forces, and nothing is returned.

Source: P. Vermeer, R. de Borst, Heron 29 (1984) no. 3, on limit loads without normality.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from concio.analysis.lent_compliance import lent_assembly
from concio.analysis.linearised_state import LinearisedState
from concio.analysis.parameters import Parameter, parameters_of
from concio.analysis.sensitivity import STEP, Sensitivity, SensitivityRow, rowless
from concio.errors import ConcioError, InputError
from concio.problem.contact_problem import ContactProblem
from concio.solvers.path.path_state import CRUSHED, OPEN, weakened

if TYPE_CHECKING:
    from concio.analysis.path_result import PathResult

Array = np.ndarray

SOFT = 1e-11
"""Compliance added to closed joints of the scaled equations, where forces are shared in several ways."""
STILL, BALANCED, HELD = 1e-6, 1e-6, 1e-9
"""Velocities and forces below these shares (first, last) of the largest are none; largest relative error of y."""


@dataclass(frozen=True, eq=False)
class _Moving(LinearisedState):
    """A state at collapse: its pairs open and slip as the velocities say."""

    direction: Array

    @property
    def way(self) -> tuple[Array, Array]:
        """Directions and sizes of the slips of the collapse."""
        size = np.linalg.norm(self.direction, axis=1)
        return self.direction / np.where(size > 0, size, 1.0)[:, None], size


def collapse_sensitivity(found: PathResult) -> Sensitivity | None:
    """Return the derivatives of the load factor at which a path of a plane model collapses.

    Parameters
    ----------
    found : PathResult

    Returns
    -------
    Sensitivity or None
        None where the path did not end in a collapse at which the last stage multiplies forces, where the model is in
        space, or where the collapse depends on more than the forces at it.

    Examples
    --------
    A block slides at its friction coefficient:

    >>> import concio
    >>> from concio.analysis.collapse_sensitivity import collapse_sensitivity
    >>> block = concio.column(width=1.0, height=0.5, blocks=1, block="rigid", friction=0.3, horizontal=1.0)
    >>> path = concio.run_path(block, [concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 1.0})])
    >>> round(collapse_sensitivity(path)["friction of joint"].rate, 6)
    1.0
    """
    if not found.collapsed or not found.certified or found.assembly.model.dim == 3 or not found.direction.any():
        return None
    step, groups = found.steps[-1], _multiplied(found)
    if not groups:
        return None
    broken = step.state.broken
    problem = weakened(found.assembly.problem(step.factors), broken)
    more = {g: v + 1.0 for g, v in step.factors.items() if g in groups}
    push = found.assembly.problem({**step.factors, **more}).f - problem.f
    state = _moving(found, problem)
    y = _virtual(state, push)
    if y is None or not _alone(state, push, y):
        return None
    top = float(step.factors[groups[0]])
    numbers = parameters_of(found.assembly.model, groups)
    rows = [_row(p, state, y, step.factors, broken, top) for p in numbers]
    known = sorted((r for r in rows if r is not None), key=lambda r: -abs(r.per_percent[1]))
    return Sensitivity(top, tuple(known), rowless(numbers, rows, top)) if known and top > 0 else None


def _multiplied(found: PathResult) -> list[str]:
    """Return the load groups that the last stage multiplies, where they have one factor and move no support."""
    last, before = found.steps[-1], [s for s in found.steps if s.stage < found.steps[-1].stage]
    first = before[-1].factors if before else {}
    groups = [g for g, v in last.factors.items() if v != first.get(g, 0.0)]
    moves = {s.group for s in found.assembly.model.supports}
    alike = len({last.factors[g] for g in groups}) == 1
    return groups if alike and not moves & set(groups) else []


def _moving(found: PathResult, problem: ContactProblem) -> _Moving:
    """Return the state at collapse, its pairs as its velocities show, and open where they are open."""
    state, v, law = found.steps[-1].state, found.direction, problem.laws
    slip = (problem.C_t @ v).reshape(problem.pairs, -1)
    opening, speed = problem.C_n @ v, np.linalg.norm(slip, axis=1)
    least = STILL * float(max(np.abs(opening).max(initial=0.0), speed.max(initial=0.0)))
    opens = (state.contact == OPEN) | (opening - law.dilatancy * speed > least)
    crushed = ~opens & (state.contact == CRUSHED) & (opening < -least)
    moves = speed > least
    none = np.zeros(problem.pairs, dtype=bool)
    return _Moving(problem, state.displacement, state.normal_force, state.friction_force, ~opens, crushed,
                   ~moves & ~opens, none, np.where(moves[:, None], slip, 0.0))  # fmt: skip


def _virtual(state: _Moving, push: Array) -> Array | None:
    """Return y with J^T y = 0 and y . dr/dlambda = 1; None where there is none or several, or where it strains."""
    p, J = state.problem, state.jacobian()
    n, m = p.unknowns, p.pairs
    columns = np.repeat([state.far, state.force], [n, m * p.dim])
    rows = 1.0 / np.maximum(abs(J) @ columns, 1e-300)
    soft = sp.diags_array(np.repeat([0.0, SOFT], [n, m * p.dim]))
    scaled = sp.diags_array(rows) @ J @ sp.diags_array(columns) + soft
    border = rows * np.concatenate([-push, np.zeros(m * p.dim)])
    border, chance, motions = border / np.abs(border).max(initial=1e-300), np.random.default_rng(0), []
    for _ in range(2):  # any further equation gives the same y where there is one only
        other = np.concatenate([chance.standard_normal(n), np.zeros(m * p.dim)])
        whole = sp.block_array([[scaled, sp.csr_array(border[:, None])], [sp.csr_array(other[None]), None]])
        try:
            found = spl.splu(sp.csc_array(whole.T)).solve(np.append(np.zeros(len(rows)), 1.0))
        except RuntimeError:
            return None
        motion = (rows * found[:-1])[:n]
        motions.append(motion / (float(-push @ motion) or 1.0))
    one, two = motions
    y = _with_joints(state, one)
    error, size = np.abs(J.T @ y), abs(J).T @ np.abs(y)
    scale = np.repeat([size[:n].max(initial=0.0), size[n:].max(initial=0.0)], [n, m * p.dim])
    sound = np.isfinite(y).all() and np.abs(one - two).max() <= BALANCED * np.abs(one).max()
    return y if sound and (error <= BALANCED * scale).all() else None


def _alone(state: _Moving, push: Array, y: Array) -> bool:
    """Return whether pairs at their strength that do not move leave y as it is, if they may move."""
    law, cone = state.problem.laws, state.problem.cone
    free = state.closed & (state.t_n + law.tension <= HELD * state.force)
    free &= np.abs(state.way[1]) == 0
    pull = np.linalg.norm(state.t_t, axis=1)
    loose = state.sticks & ~free & (pull > 0) & (cone.linear_strength(state.t_n) - pull <= HELD * state.force)
    if not (free | loose).any():
        return True
    direction = np.where(loose[:, None], -state.t_t, state.direction)
    other = replace(state, closed=state.closed & ~free, sticks=state.sticks & ~free & ~loose, direction=direction)
    found, n = _virtual(other, push), state.problem.unknowns
    return found is not None and bool(np.abs(found - y)[:n].max() <= BALANCED * np.abs(y[:n]).max())


def _with_joints(state: _Moving, motion: Array) -> Array:
    """Return y of a virtual motion: in the joints what takes up the forces that the strength fixes."""
    p = state.problem
    along = np.where(state.sticks[:, None], 0.0, (p.C_t @ motion).reshape(p.pairs, -1))
    fixed = ~state.closed | state.crushed
    normal = np.where(fixed, p.C_n @ motion - p.laws.friction * (state.way[0] * along).sum(axis=1), 0.0)
    return np.concatenate([motion, normal, along.ravel()])


def _row(
    p: Parameter, state: _Moving, y: Array, factors: Mapping[str, float], broken: Array | None, top: float
) -> SensitivityRow | None:
    """Return the derivative with respect to one number; None where models beside this one have other joints."""

    def power(value: float) -> float:
        problem = weakened(lent_assembly(p.change(value)).problem(dict(factors)), broken)
        if problem.pairs != state.problem.pairs or problem.unknowns != state.problem.unknowns:
            msg = "models beside this one have other joints"
            raise InputError(msg)
        return float(y @ state.residual(problem))

    h = STEP * (abs(p.value) or 1.0)
    try:
        read = [power(p.value + k * h) for k in (-2, -1, 1, 2)]
    except (ConcioError, ValueError):
        return None
    rate = -(read[0] - 8 * read[1] + 8 * read[2] - read[3]) / (12 * h)
    return SensitivityRow(p.name, p.kind, p.of, p.value, p.unit, rate, rate, top)
