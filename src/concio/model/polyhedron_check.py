"""Faults of a single polyhedron: what a file or a table can get wrong before blocks are even put together.

A block is sound where its faces close a volume, point outwards, are planar and do not cross themselves or each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import shapely

from concio.errors import GeometryError
from concio.kinematics.frames import cross, tangents, turning
from concio.model.limits import LARGEST_COORDINATE
from concio.model.topology import Loop, Topology, topology

Array = np.ndarray

SolidFaultKind = Literal[
    "not finite", "too many", "index", "too few", "open", "turned", "shared", "double vertex", "no volume",
    "inside out", "out of plane", "no area", "crossing", "piercing",
]  # fmt: skip

MOST_VERTICES = 20_000
"""A block with more vertices than this is a scanned surface, not a block."""
PLANAR = 1e-4
"""Share of a block's longest side by which a vertex may stand off the plane of its face."""
DOUBLE = 1e-9
"""Share of a block's longest side within which two vertices are one."""
_HINTS = {
    "open": "add the missing face, or weld the vertices that belong together ('mend' of an import)",
    "turned": "reverse the order of the vertices of one of them ('mend' of an import does)",
    "shared": "more than two faces meet in an edge: make two blocks of it",
}


@dataclass(frozen=True, eq=False)
class SolidFault:
    """One fault of a polyhedron.

    Parameters
    ----------
    kind : str
    face : int
        Number of the face from 0; -1 where no face in particular is at fault.
    at : (3,) array
        Where [m].
    deviation : float
        How far off, where that can be said: distance from the plane, width of a gap [m].
    sentence : str
        What was found there.
    hint : str
        What to do.
    """

    kind: SolidFaultKind
    face: int
    at: Array
    deviation: float
    sentence: str
    hint: str


def require_sound(
    points: Array, faces: Sequence[Loop], holes: Sequence[tuple[int, Loop]] = (), name: str = "", *,
    planar: float = PLANAR,
) -> Array:  # fmt: skip
    """Return the unit normals (f, 3) of the faces of a polyhedron, and raise for its first fault.

    Parameters
    ----------
    points : (n, 3) array
        Vertices [m].
    faces, holes
        As in :class:`concio.model.polyhedron.Polyhedron`.
    name : str
        Name of the block, for the message.
    planar : float
        Share of the longest side by which vertices may stand off the plane of their face.

    Raises
    ------
    GeometryError
        With what was found, block, face and place, what to do, and how many more faults there are.
    """
    unusable = _unusable(points, faces, holes)
    if unusable is None:
        top = topology(tuple(faces), tuple(holes))
        normals = _seen_at_once(points, top, planar)
        if normals is not None:
            return normals
    faults = polyhedron_faults(points, faces, holes, planar=planar)
    if faults:
        first = faults[0]
        more = f"; {len(faults) - 1} more fault{'s' if len(faults) > 2 else ''} in this block" if faults[1:] else ""
        raise GeometryError(first.sentence + more, where=f"block '{name}'" if name else None, hint=first.hint)
    area = top.area_vectors(points)
    return np.asarray(area / np.linalg.norm(area, axis=1)[:, None])


def _seen_at_once(points: Array, top: Topology, planar: float) -> Array | None:
    """Return the normals of a convex polyhedron with triangles and quadrilaterals for faces; None for any other."""
    if top.fault is not None or top.sides_of_face.max() > 4 or len(top.first) > len(top.sides_of_face):
        return None
    size = float(np.ptp(points[top.start], axis=0).max())
    twice = top.spanned(points)
    area = top.by_face(twice)
    length = np.sqrt((area * area).sum(1))
    if length.min() <= 1e-12 * size * size:
        return None
    normals = area / length[:, None]
    at = points[top.start]
    middle = top.by_face(at) / top.sides_of_face[:, None]
    offset = (middle * normals).sum(1)
    own = normals[top.face]
    along = points[top.end] - at
    turn = (cross(along, along[top.following]) * own).sum(1)
    sound = (
        np.abs((at * own).sum(1) - offset[top.face]).max() <= planar * size
        and turn.min() > 0
        and (points[top.start] @ normals.T - offset).max() <= planar * size
        and ((points[top.corners[0]] - points[0]) * twice).sum() > 6e-9 * size**3
    )
    return normals if sound else None


def polyhedron_faults(
    points: Array, faces: Sequence[Loop], holes: Sequence[tuple[int, Loop]] = (), *, planar: float = PLANAR
) -> tuple[SolidFault, ...]:
    """Return the faults of a polyhedron; those that make others meaningless end the search."""
    coarse = _unusable(points, faces, holes)
    if coarse is not None:
        return (coarse,)
    top = topology(tuple(faces), tuple(holes))
    size = float(np.ptp(points[top.start], axis=0).max())
    if top.fault is not None:
        crossed = _crossed_any_way(points, faces, size) if top.fault[0] != "shared" else None
        return (crossed or _not_closed(points, top, size),)
    area = top.area_vectors(points)
    length = np.linalg.norm(area, axis=1)
    flat = np.flatnonzero(length <= 1e-12 * size * size)
    if len(flat):
        face = int(flat[0])
        at = points[faces[face][0]]
        text = f"face {face + 1} has no area {place(at)}"
        return (SolidFault("no area", face, at, 0.0, text, "delete it and join its neighbours"),)
    normal = area / length[:, None]
    faults = _out_of_plane(points, top, normal, planar * size)
    if not faults:
        faults = _crossing(points, faces, holes, top, normal)
    middle = points[top.start].mean(0)
    volume = float(((points[top.corners[0]] - middle) * top.spanned(points)).sum()) / 6
    if not faults and abs(volume) <= 1e-9 * size**3:
        faults = [SolidFault("no volume", -1, middle, 0.0, f"the faces enclose no volume {place(middle)}", "delete it")]
    elif not faults and volume < 0:
        text = f"the faces point inwards: the volume they enclose is {volume:.4g} m3"
        hint = "the vertices of each face run counter-clockwise seen from outside: reverse all of them"
        faults = [SolidFault("inside out", -1, middle, 0.0, text, hint)]
    if not faults:
        faults = _piercing(points, faces, holes, top, normal, size)
    return tuple(faults)


def place(at: Array) -> str:
    """Return a point as text."""
    return f"at ({at[0]:.6g}, {at[1]:.6g}, {at[2]:.6g}) m"


def _unusable(points: Array, faces: Sequence[Loop], holes: Sequence[tuple[int, Loop]]) -> SolidFault | None:
    nowhere = np.full(3, np.nan)

    def fault(kind: SolidFaultKind, text: str, hint: str, face: int = -1) -> SolidFault:
        return SolidFault(kind, face, nowhere, 0.0, text, hint)

    if points.ndim != 2 or points.shape[1] != 3:
        return fault("not finite", f"vertices have shape {points.shape}, expected (n, 3)", "give x, y, z of each")
    if not np.isfinite(points).all():
        return fault("not finite", "a vertex holds a coordinate that is not finite", "give numbers in m")
    if len(points) and np.abs(points).max() >= LARGEST_COORDINATE:
        text = f"a vertex holds a coordinate of {np.abs(points).max():g} m"
        return fault("not finite", text, "no structure is that large: look at the number, and at its unit")
    if len(points) > MOST_VERTICES:
        text = f"{len(points):,} vertices are more than the {MOST_VERTICES:,} a block may have"
        return fault("too many", text, "a scanned surface is not a block: simplify it, or split it into blocks")
    if len(faces) < 4:
        return fault("too few", f"{len(faces)} faces close no volume", "a polyhedron has at least 4")
    if _indices_are_right(tuple(faces), tuple(holes), len(points)):
        return None
    loops = [*enumerate(faces), *holes]
    for face, loop in loops:
        if not 0 <= face < len(faces):
            text = f"a hole belongs to face {face + 1}, but there are {len(faces)}"
            return fault("index", text, "faces of holes are numbered from 0")
        missing = [v for v in loop if not 0 <= v < len(points)]
        if missing:
            text = f"face {face + 1} uses vertex {missing[0]}, but there are {len(points)} vertices"
            return fault("index", text, "vertices of faces are numbered from 0", face)
        if len(set(loop)) < 3:
            text = f"face {face + 1} has {len(set(loop))} different vertices"
            return fault("too few", text, "a face needs at least 3", face)
        if len(set(loop)) < len(loop):
            twice = next(v for v in loop if loop.count(v) > 1)
            at = points[twice]
            text = f"face {face + 1} meets vertex {twice} twice {place(at)}"
            return SolidFault("double vertex", face, at, 0.0, text, "split the face, or delete the repetition")
    return None


@lru_cache(maxsize=4096)
def _indices_are_right(faces: tuple[Loop, ...], holes: tuple[tuple[int, Loop], ...], count: int) -> bool:
    loops = [*enumerate(faces), *holes]
    return all(
        0 <= face < len(faces) and len(set(loop)) == len(loop) >= 3 and min(loop) >= 0 and max(loop) < count
        for face, loop in loops
    )


def _not_closed(points: Array, top: Topology, size: float) -> SolidFault:
    """Return the fault of faces that do not close, distinguished from vertices that were not put together."""
    assert top.fault is not None
    kind, p, q, number = top.fault
    at = 0.5 * (points[p] + points[q])
    edge = f"the edge from vertex {p} to vertex {q} {place(at)}"
    more = f", and {number - 1} more such edges" if number > 1 else ""
    if kind == "open":
        used = np.unique(top.start)
        rounded = np.unique(np.round(points[used] / (DOUBLE * size or 1.0)), axis=0)
        if len(rounded) < len(used):
            double = len(used) - len(rounded)
            text = f"the surface is open: {double} vertices coincide with others, and {edge} has one face"
            return SolidFault("double vertex", -1, at, 0.0, text + more, _HINTS["open"])
        face = int(top.face[np.flatnonzero(np.minimum(top.start, top.end) == p)[0]])
        text = f"the surface is open: {edge} belongs to one face only{more}"
        return SolidFault("open", face, at, 0.0, text, _HINTS["open"])
    on = np.flatnonzero((np.minimum(top.start, top.end) == p) & (np.maximum(top.start, top.end) == q))
    a, b = (int(f) for f in top.face[on[:2]])
    if kind == "turned":
        text = f"faces {a + 1} and {b + 1} run the same way along {edge}: one of them is turned over{more}"
        return SolidFault("turned", b, at, 0.0, text, _HINTS["turned"])
    return SolidFault("shared", b, at, 0.0, f"{len(on)} faces share {edge}{more}", _HINTS["shared"])


def _out_of_plane(points: Array, top: Topology, normal: Array, tolerance: float) -> list[SolidFault]:
    at = points[top.start]
    middle = top.by_face(at) / top.sides_of_face[:, None]
    off = np.abs(((at - middle[top.face]) * normal[top.face]).sum(1))
    worst = np.zeros(len(middle))
    np.maximum.at(worst, top.face, off)
    found = []
    for face in np.flatnonzero(worst > tolerance):
        side = int(np.argmax(np.where(top.face == face, off, -1.0)))
        where = points[top.start[side]]
        text = (
            f"face {face + 1} is not planar: vertex {top.start[side]} {place(where)} stands {1e3 * off[side]:.4g} mm "
            "off its plane"
        )
        hint = "split the face into triangles, or move the vertex into the plane"
        found.append(SolidFault("out of plane", int(face), where, float(off[side]), text, hint))
    return found


def _crossed_any_way(points: Array, faces: Sequence[Loop], size: float) -> SolidFault | None:
    """Return a face that crosses itself in the plane that fits it best: the usual reason why faces do not close."""
    for number, face in enumerate(faces):
        at = points[list(face)]
        middle = at.mean(0)
        _, spread, axes = np.linalg.svd(at - middle)
        if len(face) < 4 or spread[2] > PLANAR * size or spread[1] < 1e-9 * size:
            continue
        flat = (at - middle) @ axes[:2].T
        for j in range(len(face)):
            for k in range(j + 2, len(face) - (j == 0)):
                sides = shapely.linestrings([flat[[j, j + 1]], np.array([flat[k], flat[(k + 1) % len(face)]])])
                if shapely.crosses(*sides):
                    meet = shapely.intersection(*sides)
                    where = middle + np.array([meet.x, meet.y]) @ axes[:2]
                    text = f"face {number + 1} crosses itself {place(where)}"
                    hint = "list its vertices in order round the face"
                    return SolidFault("crossing", number, where, 0.0, text, hint)
    return None


def _crossing(
    points: Array, faces: Sequence[Loop], holes: Sequence[tuple[int, Loop]], top: Topology, normal: Array
) -> list[SolidFault]:
    """Return the faces whose boundary crosses or touches itself; convex ones are seen to be sound at once."""
    t1, t2 = np.moveaxis(tangents(normal), 1, 0)
    along = points[top.end] - points[top.start]
    flat = np.column_stack([(along * t1[top.face]).sum(1), (along * t2[top.face]).sum(1)])
    turn = turning(flat, flat[top.following])
    least = np.minimum.reduceat(turn, top.first)
    convex = (least > -1e-6) & (np.add.reduceat(turn, top.first) < 2.5 * np.pi)
    suspect = np.unique(top.face[top.first[~convex]])
    with_holes = {face for face, _ in holes}
    found = []
    for face in suspect.tolist():
        loops = [faces[face], *(loop for number, loop in holes if number == face)]
        frame = np.stack([t1[face], t2[face]], 1)
        origin = points[loops[0][0]]
        rings = [(points[list(loop)] - origin) @ frame for loop in loops]
        shape = shapely.Polygon(rings[0], rings[1:])
        if shape.is_valid:
            continue
        reason = shapely.is_valid_reason(shape)
        word, _, where = reason.partition("[")
        at = np.array([float(v) for v in where.rstrip("]").split()[:2]]) if where else rings[0][0]
        place3 = origin + frame @ at
        what = "crosses itself" if "Self" in word or "Ring" in word else "has holes that do not lie inside it"
        text = f"face {face + 1} {what} {place(place3)}"
        hint = "list its vertices in order round the face" if face not in with_holes else "check its holes"
        found.append(SolidFault("crossing", face, place3, 0.0, text, hint))
    return found


def _piercing(
    points: Array, faces: Sequence[Loop], holes: Sequence[tuple[int, Loop]], top: Topology, normal: Array, size: float
) -> list[SolidFault]:
    """Return where an edge of a block that is not convex pierces one of its own faces."""
    offset = top.by_face((points[top.start] * normal[top.face]).sum(1)) / top.sides_of_face
    height = points @ normal.T - offset  # (n, f)
    if height.max() <= 1e-6 * size:
        return []
    p, q = top.edges.T
    through = (height[p] * height[q] < 0) & (np.minimum(np.abs(height[p]), np.abs(height[q])) > 1e-6 * size)
    edge, face = np.nonzero(through)
    frame = tangents(normal)
    for number in np.unique(face).tolist():
        own = edge[face == number]
        share = height[p[own], number] / (height[p[own], number] - height[q[own], number])
        at = points[p[own]] + share[:, None] * (points[q[own]] - points[p[own]])
        rings = [points[list(faces[number])], *(points[list(loop)] for f, loop in holes if f == number)]
        flat = [ring @ frame[number].T for ring in rings]
        shape = shapely.Polygon(flat[0], flat[1:]).buffer(-1e-6 * size)
        inside = np.flatnonzero(shapely.contains_xy(shape, *(at @ frame[number].T).T))
        if len(inside):
            k = int(inside[0])
            edge_words = f"the edge from vertex {p[own[k]]} to vertex {q[own[k]]}"
            text = f"{edge_words} pierces face {number + 1} {place(at[k])}: the block runs through itself"
            return [SolidFault("piercing", number, at[k], 0.0, text, "make two blocks of it, or mend its surface")]
    return []
