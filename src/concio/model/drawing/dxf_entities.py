"""Entities of a DXF drawing as outlines, places and loads; see :mod:`concio.model.drawing.dxf` for the layers."""

from __future__ import annotations

from typing import Any

import numpy as np

from concio.model.model import Array, Load


def outline_of(entity: Any, metres: float, chord: float) -> tuple[Array, bool, float] | None:
    """Return the outline an entity draws.

    Returns
    -------
    (points, curved, open_by) or None
        Points (n, 2) [m], whether it has arcs, and the distance between its ends where it is not closed [m]; None for
        entities that draw no outline.
    """
    kind = entity.dxftype()
    if kind == "LWPOLYLINE":
        raw = np.array([(x, y, b) for x, y, b in entity.get_points("xyb")]).reshape(-1, 3)
        closed = bool(entity.closed)
    elif kind == "POLYLINE":
        if not (entity.is_2d_polyline or entity.is_3d_polyline):
            return None
        raw = np.array([(v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0)) for v in entity.vertices])
        raw, closed = raw.reshape(-1, 3), bool(entity.is_closed)
    elif kind in ("CIRCLE", "ELLIPSE", "SPLINE"):
        from ezdxf.path import make_path

        path = make_path(entity)
        if not path.is_closed:
            return None
        flat = metres * np.array([(p.x, p.y) for p in path.flattening(chord / metres)])
        return flat[:-1], True, 0.0
    else:
        return None
    if len(raw) < 2:
        return metres * raw[:, :2], False, 0.0
    points, bulges = metres * raw[:, :2], raw[:, 2]
    open_by = 0.0 if closed else float(np.hypot(*(points[-1] - points[0])))
    size = float(np.ptp(points, axis=0).max())
    if np.hypot(*(points[-1] - points[0])) <= 1e-9 * size:
        points, bulges, open_by = points[:-1], bulges[:-1], 0.0
    if open_by:
        bulges[-1] = 0.0
    return with_arcs(points, bulges, chord), bool(bulges.any()), open_by


def with_arcs(points: Array, bulges: Array, chord: float) -> Array:
    """Return a closed outline (n, 2) whose arcs are chords within ``chord`` of the arc [m].

    Parameters
    ----------
    points : (k, 2) array
        Vertices [m].
    bulges : (k,) array
        Tangent of a quarter of the angle of the arc from vertex k to the next, positive counter-clockwise.
    chord : float
        [m].
    """
    result = []
    for p, q, bulge in zip(points, np.roll(points, -1, axis=0), bulges, strict=True):
        result.append(p[None])
        length = float(np.hypot(*(q - p)))
        if not bulge or not length:
            continue
        angle = 4 * np.arctan(bulge)
        radius = length / (2 * np.sin(abs(angle) / 2))
        n = max(1, int(np.ceil(abs(angle) / (2 * np.arccos(max(1 - chord / radius, 0.0))) - 1e-9)))
        left = np.array([p[1] - q[1], q[0] - p[0]])
        centre = 0.5 * (p + q) + left * (1 - bulge * bulge) / (4 * bulge)
        turn = angle * np.arange(1, n) / n
        x, y = p - centre
        result.append(centre + np.stack([x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)], 1))
    return np.concatenate(result)


def place_of(entity: Any, metres: float) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Return the two ends of a LINE, or a POINT twice [m]; None for other entities."""
    kind = entity.dxftype()
    if kind == "LINE":
        p, q = entity.dxf.start, entity.dxf.end
    elif kind == "POINT":
        p = q = entity.dxf.location
    else:
        return None
    return (metres * p.x, metres * p.y), (metres * q.x, metres * q.y)


def load_of(layer: str, place: tuple[tuple[float, float], tuple[float, float]]) -> Load | str:
    """Return the load that a layer's name and a place describe, or what is wrong with the name."""
    parts = layer.removeprefix("CONCIO_LOAD").strip("_").split("_")
    form = "the layer is not CONCIO_LOAD_<PRESSURE|TX|TY|FX|FY>_<value>_<group>"
    if len(parts) < 2 or parts[0] not in ("PRESSURE", "TX", "TY", "FX", "FY"):
        return form
    try:
        value = float(parts[1])
    except ValueError:
        return f"'{parts[1]}' is not a number; {form}"
    group = "_".join(parts[2:]).lower() or "live"
    is_point = place[0] == place[1]
    if parts[0].startswith("F") != is_point:
        return f"{parts[0]} wants {'a POINT' if parts[0].startswith('F') else 'a LINE'}, not this entity"
    if parts[0] == "PRESSURE":
        return Load("pressure", (value,), edge=place, group=group)
    vector = (value, 0.0) if parts[0].endswith("X") else (0.0, value)
    if parts[0].startswith("T"):
        return Load("traction", vector, edge=place, group=group)
    return Load("point", vector, at=place[0], group=group)
