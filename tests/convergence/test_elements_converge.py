"""Orders of the element families on a smooth manufactured solution: p + 1 in displacement, p in strain energy norm.

(Strang and Fix, An Analysis of the Finite Element Method, 1973, chapter 3.)
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from concio.fem.constitutive import constitutive_matrix
from concio.fem.elements import build
from concio.fem.mesh import tensor
from concio.fem.shape import Shape
from concio.model.materials import Elastic

D = constitutive_matrix(Elastic(E=1.0, nu=0.3), "strain")
WAVE = 2.0
OUTLINE = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])


def displacement(x, y):
    return np.stack([np.sin(WAVE * x) * np.cos(WAVE * y), np.cos(WAVE * x + 1) * np.sin(WAVE * y)], axis=-1)


def strain(x, y):
    s, c = np.sin, np.cos
    exx = WAVE * c(WAVE * x) * c(WAVE * y)
    eyy = WAVE * c(WAVE * x + 1) * c(WAVE * y)
    gxy = -WAVE * s(WAVE * x) * s(WAVE * y) - WAVE * s(WAVE * x + 1) * s(WAVE * y)
    return np.stack([exx, eyy, gxy], axis=-1)


def body_force(x, y, h=1e-5):
    """Minus the divergence of the stress, by central differences of the exact stress."""

    def stress(x, y):
        return strain(x, y) @ D.T

    dx = (stress(x + h, y) - stress(x - h, y)) / (2 * h)
    dy = (stress(x, y + h) - stress(x, y - h)) / (2 * h)
    return -np.stack([dx[..., 0] + dy[..., 2], dx[..., 2] + dy[..., 1]], axis=-1)


def errors(name, n):
    """Error in displacement (root mean square) and in strain (energy norm) on an n x n mesh of wavy lines."""
    points, cells = tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    x, y = points.T
    bump = 0.04 * np.sin(np.pi * x) * np.sin(np.pi * y)  # elements tend to parallelograms as n grows
    points = points + np.column_stack([bump, -bump])
    shape = Shape(OUTLINE, build(points, cells, name, D), D, 1.0)
    el = shape.elements
    f = (el.N.T @ (el.weights[:, None] * body_force(*el.points.T))).ravel()
    nodes = el.nodes
    edge = np.repeat(((nodes < 1e-9) | (nodes > 1 - 1e-9)).any(1), 2)
    u = displacement(*nodes.T).ravel()
    K = sp.csr_array(shape.K)
    free = np.flatnonzero(~edge)
    held = np.flatnonzero(edge)
    u[free] = spla.spsolve(K[free][:, free].tocsc(), f[free] - K[free][:, held] @ u[held])
    off = el.N @ u.reshape(-1, 2) - displacement(*el.points.T)
    gap = (el.B @ u).reshape(-1, 3) - strain(*el.points.T)
    energy = np.einsum("p,pi,ij,pj->", el.weights, gap, D, gap)
    return np.sqrt(el.weights @ (off**2).sum(1)), np.sqrt(energy)


@pytest.mark.parametrize(("name", "p"), [("T3", 1), ("Q4", 1), ("Q4I", 1), ("T6", 2), ("Q8", 2), ("Q9", 2)])
def test_orders(name, p):
    coarse, fine = errors(name, 8), errors(name, 16)
    order = np.log2(np.array(coarse) / fine)
    assert order[0] > p + 1 - 0.2
    assert order[1] > p - 0.15
    assert fine[0] < 10.0 ** (-2 * p)
