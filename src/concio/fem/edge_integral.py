"""Integrals of shape functions along part of an edge: consistent loads, tributary lengths, mortar coupling."""

from __future__ import annotations

import numpy as np

Array = np.ndarray

GAUSS_X, GAUSS_W = np.polynomial.legendre.leggauss(3)


def pieces(at: Array, order: int) -> list[Array]:
    """Return the positions in ``at`` (indices) of the nodes of each one-dimensional element, in order."""
    return [np.arange(i, i + order + 1) for i in range(0, len(at) - 1, order)]


def lagrange(nodes: Array, x: Array) -> Array:
    """Return the Lagrange polynomials (k, n) through ``nodes`` (k,) at ``x`` (n,)."""
    values = np.ones((len(nodes), len(x)))
    for i, a in enumerate(nodes):
        for j, b in enumerate(nodes):
            if i != j:
                values[i] *= (x - b) / (a - b)
    return values


def gauss(left: float, right: float) -> tuple[Array, Array]:
    """Return three Gauss points and weights on [left, right]; exact to degree five."""
    half = (right - left) / 2
    return (left + right) / 2 + half * GAUSS_X, half * GAUSS_W


def edge_weights(at: Array, order: int, start: float, end: float) -> Array:
    """Return the integral (k,) of each node's shape function over [start, end] of the edge.

    Parameters
    ----------
    at : (k,) array
        Increasing node positions along the edge [m].
    order : {1, 2}
        Order of the one-dimensional elements.
    start, end : float
        Part of the edge that is integrated [m].
    """
    total = np.zeros(len(at))
    for nodes in pieces(at, order):
        left, right = max(start, at[nodes[0]]), min(end, at[nodes[-1]])
        if right > left:
            x, w = gauss(left, right)
            total[nodes] += lagrange(at[nodes], x) @ w
    return total
