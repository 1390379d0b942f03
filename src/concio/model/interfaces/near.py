"""What interface detection reports beside interfaces: near misses, corners that touch in a point, overlaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from concio.model.model import Array, Body
from concio.model.overlay import common
from concio.representation import short_repr

MissKind = Literal["gap", "angle", "sliver", "partial", "corner", "edge"]


@short_repr
@dataclass(frozen=True, eq=False)
class NearMiss:
    """A place where two bodies nearly have a joint, have one only in part, or touch without one.

    Parameters
    ----------
    kind : {"gap", "angle", "sliver", "partial", "corner", "edge"}
        gap: they face each other but stand too far apart. angle: they touch but are turned too far. sliver: their
        common length is too short. partial: a joint was made of only a part of the common length. corner: a corner of
        one body touches the other in a point. edge: in space, an edge of one lies on a face or an edge of the other.
    a, b : str
        Names of the bodies.
    bodies : (int, int)
        Their indices.
    at : (d,) array
        Middle of the place [m].
    gap : float
        Distance there [m].
    length : float
        Common length, in space of two faces their common area [m, m2].
    angle : float
        Angle between the edges or faces [rad].
    sentence : str
        What was found, where, and what to do.
    """

    kind: MissKind
    a: str
    b: str
    bodies: tuple[int, int]
    at: Array
    gap: float
    length: float
    angle: float
    sentence: str

    @property
    def made(self) -> bool:
        """Whether a joint was made of a part of it; elsewhere the bodies can pass through each other unseen."""
        return self.kind == "partial"

    @property
    def touches(self) -> bool:
        """Whether the bodies meet there, within the tolerance or the reach, so that force can pass as drawn."""
        return self.kind != "gap"

    @property
    def place(self) -> str:
        """Where, in words: the two bodies and the point [m]."""
        return f"'{self.a}' on '{self.b}' at ({', '.join(f'{v:.6g}' for v in self.at)}) m"

    @classmethod
    def of(
        cls, kind: MissKind, a: Body, b: Body, bodies: tuple[int, int], at: Array, *,
        gap: float, length: float, joined: float, angle: float, within: float,
    ) -> NearMiss:  # fmt: skip
        """Return a near miss with its sentence."""
        place = f"at ({at[0]:.6g}, {at[1]:.6g}) m"
        pair = f"'{a.name}' and '{b.name}'"
        if kind == "gap":
            text = (
                f"{pair} face each other over {length:.4g} m {place} with a gap of {1e3 * gap:.4g} mm; no joint was "
                f"made (if they touch raise gap_tolerance above it, or 'mend' of a drawing; gap_reach keeps it as an "
                f"initial gap)"
            )
        elif kind == "angle":
            text = (
                f"{pair} touch {place} with edges turned by {np.rad2deg(angle):.3g} degrees; no joint was made "
                f"(align the edges, or raise gap_tolerance)"
            )
        elif kind == "sliver":
            text = (
                f"{pair} share only {1e3 * joined:.4g} mm {place}; this sliver was dropped (align the corners, or "
                f"lengthen the overlap if the contact is meant)"
            )
        elif kind == "partial":
            text = (
                f"{pair} face each other over {length:.4g} m {place} but only {joined:.4g} m lie within "
                f"{1e3 * within:.4g} mm; the joint covers that part (the gap grows to {1e3 * gap:.4g} mm: raise "
                f"gap_reach to keep the rest as an initial gap)"
            )
        else:
            text = f"{pair} touch {place} in a corner only; no joint was made (give it a length if it bears load)"
        return cls(kind, a.name, b.name, bodies, at, gap, length, angle, text)


@short_repr
@dataclass(frozen=True, eq=False)
class Overlap:
    """An area that two bodies cover.

    Parameters
    ----------
    a, b : str
        Names of the bodies.
    bodies : (int, int)
        Their indices.
    at : (2,) array
        A point inside the overlap [m].
    area : float
        Area covered twice [m2].
    depth : float
        Mean width of the overlap, twice area over perimeter [m].
    sentence : str
        What was found, where, and what to do.
    """

    a: str
    b: str
    bodies: tuple[int, int]
    at: Array
    area: float
    depth: float
    sentence: str


def size_of_bodies(bodies: Sequence[Body]) -> Array:
    """Return the root of the area of each body (n,) [m]."""
    return np.asarray(np.sqrt(np.abs(shapely.area(polygons(bodies)))))


def polygons(bodies: Sequence[Body]) -> Array:
    """Return the outlines as an array of shapely polygons (n,)."""
    counts = np.array([len(b.outline) for b in bodies])
    points = np.concatenate([b.outline for b in bodies])
    rings = shapely.linearrings(points, indices=np.repeat(np.arange(len(bodies)), counts))
    result: Array = shapely.polygons(rings)
    for k, body in enumerate(bodies):
        if body.holes:
            result[k] = shapely.Polygon(body.outline, body.holes)
    return result


def find_overlaps(bodies: Sequence[Body], tolerance: float) -> list[Overlap]:
    """Return the areas covered by two bodies to a depth above the tolerance; two fixed bodies may overlap."""
    shapes = polygons(bodies)
    fixed = np.array([b.kind == "fixed" for b in bodies])
    i, j = shapely.STRtree(shapes).query(shapes)
    keep = (i < j) & ~(fixed[i] & fixed[j])
    i, j = i[keep], j[keep]
    box = shapely.bounds(shapes)
    widths = np.minimum(box[i, 2:], box[j, 2:]) - np.maximum(box[i, :2], box[j, :2])
    keep = (widths > tolerance).all(1)
    i, j = i[keep], j[keep]
    valid = shapely.is_valid(shapes)
    shapes = np.where(valid, shapes, shapely.make_valid(shapes)) if not valid.all() else shapes
    both = common(shapes[i], shapes[j])
    area, around = shapely.area(both), shapely.length(both)
    depth = np.divide(2 * area, around, out=np.zeros_like(area), where=around > 0)
    result = []
    for k in np.flatnonzero(depth > tolerance):
        a, b = bodies[i[k]], bodies[j[k]]
        inside = shapely.point_on_surface(both[k])
        place = f"at ({inside.x:.6g}, {inside.y:.6g}) m"
        if area[k] > 0.999 * max(a.area, b.area):
            text = f"'{a.name}' and '{b.name}' are drawn twice over each other {place} (delete one of them)"
        else:
            text = (
                f"'{a.name}' and '{b.name}' overlap {place} by {area[k]:.4g} m2, about {1e3 * depth[k]:.4g} mm deep "
                f"(move or trim one of them; no joint is made where they overlap)"
            )
        at = np.array([inside.x, inside.y])
        result.append(Overlap(a.name, b.name, (int(i[k]), int(j[k])), at, float(area[k]), float(depth[k]), text))
    return result
