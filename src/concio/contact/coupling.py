r"""Coupling of two sides along a common segment: node pairs where meshes match, dual mortar where they do not.

Contact is stated at the nodes j of one side, the *slave*. With dual functions :math:`\psi_j`,
:math:`\int \psi_j N_k = \delta_{jk} w_j`, the relative displacement of pair j is

.. math:: \frac{1}{w_j} \int \psi_j\,(u_b - u_a)\,ds , \qquad w_j = \int N_j\, ds ,

which is the difference of two nodal values where the meshes match, and for any meshes transmits a uniform pressure
exactly because the dual functions sum to one (Wohlmuth 2000). Where the end of the segment cuts a slave of quadratic
elements, they count as linear between their nodes.

A pair stands at :math:`\frac{1}{w_j} \int \psi_j\, s\, ds`, the node itself, and there a rigid side is read. Where the
segment ends inside an element, the functions N are those of the nodes inside and of the ends of the segment. No pair
stands beyond an end: a force there would have an arm that the contact does not have.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from concio.contact.joint_points import joint_rule
from concio.fem.edge_integral import edge_weights, gauss, lagrange, pieces

Array = np.ndarray

MERGED = 1e-3
"""Nodes nearer to a cut than this share of the shortest element share its point: two rows of one place are singular."""


EVEN = 1e-6
"""Lines whose squared distances of nodes add up to the same but for this share are even alike."""


@dataclass(frozen=True)
class Line:
    """Nodes of one side along the segment.

    Parameters
    ----------
    nodes : (k,) integer array
        Node numbers.
    at : (k,) array
        Increasing positions along the segment [m]; the segment is [0, length].
    order : {1, 2}
    """

    nodes: Array
    at: Array
    order: int


@dataclass(frozen=True)
class Side:
    """Weights with which one side's nodes enter the pairs: entries (pair, node, weight)."""

    pair: Array
    node: Array
    weight: Array


@dataclass(frozen=True)
class Coupling:
    """Pairs along one segment.

    Parameters
    ----------
    at : (p,) array
        Position of each pair along the segment [m].
    length : (p,) array
        Tributary length of each pair [m].
    a, b : Side or None
        None where that side is rigid or fixed and moves as the point at ``at``.
    model : str
        How contact is stated, in words.
    """

    at: Array
    length: Array
    a: Side | None
    b: Side | None
    model: str = "dual mortar"


def cut(line: Line, length: float) -> Line:
    """Return the part of a line whose elements overlap [0, length]."""
    keep: list[int] = []
    tolerance = 1e-9 * length
    for nodes in pieces(line.at, line.order):
        if line.at[nodes[-1]] > tolerance and line.at[nodes[0]] < length - tolerance:
            keep.extend(nodes if not keep else nodes[1:])
    index = np.array(keep, dtype=int)
    return Line(line.nodes[index], line.at[index], line.order)


def match(a: Line, b: Line, length: float) -> bool:
    """Return whether both lines have the same nodes, and these begin and end with the segment."""
    tolerance = 1e-7 * length
    return bool(
        len(a.at) == len(b.at)
        and a.order == b.order
        and np.abs(a.at - b.at).max() <= tolerance
        and abs(a.at[0]) <= tolerance
        and abs(a.at[-1] - length) <= tolerance
    )


def couple(a: Line | None, b: Line | None, length: float, points: int = 2) -> Coupling:
    """Return the pairs of a segment of the given length.

    Parameters
    ----------
    a, b : Line or None
        Meshed sides; None for a rigid or fixed side.
    length : float
        Length of the segment [m].
    points : int
        Number of pairs where neither side is meshed: 2 carry any linear pressure; more resolve compliant or
        crushing joints.
    """
    a, b = (None if line is None else cut(line, length) for line in (a, b))
    if a is None and b is None:
        model = "ends of the joint" if points == 2 else "points along the joint"
        at, share = joint_rule(points)
        return Coupling(at * length, share * length, None, None, model)
    if a is not None and b is not None and match(a, b, length):
        weights = edge_weights(a.at, a.order, 0.0, length)
        pair = np.arange(len(a.at))
        one = np.ones(len(pair))
        return Coupling(a.at, weights, Side(pair, a.nodes, one), Side(pair, b.nodes, one), "node pairs")
    if a is None or (b is not None and _finer(b, a)):
        assert b is not None
        at, weights, own, other = _mortar(b, a, length)
        return Coupling(at, weights, other, own)
    at, weights, own, other = _mortar(a, b, length)
    return Coupling(at, weights, own, other)


def _finer(line: Line, other: Line) -> bool:
    """Return whether a line has more nodes than another one, or as many at more even distances.

    The numbering of the bodies does not decide it, except between lines that are alike or mirror images.
    """
    if len(line.at) != len(other.at):
        return len(line.at) > len(other.at)
    own, others = (float((np.diff(side.at) ** 2).sum()) for side in (line, other))
    return own < (1 - EVEN) * others


def _mortar(slave: Line, master: Line | None, length: float) -> tuple[Array, Array, Side, Side | None]:
    """Return positions, tributary lengths, and the entries of slave and master."""
    tolerance = 1e-9 * length
    is_cut = slave.at[0] < -tolerance or slave.at[-1] > length + tolerance
    points, order = (_within(slave, length), 1) if is_cut else (slave.at, slave.order)
    k = len(points)
    weight, moment = np.zeros(k), np.zeros(k)
    own = np.zeros((k, len(slave.at)))
    other = np.zeros((k, 0 if master is None else len(master.at)))
    marks = slave.at if master is None else np.concatenate([slave.at, master.at])
    for nodes in pieces(points, order):
        left, right = max(0.0, points[nodes[0]]), min(length, points[nodes[-1]])
        if right - left <= tolerance:
            continue
        inner = np.unique(
            np.concatenate([[left, right], marks[(marks > left + tolerance) & (marks < right - tolerance)]])
        )
        xs, ws = (np.concatenate(v) for v in zip(*(gauss(p, q) for p, q in pairwise(inner)), strict=True))
        shape = lagrange(points[nodes], xs)
        lumped = shape @ ws
        psi = lumped[:, None] * np.linalg.solve((shape * ws) @ shape.T, shape)
        weight[nodes] += lumped
        moment[nodes] += psi @ (ws * xs)
        own[nodes] += (psi * ws) @ interpolation(slave, xs).T
        if master is not None:
            other[nodes] += (psi * ws) @ interpolation(master, xs).T
    used = weight > 1e-12 * length
    position = moment[used] / weight[used]
    first = _entries(own[used] / weight[used, None], slave.nodes)
    second = None if master is None else _entries(other[used] / weight[used, None], master.nodes)
    return position, weight[used], first, second


def _within(slave: Line, length: float) -> Array:
    """Return the points of a slave that the segment cuts: its nodes inside, and the ends of the segment."""
    near = MERGED * float(np.diff(slave.at).min())
    return np.concatenate([[0.0], slave.at[(slave.at > near) & (slave.at < length - near)], [length]])


def interpolation(line: Line, x: Array) -> Array:
    """Return the shape functions (k, n) of a line at ``x``; beyond its ends the end elements are continued."""
    values = np.zeros((len(line.at), len(x)))
    elements = pieces(line.at, line.order)
    breaks = np.array([line.at[nodes[0]] for nodes in elements[1:]])
    which = np.searchsorted(breaks, x, side="right")
    for e, nodes in enumerate(elements):
        at = np.flatnonzero(which == e)
        if len(at):
            values[np.ix_(nodes, at)] = lagrange(line.at[nodes], x[at])
    return values


def _entries(matrix: Array, nodes: Array) -> Side:
    pair, column = np.nonzero(np.abs(matrix) > 1e-13)
    return Side(pair, nodes[column], matrix[pair, column])
