"""The blocks that drawn supports and loads stand on, and those that drawn ties join."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from concio.model.drawing.dxf import Drawing, DxfFault, Edge
from concio.model.generate.masonry import Piece
from concio.model.model import Load, Point, Support, Tie


def supports_and_loads(
    drawing: Drawing, pieces: Sequence[Piece], tolerance: float
) -> tuple[list[Support], list[Load], list[DxfFault]]:
    """Return supports and loads with the names of the blocks they stand on, and those that stand on none.

    Parameters
    ----------
    drawing : Drawing
    pieces : sequence of Piece
        Blocks that are not fixed.
    tolerance : float
        What is drawn nearer than twice this to an edge lies on it [m].
    """
    shapes = np.array([shapely.Polygon(p.outline, p.holes) for p in pieces])
    rings = shapely.boundary(shapes)
    bands = shapely.buffer(rings, 2 * tolerance)
    supports: list[Support] = []
    loads: list[Load] = []
    lost: list[DxfFault] = []

    def along(edge: Edge) -> list[str]:
        if edge[0] == edge[1]:
            chosen = np.flatnonzero(shapely.distance(rings, shapely.Point(edge[0])) <= 2 * tolerance)
        else:
            common = shapely.length(shapely.intersection(shapely.LineString(edge), bands))
            chosen = np.flatnonzero(common > 8 * tolerance)  # a side that is crossed covers half of that
        return [pieces[k].name for k in chosen.tolist()]

    def under(place: Point) -> list[str]:
        """Return the block that a point lies in; of several that it lies between, the lowest."""
        point = shapely.Point(place)
        chosen = np.flatnonzero(shapely.distance(shapes, point) <= tolerance)
        heights = shapely.get_y(shapely.centroid(shapes[chosen]))
        return [pieces[int(chosen[np.argmin(heights)])].name] if len(chosen) else []

    def nowhere(handle: str, at: Point, what: str) -> None:
        text = f"entity {handle} at ({at[0]:.6g}, {at[1]:.6g}) m: this {what} lies on no block (move it onto an edge)"
        lost.append(DxfFault("place", handle, "", np.array(at), text))

    for k, held in enumerate(drawing.supports):
        names = along(held.edge)
        if not names:
            nowhere(held.handle, held.edge[0], "support")
        same = sum(other.handle == held.handle for other in drawing.supports[:k])
        for name in names:
            label = f"support {held.handle}" + (f".{same + 1}" if same else "")
            label += f" {name}" if len(names) > 1 else ""
            supports.append(Support(label, name, held.edge, held.directions, group=held.group))
    for load, handle in drawing.loads:
        if load.at is not None:
            names, at = under(load.at), load.at
        else:
            assert load.edge is not None  # a drawn load has a place
            names, at = along(load.edge), load.edge[0]
        if names:
            loads.append(replace(load, bodies=tuple(names)))
        else:
            nowhere(handle, at, "load")
    return supports, loads, lost


def drawn_ties(drawing: Drawing, pieces: Sequence[Piece], tolerance: float) -> tuple[list[Tie], list[DxfFault]]:
    """Return the ties of a drawing with the blocks that their ends lie in, and those that join nothing.

    An end in no block that moves is a fixed point.

    Parameters
    ----------
    drawing : Drawing
    pieces : sequence of Piece
        Blocks that are not fixed.
    tolerance : float
        What is drawn nearer than this to a block lies in it [m].
    """
    shapes = np.array([shapely.Polygon(p.outline, p.holes) for p in pieces])
    found: list[Tie] = []
    lost: list[DxfFault] = []

    def at(place: Point) -> str:
        near = shapely.distance(shapes, shapely.Point(place))
        return pieces[int(np.argmin(near))].name if float(near.min()) <= tolerance else ""

    for k, drawn in enumerate(drawing.ties):
        ends = sorted(((at(end), end) for end in drawn.edge), key=lambda end: end[0] == "")
        (a, at_a), (b, at_b) = ends
        if a == b:
            what = f"joins '{a}' with itself" if a else "joins no block"
            text = f"entity {drawn.handle}: this tie {what} (draw it from one block to another, or to a fixed point)"
            lost.append(DxfFault("place", drawn.handle, "", np.array(drawn.edge[0]), text))
            continue
        same = sum(other.handle == drawn.handle for other in drawing.ties[:k])
        name = f"tie {drawn.handle}" + (f".{same + 1}" if same else "")
        n = drawn.numbers
        found.append(Tie(name, a, at_a, b, at_b, stiffness=n["stiffness"], prestress=n.get("prestress", 0.0),
                         yield_force=n.get("yield_force"), break_elongation=n.get("break_elongation")))  # fmt: skip
    return found, lost
