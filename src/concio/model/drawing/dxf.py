"""Blocks, supports and loads from a DXF drawing (needs the ``dxf`` extra).

What is read
------------
Closed polylines (LWPOLYLINE and POLYLINE, with bulges), circles, closed ellipses and splines become blocks, also inside
block references (INSERT). ``$INSUNITS`` gives the unit of length. Arcs become chords within a tolerance.

Layers (upper or lower case)
----------------------------
``CONCIO_FIXED``
    Fixed bodies: ground, abutments.
``CONCIO_RIGID``, ``CONCIO_RIGID_<name>``
    Rigid blocks.
``CONCIO_NAMES``
    TEXT or MTEXT whose insertion point lies in a block gives it its name; a block without one is called ``h`` and its
    handle, as in ``h2F``.
``CONCIO_SUPPORT_X``, ``_Y``, ``_XY``
    A LINE along an edge, or a POINT on an outline, holds the block it lies on in these directions.
``CONCIO_LOAD_PRESSURE_<value>_<group>``
    A LINE along edges that are loaded [kN/m2], positive pushes against the edge.
``CONCIO_LOAD_TX_<value>_<group>``, ``..._TY_...``
    The same for a traction along x or y [kN/m2].
``CONCIO_LOAD_FX_<value>_<group>``, ``..._FY_...``
    A POINT on a block on which a force acts [kN]; ``CONCIO_LOAD_FY_-5_LIVE`` is 5 kN downwards.
``CONCIO_IGNORE...``, ``DEFPOINTS``, and layers that are off or frozen
    Left out.
Any other layer
    Blocks; the layer's name is kept, and is the key that gives them a material.

Everything else on such layers (lines, texts, dimensions, hatches) is left out and counted. Every fault names the handle
of its entity and the place.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import shapely

from concio.errors import InputError
from concio.model.drawing.dxf_entities import load_of, outline_of, place_of
from concio.model.model import Array, Load
from concio.units import quantity

UNITS = {1: 0.0254, 2: 0.3048, 4: 1e-3, 5: 1e-2, 6: 1.0, 7: 1e3, 8: 0.0254e-6, 10: 0.9144, 13: 1e-6, 14: 0.1}
"""Metres in one unit of ``$INSUNITS``."""
CHORD_TOLERANCE = 5e-4
"""Largest distance of a chord from its arc where none is given [m]."""

DxfFaultKind = Literal["open", "outline", "duplicate", "overlap", "layer", "place", "ignored"]


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
    """A closed outline of a drawing: handle, layer, name or "", points (n, 2) [m], whether it has arcs or was open."""

    handle: str
    layer: str
    points: Array
    name: str = ""
    curved: bool = False
    open_by: float = 0.0


@dataclass(frozen=True)
class HeldEdge:
    """A support line or point: its ends [m], its directions, its handle."""

    edge: tuple[tuple[float, float], tuple[float, float]]
    directions: str
    handle: str


@dataclass(frozen=True, eq=False)
class Drawing:
    """What a DXF file holds, before it is put together.

    Parameters
    ----------
    outlines : tuple of Outline
        In the order of the file.
    supports : tuple of HeldEdge
    loads : tuple of (Load, str)
        Loads with the handles of their entities.
    faults : tuple of DxfFault
    metres : float
        Length of a drawing unit [m].
    """

    outlines: tuple[Outline, ...]
    supports: tuple[HeldEdge, ...]
    loads: tuple[tuple[Load, str], ...]
    faults: tuple[DxfFault, ...]
    metres: float


def read_drawing(
    path: str | Path, *, unit: str | None = None, chord_tolerance: float | str = CHORD_TOLERANCE
) -> Drawing:
    """Return what a DXF file holds.

    Parameters
    ----------
    path : str or Path
    unit : str, optional
        Unit of length of the drawing, such as "mm"; None takes ``$INSUNITS``.
    chord_tolerance : float or str
        Largest distance of a chord from its arc [m].

    Raises
    ------
    InputError
        ezdxf is not installed, the file is missing or is no DXF, or the drawing has no unit.
    """
    document = _document(Path(path))
    metres = _metres(document, unit, str(path))
    chord = quantity(chord_tolerance, "length", where="chord_tolerance")
    if not 0 < chord < np.inf:
        msg = f"chord_tolerance = {chord:g} must be positive and finite"
        raise InputError(msg, where=str(path))
    outlines: list[Outline] = []
    supports: list[HeldEdge] = []
    loads: list[tuple[Load, str]] = []
    faults: list[DxfFault] = []
    names: list[tuple[str, Array]] = []
    ignored: Counter[tuple[str, str]] = Counter()
    for entity, handle in _entities(document):
        layer, kind = str(entity.dxf.layer), str(entity.dxftype())
        word = layer.upper()
        if _left_out(document, layer):
            continue
        if word == "CONCIO_NAMES" and kind in ("TEXT", "MTEXT"):
            text = entity.plain_text() if hasattr(entity, "plain_text") else entity.dxf.text
            names.append((str(text).strip(), metres * np.array([entity.dxf.insert.x, entity.dxf.insert.y])))
        elif word.startswith(("CONCIO_SUPPORT", "CONCIO_LOAD")):
            place = place_of(entity, metres)
            if place is None:
                faults.append(_fault("place", handle, layer, None, f"{kind} is neither a LINE nor a POINT"))
            elif word.startswith("CONCIO_SUPPORT"):
                directions = word.removeprefix("CONCIO_SUPPORT").strip("_")
                if directions in ("X", "Y", "XY"):
                    supports.append(HeldEdge(place, directions.lower(), handle))
                else:
                    text = "this layer is not CONCIO_SUPPORT_X, _Y or _XY"
                    faults.append(_fault("layer", handle, layer, np.array(place[0]), text))
            else:
                load = load_of(word, place)
                if isinstance(load, Load):
                    loads.append((load, handle))
                else:
                    faults.append(_fault("layer", handle, layer, np.array(place[0]), load))
        else:
            found = outline_of(entity, metres, chord)
            if found is None:
                ignored[layer, kind] += 1
            elif len(found[0]) < 2:
                faults.append(_fault("outline", handle, layer, None, f"{kind} has fewer than two points (delete it)"))
            else:
                points, curved, open_by = found
                outlines.append(Outline(handle, layer, points, "", curved, open_by))
    for (layer, kind), many in ignored.items():
        text = f"{many} {kind} on layer '{layer}' left out: only closed polylines and circles become blocks"
        faults.append(DxfFault("ignored", "", layer, np.full(2, np.nan), text, serious=kind in ("LINE", "ARC")))
    return Drawing(_named(outlines, names, faults), tuple(supports), tuple(loads), tuple(faults), metres)


def _document(path: Path) -> Any:
    try:
        import ezdxf
    except ImportError:
        msg = "reading DXF needs the package ezdxf, which is not installed"
        raise InputError(msg, where=str(path), hint="pip install ezdxf") from None
    if not path.is_file():
        msg = "there is no such file"
        raise InputError(msg, where=str(path))
    try:
        return ezdxf.readfile(path)
    except (OSError, ezdxf.DXFError, UnicodeDecodeError, ValueError) as error:
        msg = f"the file is not a DXF drawing that can be read: {error}"
        raise InputError(msg, where=str(path), hint="save it as DXF (ASCII, 2000 or later) once more") from None


def _metres(document: Any, unit: str | None, where: str) -> float:
    if unit is not None:
        return quantity(f"1 {unit}", "length", where=f"{where}, unit")
    code = int(document.header.get("$INSUNITS", 0))
    if code in UNITS:
        return UNITS[code]
    msg = f"the drawing does not say its unit of length ($INSUNITS = {code})"
    raise InputError(msg, where=where, hint="set the unit in the drawing, or give unit = 'mm' (or 'm', 'cm', 'in')")


def _entities(document: Any) -> Iterator[tuple[Any, str]]:
    """Yield the entities of model space with their handles; block references are taken apart."""
    from ezdxf.disassemble import recursive_decompose

    for entity in document.modelspace():
        handle = str(entity.dxf.handle)
        if entity.dxftype() == "INSERT":
            for k, part in enumerate(recursive_decompose([entity]), 1):
                yield part, f"{handle}.{k}"
        else:
            yield entity, handle


def _left_out(document: Any, layer: str) -> bool:
    word = layer.upper()
    if word == "DEFPOINTS" or word.startswith("CONCIO_IGNORE"):
        return True
    if layer not in document.layers:
        return False
    entry = document.layers.get(layer)
    return bool(entry.is_off() or entry.is_frozen())


def _fault(kind: DxfFaultKind, handle: str, layer: str, at: Array | None, text: str) -> DxfFault:
    place = "" if at is None else f" at ({at[0]:.6g}, {at[1]:.6g}) m"
    where = np.full(2, np.nan) if at is None else at
    return DxfFault(kind, handle, layer, where, f"entity {handle} on layer '{layer}'{place}: {text}")


def _named(
    outlines: Sequence[Outline], names: Sequence[tuple[str, Array]], faults: list[DxfFault]
) -> tuple[Outline, ...]:
    """Return the outlines with the names written in them."""
    chosen: dict[int, str] = {}
    for text, at in names:
        inside = [k for k, o in enumerate(outlines) if len(o.points) > 2 and
                  shapely.Polygon(o.points).buffer(0).contains(shapely.Point(at))]  # fmt: skip
        if not inside:
            faults.append(_fault("place", "", "CONCIO_NAMES", at, f"the name '{text}' stands in no block"))
        for k in inside[:1]:
            chosen[k] = text
    return tuple(
        Outline(o.handle, o.layer, o.points, chosen.get(k, f"h{o.handle}"), o.curved, o.open_by)
        for k, o in enumerate(outlines)
    )
