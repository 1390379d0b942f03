"""What was traced in a picture: regions of pixels, shared outlines, joints with their doubts, the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from scipy import ndimage

from concio.arguments import strict
from concio.errors import InputError
from concio.model.actions import Load
from concio.model.body import Body
from concio.model.materials import JointLaw, Rigid
from concio.model.model import Model
from concio.model.picture.photo import Photo
from concio.model.picture.shared_boundaries import shared_outlines
from concio.representation import short_repr

Array = np.ndarray
Point = tuple[float, float]


@short_repr
@dataclass(frozen=True)
class TracedJoint:
    """A joint that was traced.

    Parameters
    ----------
    kind : {"bed", "head", "joint"}
    ends : (point, point)
        [m].
    strength : float
        How clear it is: in deviations of the noise where courses were traced, else the depth of the valley in grey.

    Examples
    --------
    >>> from concio.trace import TracedJoint
    >>> TracedJoint("head", ((0.5, 0.0), (0.5, 0.1)), 3.2).strength
    3.2
    """

    kind: Literal["bed", "head", "joint"]
    ends: tuple[Point, Point]
    strength: float

    def in_metres(self, photo: Photo) -> TracedJoint:
        """Return the joint with its ends [pixels] in metres."""
        a, b = photo.metres(np.array(self.ends)).tolist()
        return replace(self, ends=((a[0], a[1]), (b[0], b[1])))


@short_repr
@dataclass(frozen=True, eq=False)
class Tracing:
    """Blocks that were traced in a picture.

    Parameters
    ----------
    labels : (rows, columns) integer array
        Number of the block of each pixel; 0 is none.
    photo : Photo
        The picture with its scale.
    joints : tuple of TracedJoint
        The most doubtful first.
    joint_width : float
        Measured width of the joints [m]; 0 where it was not measured.

    Examples
    --------
    Two blocks become one, which is cut again:

    >>> import numpy as np
    >>> from concio.trace import Photo, Tracing
    >>> found = Tracing(np.repeat([[1, 2, 3]], 20, axis=0).repeat(20, axis=1), Photo(np.zeros((20, 60)), 0.01))
    >>> one = found.merged(1, 2)
    >>> len(one.outlines()), len(one.split(1, [(0.15, -0.1), (0.15, 0.3)]).outlines())
    (2, 3)
    """

    labels: Array
    photo: Photo
    joints: tuple[TracedJoint, ...] = ()
    joint_width: float = 0.0

    def outlines(self, tolerance: float | None = None) -> dict[int, Array]:
        """Return the outline (n, 2) of each block, counter-clockwise [m]; neighbours share their points.

        Each boundary between two blocks is simplified once, for both.

        Parameters
        ----------
        tolerance : float, optional
            Largest distance of a simplified boundary from that of the pixels [m]; default one and a half pixels.
        """
        allowed = 1.5 * self.photo.pixel if tolerance is None else tolerance
        found = shared_outlines(self.labels, allowed / self.photo.pixel)
        return {label: self.photo.metres(ring) for label, ring in found.items()}

    def merged(self, *blocks: int) -> Tracing:
        """Return the tracing with blocks made one, which has the number of the first.

        Raises
        ------
        InputError
            There are no such blocks, or they do not touch.
        """
        self._check(blocks)
        one = np.isin(self.labels, blocks)
        if ndimage.label(one)[1] != 1:
            msg = f"the blocks {list(blocks)} do not touch"
            raise InputError(msg, hint="merge neighbours")
        return replace(self, labels=np.where(one, blocks[0], self.labels))

    def split(self, block: int, line: Sequence[Sequence[float]]) -> Tracing:
        """Return the tracing with a block cut along a line.

        Parameters
        ----------
        block : int
        line : sequence of points
            From one side of the block to another [m].

        Raises
        ------
        InputError
            There is no such block, or the line does not cut it in two.
        """
        self._check((block,))
        inside = self.labels == block
        wall = _drawn(self.photo.pixels(np.asarray(line, dtype=float)), inside.shape)
        parts, count = ndimage.label(inside & ~wall)
        sizes = ndimage.sum_labels(inside, parts, np.arange(1, count + 1))
        if count < 2 or np.sort(sizes)[-2] < 4:
            msg = f"the line does not cut block {block} in two"
            raise InputError(msg, hint="draw it from outside to outside of the block")
        keep = np.isin(parts, 1 + np.argsort(sizes)[-2:])
        nearest = ndimage.distance_transform_edt(~keep, return_distances=False, return_indices=True)
        parts = np.where(inside, parts[tuple(nearest)], 0)
        second = int(1 + np.argsort(sizes)[-1])
        labels = np.where(inside & (parts == second), self.labels.max() + 1, self.labels)
        return replace(self, labels=labels)

    def _check(self, blocks: Sequence[int]) -> None:
        for block in blocks:
            if block <= 0 or not (self.labels == block).any():
                msg = f"there is no block {block}"
                raise InputError(msg, hint=f"blocks are numbered from 1 to {int(self.labels.max())}")

    def model(
        self, *, thickness: float = 1.0, unit_weight: float = 20.0, friction: float = 0.6,
        tolerance: float | None = None, ground: bool = True, **fields: Any,
    ) -> Model:  # fmt: skip
        """Return the model of the traced blocks as rigid ones, with their self-weight, on fixed ground.

        Parameters
        ----------
        thickness : float
            [m].
        unit_weight : float
            [kN/m3].
        friction : float
        tolerance : float, optional
            As in :meth:`outlines`.
        ground : bool
            Whether a fixed body lies under the lowest blocks.
        **fields
            Further fields of :class:`concio.Model`.
        """
        rings = self.outlines(tolerance)
        lost = sorted(set(np.unique(self.labels[self.labels > 0]).tolist()) - rings.keys())
        if lost:
            others = f", and {len(lost) - 1} more" if len(lost) > 1 else ""
            msg = f"block {lost[0]} is too small for an outline{others}"
            raise InputError(msg, hint="join it to a neighbour, set it to 0, or take a smaller tolerance")
        width = len(str(len(rings)))
        bodies = [
            Body(f"s{k:0{width}d}", ring, "stone", kind="rigid", thickness=thickness)
            for k, ring in enumerate(rings.values(), 1)
        ]
        if ground:
            low, high = np.concatenate(list(rings.values())).min(0), np.concatenate(list(rings.values())).max(0)
            deep = 0.1 * float((high - low).max())
            box = [(low[0], low[1] - deep), (high[0], low[1] - deep), (high[0], low[1]), (low[0], low[1])]
            bodies.append(Body("ground", np.array(box), "stone", kind="fixed", thickness=thickness))
        given: Mapping[str, Any] = {
            "bodies": tuple(bodies), "materials": {"stone": Rigid(unit_weight=unit_weight)},
            "laws": {"joint": JointLaw(friction=friction)}, "loads": (Load("weight", (0.0, -1.0)),), **fields,
        }  # fmt: skip
        return Model(**given)


def _drawn(line: Array, shape: tuple[int, ...]) -> Array:
    """Return the pixels that a line (k, 2) of columns and rows runs through, without gaps at corners."""
    found = np.zeros(shape, dtype=bool)
    for a, b in pairwise(line):
        count = int(4 * np.abs(b - a).max()) + 2
        at = np.floor(a + np.linspace(0.0, 1.0, count)[:, None] * (b - a)).astype(int)
        within = (at >= 0).all(axis=1) & (at[:, 0] < shape[1]) & (at[:, 1] < shape[0])
        found[at[within, 1], at[within, 0]] = True
    return found


@strict
def trace_labels(labels: Array, photo: Photo) -> Tracing:
    """Return a tracing from a segmentation of your own: the number of the block of each pixel, 0 for none.

    Parameters
    ----------
    labels : (rows, columns) integer array
    photo : Photo
        A picture of the same size.

    Raises
    ------
    InputError
        The sizes differ, there is no block, or a block is in several pieces.

    Examples
    --------
    >>> import numpy as np
    >>> from concio.trace import Photo, trace_labels
    >>> labels = np.repeat([[1, 2]], 20, axis=0).repeat(30, axis=1)
    >>> len(trace_labels(labels, Photo(np.zeros((20, 60)), 0.01)).model(thickness=0.3).free_bodies)
    2
    """
    own = np.asarray(labels)
    if own.shape != photo.grey.shape or not np.issubdtype(own.dtype, np.integer) or not (own > 0).any():
        msg = f"labels of shape {own.shape} and type {own.dtype} for a picture of {photo.grey.shape}"
        raise InputError(msg, hint="give whole numbers of the size of the picture, above 0 for blocks")
    own = own.astype(np.int32)
    _refuse_pieces(own)
    return Tracing(own, photo)


def _refuse_pieces(labels: Array) -> None:
    """Refuse a block that is in several pieces: its outline is that of the largest one."""
    numbers = np.unique(labels[labels > 0]).tolist()
    order = np.searchsorted(numbers, np.maximum(labels, 0)) + 1
    for k, part in zip(numbers, ndimage.find_objects(np.where(labels > 0, order, 0)), strict=True):
        pieces, count = ndimage.label(labels[part] == k)
        if count > 1:
            sizes = sorted(np.bincount(pieces.ravel())[1:].tolist(), reverse=True)
            msg = f"block {k} is in {count} pieces, of {', '.join(map(str, sizes[:3]))} pixels"
            hint = "give each piece a number of its own, join it to a neighbour, or set it to 0"
            raise InputError(msg, where="labels", hint=hint)

