"""Columns of blocks on each other, and buttresses with a sloping face."""

from __future__ import annotations

from itertools import pairwise
from typing import Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.model.generate.bonds import without_short_pieces
from concio.model.generate.generator_arguments import (
    Common,
    check_blocks,
    checked,
    count,
    finite,
    not_negative,
    positive,
)
from concio.model.generate.masonry import Piece, assemble, numbered, rectangle
from concio.model.model import Load, Model


@strict_with(Common.__annotations__)
def column(
    *,
    width: float | str,
    height: float | str,
    blocks: int,
    top_pressure: float | str = 0.0,
    top_force: float | str = 0.0,
    eccentricity: float | str = 0.0,
    **common: Unpack[Common],
) -> Model:
    """Return a column of equal blocks on the fixed body "ground".

    Parameters
    ----------
    width, height : float or str
        Of the column [m].
    blocks : int
        Number of blocks, called ``b01``, ``b02``... from below.
    top_pressure : float or str
        On the whole upper face [kN/m2], load group "top".
    top_force, eccentricity : float or str
        Vertical force, downwards positive [kN], load group "top", and its distance from the axis [m].
    **common
        See :class:`concio.model.generate.generator_arguments.Common`.

    Examples
    --------
    Under a horizontal share of its weight a column tips at width over height:

    >>> import concio
    >>> model = concio.column(width=0.5, height=2.0, blocks=4, block="rigid", horizontal=1.0)
    >>> round(concio.limit(model).design, 6)
    0.25
    """
    where = "column"
    options = checked(where, common)
    b, h = positive(where, "width", width), positive(where, "height", height)
    n = count(where, "blocks", blocks)
    pressure = finite(where, "top_pressure", top_pressure, "stress")
    force, e = finite(where, "top_force", top_force, "force"), finite(where, "eccentricity", eccentricity)
    if abs(e) > b / 2:
        msg = f"eccentricity = {e:g} m lies outside the column"
        raise InputError(msg, where=where, hint=f"at most half the width, {b / 2:g} m")
    levels = h * np.arange(n + 1) / n
    pieces = [
        Piece(numbered("b", k + 1, n), rectangle(-b / 2, b / 2, low, high))
        for k, (low, high) in enumerate(pairwise(levels))
    ]
    loads = []
    if pressure:
        loads.append(Load("pressure", (pressure,), edge=((-b / 2, h), (b / 2, h)), group="top"))
    if force:
        loads.append(Load("point", (0.0, -force), bodies=(pieces[-1].name,), at=(e, h), group="top"))
    ground = Piece("ground", rectangle(-b / 2, b / 2, -0.1 * max(b, h), 0.0), "ground")
    title = f"column of {n} blocks, {b:g} x {h:g} m"
    return assemble(options, pieces, [ground], loads=loads, title=title, generator={"kind": "column", "blocks": n})


@strict_with(Common.__annotations__)
def buttress(
    *,
    base: float | str,
    top: float | str,
    height: float | str,
    courses: int,
    block_length: float | str | None = None,
    thrust: float | str = 0.0,
    thrust_at: float | str | None = None,
    **common: Unpack[Common],
) -> Model:
    """Return a buttress: vertical left face, right face sloping from ``base`` to ``top``, in horizontal courses.

    Parameters
    ----------
    base, top : float or str
        Widths at the foot and at the head, base >= top [m].
    height : float or str
        [m].
    courses : int
        Number of courses of equal height.
    block_length : float or str, optional
        Length of the blocks of a course, in running bond from the left face [m]; None makes each course one block.
    thrust : float or str
        Horizontal force towards +x on the left face [kN], load group "live".
    thrust_at : float or str, optional
        Its height [m]; by default the middle of the highest course.
    **common
        See :class:`concio.model.generate.generator_arguments.Common`.

    Examples
    --------
    A buttress of 80 kN is 1 m wide. A thrust at a height of 3.5 m overturns it from 80 * 0.5 / 3.5 = 11.429 kN on:

    >>> import concio
    >>> model = concio.buttress(base=1.0, top=1.0, height=4.0, courses=4, thrust=1.0, block="rigid", unit_weight=20.0)
    >>> round(concio.limit(model).design, 3)
    11.429
    """
    where = "buttress"
    options = checked(where, common)
    b0, b1, h = positive(where, "base", base), positive(where, "top", top), positive(where, "height", height)
    n = count(where, "courses", courses)
    if b1 > b0:
        msg = f"top = {b1:g} m is wider than base = {b0:g} m"
        raise InputError(msg, where=where, hint="the buttress narrows upwards")
    length = None if block_length is None else positive(where, "block_length", block_length)
    check_blocks(where, n * (1.0 if length is None else b0 / length), "lengths are in m")
    force = finite(where, "thrust", thrust, "force")
    at = h * (1 - 0.5 / n) if thrust_at is None else not_negative(where, "thrust_at", thrust_at)
    if at > h:
        msg = f"thrust_at = {at:g} m lies above the buttress"
        raise InputError(msg, where=where, hint=f"the height is {h:g} m")
    levels = h * np.arange(n + 1) / n
    widths = b0 + (b1 - b0) * levels / h
    pieces: list[Piece] = []
    loaded = ""
    for c, ((y0, y1), (w0, w1)) in enumerate(zip(pairwise(levels), pairwise(widths), strict=True)):
        lines = np.array([0.0, w0])
        if length is not None:
            inner = length * (np.arange(int(w0 / length) + 1) + (1.0 if c % 2 == 0 else 0.5))
            inner = inner[inner < w1 - 0.25 * length]  # a joint must not meet the sloping face
            lines = without_short_pieces(np.array([0.0, *inner, w0]) / length, longest=1.25) * length
            lines[-1] = w0
        for k, (p, q) in enumerate(pairwise(lines)):
            last = k == len(lines) - 2
            outline = np.array([[p, y0], [q, y0], [w1 if last else q, y1], [p, y1]])
            course = numbered("c", c + 1, n)
            pieces.append(Piece(f"{course}-{numbered('b', k + 1, len(lines) - 1)}", outline))
        if y0 <= at <= y1:
            loaded = pieces[-(len(lines) - 1)].name
    loads = [Load("point", (force, 0.0), bodies=(loaded,), at=(0.0, at), group="live")] if force else []
    ground = Piece("ground", rectangle(0.0, b0, -0.1 * max(b0, h), 0.0), "ground")
    title = f"buttress of {n} courses, {b0:g} m at the foot, {b1:g} m at the head, {h:g} m high"
    return assemble(options, pieces, [ground], loads=loads, title=title, generator={"kind": "buttress", "courses": n})
