"""The faces that a load along a line acts on: of the two faces of a joint only one, unless both are asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.arguments import closest
from concio.contact.separate import surroundings
from concio.errors import InputError
from concio.kinematics.frames import turned_left, turned_right
from concio.model.model import Load, Model, called

Array = np.ndarray

UPRIGHT = float(np.sin(np.deg2rad(10.0)))
"""Joints whose normal rises by less than this have no lower face."""
SIDES: dict[str, tuple[int, float]] = {"lower": (-1, 1.0), "upper": (-1, -1.0), "left": (0, 1.0), "right": (0, -1.0)}
"""Component (the last is the vertical) and sign of the outward normal of each face of a joint: the lower one is the top
of the body below."""


@dataclass(frozen=True, eq=False)
class LoadedFace:
    """Parts of one edge of a body that a load acts on.

    Parameters
    ----------
    body, edge : int
        Number of the body, and of the edge in its outline.
    parts : tuple of (float, float)
        Where the load begins and ends, from the first vertex of the edge [m].
    inward : (2,) array
        Unit normal into the body.
    on_line : tuple of (float, float)
        The same parts, from the first end of the line of the load [m].
    in_joint : float
        Length of these parts on whose other side another body lies that the load could act on as well [m].
    """

    body: int
    edge: int
    parts: tuple[tuple[float, float], ...]
    inward: Array
    on_line: tuple[tuple[float, float], ...]
    in_joint: float = 0.0

    @property
    def length(self) -> float:
        """Length that is loaded [m]."""
        return sum(stop - start for start, stop in self.parts)


@dataclass(frozen=True, eq=False)
class _Found:
    """An edge on the line of a load: body, edge, its interval on the line [m], how it runs, its outward normal."""

    body: int
    edge: int
    low: float
    high: float
    first: float
    forwards: float
    outward: Array


def loaded_bodies(model: Model, load: Load) -> list[int]:
    """Return the numbers of the bodies that a load may act on.

    Raises
    ------
    InputError
        The load names a body that does not exist or is fixed.
    """
    bodies = model.bodies
    if not load.bodies:
        return [i for i, b in enumerate(bodies) if b.kind != "fixed"]
    chosen = []
    for word in load.bodies:
        found = [i for i, b in enumerate(bodies) if b.kind != "fixed" and called(word, b)]
        if not found:
            msg = f"a {load.kind} load acts on '{word}', but no free body has that name, role or layer"
            known = dict.fromkeys(w for b in bodies if b.kind != "fixed" for w in (b.role, b.layer, b.name) if w)
            raise InputError(msg, where=f"load group '{load.group}'", hint=closest(word, known))
        chosen.extend(found)
    return sorted(set(chosen))


def loaded_faces(model: Model, load: Load) -> list[LoadedFace]:
    """Return the faces that a pressure or traction acts on.

    Where two of the bodies meet in a joint under the line, the load acts on one face: the one ``load.face`` names, by
    default the lower one, which is the top of the body below.

    Raises
    ------
    InputError
        The load has no edge, lies on no edge of a body, names a face its joint does not have, or lies in a vertical
        joint and names none.
    """
    where = f"load group '{load.group}'"
    if load.edge is None:
        msg = f"a {load.kind} load needs an edge"
        raise InputError(msg, where=where, hint="give the two ends of the loaded line")
    p, q = (np.array(end, dtype=float) for end in load.edge)
    length = float(np.linalg.norm(q - p))
    if length == 0:
        msg = f"the edge of a {load.kind} load has no length"
        raise InputError(msg, where=where, hint="use a point load")
    tolerance = line_tolerance(model, load)
    found = _on_line(model, loaded_bodies(model, load), p, (q - p) / length, length, tolerance)
    line = f"from ({p[0]:g}, {p[1]:g}) to ({q[0]:g}, {q[1]:g}) m"
    if not found:
        msg = f"the {load.kind} load {line} lies on no edge of a body"
        raise InputError(msg, where=where, hint="give coordinates on the outline of a block")
    result = []
    for face in found:
        others = [
            o
            for o in found
            if o.body != face.body
            and o.outward @ face.outward < 0
            and min(o.high, face.high) - max(o.low, face.low) > tolerance
        ]
        parts = [(face.low, face.high)]
        shared = 0.0
        for other in others:
            low, high = max(other.low, face.low), min(other.high, face.high)
            if load.face != "both" and not prefers(load, face.outward, f"{load.kind} load {line}", where):
                parts = _without(parts, low, high, tolerance)
            else:
                shared += high - low
        if parts:
            along = [sorted((face.forwards * (a - face.first), face.forwards * (b - face.first))) for a, b in parts]
            own = tuple((a, b) for a, b in along)
            result.append(LoadedFace(face.body, face.edge, own, -face.outward, tuple(parts), shared))
    return result


def line_tolerance(model: Model, load: Load) -> float:
    """Return how far an edge may lie from the line or polygon of a load [m].

    1e-6 of the size of the structure that it lies on, and at least twice the gap tolerance, for joints wobble by it.
    """
    around, bodies = surroundings(model), loaded_bodies(model, load)
    points = np.array(load.edge if load.polygon is None else load.polygon, dtype=float)
    slack = 1e-6 * around.size[bodies, None]
    apart = (around.low[bodies] - slack > points.max(axis=0)) | (around.high[bodies] + slack < points.min(axis=0))
    near = around.size[bodies][~apart.any(axis=1)]
    return max(1e-6 * float(near.max(initial=0.0)), 2 * (model.gap_tolerance or 0.0))


def _on_line(model: Model, chosen: list[int], p: Array, along: Array, length: float, tolerance: float) -> list[_Found]:
    across = turned_left(along)
    found = []
    for b in chosen:
        vertices, following = model.outlines[b].vertices, model.outlines[b].following
        off = np.abs((vertices - p) @ across) <= tolerance
        for e in np.flatnonzero(off & off[following]).tolist():
            a, c = vertices[e], vertices[following[e]]
            direction = (c - a) / float(np.linalg.norm(c - a))
            first, last = float((a - p) @ along), float((c - p) @ along)
            low, high = max(min(first, last), 0.0), min(max(first, last), length)
            if high - low > tolerance:
                outward = turned_right(direction)
                found.append(_Found(b, e, low, high, first, 1.0 if last > first else -1.0, outward))
    return found


def prefers(load: Load, outward: Array, what: str, where: str) -> bool:
    """Tell whether the face of a joint with this outward normal is the one that a load acts on."""
    rise = abs(float(outward[-1]))
    named = load.face or ("lower" if rise >= UPRIGHT else "")
    if not named:
        msg = f"the {what} lies in a vertical joint, which has two faces"
        raise InputError(msg, where=where, hint="say which with face = 'left', 'right' or 'both', or name one body")
    component, sign = SIDES[named]
    if abs(float(outward[component])) < UPRIGHT:
        msg = f"the {what} lies in a joint that has no {named} face"
        fitting = "'left' or 'right'" if component == -1 else "'lower' or 'upper'"
        raise InputError(msg, where=where, hint=f"take face = {fitting}")
    return bool(sign * outward[component] > 0)


def _without(
    parts: list[tuple[float, float]], low: float, high: float, tolerance: float
) -> list[tuple[float, float]]:
    """Return intervals without what lies between ``low`` and ``high``; slivers go too."""
    pieces = [piece for a, b in parts for piece in ((a, min(b, low)), (max(a, high), b))]
    return [(a, b) for a, b in pieces if b - a > tolerance]


def covered(faces: Sequence[LoadedFace]) -> float:
    """Return the length of the line of a load that lies on a face, parts on two faces counted once [m]."""
    total, reached = 0.0, -np.inf
    for low, high in sorted(part for face in faces for part in face.on_line):
        total += max(high - max(low, reached), 0.0)
        reached = max(reached, high)
    return total
