"""Walls in plan: where they meet, and which of them goes through a corner in each course.

A wall is a line along x or y, its axis. Where an axis ends at another wall, the wall reaches to the far face of that
wall, so that both share the square of the corner. As masons do, the walls that share a square take turns: in one course
the one goes through and the other butts against it, in the next course the reverse. Of a T the wall that runs on goes
through first, of a corner or a crossing the one listed first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from concio.arguments import strict_class
from concio.errors import InputError
from concio.model.generate.generator_arguments import check_keys, finite, positive, two
from concio.model.generate.openings import Opening, checked_openings

Array = np.ndarray

THICK = 20.0
"""A wall thicker than this is in another unit [m]."""


@strict_class
@dataclass(frozen=True)
class WallLine:
    """A wall in plan.

    Parameters
    ----------
    start, end : (x, y)
        Ends of its axis, along x or along y [m].
    height : float or str, optional
        Where it is not that of the others [m].
    openings : sequence of Opening or mapping
        ``x`` from the start along the axis, ``y`` from the foot [m].

    Examples
    --------
    A wall of 3 by 1.5 m and 0.25 m with a window of 0.5 m2:

    >>> import concio
    >>> from concio.generate import Opening, WallLine
    >>> window = Opening(x=1.0, y=0.5, width=1.0, height=0.5, lintel=0.25)
    >>> line = WallLine((0.0, 0.0), (3.0, 0.0), height=1.5, openings=[window])
    >>> model = concio.walls(lines=[line], block_size=(0.5, 0.25, 0.25))
    >>> round(sum(block.volume for block in model.free_bodies), 6)
    1.0
    """

    start: Sequence[float | str]
    end: Sequence[float | str]
    height: float | str | None = None
    openings: Sequence[Opening | Mapping[str, Any]] = ()


@dataclass(frozen=True)
class PlanWall:
    """A wall with its numbers checked.

    Parameters
    ----------
    axis : {0, 1}
        Along x or along y.
    low, high : float
        Its faces at the ends, along the axis [m].
    across : float
        Where its axis lies in the other direction [m].
    height : float
        [m].
    holes : tuple of (s0, s1, z0, z1)
        Openings and lintels along the axis [m].
    lintels : tuple of (s0, s1, z0, z1)
    """

    axis: int
    low: float
    high: float
    across: float
    height: float
    holes: tuple[tuple[float, float, float, float], ...] = ()
    lintels: tuple[tuple[float, float, float, float], ...] = ()


@dataclass(frozen=True)
class Junction:
    """Where two walls share a square: their numbers, that which goes through in the first course, and the other."""

    through: int
    butting: int


def checked_plan(
    where: str, lines: Sequence[WallLine | Mapping[str, Any] | Sequence[Any]], height: float | str | None, thick: float
) -> list[PlanWall]:
    """Return the walls of a plan, prolonged to the far faces of those they meet.

    Raises
    ------
    InputError
        A line is not along x or y, has no length, or an opening does not fit.
    """
    if not len(lines):
        msg = "there are no walls"
        raise InputError(msg, where=where, hint="lines = [((0, 0), (4, 0)), ((0, 0), (0, 3))]")
    found: list[PlanWall] = []
    given: list[tuple[float, float, Sequence[Any]]] = []
    for number, item in enumerate(lines, 1):
        place = f"{where}, line {number}"
        if isinstance(item, Mapping):
            check_keys(place, item, WallLine)
            for key in ("start", "end"):
                if key not in item:
                    msg = f"{key} is missing"
                    raise InputError(msg, where=place, hint="a wall in plan needs start and end")
            line = WallLine(**item)
        elif isinstance(item, WallLine):
            line = item
        else:
            line = WallLine(*two(where, f"line {number}", item))
        p, q = (np.array([finite(place, "end", v) for v in two(place, "end", e)]) for e in (line.start, line.end))
        along = q - p
        axis = int(np.argmax(np.abs(along)))
        length = float(np.abs(along[axis]))
        if length <= thick and thick > THICK:
            ends = f"from ({p[0]:g}, {p[1]:g}) to ({q[0]:g}, {q[1]:g}) m"
            msg = f"{ends}: the wall is {length:g} m long and {thick:g} m thick"
            hint = f"lengths without a unit are in m: is block_size in mm? [..., '{thick:g} mm', ...]"
            raise InputError(msg, where=place, hint=hint)
        if length <= thick or abs(along[1 - axis]) > 1e-9 * length:
            msg = f"from ({p[0]:g}, {p[1]:g}) to ({q[0]:g}, {q[1]:g}) m: a wall is longer than thick, along x or y"
            raise InputError(msg, where=place, hint="turn the whole with concio.place where it stands askew")
        top = positive(place, "height", line.height if line.height is not None else _needed(where, height))
        low, high = sorted((float(p[axis]), float(q[axis])))
        found.append(PlanWall(axis, low, high, float(p[1 - axis]), top))
        given.append((float(p[axis]), float(np.sign(along[axis])), line.openings))
    reaching = [_reaching(found, k, 0.5 * thick) for k in range(len(found))]
    return [_with_openings(where, w, *g) for w, g in zip(reaching, given, strict=True)]


def _needed(where: str, height: float | str | None) -> float | str:
    if height is None:
        msg = "height is missing"
        raise InputError(msg, where=where, hint="give the height of the walls in m, or one of its own to each line")
    return height


def _reaching(walls: Sequence[PlanWall], number: int, half: float) -> PlanWall:
    """Return a wall prolonged to the far faces of the walls in which it ends."""
    wall = walls[number]
    low, high = wall.low, wall.high
    tiny = 1e-6 * half
    for other in walls:
        if other.axis == wall.axis or not (other.low - half - tiny <= wall.across <= other.high + half + tiny):
            continue
        if abs(wall.low - other.across) <= half + tiny:
            low = other.across - half
        if abs(wall.high - other.across) <= half + tiny:
            high = other.across + half
    return replace(wall, low=low, high=high)


def _with_openings(where: str, wall: PlanWall, start: float, sense: float, openings: Sequence[Any]) -> PlanWall:
    length = wall.high - wall.low
    checked = checked_openings(where, openings, length, wall.height) if openings else ()
    holes, lintels = [], []
    for opening in checked:
        for k, (x0, x1, z0, z1) in enumerate(opening.holes):
            s = sorted((start + sense * x0, start + sense * x1))
            rectangle = (s[0], s[1], z0, z1)
            if s[0] < wall.low - 1e-9 or s[1] > wall.high + 1e-9:
                msg = f"an opening or its lintel reaches from {s[0]:g} to {s[1]:g} m, beyond the wall"
                raise InputError(msg, where=where, hint=f"the wall lies between {wall.low:g} and {wall.high:g} m")
            holes.append(rectangle)
            if k == 1:
                lintels.append(rectangle)
    return replace(wall, holes=tuple(holes), lintels=tuple(lintels))


def junctions(walls: Sequence[PlanWall], half: float) -> list[Junction]:
    """Return the squares that walls share."""
    found = []
    tiny = 1e-6 * half
    for i, a in enumerate(walls):
        for j, b in enumerate(walls[i + 1 :], i + 1):
            if a.axis == b.axis:
                continue
            if not (a.low - tiny <= b.across - half and b.across + half <= a.high + tiny):
                continue
            if not (b.low - tiny <= a.across - half and a.across + half <= b.high + tiny):
                continue
            a_ends = min(b.across - half - a.low, a.high - b.across - half) <= tiny
            b_ends = min(a.across - half - b.low, b.high - a.across - half) <= tiny
            found.append(Junction(j, i) if a_ends and not b_ends else Junction(i, j))
    return found


def runs_of(
    walls: Sequence[PlanWall], number: int, meeting: Sequence[Junction], course: int, foot: float, half: float
) -> list[tuple[float, float]]:
    """Return the intervals (s0, s1) of a wall that a course covers, squares that another wall takes left out."""
    wall = walls[number]
    tiny = 1e-6 * half
    gaps = []
    for junction in meeting:
        if number not in (junction.through, junction.butting):
            continue
        other = junction.butting if number == junction.through else junction.through
        if walls[other].height <= foot + tiny:  # the other wall has ended below
            continue
        owner = junction.through if course % 2 == 0 else junction.butting
        if owner != number:
            gaps.append((walls[other].across - half, walls[other].across + half))
    found, start = [], wall.low
    for a, b in [*sorted(gaps), (wall.high, np.inf)]:
        if a - start > tiny:
            found.append((start, a))
        start = max(start, b)
    return found


def require_clear_corners(where: str, walls: Sequence[PlanWall], meeting: Sequence[Junction], half: float) -> None:
    """Refuse openings and lintels that reach into a square that two walls share.

    Raises
    ------
    InputError
    """
    for junction in meeting:
        for own, other in ((junction.through, junction.butting), (junction.butting, junction.through)):
            low, high = walls[other].across - half, walls[other].across + half
            for s0, s1, z0, _ in walls[own].holes:
                if s0 < high - 1e-9 and s1 > low + 1e-9 and z0 < walls[other].height - 1e-9:
                    msg = f"an opening or its lintel of wall {own + 1} reaches into its corner with wall {other + 1}"
                    hint = f"keep it out of {low:g} to {high:g} m along the wall"
                    raise InputError(msg, where=where, hint=hint)
