r"""The way on at a point of a path: rates that contradict no state of a critical pair.

The linear complementarity problem of :mod:`concio.solvers.path.rates` is solved by flipping the pairs whose rates are
wrong, starting from the states the path came with (most events: one flip, one back-substitution); where that goes
round in circles, by Lemke's method on the pairs that took part, and at last on all critical pairs.

Hard redundant pairs (the three at a corner) may forbid the motion of a support though the structure could follow it:
no finite rate is consistent. Were they a little compliant, forces in equilibrium with themselves would grow, however
small the motion, until a pair slips or opens. So the *self-stress* that runs away is the direction in which the path
goes on: it changes forces at constant displacements and loads.
"""

from __future__ import annotations

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.limits_of_work import LARGEST_VERTEX
from concio.solvers.path.equations import PathEquations
from concio.solvers.path.path_state import CLOSED, CRUSHED, OPEN, STICK
from concio.solvers.path.rate_lcp import lemke
from concio.solvers.path.rates import Rates, Values, critical, holds, rates, restore, wrong

ROUNDS_ALL, ROUNDS_ONE = 6, 60
"""Rounds in which all wrong pairs are flipped together, then rounds that flip the worst alone."""

TRUE = 1e-7
"""Residual up to which the equations of a set of states count as solvable."""

SELF_STRESS = 1e-5
"""A rate that runs away with displacements below this share of its forces (scaled) is a self-stress."""


def find_direction(
    equations: PathEquations, v: Values, first: Rates | None = None, sense: float = 1.0, *, vertex: bool = True
) -> tuple[Rates | None, Array | None]:
    """Return consistent rates for a control that changes at the rate ``sense`` (+1 or -1).

    The states of ``equations`` are set accordingly; where nothing is found they are left as they were.

    Parameters
    ----------
    equations : PathEquations
    v : Values
        Distances from the bounds at the point.
    first : Rates, optional
        Direction of the present states, where it is known already.
    sense : float
    vertex : bool
        Whether Lemke's method is tried where flipping does not settle.

    Returns
    -------
    Rates or None
        None where no direction was found: under load control a limit point.
    array (size,) or None
        Where none was found: the rate that diverged, if one did (the mechanism).
    """
    unit = np.zeros(equations.size)
    unit[-1] = sense
    start = (equations.contact.copy(), equations.sliding.copy())
    seen: set[bytes] = set()
    together = ROUNDS_ALL
    met = np.zeros(equations.m, dtype=bool)
    runaway: Array | None = None
    for round_ in range(ROUNDS_ALL + ROUNDS_ONE):
        if round_ or first is None:
            direction, residual = equations.refined(unit)
            creep = equations.creep
        else:
            direction, creep, residual = first.direction, first.creep, 0.0
        if not np.isfinite(direction).all():
            break
        if residual > TRUE:
            stress = self_stress(equations, direction)
            if stress is None:
                runaway = equations.null_motion(direction)
                break
            direction, creep = stress, np.zeros_like(stress)
        r = rates(equations, direction, creep)
        bad = wrong(equations, v, r)
        if not bad:
            return r, None
        key = equations.contact.tobytes() + equations.sliding.tobytes()
        if key in seen:
            if round_ > together:
                break
            together = round_
        seen.add(key)
        if round_ >= together:
            bad = [max(bad)]
        for _, k, contact, sliding in bad:
            met[k] = True
            equations.set_state(k, contact, sliding)
    restore(equations, *start)
    found = by_pivots(equations, v, sense, met) if vertex else None
    if found is None:
        restore(equations, *start)
    return found, runaway


def self_stress(equations: PathEquations, runaway: Array) -> Array | None:
    """Return the self-stress (size,) in a rate that diverged, largest force 1; None where it is not a self-stress."""
    n = equations.n
    top = float(np.abs(runaway[n:-1]).max(initial=0.0))
    if not top > 0 or float(np.abs(runaway[:n]).max(initial=0.0)) > SELF_STRESS * top:
        return None
    x = runaway / top
    x[:n], x[-1] = 0.0, 0.0
    change, residual = equations.refined(equations.multiply(x))  # puts it on the equations, by the least change
    x = x - change
    if residual > TRUE or float(np.abs(change).max()) > SELF_STRESS * 1e2:
        return None
    x[:n], x[-1] = 0.0, 0.0
    left = float(np.abs(equations.multiply(x)).max())
    return x / float(np.abs(x).max()) if left <= TRUE else None


def by_pivots(equations: PathEquations, v: Values, sense: float, met: Array) -> Rates | None:
    """Try Lemke's method on all critical pairs; failing that, perhaps on the pairs (m,) that flipping met.

    All critical pairs sticking at once may contradict the motion of a support that some of them can follow. Then only
    those take part that flipping met, and those found wrong afterwards.
    """
    start = (equations.contact.copy(), equations.sliding.copy())
    found, others, blocked = by_lemke(equations, v, sense, np.ones(equations.m, dtype=bool))
    chosen = met.copy()
    for _ in range(ROUNDS_ALL):
        if found is not None or not blocked or not chosen.any():
            break
        restore(equations, *start)
        found, others, _ = by_lemke(equations, v, sense, chosen, lent=True)
        if not (others & ~chosen).any():
            break
        chosen |= others
    return found


def by_lemke(
    equations: PathEquations, v: Values, sense: float, chosen: Array, *, lent: bool = False
) -> tuple[Rates | None, Array, bool]:
    """Solve the complementarity problem of the critical pairs among those chosen (m,), and set their states.

    ``lent`` tells whether responses without a finite value are replaced by those of slightly compliant pairs.

    Returns
    -------
    Rates or None
        None where it has no solution, or one that contradicts the states of other pairs.
    array (m,)
        The pairs whose states it contradicts.
    bool
        Whether all of them sticking contradicts the motion of a support: a self-stress runs away.
    """
    blocked = False
    others = np.zeros(equations.m, dtype=bool)
    d, n, m = equations.data, equations.n, equations.m
    normal, cap, plus, minus = (mask & chosen for mask in critical(equations, v))
    sets = [np.flatnonzero(mask) for mask in (normal, cap, plus, minus)]
    size = sum(s.size for s in sets)
    if size > LARGEST_VERTEX:
        return None, others, blocked
    for k in np.flatnonzero(normal | cap | plus | minus):
        stuck = STICK if plus[k] or minus[k] else int(equations.sliding[k])
        equations.set_state(int(k), CLOSED if normal[k] or cap[k] else int(equations.contact[k]), stuck)
    equations.factorise()
    base = (equations.contact.copy(), equations.sliding.copy())
    unit = np.zeros(equations.size)
    unit[-1] = sense
    B = np.zeros((equations.size, size))
    at = np.cumsum([0, *(s.size for s in sets)])
    pick = [np.arange(at[i], at[i + 1]) for i in range(4)]
    closed = equations.contact == CLOSED
    B[n + sets[0], pick[0]] = 1.0
    B[n + sets[1], pick[1]] = -1.0
    for i, sign in ((2, 1.0), (3, -1.0)):
        B[n + m + sets[i], pick[i]] = sign
        B[n + sets[i], pick[i]] += d.dilatancy[sets[i]] * closed[sets[i]]
    X, residual = equations.refined(unit[:, None])  # often this has no solution, and the others cost a hundred times it
    if residual <= TRUE:
        X, residual = equations.refined(np.column_stack([unit, B]))
    if residual > TRUE:
        blocked = self_stress(equations, X[:, 0]) is not None
        if not (blocked or lent):
            return None, others, blocked
        # the states of pairs with the compliance added to the factors are tried
        X = equations.approximate(np.column_stack([unit, B]))
    if not np.isfinite(X).all():
        return None, others, blocked
    t_n, t_t = X[n : n + m], X[n + m : -1]
    mu = d.cone.friction[:, None]
    W = np.vstack(
        [t_n[sets[0]], -t_n[sets[1]], (mu * t_n + t_t)[sets[2]], (mu * t_n - t_t)[sets[3]]]
    )  # fmt: skip
    scale = float(np.abs(W[:, 0]).max(initial=0.0)) or 1.0
    A = W[:, 1:]
    rows = 1.0 / np.sqrt(np.maximum(np.abs(np.diag(A)), 1e-9 * np.abs(A).max(initial=1.0)))
    A = rows[:, None] * A * rows
    for cover in (None, 1.0 + np.arange(size) / max(size, 1), 1.0 + np.arange(size)[::-1] ** 2 / max(size, 1)):
        z = lemke(A, rows * W[:, 0] / scale, cover=cover)
        if z is None:
            continue
        z = z * rows
        contact, sliding = equations.contact.copy(), equations.sliding.copy()
        moved = z > 1e-11 * max(1.0, float(z.max(initial=0.0)))
        contact[sets[0][moved[pick[0]]]] = OPEN
        contact[sets[1][moved[pick[1]]]] = CRUSHED
        sliding[sets[2][moved[pick[2]]]] = 1
        sliding[sets[3][moved[pick[3]]]] = -1
        sliding = np.where((contact == OPEN) & ~holds(d.cone, contact), 1, sliding)
        restore(equations, contact, sliding)
        found = consistent(equations, unit)
        if found is not None:
            bad = wrong(equations, v, found)
            if not bad:
                return found, others, blocked
            others[[k for _, k, _, _ in bad]] = True
        restore(equations, *base)
    return None, others, blocked


def consistent(equations: PathEquations, unit: Array) -> Rates | None:
    """Return the rates of the present states, or their self-stress; None where they admit neither."""
    direction, residual = equations.refined(unit)
    creep = equations.creep
    if residual > TRUE:
        stress = self_stress(equations, direction)
        return None if stress is None else rates(equations, stress)
    return rates(equations, direction, creep) if np.isfinite(direction).all() else None
