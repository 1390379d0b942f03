"""A picture under the model: where it lies, and the stones that are traced in it."""

from __future__ import annotations

import base64
import io
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from concio.errors import InputError
from concio.model.picture.courses import trace_courses
from concio.model.picture.photo import Photo, read_photo
from concio.model.picture.regions import trace_outlines, trace_regions, wire
from concio.model.picture.tracing import Tracing
from concio.window.folder import check_files
from concio.window.worker import Tell

MOST_PIXELS = 1600
"""Longer side of the picture that the page shows."""
MOST_STONES = 2000
MOST_DOUBTS = 60
MOST_WIRE = 300_000
"""Pixels around two clicks between which the way along the joints is shown at once."""
_LAST: dict[str, tuple[Photo, bool]] = {}
UNKNOWN = 3.0
"""Width that a picture is shown with before its scale is known [m]."""


def photo_of(request: Mapping[str, Any]) -> tuple[Photo, bool]:
    """Return the picture of a text with its scale, and whether the scale is known.

    Raises
    ------
    InputError
        The text names no picture, or it cannot be read.
    """
    data = tomllib.loads(request["text"])
    record = data.get("record", {})
    table = record.get("picture") if isinstance(record, dict) else None
    if not isinstance(table, dict) or not isinstance(table.get("file"), str):
        msg = "the model names no picture"
        raise InputError(msg, where="[record.picture]", hint="drop a PNG, JPEG or TIFF file on the page")
    check_files({"file": table["file"]}, Path(request["base"]), Path(request["folder"]))
    file = Path(request["base"]) / table["file"]
    changed = file.stat().st_mtime_ns if file.is_file() else 0
    key = f"{file} {changed} {table!r}"
    if key not in _LAST:  # many requests of one picture follow each other while a hand moves
        found = _scaled(read_photo(file), table)
        _LAST.clear()
        _LAST[key] = found
    return _LAST[key]


def _scaled(photo: Photo, table: Mapping[str, Any]) -> tuple[Photo, bool]:
    corners, points = table.get("corners"), table.get("points")
    if corners is not None:
        width, height = _numbers(table.get("size"), (2,))
        return photo.rectified(_numbers(corners, (4, 2)), width, height), True
    if points is not None:
        a, b = _numbers(points, (2, 2))
        return photo.scaled(a, b, float(_numbers(table.get("distance"), ()))), True
    return Photo(photo.grey, UNKNOWN / photo.grey.shape[1]), False


def _numbers(value: Any, shape: tuple[int, ...]) -> Any:
    try:
        found = np.array(value, dtype=float)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != shape or not np.isfinite(found).all():
        msg = "the scale of the picture is not complete"
        raise InputError(msg, where="[record.picture]", hint="give points and distance, or corners and size")
    return found


def underlay(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return the picture of a text for the page.

    Returns
    -------
    dict
        ``href``, PNG; ``box``, where it lies [m]; ``columns`` and ``rows`` of the pixels that the text counts;
        ``known``, whether it has its scale; ``flat``, whether it is rectified.
    """
    from matplotlib.image import imsave

    photo, known = photo_of(request)
    rows, columns = photo.grey.shape
    every = -(-max(rows, columns) // MOST_PIXELS)
    into = io.BytesIO()
    imsave(into, photo.grey[::every, ::every], cmap="gray", vmin=0.0, vmax=1.0, format="png")
    width, height = photo.size
    flat = "corners" in tomllib.loads(request["text"])["record"]["picture"]
    href = "data:image/png;base64," + base64.b64encode(into.getvalue()).decode()
    return {"href": href, "box": [0.0, 0.0, width, height], "columns": columns, "rows": rows, "known": known,
            "flat": flat}  # fmt: skip


def traced(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return the stones of the picture.

    Parameters
    ----------
    request : mapping
        ``method``: "courses", "regions" or "outlines"; ``unit``, two numbers or one [m]; ``joint``, rough width of the
        joints [m]; ``clicks`` around each stone.
    tell : callable
        Not used.

    Returns
    -------
    dict
        ``stones``, outlines [m]; ``joints``, the most doubtful first, with ends and strength; ``width`` of joints [m].
    """
    photo, known = photo_of(request)
    if not known:
        msg = "the picture has no scale yet"
        raise InputError(msg, hint="click two points and state their distance, or four corners and the size")
    found = _traced(photo, request)
    outlines = found.outlines()
    if len(outlines) > MOST_STONES:
        msg = f"{len(outlines)} stones were traced"
        raise InputError(msg, hint="state a larger unit, or a smaller part of the picture")
    return {
        "stones": [np.round(ring, 5).tolist() for ring in outlines.values()], "width": found.joint_width,
        "joints": [
            {"kind": j.kind, "ends": np.round(j.ends, 5).tolist(), "strength": j.strength}
            for j in found.joints[:MOST_DOUBTS]
        ],
    }  # fmt: skip


def wired(request: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return the way along the joints between two points of the picture.

    Parameters
    ----------
    request : mapping
        ``a`` and ``b``, points [m]; ``joint``, rough width of the joints [m].
    tell : callable
        Not used.

    Returns
    -------
    dict
        ``way``, points [m]; None where the points are too far apart for a way at once, or the picture has no scale.
    """
    photo, known = photo_of(request)
    a, b = (_numbers(request[key], (2,)) for key in "ab")
    (x0, y0), (x1, y1) = photo.pixels(np.array([a, b]))
    far = float(np.hypot(x1 - x0, y1 - y0))
    if not known or (abs(x1 - x0) + far) * (abs(y1 - y0) + far) > MOST_WIRE:
        return {"way": None}
    found = wire(photo, a.tolist(), b.tolist(), joint=request.get("joint") or None)
    return {"way": np.round(found, 5).tolist()}


def _traced(photo: Photo, request: Mapping[str, Any]) -> Tracing:
    joint = request.get("joint") or None
    if request["method"] == "courses":
        return trace_courses(photo, request["unit"])
    if request["method"] == "regions":
        length, height = request["unit"]
        return trace_regions(photo, float(np.sqrt(length * height)), joint=joint)
    return trace_outlines(photo, request["clicks"], joint=joint)
