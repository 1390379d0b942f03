"""Motion of each body: the mean displacement of its centroid and its mean rotation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from concio.contact.factors import load_factor
from concio.fem.discretisation import FIXED, RIGID
from concio.kinematics.rigid import motions, rigid_operator

if TYPE_CHECKING:
    from concio.analysis.result import Result

Array = np.ndarray


def body_motions(result: Result, u: Array | None = None) -> Array:
    """Return (u_x, u_y, rotation) of each body (B, 3), in space (u_x, u_y, u_z, rotation vector) (B, 6) [m, rad].

    A deformed body has the rigid motion that fits its nodes best (least squares over the nodes, about the centroid). A
    fixed body has the movement imposed on it, and none when ``u`` is given.

    Parameters
    ----------
    result : Result
    u : (N_all,) array, optional
        Other displacements than the result's, such as a mechanism.
    """
    disc = result.assembly.disc
    own = result.displacement if u is None else u
    d, r = disc.dim, motions(disc.dim)
    motion = np.zeros((len(disc.shape_of), r))
    rigid = np.flatnonzero(disc.shape_of == RIGID)
    motion[rigid] = own[disc.offsets[rigid][:, None] + np.arange(r)]
    motion[rigid, d:] /= disc.reach[rigid][:, None]
    for s, shape in enumerate(disc.shapes):
        bodies = np.flatnonzero(disc.shape_of == s)
        if not len(bodies):
            continue
        arm = shape.elements.nodes - (disc.centroids[bodies[0]] - disc.origins[bodies[0]])
        modes = rigid_operator(arm, 1.0).reshape(-1, r)
        nodal = own[disc.offsets[bodies][:, None] + np.arange(len(modes))]
        motion[bodies] = nodal @ np.linalg.pinv(modes).T
    if u is None:
        number = {b.name: k for k, b in enumerate(result.model.bodies)}
        for support in result.model.supports:
            b = number[support.body]
            if disc.shape_of[b] == FIXED:
                factor = load_factor(result.factors, support.group)
                motion[b] += factor * np.array([*support.displacement, *np.broadcast_to(support.rotation, r - d)])
    return motion
