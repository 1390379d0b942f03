"""The contact search of a motion: looks for candidates again only when something has moved by half the skin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.candidates import CRUSHED, THROUGH, find_candidates
from concio.contact.edges import PlacedEdges
from concio.contact.rows import RowMaker, Rows
from concio.contact.slots import SlotMaker, Slots
from concio.contact.touch import Touch, Toucher
from concio.kinematics.frames import norm
from concio.kinematics.placement import Placement
from concio.model.interfaces.detect import SLIVER_SHARE

if TYPE_CHECKING:
    from concio.contact.reference import Reference

Array = np.ndarray

SKIN = 0.1
"""Skin over the median width of the bodies."""

SHIFT = 2e-3
"""Share of an edge by which a meshed side may slide along another before their coupling is worked out again."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Slots with what they were made from.

    Parameters
    ----------
    slots : Slots
    toucher : Toucher
    maker : RowMaker
    start : (e, 2) array
        Where the edges began when the layout was made.
    along : (f,) array
        Position of the bodies along their joints then [m].
    """

    slots: Slots
    toucher: Toucher
    maker: RowMaker
    start: Array
    along: Array


class ContactSearch:
    """Finds the contact pairs of moving bodies.

    Parameters
    ----------
    reference : Reference
    skin : float, optional
        Edges closer than this are candidates [m]; default :data:`SKIN` of the median width of the bodies.
    """

    def __init__(self, reference: Reference, skin: float | None = None) -> None:
        self.reference = reference
        disc = reference.disc
        self.edges = reference.edges
        width = float(np.median(self.edges.width[reference.free]))
        self.skin = SKIN * width if skin is None else skin
        self.slack = 1e-9 * disc.size
        self.through = CRUSHED if np.isfinite(reference.laws.cap).any() else THROUGH
        self.maker = SlotMaker(
            disc, self.edges, reference.laws, reference.rules, dict(reference.drawn), reference.first_node,
            len(reference.body_of_node),
        )  # fmt: skip
        self.layout: Layout | None = None
        self._moved = ~self.edges.fixed

    def update(self, placed: PlacedEdges) -> bool:
        """Look for candidates again where that is due; return whether the layout has changed."""
        if self.layout is not None and not self._due(self.layout, placed):
            return False
        found = find_candidates(self.edges, placed, self.skin, self.through)
        toucher = Toucher.of(self.edges, found, SLIVER_SHARE, self.slack)
        touch = toucher.touch(placed)
        slots = self.maker.make(found, toucher, touch, placed)
        reference = self.reference
        maker = RowMaker(reference.disc, slots, toucher, reference.node_column, reference.spin_axes)
        self.layout = Layout(slots, toucher, maker, placed.start, touch.length)
        return True

    def _due(self, layout: Layout, placed: PlacedEdges) -> bool:
        moved = norm(placed.start - layout.start)
        if moved.max(initial=0.0) > 0.5 * self.skin:
            return True
        if layout.slots.side_a is None:
            return False
        shifted = np.abs(layout.toucher.touch(placed).length - layout.along)
        return bool((shifted > SHIFT * layout.toucher.length_a).any())

    def touch(self, placed: PlacedEdges) -> Touch:
        """Return the contact points of the present layout."""
        assert self.layout is not None
        return self.layout.toucher.touch(placed)

    def rows(
        self, placement: Placement, velocity: Array, spin: Array, strain: Array, *, turning: bool = True
    ) -> Rows:
        """Return the rows of bodies placed so, after :meth:`update`; see :meth:`RowMaker.rows`."""
        assert self.layout is not None
        touch = self.layout.toucher.touch(self.edges.placed(placement))
        return self.layout.maker.rows(touch, placement, velocity, spin, strain, turning=turning)
