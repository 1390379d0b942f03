"""Lumped masses of the bodies: what resists a structure that moves, in proportion to weight where weights are given."""

from __future__ import annotations

import numpy as np

from concio.fem.discretisation import RIGID, Discretisation
from concio.units import GRAVITY

Array = np.ndarray


def lumped_masses(disc: Discretisation) -> Array:
    """Return the mass that goes with each unknown (N_all,), positive [t = kN s2/m].

    Where every free body has a unit weight, masses are weights over gravity. Where one has none (it is common to leave
    the weight out), all bodies get a density of 1 t/m3 instead: some resistance to motion, equal everywhere. The
    rotation of a rigid body carries its mass too, since its unknown is the rotation times the radius of gyration.
    """
    model = disc.model
    free = [b for b in model.bodies if b.kind != "fixed"]
    weights = {b.material: model.materials[b.material].unit_weight for b in free}
    heavy = all(w > 0 for w in weights.values())
    masses = np.ones(disc.unknowns)
    for b, s in enumerate(disc.shape_of):
        if s < 0 and s != RIGID:
            continue
        body = model.bodies[b]
        density = weights[body.material] / GRAVITY if heavy else 1.0
        at = disc.offsets[b]
        if s == RIGID:
            masses[at : disc.offsets[b + 1]] = density * body.volume
            continue
        nodal = disc.shapes[s].volume_weights
        if nodal.min() <= 0:  # corners of eight-node elements: share the volume equally
            nodal = np.full(nodal.size, nodal.sum() / nodal.size)
        masses[at : disc.offsets[b + 1]] = density * np.repeat(nodal, disc.dim)
    return masses
