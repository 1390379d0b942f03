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
    blocks: list[sp.csr_array | Array] = []
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
            blocks.append(density * body.volume * block)
        else:
            blocks.append(sp.kron(density * disc.shapes[s].mass, np.eye(disc.dim), format="csr"))
    if not blocks:
        return sp.csr_array((disc.unknowns, disc.unknowns))
    return sp.csr_array(sp.block_diag(blocks, format="csr"))
