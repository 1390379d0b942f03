"""Blocks that move: models for the tests of large displacements and dynamics."""

from __future__ import annotations

import numpy as np

import concio
from models import box, model_of, weight

G = 9.81
"""Gravity of the oracles [m/s2]; pass it to every motion."""


def standing(width=0.4, height=1.2, friction=1.0, tilt=0.0, kind="rigid", at=(0.0, 0.0), **options):
    """A block on a wide floor, turned by ``tilt`` (anticlockwise) about the foot it then stands on."""
    half = 0.5 * width
    outline = np.array([(-half, 0.0), (half, 0.0), (half, height), (-half, height)])
    foot = np.array([-half if tilt > 0 else half, 0.0])
    c, s = np.cos(tilt), np.sin(tilt)
    outline = (outline - foot) @ np.array([[c, s], [-s, c]]) + foot + np.array(at)
    if kind == "rigid":
        options = {"material": "stone", **options}
    block = concio.Body("block", outline, kind=kind, **options)
    floor = box("floor", -30.0, 30.0, -1.0, 0.0, kind="fixed")
    return model_of(floor, block, law=friction, loads=(weight(),))
