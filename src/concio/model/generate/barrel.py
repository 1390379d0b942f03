"""Barrel vaults: an arch repeated along its axis in rings of blocks that break joint, square or askew in plan.

A skew barrel is the square one sheared in plan: a point at x moves along the axis by x tan(skew). Planes stay planes,
so that blocks keep planar faces; courses are parallel to the springings, the faces at the ends stand askew.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Literal, Unpack

import numpy as np

from concio.arguments import strict_with
from concio.errors import InputError
from concio.model.generate.arches import Shape, abutment_outline, ring_outlines
from concio.model.generate.generator_arguments import choice, count, positive
from concio.model.generate.masonry import numbered
from concio.model.generate.solid_masonry import CommonSpace, SolidPiece, assemble_space, checked_space, prism_piece
from concio.model.model import Model
from concio.units import degrees

Array = np.ndarray


@strict_with(CommonSpace.__annotations__)
def barrel(
    *,
    span: float | str,
    ring: float | str,
    length: float | str,
    voussoirs: int,
    blocks: int = 4,
    shape: Shape = "semicircular",
    rise: float | str | None = None,
    skew: float | str = 0.0,
    bond: Literal["running", "stack"] = "running",
    chord_tolerance: float | str | None = None,
    **common: Unpack[CommonSpace],
) -> Model:
    """Return a barrel vault between two fixed abutments along y.

    Parameters
    ----------
    span : float or str
        Clear span at the springings, along x [m].
    ring : float or str
        Thickness [m].
    length : float or str
        Along the axis, y from 0 [m].
    voussoirs : int
        Courses from springing to springing; an odd number has a course of keystones.
    blocks : int
        Whole blocks in a course.
    shape, rise
        As in :func:`concio.arch`.
    skew : float or str
        Angle by which the ends stand askew in plan [degrees].
    bond : {"running", "stack"}
        Whether every second course is shifted by half a block.
    chord_tolerance : float or str, optional
        Largest distance of a chord from its arc [m]; without it each voussoir has one chord.
    **common
        See :class:`concio.model.generate.solid_masonry.CommonSpace`.

    Notes
    -----
    Blocks are called ``v01-b01``: course from the left springing, block along the axis. The fixed bodies are "left
    abutment" and "right abutment".

    Examples
    --------
    In section the vault is half a ring of 14 sides:

    >>> import concio
    >>> import math
    >>> model = concio.barrel(span=2.0, ring=0.2, length=3.0, voussoirs=7, blocks=3)
    >>> round(sum(block.volume for block in model.free_bodies), 6)
    2.004543
    >>> round(7 * math.sin(math.pi / 7) / 2 * (1.2**2 - 1.0**2) * 3.0, 6)
    2.004543
    """
    where = "barrel"
    options = checked_space(where, common)
    s, t, l = positive(where, "span", span), positive(where, "ring", ring), positive(where, "length", length)
    n, m = count(where, "voussoirs", voussoirs, 2), count(where, "blocks", blocks)
    choice(where, "bond", bond, ("running", "stack"))
    angle = degrees(skew, where=f"{where}, skew")
    if not abs(angle) < 75:
        msg = f"skew = {angle:g} must lie between -75 and 75 degrees"
        raise InputError(msg, where=where)
    tolerance = None if chord_tolerance is None else positive(where, "chord_tolerance", chord_tolerance)
    height = None if rise is None else positive(where, "rise", rise)
    outlines, joints = ring_outlines(where, shape, s, height, t, n, tolerance)
    lean = float(np.tan(np.deg2rad(angle)))
    pieces = []
    for k, outline in enumerate(outlines):
        cuts = l * np.arange(m + 1) / m
        if bond == "running" and k % 2:
            cuts = np.concatenate([[0.0], cuts[:-1] + 0.5 * l / m, [l]])
        for j, (y0, y1) in enumerate(pairwise(cuts.tolist())):
            name = f"{numbered('v', k + 1, n)}-{numbered('b', j + 1, len(cuts) - 1)}"
            layer = "keystone" if n % 2 and k == n // 2 else "voussoir"
            pieces.append(along_axis(name, outline, y0, y1, lean, layer=layer))
    obstacles = [
        along_axis(f"{side} abutment", abutment_outline(joint, t), 0.0, l, lean, role="abutment")
        for side, joint in zip(("left", "right"), joints, strict=True)
    ]
    word = "" if not angle else f", {angle:g} degrees askew"
    title = f"{shape} barrel, span {s:g} m, ring {t:g} m, {l:g} m long{word}, {len(pieces)} blocks"
    record = {"kind": "barrel", "shape": shape, "span": s, "ring": t, "length": l, "voussoirs": n, "skew": angle}
    return assemble_space(options, pieces, obstacles, title=title, generator=record)


def along_axis(name: str, outline: Array, y0: float, y1: float, lean: float, **words: str) -> SolidPiece:
    """Return the block that an outline (n, 2) in x, z sweeps from y0 to y1, sheared by ``lean`` in plan."""
    x, z = outline.T
    ring = np.column_stack([x, y1 + lean * x, z])
    return prism_piece(name, [ring], (0.0, y0 - y1, 0.0), **words)
