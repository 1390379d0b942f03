"""Lines of an existing bridge from a DXF drawing: intrados, lines between rings, extrados, road; a layer for each.

Each layer holds one line: a polyline, an arc, an ellipse, a spline, or pieces of these that follow each other. Lines
run from left to right, and the left end of the first is put at (0, 0).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from concio.arguments import closest
from concio.errors import InputError
from concio.model.arcs import with_arcs
from concio.model.drawing.dxf_entities import Entity, Sheet, read_sheet

Array = np.ndarray

JOINED = 1e-3
"""Ends of pieces within this share of the width of the line are one point."""


def read_lines(path: Path, layers: Sequence[str], *, unit: str | None, chord: float) -> dict[str, list[list[float]]]:
    """Return the line of each layer as points [x, y] [m].

    Parameters
    ----------
    path : Path
    layers : sequence of str
        The first is the intrados.
    unit : str or None
        Unit of length of the drawing; None takes what the file says.
    chord : float
        Largest distance of a chord from its curve [m].

    Raises
    ------
    InputError
        The drawing cannot be read, a layer is missing or empty, or what is on it is not one line.
    """
    sheet = read_sheet(path, unit, chord, open_curves=True)
    found = {name: _line(sheet, name, chord, str(path)) for name in layers}
    origin = found[layers[0]][0]
    return {name: (line - origin).tolist() for name, line in found.items()}


def _line(sheet: Sheet, layer: str, chord: float, where: str) -> Array:
    own = [e for e in sheet.entities if e.layer.upper() == layer.upper() and not e.fault and len(e.points) > 1]
    if not own:
        msg = f"there is no line on layer '{layer}'"
        raise InputError(msg, where=where, hint=closest(layer, sheet.layers, names="layers"))
    pieces = [_points(e, chord) for e in own]
    width = float(np.ptp(np.vstack(pieces)[:, 0]))
    return _joined(pieces, JOINED * width, layer, where)


def _points(entity: Entity, chord: float) -> Array:
    """Return the points of an open line, its arcs as chords, from left to right."""
    bulges = entity.bulges.copy()
    if not entity.closed:
        bulges[-1] = 0.0
    points = with_arcs(entity.points, bulges, chord) if bulges.any() else entity.points
    found = np.asarray(points, dtype=float)
    return found if found[-1, 0] >= found[0, 0] else found[::-1]


def _joined(pieces: list[Array], near: float, layer: str, where: str) -> Array:
    pieces = sorted(pieces, key=lambda p: float(p[0, 0]))
    line = pieces[0]
    for piece in pieces[1:]:
        if float(np.hypot(*(piece[0] - line[-1]))) > near:
            x, y = line[-1]
            msg = f"the pieces on layer '{layer}' do not follow each other: one ends at ({x:.4g}, {y:.4g}) m"
            raise InputError(msg, where=where, hint="draw one polyline, or join the ends of its pieces")
        line = np.vstack([line, piece[1:]])
    return line
