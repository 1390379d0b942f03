"""An arch on two piers with its spandrels: one bay of a bridge or of an arcade.

Courses of the spandrels run from the outer faces to the extrados, which they follow; where a course would thin out over
the arch to less than a quarter of its height it ends.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Literal, Unpack

import numpy as np
import shapely
import shapely.ops

from concio.arguments import strict_with
from concio.errors import InputError
from concio.model.generate.arches import ring_outlines
from concio.model.generate.generator_arguments import (
    Common,
    check_blocks,
    checked,
    choice,
    count,
    finite,
    not_negative,
    positive,
)
from concio.model.generate.masonry import Piece, assemble, numbered, rectangle
from concio.model.model import Load, Model

Array = np.ndarray
THIN = 0.25
"""Share of its height to which a course of a spandrel may thin out."""


@strict_with(Common.__annotations__)
def arch_on_piers(
    *,
    span: float | str,
    ring: float | str,
    voussoirs: int,
    pier_width: float | str,
    pier_height: float | str,
    pier_courses: int,
    shape: Literal["semicircular", "segmental", "pointed"] = "semicircular",
    rise: float | str | None = None,
    course: float | str | None = None,
    block_length: float | str | None = None,
    fill: float | str = 0.0,
    spandrels: bool = True,
    chord_tolerance: float | str | None = None,
    top_pressure: float | str = 0.0,
    **common: Unpack[Common],
) -> Model:
    """Return an arch on two piers with spandrels.

    Parameters
    ----------
    span : float or str
        Clear span between the piers; x = 0 is the crown [m].
    ring : float or str
        Thickness of the arch [m].
    voussoirs : int
        Number of voussoirs.
    pier_width, pier_height : float or str
        The piers stand on the ground at y = 0 and end at the springing of the intrados [m].
    pier_courses : int
        Blocks of each pier; the last is cut to the springing joint.
    shape, rise
        As in :func:`concio.arch`.
    course, block_length : float or str, optional
        Of the spandrels: height of a course, by default that of the piers', and length of a block, by default twice the
        height [m].
    fill : float or str
        Height of the masonry above the crown of the extrados [m].
    spandrels : bool
        False leaves them out, and the fill with them.
    chord_tolerance : float or str, optional
        Largest distance of a chord from its arc [m]; without it each voussoir has one chord.
    top_pressure : float or str
        On the upper edge [kN/m2], load group "top".
    **common
        See :class:`concio.model.generate.generator_arguments.Common`.

    Notes
    -----
    Blocks are called ``left-p01`` (piers, from below), ``v01`` (arch, from the left), ``c01-b01`` (spandrels, course
    from below, block from the left). The fixed bodies are "left ground" and "right ground".

    Examples
    --------
    >>> import concio
    >>> model = concio.arch_on_piers(
    ...     span=2.0, ring=0.3, voussoirs=9, pier_width=0.8, pier_height=2.0, pier_courses=4, spandrels=False
    ... )
    >>> len(model.free_bodies)
    17
    """
    where = "arch_on_piers"
    options = checked(where, common)
    s, t, n = positive(where, "span", span), positive(where, "ring", ring), count(where, "voussoirs", voussoirs, 2)
    b, h = positive(where, "pier_width", pier_width), positive(where, "pier_height", pier_height)
    m = count(where, "pier_courses", pier_courses)
    choice(where, "shape", shape, ("semicircular", "segmental", "pointed"))
    high = h / m if course is None else positive(where, "course", course)
    long = 2 * high if block_length is None else positive(where, "block_length", block_length)
    over, pressure = not_negative(where, "fill", fill), finite(where, "top_pressure", top_pressure, "stress")
    tolerance = None if chord_tolerance is None else positive(where, "chord_tolerance", chord_tolerance)
    outlines, joints = ring_outlines(where, shape, s, None if rise is None else positive(where, "rise", rise), t, n,
                                     tolerance)  # fmt: skip
    if abs(joints[0][1, 0]) > s / 2 + b + 1e-9:
        msg = f"the arch is thicker at its springing than the pier, {b:g} m, is wide"
        raise InputError(msg, where=where, hint="make the piers wider")
    lift = np.array([0.0, h])
    arch = [outline + lift for outline in outlines]
    pieces = [Piece(numbered("v", k + 1, n), o, layer="keystone" if n % 2 and k == n // 2 else "voussoir")
              for k, o in enumerate(arch)]  # fmt: skip
    pieces += [p for k, word in enumerate(("left", "right")) for p in _pier(word, joints[k] + lift, s, b, h, m)]
    top = h
    if spandrels:
        solid = shapely.union_all([shapely.Polygon(o) for o in arch])
        foot = float(joints[0][1, 1]) + h
        crown = float(solid.bounds[3])
        rows = (crown - foot + over) / high
        check_blocks(where, rows * (s + 2 * b) / long, "lengths are in m")
        levels = _levels(foot, crown, over, high)
        pieces += _spandrels(solid, levels, s / 2 + b, long)
        top = float(levels[-1])
    loads = []
    if pressure:
        loads = [Load("pressure", (pressure,), edge=((-s / 2 - b, top), (s / 2 + b, top)), group="top")]
    deep = 0.1 * max(s, h)
    obstacles = [
        Piece("left ground", rectangle(-s / 2 - b, -s / 2, -deep, 0.0), "ground"),
        Piece("right ground", rectangle(s / 2, s / 2 + b, -deep, 0.0), "ground"),
    ]
    title = f"{shape} arch on piers, span {s:g} m, {len(pieces)} blocks"
    record = {"kind": "arch_on_piers", "shape": shape, "span": s, "ring": t, "voussoirs": n}
    return assemble(options, pieces, obstacles, loads=loads, title=title, generator=record)


def _pier(word: str, joint: Array, s: float, b: float, h: float, m: int) -> list[Piece]:
    """Return the blocks of a pier; the last carries the springing joint, given from intrados to extrados."""
    levels = h * np.arange(m + 1) / m
    sign = -1.0 if word == "left" else 1.0
    inner, outer = sign * s / 2, sign * (s / 2 + b)
    found = []
    for k, (low, high) in enumerate(pairwise(levels.tolist())):
        outline = rectangle(min(inner, outer), max(inner, outer), low, high)
        if k == m - 1:
            corners = [[outer, low], [inner, low], joint[0], joint[1], [outer, float(joint[1, 1])]]
            if abs(joint[1, 0] - outer) < 1e-9 * b:
                corners.pop()
            outline = np.array(corners, dtype=float)
        found.append(Piece(f"{word}-{numbered('p', k + 1, m)}", outline, layer="pier"))
    return found


def _levels(foot: float, crown: float, fill: float, course: float) -> Array:
    """Return the bed joints of the spandrels: one at the crown of the extrados, courses of equal height below it."""
    below = max(1, round((crown - foot) / course))
    above = max(1, round(fill / course)) if fill > 0 else 0
    upper = crown + fill * np.arange(1, above + 1) / max(above, 1)
    return np.concatenate([foot + (crown - foot) * np.arange(below + 1) / below, upper])


def _spandrels(ring: shapely.Geometry, levels: Array, half: float, long: float) -> list[Piece]:
    """Return the blocks of the courses between the outer faces and the ring of the arch."""
    hidden = shapely.Polygon(shapely.get_coordinates(_extrados(ring)))
    found = []
    total = len(levels) - 1
    for c, (y0, y1) in enumerate(pairwise(levels.tolist())):
        strip = shapely.box(-half, y0, half, y1).difference(hidden)
        solid = _without_thin_ends(strip, hidden, y0, y1)
        parts = sorted(shapely.get_parts(solid), key=lambda part: part.bounds[0])
        blocks = [block for part in parts for block in _cut(part, half, long, c)]
        for k, block in enumerate(blocks):
            outline = np.array(shapely.orient_polygons(block).exterior.coords[:-1])
            apart = np.hypot(*(outline - np.roll(outline, 1, axis=0)).T)
            outline = outline[apart > 1e-9 * half]
            found.append(Piece(f"{numbered('c', c + 1, total)}-{numbered('b', k + 1, len(blocks))}", outline,
                               layer="spandrel"))  # fmt: skip
    return found


def _extrados(ring: shapely.Geometry) -> shapely.LineString:
    """Return the outer line of an arch, from springing to springing."""
    points = shapely.get_coordinates(ring)[:-1]
    x0, y0, x1, _ = ring.bounds
    ends = [int(np.argmin(np.hypot(points[:, 0] - x, (points[:, 1] - y0) * 0.5))) for x in (x0, x1)]
    ways = [np.roll(points, -ends[0], axis=0)]
    stop = (ends[1] - ends[0]) % len(points)
    ways = [ways[0][: stop + 1], np.vstack([ways[0][stop:], ways[0][:1]])]
    upper = max(ways, key=lambda way: float(way[:, 1].mean()))
    return shapely.LineString(upper)


def _without_thin_ends(strip: shapely.Geometry, hidden: shapely.Polygon, y0: float, y1: float) -> shapely.Geometry:
    """Return a course without feather edges: ends over the arch, thinner than a quarter of its height and longer."""
    thin = THIN * (y1 - y0)
    ends = [hidden.intersection(shapely.box(-1e6, y, 1e6, 1e6)).bounds for y in (y1 - thin, y1)]
    low, high = (ends[0][k] for k in (0, 2))
    if np.isnan(low) or high - low <= 0:
        return strip
    at_top = ends[1] if not np.isnan(ends[1][0]) else (0.5 * (low + high),) * 4
    if max(at_top[0] - low, high - at_top[2]) <= thin:  # the extrados is steep here
        return strip
    return strip.difference(shapely.box(low, y0 - 1.0, high, y1 + 1.0))


def _cut(part: shapely.Polygon, half: float, long: float, course: int) -> list[shapely.Polygon]:
    """Return the blocks of a part of a course: cut from its outer face, in running bond."""
    x0, y0, x1, y1 = part.bounds
    left = abs(x0 + half) < 1e-9 * half
    start = x0 if left else x1
    sign = 1.0 if left else -1.0
    edges = (y0 + 0.02 * (y1 - y0), y1 - 0.02 * (y1 - y0))
    ends = sorted((_reach(part, y, sign) for y in edges), key=lambda e: e * sign)
    width = abs(ends[0] - start) if not (left and abs(x1 - half) < 1e-9 * half) else x1 - x0
    first = long if course % 2 == 0 else 0.5 * long
    cuts = []
    at = first
    while at < width - 0.4 * long:
        cuts.append(start + sign * at)
        at += long
    found = [part]
    for x in cuts:
        line = shapely.LineString([(x, y0 - 1.0), (x, y1 + 1.0)])
        found = [piece for block in found for piece in shapely.get_parts(shapely.ops.split(block, line))]
    return sorted(found, key=lambda block: block.bounds[0])


def _reach(part: shapely.Polygon, y: float, sign: float) -> float:
    """Return how far a part of a course reaches at a height, on the side of the arch."""
    across = part.intersection(shapely.LineString([(-1e6, y), (1e6, y)]))
    x0, _, x1, _ = across.bounds
    return float(x1 if sign > 0 else x0)
