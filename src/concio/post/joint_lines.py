"""Joints as drawn: the piece of joint that belongs to each contact pair, on both sides, where it has moved to."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from concio.post.outlines import Outlines
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray

MARK = 0.25
"""Length of the mark of a corner that touches, over the size of the smaller body."""


@short_repr
@dataclass(frozen=True, eq=False)
class JointLines:
    """Pieces of joints, k in all; ties are left out.

    Parameters
    ----------
    pair : (k,) integer array
        The contact pair of each piece.
    ends : (k, 2, 2) array
        Start and end of each piece as it was drawn [m].
    moved_a, moved_b : (k, 2, 2) arrays
        Displacements of these ends on side a and on side b [m].
    """

    pair: Array
    ends: Array
    moved_a: Array
    moved_b: Array

    def side(self, name: str, scale: float = 1.0) -> Array:
        """Return the pieces (k, 2, 2) on side "a", "b" or in the "middle" with displacements times ``scale`` [m]."""
        motion = {"a": self.moved_a, "b": self.moved_b, "middle": (self.moved_a + self.moved_b) / 2}[name]
        lines: Array = self.ends + scale * motion
        return lines

    def openings(self, scale: float = 1.0) -> Array:
        """Return the quadrilaterals (k, 4, 2) between the two sides [m]."""
        return np.concatenate([self.side("a", scale), self.side("b", scale)[:, ::-1]], axis=1)


def joint_lines(result: Result, shown: Outlines) -> JointLines:
    """Return the pieces of all joints, moved with the outlines ``shown``.

    Each interface is cut into as many pieces as it has pairs, each as long as the pair's tributary length; where bodies
    touch with a corner, the piece is a short mark along the joint.
    """
    parts = _face_lines(result, shown), _point_marks(result, shown)
    return JointLines(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(JointLines)))


def _point_marks(result: Result, shown: Outlines) -> JointLines:
    """Return a mark at each corner or edge on which bodies touch without a common face, moved with both bodies."""
    pairs, detection = result.assembly.pairs, result.assembly.detection
    first = len(detection.segments)
    pair = np.flatnonzero(pairs.interface >= first)
    size = np.array([MARK * detection.interfaces[k].scale for k in pairs.interface[pair].tolist()])
    half = 0.5 * size[:, None] * pairs.tangent[pair]
    ends = pairs.point[pair][:, None] + np.stack([-half, half], axis=1)
    moved = []
    for body in (pairs.body_a[pair], pairs.body_b[pair]):
        at = [_displacement(shown, b, p) for b, p in zip(body.tolist(), pairs.point[pair], strict=True)]
        moved.append(np.repeat(np.array(at).reshape(-1, 1, 2), 2, axis=1))
    return JointLines(pair, ends.reshape(-1, 2, 2), *moved)


def _displacement(shown: Outlines, body: int, point: Array) -> Array:
    """Return the displacement (2,) of the place on the outline of a body that is nearest to a point [m]."""
    own = slice(*shown.starts[body : body + 2].tolist())
    start, arc = shown.points[own], shown.arc[own]
    way, long = np.diff(start, axis=0), np.diff(arc)
    square = np.maximum((way**2).sum(axis=1), 1e-300)
    share = np.clip(((point - start[:-1]) * way).sum(axis=1) / square, 0.0, 1.0)
    away = np.linalg.norm(start[:-1] + share[:, None] * way - point, axis=1)
    away[np.isin(np.arange(own.start + 1, own.stop), shown.rings)] = np.inf  # from one ring to the next
    k = int(away.argmin())
    return np.asarray(shown.at(np.array([arc[k] + share[k] * long[k]]))[0])


def _face_lines(result: Result, shown: Outlines) -> JointLines:
    """Return the pieces of joints of faces."""
    pairs = result.assembly.pairs
    faces = result.assembly.detection.segments
    pair = np.flatnonzero((pairs.interface >= 0) & (pairs.interface < len(faces)))
    if not len(pair):
        empty = np.zeros((0, 2, 2))
        return JointLines(pair, empty, empty, empty)
    along = (pairs.point[pair] * pairs.tangent[pair]).sum(1)
    pair = pair[np.lexsort((along, pairs.interface[pair]))]
    face = pairs.interface[pair]
    first = np.concatenate([[True], face[1:] != face[:-1]])
    length = pairs.length[pair]
    total = np.cumsum(length)
    begin = (total - length)[first]
    offset = begin[np.cumsum(first) - 1]
    low, high = total - length - offset, total - offset
    start = np.array([f.start for f in faces])[face]
    tangent = pairs.tangent[pair]
    ends = start[:, None] + np.stack([low, high], axis=1)[:, :, None] * tangent[:, None]
    moved = []
    for side in ("a", "b"):
        edge = np.array([shown.edges[getattr(f, side)][getattr(f, f"edge_{side}")] for f in faces])
        corner = np.array([result.model.outlines[getattr(f, side)].vertices[getattr(f, f"edge_{side}")] for f in faces])
        shift = np.array([f.shift if side == "b" else (0.0, 0.0) for f in faces])  # of images across a cell's edge
        corner = corner + shift
        away = np.abs(((ends - corner[face][:, None]) * tangent[:, None]).sum(-1))
        arc = np.minimum(edge[face, :1] + away, edge[face, 1:])
        moved.append(shown.at(arc.ravel()).reshape(-1, 2, 2) + (shift @ shown.strain.T)[face][:, None])
    return JointLines(pair, ends, moved[0], moved[1])
