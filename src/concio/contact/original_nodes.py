"""Nodes of elastic bodies in contacts in space, written down once more for the certificate.

Of the search come the nodes of each side and their weights. That these belong to the point is checked: they sum to one,
are those of the body, and their mean as described is where the point touches the body.
"""

from __future__ import annotations

import numpy as np

from concio.contact.moving_solids import BESIDE
from concio.contact.reference import Reference
from concio.contact.slots import MeshedSide, Slots
from concio.contact.solid_search import SHIFT

Array = np.ndarray

SLACK = 2e-9
"""Rounding of places over the size of the model."""


def node_arms(reference: Reference) -> list[Array]:
    """Return where the nodes are (k, 3) that stand as vertices behind the corners of each body, from its centroid."""
    disc, solids, found = reference.disc, reference.solids, []
    for b, body in enumerate(reference.model.polyhedra):
        number = solids.node[solids.body == b][len(body.vertices) :]
        found.append(disc.nodes(b)[number] - disc.centroids[b])
    return found


def node_columns(reference: Reference, slots: Slots) -> list[Array]:
    """Return the unknowns (m, k) of the nodes of either side."""
    return [reference.node_column[side.node].reshape(len(slots), 3 * side.node.shape[1]) for side in _sides(slots)]


def node_rows(slots: Slots, frame: Array, rotation: Array, strain: Array) -> tuple[list[Array], Array]:
    """Return rows (m, 3, k) of either side along frames (m, 3, 3), and what strains add to gaps (m,) [m]."""
    padded, values, added = np.vstack([strain, np.zeros((1, 3))]), [], np.zeros(len(slots))
    for sign, body, side in zip((-1.0, 1.0), (slots.body_a, slots.body_b), _sides(slots), strict=False):
        local = np.matmul(frame, rotation[body])
        entries = np.einsum("mk,mdc->mdkc", sign * side.weight, local)
        values.append(entries.reshape(len(slots), 3, 3 * side.node.shape[1]))
        moved = (side.weight[:, :, None] * padded[side.node]).sum(axis=1)
        added += sign * (local[:, 0] * moved).sum(axis=1)
    return values, added


def nodes_belong(
    reference: Reference, slots: Slots, point: Array, gap: Array, centre: Array, rotation: Array
) -> Array:
    """Return the pairs (m,) whose nodes and weights are those of their points.

    Parameters
    ----------
    reference : Reference
    slots : Slots
    point : (m, 3) array
        Where the bodies stand, without their strains [m].
    gap : (m,) array
        The same [m].
    centre, rotation : (B, 3) and (B, 3, 3) arrays
    """
    solids, good = reference.solids, np.ones(len(slots), dtype=bool)
    owner, arm = np.append(reference.body_of_node, -1), np.vstack([reference.node_arm, np.zeros((1, 3))])
    rounding = SLACK * reference.disc.size
    for body, side in zip((slots.body_a, slots.body_b), _sides(slots), strict=False):
        own = np.flatnonzero(reference.disc.shape_of[body] >= 0)
        b, weight, node = body[own], side.weight[own], side.node[own]
        right = ((owner[node] == b[:, None]) | (weight == 0)).all(axis=1) & (np.abs(weight.sum(axis=1) - 1.0) < 1e-9)
        mean = (weight[:, :, None] * arm[node]).sum(axis=1)
        off = point[own] - centre[b] - np.matmul(rotation[b], mean[:, :, None])[:, :, 0]
        near = np.abs(gap[own]) + 2.0 * (SHIFT + BESIDE) * solids.spacing[b] + rounding
        good[own] &= right & (np.linalg.norm(off, axis=1) <= near)
    return good


def _sides(slots: Slots) -> list[MeshedSide]:
    """Return both sides, none where no body is elastic."""
    return [side for side in (slots.side_a, slots.side_b) if side is not None]
