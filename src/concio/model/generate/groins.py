"""Vaults of cylindrical webs that meet at groins.

The webs of a cloister vault stand on walls all round; those of a cross vault are open at the edges and stand on four
corners. Webs are cylinders whose axes pass through the middle of the plan, so that groins lie in vertical planes;
courses run along the axes, between joints that point to them. At the groin two webs meet in a mitre joint, or one stone
reaches round the corner (``groin = "stone"``), as masons prefer.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Literal, Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.kinematics.rigid import rotation_matrix
from concio.model.generate.generator_arguments import choice, count, not_negative, positive
from concio.model.generate.masonry import numbered
from concio.model.generate.solid_masonry import (
    CommonSpace,
    SolidPiece,
    assemble_space,
    checked_space,
    grid_piece,
    joined,
    prism_piece,
)
from concio.model.model import Model
from concio.units import degrees

Array = np.ndarray
Groin = Literal["stone", "mitre"]
SHORTEST = 0.25
"""Shortest piece beside a groin, in block lengths."""


@strict_with(CommonSpace.__annotations__)
def cloister_vault(
    *,
    span: float | str,
    ring: float | str,
    courses: int,
    block_length: float | str,
    sides: int = 4,
    rise: float | str | None = None,
    oculus: float | str = 0.0,
    groin: Groin = "stone",
    **common: Unpack[CommonSpace],
) -> Model:
    """Return a cloister vault over a regular plan of ``sides`` sides, on fixed springers.

    Parameters
    ----------
    span : float or str
        Clear distance between opposite walls, twice the distance of a wall from the middle [m].
    ring : float or str
        Thickness [m].
    courses : int
        Courses from the springing to the key or the oculus.
    block_length : float or str
        [m].
    sides : int
        Of the plan; 4 is a square, 8 an octagonal dome.
    rise : float or str, optional
        Rise of the intrados; half the span by default [m].
    oculus : float or str
        Clear width of the opening at the top; 0 closes the vault with a key [m].
    groin : {"stone", "mitre"}
        One stone reaches round the corner where two webs meet, or both end in a mitre joint.
    **common
        See :class:`concio.model.generate.solid_masonry.CommonSpace`.

    Notes
    -----
    Blocks are called ``s1-c01-b01``: side, course from below, block; those round a groin belong to the side before it.

    Examples
    --------
    The springers carry the weight of the vault:

    >>> import concio
    >>> model = concio.cloister_vault(span=3.0, ring=0.3, courses=3, block_length=1.5, block="rigid", unit_weight=20.0)
    >>> result = concio.solve(model)
    >>> weight = sum(20.0 * block.volume for block in model.free_bodies)
    >>> round(sum(float(force[2]) for force in result.reactions.values()) / weight, 6)
    1.0
    """
    where = "cloister_vault"
    options = checked_space(where, common)
    s, t = positive(where, "span", span), positive(where, "ring", ring)
    l = positive(where, "block_length", block_length)
    n, m = count(where, "courses", courses), count(where, "sides", sides, 3)
    choice(where, "groin", groin, ("stone", "mitre"))
    eye = not_negative(where, "oculus", oculus)
    high = 0.5 * s if rise is None else positive(where, "rise", rise)
    if high > 0.5 * s * (1 + 1e-9):
        msg = f"a cloister vault of span {s:g} m rises at most {s / 2:g} m, not {high:g} m"
        raise InputError(msg, where=where)
    if eye >= 0.95 * s:
        msg = f"oculus = {eye:g} m leaves no vault of span {s:g} m"
        raise InputError(msg, where=where)
    radius = (0.25 * s * s + high * high) / (2 * high)
    low = 0.0 if rise is None else float(np.arccos(min(0.5 * s / radius, 1.0)))  # from the horizontal
    top = float(np.arccos(0.5 * eye / radius)) if eye else np.pi / 2
    step = (top - low) / (n if eye else n + 0.5)
    angles = low + step * np.arange(n + 1)
    tangent, down = float(np.tan(np.pi / m)), radius * float(np.sin(low))
    pieces: list[SolidPiece] = []
    for c in range(n):
        ends: list[list[SolidPiece]] = []
        for k in range(m):
            turn = rotation_matrix(np.array([0.0, 0.0, 2 * np.pi * k / m]))
            narrow = radius * float(np.cos(angles[c + 1])) * tangent
            inner = _cuts(narrow, l, c)
            runs = [None, *inner, None]
            row = []
            for b, (y0, y1) in enumerate(pairwise(runs)):
                grid = _web(radius, t, angles[[c, c + 1]], down, tangent, y0, y1)
                name = f"s{k + 1}-{numbered('c', c + 1, n)}-{numbered('b', b + 1, len(runs) - 1)}"
                row.append(grid_piece(name, grid @ turn.T, layer=f"course {c + 1}"))
            ends.append(row)
        pieces += _round_the_groins(ends, groin)
    if not eye:
        pieces.append(_pyramid("key", radius, t, float(angles[-1]), down, m))
    obstacles = []
    for k in range(m):
        turn = rotation_matrix(np.array([0.0, 0.0, 2 * np.pi * k / m]))
        facet = _web(radius, t, np.array([low, low]), down, tangent, None, None)[:, :, 0].reshape(4, 3)[[0, 2, 3, 1]]
        normal = np.array([np.sin(low), 0.0, -np.cos(low)])
        obstacles.append(
            prism_piece(f"springer {k + 1}", [facet @ turn.T], (0.5 * t * normal @ turn.T).tolist(), role="springer")
        )
    title = f"cloister vault on {m} sides, span {s:g} m, ring {t:g} m, {len(pieces)} blocks"
    record = {"kind": "cloister_vault", "span": s, "ring": t, "courses": n, "sides": m, "groin": groin}
    return assemble_space(options, pieces, obstacles, title=title, generator=record)


def _cuts(half: float, length: float, course: int) -> list[float]:
    """Return where a course of half length ``half`` is cut, from its middle [m]; no piece at the ends is too short."""
    if half <= 0:
        return []
    number = int(half / length) + 1
    at = length * (np.arange(-number, number + 1) + (0.5 if course % 2 == 0 else 0.0))
    return [float(y) for y in at if abs(y) < half - SHORTEST * length]


def _web(
    radius: float, thick: float, angles: Array, down: float, tangent: float, y0: float | None, y1: float | None
) -> Array:
    """Return the grid (2, 2, 2, 3) of a block of the web towards +x: radius, axis, angle; None ends at the groin."""
    found = np.zeros((2, 2, 2, 3))
    for i, r in enumerate((radius, radius + thick)):
        for k, angle in enumerate(angles):
            x = r * np.cos(angle)
            ends = (-x * tangent if y0 is None else y0, x * tangent if y1 is None else y1)
            for j, y in enumerate(ends):
                found[i, j, k] = (x, y, r * np.sin(angle) - down)
    return found


def _round_the_groins(rows: list[list[SolidPiece]], groin: str) -> list[SolidPiece]:
    """Return the blocks of a course all round; last and first of neighbouring webs are one where the groin is stone."""
    if groin == "mitre":
        return [p for row in rows for p in row]
    if any(len(row) == 1 for row in rows):  # blocks from groin to groin: nothing to reach round with
        return [p for row in rows for p in row]
    found = []
    for k, row in enumerate(rows):
        found += row[1:-1]
        found.append(joined(row[-1], rows[(k + 1) % len(rows)][0]))
    return found


def _pyramid(name: str, radius: float, thick: float, angle: float, down: float, sides: int) -> SolidPiece:
    """Return the truncated pyramid that closes a vault over a regular plan."""
    turn = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    reach = 1 / np.cos(np.pi / sides)
    rings = []
    for r in (radius, radius + thick):
        x = r * np.cos(angle) * reach
        rings.append(np.column_stack([x * np.cos(turn), x * np.sin(turn), np.full(sides, r * np.sin(angle) - down)]))
    faces = [tuple(range(sides))[::-1], tuple(range(sides, 2 * sides))]
    faces += [(k, (k + 1) % sides, (k + 1) % sides + sides, k + sides) for k in range(sides)]
    return SolidPiece(name, (np.vstack(rings), tuple(faces), ()), layer="key")


@strict_with(CommonSpace.__annotations__)
def cross_vault(
    *,
    span: float | str,
    ring: float | str,
    courses: int,
    block_length: float | str,
    springing: float | str = 40.0,
    groin: Groin = "stone",
    **common: Unpack[CommonSpace],
) -> Model:
    """Return a cross vault of two equal semicircular barrels over a square, on four fixed springers.

    Parameters
    ----------
    span : float or str
        Clear span of the barrels and side of the square [m].
    ring : float or str
        Thickness [m].
    courses : int
        Courses from each springing to the crown course, which is not counted.
    block_length : float or str
        [m].
    springing : float or str
        Angle above the horizontal at which the webs leave the springers, which are one solid below [degrees].
    groin : {"stone", "mitre"}
        One stone reaches round the corner where two webs meet, or both end in a mitre joint.
    **common
        See :class:`concio.model.generate.solid_masonry.CommonSpace`.

    Notes
    -----
    Blocks are called ``s1-c01-b01``: side (1 towards +y, then round), course from the left springing over the crown to
    the right one, block from the groin outwards. The fixed bodies are "springer 1" to "springer 4", the stone in the
    middle "key". z = 0 is the level of the axes of the barrels.

    Examples
    --------
    Each of the four springers carries a quarter of the weight:

    >>> import concio
    >>> model = concio.cross_vault(span=3.0, ring=0.3, courses=2, block_length=1.5, springing=45.0, block="rigid")
    >>> result = concio.solve(model)
    >>> round(float(-result.reactions["springer 1"][2] / result.total_load[2]), 6)
    0.25
    """
    where = "cross_vault"
    options = checked_space(where, common)
    s, t = positive(where, "span", span), positive(where, "ring", ring)
    l = positive(where, "block_length", block_length)
    n = count(where, "courses", courses)
    choice(where, "groin", groin, ("stone", "mitre"))
    low = float(np.deg2rad(degrees(springing, where=f"{where}, springing")))
    r, edge = 0.5 * s, 0.5 * s
    least = float(np.arccos((edge - 0.05 * s) / (r + t)))
    if not least < low < np.deg2rad(85):
        msg = f"springing = {np.rad2deg(low):.4g} degrees must lie between {np.rad2deg(least):.3g} and 85"
        raise InputError(msg, where=where, hint="lower down the webs have no width left beside the springers")
    step = (np.pi / 2 - low) / (n + 0.5)
    angles = low + step * np.arange(n + 1)
    foot = max(low - step, least + min(0.02, 0.5 * (low - least)))
    rows: dict[tuple[int, int], list[SolidPiece]] = {}
    total = 2 * n + 1
    crown = 0.5 * step
    for k in range(4):
        turn = rotation_matrix(np.array([0.0, 0.0, -0.5 * np.pi * k]))
        for c in range(n):
            for side in (0, 1):  # left, right half of the web
                number = c if side == 0 else total - 1 - c
                cuts = _from_edge(r + t, float(angles[c]), edge, l, c)
                row = []
                for b, (y0, y1) in enumerate(zip([None, *cuts], [*cuts, edge], strict=True)):
                    grid = _half_web(r, t, angles[[c, c + 1]], y0, y1, side)
                    name = f"s{k + 1}-{numbered('c', number + 1, total)}-{numbered('b', b + 1, len(cuts) + 1)}"
                    row.append(grid_piece(name, grid @ turn.T, layer=f"course {c + 1}"))
                rows[k, number] = row
        cuts = _from_edge((r + t) * float(np.sin(crown)), 0.0, edge, l, n)
        row = []
        for b, (y0, y1) in enumerate(zip([None, *cuts], [*cuts, edge], strict=True)):
            grid = _crown(r, t, crown, y0, y1)
            name = f"s{k + 1}-{numbered('c', n + 1, total)}-{numbered('b', b + 1, len(cuts) + 1)}"
            row.append(grid_piece(name, grid @ turn.T, layer="crown"))
        rows[k, n] = row
    pieces = []
    for (k, number), row in rows.items():
        own = list(row)
        if groin == "stone" and number > n:  # the right half of a web and the left half of the next share a groin
            own[0] = joined(row[0], rows[(k + 1) % 4, total - 1 - number][0])
        elif groin == "stone" and number < n:
            own = own[1:]
        pieces += own
    pieces.append(_pyramid("key", r, t, np.pi / 2 - crown, 0.0, 4))
    obstacles = []
    for k in range(4):
        turn, following = (rotation_matrix(np.array([0.0, 0.0, -0.5 * np.pi * j])) for j in (k, k + 1))
        low_angles = np.array([foot, low])
        right = grid_piece(f"springer {k + 1}", _half_web(r, t, low_angles, None, edge, 1) @ turn.T, role="springer")
        left = grid_piece("left", _half_web(r, t, low_angles, None, edge, 0) @ following.T, role="springer")
        obstacles.append(joined(right, left))
    title = f"cross vault, span {s:g} m, ring {t:g} m, {len(pieces)} blocks"
    record = {"kind": "cross_vault", "span": s, "ring": t, "courses": n, "groin": groin}
    return assemble_space(options, pieces, obstacles, title=title, generator=record)


def _from_edge(radius: float, angle: float, edge: float, length: float, course: int) -> list[float]:
    """Return where a course is cut between the groin and the edge, from the middle of the plan [m]."""
    near = radius * float(np.cos(angle)) + SHORTEST * length
    at = edge - length * (np.arange(1, int(edge / length) + 2) - (0.5 if course % 2 else 0.0))
    return sorted(float(y) for y in at if y > near)


def _half_web(radius: float, thick: float, angles: Array, y0: float | None, y1: float, side: int) -> Array:
    """Return the grid of a block of the web towards +y: left (x < 0) or right half; None is the groin."""
    found = np.zeros((2, 2, 2, 3))
    for i, r in enumerate((radius, radius + thick)):
        for k, angle in enumerate(angles):
            x, z = r * np.cos(angle), r * np.sin(angle)
            for j, y in enumerate((x if y0 is None else y0, y1)):
                found[i, j, k] = (x if side else -x, y, z)
    return found if side else found[:, ::-1]


def _crown(radius: float, thick: float, half: float, y0: float | None, y1: float) -> Array:
    """Return the grid of a block of the crown course towards +y; None is the face of the key."""
    found = np.zeros((2, 2, 2, 3))
    for i, r in enumerate((radius, radius + thick)):
        for k, x in enumerate((r * np.sin(half), -r * np.sin(half))):
            for j, y in enumerate((r * np.sin(half) if y0 is None else y0, y1)):
                found[i, j, k] = (x, y, r * np.cos(half))
    return found
