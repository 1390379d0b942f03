"""From a DXF drawing to a model: faults judged and mended, blocks named, supports and loads found on their blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, Unpack

import numpy as np
import shapely

from concio.arguments import strict_with
from concio.errors import GeometryError, InputError
from concio.model.drawing.dxf import CHORD_TOLERANCE, Drawing, DxfFault, Outline, read_drawing
from concio.model.drawing.mend import snapped
from concio.model.generate.arguments import Checked, Common, checked, not_negative
from concio.model.generate.masonry import Piece, assemble
from concio.model.interfaces.near import find_overlaps
from concio.model.interfaces.polygon_check import polygon_faults
from concio.model.materials import Elastic, Rigid
from concio.model.model import Array, Body, Load, Model, Support
from concio.units import quantity


@strict_with(Common.__annotations__)
def model_from_dxf(
    path: str | Path,
    *,
    materials: Mapping[str, Elastic | Rigid] | None = None,
    mend: float | str = 0.0,
    close: float | str | None = None,
    on_fault: Literal["raise", "skip"] = "raise",
    unit: str | None = None,
    chord_tolerance: float | str = CHORD_TOLERANCE,
    **common: Unpack[Common],
) -> Model:
    """Return the model that a DXF drawing describes; its layers are documented in :mod:`concio.model.drawing.dxf`.

    Parameters
    ----------
    path : str or Path
    materials : mapping of layer to material, optional
        Blocks on other layers take ``block``.
    mend : float or str
        Vertices closer than this to each other or to a side are put together, double vertices and blocks drawn twice
        within it are deleted, and it becomes the gap tolerance of the model [m]. 0 mends nothing.
    close : float or str, optional
        Open polylines whose ends are at most this far apart are closed with a straight side [m]; None takes ``mend``.
    on_fault : {"raise", "skip"}
        Skip leaves out what cannot be used, and leaves overlaps as they are; ``model.generator["faults"]`` tells what.
    unit : str, optional
        Unit of length of the drawing; None takes ``$INSUNITS``.
    chord_tolerance : float or str
        Largest distance of a chord from its arc [m].
    **common
        See :class:`concio.model.generate.arguments.Common`.

    Raises
    ------
    InputError
        The file or an option is not usable.
    GeometryError
        The drawing has faults that would lose or spoil a block, a support or a load; the message lists them.
    """
    where = str(path)
    options = checked(where, common)
    within = not_negative(where, "mend", mend)
    gap = within if close is None else not_negative(where, "close", close)
    if on_fault not in ("raise", "skip"):
        msg = f"on_fault = '{on_fault}' is not one of raise, skip"
        raise InputError(msg, where=where)
    drawing = read_drawing(path, unit=unit, chord_tolerance=chord_tolerance)
    outlines, faults = usable_outlines(drawing, within, gap)
    curved = 2.5 * quantity(chord_tolerance, "length") if any(o.curved for o in outlines) else 0.0
    pieces, obstacles, table = _pieces(outlines, materials or {}, options)
    if not pieces and on_fault == "skip":
        msg = "no usable block is left in the drawing"
        raise GeometryError(msg, where=where, hint="; ".join(f.sentence for f in faults[:3]))
    if pieces:
        size = float(np.ptp(np.concatenate([o.points for o in outlines]), axis=0).max())
        tolerance = max(within, curved, 1e-6 * size)
        supports, loads, lost = _supports_and_loads(drawing, [*pieces, *obstacles], tolerance)
        faults += lost + _overlaps(outlines, obstacles, tolerance)
    serious = [f for f in faults if f.serious and not f.mended]
    if not pieces and not serious:
        msg = "the drawing holds no closed polyline that could be a block"
        raise GeometryError(msg, where=where, hint="draw each block as a closed polyline; see the layers in the manual")
    if serious and on_fault == "raise":
        shown = "\n".join(f"  - {f.sentence}" for f in serious[:12])
        more = f"\n  ... and {len(serious) - 12} more" if len(serious) > 12 else ""
        msg = f"the drawing has {len(serious)} fault{'s' if len(serious) > 1 else ''}\n{shown}{more}\n"
        raise GeometryError(msg, where=where, hint="mend them there, give 'mend' a tolerance, or set on_fault = 'skip'")
    model = assemble(
        options,
        pieces,
        obstacles,
        loads=loads,
        materials=table,
        title=f"drawing {Path(path).name}, {len(pieces)} block{'s' if len(pieces) != 1 else ''}",
        generator={"kind": "dxf", "file": str(path), "faults": tuple(f.sentence for f in faults)},
    )
    return replace(model, supports=tuple(supports), gap_tolerance=tolerance)


def usable_outlines(drawing: Drawing, mend: float = 0.0, close: float = 0.0) -> tuple[list[Outline], list[DxfFault]]:
    """Return the outlines that can be blocks, mended within the tolerances, and all faults, those of reading first.

    Parameters
    ----------
    drawing : Drawing
    mend, close : float
        As in :func:`model_from_dxf` [m].
    """
    faults = list(drawing.faults)

    def note(kind: Any, o: Outline, at: Array, text: str, mended: bool = False) -> None:
        sentence = f"entity {o.handle} on layer '{o.layer}' at ({at[0]:.6g}, {at[1]:.6g}) m: {text}"
        faults.append(DxfFault(kind, o.handle, o.layer, np.asarray(at), sentence, mended=mended))

    closed: list[Outline] = []
    for o in drawing.outlines:
        if o.open_by > close:
            text = f"the polyline is open, its ends are {1e3 * o.open_by:.4g} mm apart"
            note("open", o, o.points[-1], text + " (close it, or give 'close' a length)")
            continue
        if o.open_by:
            note("open", o, o.points[-1], f"open by {1e3 * o.open_by:.4g} mm, closed", mended=True)
        points = o.points
        if mend:
            apart = np.hypot(*(points - np.roll(points, 1, axis=0)).T)
            if (apart <= mend).any():
                for at in points[apart <= mend]:
                    note("outline", o, at, "double vertex, deleted", mended=True)
                points = points[apart > mend]
        closed.append(replace(o, points=points))
    if mend and closed:
        moved = snapped([o.points for o in closed], mend)
        closed = [replace(o, points=p) for o, p in zip(closed, moved, strict=True)]
    result: list[Outline] = []
    for o in closed:
        wrong = polygon_faults(o.points)
        for fault in wrong:
            note("outline", o, fault.at, f"{fault.sentence} ({fault.hint})")
        if not wrong:
            result.append(o)
    return _without_duplicates(result, mend, note), faults


def _without_duplicates(outlines: list[Outline], mend: float, note: Any) -> list[Outline]:
    """Return the outlines without those drawn twice; noted as mended where mending is allowed."""
    shapes = shapely.polygons([shapely.linearrings(o.points) for o in outlines]) if outlines else np.array([])
    drop: set[int] = set()
    if len(outlines) > 1:
        i, j = shapely.STRtree(shapes).query(shapes)
        i, j = i[i < j], j[i < j]
        same = np.abs(shapely.bounds(shapes[i]) - shapely.bounds(shapes[j])).max(1) <= np.maximum(
            mend, 1e-6 * np.sqrt(shapely.area(shapes[i]))
        )
        for p, q in zip(i[same].tolist(), j[same].tolist(), strict=True):
            both = shapes[p].intersection(shapes[q]).area
            if both > 0.99 * max(shapes[p].area, shapes[q].area) and q not in drop:
                drop.add(q)
                text = f"the same block as entity {outlines[p].handle}, drawn twice" + (", deleted" if mend else "")
                at = np.array(shapes[q].centroid.coords[0])
                note("duplicate", outlines[q], at, text + ("" if mend else " (delete one)"), mended=bool(mend))
    return [o for k, o in enumerate(outlines) if k not in drop]


def _pieces(
    outlines: list[Outline], materials: Mapping[str, Elastic | Rigid], options: Checked
) -> tuple[list[Piece], list[Piece], dict[str, Elastic | Rigid]]:
    """Return blocks, fixed bodies and the materials beside "block"."""
    by_layer = {layer.upper(): (layer, material) for layer, material in materials.items()}
    pieces, obstacles, table = [], [], {}
    for o in outlines:
        word = o.layer.upper()
        if word == "CONCIO_FIXED":
            obstacles.append(Piece(o.name, o.points, "obstacle", o.layer))
            continue
        key = "block"
        if word in by_layer:
            key, table[by_layer[word][0]] = by_layer[word][0], by_layer[word][1]
        elif word.startswith("CONCIO_RIGID"):
            key, table["rigid"] = "rigid", Rigid(options.block.unit_weight)
        pieces.append(Piece(o.name, o.points, "block", o.layer, key))
    return pieces, obstacles, table


def _supports_and_loads(
    drawing: Drawing, pieces: list[Piece], tolerance: float
) -> tuple[list[Support], list[Load], list[DxfFault]]:
    """Return supports and loads with the names of the blocks they stand on, and those that stand on none."""
    shapes = shapely.polygons([shapely.linearrings(p.outline) for p in pieces])
    rings = shapely.boundary(shapes)
    free = np.array([p.role != "obstacle" for p in pieces])
    supports, loads, lost = [], [], []

    def blocks_at(edge: Any, inside: bool) -> list[str]:
        if edge[0] == edge[1]:
            near = shapely.distance(shapes if inside else rings, shapely.Point(edge[0])) <= tolerance
            chosen = np.flatnonzero(near & free)[:1] if inside else np.flatnonzero(near & free)
        else:
            line = shapely.LineString(edge)
            common = shapely.length(shapely.intersection(line, shapely.buffer(rings, tolerance)))
            chosen = np.flatnonzero((common > 4 * tolerance) & free)
        return [pieces[k].name for k in chosen]

    def nowhere(handle: str, at: Any, what: str) -> None:
        text = f"entity {handle} at ({at[0]:.6g}, {at[1]:.6g}) m: this {what} lies on no block (move it onto an edge)"
        lost.append(DxfFault("place", handle, "", np.array(at), text))

    for held in drawing.supports:
        names = blocks_at(held.edge, inside=False)
        if not names:
            nowhere(held.handle, held.edge[0], "support")
        for name in names:
            label = f"support {held.handle}" + (f" {name}" if len(names) > 1 else "")
            supports.append(Support(label, name, held.edge, held.directions))
    for load, handle in drawing.loads:
        edge = load.edge if load.edge is not None else (load.at, load.at)
        names = blocks_at(edge, inside=load.kind == "point")
        if names:
            loads.append(replace(load, bodies=tuple(names)))
        else:
            nowhere(handle, edge[0], "load")
    return supports, loads, lost


def _overlaps(outlines: list[Outline], obstacles: list[Piece], tolerance: float) -> list[DxfFault]:
    fixed = {o.name for o in obstacles}
    bodies = [Body(o.name, o.points, kind="fixed" if o.name in fixed else "elastic") for o in outlines]
    found = []
    for overlap in find_overlaps(bodies, tolerance):
        p, q = (outlines[k] for k in overlap.bodies)
        text = f"entities {p.handle} and {q.handle} on layers '{p.layer}' and '{q.layer}': {overlap.sentence}"
        found.append(DxfFault("overlap", p.handle, p.layer, overlap.at, text))
    return found
