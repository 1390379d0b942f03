"""How far gaps as contact states them are from gaps between displaced outlines, where meshes do not match.

At nodes of one side the certificate's gap is a mean over the neighbourhood, weighted with dual functions
(:mod:`concio.contact.coupling`); the outlines have gaps of their own at that place. Where meshes match, or neither
side is meshed, both are the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from concio.contact.coupling import cut, interpolation
from concio.contact.pairs import CONTACT_MODELS, Pairs, line_of, place
from concio.contact.sides import FacingSides
from concio.fem.discretisation import FIXED, RIGID, Discretisation
from concio.kinematics.rigid import rigid_row
from concio.model.interfaces.detect import Interface

Array = np.ndarray

WEIGHTED = CONTACT_MODELS.index("dual mortar")


def outline_gaps(disc: Discretisation, interfaces: Sequence[Interface], pairs: Pairs) -> tuple[Array, sp.csr_array]:
    """Return the pairs (k,) that state weighted gaps, and how their outlines move apart, on all unknowns (k, N).

    The operator gives the displacement of side b less that of side a along the normal, at the pairs' points.
    """
    chosen = np.flatnonzero(pairs.rule == WEIGHTED)
    if not chosen.size:
        return chosen, sp.csr_array((0, disc.unknowns))
    sides = FacingSides.of(disc.model.outlines, interfaces)
    along = sides.end - sides.start
    length = np.hypot(*along.T)
    along = along / length[:, None]
    face = pairs.interface[chosen]
    at = ((pairs.point[chosen] - sides.start[face]) * along[face]).sum(1)
    rows, columns, values = [], [], []
    for body, edge, p, q, sign, shift in (
        (sides.a, sides.edge_a, sides.p_a, sides.q_a, -1.0, np.zeros_like(sides.shift)),
        (sides.b, sides.edge_b, sides.p_b, sides.q_b, 1.0, sides.shift),
    ):
        first, forwards, _ = place(disc, body, edge, p, q, sides.start, along, 1.0)
        for f in np.unique(face):
            own = np.flatnonzero(face == f)
            b, normal = int(body[f]), sides.normal[f]
            if disc.shape_of[b] == FIXED:
                continue
            line = line_of(disc, b, int(edge[f]), float(first[f]), bool(forwards[f]))
            if line is None:
                assert disc.shape_of[b] == RIGID
                arm = pairs.point[chosen[own]] - shift[f] - disc.centroids[b]
                weight = rigid_row(np.broadcast_to(normal, arm.shape), arm, np.full(len(own), disc.reach[b]))
                column = disc.offsets[b] + np.arange(3)
            else:
                line = cut(line, float(length[f]))
                weight = (interpolation(line, at[own]).T[:, :, None] * normal).reshape(len(own), -1)
                column = disc.offsets[b] + (2 * line.nodes[:, None] + np.arange(2)).ravel()
            rows.append(np.repeat(own, weight.shape[1]))
            columns.append(np.tile(column, len(own)))
            values.append(sign * weight.ravel())
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return chosen, sp.csr_array(entries, shape=(len(chosen), disc.unknowns))
