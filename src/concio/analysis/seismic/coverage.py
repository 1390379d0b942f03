"""What a search of mechanisms covered: places of each kind, pushes, motions that were met, and the weakest of each."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from concio.analysis.seismic.macro_blocks import Mechanics
from concio.analysis.seismic.weakest_mechanism import Found
from concio.kinematics.frames import turned_left

KINDS = ("whole", "named", "levels", "openings", "returns", "changes", "alone", "strips")
"""Where mechanisms are sought: among all motions, by name, above levels, beside openings and returns, beyond changes,
in structures that stand alone, out of the plane of a facade."""

MOTIONS = ("overturning", "sliding", "bending", "wedge", "mixed")
"""How they move: one block turns about a horizontal axis across the push; all blocks slide; blocks turn against each
other; one block turns about another axis; anything else."""

STRAIGHT = 1e-4
"""Rotation times size below this share of the velocity is none."""

ACROSS = 0.1
"""Share of a rotation about other axes up to which it is one about the axis across the push."""


@dataclass(frozen=True)
class Sought:
    """One search.

    Parameters
    ----------
    kind : str
        One of :data:`KINDS`.
    name : str
    way : str
        Which way the earthquake pushes.
    multiplier : float
        The least that was met; ``inf`` where nothing can move.
    motion : str
        One of :data:`MOTIONS`; empty where nothing can move.
    """

    kind: str
    name: str
    way: str
    multiplier: float
    motion: str


@dataclass(frozen=True)
class Covered:
    """All searches of one kind.

    Parameters
    ----------
    kind : str
    there, sought : int
        Places, and those that were sought at, over all pushes.
    searches : int
    multiplier : float
        The least; ``inf`` where nothing can move.
    motions : tuple of str
        That were met.
    """

    kind: str
    there: int
    sought: int
    searches: int
    multiplier: float
    motions: tuple[str, ...]


def covered(searches: Iterable[Sought], places: dict[str, tuple[int, int]]) -> tuple[Covered, ...]:
    """Return a row for each kind of place that there is.

    Parameters
    ----------
    searches : iterable of Sought
    places : mapping of str to (int, int)
        For levels, openings, returns and changes: sought at, and there.
    """
    by_kind: dict[str, list[Sought]] = {}
    for one in searches:
        by_kind.setdefault(one.kind, []).append(one)
    rows = []
    for kind in KINDS:
        own = by_kind.get(kind, [])
        sought, there = places.get(kind, (len(own), len(own)))
        if own or there:
            motions = tuple(m for m in MOTIONS if any(one.motion == m for one in own))
            least = min((one.multiplier for one in own), default=math.inf)
            rows.append(Covered(kind, there, sought, len(own), least, motions))
    return tuple(rows)


def motion_of(found: Found, along: np.ndarray) -> str:
    """Return how the blocks of a mechanism move, in a word; empty where nothing can move.

    Parameters
    ----------
    found : Found
    along : (d,) array
        Horizontal unit vector of the push.
    """
    return "" if found.mechanics is None else _motion(found.mechanics, along)


def _motion(mechanics: Mechanics, along: np.ndarray) -> str:
    d = len(along)
    size = mechanics.reach([j.point for j in mechanics.joints] or [b.centre for b in mechanics.blocks])
    moves = [(b.motion[:d], b.motion[d:] * size) for b in mechanics.blocks]
    fastest = max(max(float(np.abs(v).max()), float(np.abs(w).max())) for v, w in moves)
    turning = [w for _, w in moves if float(np.abs(w).max()) > STRAIGHT * fastest]
    if not turning:
        return "sliding"
    if len(turning) == len(moves) == 1:
        return "overturning" if d == 2 or _across(turning[0], along) else "wedge"
    if d == 2 and any(float(w[0]) > 0 for w in turning) and any(float(w[0]) < 0 for w in turning):
        return "bending"
    if d == 3 and all(_across(w, along) for w in turning):
        senses = {float(w @ _axis(along)) > 0 for w in turning}
        return "bending" if len(senses) == 2 else "mixed"
    return "mixed"


def _across(turn: np.ndarray, along: np.ndarray) -> bool:
    """Return whether a rotation is one about the horizontal axis across the push."""
    axis = _axis(along)
    own = float(turn @ axis)
    return float(np.abs(turn - own * axis).max()) <= ACROSS * abs(own)


def _axis(along: np.ndarray) -> np.ndarray:
    """Return the horizontal axis across a push, about which what overturns turns."""
    return np.append(turned_left(along[:2]), 0.0)
