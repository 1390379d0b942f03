"""Walls in space: corners, T-junctions and crossings, one or several wythes, openings; and towers made of them.

Every run of a course between two ends is set out so that its head joints lap those of the course below on the same
wall as far as they can: the mason's choice of the first piece (whole, half, three-quarter or a closer).

Wythes lie side by side with a collar joint between them. Headers cross two of them: in English bond every second course
is of headers, in Flemish bond headers and stretchers take turns in every course, and ``headers`` puts a course of
headers into running bond after every so many.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal, Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.model.generate.bonds import without_short_pieces
from concio.model.generate.generator_arguments import check_blocks, choice, count, finite, positive
from concio.model.generate.masonry import numbered
from concio.model.generate.openings import Opening
from concio.model.generate.plan import (
    Junction,
    PlanWall,
    WallLine,
    checked_plan,
    junctions,
    require_clear_corners,
    runs_of,
)
from concio.model.generate.solid_masonry import (
    CommonSpace,
    SolidPiece,
    assemble_space,
    box_piece,
    checked_space,
    prism_piece,
)
from concio.model.generate.walls import course_outlines
from concio.model.materials import Elastic, Rigid
from concio.model.model import Load, Model

Array = np.ndarray
BondInSpace = Literal["running", "stack", "english", "flemish"]
FIRST = {
    "stretcher": ((), (0.5,), (0.75,), (0.25,), (0.75, 0.75)),
    "header": ((0.5, 0.25), (), (0.25,), (0.75,), (0.5, 0.75)),
    "mixed": ((), (0.5, 0.25), (0.5,), (0.75,), (0.25,)),
}
"""First pieces a mason would try, in block lengths, in this order; then the unit of the course repeats."""


@dataclass(frozen=True)
class _Bricks:
    """Sizes of a block and what a wall is made of: length, width, height [m], wythes, bond, course of headers each."""

    length: float
    width: float
    height: float
    wythes: int
    bond: str
    headers: int

    @property
    def thick(self) -> float:
        return self.wythes * self.width

    def unit(self, course: int) -> tuple[str, tuple[float, ...]]:
        """Return the sort of a course and its repeating unit in block lengths."""
        if self.bond == "flemish":
            return "mixed", (1.0, 0.5) if course % 2 == 0 else (0.5, 1.0)
        if (self.bond == "english" and course % 2) or (self.headers and course % self.headers == self.headers - 1):
            return "header", (0.5,)
        return "stretcher", (1.0,)


@strict_with(CommonSpace.__annotations__)
def walls(
    *,
    lines: Sequence[WallLine | Mapping[str, Any] | Sequence[Any]],
    height: float | str | None = None,
    block_size: Sequence[float | str] = (0.25, 0.125, 0.125),
    bond: BondInSpace = "running",
    wythes: int = 1,
    headers: int = 0,
    lintel: Elastic | Rigid | None = None,
    ground: Literal["one", "each"] = "one",
    top_pressure: float | str = 0.0,
    **common: Unpack[CommonSpace],
) -> Model:
    """Return dry walls in space with corners, T-junctions and crossings, bonded as masons do.

    Parameters
    ----------
    lines : sequence
        The walls in plan: pairs of ends of their axes, along x or y [m], or
        :class:`concio.model.generate.plan.WallLine` with height and openings. Walls whose ends meet share the corner.
    height : float or str
        Of the walls that have none of their own [m].
    block_size : (length, width, height)
        Of a whole block [m]; the width is the thickness of a wythe.
    bond : {"running", "stack", "english", "flemish"}
        English and Flemish need two wythes.
    wythes : int
        Blocks side by side in the thickness.
    headers : int
        Every so many courses of running bond one of headers, which cross two wythes; 0 for none. Blocks must then be
        twice as long as wide.
    lintel : Elastic or Rigid, optional
        Material of the lintels; that of the blocks where None.
    ground : {"one", "each"}
        One fixed body "ground" under all walls, or one under each ("ground 1"...), which can settle alone.
    top_pressure : float or str
        On the upper faces of all walls [kN/m2], load group "top".
    **common
        See :class:`concio.model.generate.solid_masonry.CommonSpace`.

    Raises
    ------
    InputError
        An argument is missing or out of range.
    GeometryError
        An opening leaves a strip of a course too thin to be a block.

    Notes
    -----
    Blocks are called ``w1-c03-b07``: wall, course and block from 1, from below and along the axis; with several wythes
    ``w1-c03-y2-b07``. Layers hold "header" or the mason's word for the length.

    Examples
    --------
    Two walls meet at a corner. They are 0.25 m thick and 0.5 m high, and their axes are 2 m long:

    >>> import concio
    >>> model = concio.walls(lines=[((0, 0), (2, 0)), ((0, 0), (0, 2))], height=0.5, block_size=(0.5, 0.25, 0.25))
    >>> round(sum(block.volume for block in model.free_bodies), 6)
    0.5
    """
    where = "walls"
    options = checked_space(where, common)
    bricks = _checked_bricks(where, block_size, bond, wythes, headers)
    choice(where, "ground", ground, ("one", "each"))
    pressure = finite(where, "top_pressure", top_pressure, "stress")
    plan = checked_plan(where, lines, height, bricks.thick)
    area = sum((w.high - w.low) * w.height for w in plan)
    check_blocks(where, area / (bricks.length * bricks.height) * bricks.wythes, "block_size is in m")
    meeting = junctions(plan, 0.5 * bricks.thick)
    require_clear_corners(where, plan, meeting, 0.5 * bricks.thick)
    pieces = [p for k in range(len(plan)) for p in _wall(where, plan, k, meeting, bricks, "lintel" if lintel else "")]
    loads = _pressed(plan, meeting, bricks.thick, pressure) if pressure else []
    extent = _extent(plan, bricks.thick)
    title = f"{len(plan)} wall{'s' if len(plan) > 1 else ''} in {bond} bond, {len(pieces)} blocks"
    record = {"kind": "walls", "bond": bond, "wythes": bricks.wythes, "walls": len(plan), "blocks": len(pieces)}
    materials = {"lintel": lintel} if lintel else {}
    return assemble_space(
        options, pieces, _grounds(plan, bricks.thick, ground, extent), loads=loads, materials=materials, title=title,
        generator=record,
    )  # fmt: skip


@strict_with(CommonSpace.__annotations__)
def tower(
    *,
    width: float | str,
    depth: float | str,
    height: float | str,
    block_size: Sequence[float | str] = (0.6, 0.3, 0.3),
    bond: BondInSpace = "running",
    wythes: int = 1,
    headers: int = 0,
    openings: Sequence[Sequence[Opening | Mapping[str, Any]]] = (),
    lintel: Elastic | Rigid | None = None,
    ground: Literal["one", "each"] = "one",
    top_pressure: float | str = 0.0,
    **common: Unpack[CommonSpace],
) -> Model:
    """Return a tower: four walls round a rectangle, bonded at the corners.

    Parameters
    ----------
    width, depth : float or str
        Outer sizes along x and y; the middle of the tower stands at the origin [m].
    height : float or str
        [m].
    block_size, bond, wythes, headers, lintel, ground, top_pressure
        As in :func:`walls`.
    openings : sequence of sequences
        Openings of the front, right, back and left wall, each from its left end seen from outside, as in :func:`walls`.
    **common
        See :class:`concio.model.generate.solid_masonry.CommonSpace`.

    Examples
    --------
    Walls of 0.3 m around 3 by 2.4 m, 1.5 m high:

    >>> import concio
    >>> model = concio.tower(width=3.0, depth=2.4, height=1.5, block_size=(0.6, 0.3, 0.3))
    >>> round(sum(block.volume for block in model.free_bodies), 6)
    4.32
    """
    where = "tower"
    bricks = _checked_bricks(where, block_size, bond, wythes, headers)
    a, b = positive(where, "width", width), positive(where, "depth", depth)
    half = 0.5 * bricks.thick
    if min(a, b) <= 4 * half:
        msg = f"a tower of {a:g} x {b:g} m with walls of {2 * half:g} m has no room inside"
        raise InputError(msg, where=where, hint="make it wider, or its walls thinner")
    if len(openings) > 4:
        msg = f"there are openings for {len(openings)} walls, a tower has 4"
        raise InputError(msg, where=where, hint="give those of the front, right, back and left wall")
    corners = [(-a / 2, -b / 2), (a / 2, -b / 2), (a / 2, b / 2), (-a / 2, b / 2)]
    shift = [(0.0, half), (-half, 0.0), (0.0, -half), (half, 0.0)]
    lines = []
    for k in range(4):
        (x0, y0), (x1, y1), (dx, dy) = corners[k], corners[(k + 1) % 4], shift[k]
        own = openings[k] if k < len(openings) else ()
        lines.append(WallLine((x0 + dx, y0 + dy), (x1 + dx, y1 + dy), None, own))
    made = walls(
        lines=lines, height=height, block_size=block_size, bond=bond, wythes=wythes, headers=headers, lintel=lintel,
        ground=ground, top_pressure=top_pressure, **common,
    )  # fmt: skip
    given = str(common.get("title") or f"tower of {a:g} x {b:g} m, {len(made.free_bodies)} blocks")
    return replace(made, title=given, generator={**made.generator, "kind": "tower", "width": a, "depth": b})


def _checked_bricks(where: str, size: Sequence[float | str], bond: str, wythes: int, headers: int) -> _Bricks:
    try:
        l, w, h = size
    except (TypeError, ValueError):
        msg = f"block_size = {size!r} must be three lengths"
        raise InputError(msg, where=where, hint="length, width and height of a block in m") from None
    l, w, h = (positive(where, "block_size", v) for v in (l, w, h))
    choice(where, "bond", bond, ("running", "stack", "english", "flemish"))
    number = count(where, "wythes", wythes)
    every = count(where, "headers", headers, 0)
    if bond in ("english", "flemish") and number != 2:
        msg = f"{bond} bond has two wythes, not {number}"
        raise InputError(msg, where=where, hint="set wythes = 2; for other walls take headers")
    if every and (number < 2 or bond != "running"):
        msg = f"headers = {every} needs running bond and two wythes or more"
        raise InputError(msg, where=where, hint="a header crosses two wythes")
    crossing = every or bond in ("english", "flemish")
    if crossing and abs(l - 2 * w) > 1e-6 * l:
        msg = f"headers of blocks {l:g} m long do not fill two wythes of {w:g} m"
        raise InputError(msg, where=where, hint="block_size = (length, half of it, height)")
    return _Bricks(l, w, h, number, bond, every)


def _wall(
    where: str, plan: Sequence[PlanWall], number: int, meeting: Sequence[Junction], bricks: _Bricks, lintel: str
) -> list[SolidPiece]:
    """Return the blocks of one wall."""
    wall = plan[number]
    courses = max(1, int(np.ceil(wall.height / bricks.height - 0.25)))
    levels = np.append(bricks.height * np.arange(courses), wall.height)
    label = numbered("w", number + 1, 1).replace("w0", "w")
    pieces, below = [], np.zeros(0)
    for c, (z0, z1) in enumerate(pairwise(levels.tolist())):
        sort, unit = bricks.unit(c)
        found: list[tuple[Array, float]] = []
        lines_here = [np.zeros(0)]
        for s0, s1 in runs_of(plan, number, meeting, c, z0, 0.5 * bricks.thick):
            lines = _set_out(s0, s1, bricks, sort, unit, below)
            lines_here.append(lines)
            inside = [(max(a, s0), min(b, s1), z, t) for a, b, z, t in wall.holes if a < s1 - 1e-9 and b > s0 + 1e-9]
            name = f"{where}, wall {number + 1}, course {c + 1}"
            found += [(o, float(np.ptp(o[:, 0]))) for o in course_outlines(name, lines, z0, z1, inside, bricks.length)]
        below = np.concatenate(lines_here)
        pieces += _course(wall, label, c, courses, found, bricks, sort)
    half = 0.5 * bricks.thick
    for k, (s0, s1, z0, z1) in enumerate(wall.lintels, 1):
        outline = np.array([[s0, z0], [s1, z0], [s1, z1], [s0, z1]])
        words = {"role": "lintel", "layer": "lintel", "material": lintel or "block"}
        pieces.append(_swept(wall, f"{label}-lintel{k}", outline, -half, half, words))
    return pieces


def _course(
    wall: PlanWall, label: str, c: int, courses: int, found: Sequence[tuple[Array, float]], bricks: _Bricks, sort: str
) -> list[SolidPiece]:
    """Return the blocks of a course, wythe by wythe; headers cross two wythes."""
    w, l, half = bricks.width, bricks.length, 0.5 * bricks.thick
    pieces = []
    numbers = dict.fromkeys(range(bricks.wythes), 0)
    total = len(found)
    for outline, length in found:
        share = length / l
        header = sort != "stretcher" and abs(share - 0.5) < 0.05
        pairs = _crossed(bricks, c) if header else []
        taken = {y for y, _ in pairs} | {y for _, y in pairs}
        bands = [(y, y + 1) for y in range(bricks.wythes) if y not in taken] + [(p, q + 1) for p, q in pairs]
        for first, last in sorted(bands):
            numbers[first] += 1
            row = f"-y{first + 1}" if bricks.wythes > 1 else ""
            name = f"{label}-{numbered('c', c + 1, courses)}{row}-{numbered('b', numbers[first], total)}"
            layer = "header" if last - first == 2 else _word(share)
            pieces.append(_swept(wall, name, outline, first * w - half, last * w - half, {"layer": layer}))
    return pieces


def _word(share: float) -> str:
    for word, value in (("closer", 0.25), ("half", 0.5), ("three-quarter", 0.75), ("whole", 1.0)):
        if abs(share - value) <= 1e-6:
            return word
    return "cut"


def _crossed(bricks: _Bricks, course: int) -> list[tuple[int, int]]:
    """Return the pairs of wythes that headers cross: from the near face and from the far face in turn."""
    n = bricks.wythes
    start = 0 if n % 2 == 0 and not bricks.headers else (course // max(bricks.headers, 1)) % 2 if n > 2 else 0
    return [(y, y + 1) for y in range(start, n - 1, 2)]


def _swept(wall: PlanWall, name: str, outline: Array, t0: float, t1: float, words: Mapping[str, str]) -> SolidPiece:
    """Return the block of an outline (n, 2) in the face of a wall, from t0 to t1 across it."""
    s, z = outline.T
    if len(outline) == 4 and len(np.unique(s)) == 2 and len(np.unique(z)) == 2:
        low, high = [float(s.min()), wall.across + t0], [float(s.max()), wall.across + t1]
        if wall.axis == 1:
            low, high = low[::-1], high[::-1]
        return box_piece(name, (*low, float(z.min())), (*high, float(z.max())), **words)
    columns = [s, np.full(len(s), wall.across + t0)]
    ring = np.column_stack([*(columns if wall.axis == 0 else columns[::-1]), z])
    direction = np.zeros(3)
    direction[1 - wall.axis] = t1 - t0
    return prism_piece(name, [ring], direction.tolist(), **words)


def _set_out(s0: float, s1: float, bricks: _Bricks, sort: str, unit: tuple[float, ...], below: Array) -> Array:
    """Return the head joints of a run, ends included, that lap those of the course below best [m]."""
    l = bricks.length
    length = (s1 - s0) / l
    inner = (below - s0) / l
    inner = inner[(inner > 1e-6) & (inner < length - 1e-6)]
    best: tuple[float, Array] | None = None
    tries = ((),) if bricks.bond == "stack" else FIRST[sort]
    for turned in (False, True):
        for first in tries:
            at = list(np.cumsum([0.0, *first]))
            k = 0
            while at[-1] < length - 1e-9:
                at.append(at[-1] + unit[k % len(unit)])
                k += 1
            lines = np.array([*at[:-1], length]) if len(at) > 1 else np.array([0.0, length])
            lines = lines[lines <= length]
            lines = length - lines[::-1] if turned else lines
            lines = without_short_pieces(lines)
            lap = float(np.abs(lines[1:-1, None] - inner).min()) if len(lines) > 2 and len(inner) else 1.0
            score = min(lap, 0.5)
            if best is None or score > best[0] + 1e-6:
                best = (score, lines)
    assert best is not None
    found = s0 + l * best[1]
    found[0], found[-1] = s0, s1
    return found


def _pressed(plan: Sequence[PlanWall], meeting: Sequence[Junction], thick: float, pressure: float) -> list[Load]:
    """Return the loads on the upper faces of all walls, squares that two walls share once."""
    found, half = [], 0.5 * thick
    for k, wall in enumerate(plan):
        for s0, s1 in runs_of(plan, k, meeting, 0, wall.height - 1e-3 * thick, half):
            t0, t1 = wall.across - half, wall.across + half
            corners = [(s0, t0), (s1, t0), (s1, t1), (s0, t1)]
            polygon = tuple((*(p if wall.axis == 0 else p[::-1]), wall.height) for p in corners)
            found.append(Load("pressure", (pressure,), polygon=polygon, group="top"))
    return found


def _extent(plan: Sequence[PlanWall], thick: float) -> Array:
    """Return the lower and the upper corner of the plan (2, 2) [m]."""
    corners = []
    for w in plan:
        for s in (w.low, w.high):
            for t in (w.across - 0.5 * thick, w.across + 0.5 * thick):
                corners.append((s, t) if w.axis == 0 else (t, s))
    found = np.array(corners)
    return np.array([found.min(0), found.max(0)])


def _grounds(plan: Sequence[PlanWall], thick: float, how: str, extent: Array) -> list[SolidPiece]:
    deep = 0.1 * max(float(np.ptp(extent, axis=0).max()), max(w.height for w in plan))
    if how == "one":
        return [box_piece("ground", (*extent[0], -deep), (*extent[1], 0.0), role="ground")]
    found = []
    meeting = junctions(plan, 0.5 * thick)
    for k, wall in enumerate(plan):
        for part, (s0, s1) in enumerate(runs_of(plan, k, meeting, 0, 0.0, 0.5 * thick)):
            name = f"ground {k + 1}" + ("" if part == 0 else f" {'abcdefgh'[part]}")
            outline = np.array([[s0, -deep], [s1, -deep], [s1, 0.0], [s0, 0.0]])
            found.append(_swept(wall, name, outline, -0.5 * thick, 0.5 * thick, {"role": "ground"}))
    return found
