"""Capacity curves: the multiplier against the displacement of the control point, followed, and as a straight line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from concio.analysis.seismic.linkage import Linkage, Point
from concio.analysis.seismic.tie_history import yields_at

Array = np.ndarray

STEPS = 100
"""Points of a followed curve, about."""

FARTHEST = 2.0
"""The control point is followed to this multiple of the size of the mechanism at most."""

REASONS = {
    "falls": "the multiplier vanishes",
    "far": f"the control point has moved by {FARTHEST:g} times the size of the mechanism",
    "joints end": "its joints reach the end of their travel; equilibria beyond are ignored",
    "joint opens": "a joint opens or a tie goes slack or yields; equilibria beyond are ignored",
    "several motions": "its joints allow more than one motion, or none",
    "no forces": "its joints carry no forces in equilibrium",
    "not asked": "no limit state asks for it",
    "no state": "no collapse state is found from which to continue; equilibria beyond are ignored",
    "jams": "its blocks jam and the multiplier rises far above alpha_0; equilibria beyond are ignored",
    "long": "too many changes of its joints to follow; equilibria beyond are ignored",
}
"""Why a curve ends where it ends."""

ROOT = 1e-13
"""Multipliers below this share of the first are zero."""


@dataclass(frozen=True, eq=False)
class CapacityCurve:
    """alpha(d_C) of one mechanism.

    Parameters
    ----------
    kind : {"followed", "steps", "straight"}
        "steps": by limit analysis of the displaced macro-blocks, step by step.
    displacement : (n,) array
        Of the control point [m], growing; by steps no more than that of the masses, seen as one of the control point.
    multiplier : (n,) array
        alpha.
    end : float
        d_C0, where alpha vanishes or the motion ends [m]; ``nan`` where neither happens.
    reason : str
        Why it ends where it ends, a key of ``REASONS``.
    broken : tuple of float
        Displacements at which ties break [m].
    tie_force : (n, ties) array
        [kN]; none for a straight line.
    points : tuple of Point
        The configurations; none for a straight line.
    reduced : float
        Factor by which multipliers were reduced so that the curve begins at alpha_0 and never rises above it.
    control : (2, k) array or None
        How far the control point itself has moved and the displacement that counts there [m]; None where they are one.
    """

    kind: Literal["followed", "steps", "straight"]
    displacement: Array
    multiplier: Array
    end: float
    reason: str = "falls"
    broken: tuple[float, ...] = ()
    tie_force: Array | None = None
    points: tuple[Point, ...] = ()
    reduced: float = 1.0
    control: Array | None = None

    def within(self, given: float) -> float:
        """Return the displacement of the curve at which the control point has moved by ``given`` [m]."""
        if self.control is None or not given < float(self.control[0, -1]):
            return given
        return float(np.interp(given, *self.control))

    @property
    def ends(self) -> bool:
        """Whether alpha vanishes, or the motion ends, somewhere."""
        return bool(np.isfinite(self.end))

    def at(self, displacement: float) -> float:
        """Return alpha at a displacement of the control point; where a tie breaks, after it."""
        d = self.displacement
        i = int(np.searchsorted(d, displacement, side="right"))
        if i in (0, len(d)):
            return float(self.multiplier[min(i, len(d) - 1)])
        share = (displacement - d[i - 1]) / (d[i] - d[i - 1])
        return float((1 - share) * self.multiplier[i - 1] + share * self.multiplier[i])

    def first_below_half_after_a_break(self) -> float:
        """Return where ties have broken and alpha is below half its largest [m]; ``inf`` where that never happens."""
        if not self.broken:
            return float("inf")
        d, alpha, half = self.displacement, self.multiplier, 0.5 * float(self.multiplier.max())
        late = np.flatnonzero((d >= self.broken[0]) & (alpha < half))
        if not late.size:
            return float("inf")
        k = int(late[0])
        # before the point after a break stands one at the same displacement with the tie still whole
        if k == 0 or d[k - 1] < self.broken[0] or alpha[k - 1] <= half:
            return float(d[k])
        share = (alpha[k - 1] - half) / (alpha[k - 1] - alpha[k])
        return float(d[k - 1] + share * (d[k] - d[k - 1]))


def straight(multiplier: float, end: float) -> CapacityCurve:
    """Return the line from alpha_0 at rest to zero at d_C0."""
    return CapacityCurve("straight", np.array([0.0, end]), np.array([multiplier, 0.0]), end)


def not_followed(reason: str) -> CapacityCurve:
    """Return the curve of a mechanism that cannot be followed, for one of ``REASONS``."""
    return CapacityCurve("followed", np.zeros(1), np.zeros(1), float("nan"), reason)


def follow(linkage: Linkage, start: Array | None = None, d0: float = 0.0) -> CapacityCurve:
    """Follow a mechanism with one degree of freedom until its multiplier vanishes.

    Parameters
    ----------
    linkage : Linkage
    start : (G, 3) array, optional
        Configuration in which the curve begins; that at rest by default.
    d0 : float
        Displacement of the control point there [m].

    Returns
    -------
    CapacityCurve
        Of points as equilibrium gives them; where it ends early, its reason says why.
    """
    begins = np.zeros((len(linkage.mechanics.blocks), 3)) if start is None else start
    n = linkage.freedom if start is None else linkage.freedom_at(start)
    first = linkage.balance(begins) if n == 1 else None
    if first is None:
        return not_followed("several motions" if n != 1 else "no forces")
    points, d = [first], [d0]
    step = _first_step(linkage, first, d0)
    reason = "far"
    end, broken = float("nan"), []
    while d[-1] - d0 < FARTHEST * linkage.size:
        q = _ahead(linkage, points[-1], step)
        moved = linkage.moved(q, d[-1] + step)
        now = None if moved is None else linkage.balance(moved)
        if now is None:
            if step > 1e-4 * linkage.size:
                step /= 4
                continue
            end, reason = d[-1], "joints end"
            break
        if not now.pressed:
            end, before, _ = _bracket(linkage, points[-1], d[-1], d[-1] + step, lambda p: not p.pressed)
            points.append(before)
            d.append(end)
            reason = "joint opens"
            break
        if _shortens(linkage, points[-1], now):
            end, reason = d[-1], "joint opens"
            break
        if _changes(linkage, points[-1], now):
            changes = partial(_changes, linkage, points[-1])
            at, before, after = _bracket(linkage, points[-1], d[-1], d[-1] + step, changes)
            if not _breaks(linkage, before, after):
                points.append(after)
                d.append(at)
                continue
            points += [before, after]
            d += [at, at]
            broken.append(at)
            if after.multiplier <= 0:
                end, reason = at, "falls"
                break
            continue
        if now.multiplier <= ROOT * abs(first.multiplier):
            at, _, last = _bracket(linkage, points[-1], d[-1], d[-1] + step, lambda p: p.multiplier <= 0)
            points.append(last)
            d.append(at)
            end, reason = at, "falls"
            break
        points.append(now)
        d.append(d[-1] + step)
    multipliers = np.array([p.multiplier for p in points])
    if reason in ("joints end", "joint opens"):  # what may still stand beyond does not count
        points.append(points[-1])
        d.append(end)
        multipliers = np.append(multipliers, 0.0)
    elif end == end and not (broken and d[-1] == broken[-1]):
        multipliers[-1] = 0.0
    forces = np.array([p.tie_force for p in points])
    return CapacityCurve("followed", np.array(d), multipliers, end, reason, tuple(broken), forces, tuple(points))


def _first_step(linkage: Linkage, first: Point, d0: float) -> float:
    """Return a step of which some ``STEPS`` lead to where alpha vanishes, by its slope without ties."""
    tiny = 1e-5 * linkage.size
    moved = linkage.moved(first.q + tiny * linkage.velocity(first.q).reshape(-1, 3), d0 + tiny)
    after = None if moved is None else linkage.balance(moved)
    begin, then = first.multiplier, 0.0 if after is None else after.multiplier
    fall = (begin - then) / tiny
    length = begin / fall if fall > 0 else 0.5 * linkage.size
    return min(max(length, 1e-3 * linkage.size), 0.5 * linkage.size) / STEPS


def _ahead(linkage: Linkage, last: Point, step: float) -> Array:
    """Return a guess (G, 3) of the next configuration."""
    guess: Array = last.q + step * linkage.velocity(last.q).reshape(-1, 3)
    return guess


def _breaks(linkage: Linkage, before: Point, after: Point) -> list[int]:
    """Return the ties that break between two configurations."""
    found = []
    for k, (tie, _, _) in enumerate(linkage.ties):
        limit = tie.break_elongation
        if limit is not None and before.elongation[k] < limit <= after.elongation[k]:
            found.append(k)
    return found


def _changes(linkage: Linkage, before: Point, after: Point) -> list[int]:
    """Return the ties that yield or break between two configurations."""
    found = _breaks(linkage, before, after)
    for k, (tie, _, _) in enumerate(linkage.ties):
        if before.elongation[k] < yields_at(tie) <= after.elongation[k]:
            found.append(k)
    return found


def _shortens(linkage: Linkage, before: Point, after: Point) -> bool:
    """Return whether a tie that has yielded or broken gets shorter again: what it then carries is not followed."""
    return any(
        after.elongation[k] < before.elongation[k] >= min(yields_at(tie), tie.break_elongation or np.inf)
        for k, (tie, _, _) in enumerate(linkage.ties)
    )


def _bracket(
    linkage: Linkage, start: Point, low: float, high: float, beyond: Callable[[Point], object]
) -> tuple[float, Point, Point]:
    """Return the displacement at which ``beyond`` becomes true, by bisection, with the points just before and after."""
    before, after = start, start
    for _ in range(60):
        middle = (low + high) / 2
        moved = linkage.moved(before.q, middle)
        now = None if moved is None else linkage.balance(moved)
        if now is None:
            break
        if beyond(now):
            high, after = middle, now
        else:
            low, before = middle, now
        if high - low <= 1e-15 * linkage.size:
            break
    return high, before, after if after is not start else before
