r"""Masses of the bodies: what resists a structure that moves, in proportion to weight where weights are given.

.. math:: v^T M v = \int \rho\, \dot u \cdot \dot u \, dV .

A rigid body brings its mass and its tensor of inertia about the centroid; its rotations are times the reach r, so that
the tensor stands over :math:`r^2`. An elastic body brings the consistent mass of its elements. Both are exact for every
rigid motion: shape functions hold the linear functions, and products of two are integrated exactly.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from concio.fem.discretisation import RIGID, Discretisation
from concio.units import GRAVITY

Array = np.ndarray


def masses(disc: Discretisation) -> sp.csr_array:
    """Return the mass matrix of all bodies (N_all, N_all), symmetric positive definite [t = kN s2/m].

    Where every free body has a unit weight, masses are weights over gravity. Where one has none (it is common to leave
    the weight out), all bodies get a density of 1 t/m3 instead: some resistance to motion, equal everywhere.
    """
    model = disc.model
    free = [b for b in model.bodies if b.kind != "fixed"]
    weights = {b.material: model.materials[b.material].unit_weight for b in free}
    heavy = all(w > 0 for w in weights.values())
    rows, columns, values = list[Array](), list[Array](), list[Array]()
    elastic: dict[int, tuple[Array, Array, Array, int]] = {}  # bodies of one shape have one matrix, but for density
    begin = 0
    for b, s in enumerate(disc.shape_of):
        if s < 0 and s != RIGID:
            continue
        body = model.bodies[b]
        density = weights[body.material] / GRAVITY if heavy else 1.0
        if s == RIGID:
            tensor = body.moments.inertia / (body.moments.measure * float(disc.reach[b]) ** 2)
            rotating = len(tensor)
            block = np.eye(disc.dim + rotating)
            block[-rotating:, -rotating:] = 0.5 * (tensor + tensor.T)
            row, column = np.nonzero(block)
            value, size = density * body.volume * block[row, column], len(block)
        else:
            if s not in elastic:
                elastic[s] = _in_every_direction(disc.shapes[s].mass, disc.dim)
            row, column, value, size = elastic[s]
            value = density * value
        rows.append(row + begin)
        columns.append(column + begin)
        values.append(value)
        begin += size
    if not rows:
        return sp.csr_array((disc.unknowns, disc.unknowns))
    every = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return sp.csr_array(sp.coo_array(every, shape=(begin, begin)))


def _in_every_direction(mass: sp.csr_array, dim: int) -> tuple[Array, Array, Array, int]:
    """Return rows, columns and values of the mass of nodes (n, n) as one of displacements (n d, n d), and n d."""
    of = sp.coo_array(mass)
    d = np.arange(dim)
    row, column = (of.row[:, None] * dim + d).ravel(), (of.col[:, None] * dim + d).ravel()
    return row, column, np.repeat(of.data, dim), of.shape[0] * dim
