"""Contact pairs of contacts without area: corners and edges, in the plane and in space.

They have the friction of the law between the two bodies and nothing that is per area: cohesion and tensile strength are
zero there, and a joint stiffness does not act. A corner is one pair, an edge one at each end, or five along it where a
body deforms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from concio.contact.laws import RuleBook
from concio.contact.operators import Entries, nodal_entries, operators, rigid_entries
from concio.contact.pairs import CONTACT_MODELS, Pairs
from concio.fem.discretisation import FIXED, RIGID, Discretisation
from concio.kinematics.frames import frames
from concio.model.interfaces.point_contact import PointContact

Array = np.ndarray

ALONG = 5
"""Points along an edge where a body deforms."""


def add_point_pairs(disc: Discretisation, pairs: Pairs, contacts: Sequence[PointContact], first: int) -> Pairs:
    """Return the pairs with those of contacts without area.

    Parameters
    ----------
    disc : Discretisation
    pairs : Pairs
        Of the interfaces before them.
    contacts : sequence of PointContact
    first : int
        Number of the first of them among all interfaces.

    Raises
    ------
    InputError
        No joint law matches a contact.
    """
    if not contacts:
        return pairs
    a, b = np.array([(c.a, c.b) for c in contacts]).T
    law, opening = RuleBook(disc.model).find(a, b)
    share = [_shares(disc, c) for c in contacts]
    of = np.repeat(np.arange(len(contacts)), [len(s) for s in share])
    on_a = np.concatenate([_along(c.points, s) for c, s in zip(contacts, share, strict=True)])
    signed = np.concatenate([_along(c.signed_gap[:, None], s) for c, s in zip(contacts, share, strict=True)])
    gap = np.concatenate([_along(c.gap[:, None], s)[:, 0] for c, s in zip(contacts, share, strict=True)])
    normal = np.array([c.normal for c in contacts])[of]
    frame = frames(normal)
    on_b = on_a + signed * normal
    middle = 0.5 * (on_a + on_b)
    entries: list[Entries] = []
    for body, own, sign in ((a[of], on_a, -1.0), (b[of], on_b, 1.0)):
        entries += _entries(disc, body, own, middle, frame, sign)
    C_n, C_t = operators(entries, len(of), disc.unknowns, disc.dim)
    none = np.zeros(len(of))
    join = np.concatenate
    return replace(
        pairs,
        body_a=join([pairs.body_a, a[of]]),
        body_b=join([pairs.body_b, b[of]]),
        interface=join([pairs.interface, first + of]),
        point=np.vstack([pairs.point, middle]),
        normal=np.vstack([pairs.normal, normal]),
        tangents=join([pairs.tangents, frame[:, 1:]]),
        length=join([pairs.length, none if disc.dim == 2 else np.full(len(of), np.nan)]),
        area=join([pairs.area, none]),
        gap=join([pairs.gap, gap + opening[of]]),
        law=join([pairs.law, law[of]]),
        C_n=sp.csr_array(sp.vstack([pairs.C_n, C_n])),
        C_t=sp.csr_array(sp.vstack([pairs.C_t, C_t])),
        rule=join([pairs.rule, np.full(len(of), CONTACT_MODELS.index("corner or edge"))]),
    )


def _shares(disc: Discretisation, contact: PointContact) -> Array:
    """Return where the pairs of a contact stand, from 0 at its first point to 1 at its last."""
    if len(contact.points) == 1:
        return np.zeros(1)
    meshed = max(disc.shape_of[contact.a], disc.shape_of[contact.b]) >= 0
    return np.linspace(0.0, 1.0, ALONG if meshed else 2)


def _along(values: Array, share: Array) -> Array:
    return np.asarray(values[0] + share[:, None] * (values[-1] - values[0]))


def _entries(
    disc: Discretisation, body: Array, own: Array, middle: Array, frame: Array, sign: float
) -> list[Entries]:
    """Return the entries of one side: rigid bodies at the middle between both, meshed ones at their own points."""
    rigid = np.flatnonzero(disc.shape_of[body] == RIGID)
    b = body[rigid]
    arm = middle[rigid] - disc.centroids[b]
    found = [rigid_entries(rigid, frame[rigid], arm, disc.reach[b], disc.offsets[b], sign)]
    for k in np.flatnonzero((disc.shape_of[body] != RIGID) & (disc.shape_of[body] != FIXED)).tolist():
        unknowns, rows = disc.point_operator(int(body[k]), own[k])
        first, weight = unknowns[:: disc.dim], rows[0, :: disc.dim]
        pair = np.full(len(first), k)
        found.append(nodal_entries(pair, frame[pair], weight, first, sign))
    return found
