"""Outlines that are drawn as holes, and the blocks they lie in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import shapely

from concio.errors import GeometryError
from concio.model.drawing.dxf import Outline
from concio.model.rings import check_holes


def with_holes(outlines: Sequence[Outline], note: Any) -> list[Outline]:
    """Return the outlines of blocks with the holes in them; a hole belongs to the smallest block around it.

    Parameters
    ----------
    outlines : sequence of Outline
        Those of blocks and those of holes.
    note : callable
        Takes kind, outline, place and text of a fault: a hole that lies in no block, or touches its outline.
    """
    blocks = [o for o in outlines if o.use.use != "hole"]
    drawn = [o for o in outlines if o.use.use == "hole"]
    if not drawn:
        return list(outlines)
    shapes = [shapely.Polygon(o.points) for o in blocks]
    tree = shapely.STRtree(shapes)
    found: dict[int, list[Outline]] = {}
    for hole in drawn:
        ring = shapely.Polygon(hole.points)
        around = [int(k) for k in tree.query(ring, predicate="covered_by")]
        if not around:
            note("hole", hole, hole.points[0], "this hole lies in no block, or only in part (draw it inside one)")
            continue
        found.setdefault(min(around, key=lambda k: float(shapes[k].area)), []).append(hole)
    result = []
    for k, block in enumerate(blocks):
        holes = found.get(k, [])
        try:
            check_holes(block.points, [hole.points for hole in holes], "")
        except GeometryError as error:
            note("hole", block, block.points[0], str(error))
            continue
        result.append(replace(block, holes=tuple(holes)))
    return result
