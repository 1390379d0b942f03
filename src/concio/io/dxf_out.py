"""Outlines to a DXF drawing: the model as it is, or its deformed shape (needs the ``dxf`` extra).

Every outline becomes a closed LWPOLYLINE on the layer it is given, its name a TEXT at its centroid on the layer
``CONCIO_NAMES``, so that :mod:`concio.model.drawing.dxf` reads the drawing back with its names.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.files import whole_file
from concio.model.model import Body, Model

Array = np.ndarray
UNITS = {
    "mm": (4, 1e-3), "cm": (5, 1e-2), "dm": (14, 0.1), "m": (6, 1.0), "km": (7, 1e3), "in": (1, 0.0254),
    "ft": (2, 0.3048), "yd": (10, 0.9144),
}  # fmt: skip
"""Code of ``$INSUNITS`` and length [m] of each unit."""
FORBIDDEN = re.compile(r"[<>/\\\":;?*|=`,\x00-\x1f]")
"""Characters that names of layers must not hold."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A line, a circle or a text on a layer.

    Parameters
    ----------
    layer : str
    points : (n, 2) array
        Of a line; one point is the centre of a circle, or where a text begins [m].
    closed : bool
    text : str
    size : float
        Radius of a circle, height of a text [m].
    """

    layer: str
    points: Array
    closed: bool = False
    text: str = ""
    size: float = 0.0


def unit_of(model: Model) -> str:
    """Return the unit of the drawing that a model was read from, "m" where there was none."""
    metres = model.generator.get("metres", 1.0)
    return next((name for name, (_, length) in UNITS.items() if length == metres), "m")


def layer_of(model: Model, body: Body) -> str:
    """Return the layer on which a body of a model is drawn so that it reads back as what it is.

    That of the drawing it came from; otherwise one whose name says that it is fixed or rigid, or its own layer or
    material.
    """
    if body.layer and model.generator.get("kind") == "dxf":
        return body.layer
    if body.kind == "fixed":
        return "CONCIO_FIXED"
    name = FORBIDDEN.sub("_", body.layer or body.material or "BLOCKS")
    return f"CONCIO_RIGID_{name}" if body.kind == "rigid" else name


def write_dxf(
    path: str | Path,
    names: Sequence[str],
    outlines: Sequence[Array],
    *,
    layers: Sequence[str] | None = None,
    colours: Mapping[str, int] | None = None,
    unit: str = "m",
    texts: bool = True,
    holes: Sequence[Sequence[Array]] = (),
    more: Sequence[Drawn] = (),
) -> None:
    """Write outlines to a DXF drawing.

    Parameters
    ----------
    path : str or Path
        An existing file is replaced only when the new one is complete.
    names : sequence of str
    outlines : sequence of (n, 2) arrays
        Vertices [m], deformed or not, without the closing repetition.
    layers : sequence of str, optional
        Layer of each outline; "BLOCKS" by default.
    colours : mapping of layer to int, optional
        AutoCAD colour index of layers.
    unit : str
        Unit of the drawing, a key of :data:`UNITS`.
    texts : bool
        Write the names.
    holes : sequence of sequences of (n, 2) arrays, optional
        Holes of each outline [m]; they go on the layer ``CONCIO_HOLES``.
    more : sequence of Drawn
        What else is drawn.

    Raises
    ------
    InputError
        ezdxf is not installed, an unknown unit, or numbers of names, outlines and layers that differ.
    """
    try:
        import ezdxf
        from ezdxf.enums import TextEntityAlignment
    except ImportError:
        msg = "writing DXF needs the package ezdxf, which is not installed"
        raise InputError(msg, hint="pip install ezdxf") from None
    if unit not in UNITS:
        msg = f"unit '{unit}' is not one of {', '.join(UNITS)}"
        raise InputError(msg, where=str(path))
    layers = ["BLOCKS"] * len(names) if layers is None else layers
    if not len(names) == len(outlines) == len(layers):
        msg = f"{len(names)} names, {len(outlines)} outlines and {len(layers)} layers"
        raise InputError(msg, where=str(path), hint="give one of each for every block")
    code, metres = UNITS[unit]
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = code
    rings = [ring for own in holes for ring in own]
    extra = ["CONCIO_NAMES"] * texts + ["CONCIO_HOLES"] * bool(rings) + [one.layer for one in more]
    for layer in dict.fromkeys([*layers, *extra]):
        if layer and layer not in document.layers:
            document.layers.add(layer, color=(colours or {}).get(layer, 7))
    space = document.modelspace()
    for ring in rings:
        corners = np.asarray(ring, dtype=float) / metres
        space.add_lwpolyline(corners.tolist(), close=True, dxfattribs={"layer": "CONCIO_HOLES"})
    for k, (name, outline, layer) in enumerate(zip(names, outlines, layers, strict=True)):
        points = np.asarray(outline, dtype=float) / metres
        space.add_lwpolyline(points.tolist(), close=True, dxfattribs={"layer": layer or "0"})
        if texts:
            height = 0.15 * float(np.ptp(points, axis=0).min())
            text = space.add_text(name, height=max(height, 1e-6), dxfattribs={"layer": "CONCIO_NAMES"})
            inner = [np.asarray(hole, dtype=float) / metres for hole in (holes[k] if holes else ())]
            text.set_placement(_inside(points, inner), align=TextEntityAlignment.LEFT)
    for one in more:
        _draw(space, one, metres)
    with whole_file(Path(path)) as fresh:
        document.saveas(fresh)


def _draw(space: Any, one: Drawn, metres: float) -> None:
    """Draw a line, a circle or a text; ``metres`` is the length of the unit of the drawing [m]."""
    points = (np.asarray(one.points, dtype=float) / metres).tolist()
    own, size = {"layer": one.layer}, one.size / metres
    if one.text:
        space.add_text(one.text, height=max(size, 1e-6), dxfattribs=own).set_placement(points[0])
    elif len(points) == 1:
        space.add_circle(points[0], size, dxfattribs=own)
    else:
        space.add_lwpolyline(points, close=one.closed, dxfattribs=own)


def _inside(points: Array, holes: Sequence[Array]) -> tuple[float, float]:
    """Return a point inside an outline, in none of its holes."""
    import shapely

    found = shapely.Polygon(points, holes).buffer(0).point_on_surface()
    return float(found.x), float(found.y)
