"""Outlines to a DXF drawing: the model as it is, or its deformed shape (needs the ``dxf`` extra).

Every outline becomes a closed LWPOLYLINE on the layer it is given, its name a TEXT at its centroid on the layer
``CONCIO_NAMES``, so that :mod:`concio.model.drawing.dxf` reads the drawing back with its names.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from concio.errors import InputError

Array = np.ndarray
UNITS = {"mm": (4, 1e-3), "cm": (5, 1e-2), "m": (6, 1.0), "in": (1, 0.0254), "ft": (2, 0.3048)}
"""Code of ``$INSUNITS`` and length [m] of each unit."""


def write_dxf(
    path: str | Path,
    names: Sequence[str],
    outlines: Sequence[Array],
    *,
    layers: Sequence[str] | None = None,
    colours: Mapping[str, int] | None = None,
    unit: str = "m",
    texts: bool = True,
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
        Unit of the drawing: "m", "cm", "mm", "in" or "ft".
    texts : bool
        Write the names.

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
    for layer in dict.fromkeys([*layers, *(["CONCIO_NAMES"] if texts else [])]):
        if layer and layer not in document.layers:
            document.layers.add(layer, color=(colours or {}).get(layer, 7))
    space = document.modelspace()
    for name, outline, layer in zip(names, outlines, layers, strict=True):
        points = np.asarray(outline, dtype=float) / metres
        space.add_lwpolyline(points.tolist(), close=True, dxfattribs={"layer": layer or "0"})
        if texts:
            height = 0.15 * float(np.ptp(points, axis=0).min())
            text = space.add_text(name, height=max(height, 1e-6), dxfattribs={"layer": "CONCIO_NAMES"})
            text.set_placement(_inside(points), align=TextEntityAlignment.LEFT)
    path = Path(path)
    unfinished = path.with_name(path.name + ".part")
    try:
        document.saveas(unfinished)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def _inside(points: Array) -> tuple[float, float]:
    """Return a point inside an outline."""
    import shapely

    found = shapely.Polygon(points).buffer(0).point_on_surface()
    return float(found.x), float(found.y)
