r"""The rate problem at a point of a path: which way the states of the critical pairs go.

A pair is *critical* where one of its conditions holds with equality though another state would allow the same: a pair
that slips (it may stick), that is closed without force or open without gap, or that has just reached its strength.
The rates must satisfy, at critical pairs only,

.. math:: 0 \le \dot y_n \perp \dot t_n \ge 0, \qquad
          0 \le \dot y^\pm \perp \mu\dot t_n \pm \dot t_t \ge 0, \qquad \dot y_t = \dot y^+ - \dot y^-,

everything else being linear: a linear complementarity problem. It is solved by flipping the pairs whose rates are
wrong, starting from the states the path came with (most events: one flip, one back-substitution); where that goes
round in circles, by Lemke's method on the critical pairs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.contact.problem import Array
from concio.lcp.path_equations import PathEquations
from concio.lcp.path_state import CLOSED, CRUSHED, OPEN, STICK
from concio.lcp.rate_lcp import lemke

ZERO = 1e-9
"""Gaps and forces below this share of the largest displacement or force count as zero."""

STILL = 1e-10
"""Rates below this share of the largest rate count as zero."""

ROUNDING = 1e-13
"""Rates of forces below this share of the rates of displacements are rounding, and the other way round (scaled)."""

ROUNDS_ALL, ROUNDS_ONE = 6, 60
"""Rounds in which all wrong pairs are flipped together, then rounds that flip the worst alone."""

TRUE = 1e-7
"""Residual up to which the equations of a set of states count as solvable."""

LARGEST_VERTEX = 400
"""Largest dense complementarity problem tried at a vertex."""


@dataclass
class Values:
    """Distances of every pair from its bounds at a point, all (m,) and scaled.

    Parameters
    ----------
    gap, force, room : arrays
        y_n, t_n + T, N - t_n.
    plus, minus : arrays
        c + mu t_n + t_t and c + mu t_n - t_t.
    gap_zero, force_zero : float
        Sizes that count as zero.
    """

    gap: Array
    force: Array
    room: Array
    plus: Array
    minus: Array
    gap_zero: float
    force_zero: float


@dataclass
class Rates:
    """Rates of the same quantities; ``slip`` is the rate of the plastic slip.

    Motions slower than ``still`` and forces that change less than ``calm`` do not change at all.

    Parameters
    ----------
    direction : (size,) array
        Rate of all unknowns.
    """

    direction: Array
    opening: Array
    slip: Array
    force: Array
    plus: Array
    minus: Array
    still: float
    calm: float


def grips(equations: PathEquations) -> Array:
    """Return which pairs (m,) can carry friction in their present normal state."""
    d = equations.data
    spare = d["c"] - d["mu"] * d["T"] > 1e-12 * (1.0 + d["c"])
    rough = (d["mu"] > 0) | (d["c"] > 0)
    return np.where(equations.contact == OPEN, spare, rough)


def values(equations: PathEquations, x: Array, slip: Array, offset: Array) -> Values:
    """Return the distances from the bounds at the point x (size,), with slip and offset (m,) scaled."""
    d, n, m = equations.data, equations.n, equations.m
    opening, position = equations.positions(x)
    gap = opening + offset - d["psi"] * np.abs(position - slip)
    t_n, t_t = x[n : n + m], x[n + m : -1]
    strength = d["c"] + d["mu"] * t_n
    length = max(float(np.abs(x[:n]).max(initial=0.0)), 1e-3)
    force = max(float(np.abs(x[n:-1]).max(initial=0.0)), 1e-3)
    return Values(
        gap, t_n + d["T"], d["N"] - t_n, strength + t_t, strength - t_t, ZERO * length, ZERO * force
    )  # fmt: skip


def rates(equations: PathEquations, direction: Array) -> Rates:
    """Return the rates of the pairs that go with a rate of the unknowns (size,)."""
    d, n, m = equations.data, equations.n, equations.m
    opening, slip = equations.positions(direction, rate=True)
    t_n, t_t = direction[n : n + m], direction[n + m : -1]
    gap = opening - d["psi"] * np.abs(slip)
    moving = float(np.abs(direction[:n]).max(initial=0.0))
    loading = float(np.abs(direction[n:-1]).max(initial=0.0))
    still = max(STILL * moving, ROUNDING * loading)
    calm = max(STILL * loading, ROUNDING * moving)
    return Rates(direction, gap, slip, t_n, d["mu"] * t_n + t_t, d["mu"] * t_n - t_t, still, calm)


def wrong(equations: PathEquations, v: Values, r: Rates) -> list[tuple[float, int, int, int]]:
    """Return (size of the violation, pair, contact, sliding): states that the rates contradict, and better ones."""
    contact, sliding, grip = equations.contact, equations.sliding, grips(equations)
    rough = (equations.data["mu"] > 0) | (equations.data["c"] > 0)
    zero, still, calm = v.force_zero, r.still, r.calm
    found: list[tuple[float, int, int, int]] = []

    def report(mask: Array, size: Array, new_contact: int, new_sliding: Array | int) -> None:
        side = np.broadcast_to(new_sliding, mask.shape)
        found.extend((float(size[k]), int(k), new_contact, int(side[k])) for k in np.flatnonzero(mask))

    closing = (contact == OPEN) & (v.gap <= v.gap_zero) & (r.opening < -still)
    report(closing, -r.opening, CLOSED, np.where(rough, STICK, 1))
    opening = (contact == CLOSED) & (v.force <= zero) & (r.force < -calm)
    report(opening, -r.force, OPEN, np.where(grip & (v.plus + v.minus > 4 * zero), sliding, 1))
    crushing = (contact == CLOSED) & (v.room <= zero) & (r.force > calm)
    report(crushing, r.force, CRUSHED, sliding)
    recovering = (contact == CRUSHED) & (r.opening > still)
    report(recovering, r.opening, CLOSED, sliding)
    done = closing | opening | crushing | recovering | ~grip
    stuck = (sliding == STICK) & ~done
    plus = stuck & (v.plus <= zero) & (r.plus < -calm)
    minus = stuck & (v.minus <= zero) & (r.minus < -calm)
    side = np.where(plus & ~(minus & (r.minus < r.plus)), 1, -1)
    report(plus | minus, np.maximum(-r.plus * plus, -r.minus * minus), -1, side)
    back = (sliding != STICK) & ~done & (sliding * r.slip < -still)
    report(back, -sliding * r.slip, -1, STICK)
    return [(size, k, int(contact[k]) if c < 0 else c, s) for size, k, c, s in found]


def find_direction(
    equations: PathEquations, v: Values, first: Array | None = None, sense: float = 1.0, *, vertex: bool = True
) -> tuple[Rates | None, Array | None]:
    """Return consistent rates for a control that changes at the rate ``sense`` (+1 or -1).

    The states of ``equations`` are set accordingly; where nothing is found they are left as they were.

    Parameters
    ----------
    equations : PathEquations
    v : Values
        Distances from the bounds at the point.
    first : (size,) array, optional
        Direction of the present states, where it is known already.
    sense : float
    vertex : bool
        Whether Lemke's method is tried where flipping does not settle.

    Returns
    -------
    Rates or None
        None where no direction was found: under load control a limit point.
    array (size,) or None
        Where none was found: the rate that ran away, if one did (the mechanism).
    """
    unit = np.zeros(equations.size)
    unit[-1] = sense
    start = (equations.contact.copy(), equations.sliding.copy())
    seen: set[bytes] = set()
    together = ROUNDS_ALL
    runaway: Array | None = None
    for round_ in range(ROUNDS_ALL + ROUNDS_ONE):
        if round_ or first is None:
            direction, residual = equations.solve(unit)
        else:
            direction, residual = first, 0.0
        if residual > TRUE or not np.isfinite(direction).all():
            runaway = direction if np.isfinite(direction).all() else None
            break
        r = rates(equations, direction)
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
            equations.set_state(k, contact, sliding)
    restore(equations, *start)
    found = by_lemke(equations, v, sense) if vertex else None
    if found is None:
        restore(equations, *start)
    return found, runaway


def admissible(equations: PathEquations, v: Values, contact: Array, sliding: Array) -> tuple[Array, Array]:
    """Return the states (m,) wished for wherever the present point allows them, the present states elsewhere."""
    d, now = equations.data, equations.contact
    free, shut, full = v.force <= v.force_zero, v.gap <= v.gap_zero, v.room <= v.force_zero
    allowed = np.select([contact == OPEN, contact == CRUSHED], [free, full], shut | (now == CRUSHED))
    contact = np.where(allowed, contact, now).astype(np.int8)
    touch = np.select([sliding > 0, sliding < 0], [v.plus <= v.force_zero, v.minus <= v.force_zero], True)
    sliding = np.where(touch, sliding, equations.sliding)
    spare = d["c"] - d["mu"] * d["T"] > 1e-12 * (1.0 + d["c"])
    grip = np.where(contact == OPEN, spare, (d["mu"] > 0) | (d["c"] > 0))
    return contact, np.where(grip, sliding, 1).astype(np.int8)


def restore(equations: PathEquations, contact: Array, sliding: Array) -> None:
    """Give back the states ``contact`` and ``sliding`` (m,)."""
    for k in np.flatnonzero((equations.contact != contact) | (equations.sliding != sliding)):
        equations.set_state(int(k), int(contact[k]), int(sliding[k]))


def critical(equations: PathEquations, v: Values) -> tuple[Array, Array, Array, Array]:
    """Return where (m,) pairs are at their bounds: touching without force, at the cap, at +, at - sliding strength."""
    d = equations.data
    grip = (d["mu"] > 0) | (d["c"] > 0)
    normal = (v.gap <= v.gap_zero) & (v.force <= v.force_zero) & (equations.contact != CRUSHED)
    cap = (v.room <= v.force_zero) & (equations.contact != OPEN)
    touching = grip & (normal | (equations.contact != OPEN) | grips(equations))
    return normal, cap, touching & (v.plus <= v.force_zero), touching & (v.minus <= v.force_zero)


def vertex_size(equations: PathEquations, v: Values) -> int:
    """Return the number of complementary pairs of variables at a point."""
    return int(sum(mask.sum() for mask in critical(equations, v)))


def by_lemke(equations: PathEquations, v: Values, sense: float) -> Rates | None:
    """Solve the complementarity problem of the critical pairs and set their states; None where it has no solution."""
    d, n, m = equations.data, equations.n, equations.m
    normal, cap, plus, minus = critical(equations, v)
    sets = [np.flatnonzero(mask) for mask in (normal, cap, plus, minus)]
    size = sum(s.size for s in sets)
    if size > LARGEST_VERTEX:
        return None
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
        B[n + sets[i], pick[i]] += d["psi"][sets[i]] * closed[sets[i]]
    X, residual = equations.solve(np.column_stack([unit, B]))
    if residual > TRUE or not np.isfinite(X).all():
        return None
    t_n, t_t = X[n : n + m], X[n + m : -1]
    mu = d["mu"][:, None]
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
        spare = d["c"] - d["mu"] * d["T"] > 1e-12 * (1.0 + d["c"])
        sliding = np.where((contact == OPEN) & ~spare, 1, sliding)
        restore(equations, contact, sliding)
        direction, residual = equations.solve(unit)
        r = rates(equations, direction)
        if residual <= TRUE and not wrong(equations, v, r):
            return r
        restore(equations, *base)
    return None
