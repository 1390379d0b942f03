"""Blocks that rest on joints of a few millimetres alone: what they carry hangs on the accuracy of a drawing."""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np

from concio.display import counted
from concio.model.interfaces.detect import Detection, Interface
from concio.model.interfaces.patch import Patch
from concio.model.model import Model
from concio.model.polyhedron import Polyhedron
from concio.verdict.connection import held_bodies

NARROW = 0.01
"""Bearings are wider [m]."""
SHARE = 0.02
"""Narrower bearings are reported below this share of the thickness of a block: ends of mortar films are as narrow."""
UPWARDS = 0.3
"""A joint whose normal rises by less carries no block from below."""
MOST_NAMES = 3


def narrow_bearings(model: Model, detection: Detection) -> tuple[str, ...]:
    """Return in a sentence which blocks rest on joints of a few millimetres alone.

    Parameters
    ----------
    model : Model
    detection : Detection
    """
    if model.periods is not None:
        return ()
    bearings: dict[int, dict[int, float]] = defaultdict(lambda: defaultdict(float))
    for face in detection.faces:
        up = float(face.normal[-1])
        if abs(up) > UPWARDS:
            carried, carries = (face.b, face.a) if up > 0 else (face.a, face.b)
            bearings[carried][carries] += _width(face)
    held = held_bodies(model)
    widest = {
        b: max(own.values()) for b, own in sorted(bearings.items())
        if model.bodies[b].kind != "fixed" and model.bodies[b].name not in held
    }  # fmt: skip
    found = [
        f"'{model.bodies[b].name}' ({width:.3g} m)"
        for b, width in widest.items()
        if width < NARROW and width < SHARE * _thickness(model, b)
    ]
    if not found:
        return ()
    more = f" and {len(found) - MOST_NAMES:,} more" if len(found) > MOST_NAMES else ""
    rest = counted(len(found), "block rests", "blocks rest")
    return (
        f"{rest} on joints narrower than {NARROW:g} m alone: {'; '.join(found[:MOST_NAMES])}{more}: "
        "are these bearings meant?",
    )


def _width(face: Interface | Patch) -> float:
    """Return the width of a joint, or what shows that it is not narrow: area over diameter, which is less [m]."""
    if isinstance(face, Patch):
        low, high = face.polygon.min(0), face.polygon.max(0)
        least = face.area / math.dist(low, high)
        if least >= NARROW:
            return least
    return face.width


def _thickness(model: Model, b: int) -> float:
    """Return the thickness of a body: of a film its own, of a square or a cube the side [m]."""
    body = model.bodies[b]
    if isinstance(body, Polyhedron):
        return 6.0 * body.volume / float(np.sum(body.face_areas))
    return 4.0 * body.area / sum(float(np.linalg.norm(np.roll(r, -1, axis=0) - r, axis=1).sum()) for r in body.rings)
