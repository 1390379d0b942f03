"""Parts of a structure that mechanisms are sought in unasked: what stands above a level, what lies beyond a line.

The weakest mechanism of all is sought among all motions. Where joints slide, that search ends at one of several
collapse states, and another may be weaker; and a mechanism with a larger multiplier may be worse off in its checks, as
it starts higher or has less way to go. So mechanisms are sought in parts as well, while all other bodies are held:
above every level at which courses meet, storeys, lintels and sills among them, and beyond the lines in plan or
elevation at which the structure changes: a facade without its returns, a pier beside an opening. Where a model holds
several structures that touch only what is fixed, each is searched for itself, so that none hides another.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.contact.assembly import Assembly
from concio.model.model import Model

Array = np.ndarray

CHANGE = 0.02
"""A level or line at which the area of the bodies changes by more than this share is one of openings or returns."""

MOST_LEVELS, MOST_LINES = 24, 4
"""Levels, and lines, at most."""

PAIRS = {2: 12_000, 3: 4_500}
"""Contact pairs times levels at most, but for :data:`LEAST` levels: in space a programme takes up to seconds."""

LEAST = 3


@dataclass(frozen=True)
class Part:
    """Bodies that a mechanism is sought among.

    Parameters
    ----------
    kind : {"above", "beyond", "alone"}
    at : float
        The level z, or the coordinate of the line along the push [m]; ``nan`` of a structure alone.
    bodies : tuple of int
    of : str
        Its first body where the model holds several structures.
    """

    kind: str
    at: float
    bodies: tuple[int, ...]
    of: str = ""

    @property
    def name(self) -> str:
        """What it is called."""
        whose = f" of '{self.of}'" if self.of else ""
        if self.kind == "alone":
            return f"'{self.of}' and what it touches"
        where = f"above z = {self.at:.4g} m" if self.kind == "above" else f"beyond {self.at:.4g} m along the push"
        return where + whose


def parts_of(assembly: Assembly, along: Array) -> tuple[Part, ...]:
    """Return the parts of a structure under a push.

    Parameters
    ----------
    assembly : Assembly
    along : (d,) array
        Horizontal unit vector of the push.
    """
    model, pairs = assembly.model, assembly.pairs
    free = np.array([i for i, b in enumerate(model.bodies) if b.kind != "fixed"])
    up = np.zeros(model.dim)
    up[-1] = 1.0
    groups = _structures(assembly, free)
    most = max(min(MOST_LEVELS, PAIRS[model.dim] // max(len(pairs), 1)), LEAST)
    levels = max(most // len(groups), 1)
    found: dict[tuple[int, ...], Part] = {tuple(free.tolist()): Part("above", -np.inf, tuple(free.tolist()))}
    for group in groups[:most]:
        of = model.bodies[group[0]].name if len(groups) > 1 else ""
        found.setdefault(group, Part("alone", np.nan, group, of))
        for kind, axis, count in (("above", up, levels), ("beyond", along, MOST_LINES)):
            for at in _lines(model, list(group), axis, count, changes_only=kind == "beyond"):
                bodies = tuple(i for i in group if float(np.asarray(model.bodies[i].centroid) @ axis) > at)
                if bodies:
                    found.setdefault(bodies, Part(kind, at, bodies, of))
    return tuple(found.values())[1:]


def _structures(assembly: Assembly, free: Array) -> list[tuple[int, ...]]:
    """Return the bodies that can move in groups that touch, or are tied to, each other."""
    count, moves = len(assembly.model.bodies), np.zeros(len(assembly.model.bodies) + 1, dtype=bool)
    moves[free] = True
    a, b = np.asarray(assembly.pairs.body_a), np.asarray(assembly.pairs.body_b)
    both = moves[a] & moves[b]
    graph = sp.coo_array((np.ones(int(both.sum())), (a[both], b[both])), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    return [tuple(free[label[free] == k].tolist()) for k in dict.fromkeys(label[free].tolist())]


def _lines(model: Model, free: list[int], axis: Array, most: int, *, changes_only: bool) -> list[float]:
    """Return coordinates along an axis at which bodies begin or end, the ones at which much changes first."""
    spans = np.array([(s.min(), s.max()) for s in (np.asarray(model.bodies[i].vertices) @ axis for i in free)])
    section = np.array([model.bodies[i].volume for i in free]) / np.maximum(np.ptp(spans, axis=1), 1e-300)
    size = float(np.ptp(spans)) or 1.0
    every = np.unique(np.round(spans.ravel() / (1e-6 * size))) * 1e-6 * size
    inner = [float(v) for v in every if spans.min() + 1e-4 * size < v < spans.max() - 1e-4 * size]
    step = 1e-4 * size

    def area(at: float) -> float:
        return float(section[(spans[:, 0] < at) & (spans[:, 1] > at)].sum())

    changes = [v for v in inner if abs(area(v + step) - area(v - step)) > CHANGE * max(area(v + step), area(v - step))]
    if changes_only:
        return _spread(changes, most)
    levels = [v for v in inner if (np.abs(spans[:, 0] - v) < step).any()]
    kept = _spread([v for v in changes if v in levels], most)
    return sorted({*kept, *_spread([v for v in levels if v not in kept], most - len(kept))})


def _spread(values: list[float], most: int) -> list[float]:
    """Return at most ``most`` of some values, evenly chosen."""
    if len(values) <= most:
        return values
    if most <= 0:
        return []
    chosen = np.unique(np.linspace(0, len(values) - 1, most + 2)[1:-1].round().astype(int))
    return [values[k] for k in chosen]
