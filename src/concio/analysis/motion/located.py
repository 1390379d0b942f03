"""What happens between two points of a curve: ties that give way, bodies that meet or part, the top of the curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from concio.analysis.motion.state import MotionState
from concio.contact.attachments import Ties
from concio.contact.reference import Reference
from concio.contact.slots import KINDS

Array = np.ndarray

SHARE = 0.3
"""Share of an interval at which the next value is taken where no chord bounds it from one side."""

LEAST = 1e-3
"""Share of an interval by which values keep apart."""

LITTLE = 1e-2
"""Share of the largest contact force below which a joint carries hardly anything."""

MOST = 30
"""Values taken to find a top at most."""


def ties_give_way(before: MotionState, after: MotionState) -> bool:
    """Return whether a tie begins to yield or breaks between two states."""
    old, new = before.ties, after.ties
    return bool(((new.plastic > 0) & ~(old.plastic > 0)).any() or (new.broken & ~old.broken).any())


def bars_give_way(ties: Ties, before: MotionState, after: MotionState) -> bool:
    """Return whether a tie begins to yield or breaks between two equilibria, other than soil with all its pressure.

    Soil has an element for each block, and does not break: each reaches its cap within a step as within two, since
    its law is evaluated at the end of a step.
    """
    old, new = before.ties, after.ties
    yields = (new.plastic > 0) & ~(old.plastic > 0) & (ties.sign > 0)
    return bool(yields.any() or (new.broken & ~old.broken).any())


def touching(reference: Reference, state: MotionState) -> dict[frozenset[int], float]:
    """Return the largest force of the pairs of bodies that press or hold each other [kN]."""
    memory = state.memory
    found: dict[frozenset[int], float] = {}
    carries = np.flatnonzero(memory.force.any(axis=1))
    first, second = _bodies(reference, memory.key[carries])
    size = np.abs(memory.force[carries]).max(axis=1)
    for a, b, force in zip(first.tolist(), second.tolist(), size.tolist(), strict=True):
        pair = frozenset((a, b))
        found[pair] = max(found.get(pair, 0.0), force)
    return found


def _bodies(reference: Reference, key: Array) -> tuple[Array, Array]:
    """Return the bodies (k,) on both sides of pairs of given names (k,)."""
    if reference.disc.dim == 2:
        body = reference.edges.body
        first, second = np.divmod(key // KINDS, len(body))
        return body[first], body[second]
    first, second = reference.solids.sides_of(key)
    return first, second


def meetings(reference: Reference, before: MotionState, after: MotionState) -> set[frozenset[int]]:
    """Return the pairs of bodies that begin or cease to touch between two states, where they carry more than little.

    What is left in a joint that hardly carried anything, a head joint of a wall for one, opens without a trace.
    """
    old, new = touching(reference, before), touching(reference, after)
    most = max((*old.values(), *new.values()), default=0.0)
    return {pair for pair in old.keys() ^ new.keys() if max(old.get(pair, 0.0), new.get(pair, 0.0)) > LITTLE * most}


def highest(at: Callable[[float], float], known: Sequence[tuple[float, float]], error: float) -> float | None:
    """Return where a function is largest about the largest of its known values, as if it were concave there.

    Chords that are drawn on bound a concave function: values are taken where that bound is largest, which at a kink is
    the kink. Where the function is not concave the value found is still one of the function.

    Parameters
    ----------
    at : callable
        The function; not finite where it has no value.
    known : sequence of (float, float)
        Three places or more with their values, the largest of them inside.
    error : float
        How far the bound may lie above the largest value, over that.

    Returns
    -------
    float or None
        None where nothing larger was found.
    """
    points = sorted(known)
    first = max(points, key=lambda p: p[1])
    for _ in range(MOST):
        k = max(range(len(points)), key=lambda i: points[i][1])
        if not 0 < k < len(points) - 1:
            break
        bound, trial = max(_bound(points, k - 1), _bound(points, k))
        if bound - points[k][1] <= error * abs(points[k][1]):
            break
        value = at(trial)
        if not np.isfinite(value) or any(trial == x for x, _ in points):
            break
        points = sorted([*points, (trial, value)])
    best = max(points, key=lambda p: p[1])
    return best[0] if best[1] > first[1] else None


def _bound(points: Sequence[tuple[float, float]], i: int) -> tuple[float, float]:
    """Return the bound between two neighbouring places, and where to look next."""
    (a, f_a), (b, f_b) = points[i], points[i + 1]
    slopes = []
    for j in (i - 1, i + 1):
        if 0 <= j < len(points) - 1:
            (p, f_p), (q, f_q) = points[j], points[j + 1]
            slopes.append((f_q - f_p) / (q - p))
        else:
            slopes.append(np.inf if j < i else -np.inf)
    rise, fall = slopes
    if np.isinf(rise) and np.isinf(fall):
        return np.inf, 0.5 * (a + b)
    if np.isinf(rise):
        return f_b - fall * (b - a), a + SHARE * (b - a)
    if np.isinf(fall):
        return f_a + rise * (b - a), b - SHARE * (b - a)
    if rise <= fall:  # not concave
        return max(f_a, f_b), 0.5 * (a + b)
    x = (f_b - f_a + rise * a - fall * b) / (rise - fall)
    near = LEAST * (b - a)
    inside = min(max(x, a + near), b - near)
    return f_a + rise * (x - a), inside
