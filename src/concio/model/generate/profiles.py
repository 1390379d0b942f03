r"""Intrados lines of arch barrels, and lines at a distance from them.

An intrados of span s and rise r stands on the springing line y = 0 between x = 0 and x = s. It is a
:class:`Profile`: points and outward normals for shares of its length from left to right.

* segmental, semicircular: one arc;
* elliptical: the upper half of an ellipse;
* three-centred: two arcs of radius :math:`R_1` at the springings, vertical there, and one of radius :math:`R_2` between
  them, which meet tangentially after 60 degrees; span and rise give both radii;
* parabolic; pointed: two arcs with centres on the springing line;
* a polyline of the user's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from concio.errors import InputError
from concio.kinematics.frames import turned_left

Array = np.ndarray

SHAPES = ("segmental", "semicircular", "elliptical", "three-centred", "parabolic", "pointed")
FINE = 4001
"""Points by which lengths along curves other than arcs are measured."""


@dataclass(frozen=True, eq=False)
class Profile:
    """A line from the left to the right springing.

    Parameters
    ----------
    points, normals : functions
        From shares (k,) of its length to points (k, 2) [m] and outward unit normals (k, 2).
    kinks : tuple of float
        Shares at which its direction jumps, where a joint has to be.
    """

    points: Callable[[Array], Array]
    normals: Callable[[Array], Array]
    kinks: tuple[float, ...] = ()

    def offset(self, shares: Array, distance: Array | float) -> Array:
        """Return points (k, 2) at distances outwards from the line [m]."""
        found: Array = self.points(shares) + np.reshape(distance, (-1, 1)) * self.normals(shares)
        return found


def profile_of(where: str, shape: str, span: float, rise: float | None) -> Profile:
    """Return the intrados of a shape.

    Raises
    ------
    InputError
        The rise is missing, or does not go with the shape.
    """
    if shape not in SHAPES:
        msg = f"shape = '{shape}' is not one of {', '.join(SHAPES)}"
        raise InputError(msg, where=where)
    half = 0.5 * span
    if rise is None:
        if shape != "semicircular":
            msg = "rise is missing"
            raise InputError(msg, where=where, hint=f"a {shape} arch needs the rise of its intrados in m")
        rise = half
    if shape == "semicircular" and abs(rise - half) > 1e-9 * span:
        msg = f"a semicircular arch of span {span:g} m rises {half:g} m, not {rise:g} m"
        raise InputError(msg, where=where, hint="leave rise out, or take shape = 'segmental'")
    if shape in ("segmental", "semicircular"):
        return _segmental(where, half, rise)
    if shape == "elliptical":
        return _smooth(lambda t: np.column_stack([half - half * np.cos(t), rise * np.sin(t)]), np.pi)
    if shape == "parabolic":
        return _smooth(lambda t: np.column_stack([span * t, 4 * rise * t * (1 - t)]), 1.0)
    return _pointed(where, half, rise) if shape == "pointed" else _three_centred(where, half, rise)


def polyline(where: str, points: Sequence[Sequence[float]]) -> Array:
    """Return the vertices (k, 2) of a line given by points from left to right.

    Raises
    ------
    InputError
        Fewer than three, or not from left to right.
    """
    line = np.array(points, dtype=float)
    if line.ndim != 2 or line.shape[1] != 2 or len(line) < 3 or not np.isfinite(line).all():
        msg = "a line needs at least three points [x, y]"
        raise InputError(msg, where=where, hint="for example [[0, 0], [1.5, 0.8], [3, 0]]")
    if not line[-1, 0] > line[0, 0]:
        msg = "the points of a line run from the left to the right springing"
        raise InputError(msg, where=where)
    return line


def share_of_line(line: Array, shares: Array) -> Array:
    """Return points (k, 2) at shares of the length of a line of vertices (n, 2)."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    return np.column_stack([np.interp(shares * along[-1], along, line[:, c]) for c in (0, 1)])


def _segmental(where: str, half: float, rise: float) -> Profile:
    if rise > half * (1 + 1e-9):
        msg = f"a segmental arch of span {2 * half:g} m rises at most {half:g} m, not {rise:g} m"
        raise InputError(msg, where=where, hint="take shape = 'pointed', 'elliptical' or 'parabolic'")
    radius = (half**2 + rise**2) / (2 * rise)
    centre, turn = np.array([half, rise - radius]), 2 * np.arctan2(rise, half)

    def direction(s: Array) -> Array:
        angle = np.pi / 2 + turn * (1 - 2 * s)
        return np.column_stack([np.cos(angle), np.sin(angle)])

    return Profile(lambda s: centre + radius * direction(s), direction)


def _smooth(curve: Callable[[Array], Array], end: float, kinks: tuple[float, ...] = ()) -> Profile:
    """Return the profile of a curve given by a parameter from 0 to ``end``, in equal lengths along it."""
    fine = np.unique(np.concatenate([np.linspace(0.0, end, FINE), kinks]))
    points = curve(fine)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    along /= along[-1]
    step = 1e-6 * end

    def parameter(s: Array) -> Array:
        return np.asarray(np.interp(s, along, fine))

    def normals(s: Array) -> Array:
        t = parameter(s)
        low, high = np.maximum(t - step, 0.0), np.minimum(t + step, end)
        tangent = curve(high) - curve(low)
        tangent /= np.hypot(*tangent.T)[:, None]
        return turned_left(tangent)

    shares = tuple(float(v) for v in np.interp(kinks, fine, along)) if kinks else ()
    return Profile(lambda s: curve(parameter(s)), normals, shares)


def _pointed(where: str, half: float, rise: float) -> Profile:
    if rise <= half * (1 + 1e-9):
        msg = f"a pointed arch of span {2 * half:g} m rises more than {half:g} m, not {rise:g} m"
        raise InputError(msg, where=where, hint="take shape = 'semicircular' or 'segmental'")
    shift = (rise**2 - half**2) / (2 * half)  # of the centre beyond the middle
    radius = half + shift

    def curve(t: Array) -> Array:
        angle = np.arcsin(rise / radius) * np.minimum(t, 2 - t)
        x = half + shift - radius * np.cos(angle)
        return np.column_stack([np.where(t <= 1, x, 2 * half - x), radius * np.sin(angle)])

    return _smooth(curve, 2.0, (1.0,))


def _three_centred(where: str, half: float, rise: float) -> Profile:
    if not 0.5 * half < rise < half:
        msg = f"a three-centred arch of span {2 * half:g} m rises between {half / 2:g} and {half:g} m, not {rise:g} m"
        raise InputError(msg, where=where, hint="take shape = 'segmental' or 'elliptical'")
    turn = np.pi / 3  # angle of each arc at the springings
    cos, sin = np.cos(turn), np.sin(turn)
    # centres (half - (half - R1), 0) and (half, rise - R2): (R2 - R1) cos = half - R1, (R2 - R1) sin = R2 - rise
    small, large = np.linalg.solve([[1 - cos, cos], [-sin, sin - 1]], [half, -rise])
    rest = np.pi / 2 - turn
    lengths = np.array([small * turn, large * rest])

    def curve(t: Array) -> Array:
        s = np.minimum(t, 2 - t) * lengths.sum()
        a = np.minimum(s / small, turn)
        b = turn + np.maximum(s - lengths[0], 0.0) / large
        first = np.column_stack([small - small * np.cos(a), small * np.sin(a)])
        second = np.column_stack([half - large * np.cos(b), rise - large + large * np.sin(b)])
        points = np.where((s <= lengths[0])[:, None], first, second)
        points[:, 0] = np.where(t <= 1, points[:, 0], 2 * half - points[:, 0])
        return points

    return _smooth(curve, 2.0)
