"""From a DXF drawing to a model: faults judged and repaired, blocks named, supports and loads found on their blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, Unpack

import numpy as np
import shapely

from concio.arguments import strict_with
from concio.errors import GeometryError, InputError
from concio.model.drawing.drawn_places import drawn_ties, supports_and_loads
from concio.model.drawing.dxf import CHORD_TOLERANCE, Drawing, DxfFault, Outline, read_drawing
from concio.model.drawing.holes import with_holes
from concio.model.drawing.layers import Layers
from concio.model.drawing.mend import mended
from concio.model.generate.generator_arguments import Checked, Common, checked, not_negative
from concio.model.generate.masonry import Piece, assemble
from concio.model.interfaces.near import find_overlaps
from concio.model.interfaces.polygon_check import polygon_faults
from concio.model.materials import Elastic, Rigid
from concio.model.model import Array, Body, Model
from concio.model.overlay import common
from concio.units import quantity


@strict_with(Common.__annotations__)
def model_from_dxf(
    path: str | Path,
    *,
    materials: Mapping[str, Elastic | Rigid] | None = None,
    layers: Mapping[str, Any] | None = None,
    mend: float | str = 0.0,
    close: float | str | None = None,
    on_fault: Literal["raise", "skip"] = "raise",
    unit: str | None = None,
    chord_tolerance: float | str = CHORD_TOLERANCE,
    **common: Unpack[Common],
) -> Model:
    """Return the model that a DXF drawing describes; see :mod:`concio.model.drawing.dxf` for what is read.

    Parameters
    ----------
    path : str or Path
    materials : mapping of name to material, optional
        A block takes the one that ``layers`` gives its layer, else the one of its layer's own name, else ``block``.
    layers : mapping of layer to word or table, optional
        What layers mean: "fixed", "ignore", a material, a role, a load...; see :mod:`concio.model.drawing.layers`.
    mend : float or str
        Corners closer than this are moved together or onto the side they nearly touch, double vertices and blocks
        drawn twice within it are deleted, and it becomes the gap tolerance of the model [m]. 0 mends nothing.
    close : float or str, optional
        Open polylines whose ends are at most this far apart are closed with a straight side [m]; None takes ``mend``.
    on_fault : {"raise", "skip"}
        Skip leaves out what cannot be used, and leaves overlaps as they are.
    unit : str, optional
        Unit of length of the drawing; None takes ``$INSUNITS``.
    chord_tolerance : float or str
        Largest distance of a chord from its arc [m].
    **common
        See :class:`concio.model.generate.generator_arguments.Common`.

    Raises
    ------
    InputError
        The file or an option is not usable.
    GeometryError
        The drawing has faults that would lose or spoil a block, a support, a load or a tie; the message lists them.

    Notes
    -----
    ``model.generator`` keeps what was found: ``faults`` (repaired or skipped), ``moved`` (every corner that mending
    moved), ``left_out`` (what was ignored as asked), ``metres`` (a drawing unit).

    Examples
    --------
    Two blocks of 0.6 by 0.3 m on the ground, drawn in mm:

    >>> import concio
    >>> import ezdxf
    >>> import tempfile
    >>> from pathlib import Path
    >>> drawing = ezdxf.new()
    >>> drawing.header["$INSUNITS"] = 4
    >>> sheet = drawing.modelspace()
    >>> for layer, y in (("ground", 0), ("stone", 300), ("stone", 600)):
    ...     corners = [(0, y), (600, y), (600, y + 300), (0, y + 300)]
    ...     line = sheet.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     drawing.saveas(Path(folder) / "pillar.dxf")
    ...     model = concio.model_from_dxf(Path(folder) / "pillar.dxf", layers={"ground": "fixed"})
    >>> [round(body.area, 6) for body in model.free_bodies]
    [0.18, 0.18]
    """
    where = str(path)
    options = checked(where, common)
    within = not_negative(where, "mend", mend)
    gap = within if close is None else not_negative(where, "close", close)
    if on_fault not in ("raise", "skip"):
        msg = f"on_fault = '{on_fault}' is not one of raise, skip"
        raise InputError(msg, where=where)
    uses = Layers(layers, list(materials or {}))
    drawing = read_drawing(path, unit=unit, chord_tolerance=chord_tolerance, layers=uses)
    outlines, faults, moved = usable_outlines(drawing, within, gap, where)
    curved = 2.5 * quantity(chord_tolerance, "length") if any(o.curved for o in outlines) else 0.0
    pieces, obstacles, table = _pieces(outlines, materials or {}, options)
    if not pieces and on_fault == "skip":
        msg = "no usable block is left in the drawing"
        raise GeometryError(msg, where=where, hint="; ".join(f.sentence for f in faults[:3]))
    if pieces:
        size = float(np.ptp(np.concatenate([o.points for o in outlines]), axis=0).max())
        tolerance = max(within, curved, 1e-6 * size)
        supports, loads, lost = supports_and_loads(drawing, pieces, tolerance)
        ties, untied = drawn_ties(drawing, pieces, tolerance)
        faults += lost + untied + _overlaps(outlines, obstacles, tolerance)
    serious = [f for f in faults if f.serious and not f.mended]
    if not pieces and not serious:
        msg = "the drawing holds no closed polyline that could be a block"
        raise GeometryError(msg, where=where, hint="draw each block as a closed polyline; see the layers in the manual")
    if serious and on_fault == "raise":
        shown = "\n".join(f"  - {f.sentence}" for f in serious[:12])
        more = f"\n  ... and {len(serious) - 12} more" if len(serious) > 12 else ""
        msg = f"the drawing has {len(serious)} fault{'s' if len(serious) > 1 else ''}\n{shown}{more}\n"
        raise GeometryError(msg, where=where, hint="mend them there, give 'mend' a tolerance, or set on_fault = 'skip'")
    record = {
        "kind": "dxf", "file": str(path), "metres": drawing.metres, "faults": tuple(f.sentence for f in faults),
        "left_out": drawing.left_out, "moved": moved,
    }  # fmt: skip
    title = f"drawing {Path(path).name}, {len(pieces)} block{'s' if len(pieces) != 1 else ''}"
    model = assemble(options, pieces, obstacles, loads=loads, materials=table, title=title, generator=record)
    return replace(model, supports=tuple(supports), ties=tuple(ties), gap_tolerance=tolerance)


def usable_outlines(
    drawing: Drawing, mend: float = 0.0, close: float = 0.0, where: str = "drawing"
) -> tuple[list[Outline], list[DxfFault], tuple[str, ...]]:
    """Return the outlines that can be blocks, repaired within the tolerances, all faults, and the corners moved.

    Parameters
    ----------
    drawing : Drawing
    mend, close : float
        As in :func:`model_from_dxf` [m].
    where : str
        The drawing, for messages.

    Raises
    ------
    InputError
        Mending would remove half of the blocks.
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
        closed.append(o)
    closed = _wider(closed, mend, note, where)
    moved: list[str] = []
    if mend:
        singled = []
        for o in closed:
            apart = np.hypot(*(o.points - np.roll(o.points, 1, axis=0)).T)
            for at in o.points[apart <= mend]:
                note("outline", o, at, "double vertex, deleted", mended=True)
            singled.append(replace(o, points=o.points[apart > mend]))
        single = _without_duplicates(singled, mend, note)
        points, moves = mended([o.points for o in single], mend)
        closed = [replace(o, points=p) for o, p in zip(single, points, strict=True)]
        for m in moves:
            o, a, b = closed[m.outline], m.start, m.end
            moved.append(
                f"entity {o.handle} on layer '{o.layer}': corner ({a[0]:.6g}, {a[1]:.6g}) m moved by "
                f"{1e3 * m.length:.3g} mm to ({b[0]:.6g}, {b[1]:.6g}) m"
            )
    result: list[Outline] = []
    for o in closed:
        wrong = polygon_faults(o.points)
        for fault in wrong:
            note("outline", o, fault.at, f"{fault.sentence} ({fault.hint})")
        if not wrong:
            result.append(o)
    whole = result if mend else _without_duplicates(result, mend, note)
    return with_holes(whole, note), faults, tuple(moved)


def _wider(outlines: list[Outline], mend: float, note: Any, where: str) -> list[Outline]:
    """Return the outlines that mending does not remove, the others noted."""
    if not mend:
        return outlines
    kept: list[tuple[float, Outline]] = []
    lost: list[tuple[float, Outline]] = []
    for o in outlines:
        shape = shapely.Polygon(o.points) if len(o.points) > 2 else shapely.Polygon()
        width = 2 * abs(shape.area) / shape.length if shape.length else 0.0
        (lost if width <= 2 * mend else kept).append((width, o))
    if len(lost) > len(kept):
        width, o = min(lost, key=lambda found: found[0])
        msg = f"mend = {mend:g} m would remove {len(lost)} of {len(outlines)} outlines"
        at = o.points[0]
        hint = f"the thinnest, entity {o.handle} at ({at[0]:.6g}, {at[1]:.6g}) m, is about {1e3 * width:.3g} mm wide"
        raise InputError(msg, where=where, hint=hint)
    for width, o in lost:
        text = f"this outline is only about {1e3 * width:.3g} mm wide, and mend = {1e3 * mend:.3g} mm would remove it"
        note("thin", o, o.points[0], text + " (delete it, or give 'mend' a smaller length)")
    return [o for _, o in kept]


def _without_duplicates(outlines: list[Outline], mend: float, note: Any) -> list[Outline]:
    """Return the outlines without those drawn twice; noted as repaired where mending is allowed."""
    shapes = shapely.polygons([shapely.linearrings(o.points) for o in outlines]) if outlines else np.array([])
    drop: set[int] = set()
    if len(outlines) > 1:
        i, j = shapely.STRtree(shapes).query(shapes)
        i, j = i[i < j], j[i < j]
        same = np.abs(shapely.bounds(shapes[i]) - shapely.bounds(shapes[j])).max(1) <= np.maximum(
            mend, 1e-6 * np.sqrt(shapely.area(shapes[i]))
        )
        for p, q in zip(i[same].tolist(), j[same].tolist(), strict=True):
            both = float(shapely.area(common(shapes[[p]], shapes[q]))[0])
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
    by_layer = {layer.upper(): layer for layer in materials}
    pieces, obstacles, table = [], [], {}
    for o in outlines:
        use = o.use
        if use.use == "fixed":
            role = use.role or "obstacle"
            obstacles.append(Piece(o.name, o.points, role, o.layer, "", use.thickness, _rings(o)))
            continue
        key = use.material or by_layer.get(o.layer.upper(), "block")
        if key in materials:
            table[key] = materials[key]
        elif use.use == "rigid":
            key, table["rigid"] = "rigid", Rigid(options.block.unit_weight)
        pieces.append(Piece(o.name, o.points, use.role or "block", o.layer, key, use.thickness, _rings(o)))
    return pieces, obstacles, table


def _rings(outline: Outline) -> tuple[Array, ...]:
    return tuple(hole.points for hole in outline.holes)


def _overlaps(outlines: list[Outline], obstacles: list[Piece], tolerance: float) -> list[DxfFault]:
    fixed = {o.name for o in obstacles}
    bodies = [
        Body(o.name, o.points, kind="fixed" if o.name in fixed else "elastic", holes=_rings(o)) for o in outlines
    ]
    found = []
    for overlap in find_overlaps(bodies, tolerance):
        p, q = (outlines[k] for k in overlap.bodies)
        text = f"entities {p.handle} and {q.handle} on layers '{p.layer}' and '{q.layer}': {overlap.sentence}"
        if min(bodies[k].area for k in overlap.bodies) < 1.001 * overlap.area:
            text += "; is one a hole in the other? its layer can be given the meaning 'hole' in [drawing.layers]"
        found.append(DxfFault("overlap", p.handle, p.layer, overlap.at, text))
    return found
