r"""Macroscopic strain of a periodic cell: a load group for each component moves the pairs across the cell's edges.

Displacements of a periodic medium under the macroscopic strain E are u(x) = E x plus what repeats itself. With u of the
bodies of one cell as unknowns, the image of body b that stands at the shift s moves by u_b + E s, so that the relative
displacement of a pair across an edge is

.. math:: C_n u + n \cdot E s, \qquad C_t u + t \cdot E s .

What a strain component adds is linear in its value, like a moved obstacle, and all that is built on load groups (load
steps, paths, events) works on cells too. A translation of the whole changes no relative displacement; it is taken out
by holding one point, whose reaction is zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from concio.contact.pairs import Pairs
from concio.model.interfaces.detect import Interface
from concio.model.model import Array, Model, Support

COMPONENTS = ("xx", "yy", "xy")
"""Components of macroscopic strain and stress, in this order; the strain xy is the engineering shear, 2 E_xy."""

STRAINS = tuple(f"strain {c}" for c in COMPONENTS)
"""Names of the load groups."""

ORIGIN = "origin"
"""Name of the support that takes out translations."""


def strain_columns(pairs: Pairs, interfaces: Sequence[Interface]) -> tuple[Array, Array]:
    """Return what unit macroscopic strains add to the relative displacements of the pairs, (m, 3) along n and t [m]."""
    shift = np.array([face.shift for face in interfaces], dtype=float).reshape(-1, 2)[pairs.interface]
    x, y = shift.T

    def columns(direction: Array) -> Array:
        a, b = direction.T
        return np.column_stack([a * x, b * y, 0.5 * (a * y + b * x)])

    return columns(pairs.normal), columns(pairs.tangent)


def strain_groups(pairs: Pairs, interfaces: Sequence[Interface]) -> dict[str, tuple[Array, Array]]:
    """Return for each strain component the change of normal (m,) and tangential (m, 1) relative displacement [m]."""
    normal, tangential = strain_columns(pairs, interfaces)
    return {name: (normal[:, k].copy(), tangential[:, [k]]) for k, name in enumerate(STRAINS)}


def held_at_a_point(model: Model) -> Model:
    """Return a cell with a support that holds the first corner of its first body."""
    body = model.outlines[0]
    x, y = (float(v) for v in body.outline[0])
    return replace(model, periods=None, supports=(Support(ORIGIN, body.name, ((x, y), (x, y))),))
