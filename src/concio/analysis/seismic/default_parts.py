"""Parts of a structure that mechanisms are sought in by default: what stands above a level, what lies beyond a line.

The weakest mechanism of all is sought among all motions. Where joints slide, that search ends at one of several
collapse states, and another may be weaker; and a mechanism with a larger multiplier may be worse off in its checks, as
it starts higher or has less way to go. So mechanisms are sought in parts as well, while all other bodies are held:
above every level at which courses meet, storeys, lintels and sills among them; beside every line of an opening and
every face of a return or cross wall (:mod:`concio.analysis.seismic.layout`), on either side where it is a line across
the push; beyond other lines along the push at which the structure changes. Where a model holds several structures that
touch only what is fixed, each is searched for itself, so that none hides another. How many of each kind there are and
how many were sought is reported.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.analysis.seismic.layout import THIN, leaves_of, openings_of, returns_of, spans_along
from concio.contact.assembly import Assembly
from concio.contact.separate import surroundings
from concio.kinematics.frames import turned_left
from concio.model.model import Model

Array = np.ndarray

CHANGE = 0.02
"""A level or line at which the area of the bodies changes by more than this share is one of openings or returns."""

MOST_LEVELS, MOST_LINES, MOST_CHANGES = 24, 16, 4
"""Levels, lines of openings and returns, and other lines, at most."""

PAIRS = {2: 12_000, 3: 4_500}
"""Contact pairs times levels at most, but for :data:`LEAST` levels: in space a programme takes up to seconds."""

LEAST = 3


@dataclass(frozen=True)
class Part:
    """Bodies that a mechanism is sought among.

    Parameters
    ----------
    kind : {"above", "beyond", "past", "short of", "alone"}
        "beyond" a line along the push; "past" and "short of" one across it.
    at : float
        The level z, or the coordinate of the line along the push, or across it [m]; ``nan`` of a structure alone.
    bodies : tuple of int
    of : str
        Its first body where the model holds several structures.
    what : str
        Which kind of place it is: "levels", "openings", "returns", "changes" or "alone".
    digits : int
        Of the coordinate in its name.
    """

    kind: str
    at: float
    bodies: tuple[int, ...]
    of: str = ""
    what: str = "levels"
    digits: int = 4

    @property
    def name(self) -> str:
        """What it is called."""
        whose = f" of '{self.of}'" if self.of else ""
        if self.kind == "alone":
            return f"'{self.of}' and what it touches"
        at = f"{self.at:.{self.digits}g} m"
        if self.kind == "above":
            return f"above z = {at}{whose}"
        return f"{self.kind} {at} {'along' if self.kind == 'beyond' else 'across'} the push{whose}"


@dataclass(frozen=True)
class Parts:
    """Parts of a structure under a push, and how many places of each kind they stand for.

    Parameters
    ----------
    parts : tuple of Part
    sought, there : mapping of str to int
        For "levels", "openings", "returns" and "changes" the levels or lines that were sought at, and those there are.
    """

    parts: tuple[Part, ...]
    sought: Mapping[str, int]
    there: Mapping[str, int]


def parts_of(assembly: Assembly, along: Array) -> Parts:
    """Return the parts of a structure under a push.

    Parameters
    ----------
    assembly : Assembly
    along : (d,) array
        Horizontal unit vector of the push.
    """
    model = assembly.model
    free = np.array([i for i, b in enumerate(model.bodies) if b.kind != "fixed"])
    up = np.zeros(model.dim)
    up[-1] = 1.0
    groups = structures_of(assembly)
    own_pairs = _pairs_of(assembly, groups)
    found: dict[tuple[int, ...], Part] = {tuple(free.tolist()): Part("above", -np.inf, tuple(free.tolist()))}
    sought, there = Counter[str](), Counter[str]()

    def cut(group: tuple[int, ...], kind: str, axis: Array, at: float, of: str, what: str) -> None:
        sign = -1.0 if kind == "short of" else 1.0
        bodies = tuple(i for i in group if sign * (float(np.asarray(model.bodies[i].centroid) @ axis) - at) > 0)
        if bodies:
            found.setdefault(bodies, Part(kind, at, bodies, of, what))

    for group, many in zip(groups, own_pairs, strict=True):
        of = model.bodies[group[0]].name if len(groups) > 1 else ""
        found.setdefault(group, Part("alone", np.nan, group, of, "alone"))
        most = max(min(MOST_LEVELS, PAIRS[model.dim] // max(many, 1)), LEAST)
        levels = _lines(model, list(group), up, many + MOST_LEVELS, changes_only=False)
        kept = _lines(model, list(group), up, most, changes_only=False)
        lines = _lines_of(model, group, along)
        chosen = [lines[k] for k in _spread(list(range(len(lines))), MOST_LINES)]
        changes = _lines(model, list(group), along, MOST_CHANGES, changes_only=True)
        for at in kept:
            cut(group, "above", up, at, of, "levels")
        for line in chosen:
            for kind in ("past", "short of") if line.across else ("beyond",):
                cut(group, kind, line.axis, line.at, of, line.kind)
        for at in changes:
            cut(group, "beyond", along, at, of, "changes")
        sought.update({"levels": len(kept), "changes": len(changes), **Counter(line.kind for line in chosen)})
        there.update({"levels": len(levels), "changes": len(changes), **Counter(line.kind for line in lines)})
    return Parts(_told_apart(tuple(found.values())[1:]), sought, there)


def _told_apart(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """Return parts with as many digits in their names as tell them apart, as far from the origin as they may be."""
    for digits in range(Part.digits, 18):
        parts = tuple(replace(part, digits=digits) for part in parts)
        if len({part.name for part in parts}) == len(parts):
            break
    return parts


@dataclass(frozen=True, eq=False)
class _Line:
    """A line of an opening or a return: its kind, axis, coordinate [m], and whether it lies across the push."""

    kind: str
    axis: Array
    at: float
    across: bool


def _lines_of(model: Model, group: tuple[int, ...], along: Array) -> list[_Line]:
    """Return the lines of all openings, returns and cross walls of a structure, those of one place once."""
    if model.dim == 2:
        return _once([_Line("openings", along, at, False) for o in openings_of(model, group, along) for at in o.sides])
    across = np.array([*turned_left(along[:2]), 0.0])
    across = across * (1.0 if across[np.argmax(np.abs(across))] > 0 else -1.0)
    cross = returns_of(model, group, along, across)
    lines = [_Line("returns", across, at, True) for face in cross for at in face]
    for leaf in leaves_of(model, group, along, across):
        lines += [_Line("openings", across, at, True) for o in openings_of(model, leaf, across) for at in o.sides]
    place = spans_along(model, group, across).mean(axis=1)
    for low, high in cross:
        wall = [i for i, m in zip(group, place, strict=True) if low <= m <= high]
        lines += [_Line("openings", along, at, False) for o in openings_of(model, wall, along) for at in o.sides]
    ends = spans_along(model, group, across)
    first, last = float(ends.min()), float(ends.max())
    near = 1e-4 * surroundings(model).of(group)
    return _once([x for x in lines if not x.across or first + near < x.at < last - near])


def _once(lines: list[_Line]) -> list[_Line]:
    """Return lines of which none has the axis and place of another."""
    found: dict[tuple[bool, float], _Line] = {}
    for line in lines:
        found.setdefault((line.across, round(line.at, 6)), line)
    return list(found.values())


def structures_of(assembly: Assembly) -> list[tuple[int, ...]]:
    """Return the bodies that can move in groups that touch, or are tied to, each other, in the order of their first."""
    free = np.array([i for i, b in enumerate(assembly.model.bodies) if b.kind != "fixed"])
    count, moves = len(assembly.model.bodies), np.zeros(len(assembly.model.bodies) + 1, dtype=bool)
    moves[free] = True
    a, b = np.asarray(assembly.pairs.body_a), np.asarray(assembly.pairs.body_b)
    both = moves[a] & moves[b]
    graph = sp.coo_array((np.ones(int(both.sum())), (a[both], b[both])), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    return [tuple(free[label[free] == k].tolist()) for k in dict.fromkeys(label[free].tolist())]


def _pairs_of(assembly: Assembly, groups: list[tuple[int, ...]]) -> list[int]:
    """Return how many contact pairs each structure has."""
    number = np.full(len(assembly.model.bodies) + 1, -1)
    for k, group in enumerate(groups):
        number[list(group)] = k
    of_pair = np.maximum(number[np.asarray(assembly.pairs.body_a)], number[np.asarray(assembly.pairs.body_b)])
    return [int(many) for many in np.bincount(of_pair[of_pair >= 0], minlength=len(groups))]


def _lines(model: Model, free: list[int], axis: Array, most: int, *, changes_only: bool) -> list[float]:
    """Return coordinates along an axis at which bodies begin or end, the ones at which much changes first."""
    spans = np.array([(s.min(), s.max()) for s in (np.asarray(model.bodies[i].vertices) @ axis for i in free)])
    section = np.array([model.bodies[i].volume for i in free]) / np.maximum(np.ptp(spans, axis=1), 1e-300)
    size = float(np.ptp(spans)) or 1.0
    every: list[float] = []
    for v in np.sort(spans.ravel()):
        if not every or v - every[-1] > THIN * size:
            every.append(float(v))
    inner = [v for v in every if spans.min() + 1e-4 * size < v < spans.max() - 1e-4 * size]
    step = 1e-4 * size

    def area(at: float) -> float:
        return float(section[(spans[:, 0] < at) & (spans[:, 1] > at)].sum())

    changes = [v for v in inner if abs(area(v + step) - area(v - step)) > CHANGE * max(area(v + step), area(v - step))]
    if changes_only:
        return _spread(changes, most)
    levels = [v for v in inner if (np.abs(spans[:, 0] - v) < step).any()]
    kept = _spread([v for v in changes if v in levels], most)
    return sorted({*kept, *_spread([v for v in levels if v not in kept], most - len(kept))})


def _spread(values: list[Any], most: int) -> list[Any]:
    """Return at most ``most`` of some values, evenly chosen."""
    if len(values) <= most:
        return values
    if most <= 0:
        return []
    chosen = np.unique(np.linspace(0, len(values) - 1, most + 2)[1:-1].round().astype(int))
    return [values[k] for k in chosen]
