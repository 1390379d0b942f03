"""Arcs as chords that keep the area under the arc.

Vertices on the arc itself would lose area: two thirds of the rise times the chord, each. The ends of an arc stay where
they are, since other blocks meet it there, and the vertices between them move out to the radius ``rho r`` at which
the area of the polygon is that of the sector,

    (n - 2) sin(phi) rho^2 + 2 sin(phi) rho = n phi        (n chords, phi = angle of one chord).
"""

from __future__ import annotations

import numpy as np

from concio.errors import InputError
from concio.model.model import Array

MOST = 10_000
"""Most chords of one arc."""
LARGEST = np.pi / 4
"""Largest angle of a chord [rad]."""


def chords_of(radius: float, angle: float, tolerance: float) -> int:
    """Return how many chords, at least two, keep within ``tolerance`` [m] of an arc.

    Raises
    ------
    InputError
        More than :data:`MOST`.
    """
    largest = min(2 * np.arccos(max(1 - 0.75 * tolerance / radius, 0.0)), LARGEST)
    wanted = abs(angle) / largest if largest > 0 else np.inf
    if wanted > MOST:
        msg = f"an arc of radius {radius:.4g} m would be made of more than {MOST:,} chords"
        raise InputError(msg, hint="raise chord_tolerance")
    return max(2, int(np.ceil(wanted - 1e-9)))


def spread(angle: float, chords: int) -> float:
    """Return by what factor the radius of the inner vertices grows so that the area under the arc is kept."""
    n, phi = chords, abs(angle) / chords
    s = np.sin(phi)
    if n < 2:
        return 1.0
    if n == 2:
        return float(phi / s)
    return float((np.sqrt(s * s + (n - 2) * s * n * phi) - s) / ((n - 2) * s))


def arc(centre: Array, radius: float, start: float, stop: float, chords: int) -> Array:
    """Return points (chords + 1, 2) of an arc from angle ``start`` to ``stop`` [rad], ends on it, area kept."""
    angle = np.linspace(start, stop, chords + 1)
    size = np.full(chords + 1, radius)
    size[1:-1] *= spread(stop - start, chords)
    result: Array = centre + size[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1)
    return result


def with_arcs(points: Array, bulges: Array, tolerance: float) -> Array:
    """Return a closed outline (n, 2) whose arcs are chords within ``tolerance`` of the arc, their area kept [m].

    Parameters
    ----------
    points : (k, 2) array
        Vertices [m].
    bulges : (k,) array
        Tangent of a quarter of the angle of the arc from vertex k to the next, positive counter-clockwise.
    tolerance : float
        [m].

    Raises
    ------
    InputError
        An arc needs too many chords.
    """
    result = []
    for p, q, bulge in zip(points, np.roll(points, -1, axis=0), bulges, strict=True):
        length = float(np.hypot(*(q - p)))
        if abs(bulge) * length <= 1e-12 * (length + np.abs(p).max()):
            result.append(p[None])
            continue
        angle = 4 * np.arctan(bulge)
        radius = length / (2 * np.sin(abs(angle) / 2))
        left = np.array([p[1] - q[1], q[0] - p[0]])
        centre = 0.5 * (p + q) + left * (1 - bulge * bulge) / (4 * bulge)
        start = float(np.arctan2(p[1] - centre[1], p[0] - centre[0]))
        found = arc(centre, radius, start, start + angle, chords_of(radius, angle, tolerance))
        found[0] = p
        result.append(found[:-1])
    return np.concatenate(result)
