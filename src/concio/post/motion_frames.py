"""Frames of a motion: where the bodies stand, frame by frame, with a word for each; of pushes and of dynamics alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.push_result import PushResult
from concio.model.model import Model

Array = np.ndarray

MOST = 400
"""Frames of an animation at most; of more, some evenly chosen."""


@dataclass(frozen=True, eq=False)
class Frame:
    """One picture of a motion.

    Parameters
    ----------
    number : int
        Of the point of the curve, or of the shot.
    at : float
        Time [s], or controlled displacement [m].
    word : str
    rings : tuple of tuples of (n, 2) arrays
        Outline and holes of each body [m].
    """

    number: int
    at: float
    word: str
    rings: tuple[tuple[Array, ...], ...]


def positions(result: PushResult | DynamicsResult) -> tuple[Array, list[str]]:
    """Return time or displacement of every frame, and a word for each."""
    if isinstance(result, PushResult):
        pairs = zip(result.displacement.tolist(), result.multiplier.tolist(), strict=True)
        return result.displacement, [f"{1e3 * d:.1f} mm, multiplier {load:.4f}" for d, load in pairs]
    return result.shots.time, [f"{t:.3f} s" for t in result.shots.time.tolist()]


def frames(result: PushResult | DynamicsResult, most: int = MOST) -> list[Frame]:
    """Return frames of a motion, evenly chosen: by number for a push, by time for dynamics."""
    at, words = positions(result)
    chosen = np.unique(np.linspace(0, len(at) - 1, min(most, len(at))).round().astype(int)).tolist()
    found = []
    for k in chosen:
        standing = result.configuration(k)
        rings = tuple(standing.rings(b) for b in range(len(result.model.bodies)))
        found.append(Frame(k, float(at[k]), words[k], rings))
    return found


def box_of(pictures: Sequence[Frame], model: Model) -> Array:
    """Return lower and upper corner (2, 2) of what moves in all frames, fixed bodies where they are near [m]."""
    free = [b for b, body in enumerate(model.bodies) if body.kind != "fixed"]
    points = np.concatenate([ring for f in pictures for b in free for ring in f.rings[b]])
    low, high = points.min(0), points.max(0)
    pad = 0.08 * float((high - low).max())
    return np.array([low - pad, high + pad])
