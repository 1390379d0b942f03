"""The barrel of one span of a bridge: rings of voussoirs between lines at distances from the intrados."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from concio.errors import InputError
from concio.model.generate.masonry import Piece, numbered
from concio.model.generate.profiles import Profile, polyline, share_of_line

Array = np.ndarray

CLEAN = 16
"""Points by which the area between a chord and its arc is measured."""


@dataclass(frozen=True, eq=False)
class Barrel:
    """Rings of one span.

    Parameters
    ----------
    pieces : tuple of Piece
        Voussoirs, ring by ring from the intrados, each from left to right.
    left, right : (r + 1, 2) arrays
        Springing joints from intrados to extrados, with a point between each two rings [m].
    extrados : (k, 2) array
        From left to right [m].
    """

    pieces: tuple[Piece, ...]
    left: Array
    right: Array
    extrados: Array

    def moved(self, x: float) -> Barrel:
        """Return the same, further to the right by x [m]."""
        shift = np.array([x, 0.0])
        pieces = tuple(replace(p, outline=p.outline + shift) for p in self.pieces)
        return Barrel(pieces, self.left + shift, self.right + shift, self.extrados + shift)


@dataclass(frozen=True)
class RingPlan:
    """How the rings of a span are cut.

    Parameters
    ----------
    crown, springing : tuple of float
        Thickness of each ring at the crown and at the springings [m].
    voussoirs : tuple of int
        Of each ring.
    staggered : bool
        Whether the joints of every second ring lie half a voussoir further on.
    headers : int
        Every so many voussoirs one runs through all rings; 0 is none.
    chords : int
        Chords of each curved side between two joints.
    prefix : str
        Before the names.
    """

    crown: tuple[float, ...]
    springing: tuple[float, ...]
    voussoirs: tuple[int, ...]
    staggered: bool
    headers: int
    chords: int
    prefix: str

    def joints(self, ring: int, kinks: tuple[float, ...]) -> Array:
        """Return where the joints of a ring are, as shares of the intrados, springings included."""
        n = self.voussoirs[ring]
        shares = np.arange(n + 1) / n
        if self.staggered and ring % 2:
            shares = np.concatenate([[0.0], (np.arange(n) + 0.5) / n, [1.0]])
        for kink in kinks:  # a joint at the top of a pointed arch
            shares[int(np.argmin(np.abs(shares - kink)))] = kink
        return shares


def barrel_of(where: str, profile: Profile, plan: RingPlan) -> Barrel:
    """Return the rings of a span with a given intrados.

    Raises
    ------
    InputError
        Headers in rings whose joints do not meet.
    """
    rings = len(plan.crown)
    joints = [plan.joints(j, profile.kinks) for j in range(rings)]
    if plan.headers and any(len(j) != len(joints[0]) or np.abs(j - joints[0]).max() > 1e-12 for j in joints):
        msg = "headers need rings of as many voussoirs, with their joints in line"
        raise InputError(msg, where=where, hint="give one number of voussoirs, and leave staggered out")
    every = np.unique(np.round(np.concatenate(joints), 12))
    grid = np.concatenate([np.linspace(a, b, plan.chords, endpoint=False) for a, b in pairwise(every)] + [[1.0]])
    thick = [np.zeros_like(grid)]
    for crown, springing in zip(plan.crown, plan.springing, strict=True):
        thick.append(thick[-1] + crown + (springing - crown) * np.abs(2 * grid - 1) ** 2)
    knots = np.searchsorted(grid, every - 1e-9)
    lines = [_kept_area(profile, grid, d, knots, plan, j) for j, d in enumerate(thick)]
    pieces: list[Piece] = []
    for j in range(rings):
        cut = np.searchsorted(grid, joints[j] - 1e-9)
        for k, (a, b) in enumerate(pairwise(cut.tolist())):
            top = j + 1
            if plan.headers and (k + 1) % plan.headers == 0:
                if j:
                    continue
                top = rings
            outline = np.vstack([lines[j][a : b + 1], *_end(lines, b, j, top), lines[top][a : b + 1][::-1],
                                 *_end(lines, a, j, top)[::-1]])  # fmt: skip
            ring = f"r{j + 1}-" if rings > 1 else ""
            name = plan.prefix + ring + numbered("v", k + 1, len(cut) - 1)
            layer = "header" if top > j + 1 else f"ring {j + 1}" if rings > 1 else "voussoir"
            pieces.append(Piece(name, outline, layer=layer))
    ends = [np.array([line[k] for line in lines]) for k in (0, -1)]
    return Barrel(tuple(pieces), ends[0], ends[1], lines[-1])


def barrel_between(where: str, lines: Sequence[Sequence[Sequence[float]]], voussoirs: int, prefix: str) -> Barrel:
    """Return the rings between lines given as points, from the intrados outwards, joints at equal shares of each.

    Raises
    ------
    InputError
        A line is none, or two of them meet or cross.
    """
    drawn = [polyline(f"{where}, line {k}", line) for k, line in enumerate(lines, 1)]
    shares = np.arange(voussoirs + 1) / voussoirs
    joints = [share_of_line(line, shares) for line in drawn]
    pieces = []
    for j, (low, high) in enumerate(pairwise(drawn)):
        _check_apart(where, j + 1, joints[j], joints[j + 1])
        for k in range(voussoirs):
            sides = [_between(line, shares[k], shares[k + 1]) for line in (low, high)]
            outline = np.vstack([sides[0], sides[1][::-1]])
            ring = f"r{j + 1}-" if len(drawn) > 2 else ""
            layer = f"ring {j + 1}" if ring else "voussoir"
            pieces.append(Piece(prefix + ring + numbered("v", k + 1, voussoirs), outline, layer=layer))
    left, right = (np.array([ends[k] for ends in joints]) for k in (0, -1))
    return Barrel(tuple(pieces), left, right, _between(drawn[-1], 0.0, 1.0))


Lines = list[list[list[float]]]
"""A line of each span, as points [m]."""


def thickness_of(lines: Sequence[Lines]) -> float:
    """Return the thickness of all rings of the first span at its middle [m]."""
    ends = [share_of_line(np.array(line[0], dtype=float), np.array([0.5]))[0] for line in (lines[0], lines[-1])]
    return float(np.hypot(*(ends[1] - ends[0])))


def thicker(lines: Sequence[Lines], factor: float) -> list[Lines]:
    """Return lines of the barrel further from the intrados by a factor, which is the first of them and stays."""
    found = [list(lines[0])]
    for line in lines[1:]:
        made = []
        for inner, own in zip(lines[0], line, strict=True):
            points = np.array(own, dtype=float)
            along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
            foot = share_of_line(np.array(inner, dtype=float), along / along[-1])
            made.append((foot + factor * (points - foot)).tolist())
        found.append(made)
    return found


def _check_apart(where: str, ring: int, low: Array, high: Array) -> None:
    """Refuse two lines of a ring that meet or cross anywhere."""
    thick = np.hypot(*(high - low).T)
    along = np.roll(low, -1, axis=0) - low
    along[-1] = along[-2]
    outward = along[:, 0] * (high - low)[:, 1] - along[:, 1] * (high - low)[:, 0]
    if not (outward > 0).all() or not (thick > 1e-6 * np.ptp(low[:, 0])).all():
        k = int(np.argmin(outward))
        msg = f"ring {ring} has no thickness at x = {low[k, 0]:.4g} m: its lines meet or cross there"
        raise InputError(msg, where=where, hint="give the lines from the intrados outwards, each from left to right")


def _between(line: Array, a: float, b: float) -> Array:
    """Return the part of a line between two shares of its length, with the vertices between them."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    own = along / along[-1]
    inside = own[(own > a + 1e-9) & (own < b - 1e-9)]
    return share_of_line(line, np.concatenate([[a], inside, [b]]))


def _end(lines: list[Array], k: int, j: int, top: int) -> list[Array]:
    """Return the points at a joint of the lines between two rings that a header runs through."""
    return [lines[i][k : k + 1] for i in range(j + 1, top)]


def _kept_area(profile: Profile, grid: Array, distance: Array, knots: Array, plan: RingPlan, ring: int) -> Array:
    """Return the line (g, 2) at a distance, the points between joints moved so that the area under it is kept."""
    line = profile.offset(grid, distance)
    if plan.chords < 2:
        return line

    def thickness(s: Array) -> Array:
        found: Array = np.interp(s, grid, distance)
        if ring:
            crown, springing = sum(plan.crown[:ring]), sum(plan.springing[:ring])
            found = crown + (springing - crown) * np.abs(2 * s - 1) ** 2
        return found

    for a, b in pairwise(knots.tolist()):
        fine = np.linspace(grid[a], grid[b], CLEAN * (b - a) + 1)
        exact = _segment(profile.offset(fine, thickness(fine)))
        own = _segment(line[a : b + 1])
        if abs(own) > 1e-15:
            share = np.linspace(0.0, 1.0, b - a + 1)[:, None]
            chord = line[a] + share * (line[b] - line[a])
            line[a : b + 1] = chord + (line[a : b + 1] - chord) * (exact / own)
    return line


def _segment(points: Array) -> float:
    """Return the area between a line and its chord."""
    x, y = points[:, 0], points[:, 1]
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())
