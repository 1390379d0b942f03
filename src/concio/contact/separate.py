"""Structures that stand apart: groups of bodies whose boxes do not come near each other.

What is near is measured by the sizes of the bodies. Interfaces are looked for in each group by itself, with a tolerance
of its own, so that nothing far away changes an answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from concio.kinematics.boxes import meeting_boxes
from concio.model.interfaces.detect import Detection
from concio.model.interfaces.point_contact import PointContact
from concio.model.model import Model
from concio.model.rules import JointRule
from concio.problem.once import once
from concio.representation import short_repr

Array = np.ndarray

NEAR = 0.1
"""Boxes are near within this share of the longest side of the smaller one: twice what near misses look at."""


def separate_groups(model: Model) -> list[Array]:
    """Return the numbers of the bodies of each structure that stands apart, in order of their first free body.

    Parameters
    ----------
    model : Model

    Returns
    -------
    list of integer arrays
        A fixed body belongs to every group whose free bodies come near it; one near none belongs to no group.
    """
    low, high = (np.array([f(body.vertices, axis=0) for body in model.bodies]) for f in (np.min, np.max))
    return grouped(low, high, free_of(model), model.gap_reach or 0.0)


@short_repr
@dataclass(frozen=True, eq=False)
class Surroundings:
    """The box around each body, and how large the structure is that it belongs to.

    Parameters
    ----------
    low, high : (B, d) arrays
        Corners of the boxes [m].
    size : (B,) array
        Longest side of the box around the structure that stands apart, fixed bodies near it included; of a fixed body
        the largest of its structures, of one that no free body comes near its own [m].
    """

    low: Array
    high: Array
    size: Array

    def of(self, bodies: Sequence[int]) -> float:
        """Return the size of the largest structure that some bodies belong to [m]."""
        return float(self.size[list(bodies)].max())


@once
def surroundings(model: Model) -> Surroundings:
    """Return the boxes of the bodies of a model and the sizes of their structures.

    What is measured by the size of a structure is measured by that of its own: another one, of whatever size and
    however far away, changes no digit.

    Parameters
    ----------
    model : Model
    """
    low, high = (np.array([f(body.vertices, axis=0) for body in model.bodies]) for f in (np.min, np.max))
    size = (high - low).max(axis=1)
    groups = [np.arange(len(size))] if model.periods is not None else separate_groups(model)
    for group in groups:
        own = float((high[group].max(axis=0) - low[group].min(axis=0)).max())
        size[group] = np.maximum(size[group], own)
    return Surroundings(low, high, size)


def free_of(model: Model) -> Array:
    """Return which bodies have unknowns (B,)."""
    return np.array([body.kind != "fixed" for body in model.bodies])


def grouped(
    low: Array, high: Array, free: Array, reach: float, tied: Array | None = None, known: Sequence[Array] = ()
) -> list[Array]:
    """Return the numbers of the bodies of each group that stands apart, in order of their first free body.

    Parameters
    ----------
    low, high : (B, d) arrays
        Corners of the boxes around the bodies [m].
    free : (B,) boolean array
        Which of them have unknowns.
    reach : float
        Distance that is near in any case [m].
    tied : (k, 2) integer array, optional
        Bodies that ties connect.
    known : sequence of integer arrays
        Bodies that belong together, wherever they stand.
    """
    count = len(free)
    a, b = _near(low, high, reach)
    if tied is not None:
        a, b = np.concatenate([a, tied[:, 0]]), np.concatenate([b, tied[:, 1]])
    for group in known:
        first = np.full(len(group), group[free[group]][0])
        a, b = np.concatenate([a, first]), np.concatenate([b, group])
    both = free[a] & free[b]
    links = sp.coo_array((np.ones(int(both.sum())), (a[both], b[both])), shape=(count, count))
    _, label = connected_components(links, directed=False)
    labels = list(dict.fromkeys(label[free].tolist()))
    held: dict[int, set[int]] = {k: set(np.flatnonzero(free & (label == k)).tolist()) for k in labels}
    for p, q in zip(a.tolist(), b.tolist(), strict=True):
        if free[p] != free[q]:
            held[int(label[p if free[p] else q])].add(q if free[p] else p)
    return [np.array(sorted(held[k])) for k in labels]


def _near(low: Array, high: Array, reach: float) -> tuple[Array, Array]:
    """Return the pairs of bodies whose boxes come as near each other as the smaller one's size makes near."""
    size = (high - low).max(axis=1)
    margin = np.maximum(NEAR * size, reach)[:, None]
    a, b = meeting_boxes(low - margin, high + margin)
    apart = np.maximum(low[b] - high[a], low[a] - high[b]).max(axis=1)
    near = apart <= np.maximum(NEAR * np.minimum(size[a], size[b]), reach)
    return a[near], b[near]


def bare(model: Model, group: Array) -> Model:
    """Return the model of some bodies, with their joints and nothing that loads or holds them."""
    bodies = tuple(model.bodies[b] for b in group)
    return replace(
        model, bodies=bodies, rules=(JointRule(next(iter(model.laws))),), loads=(), supports=(), ties=(), stages=()
    )


def merged(found: Sequence[tuple[Array, Detection]]) -> Detection:
    """Return one detection of groups of bodies, each with the numbers (k,) of its bodies in the model."""
    interfaces: list[Any] = [
        replace(face, a=int(own[face.a]), b=int(own[face.b])) for own, part in found for face in part.interfaces
    ]
    ordered = sorted(interfaces, key=lambda face: (isinstance(face, PointContact), face.a, face.b))
    misses = [replace(m, bodies=_own(own, m.bodies)) for own, part in found for m in part.near_misses]
    overlaps = [replace(o, bodies=_own(own, o.bodies)) for own, part in found for o in part.overlaps]
    return Detection(
        tuple(ordered),
        tuple({(m.kind, m.bodies, tuple(m.at)): m for m in misses}.values()),
        tuple({o.bodies: o for o in overlaps}.values()),
    )


def _own(own: Array, bodies: tuple[int, int]) -> tuple[int, int]:
    return int(own[bodies[0]]), int(own[bodies[1]])
