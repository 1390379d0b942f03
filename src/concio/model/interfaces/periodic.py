"""Interfaces of a periodic cell: within it, and across its edges to the images of its bodies.

The images of the bodies at the shifts i p1 + j p2 that come near the cell stand around it, unable to move on their own,
and the joints are found as in any model. Of each joint across an edge and its repetition on the opposite edge one is
kept, that whose image stands at j > 0, or at j = 0 and i > 0. So a body may touch itself, and every joint of the
infinite wall is there once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from concio.model.interfaces.detect import NEAR_SHARE, Detection, detect_interfaces
from concio.model.model import Array, Body, Periods


@dataclass(frozen=True, eq=False)
class Image:
    """A body of a neighbouring cell.

    Parameters
    ----------
    body : Body
        Where it stands, named after the body and the neighbour, kind "fixed".
    of : int
        Number of the body in the cell.
    cell : (i, j)
        The neighbour.
    shift : (2,) array
        i p1 + j p2 [m].
    """

    body: Body
    of: int
    cell: tuple[int, int]
    shift: Array

    @property
    def kept(self) -> bool:
        """Whether joints with this image count, and not their repetition on the other side."""
        return self.cell[1] > 0 or (self.cell[1] == 0 and self.cell[0] > 0)


def images(bodies: Sequence[Body], periods: Periods, near: float) -> list[Image]:
    """Return the images of the bodies of a cell that come within ``near`` [m] of the box around it."""
    p = np.asarray(periods, dtype=float)
    low = np.array([b.outline.min(0) for b in bodies])
    high = np.array([b.outline.max(0) for b in bodies])
    reach = np.abs(np.linalg.inv(p)).T @ (high.max(0) - low.min(0) + near)
    most = np.ceil(reach).astype(int)
    found = []
    for j in range(-most[1], most[1] + 1):
        for i in range(-most[0], most[0] + 1):
            if i == j == 0:
                continue
            shift = np.array([i, j]) @ p
            beside = ((low + shift <= high.max(0) + near) & (high + shift >= low.min(0) - near)).all(1)
            for k in np.flatnonzero(beside).tolist():
                name = f"{bodies[k].name} of the cell at ({i:+d}, {j:+d})"
                holes = tuple(hole + shift for hole in bodies[k].holes)
                outline = bodies[k].outline + shift
                image = replace(bodies[k], name=name, outline=outline, holes=holes, kind="fixed", grid=None)
                found.append(Image(image, k, (i, j), shift))
    return found


def detect_periodic(bodies: Sequence[Body], periods: Periods, *, tolerance: float) -> Detection:
    """Return the interfaces of a periodic cell, with near misses and overlaps.

    Parameters
    ----------
    bodies : sequence of Body
    periods : ((x1, y1), (x2, y2))
        [m].
    tolerance : float
        As in :func:`concio.model.interfaces.detect.detect_interfaces` [m].
    """
    size = max(float(np.ptp(b.outline, axis=0).max()) for b in bodies)
    around = images(bodies, periods, max(NEAR_SHARE * size, 2 * tolerance))
    found = detect_interfaces([*bodies, *(image.body for image in around)], tolerance=tolerance)
    count = len(bodies)

    def kept(pair: tuple[int, int]) -> bool:
        return pair[1] < count or around[pair[1] - count].kept

    def own(pair: tuple[int, int]) -> tuple[int, int]:
        return pair if pair[1] < count else (pair[0], around[pair[1] - count].of)

    interfaces = []
    for face in found.segments:
        if face.b < count:
            interfaces.append(face)
        elif around[face.b - count].kept:
            image = around[face.b - count]
            x, y = (float(v) for v in image.shift)
            interfaces.append(replace(face, b=image.of, shift=(x, y)))
    return Detection(
        tuple(interfaces),
        tuple(replace(miss, bodies=own(miss.bodies)) for miss in found.near_misses if kept(miss.bodies)),
        tuple(replace(lap, bodies=own(lap.bodies)) for lap in found.overlaps if kept(lap.bodies)),
    )
