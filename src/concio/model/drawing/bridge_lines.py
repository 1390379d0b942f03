"""Lines of an existing bridge from a DXF drawing: intrados, lines between rings, extrados, road; a layer for each.

Each layer holds a polyline, an arc, an ellipse, a spline, or pieces of these that follow each other; on layers of the
barrel pieces that stand apart are spans. Lines run from left to right, and the left end of the first is put at (0, 0).
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


def read_lines(
    path: Path, layers: Sequence[str], *, unit: str | None, chord: float, single: Sequence[str] = ()
) -> dict[str, list[list[list[float]]]]:
    """Return the lines of each layer as points [x, y] [m], from left to right.

    Parameters
    ----------
    path : Path
    layers : sequence of str
        The first is the intrados.
    unit : str or None
        Unit of length of the drawing; None takes what the file says.
    chord : float
        Largest distance of a chord from its curve [m].
    single : sequence of str
        Further layers, each of which holds one line.

    Raises
    ------
    InputError
        The drawing cannot be read, a layer is missing or empty, or does not hold as many lines as the intrados.
    """
    sheet = read_sheet(path, unit, chord, open_curves=True)
    where = str(path)
    found = {name: _lines(sheet, name, chord, where) for name in (*layers, *single)}
    spans = len(found[layers[0]])
    for name, lines in found.items():
        wanted = 1 if name in single else spans
        if len(lines) != wanted:
            x, y = lines[0][-1]
            told = "one is wanted" if wanted == 1 else f"layer '{layers[0]}' has {wanted}"
            msg = f"the pieces on layer '{name}' do not follow each other: they make {len(lines)} lines, {told}; the "
            msg += f"first ends at ({x:.4g}, {y:.4g}) m"
            raise InputError(msg, where=where, hint="draw one polyline for each span, or join the ends of its pieces")
    origin = found[layers[0]][0][0]
    return {name: [(line - origin).tolist() for line in lines] for name, lines in found.items()}


def _lines(sheet: Sheet, layer: str, chord: float, where: str) -> list[Array]:
    own = [e for e in sheet.entities if e.layer.upper() == layer.upper() and not e.fault and len(e.points) > 1]
    if not own:
        msg = f"there is no line on layer '{layer}'"
        raise InputError(msg, where=where, hint=closest(layer, sheet.layers, names="layers"))
    pieces = [_points(e, chord) for e in own]
    width = float(np.ptp(np.vstack(pieces)[:, 0]))
    return _joined(pieces, JOINED * width)


def _points(entity: Entity, chord: float) -> Array:
    """Return the points of an open line, its arcs as chords, from left to right."""
    bulges = entity.bulges.copy()
    if not entity.closed:
        bulges[-1] = 0.0
    points = with_arcs(entity.points, bulges, chord) if bulges.any() else entity.points
    found = np.asarray(points, dtype=float)
    return found if found[-1, 0] >= found[0, 0] else found[::-1]


def _joined(pieces: list[Array], near: float) -> list[Array]:
    """Return the lines that pieces make whose ends meet, from left to right."""
    pieces = sorted(pieces, key=lambda p: float(p[0, 0]))
    lines = [pieces[0]]
    for piece in pieces[1:]:
        if float(np.hypot(*(piece[0] - lines[-1][-1]))) > near:
            lines.append(piece)
        else:
            lines[-1] = np.vstack([lines[-1], piece[1:]])
    return lines
