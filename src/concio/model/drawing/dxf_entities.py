"""Entities of a DXF file as plain values: points with bulges, texts, layers, block references taken apart.

Whatever a damaged file makes ezdxf raise ends here, as a message or as the fault of one entity.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.files import check_regular
from concio.model.model import Array
from concio.units import quantity

DEEPEST = 16
"""Blocks within blocks within blocks are followed so far: deeper ones hold themselves."""
LARGEST = 1_000_000
"""A drawing of more entities, block references taken apart, is refused."""
FINEST = 1e-9
"""Chords keep no closer to a curve than this share of its size."""
UNITS = {1: 0.0254, 2: 0.3048, 4: 1e-3, 5: 1e-2, 6: 1.0, 7: 1e3, 8: 0.0254e-6, 10: 0.9144, 13: 1e-6, 14: 0.1}
"""Metres in one unit of ``$INSUNITS``."""
FLATTEST = 1e-6
"""Extrusions may lean out of the direction across the drawing by this."""
DAMAGED = (
    OSError, ValueError, TypeError, AttributeError, LookupError, ArithmeticError, RecursionError, AssertionError,
    StopIteration, RuntimeError, MemoryError,
)  # fmt: skip
"""What ezdxf raises for files whose tags are damaged, beside its own errors."""


@dataclass(frozen=True, eq=False)
class Entity:
    """An entity of a drawing.

    Parameters
    ----------
    kind : str
        Its DXF type.
    layer, handle : str
    points : (n, 2) array
        Vertices, ends, or the place of a text [m]; none for entities that are not read.
    bulges : (n,) array
        Tangent of a quarter of the angle of the arc from each vertex to the next, positive counter-clockwise.
    closed : bool
    smooth : bool
        True where the points stand for a curve.
    text : str
    fault : str
        Why it cannot be read, else "".
    """

    kind: str
    layer: str
    handle: str
    points: Array
    bulges: Array
    closed: bool = False
    smooth: bool = False
    text: str = ""
    fault: str = ""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A drawing as read: metres in a drawing unit, names of its layers, those off or frozen (upper case), entities."""

    metres: float
    layers: tuple[str, ...]
    hidden: frozenset[str]
    entities: tuple[Entity, ...]


def read_sheet(path: Path, unit: str | None, chord: float, *, open_curves: bool = False) -> Sheet:
    """Return what stands in the model space of a DXF file, in metres.

    Parameters
    ----------
    path : Path
    unit : str or None
        Unit of length of the drawing; None takes ``$INSUNITS``.
    chord : float
        Largest distance of a chord from the ellipse or spline it stands for [m].
    open_curves : bool
        Whether arcs and open ellipses and splines are read, which bound no block.

    Raises
    ------
    InputError
        ezdxf is not installed, the file is missing, no DXF or damaged, has no unit, or holds too many entities.
    """
    try:
        import ezdxf
    except ImportError:
        msg = "reading DXF needs the package ezdxf, which is not installed"
        raise InputError(msg, where=str(path), hint="pip install ezdxf") from None
    given = None if unit is None else quantity(f"1 {unit}", "length", where=f"{path}, unit")
    check_regular(path)
    hint = "save it as DXF (ASCII, 2000 or later) once more"
    try:
        with path.open("rb") as file:
            if file.read(4) == b"AC10":
                msg = "this is a DWG drawing, not a DXF one"
                raise InputError(msg, where=str(path), hint=hint)
        document = ezdxf.readfile(path)
        metres = _metres(document, str(path)) if given is None else given
        layers = [str(layer.dxf.name) for layer in document.layers]
        hidden = frozenset(str(x.dxf.name).upper() for x in document.layers if x.is_off() or x.is_frozen())
        entities = tuple(_entities(document, metres, chord, str(path), open_curves))
    except ezdxf.DXFError as error:
        raise _unreadable(error, path, hint) from None
    except InputError:
        raise
    except DAMAGED as error:
        raise _unreadable(error, path, hint) from None
    layers += [entity.layer for entity in entities]
    return Sheet(metres, tuple(dict.fromkeys(layers)), hidden, entities)


def _metres(document: Any, where: str) -> float:
    code = int(document.header.get("$INSUNITS", 0))
    if code in UNITS:
        return UNITS[code]
    msg = f"the drawing does not say its unit of length ($INSUNITS = {code})"
    raise InputError(msg, where=where, hint="set the unit in the drawing, or give unit = 'mm' (or 'm', 'cm', 'in')")


def _unreadable(error: Exception, path: Path, hint: str) -> InputError:
    said = " ".join(str(error).split())[:200]
    what = "the file is not a DXF drawing that can be read" + (f": {said}" if said else "")
    return InputError(what, where=str(path), hint=hint)


def _entities(document: Any, metres: float, chord: float, where: str, curves: bool) -> Iterator[Entity]:
    seen = 0
    for entity in document.modelspace():
        for part, handle, layer in _parts(entity, str(entity.dxf.get("handle", "?")), "0", 0):
            seen += 1
            if seen > LARGEST:
                msg = f"the drawing holds more than {LARGEST:,} entities"
                raise InputError(msg, where=where, hint="draw the structure in a file of its own")
            yield part if isinstance(part, Entity) else _plain(part, handle, layer, metres, chord, curves)


def _parts(entity: Any, handle: str, outer: str, depth: int) -> Iterator[tuple[Any, str, str]]:
    """Yield an entity with its handle and layer, or what a block reference stands for.

    What lies on layer 0 in a block lies on the layer of the reference.
    """
    layer = str(entity.dxf.get("layer", "0"))
    layer = outer if layer == "0" else layer
    kind = str(entity.dxftype())
    if kind != "INSERT":
        yield entity, handle, layer
        return
    copies = int(entity.mcount)
    if depth >= DEEPEST or not 0 <= copies <= LARGEST:
        text = "holds itself" if depth >= DEEPEST else f"stands for {copies:,} copies"
        yield _left(kind, layer, handle, f"the block '{entity.dxf.get('name', '')}' {text}"), handle, layer
        return
    k = 0
    for one in entity.multi_insert() if copies > 1 else (entity,):
        for part in one.virtual_entities():
            k += 1
            yield from _parts(part, f"{handle}.{k}", layer, depth + 1)


def _left(kind: str, layer: str, handle: str, fault: str = "") -> Entity:
    return Entity(kind, layer, handle, np.zeros((0, 2)), np.zeros(0), fault=fault)


def _plain(entity: Any, handle: str, layer: str, metres: float, chord: float, curves: bool) -> Entity:
    """Return one entity as plain values, in metres."""
    kind = str(entity.dxftype())
    try:
        curve = _open_curve(entity, kind, chord / metres) if curves else None
        read = curve or _read(entity, kind, chord / metres)
    except DAMAGED as error:
        return _left(kind, layer, handle, f"it cannot be read ({type(error).__name__})")
    if isinstance(read, str):
        return _left(kind, layer, handle, read)
    if read is None:
        return _left(kind, layer, handle)
    points, bulges, closed, smooth, text = read
    if len(points) and not np.isfinite(points).all():
        return _left(kind, layer, handle, "a coordinate is not finite")
    if len(points) and np.abs(points).max() > 1e15:
        return _left(kind, layer, handle, f"a coordinate is {np.abs(points).max():.3g}, far out of any drawing")
    if len(points) != len(bulges) or not np.isfinite(bulges).all():
        return _left(kind, layer, handle, "its arcs are not usable")
    return Entity(kind, layer, handle, metres * points, bulges, closed, smooth, text)


def _read(entity: Any, kind: str, chord: float) -> tuple[Array, Array, bool, bool, str] | str | None:
    """Return points, bulges, whether it is closed, whether it is a curve, and a text; a fault; None if not read."""
    if kind == "LINE":
        return _flat([entity.dxf.start, entity.dxf.end]), np.zeros(2), False, False, ""
    if kind == "POINT":
        return _flat([entity.dxf.location]), np.zeros(1), False, False, ""
    if kind == "MTEXT":
        return _flat([entity.dxf.insert]), np.zeros(1), False, False, str(entity.plain_text())
    if kind == "TEXT":
        _, at, end = entity.get_placement()
        middle = at if end is None else (at + end) / 2
        return _flat([entity.ocs().to_wcs(middle)]), np.zeros(1), False, False, str(entity.plain_text())
    if kind in ("LWPOLYLINE", "POLYLINE", "CIRCLE"):
        tilt = entity.dxf.get("extrusion", (0, 0, 1))
        if abs(abs(float(tilt[2])) - 1) > FLATTEST and not (kind == "POLYLINE" and entity.is_3d_polyline):
            return "it is not drawn in the plane of the drawing"
        turn = -1.0 if float(tilt[2]) < 0 else 1.0
    if kind == "LWPOLYLINE":
        bulges = turn * np.array([b for (b,) in entity.get_points("b")], dtype=float)
        return _flat(entity.vertices_in_wcs()), bulges, bool(entity.closed), False, ""
    if kind == "POLYLINE":
        if not (entity.is_2d_polyline or entity.is_3d_polyline):
            return None
        bulges = turn * np.array([float(v.dxf.get("bulge", 0.0)) for v in entity.vertices])
        return _flat(entity.points_in_wcs()), bulges, bool(entity.is_closed), False, ""
    if kind == "CIRCLE":
        centre, radius = entity.ocs().to_wcs(entity.dxf.center), float(entity.dxf.radius)
        ends = [(centre.x + radius, centre.y), (centre.x - radius, centre.y)]
        return np.array(ends), np.ones(2), True, False, ""
    if kind in ("ELLIPSE", "SPLINE"):
        from ezdxf.path import make_path

        path = make_path(entity)
        if not path.is_closed:
            return None
        extent = float(np.ptp(_flat(path.control_vertices()), axis=0).max())
        flat = _flat(path.flattening(max(chord, FINEST * extent)))[:-1]
        return flat, np.zeros(len(flat)), True, True, ""
    return None


def _open_curve(entity: Any, kind: str, chord: float) -> tuple[Array, Array, bool, bool, str] | None:
    """Return an arc, or an open ellipse or spline, as :func:`_read` returns others; None where it is none."""
    if kind not in ("ARC", "ELLIPSE", "SPLINE"):
        return None
    from ezdxf.path import make_path

    path = make_path(entity)
    if path.is_closed:
        return None
    flat = _flat(path.flattening(chord))
    return flat, np.zeros(len(flat)), False, True, ""


def _flat(vertices: Any) -> Array:
    return np.array([(float(v[0]), float(v[1])) for v in vertices], dtype=float).reshape(-1, 2)
