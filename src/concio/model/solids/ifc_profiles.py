"""Profiles of IFC that are bounded by straight lines: rings of points, the outline first, then its holes."""

from __future__ import annotations

import numpy as np

from concio.model.solids.ifc_placement import axes, point
from concio.model.solids.step_file import Instance, Reference, Typed

Array = np.ndarray

CURVED = "model it with straight sides, or export the part as a tessellation or faceted brep"


def rings(profile: Instance) -> list[Array]:
    """Return the rings (n, 2) of a profile.

    Raises
    ------
    InputError
        The profile is curved or of a sort that is not read.
    """
    kind = profile.kind
    if kind == "IFCRECTANGLEPROFILEDEF":
        x, y = (_positive(profile, k) / 2 for k in (3, 4))
        outline = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    elif kind == "IFCTRAPEZIUMPROFILEDEF":
        bottom, top, height = (_positive(profile, k) for k in (3, 4, 5))
        left, y = profile.number_at(6) - bottom / 2, height / 2
        outline = np.array([[-bottom / 2, -y], [bottom / 2, -y], [left + top, y], [left, y]])
    elif kind in ("IFCARBITRARYCLOSEDPROFILEDEF", "IFCARBITRARYPROFILEDEFWITHVOIDS"):
        inner = profile.instances(3) if kind.endswith("VOIDS") else []
        return [_ring(curve) for curve in (profile.instance(2), *inner)]
    else:
        profile.refuse("is a profile that is not read", CURVED)
    return [(outline @ (matrix := axes(profile.open_instance(2)))[:2, :2].T) + matrix[:2, 3]]


def _positive(profile: Instance, place: int) -> float:
    value = profile.number_at(place)
    if value <= 0:
        profile.refuse(f"has the size {value:g}, which is not positive")
    return value


def _ring(curve: Instance) -> Array:
    """Return the points (n, 2) of a closed line of straight pieces, each once."""
    if curve.kind == "IFCPOLYLINE":
        points = [point(p, 2) for p in curve.instances(0)]
    elif curve.kind == "IFCINDEXEDPOLYCURVE":
        points = _indexed(curve)
    else:
        curve.refuse("is a curved line, which is not read", CURVED)
    if len(points) > 1 and points[0] == points[-1]:
        points = points[:-1]
    if len(points) < 3:
        curve.refuse(f"has {len(points)} points, which bound nothing")
    return np.array(points)


def _indexed(curve: Instance) -> list[list[float]]:
    table = curve.instance(0).rows(0, 2)
    if curve.value(1) is None:
        return table
    order: list[int] = []
    for piece in curve.listed(1):
        if not isinstance(piece, Typed) or piece.kind != "IFCLINEINDEX":
            curve.refuse("has arcs, which are not read", CURVED)
        order += indices(curve, piece.value if isinstance(piece.value, tuple) else (), len(table))
    return [table[k] for n, k in enumerate(order) if n == 0 or k != order[n - 1]]


def indices(of: Instance, given: object, count: int) -> list[int]:
    """Return whole numbers that count from 1 as numbers that count from 0, each below ``count``."""
    if not isinstance(given, tuple) or any(not isinstance(v, int) or isinstance(v, Reference) for v in given):
        of.refuse("lists something else than numbers of points")
    wrong = next((v for v in given if not 1 <= v <= count), None)
    if wrong is not None:
        of.refuse(f"uses point {wrong}: there are {count}, numbered from 1")
    return [v - 1 for v in given]
