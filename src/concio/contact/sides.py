"""The two sides of every interface as arrays, and the marks that interfaces leave on the outlines of meshed bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from concio.fem.mesh import merged
from concio.kinematics.frames import turned_left
from concio.model.interfaces.detect import Interface
from concio.model.model import Body, Model

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class FacingSides:
    """All interfaces as arrays, i in all: bodies, edges with their ends, the common segment, its frame and gaps.

    ``p_b`` and ``q_b`` are ends of the image of b that a touches; ``shift`` is where it stands, from b itself.
    """

    a: Array
    b: Array
    edge_a: Array
    edge_b: Array
    p_a: Array
    q_a: Array
    p_b: Array
    q_b: Array
    start: Array
    end: Array
    normal: Array
    gap: Array
    shift: Array

    @classmethod
    def of(cls, bodies: Sequence[Body], interfaces: Sequence[Interface]) -> FacingSides:
        """Collect interfaces; ``p`` and ``q`` (i, 2) are the ends of the outline edges [m]."""
        numbers = np.array([(f.a, f.b, f.edge_a, f.edge_b) for f in interfaces], dtype=np.int64).reshape(-1, 4)
        vectors = np.array([(f.start, f.end, f.normal, f.gap) for f in interfaces], dtype=float).reshape(-1, 4, 2)
        a, b, edge_a, edge_b = numbers.T
        count = np.array([len(body.vertices) for body in bodies])
        first = np.concatenate([[0], np.cumsum(count)[:-1]])
        vertices = np.concatenate([body.vertices for body in bodies])
        following = np.concatenate([body.following + at for body, at in zip(bodies, first, strict=True)])
        shift = np.array([f.shift for f in interfaces], dtype=float).reshape(-1, 2)
        p_a, p_b = vertices[first[a] + edge_a], vertices[first[b] + edge_b] + shift
        q_a = vertices[following[first[a] + edge_a]]
        q_b = vertices[following[first[b] + edge_b]] + shift
        start, end, normal, gap = (vectors[:, k] for k in range(4))
        return cls(a, b, edge_a, edge_b, p_a, q_a, p_b, q_b, start, end, normal, gap, shift)


def interface_breaks(model: Model, interfaces: Sequence[Interface]) -> Mapping[int, list[Array]]:
    """Return for each meshed body where interfaces begin and end on each edge of its outline [m]."""
    meshed = np.array([b.kind == "elastic" and b.grid is None for b in model.bodies])
    sides = FacingSides.of(model.outlines, interfaces)
    found: dict[int, list[list[float]]] = {}
    for body, edge, p, q in (
        (sides.a, sides.edge_a, sides.p_a, sides.q_a),
        (sides.b, sides.edge_b, sides.p_b, sides.q_b),
    ):
        length = np.hypot(*(q - p).T)
        wedge, mean = (sides.gap > 0).any(1), turned_left(sides.normal)
        over = np.where(wedge, ((q - p) * mean).sum(1), 1.0)
        for end in (sides.start, sides.end):
            plain = ((end - p) * (q - p)).sum(1) / length
            at = np.where(wedge, length * ((end - p) * mean).sum(1) / over, plain)
            inside = meshed[body] & (at > 1e-6 * length) & (at < (1 - 1e-6) * length)
            for b, e, mark in zip(body[inside].tolist(), edge[inside].tolist(), at[inside].tolist(), strict=True):
                found.setdefault(b, [[] for _ in model.outlines[b].vertices])[e].append(mark)
    return {b: [_distinct(v, model.outlines[b]) for v in edges] for b, edges in found.items()}


def _distinct(marks: list[float], body: Body) -> Array:
    """Return marks in order, those nearer than a millionth of the body's size taken as one [m]."""
    if not marks:
        return np.zeros(0)
    return merged(np.array(marks), 1e-6 * float(np.ptp(body.outline, axis=0).max()))
