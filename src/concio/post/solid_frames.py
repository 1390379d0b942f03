"""Frames of a motion in space: surfaces of the blocks once, and where each stands frame by frame."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.push_result import PushResult
from concio.kinematics.spins import turned_by
from concio.post.motion_frames import MOST, positions
from concio.post.solids import Solids, model_solids

Array = np.ndarray

PAD = 0.06
"""Margin around what moves, over its largest side."""


@dataclass(frozen=True, eq=False)
class SolidFrames:
    """A motion of B bodies in n frames.

    Parameters
    ----------
    shown : Solids
        Surfaces where the bodies were described.
    at : (n,) array
        Times [s], or controlled displacements [m].
    words : tuple of str
    points : (n, P, 3) array
        Points of the surfaces where they stand [m].
    centre : (n, B, 3) array
        Centroids [m].
    rotation : (n, B, 3, 3) array
    """

    shown: Solids
    at: Array
    words: tuple[str, ...]
    points: Array
    centre: Array
    rotation: Array

    def moved(self, k: int) -> Solids:
        """Return the surfaces as they stand in a frame."""
        return replace(self.shown, displacement=self.points[k] - self.shown.points)

    @property
    def turned(self) -> Array:
        """By how much bodies have turned from where they were described (n, B) [rad]."""
        return np.stack([turned_by(rotation) for rotation in self.rotation])

    def box(self, moving: Array) -> Array:
        """Return lower and upper corner (2, 3) around bodies that move, a mask (B,), in all frames [m]."""
        own = self.points[:, np.repeat(moving, np.diff(self.shown.starts))].reshape(-1, 3)
        low, high = own.min(axis=0), own.max(axis=0)
        pad = PAD * float((high - low).max())
        return np.array([low - pad, high + pad])


def solid_frames(result: PushResult | DynamicsResult, most: int = MOST) -> SolidFrames:
    """Return frames of a motion in space, evenly chosen.

    Parameters
    ----------
    result : PushResult or DynamicsResult
        Of a model in space.
    most : int
        Frames at most.
    """
    at, words = positions(result)
    chosen = np.unique(np.linspace(0, len(at) - 1, min(most, len(at))).round().astype(int))
    source = result if isinstance(result, PushResult) else result.shots
    centre, rotation = source.centre[chosen], source.rotation[chosen]
    shown, disc = model_solids(result.model), result.reference.disc
    body = np.repeat(np.arange(len(disc.centroids)), np.diff(shown.starts))
    arm = shown.points - disc.centroids[body]
    points = centre[:, body] + np.einsum("npij,pj->npi", rotation[:, body], arm)
    named = tuple(words[k] for k in chosen.tolist())
    return SolidFrames(shown, np.asarray(at)[chosen], named, points, centre, rotation)
