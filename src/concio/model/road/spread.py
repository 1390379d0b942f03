r"""How live load on the road reaches the masonry below: named rules, which are data.

At depth z a footprint of length b covers the length :math:`\ell = b + b_0 + a z` along the road, symmetrical about its
middle, with a pressure over it that is uniform, half a sine wave, or that of a strip on an elastic half plane
(Boussinesq), which at the distance x from the middle is proportional to

.. math:: \alpha + \sin\alpha \cos(\alpha + 2\beta), \qquad
          \beta = \arctan\frac{x - b/2}{z}, \quad \alpha + \beta = \arctan\frac{x + b/2}{z}.

Depths differ from place to place, and bridges end: the pressures are therefore scaled so that their total over the
surface below is the load. Each straight piece of the surface is cut where the pressure begins and ends on it, and
integrated by Gauss points. A load that is uniform along the road spreads footprint by footprint, as the sum of its
parts.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache, lru_cache
from importlib.resources import files
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from concio.arguments import closest, strict_class
from concio.errors import InputError
from concio.model.road.surface import Road, Surface

Array = np.ndarray

SHORT = 0.25
"""Uniform load spreads in footprints that are at most this long [m]."""
KEPT = 2048
"""Footprints whose pressures are kept: uniform load has the same ones at every position of a vehicle."""
GAUSS = np.polynomial.legendre.leggauss(8)
SHAPES = ("uniform", "sine", "boussinesq")


@strict_class
@dataclass(frozen=True)
class SpreadRule:
    """A rule by which live load spreads through fill.

    Parameters
    ----------
    name : str
    along, across : float
        Length and width gained with each metre of depth, both sides together.
    shape : {"uniform", "sine", "boussinesq"}
        Pressure over the length.
    length, width : float
        Length and width gained at once [m].
    footprint, width_over : float or None
        Length and width of the footprint in place of the axle's [m].
    source : str

    Examples
    --------
    A wheel of 1.8 m in width, under 0.5 m of fill that spreads 1:2 to both sides:

    >>> from concio.bridges import SpreadRule
    >>> rule = SpreadRule("1:2", along=1.0, across=1.0)
    >>> round(rule.width_at(1.8, 0.5), 6)
    2.3
    """

    name: str
    along: float
    across: float
    shape: Literal["uniform", "sine", "boussinesq"] = "uniform"
    length: float = 0.0
    width: float = 0.0
    footprint: float | None = None
    width_over: float | None = None
    source: str = ""

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            msg = f"shape = '{self.shape}' is not one of {', '.join(SHAPES)}"
            raise InputError(msg, where=f"spread rule '{self.name}'")
        for name in ("along", "across", "length", "width", "footprint", "width_over"):
            value = getattr(self, name)
            if value is not None and not 0 <= value < np.inf:
                msg = f"{name} = {value:g} must be zero or positive"
                raise InputError(msg, where=f"spread rule '{self.name}'")

    def base(self, footprint: float) -> float:
        """Return the length covered at the road [m]."""
        return (footprint if self.footprint is None else self.footprint) + self.length

    def width_at(self, width: float, depth: float) -> float:
        """Return the width covered at a depth [m], of an axle of a width [m]."""
        return (width if self.width_over is None else self.width_over) + self.width + self.across * depth

    def pressure(self, x: Array, depth: Array, base: float) -> Array:
        """Return the pressure, up to a factor, at distances x from the middle and depths [m]; zero outside."""
        length = base + self.along * depth
        inside = np.abs(x) <= 0.5 * length * (1 + 1e-9)
        if self.shape == "uniform":
            value = 1.0 / length
        elif self.shape == "sine":
            value = np.cos(np.pi * np.clip(x / length, -0.5, 0.5)) / length
        else:
            low, high = np.arctan2(x - 0.5 * base, depth), np.arctan2(x + 0.5 * base, depth)
            alpha = high - low
            value = (alpha + np.sin(alpha) * np.cos(high + low)) / base
        return np.where(inside, value, 0.0)


@dataclass(frozen=True, eq=False)
class SpreadLoad:
    """What a load on the road brings to a surface.

    Parameters
    ----------
    piece : (k,) integer array
        Pieces of the surface that are loaded.
    force : (k,) array
        On each, downwards [kN]; their sum is the load.
    at : (k, 2) array
        Where its resultant acts [m].
    """

    piece: Array
    force: Array
    at: Array


def along_the_road(begin: float, end: float, load: float, origin: float = 0.0) -> list[tuple[float, float, float]]:
    """Return a load (kN) that is uniform along the road as short footprints, each of which spreads by itself.

    So a stretch is the sum of its parts, and far from its ends the pressure below is that on the road. They end at
    ``origin`` and at multiples of :data:`SHORT` from it, so that those of one stretch are those of another.

    Examples
    --------
    >>> from concio.model.road.spread import along_the_road
    >>> along_the_road(1.0, 1.5, 30.0)
    [(1.125, 0.25, 15.0), (1.375, 0.25, 15.0)]
    """
    first, last = (int(np.floor((x - origin) / SHORT)) for x in (begin, end))
    ends = [begin, *(x for k in range(first, last + 1) if begin < (x := origin + k * SHORT) < end), end]
    return [(0.5 * (a + b), b - a, load * (b - a) / (end - begin)) for a, b in pairwise(ends)]


def spread(
    rule: SpreadRule, surface: Surface, road: Road, footprints: tuple[tuple[float, float, float], ...]
) -> SpreadLoad:
    """Return what loads on the road bring to the surface below.

    Parameters
    ----------
    rule : SpreadRule
    surface : Surface
    road : Road
    footprints : tuple of (x, length, load)
        Middle [m], length along the road [m], force [kN] of each.

    Raises
    ------
    InputError
        A load stands beside the road.
    """
    force, moment = np.zeros(len(surface)), np.zeros(len(surface))
    for x, length, load in footprints:
        first, second = _shares(rule, surface, road, x, length)
        total = first.sum()
        if not total > 0:
            low, high = surface.reach
            msg = f"an axle of {load:.4g} kN at x = {x:.4g} m stands outside the road ({low:.4g} to {high:.4g} m)"
            raise InputError(msg, where="vehicle", hint="move the vehicle, or let the road reach further")
        force += load / total * first
        moment += load / total * second
    piece = np.flatnonzero(force > 0)
    start, end = surface.start[piece], surface.end[piece]
    at = moment[piece] / force[piece]
    share = np.clip((at - start[:, 0]) / (end[:, 0] - start[:, 0]), 0.0, 1.0)
    return SpreadLoad(piece, force[piece], start + share[:, None] * (end - start))


@lru_cache(maxsize=KEPT)
def _shares(rule: SpreadRule, surface: Surface, road: Road, x: float, footprint: float) -> tuple[Array, Array]:
    """Return integral and first moment (n,) of the pressure under one load over the pieces of a surface."""
    base = rule.base(footprint)
    start, end = surface.start, surface.end
    depth = [road.height(p[:, 0]) - p[:, 1] for p in (start, end)]
    reach = 0.5 * base + 0.5 * rule.along * np.maximum(*depth)
    near = np.flatnonzero((start[:, 0] <= x + reach) & (end[:, 0] >= x - reach))
    first, second = np.zeros(len(surface)), np.zeros(len(surface))
    if not len(near):
        return first, second
    left, right = start[near, 0], end[near, 0]
    low, high = depth[0][near], depth[1][near]
    kinks = _kinks(rule, (left, right), (low, high), x, base)
    cuts = np.sort(np.concatenate([np.zeros((len(near), 1)), kinks, np.ones((len(near), 1))], axis=1), axis=1)
    points, weights = GAUSS
    for k in range(cuts.shape[1] - 1):
        begin, width = cuts[:, k], cuts[:, k + 1] - cuts[:, k]
        share = begin[:, None] + width[:, None] * 0.5 * (points + 1.0)
        place = left[:, None] + share * (right - left)[:, None]
        z = low[:, None] + share * (high - low)[:, None]
        value = rule.pressure(place - x, z, base) * (0.5 * weights * (width * (right - left))[:, None])
        first[near] += value.sum(1)
        second[near] += (value * place).sum(1)
    return first, second


def _kinks(
    rule: SpreadRule, ends: tuple[Array, Array], depths: tuple[Array, Array], x: float, base: float
) -> Array:
    """Return where the pressure begins, changes and ends on each piece, as shares of it (n, 5); 0 where it does not."""
    (left, right), (low, high) = ends, depths
    found = []
    for side in (-1.0, 1.0):  # side (place - x) = base / 2 + along z / 2, both linear over the piece
        rest = side * (left - x) - 0.5 * base - 0.5 * rule.along * low
        slope = side * (right - left) - 0.5 * rule.along * (high - low)
        found.append(np.where(slope != 0, -rest / np.where(slope != 0, slope, 1.0), 0.0))
        found.append((x + side * 0.5 * base - left) / (right - left))
    found.append((x - left) / (right - left))
    shares: Array = np.clip(np.stack(found, axis=1), 0.0, 1.0)
    return shares


@cache
def spread_rules() -> dict[str, SpreadRule]:
    """Return the rules that come with concio, by name."""
    text = files("concio.model.road").joinpath("spread_rules.toml").read_text(encoding="utf-8")
    return {name: SpreadRule(name, **table) for name, table in tomllib.loads(text).items()}


def spread_rule(given: str | Mapping[str, Any]) -> SpreadRule:
    """Return a rule by its name, or the user's own.

    Raises
    ------
    InputError
        There is no such rule, or a key is not known.
    """
    known = spread_rules()
    if isinstance(given, str):
        if given not in known:
            msg = f"there is no spread rule '{given}'"
            raise InputError(msg, where="fill, spread", hint=closest(given, known))
        return known[given]
    names = [f.name for f in fields(SpreadRule)]
    for key in given:
        if key not in names:
            msg = f"unknown key '{key}'"
            raise InputError(msg, where="fill, spread", hint=closest(key, names))
    for key in ("along", "across"):
        if key not in given:
            msg = f"'{key}' is missing"
            raise InputError(msg, where="fill, spread", hint="length gained with each metre of depth, both sides")
    return SpreadRule(**{"name": "own", **given})
