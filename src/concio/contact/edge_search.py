"""The contact search of a motion in the plane: edges that face each other, and corners near edges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.contact.candidates import CRUSHED, THROUGH, find_candidates
from concio.contact.contact_search import ContactSearch, Layout
from concio.contact.edges import PlacedEdges
from concio.contact.slots import SlotMaker
from concio.contact.touch import Toucher
from concio.model.interfaces.detect import SLIVER_SHARE

if TYPE_CHECKING:
    from concio.contact.reference import Reference

Array = np.ndarray

SHIFT = 2e-3
"""Share of an edge by which a meshed side may slide along another before their coupling is worked out again."""


@dataclass(frozen=True, eq=False)
class EdgeLayout(Layout):
    """Slots of edges.

    Parameters
    ----------
    toucher : Toucher
    along : (f,) array
        Position of the bodies along their joints when the layout was made [m].
    """

    toucher: Toucher
    along: Array


class EdgeSearch(ContactSearch[PlacedEdges, EdgeLayout]):
    """Finds the contact pairs of bodies that move in the plane.

    Parameters
    ----------
    reference : Reference
    """

    def __init__(self, reference: Reference) -> None:
        super().__init__(reference, reference.edges)
        self.edges = reference.edges
        self.through = CRUSHED if np.isfinite(reference.laws.cap).any() else THROUGH
        self.maker = SlotMaker(
            reference.disc, self.edges, reference.laws, reference.rules, dict(reference.drawn), reference.first_node,
            len(reference.body_of_node),
        )  # fmt: skip

    def found(self, placed: PlacedEdges, old: EdgeLayout | None) -> tuple[EdgeLayout, bool]:
        """Return the layout where bodies stand; each is another one."""
        found = find_candidates(self.edges, placed, self.skin, self.through, self.reference.rules)
        toucher = Toucher.of(self.edges, found, SLIVER_SHARE, self.slack)
        touch = toucher.touch(placed)
        slots = self.maker.make(found, toucher, touch, placed)
        return EdgeLayout(slots, toucher, self.row_maker(slots, toucher), placed.start, touch.length), True

    def shifted(self, layout: EdgeLayout, placed: PlacedEdges) -> bool:
        """Return whether meshed sides have slid along each other."""
        if layout.slots.side_a is None:
            return False
        slid = np.abs(layout.toucher.touch(placed).length - layout.along)
        return bool((slid > SHIFT * layout.toucher.length_a).any())
