"""Table ``[bridge_drawing]`` of a model file: the lines of an existing bridge, drawn in a DXF file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import Field, StrictStr

from concio.errors import InputError
from concio.model.file.file_errors import placed
from concio.model.file.road_tables import FillTable
from concio.model.file.tables import Name, Table
from concio.model.file.values import Length


class BridgeDrawingTable(Table):
    """A drawing of a bridge: a layer for each line of the barrel from the intrados outwards, for road and fill line.

    Keys
    ----
    file :
        DXF file, beside the model file.
    lines :
        Layers of the lines of the barrel, from the intrados outwards.
    road :
        Layer of the road line.
    fill_line :
        Layer of the line between fill and surfacing.
    unit :
        Unit of the drawing, where the file does not say it.
    chord_tolerance :
        Arcs are replaced by chords that deviate by no more.
    """

    file: Name
    lines: list[StrictStr] = Field(default_factory=lambda: ["INTRADOS", "EXTRADOS"])
    road: StrictStr | None = None
    fill_line: StrictStr | None = None
    unit: StrictStr | None = None
    chord_tolerance: Length = 0.002


def drawn_barrel(drawing: BridgeDrawingTable | None, bridge: Any, folder: Path) -> dict[str, Any]:
    """Return the lines of the barrel as arguments of the generator; none without a drawing.

    Raises
    ------
    InputError
        There is no ``[bridge]``, fewer than two lines are named, or the drawing has not one line on each layer.
    """
    if drawing is None:
        return {}
    with placed("[bridge_drawing]"):
        if bridge is None or len(drawing.lines) < 2:
            what = "there is no [bridge]" if bridge is None else "lines names fewer than two layers"
            raise InputError(what, hint="it draws the barrel of [bridge], which says voussoirs and materials")
        drawn = _read(drawing, folder)
        each = [drawn[name] for name in drawing.lines]
        inner, *between, outer = each if len(each[0]) > 1 else [lines[0] for lines in each]
        return {"intrados": inner, "extrados": outer, "ring_lines": between}


def with_drawn_road(fill: FillTable | None, drawing: BridgeDrawingTable | None, folder: Path) -> FillTable | None:
    """Return the table of the fill with road and fill line of a drawing, where the table does not say them itself."""
    if drawing is None or fill is None:
        return fill
    wanted = {"road": drawing.road if fill.cover is None and not fill.road else None,
              "fill_line": None if fill.fill_line else drawing.fill_line}  # fmt: skip
    if not any(wanted.values()):
        return fill
    with placed("[bridge_drawing]"):
        drawn = _read(drawing, folder)
    update = {key: [(float(x), float(y)) for x, y in drawn[layer][0]] for key, layer in wanted.items() if layer}
    found = fill.model_copy(update=update)
    found.model_fields_set.update(update)
    return found


def _read(drawing: BridgeDrawingTable, folder: Path) -> dict[str, list[list[list[float]]]]:
    """Return the lines of a drawing by layer, the left springing of the first at (0, 0) [m]."""
    from concio.model.drawing.bridge_lines import read_lines

    single = [name for name in (drawing.road, drawing.fill_line) if name is not None]
    path = folder / drawing.file
    return read_lines(path, drawing.lines, unit=drawing.unit, chord=drawing.chord_tolerance, single=single)
