r"""The rate problem at a point of a path: which way the states of the critical pairs go.

A pair is *critical* where one of its conditions holds with equality though another state would allow the same: a pair
that slips (it may stick), that is closed without force or open without gap, or that has just reached its strength.
The rates must satisfy, at critical pairs only,

.. math:: 0 \le \dot y_n \perp \dot t_n \ge 0, \qquad
          0 \le \dot y^\pm \perp \mu\dot t_n \pm \dot t_t \ge 0, \qquad \dot y_t = \dot y^+ - \dot y^-,

everything else being linear: a linear complementarity problem, solved in :mod:`concio.solvers.path.direction`.

Pairs that their neighbours forbid to move (hard redundant pairs at a corner) have no rate of their own that could be of
the wrong sign. Were all hard pairs a little compliant they would *creep*, the more slowly the stiffer they are; a pair
that creeps against its state has another one, however stiff it is. So the forces of redundant pairs are those of a
vanishing compliance, the same that load steps take (:mod:`concio.solvers.path.near_forces`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from concio.problem.cone import Cone
from concio.problem.contact_problem import Array
from concio.solvers.path.equations import PathEquations
from concio.solvers.path.path_state import CLOSED, CRUSHED, OPEN, STICK

ZERO = 1e-9
"""Gaps and forces below this share of the largest displacement or force count as zero."""

STILL = 1e-10
"""Rates below this share of the largest rate count as zero."""

CREEPING = 1e-5
"""Creep below this share of what the most loaded pair yields (a thousandth of it: of all creep) is rounding."""

ROUNDING = 1e-13
"""Rates of forces below this share of the rates of displacements are rounding, and vice versa (scaled)."""


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
    creep : (size,) array
        What a small compliance added to hard pairs would add to it.
    creep_opening, creep_slip : (m,) arrays
        Rates of opening and plastic slip that it would bring where there are none; zero elsewhere.
    """

    direction: Array
    creep: Array
    creep_opening: Array
    creep_slip: Array
    opening: Array
    slip: Array
    force: Array
    plus: Array
    minus: Array
    still: float
    calm: float


def holds(cone: Cone, contact: Array) -> Array:
    """Return which pairs (m,) can carry friction in normal states: an open one needs strength left at its tension."""
    return np.where(contact == OPEN, cone.spare > 0, cone.rough)


def grips(equations: PathEquations) -> Array:
    """Return which pairs (m,) can carry friction in their present normal state."""
    return holds(equations.data.cone, equations.contact)


def values(equations: PathEquations, x: Array, slip: Array, offset: Array) -> Values:
    """Return the distances from the bounds at the point x (size,), with slip and offset (m,) scaled."""
    d, n, m = equations.data, equations.n, equations.m
    opening, position = equations.positions(x)
    gap = opening + offset - d.dilatancy * np.abs(position - slip)
    t_n, t_t = x[n : n + m], x[n + m : -1]
    strength = d.cone.linear_strength(t_n)
    length = max(float(np.abs(x[:n]).max(initial=0.0)), 1e-3)
    force = max(float(np.abs(x[n:-1]).max(initial=0.0)), 1e-3)
    return Values(
        gap, t_n + d.cone.tension, d.cone.cap - t_n, strength + t_t, strength - t_t, ZERO * length, ZERO * force
    )  # fmt: skip


def rates(equations: PathEquations, direction: Array, creep: Array | None = None) -> Rates:
    """Return the rates of the pairs that go with a rate of the unknowns (size,), and those of its creep."""
    d, n, m = equations.data, equations.n, equations.m
    opening, slip = equations.positions(direction, rate=True)
    t_n, t_t = direction[n : n + m], direction[n + m : -1]
    gap = opening - d.dilatancy * np.abs(slip)
    moving = float(np.abs(direction[:n]).max(initial=0.0))
    loading = float(np.abs(direction[n:-1]).max(initial=0.0))
    still = max(STILL * moving, ROUNDING * loading)
    calm = max(STILL * loading, ROUNDING * moving)
    creep = np.zeros_like(direction) if creep is None else creep
    yielding = float((equations.lent * np.maximum(np.abs(t_n), np.abs(t_t))).max(initial=0.0))
    small = max(CREEPING * yielding, 1e-3 * CREEPING * float(np.abs(creep[:n]).max(initial=0.0)))
    away, along = equations.positions(creep, rate=True)
    along = along + equations.lent * t_t  # open pairs, asked for away, carry nothing
    away = np.where((np.abs(gap) <= still) & (np.abs(away) > small), away, 0.0)
    along = np.where((np.abs(slip) <= still) & (np.abs(along) > small), along, 0.0)
    strength = d.cone.linear_strength(t_n, rate=True)
    return Rates(direction, creep, away, along, gap, slip, t_n, strength + t_t, strength - t_t, still, calm)


def wrong(equations: PathEquations, v: Values, r: Rates) -> list[tuple[float, int, int, int]]:
    """Return (size of the violation, pair, contact, sliding): states that the rates contradict, and better ones."""
    contact, sliding, grip = equations.contact, equations.sliding, grips(equations)
    rough = equations.data.cone.rough
    zero, still, calm = v.force_zero, r.still, r.calm
    found: list[tuple[float, int, int, int]] = []

    def report(mask: Array, size: Array, new_contact: int, new_sliding: Array | int) -> None:
        side = np.broadcast_to(new_sliding, mask.shape)
        found.extend((float(size[k]), int(k), new_contact, int(side[k])) for k in np.flatnonzero(mask))

    closing = (contact == OPEN) & (v.gap <= v.gap_zero) & ((r.opening < -still) | (r.creep_opening < 0))
    report(closing, -r.opening - r.creep_opening, CLOSED, np.where(rough, STICK, 1))
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
    back = (sliding != STICK) & ~done & ((sliding * r.slip < -still) | (sliding * r.creep_slip < 0))
    report(back, -sliding * (r.slip + r.creep_slip), -1, STICK)
    return [(size, k, int(contact[k]) if c < 0 else c, s) for size, k, c, s in found]


def admissible(equations: PathEquations, v: Values, contact: Array, sliding: Array) -> tuple[Array, Array]:
    """Return the states (m,) wished for wherever the present point allows them, the present states elsewhere."""
    now = equations.contact
    free, shut, full = v.force <= v.force_zero, v.gap <= v.gap_zero, v.room <= v.force_zero
    allowed = np.select([contact == OPEN, contact == CRUSHED], [free, full], shut | (now == CRUSHED))
    contact = np.where(allowed, contact, now).astype(np.int8)
    touch = np.select([sliding > 0, sliding < 0], [v.plus <= v.force_zero, v.minus <= v.force_zero], True)
    sliding = np.where(touch, sliding, equations.sliding)
    return contact, np.where(holds(equations.data.cone, contact), sliding, 1).astype(np.int8)


def restore(equations: PathEquations, contact: Array, sliding: Array) -> None:
    """Give back the states ``contact`` and ``sliding`` (m,)."""
    for k in np.flatnonzero((equations.contact != contact) | (equations.sliding != sliding)):
        equations.set_state(int(k), int(contact[k]), int(sliding[k]))


def critical(equations: PathEquations, v: Values) -> tuple[Array, Array, Array, Array]:
    """Return where (m,) pairs are at their bounds: touching without force, at the cap, at +, at - sliding strength."""
    d = equations.data
    grip = d.cone.rough
    normal = (v.gap <= v.gap_zero) & (v.force <= v.force_zero) & (equations.contact != CRUSHED)
    cap = (v.room <= v.force_zero) & (equations.contact != OPEN)
    touching = grip & (normal | (equations.contact != OPEN) | grips(equations))
    return normal, cap, touching & (v.plus <= v.force_zero), touching & (v.minus <= v.force_zero)


def vertex_size(equations: PathEquations, v: Values) -> int:
    """Return the number of complementary pairs of variables at a point."""
    return int(sum(mask.sum() for mask in critical(equations, v)))
