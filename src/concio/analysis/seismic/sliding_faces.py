"""Faces on which macro-blocks slide: which points of a joint are needed, and where its faces begin and end."""

from __future__ import annotations

import numpy as np

from concio.contact.assembly import Assembly
from concio.kinematics.frames import turned_left

Array = np.ndarray

SAME_LINE = 1e-5
"""Edges that lie within this share of the size of a body of one line are on it, and meet where they come so near."""


def face_of(assembly: Assembly, k: int) -> int:
    """Return 0 where the point of a pair is a corner of its side b, so that the face is that of a; else 1."""
    corners = [
        float(
            np.linalg.norm(
                np.asarray(assembly.model.bodies[int(side[k])].vertices) - assembly.pairs.point[k], axis=1
            ).min()
        )
        for side in (assembly.pairs.body_a, assembly.pairs.body_b)
    ]
    return 0 if corners[1] <= corners[0] else 1


def face_ends(assembly: Assembly, macro: Array, k: int, face: int) -> tuple[float, float]:
    """Return where the face of a pair begins and ends along its tangent, from its point [m]; of plane models.

    A face goes on over the bodies of its macro-block whose edges lie in one line and meet. That of a fixed body which
    goes on beyond the joint by more than the joint is long is ground, which ends nowhere: where its drawing ends says
    nothing.

    Parameters
    ----------
    assembly : Assembly
    macro : (B,) integer array
        Macro-block of each body.
    k : int
    face : {0, 1}
        Whether the face belongs to body a or to body b of the pair.
    """
    body = int(assembly.pairs.body_b[k] if face else assembly.pairs.body_a[k])
    low, high = _drawn(assembly, macro, k, face)
    if assembly.model.bodies[body].kind == "fixed":
        first, last = _drawn(assembly, macro, k, 1 - face)
        length = min(last, high) - max(first, low)
        low = -np.inf if first - low > length else low
        high = np.inf if high - last > length else high
    return low, high


def _drawn(assembly: Assembly, macro: Array, k: int, face: int) -> tuple[float, float]:
    """Return where the face of a pair begins and ends as it is drawn [m]."""
    pairs, bodies = assembly.pairs, assembly.model.outlines
    body = int(pairs.body_b[k] if face else pairs.body_a[k])
    outward = -pairs.normal[k] if face else pairs.normal[k]
    tangent = pairs.tangents[k, 0]
    near = SAME_LINE * float(np.ptp(bodies[body].outline, axis=0).max())
    spans: list[tuple[float, float]] = []
    for i in np.flatnonzero(macro == macro[body]):
        arm = np.asarray(bodies[i].outline) - pairs.point[k]
        then = np.roll(arm, -1, axis=0)
        area = float((turned_left(arm) * then).sum())
        looks = np.sign(area) * (turned_left(then - arm) @ outward) < 0
        on_line = np.maximum(np.abs(arm @ outward), np.abs(then @ outward)) <= near
        at, to = arm @ tangent, then @ tangent
        spans += [(min(at[j], to[j]), max(at[j], to[j])) for j in np.flatnonzero(on_line & looks)]
    low = high = 0.0
    for _ in spans:
        met = [(a, b) for a, b in spans if a <= high + near and b >= low - near]
        wider = min([low, *(a for a, _ in met)]), max([high, *(b for _, b in met)])
        if wider == (low, high):
            break
        low, high = wider
    return float(low), float(high)


def ends_of_sliding(assembly: Assembly, macro: Array, loaded: Array, slides: Array) -> tuple[Array, Array]:
    """Return the pairs that joints between macro-blocks are made of, and the cohesion (m,) [kN] of each; in the plane.

    Where two macro-blocks slide on each other along a line, two points at the ends of what touches carry all that can
    be carried there with one friction, whichever of the pairs between them had forces at the onset; with more points
    the forces would not be determined.

    Parameters
    ----------
    assembly : Assembly
    macro : (B,) integer array
        Macro-block of each body.
    loaded : (n,) integer array
        Pairs between macro-blocks that have forces.
    slides : (m,) boolean array
        Pairs that slide and do not open, loaded or not.
    """
    pairs, law = assembly.pairs, assembly.laws
    cohesion = law.cohesion.copy()
    kept: list[int] = []
    seen = np.zeros(len(pairs), dtype=bool)
    own = np.array([macro[pairs.body_a], macro[pairs.body_b]])
    size = SAME_LINE * np.array([float(np.ptp(b.outline, axis=0).max()) for b in assembly.model.outlines])
    for k in loaded:
        if seen[k]:
            continue
        line = np.array([k])
        if slides[k] and pairs.interface[k] >= 0:
            alike = slides & (pairs.interface >= 0) & (own.min(0) == own[:, k].min()) & (own.max(0) == own[:, k].max())
            near = min(size[pairs.body_a[k]], size[pairs.body_b[k]])
            alike &= np.abs((pairs.point - pairs.point[k]) @ pairs.normal[k]) <= near
            alike &= (np.abs(pairs.normal @ pairs.normal[k]) >= 1.0 - SAME_LINE) & (pairs.gap <= near)
            if np.ptp(law.friction[alike]) == 0:
                line = np.flatnonzero(alike)
        seen[line] = True
        if len(line) == 1:
            kept.append(int(k))
            continue
        along = pairs.point[line] @ pairs.tangents[k, 0]
        ends = [int(line[np.argmin(along)]), int(line[np.argmax(along)])]
        cohesion[ends] = law.cohesion[line].sum() / 2
        kept += ends
    return np.array(kept, dtype=int), cohesion


def ends_set_back(assembly: Assembly, macro: Array, k: int, depth: float) -> list[tuple[Array, int, float, float]]:
    """Return the ends of a joint that crushes while it slides: point, face, and where this face begins and ends [m].

    The contact force stands within ``depth`` [m] of the ends of what touches nowhere: there its joint is crushed.
    """
    lows, highs = zip(*(face_ends(assembly, macro, k, face) for face in (0, 1)), strict=True)
    low, high = max(lows), min(highs)
    depth = min(depth, (high - low) / 2)
    found = []
    for at, corners in ((low + depth, lows), (high - depth, highs)):
        face = 0 if abs(corners[1]) <= abs(corners[0]) else 1  # the corner of b, or of both, slides on the face of a
        point = assembly.pairs.point[k] + at * assembly.pairs.tangents[k, 0]
        found.append((point, face, lows[face] + depth - at, highs[face] - depth - at))
    return found
