"""Faults of a single outline: what a drawing or a table can get wrong before blocks are even put together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from concio.errors import GeometryError
from concio.kinematics.frames import turning
from concio.kinematics.mass import signed_area
from concio.model.limits import LARGEST_COORDINATE
from concio.model.model import Array

FaultKind = Literal["not finite", "too few", "double vertex", "spike", "crossing", "touching", "no area"]
SHARPEST = np.deg2rad(1.0)
"""A vertex with an inner or outer angle below this is a spike [rad]."""


@dataclass(frozen=True, eq=False)
class Fault:
    """One fault of an outline.

    Parameters
    ----------
    kind : str
    at : (2,) array
        Where [m].
    sentence : str
        What was found there.
    hint : str
        What to do.
    """

    kind: FaultKind
    at: Array
    sentence: str
    hint: str


def check_polygon(outline: Array, name: str = "") -> None:
    """Raise for the first fault of an outline.

    Parameters
    ----------
    outline : (n, 2) array
        Vertices [m].
    name : str
        Name of the block, for the message.

    Raises
    ------
    GeometryError
        With what was found, the block and the coordinates, what to do, and how many more faults there are.
    """
    faults = polygon_faults(outline)
    if faults:
        first = faults[0]
        more = f"; {len(faults) - 1} more fault{'s' if len(faults) > 2 else ''} in this outline" if faults[1:] else ""
        raise GeometryError(first.sentence + more, where=f"block '{name}'" if name else None, hint=first.hint)


def polygon_faults(outline: Array, *, tolerance: float = 0.0, sharpest: float = SHARPEST) -> tuple[Fault, ...]:
    """Return all faults of an outline (n, 2); a closing repetition of the first vertex is not a fault."""
    points = np.array(outline, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or not (np.abs(points) < LARGEST_COORDINATE).all():
        return (Fault("not finite", np.full(2, np.nan), "a coordinate is missing or not finite", "give numbers in m"),)
    if len(points) > 1 and np.array_equal(points[0], points[-1]):
        points = points[:-1]
    if len(points) < 3:
        at = points[0] if len(points) else np.full(2, np.nan)
        return (Fault("too few", at, f"the outline has {len(points)} vertices", "a polygon needs at least 3"),)
    faults = [*_double_vertices(points, tolerance)]
    distinct = points[np.hypot(*(points - np.roll(points, 1, axis=0)).T) > tolerance]
    if len(distinct) < 3:
        return (*faults, Fault("no area", points[0], f"the outline has no area {_at(points[0])}", "delete it"))
    faults += _spikes(distinct, sharpest)
    faults += _crossings(distinct)
    size = float(np.ptp(points, axis=0).max())
    if not faults and abs(signed_area(points)) <= 1e-12 * size * size:
        faults.append(Fault("no area", points[0], f"the outline has no area {_at(points[0])}", "delete it"))
    return tuple(faults)


def _at(point: Array) -> str:
    return f"at ({point[0]:.6g}, {point[1]:.6g}) m"


def _double_vertices(points: Array, tolerance: float) -> list[Fault]:
    length = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    found = []
    for k in np.flatnonzero(length <= tolerance):
        follow = (k + 1) % len(points)
        text = f"vertices {k + 1} and {follow + 1} coincide {_at(points[k])}"
        if length[k]:
            text = f"vertices {k + 1} and {follow + 1} are only {1e3 * length[k]:.3g} mm apart {_at(points[k])}"
        found.append(Fault("double vertex", points[k], text, "delete one of them"))
    return found


def _spikes(points: Array, sharpest: float) -> list[Fault]:
    back, ahead = np.roll(points, 1, axis=0) - points, np.roll(points, -1, axis=0) - points
    angle = np.abs(turning(back, ahead))
    return [
        Fault(
            "spike",
            points[k],
            f"the sides turn back on each other {_at(points[k])} with an angle of {np.rad2deg(angle[k]):.2g} degrees",
            "delete the vertex at the tip",
        )
        for k in np.flatnonzero(angle < sharpest)
    ]


def _crossings(points: Array) -> list[Fault]:
    """Return where sides that are not neighbours cross or touch."""
    n = len(points)
    sides = shapely.linestrings(np.stack([points, np.roll(points, -1, axis=0)], 1))
    i, j = shapely.STRtree(sides).query(sides, predicate="intersects")
    keep = (j - i > 1) & ~((i == 0) & (j == n - 1))
    found = []
    for p, q in zip(i[keep], j[keep], strict=True):
        where = shapely.intersection(sides[p], sides[q])
        at = np.array(shapely.point_on_surface(where).coords[0])
        crossing = bool(shapely.crosses(sides[p], sides[q]))
        word = "cross" if crossing else "touch"
        found.append(
            Fault(
                "crossing" if crossing else "touching",
                at,
                f"sides {p + 1} and {q + 1} {word} {_at(at)}",
                "draw the block as two, or move the vertices so that no two sides meet",
            )
        )
    return found
