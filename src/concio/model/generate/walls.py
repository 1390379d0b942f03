"""Walls of one or several panels, in any bond, with openings and lintels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, Unpack

import numpy as np
import shapely

from concio.arguments import strict_with
from concio.errors import GeometryError, InputError
from concio.model.generate.bonds import SHORTEST, Course, bond_courses, head_joints, sort_of_piece, without_short_pieces
from concio.model.generate.generator_arguments import Common, check_blocks, checked, finite, positive, two
from concio.model.generate.masonry import Piece, assemble, numbered, rectangle
from concio.model.generate.openings import Opening, checked_openings
from concio.model.generate.wall_panels import Bond, Panel, checked_panels
from concio.model.materials import Elastic, Rigid
from concio.model.model import Array, Load, Model

"""More blocks than this are taken for a typing error."""


@strict_with(Common.__annotations__)
def wall(
    *,
    length: float | str | None = None,
    height: float | str | None = None,
    block_size: Sequence[float | str] = (0.25, 0.125),
    bond: Bond = "running",
    lap: float = 0.5,
    openings: Sequence[Opening | Mapping[str, Any]] = (),
    lintel: Elastic | Rigid | None = None,
    panels: Sequence[Panel | Mapping[str, Any]] = (),
    ground: bool = True,
    side_walls: bool = False,
    top_pressure: float | str = 0.0,
    **common: Unpack[Common],
) -> Model:
    """Return a dry wall of blocks; thin mortar is a joint law with stiffness and strength.

    Parameters
    ----------
    length, height : float or str
        Of the wall, where it has no ``panels`` [m]. The last course is cut to the height, or made a little higher
        where less than a quarter of a course is left.
    block_size : (length, height)
        Of a whole block in the face of the wall [m].
    bond : str or sequence
        "running", "stack", "english", "flemish", or courses of one's own
        (:func:`concio.model.generate.bonds.bond_courses`).
    lap : float
        Lap of running bond in block lengths.
    openings : sequence of Opening or mapping
        Doors and windows.
    lintel : Elastic or Rigid, optional
        Material of lintels; None takes the blocks'.
    panels : sequence of Panel or mapping
        Several panels instead of one: side by side or on each other, each with its bond and its openings.
    ground : bool
        A fixed body "ground" under the lowest panels, as wide as they are.
    side_walls : bool
        Fixed bodies "left wall" and "right wall" beside the whole.
    top_pressure : float or str
        On the upper edge of the highest panels [kN/m2], load group "top".
    **common
        See :class:`concio.model.generate.generator_arguments.Common`.

    Raises
    ------
    InputError
        An argument is missing or out of range.
    GeometryError
        An opening leaves a strip of a course too thin to be a block.

    Notes
    -----
    Blocks are called ``c03-b07`` (course and block from 1, from below and from the left), after ``p2-`` where there are
    several panels; ``layer`` holds the mason's word (whole, half, closer, cut).

    Examples
    --------
    A wall of 9 m2 with a door of 2 m2:

    >>> import concio
    >>> door = {"x": 1.0, "y": 0.0, "width": 1.0, "height": 2.0, "lintel": 0.25}
    >>> model = concio.wall(length=3.0, height=3.0, block_size=(0.5, 0.25), openings=[door])
    >>> round(sum(block.area for block in model.free_bodies), 6)
    7.0
    """
    where = "wall"
    options = checked(where, common)
    size = tuple(positive(where, "block_size", v) for v in two(where, "block_size", block_size))
    pressure = finite(where, "top_pressure", top_pressure, "stress")
    parts = checked_panels(where, panels, length, height, openings)
    pieces: list[Piece] = []
    for number, part in enumerate(parts, 1):
        prefix = f"p{number}-" if len(parts) > 1 else ""
        courses = bond_courses(part.bond if part.bond is not None else bond, lap)
        each = min(min(c.unit) for c in courses) * min(c.height for c in courses)
        check_blocks(where, part.length / size[0] * (part.height / size[1]) / each, "block_size is in m")
        pieces += panel_pieces(where, part, (size[0], size[1]), courses, prefix, "lintel" if lintel else "block")
    x0, y0 = (min(p.at[k] for p in parts) for k in (0, 1))
    x1, y1 = max(p.at[0] + p.length for p in parts), max(p.at[1] + p.height for p in parts)
    deep = 0.1 * max(x1 - x0, y1 - y0)
    obstacles = []
    if ground:
        low = [p for p in parts if p.at[1] <= y0 + 1e-9]
        left, right = min(p.at[0] for p in low), max(p.at[0] + p.length for p in low)
        obstacles.append(Piece("ground", rectangle(left, right, y0 - deep, y0), "ground"))
    if side_walls:
        obstacles.append(Piece("left wall", rectangle(x0 - deep, x0, y0, y1), "side wall"))
        obstacles.append(Piece("right wall", rectangle(x1, x1 + deep, y0, y1), "side wall"))
    if not obstacles:
        msg = "no ground and no side walls: nothing holds the wall"
        raise InputError(msg, where=where, hint="set ground = true")
    loads = []
    if pressure:
        high = [p for p in parts if p.at[1] + p.height >= y1 - 1e-9]
        edges = [((p.at[0], y1), (p.at[0] + p.length, y1)) for p in high]
        loads = [Load("pressure", (pressure,), edge=edge, group="top") for edge in edges]
    one_bond = all(p.bond is None or p.bond == bond for p in parts)
    word = bond if isinstance(bond, str) and one_bond else "own"
    title = f"wall of {x1 - x0:g} x {y1 - y0:g} m in {word} bond, {len(pieces)} blocks"
    record = {
        "kind": "wall", "bond": word, "block_size": list(size), "lap": float(lap), "length": x1 - x0,
        "height": y1 - y0, "blocks": len(pieces),
    }  # fmt: skip
    materials = {"lintel": lintel} if lintel else {}
    return assemble(options, pieces, obstacles, loads=loads, materials=materials, title=title, generator=record)


@strict_with(Common.__annotations__)
def wall_of_courses(
    courses: Sequence[Sequence[float]],
    *,
    block_size: Sequence[float | str] = (0.25, 0.125),
    ground: bool = True,
    top_pressure: float | str = 0.0,
    **common: Unpack[Common],
) -> Model:
    """Return a wall from the lengths of its blocks, course by course from below.

    Parameters
    ----------
    courses : sequence of sequences of float
        Lengths in block lengths from the left; a negative length is an opening of that length.
    block_size : (length, height)
        [m].
    ground, top_pressure, **common
        As in :func:`wall`.

    Examples
    --------
    The third course has an opening of one block:

    >>> import concio
    >>> model = concio.wall_of_courses([[1, 1, 1], [0.5, 1, 1, 0.5], [1, -1, 1]], block_size=(0.4, 0.2))
    >>> len(model.free_bodies)
    9
    """
    where = "wall"
    options = checked(where, common)
    l, h = (positive(where, "block_size", v) for v in two(where, "block_size", block_size))
    pressure = finite(where, "top_pressure", top_pressure, "stress")
    if not len(courses):
        msg = "there are no courses"
        raise InputError(msg, where=where, hint="give the lengths of the blocks of each course")
    pieces, width = [], 0.0
    for c, row in enumerate(courses):
        lengths = np.asarray(row, dtype=float)
        if lengths.ndim != 1 or not len(lengths) or not np.isfinite(lengths).all() or (lengths == 0).any():
            msg = f"course {c + 1} has the lengths {list(row)}"
            raise InputError(msg, where=where, hint="give lengths in block lengths; negative ones are openings")
        ends = l * np.concatenate([[0.0], np.cumsum(np.abs(lengths))])
        width = max(width, float(ends[-1]))
        for k in np.flatnonzero(lengths > 0):
            name = f"{numbered('c', c + 1, len(courses))}-{numbered('b', int(k) + 1, len(lengths))}"
            outline = rectangle(ends[k], ends[k + 1], c * h, (c + 1) * h)
            pieces.append(Piece(name, outline, layer=sort_of_piece(float(lengths[k]))))
    top = len(courses) * h
    deep = 0.1 * max(width, top)
    obstacles = [Piece("ground", rectangle(0.0, width, -deep, 0.0), "ground")] if ground else []
    loads = [Load("pressure", (pressure,), edge=((0.0, top), (width, top)), group="top")] if pressure else []
    title = f"wall of {len(courses)} courses, {len(pieces)} blocks"
    return assemble(options, pieces, obstacles, loads=loads, title=title, generator={"kind": "wall_of_courses"})


def panel_pieces(
    where: str, panel: Panel, size: tuple[float, float], courses: Sequence[Course], prefix: str, lintel: str
) -> list[Piece]:
    """Return the blocks and lintels of one panel."""
    l, h = size
    openings = checked_openings(where, panel.openings, panel.length, panel.height)
    levels = course_levels(panel.height / h, courses) * h
    at = np.array(panel.at)
    pieces = []
    holes = [hole for opening in openings for hole in opening.holes]
    for c, (y0, y1) in enumerate(pairwise(levels)):
        lines = l * head_joints(courses[c % len(courses)], panel.length / l)
        outlines = course_outlines(f"{where}, course {c + 1}", lines, float(y0), float(y1), holes, l)
        for k, outline in enumerate(outlines):
            name = f"{prefix}{numbered('c', c + 1, len(levels) - 1)}-{numbered('b', k + 1, len(outlines))}"
            sort = sort_of_piece(float(np.ptp(outline[:, 0])) / l)
            pieces.append(Piece(name, outline + at, layer=sort))
    for k, opening in enumerate(openings, 1):
        if opening.lintel:
            outline = rectangle(*opening.holes[1]) + at
            pieces.append(Piece(f"{prefix}lintel{k}", outline, "lintel", "lintel", lintel))
    return pieces


def course_levels(height: float, courses: Sequence[Course]) -> Array:
    """Return the bed joints (k,) of a wall of ``height``, ends included, in block heights."""
    levels, c = [0.0], 0
    while levels[-1] < height - 1e-9:
        levels.append(levels[-1] + courses[c % len(courses)].height)
        c += 1
    last = height - levels[-2]
    if len(levels) > 2 and last < SHORTEST - 1e-9:
        levels.pop()
    return np.array([*levels[:-1], height])


def course_outlines(
    where: str, lines: Array, y0: float, y1: float, holes: Sequence[tuple[float, float, float, float]], l: float
) -> list[Array]:
    """Return the outlines of a course from y0 to y1 with head joints ``lines``, holes left out."""
    tiny = 1e-9 * max(l, y1)
    met = [hole for hole in holes if hole[2] < y1 - tiny and hole[3] > y0 + tiny]
    whole = [hole for hole in met if hole[2] <= y0 + tiny and hole[3] >= y1 - tiny]
    partly = [hole for hole in met if hole not in whole]
    through = sorted((hole[0], hole[1]) for hole in whole)
    solid, start = [], float(lines[0])
    for a, b in [*through, (float(lines[-1]), np.inf)]:
        if a - start > tiny:
            solid.append((start, a))
        start = max(start, b)
    outlines: list[Array] = []
    for a, b in solid:
        inner = lines[(lines > a + tiny) & (lines < b - tiny)]
        ends = without_short_pieces(np.array([a, *inner, b]) / l) * l
        ends[0], ends[-1] = a, b
        outlines += [rectangle(p, q, y0, y1) for p, q in pairwise(ends)]
    for hole in partly:
        outlines = [left for outline in outlines for left in _without(where, outline, hole, 0.1 * (y1 - y0))]
    return outlines


def _without(where: str, outline: Array, hole: tuple[float, float, float, float], thinnest: float) -> list[Array]:
    """Return what a rectangular hole that ends inside the course leaves of a block."""
    block, cut = shapely.Polygon(outline), shapely.box(hole[0], hole[2], hole[1], hole[3])
    if not block.intersects(cut) or block.intersection(cut).area <= 1e-9 * block.area:
        return [outline]
    left = block.difference(cut)
    parts = [p for p in shapely.get_parts(left) if p.area > 1e-9 * block.area]
    for part in parts:
        if part.buffer(-0.5 * thinnest, join_style="mitre").is_empty:
            x, y = part.centroid.x, part.centroid.y
            msg = f"the opening or lintel leaves a strip thinner than {1e3 * thinnest:.3g} mm at ({x:.4g}, {y:.4g}) m"
            raise GeometryError(msg, where=where, hint="let its edges fall on bed joints or further from them")
    return [np.array(shapely.orient_polygons(part).exterior.coords[:-1]) for part in parts]
