r"""Where a path starts: states of the pairs, and a cover that makes them right at z0 = 1.

From states alone (:func:`cover_states`), these are solved for as they stand (one sparse factorisation). Every slack
that comes out negative is then covered: a closed pair by a prestress, an open one by a gap, a slipping one by a slip
that earlier steps would have left. The covers are chosen so that u and the contact forces do not change along the first
piece: only the slacks do.

From a point near the answer (:func:`cover_point`), displacements and forces stay what they are, brought to exact
complementarity; the loads, gaps and slips that are missing for it are the cover. On the way every joint keeps its own
law: it is the same structure under other loads, with other gaps, and where the point is an earlier state of the
structure, the path is its way from there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from concio.problem.contact_problem import Array
from concio.problem.pair_state import Normal, PairStates
from concio.solvers.pivoting.pair_rows import Cover, PairSystem
from concio.solvers.pivoting.state_solution import state_solution

USED = 1e-10
"""Distance from the sliding strength, relative to the largest normal force, at which friction counts as used up."""

NEAR = 1e-7
"""Least slack of a pair at the start from a point, relative to the largest force or displacement."""

BASE = 0.01
"""Least cover of a pair, in units of the typical pair force."""


def cold_states(system: PairSystem) -> tuple[Array, Array]:
    """Return the glued states: all closed, all sticking but those without friction."""
    normal = np.full(system.m, Normal.CLOSED)
    return normal, np.where(system.frictionless, 1, 0)


def open_states(system: PairSystem) -> tuple[Array, Array]:
    """Return the states of blocks apart, each held by the ground (see ``ground`` of :class:`PairSystem`)."""
    free = np.arange(system.m) < system.m - system.ground
    return np.full(system.m, Normal.OPEN), np.where(free, 1, 0)


def named_states(
    system: PairSystem, states: PairStates, start: tuple[Array, Array, Array] | None
) -> tuple[Array, Array]:
    """Return normal codes (m,) and signs of slip (m,) of given states and an answer near.

    Pairs that cannot carry friction slip; open ones without strength slide to the side the answer shows.
    """
    problem, law = system.problem, system.problem.laws
    normal, sign, stuck = states.normal, states.sign * ~states.open, ~states.open & (states.sign == 0)
    slip = np.zeros(system.m)
    if start is not None:
        u, t_n, t_t = start
        t_t = np.ravel(t_t)
        slip = problem.C_t @ u - problem.slip_origin[:, 0] + law.tangential_compliance * t_t
        capped = np.isfinite(law.cap) & (t_n >= (1.0 - 1e-9) * law.cap)
        normal = np.where(capped, Normal.CRUSHED, normal)
        # friction used up without slip: the force says which way the pair would slide
        used = np.abs(t_t) >= problem.cone.strength(t_n) - USED * np.abs(t_n).max(initial=0.0)
        sign = np.where(stuck & used, np.where(t_t <= 0, 1, -1), sign)
        stuck &= ~used
    stuck = (stuck & ~system.frictionless) | (states.open & ~system.weak & (start is None))
    side = np.where(sign != 0, sign, np.where(slip < 0, -1, 1))
    return normal, np.where(stuck, 0, side)


def cover_point(
    system: PairSystem, normal: Array, sign: Array, u: Array, p: Array, r: Array
) -> tuple[Array, Array]:
    """Set the cover of ``system`` that makes a point the answer; return the states, open pairs turned as they slid.

    Parameters
    ----------
    system : PairSystem
    normal, sign : (m,) integer arrays
    u, p, r : (N,), (m,), (m,) arrays
        The point, in the units of ``system``; p is shifted by the tensile strength. The weak springs of ``system``
        are anchored there.
    """
    system.cover = Cover.none(system.m, system.n)
    closed, stick = normal == Normal.CLOSED, sign == 0
    size = 1.0 + float(np.abs(np.concatenate([p, r])).max(initial=0.0))
    far = 1.0 + float(np.abs(u).max(initial=0.0))
    least = NEAR * np.random.default_rng(0).uniform(0.5, 1.5, system.m)
    p = np.where(closed, np.clip(p, least * size, np.maximum(system.cone.cap - least * size, 0.0)), 0.0)
    p = np.where(normal == Normal.CRUSHED, system.cone.cap, p)
    strength = system.cone.linear_strength(p)
    y = (system.C @ u).reshape(-1, 2) + system.x
    free = (normal == Normal.OPEN) & system.weak & ~system.frictionless
    sign = np.where(free & ~stick, np.where(y[:, 1] < 0, -1, 1), sign)
    r = np.where(stick, np.clip(r, -(1.0 - least) * strength, (1.0 - least) * strength), -sign * strength)
    soft = system.a + system.delta
    y += soft * np.column_stack([p, r])
    slid = np.where(stick, 0.0, sign * np.maximum(sign * y[:, 1], least * far))
    slid = np.where(system.frictionless, y[:, 1], slid)
    dilated = sign * system.dilatancy * slid
    opened = np.where(normal == Normal.OPEN, np.maximum(y[:, 0] - dilated, least * far), 0.0)
    opened = np.where(normal == Normal.CRUSHED, np.minimum(y[:, 0] - dilated, -least * far), opened)
    t = np.column_stack([p, r])
    system.anchored = system.proximal * u
    loads = system.load + system.anchored - system.K @ u + system.C.T @ t.ravel()
    system.cover = replace(system.cover, g=opened + dilated - y[:, 0], h=slid - y[:, 1], load=loads)
    return normal, sign


def cover_states(
    system: PairSystem,
    normal: Array,
    sign: Array,
    *,
    base: float = BASE,
    seed: int = 0,
    swelling: float = 0.0,
    glue: float = 0.0,
) -> tuple[Array, Array]:
    """Set the cover of ``system`` for these states, and return them (open pairs turned to the side they slide to).

    Parameters
    ----------
    system : PairSystem
    normal, sign : (m,) integer arrays
    base : float
        Least cover of a pair, in units of the typical force and length.
    seed : int
        Of the random factor of each pair.
    swelling : float
        Approach forced on closed pairs at z0 = 1, in units of the problem's own length.
    glue : float
        Cohesion given to pairs with friction at z0 = 1, in multiples of the base.

    Raises
    ------
    SingularMatrixError
        The states leave a body loose.
    """
    m = system.m
    system.cover = Cover.none(m, system.n)
    v = state_solution(system, normal, sign, swelling=swelling)
    y_t = system.slacks(v, sign)["y_t"]
    loose = (normal == Normal.OPEN) & system.weak & ~system.frictionless & (sign != 0)
    sign = np.where(loose, np.where(y_t < 0, -1, 1), sign)
    value = system.slacks(v, sign)
    least = base * np.random.default_rng(seed).uniform(0.5, 1.5, m)
    closed, open_ = normal == Normal.CLOSED, normal == Normal.OPEN
    stick = sign == 0
    weak = (system.cone.cohesion == 0.0) & (glue == 0.0)
    slides = ~stick & ~system.frictionless & ~(open_ & weak & (system.dilatancy == 0.0))
    t = v[system.n : -1].reshape(-1, 2)
    p, r, mu = t[:, 0], t[:, 1], system.cone.friction
    rough = closed & stick & (mu > 0)
    # prestress P: |r| <= c' + mu (p + P), with room to spare
    lean = np.where(mu > 0, (np.abs(r) - system.cone.cohesion) / np.where(mu > 0, mu, 1.0) - p, 0.0)
    need = np.where(rough, np.maximum(lean, -p), -p)
    P = np.where(closed, least + np.maximum(need, 0.0), 0.0)
    bound = stick & ~rough & ~system.frictionless  # strength that does not grow with p, or open and sticking
    c = np.where(bound, least + np.maximum(np.abs(r) - system.cone.cohesion - mu * p, 0.0), 0.0)
    c += np.where(mu > 0, glue * least, 0.0)
    Q = np.where(~stick & ~system.frictionless, -sign * (mu * P + c), 0.0)  # slipping: u and the forces do not change
    h = np.where(slides, sign * (least + np.maximum(-sign * y_t, 0.0)), 0.0)
    over = np.where(system.cone.capped, p - np.where(system.cone.capped, system.cone.cap, 0.0), -np.inf)
    X = np.where(closed & system.cone.capped, P + least + np.maximum(over, 0.0), 0.0)
    slope = sign * system.dilatancy * h
    g = np.where(open_, slope + least + np.maximum(-value["y_n"], 0.0), slope)
    g = np.where(normal == Normal.CRUSHED, slope - least - np.maximum(value["y_n"], 0.0), g)
    g = np.where(closed, g - swelling, g)
    system.cover = replace(system.cover, P=P, Q=Q, g=g, h=h, c=c, X=X)
    return normal, sign
