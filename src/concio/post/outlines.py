"""Outlines of all bodies as meshed, with the displacement of every point: what deformed shapes are drawn from."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.factors import load_factor
from concio.contact.macroscopic_strain import STRAINS
from concio.fem.discretisation import FIXED
from concio.fem.shape import Shape
from concio.kinematics.rigid import swept
from concio.post.body_motion import body_motions
from concio.representation import short_repr

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray
STILL = "nothing moves"
"""What is said of displacements that are rounding."""
NO_MOTION = 1e-12
"""Share of the size of a model below which displacements are rounding; strains of stone under its weight are 1e-6."""


@short_repr
@dataclass(frozen=True, eq=False)
class Outlines:
    """Closed outlines and holes of B bodies: R rings, P points in all; the first point of each is repeated at its end.

    Parameters
    ----------
    points, displacement : (P, 2) arrays
        [m].
    starts : (B+1,) integer array
        Points of body b are ``starts[b]:starts[b+1]``: its outline, then its holes.
    rings : (R+1,) integer array
        Points of ring r are ``rings[r]:rings[r+1]``.
    arc : (P,) array
        Distance along the rings, growing over all bodies: a ring begins where the one before ended, plus one [m].
        Places on outlines are found by one interpolation in it.
    edges : tuple of (v, 2) arrays
        For each body (v, 2), ``arc`` of the two ends of each edge of its outline and holes.
    strain : (2, 2) array
        Macroscopic strain of a periodic cell: images of its bodies at the shift s move by ``strain @ s`` more.
    """

    points: Array
    displacement: Array
    starts: Array
    rings: Array
    arc: Array
    edges: tuple[Array, ...]
    strain: Array = field(default_factory=lambda: np.zeros((2, 2)))

    def moved(self, scale: float = 1.0) -> list[list[Array]]:
        """Return the rings (n, 2) of each body, its outline first, with displacements times ``scale`` [m]."""
        moved = self.points + scale * self.displacement
        rings = [moved[a:b] for a, b in pairwise(self.rings.tolist())]
        first = np.searchsorted(self.rings, self.starts)
        return [rings[a:b] for a, b in pairwise(first.tolist())]

    def at(self, arc: Array) -> Array:
        """Return the displacements (k, 2) of places on the outlines given by their ``arc`` (k,) [m]."""
        return np.column_stack([np.interp(arc, self.arc, self.displacement[:, i]) for i in range(2)])

    @cached_property
    def size(self) -> float:
        """Longer side of the box around everything [m]."""
        return float(np.ptp(self.points, axis=0).max())


def outlines(result: Result, u: Array | None = None) -> Outlines:
    """Return the outlines of all bodies.

    Parameters
    ----------
    result : Result
    u : (N_all,) array, optional
        Displacements to show in place of the result's, such as a mechanism; fixed bodies then stay.
    """
    disc = result.assembly.disc
    xx, yy, xy = (load_factor(result.factors, name) if u is None else 0.0 for name in STRAINS)
    own = result.displacement if u is None else u
    motion = body_motions(result, u)
    plane = [_loops(shape) for shape in disc.shapes if isinstance(shape, Shape)]
    points, moved, edges, arcs = [], [], [], []
    starts, rings, begin = [0], [0], 0.0
    for b, s in enumerate(disc.shape_of):
        own_edges = []
        loops = plane[s] if s >= 0 else [(ring, np.arange(len(ring) + 1)) for ring in disc.model.outlines[b].rings]
        for loop, corner in loops:
            if s >= 0:
                place = disc.shapes[s].elements.nodes[loop] + disc.origins[b]
                displaced = own[disc.offsets[b] : disc.offsets[b + 1]].reshape(-1, 2)[loop]
            else:
                place = np.vstack([loop, loop[:1]])
                displaced = motion[b, :2] + swept(motion[b, 2], place - disc.centroids[b])
                if s == FIXED and u is not None:
                    displaced = np.zeros_like(place)
            along = begin + np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(place, axis=0).T))])
            points.append(place)
            moved.append(displaced)
            arcs.append(along)
            own_edges.append(np.stack([along[corner[:-1]], along[corner[1:]]], 1))
            rings.append(rings[-1] + len(place))
            begin = along[-1] + 1.0
        edges.append(np.concatenate(own_edges))
        starts.append(rings[-1])
    return Outlines(
        np.vstack(points),
        np.vstack(moved),
        np.array(starts),
        np.array(rings),
        np.concatenate(arcs),
        tuple(edges),
        np.array([[xx, xy / 2], [xy / 2, yy]]),
    )


def _loops(shape: Shape) -> list[tuple[Array, Array]]:
    """Return for each ring of a shape its nodes, the first repeated, and where among them its vertices are."""
    found, at = [], 0
    for ring in shape.rings:
        sides = shape.edges[at : at + len(ring)]
        nodes = np.concatenate([e.nodes[:-1] for e in sides] + [sides[0].nodes[:1]])
        found.append((nodes, np.cumsum([0] + [len(e.nodes) - 1 for e in sides])))
        at += len(ring)
    return found


def anything_moves(largest: float, size: float) -> bool:
    """Return whether a largest displacement [m] is more than rounding in a model of a size [m]."""
    return largest > NO_MOTION * size


def display_scale(largest: float, size: float, share: float = 0.05) -> float:
    """Return a round factor (1, 2 or 5 times a power of ten) that shows ``largest`` as about ``share`` of ``size``.

    It is 1 where nothing moves.
    """
    if not (anything_moves(largest, size) and size > 0 and np.isfinite(largest)):
        return 1.0
    wanted = share * size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step <= wanted / power * (1 + 1e-12)))
