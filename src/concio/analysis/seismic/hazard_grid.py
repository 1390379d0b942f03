"""The hazard of a place, interpolated in a grid that the user provides, as NTC 2008, annex A does it.

The file is a table with a row for each node: longitude and latitude [degrees], for every return period a_g, F0 and Tc*
in columns such as ``ag475``, ``F0475``, ``Tc475``, in any order. a_g is in g, or in tenths of g where the column is
called ``ag10_475``. The value at a place is the mean of its four neighbours, one in each quadrant, weighted by one over
their distances. The grid is not part of the program: whoever provides it answers for it.
"""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from concio.errors import InputError

Array = np.ndarray

COLUMN = re.compile(r"(ag10(?=_)|ag|a_g|f0|fo|tc\*?|t_c\*?)[_ ]?(\d+)", re.IGNORECASE)
PLACE = {"lon": "lon", "long": "lon", "longitude": "lon", "lat": "lat", "latitude": "lat"}

DEGREE = 111.19
"""Length of a degree of latitude [km]."""

AT_NODE = 1e-6
"""A place nearer to a node than this is the node [km]."""

FARTHEST = 12.0
"""A neighbour further off than this is none of the mesh a place lies in [km]."""


def hazard_at(path: str | os.PathLike[str], coordinates: Sequence[float]) -> tuple[dict[str, float], ...]:
    """Return the hazard of a place for every return period of a grid: rows for :class:`concio.Site`.

    Parameters
    ----------
    path : str or Path
        Table of the grid, separated by commas, semicolons or tabs.
    coordinates : (longitude, latitude)
        [degrees].

    Raises
    ------
    InputError
        The table is not one of a grid, or the place does not lie in it.
    """
    path = Path(path)
    lon, lat = (float(v) for v in coordinates)
    nodes, periods, values = _read(path)
    east = (nodes[:, 0] - lon) * DEGREE * math.cos(math.radians(lat))
    north = (nodes[:, 1] - lat) * DEGREE
    away = np.hypot(east, north)
    nearest = int(np.argmin(away))
    if away[nearest] <= AT_NODE:
        return _rows(periods, values[nearest])
    chosen = []
    for right in (True, False):
        for up in (True, False):
            own = np.flatnonzero(((east > 0) == right) & ((north > 0) == up))
            if not len(own) or away[own].min() > FARTHEST:
                msg = f"({lon:g}, {lat:g}) does not lie between four nodes of the grid"
                raise InputError(msg, where=str(path), hint="coordinates are longitude and latitude in degrees")
            chosen.append(int(own[np.argmin(away[own])]))
    weight = 1.0 / away[chosen]
    return _rows(periods, weight @ values[chosen].reshape(len(chosen), -1) / weight.sum())


def _rows(periods: Sequence[int], values: Array) -> tuple[dict[str, float], ...]:
    """Return rows of return period, a_g, F0 and Tc*."""
    table = np.asarray(values).reshape(len(periods), 3)
    return tuple({"T_R": float(T), "a_g": float(a), "F0": float(f), "Tc": float(c)}
                 for T, (a, f, c) in zip(periods, table, strict=True))  # fmt: skip


def _read(path: Path) -> tuple[Array, list[int], Array]:
    """Return nodes (n, 2), return periods, and values (n, periods, 3) of a grid."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        msg = f"the grid cannot be read: {error}"
        raise InputError(msg, where=str(path)) from None
    lines = text.splitlines()
    mark = max(";\t,", key=lambda c: lines[0].count(c)) if lines else ","
    rows = list(csv.reader(lines, delimiter=mark))
    head = [cell.strip() for cell in rows[0]] if rows else []
    place = {PLACE[c.lower()]: k for k, c in enumerate(head) if c.lower() in PLACE}
    columns: dict[int, dict[str, tuple[int, float]]] = {}
    for k, cell in enumerate(head):
        found = COLUMN.fullmatch(cell)
        if found:
            word = found[1].lower().strip("*")
            key = "a_g" if word.startswith("a") else "F0" if word.startswith("f") else "Tc"
            columns.setdefault(int(found[2]), {})[key] = (k, 0.1 if word == "ag10" else 1.0)
    short = [T for T, own in columns.items() if len(own) < 3]
    if set(place) != {"lon", "lat"} or not columns or short:
        msg = "this is not the table of a grid" + (f": T_R = {short[0]} lacks a_g, F0 or Tc" if short else "")
        hint = "columns: lon, lat, and ag475, F0475, Tc475 for each return period"
        raise InputError(msg, where=str(path), hint=hint)
    periods = sorted(columns)
    order = [columns[T][key] for T in periods for key in ("a_g", "F0", "Tc")]
    try:
        table = np.array([[float(r[k].replace(",", ".")) for k in (place["lon"], place["lat"], *(c for c, _ in order))]
                          for r in rows[1:] if any(cell.strip() for cell in r)])  # fmt: skip
    except (ValueError, IndexError) as error:
        msg = f"a row of the grid is not made of numbers: {error}"
        raise InputError(msg, where=str(path)) from None
    scale = np.array([s for _, s in order])
    return table[:, :2], periods, (table[:, 2:] * scale).reshape(len(table), len(periods), 3)
