"""A drawing that is opened: its layers with what they seem to mean, and the model file that names it."""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Collection, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.model.drawing.dxf_entities import Entity, read_sheet
from concio.model.drawing.layers import LayerUse, named_use
from concio.window.folder import check_files
from concio.window.own_units import layer_for_page
from concio.window.worker import Tell

COARSE = 0.01
"""Largest distance of a chord from its arc in the picture of the layers [m]."""
MOST_LINES = 4000
FIXED = ("ground", "terren", "fondaz", "found", "suolo", "soil", "fixed", "base", "spall", "abutment")
IGNORED = ("quot", "dim", "text", "test", "ass", "axis", "axes", "grid", "retin", "hatch", "annot", "cartigl", "frame")
NAMED = ("nomi", "name", "numer", "label")
LOADED = ("solai", "copert", "floor", "roof", "caric", "load", "tett")


def layers(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return the layers of the drawing that a model text names.

    Parameters
    ----------
    request : mapping
        As for :func:`concio.window.read_models.read`.
    tell : callable
        Not used.

    Returns
    -------
    dict
        ``layers``: name, entities by kind, whether it is off, what is stated and what is proposed, lines to draw [m];
        ``metres``, the length of a drawing unit; ``unit``, false where the drawing states none; ``known``, the size
        of one block, to ask whether it is right.

    Raises
    ------
    InputError
        The text names no drawing, or it cannot be read.
    """
    data = tomllib.loads(request["text"])
    name = data.get("blocks_file")
    if not isinstance(name, str) or not name.lower().endswith(".dxf"):
        msg = "the model does not name a drawing"
        raise InputError(msg, hint="drop a DXF file on the page")
    check_files(data, Path(request["base"]), Path(request["folder"]))
    table = data.get("drawing", {})
    unit, stated = table.get("unit"), True
    path = Path(request["base"]) / name
    try:
        sheet = read_sheet(path, unit, COARSE)
    except InputError as error:
        if unit is not None or "unit" not in error.what:
            raise
        sheet, stated = read_sheet(path, "m", COARSE), False
    found: dict[str, dict[str, Any]] = {
        layer: {"name": layer, "count": Counter(), "off": layer.upper() in sheet.hidden, "lines": [],
                "stated": layer_for_page(table.get("layers", {}).get(layer), request["text"])}
        for layer in sheet.layers
    }  # fmt: skip
    room = MOST_LINES
    for entity in sheet.entities:
        own = found[entity.layer]
        own["count"][entity.kind] += 1
        if room and len(entity.points) > 1:
            room -= 1
            ends = entity.points if not entity.closed else np.vstack([entity.points, entity.points[:1]])
            own["lines"].append(np.round(ends, 6).tolist())
    for layer in found.values():
        layer["proposed"] = proposed(layer["name"], layer["count"])
    shown = [layer for layer in found.values() if layer["count"]]
    mend = table.get("mend", "")
    return {"layers": shown, "mend": mend, "metres": sheet.metres, "unit": stated, "known": _known(sheet.entities)}


def proposed(name: str, count: Collection[str]) -> str:
    """Return what a layer seems to be: a word of ``[drawing.layers]``, "load", or "" where nothing is proposed.

    A layer is proposed to be left out only where its name says that it is dimensions, axes or texts: lines on another
    layer may be loads, and a load must not be lost.
    """
    known = named_use(name.upper())
    if not isinstance(known, LayerUse) or known != LayerUse():
        return ""
    low = name.lower()
    lines = set(count) <= {"LINE", "POINT"}
    kinds = [("names", NAMED), ("fixed", FIXED), ("ignore", IGNORED), ("load", LOADED if lines else ())]
    for word, beginnings in kinds:
        if any(part.startswith(b) for b in beginnings for part in low.replace("-", "_").replace(" ", "_").split("_")):
            return word
    return ""


def _known(entities: tuple[Entity, ...]) -> list[float] | None:
    """Return width and height of the block of middle size [m]."""
    sizes = []
    for entity in entities:
        with suppress(ValueError):
            if entity.closed and len(entity.points) > 2:
                sizes.append(np.ptp(entity.points, axis=0))
    if not sizes:
        return None
    sizes.sort(key=lambda s: float(s.prod()))
    return [round(float(v), 6) for v in sizes[len(sizes) // 2]]
