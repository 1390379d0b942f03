"""Columns of drums: regular prisms or truncated pyramids on each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.model.generate.generator_arguments import count, finite, positive, two
from concio.model.generate.masonry import numbered
from concio.model.generate.solid_masonry import CommonSpace, SolidPiece, assemble_space, box_piece, checked_space
from concio.model.model import Load, Model


@strict_with(CommonSpace.__annotations__)
def drums(
    *,
    diameter: float | str,
    height: float | str,
    drums: int,
    sides: int = 20,
    top_diameter: float | str | None = None,
    top_force: float | str = 0.0,
    eccentricity: Sequence[float | str] = (0.0, 0.0),
    **common: Unpack[CommonSpace],
) -> Model:
    """Return a column of drums on the fixed body "ground", its axis at x = y = 0.

    Parameters
    ----------
    diameter : float or str
        Of the circle through the corners of the foot [m].
    height : float or str
        [m].
    drums : int
        Called ``d01``, ``d02``... from below.
    sides : int
        Of a drum; 4 is a square pillar with its corners on the axes.
    top_diameter : float or str, optional
        At the head of a tapering column [m].
    top_force : float or str
        Vertical force on the head, downwards positive [kN], load group "top".
    eccentricity : (x, y)
        Where it acts [m].
    **common
        See :class:`concio.model.generate.solid_masonry.CommonSpace`.

    Examples
    --------
    The section of a pillar with 8 sides is 2 sqrt(2) times the square of its radius, here 0.707 m2:

    >>> import concio
    >>> model = concio.drums(diameter=1.0, height=3.0, drums=3, sides=8, block="rigid", unit_weight=20.0)
    >>> round(float(concio.solve(model).reactions["ground"][2]), 3)
    42.426
    """
    where = "drums"
    options = checked_space(where, common)
    foot, h = positive(where, "diameter", diameter), positive(where, "height", height)
    n, m = count(where, "drums", drums), count(where, "sides", sides, 3)
    head = foot if top_diameter is None else positive(where, "top_diameter", top_diameter)
    force = finite(where, "top_force", top_force, "force")
    ex, ey = (finite(where, "eccentricity", v) for v in two(where, "eccentricity", eccentricity))
    if np.hypot(ex, ey) > 0.5 * head * np.cos(np.pi / m):
        msg = f"eccentricity = ({ex:g}, {ey:g}) m lies outside the head of the column"
        raise InputError(msg, where=where, hint=f"at most {0.5 * head * np.cos(np.pi / m):.4g} m from the axis")
    turn = 2 * np.pi * np.arange(m) / m
    circle = 0.5 * np.column_stack([np.cos(turn), np.sin(turn)])
    sections = []
    for k in range(n + 1):
        wide = foot + (head - foot) * k / n
        sections.append(np.column_stack([wide * circle, np.full(m, h * k / n)]))
    round_ = [(k, (k + 1) % m, (k + 1) % m + m, k + m) for k in range(m)]
    faces = (tuple(range(m))[::-1], tuple(range(m, 2 * m)), *round_)
    pieces = [
        SolidPiece(numbered("d", k + 1, n), (np.vstack(sections[k : k + 2]), faces, ()), layer="drum") for k in range(n)
    ]
    side = 0.5 * max(foot, head)
    ground = box_piece("ground", (-side, -side, -0.1 * max(foot, h)), (side, side, 0.0), role="ground")
    loads = []
    if force:
        loads = [Load("point", (0.0, 0.0, -force), bodies=(pieces[-1].name,), at=(ex, ey, h), group="top")]
    title = f"column of {n} drums, {foot:g} m wide, {h:g} m high"
    return assemble_space(options, pieces, [ground], loads=loads, title=title, generator={"kind": "drums", "drums": n})
