"""Draws ``facade.dxf``: a facade of 5 x 6 m as it comes from a survey, in millimetres, on the draughtsman's layers.

It is sloppy in the ways drawings are: corners that should meet are up to half a millimetre apart, one stone was drawn
twice, one outline is not quite closed, one has the same corner twice, one floor line is too long, and dimensions, axes
and a title lie about. ``facade.toml`` says what the layers mean.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np

LENGTH, COURSE, COURSES, STONE = 5000.0, 300.0, 20, 465.0
OPENINGS = ((1700.0, 2900.0, 0, 8), (700.0, 1600.0, 13, 17), (3150.0, 4150.0, 13, 17))
"""A door and two windows: left, right, first course, course of the lintel."""
BEARING = 250.0
SLIP = 0.2
"""No coordinate is further from where it should be than this [mm]."""

FILE = Path(__file__).with_name("facade.dxf")
Box = tuple[float, float, float, float]


def stones() -> tuple[list[Box], list[Box]]:
    """Return the stones and the lintels as boxes (x0, x1, y0, y1) [mm]."""
    found, lintels = [], []
    for course in range(COURSES):
        y0, y1 = course * COURSE, (course + 1) * COURSE
        free = [(0.0, LENGTH)]
        for left, right, first, lintel in OPENINGS:
            if first <= course < lintel:
                free = without(free, left, right)
            elif course == lintel:
                free = without(free, left - BEARING, right + BEARING)
                lintels.append((left - BEARING, right + BEARING, y0, y1))
        for start, stop in free:
            marks = joints(start, stop, course)
            found += [(a, b, y0, y1) for a, b in pairwise(marks)]
    return found, lintels


def without(spans: list[tuple[float, float]], left: float, right: float) -> list[tuple[float, float]]:
    """Return the spans without what lies between ``left`` and ``right``."""
    pieces = [part for a, b in spans for part in ((a, min(b, left)), (max(a, right), b))]
    return [(a, b) for a, b in pieces if b > a]


def joints(start: float, stop: float, course: int) -> list[float]:
    """Return the ends of the stones of a course between two of its ends: a running bond, no stone too short."""
    first = STONE * (0.5 + 0.1 * (course % 3)) if course % 2 else STONE
    inner = [x for x in np.arange(first, LENGTH, STONE).tolist() if start + 150 < x < stop - 150]
    return [start, *inner, stop]


def main(path: Path = FILE) -> int:
    """Draw the facade; return the number of its stones, lintels included."""
    drawing = ezdxf.new("R2010", units=4)
    ezdxf.options.write_fixed_meta_data_for_testing = True  # the same drawing gives the same file
    space = drawing.modelspace()
    random = np.random.default_rng(1874)

    def polyline(corners: list[tuple[float, float]], layer: str, *, close: bool = True) -> None:
        space.add_lwpolyline(corners, close=close, dxfattribs={"layer": layer})

    def corners(box: Box) -> list[tuple[float, float]]:
        x0, x1, y0, y1 = box
        off = random.uniform(-SLIP, SLIP, (4, 2))
        ideal = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        return [(round(x, 3), round(y, 3)) for x, y in (ideal + off).tolist()]

    walls, lintels = stones()
    polyline([(-400, -300), (LENGTH + 400, -300), (LENGTH + 400, 0), (-400, 0)], "FONDAZIONE")
    for k, box in enumerate(walls):
        around = corners(box)
        if k == 40:  # not quite closed
            x, y = around[0]
            polyline([*around, (x + 0.25, y)], "MURATURA", close=False)
            continue
        if k == 77:  # a corner given twice
            around.insert(2, (around[1][0] + 0.1, around[1][1]))
        polyline(around, "MURATURA")
        if k == 111:  # drawn twice
            polyline(corners(box), "MURATURA")
    for box in lintels:
        polyline(corners(box), "ARCHITRAVI")

    space.add_line((-3, 10 * COURSE + 0.15), (LENGTH + 4, 10 * COURSE - 0.1), dxfattribs={"layer": "SOLAIO"})
    space.add_line((0.2, 20 * COURSE), (LENGTH, 20 * COURSE + 0.1), dxfattribs={"layer": "COPERTURA"})
    for y in (0.0, 10 * COURSE, 20 * COURSE):
        space.add_line((-900, y), (LENGTH + 900, y), dxfattribs={"layer": "ASSI"})
        space.add_text(f"+{y / 1000:.2f}", height=120, dxfattribs={"layer": "QUOTE", "insert": (-1300, y)})
    for left, right, first, _ in OPENINGS:
        y = first * COURSE - 150
        space.add_line((left, y), (right, y), dxfattribs={"layer": "QUOTE"})
        space.add_text(f"{right - left:.0f}", height=80, dxfattribs={"layer": "QUOTE", "insert": (left + 200, y)})
    space.add_text("PROSPETTO SUD", height=200, dxfattribs={"layer": "QUOTE", "insert": (1500, -900)})
    drawing.saveas(path)
    return len(walls) + len(lintels)


if __name__ == "__main__":
    print(f"{main()} stones in facade.dxf")
