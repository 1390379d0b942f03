"""Blocks, supports and loads from a DXF drawing (needs the ``dxf`` extra).

What is read
------------
Closed polylines (LWPOLYLINE and POLYLINE, with bulges), circles, closed ellipses and splines become blocks, also inside
block references (INSERT). ``$INSUNITS`` gives the unit of length. Arcs become chords within a tolerance that keep the
area under the arc.

Layers (upper or lower case)
----------------------------
What a layer means is said in a table (:mod:`concio.model.drawing.layers`), or by its name:

``CONCIO_FIXED``
    Fixed bodies: ground, abutments.
``CONCIO_RIGID``, ``CONCIO_RIGID_<name>``
    Rigid blocks.
``CONCIO_HOLE``, ``CONCIO_HOLES``
    Holes in the blocks they lie in.
``CONCIO_NAMES``
    TEXT or MTEXT that stands in a block gives it its name; a block without one is called ``h`` and its handle, as in
    ``h2F``. So does a text on a layer of blocks, if it is the only one in its block and no other block has the same.
``CONCIO_SUPPORT_X``, ``_Y``, ``_XY``
    A LINE or polyline along edges, or a POINT on an outline, holds the block it lies on in these directions.
``CONCIO_LOAD_PRESSURE_<value>_<group>``
    A LINE or polyline along edges that are loaded [kN/m2], positive pushes against the edge.
``CONCIO_LOAD_TX_<value>_<group>``, ``..._TY_...``
    The same for a traction along x or y [kN/m2].
``CONCIO_LOAD_FX_<value>_<group>``, ``..._FY_...``
    A POINT on a block on which a force acts [kN]; ``CONCIO_LOAD_FY_-5_LIVE`` is 5 kN downwards.
``CONCIO_IGNORE...``, ``CONCIO_RESULT...``, ``DEFPOINTS``, and layers that are off or frozen
    Left out, and counted.
Any other layer
    Blocks; the layer's name is kept, and is the key that gives them a material.

Everything that is not a closed outline on a layer of blocks is left out and counted: other texts, dimensions, hatches.
A LINE or an ARC there is a fault, since blocks may have been drawn with single lines; a layer that is ignored may hold
any. Every fault names the handle of its entity and the place.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
import shapely

from concio.errors import InputError
from concio.model.arcs import with_arcs
from concio.model.drawing.dxf_entities import Entity, read_sheet
from concio.model.drawing.layers import Layers, LayerUse
from concio.model.model import Array, Load, Point
from concio.units import quantity

CHORD_TOLERANCE = 5e-4
"""Largest distance of a chord from its arc where none is given [m]."""

DxfFaultKind = Literal["open", "outline", "duplicate", "overlap", "layer", "place", "ignored", "thin", "hole"]
Edge = tuple[Point, Point]


@dataclass(frozen=True, eq=False)
class DxfFault:
    """Something in a drawing that is not a block as it stands.

    Parameters
    ----------
    kind : str
    handle : str
        Handle of the entity; "" for a note on several.
    layer : str
    at : (2,) array
        Where [m].
    sentence : str
        What was found, where, and what to do.
    serious : bool
        True where a block, load or support would be lost or wrong.
    mended : bool
        True where the reader put it right.
    """

    kind: DxfFaultKind
    handle: str
    layer: str
    at: Array
    sentence: str
    serious: bool = True
    mended: bool = False


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed outline of a drawing.

    Parameters
    ----------
    handle, layer : str
    points : (n, 2) array
        [m].
    name : str
        As written in it, or ``h`` and its handle.
    curved : bool
        Whether it has arcs.
    open_by : float
        Distance between its ends where it was not closed [m].
    use : LayerUse
    holes : tuple of Outline
        Outlines of the holes in it.
    """

    handle: str
    layer: str
    points: Array
    name: str = ""
    curved: bool = False
    open_by: float = 0.0
    use: LayerUse = field(default_factory=LayerUse)
    holes: tuple[Outline, ...] = ()


@dataclass(frozen=True)
class HeldEdge:
    """A support line or point: its ends [m], its directions, its handle, its load group."""

    edge: Edge
    directions: str
    handle: str
    group: str = "settlement"


@dataclass(frozen=True)
class DrawnTie:
    """A line that is a tie: its ends [m], its numbers, its handle."""

    edge: Edge
    numbers: Mapping[str, float]
    handle: str


@dataclass(frozen=True, eq=False)
class Drawing:
    """What a DXF file holds, before it is put together.

    Parameters
    ----------
    outlines : tuple of Outline
        In the order of the file; those of holes among them.
    supports : tuple of HeldEdge
    loads : tuple of (Load, str)
        Loads with the handles of their entities.
    faults : tuple of DxfFault
    metres : float
        Length of a drawing unit [m].
    left_out : tuple of str
        What was left out as asked, in sentences.
    ties : tuple of DrawnTie
    """

    outlines: tuple[Outline, ...]
    supports: tuple[HeldEdge, ...]
    loads: tuple[tuple[Load, str], ...]
    faults: tuple[DxfFault, ...]
    metres: float
    left_out: tuple[str, ...] = ()
    ties: tuple[DrawnTie, ...] = ()


def read_drawing(
    path: str | Path,
    *,
    unit: str | None = None,
    chord_tolerance: float | str = CHORD_TOLERANCE,
    layers: Layers | None = None,
) -> Drawing:
    """Return what a DXF file holds.

    Parameters
    ----------
    path : str or Path
    unit : str, optional
        Unit of length of the drawing, such as "mm"; None takes ``$INSUNITS``.
    chord_tolerance : float or str
        Largest distance of a chord from its arc [m].
    layers : Layers, optional
        What layers mean whose names do not say it.

    Raises
    ------
    InputError
        ezdxf is not installed, the file is missing or is not a DXF, the drawing has no unit, or a layer that is given a
        meaning is not in it.
    """
    chord = quantity(chord_tolerance, "length", where="chord_tolerance")
    if not 0 < chord < np.inf:
        msg = f"chord_tolerance = {chord:g} must be positive and finite"
        raise InputError(msg, where=str(path))
    sheet = read_sheet(Path(path), unit, chord)
    layers = Layers() if layers is None else layers
    left_out = layers.check_used(sheet.layers, str(path))
    uses = {layer: layers.of(layer) for layer in sheet.layers}
    outlines: list[Outline] = []
    supports: list[HeldEdge] = []
    loads: list[tuple[Load, str]] = []
    faults: list[DxfFault] = []
    names: list[tuple[str, Array]] = []
    written: list[tuple[str, Entity]] = []
    ties: list[DrawnTie] = []
    ignored: dict[tuple[str, str], Counter[str]] = {}
    lost: Counter[tuple[str, str]] = Counter()
    for e in sheet.entities:
        use = uses[e.layer]
        hidden = e.layer.upper() in sheet.hidden
        if hidden or (isinstance(use, LayerUse) and use.use == "ignore"):
            ignored.setdefault((e.layer, "off or frozen" if hidden else "ignored"), Counter())[e.kind] += 1
        elif e.fault:
            faults.append(_fault("outline", e, f"{e.fault} (draw it again, or delete it)"))
        elif isinstance(use, str):
            faults.append(_fault("layer", e, use))
        elif use.use == "names":
            if e.kind in ("TEXT", "MTEXT") and e.text.strip():
                names.append((" ".join(e.text.split()), e.points[0]))
            else:
                lost[e.layer, e.kind] += 1
        elif use.use == "support":
            edges = _edges(e)
            if not edges:
                faults.append(_fault("place", e, f"{e.kind} is neither a LINE nor a POINT"))
            supports += [HeldEdge(edge, use.directions, e.handle, use.group) for edge in edges]
        elif use.tie is not None:
            edges = _edges(e)
            if not edges or edges[0][0] == edges[0][1]:
                faults.append(_fault("place", e, f"a tie takes a LINE, not {e.kind}"))
                continue
            ties += [DrawnTie(edge, use.tie, e.handle) for edge in edges]
        elif use.load is not None:
            edges = _edges(e)
            point = use.load.kind == "point"
            if not edges or (edges[0][0] == edges[0][1]) != point:
                wanted = f"a {use.load.kind} load takes {'a POINT' if point else 'a LINE'}, not {e.kind}"
                faults.append(_fault("place", e, wanted))
                continue
            loads += [(replace(use.load, **{"at": a} if point else {"edge": (a, b)}), e.handle) for a, b in edges]
        elif e.kind in ("TEXT", "MTEXT") and e.text.strip():
            written.append((" ".join(e.text.split()), e))
        else:
            found = outline_of(e, chord)
            if found is None:
                lost[e.layer, e.kind] += 1
            elif isinstance(found, str):
                faults.append(_fault("outline", e, found))
            else:
                outlines.append(replace(found, use=use))
    for (layer, why), kinds in ignored.items():
        what = ", ".join(f"{many:,} {kind}" for kind, many in kinds.items())
        left_out.append(f"{what} on layer '{layer}', which is {why}")
    names += _names_in_blocks(outlines, names, written, lost)
    for (layer, kind), many in lost.items():
        text = f"{many} {kind} on layer '{layer}' left out: only closed polylines and circles become blocks"
        serious = kind in ("LINE", "ARC")
        if serious:
            text += f" (draw blocks as closed polylines, or write {layer} = 'ignore' in [drawing.layers])"
        faults.append(DxfFault("ignored", "", layer, np.full(2, np.nan), text, serious=serious))
    named = _named(outlines, names, faults)
    return Drawing(named, tuple(supports), tuple(loads), tuple(faults), sheet.metres, tuple(left_out), tuple(ties))


def outline_of(entity: Entity, chord: float) -> Outline | str | None:
    """Return the outline an entity draws, a sentence on its fault, or None where it is not an outline.

    Parameters
    ----------
    entity : Entity
    chord : float
        Largest distance of a chord from its arc [m].
    """
    if entity.kind not in ("LWPOLYLINE", "POLYLINE", "CIRCLE", "ELLIPSE", "SPLINE") or not len(entity.points):
        return None
    points, bulges = entity.points, entity.bulges.copy()
    if len(points) < 2:
        return f"{entity.kind} has fewer than two points (delete it)"
    size = float(np.ptp(points, axis=0).max())
    apart = float(np.hypot(*(points[-1] - points[0])))
    open_by = 0.0 if entity.closed else apart
    if apart <= 1e-9 * size:
        points, bulges, open_by = points[:-1], bulges[:-1], 0.0
    if open_by:
        bulges[-1] = 0.0
    try:
        drawn = with_arcs(points, bulges, chord)
    except InputError as error:
        return str(error)
    return Outline(entity.handle, entity.layer, drawn, "", bool(bulges.any()) or entity.smooth, open_by)


def _edges(entity: Entity) -> list[Edge]:
    """Return the straight edges of a LINE or polyline, or the place of a POINT twice [m]."""
    if entity.kind not in ("LINE", "POINT", "LWPOLYLINE", "POLYLINE") or entity.bulges.any():
        return []
    places = [(float(x), float(y)) for x, y in entity.points]
    if entity.kind == "POINT":
        return [(places[0], places[0])]
    ends = [*places[1:], *(places[:1] if entity.closed else ())]
    return [(a, b) for a, b in zip(places, ends, strict=False) if a != b]


def _fault(kind: DxfFaultKind, entity: Entity, text: str) -> DxfFault:
    at = entity.points[0] if len(entity.points) else np.full(2, np.nan)
    place = f" at ({at[0]:.6g}, {at[1]:.6g}) m" if len(entity.points) else ""
    sentence = f"entity {entity.handle} on layer '{entity.layer}'{place}: {text}"
    return DxfFault(kind, entity.handle, entity.layer, at, sentence)


def _names_in_blocks(
    outlines: Sequence[Outline],
    names: Sequence[tuple[str, Array]],
    written: Sequence[tuple[str, Entity]],
    lost: Counter[tuple[str, str]],
) -> list[tuple[str, Array]]:
    """Return texts on the layers of blocks that name their block: the only text in it, and in no other block.

    Blocks that a text of a layer of names stands in have that name. All other texts are lost: notes, and words that
    many blocks have, such as their material.
    """
    shapes = [shapely.Polygon(o.points).buffer(0) if len(o.points) > 2 else shapely.Polygon() for o in outlines]
    tree = shapely.STRtree(shapes)

    def inside(at: Array) -> int | None:
        own = [int(k) for k in tree.query(shapely.Point(at), predicate="within") if outlines[k].use.use != "hole"]
        return min(own, key=lambda k: shapes[k].area) if own else None

    taken = {inside(at) for _, at in names}
    blocks = [inside(e.points[0]) for _, e in written]
    texts, of_block = Counter(text for text, _ in written), Counter(blocks)
    found = []
    for (text, e), block in zip(written, blocks, strict=True):
        if block is None or block in taken or of_block[block] > 1 or texts[text] > 1:
            lost[e.layer, e.kind] += 1
        else:
            found.append((text, e.points[0]))
    return found


def _named(
    outlines: Sequence[Outline], names: Sequence[tuple[str, Array]], faults: list[DxfFault]
) -> tuple[Outline, ...]:
    """Return the outlines with the names written in them; a name stands in the smallest block around it."""
    areas = np.array([0.0 if len(o.points) < 3 else shapely.Polygon(o.points).buffer(0).area for o in outlines])
    shapes = [shapely.Polygon(o.points).buffer(0) if len(o.points) > 2 else shapely.Polygon() for o in outlines]
    tree = shapely.STRtree(shapes)
    chosen: dict[int, str] = {}
    for text, at in names:
        inside = [int(k) for k in tree.query(shapely.Point(at), predicate="within") if outlines[k].use.use != "hole"]
        if not inside:
            sentence = f"the name '{text}' at ({at[0]:.6g}, {at[1]:.6g}) m stands in no block"
            faults.append(DxfFault("place", "", "", at, sentence))
            continue
        chosen[min(inside, key=lambda k: areas[k])] = text
    return tuple(replace(o, name=chosen.get(k, f"h{o.handle}")) for k, o in enumerate(outlines))
