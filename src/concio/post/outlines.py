"""Outlines of all bodies as meshed, with the displacement of every point: what deformed shapes are drawn from."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.periodic import STRAINS
from concio.fem.body import Shape
from concio.fem.discretisation import FIXED
from concio.kinematics.rigid import swept
from concio.post.motion import body_motions

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Outlines:
    """Closed outlines of B bodies, P points in all; the first point of each is repeated at its end.

    Parameters
    ----------
    points, displacement : (P, 2) arrays
        [m].
    starts : (B+1,) integer array
        Points of body b are ``starts[b]:starts[b+1]``.
    arc : (P,) array
        Distance along the outline, growing over all bodies: the outline of a body begins where that of the body
        before ended, plus one [m]. Places on outlines are found by one interpolation in it.
    vertices : tuple of (v+1,) arrays
        For each body, ``arc`` of the vertices of ``Body.outline``.
    strain : (2, 2) array
        Macroscopic strain of a periodic cell: images of its bodies at the shift s move by ``strain @ s`` more.
    """

    points: Array
    displacement: Array
    starts: Array
    arc: Array
    vertices: tuple[Array, ...]
    strain: Array = field(default_factory=lambda: np.zeros((2, 2)))

    def moved(self, scale: float = 1.0) -> list[Array]:
        """Return the outlines (n, 2) of the bodies with displacements times ``scale`` [m]."""
        moved = self.points + scale * self.displacement
        return [moved[a:b] for a, b in zip(self.starts[:-1], self.starts[1:], strict=True)]

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
    xx, yy, xy = (result.factors.get(name, 0.0) if u is None else 0.0 for name in STRAINS)
    own = result.displacement if u is None else u
    motion = body_motions(result, u)
    shapes = [s for s in disc.shapes if isinstance(s, Shape)]
    loops = [np.concatenate([e.nodes[:-1] for e in s.edges] + [s.edges[0].nodes[:1]]) for s in shapes]
    cuts = [np.cumsum([0] + [len(e.nodes) - 1 for e in s.edges]) for s in shapes]
    points, moved, vertices, arcs = [], [], [], []
    starts, begin = [0], 0.0
    for b, s in enumerate(disc.shape_of):
        if s >= 0:
            loop, corner = loops[s], cuts[s]
            place = disc.shapes[s].elements.nodes[loop] + disc.origins[b]
            displaced = own[disc.offsets[b] : disc.offsets[b + 1]].reshape(-1, 2)[loop]
        else:
            outline = disc.model.outlines[b].outline
            place, corner = np.vstack([outline, outline[:1]]), np.arange(len(outline) + 1)
            arm = place - disc.centroids[b]
            displaced = motion[b, :2] + swept(motion[b, 2], arm)
            if s == FIXED and u is not None:
                displaced = np.zeros_like(place)
        along = begin + np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(place, axis=0).T))])
        points.append(place)
        moved.append(displaced)
        arcs.append(along)
        vertices.append(along[corner])
        starts.append(starts[-1] + len(place))
        begin = along[-1] + 1.0
    return Outlines(
        np.vstack(points),
        np.vstack(moved),
        np.array(starts),
        np.concatenate(arcs),
        tuple(vertices),
        np.array([[xx, xy / 2], [xy / 2, yy]]),
    )


def display_scale(largest: float, size: float, share: float = 0.05) -> float:
    """Return a round factor (1, 2 or 5 times a power of ten) that shows ``largest`` as about ``share`` of ``size``."""
    if not (largest > 0 and size > 0 and np.isfinite(largest)):
        return 1.0
    wanted = share * size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step <= wanted / power * (1 + 1e-12)))
