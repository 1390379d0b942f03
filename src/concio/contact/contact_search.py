"""The contact search of a motion: looks for candidates again only when something has moved by half the skin.

What is the same for edges in the plane (:mod:`concio.contact.edge_search`) and surfaces of polyhedra
(:mod:`concio.contact.solid_search`): when to look, and what the layout of slots says in between.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

import numpy as np

from concio.contact.rows import RowMaker, Rows
from concio.contact.slots import Slots
from concio.contact.solid_touch import SolidTouch, SolidToucher
from concio.contact.touch import Touch, Toucher
from concio.kinematics.frames import norm
from concio.kinematics.placement import Placement

if TYPE_CHECKING:
    from concio.contact.reference import Reference

Array = np.ndarray

SKIN = 0.1
"""Skin over the median width of the bodies."""


class Placed(Protocol):
    """Outlines or surfaces where the bodies stand."""

    @property
    def start(self) -> Array:
        """Where edges begin, or vertices (k, d) [m]."""
        ...


P = TypeVar("P", bound=Placed)
P_co = TypeVar("P_co", bound=Placed, covariant=True)


class Surface(Protocol[P_co]):
    """Outlines or surfaces of all bodies as described."""

    @property
    def width(self) -> Array:
        """Widths of the bodies (B,) [m]."""
        ...

    def placed(self, placement: Placement) -> P_co:
        """Return them where bodies stand."""
        ...


@dataclass(frozen=True, eq=False)
class Layout:
    """Slots with what they were made from.

    Parameters
    ----------
    slots : Slots
    toucher : Toucher or SolidToucher
    maker : RowMaker
    start : (k, d) array
        Where edges began, or where vertices were, when the layout was made [m].
    """

    slots: Slots
    toucher: Toucher | SolidToucher
    maker: RowMaker
    start: Array


L = TypeVar("L", bound=Layout)


class ContactSearch(ABC, Generic[P, L]):
    """Finds the contact pairs of moving bodies.

    Parameters
    ----------
    reference : Reference
    surface : Surface
        Of its bodies.
    """

    def __init__(self, reference: Reference, surface: Surface[P]) -> None:
        self.reference, self.surface = reference, surface
        self.skin = SKIN * float(np.median(surface.width[reference.free]))
        self.slack = 1e-9 * reference.disc.size
        self.layout: L | None = None

    def update(self, placement: Placement) -> bool:
        """Look for candidates again where that is due; return whether the layout has changed."""
        placed, old = self.surface.placed(placement), self.layout
        if old is not None and self._near(old, placed) and not self.shifted(old, placed):
            return False
        self.layout, changed = self.found(placed, old)
        return changed

    def _near(self, layout: L, placed: P) -> bool:
        """Return whether everything is within half the skin of where it was."""
        return bool(norm(placed.start - layout.start).max(initial=0.0) <= 0.5 * self.skin)

    @abstractmethod
    def found(self, placed: P, old: L | None) -> tuple[L, bool]:
        """Return the layout where bodies stand, and whether it differs from an old one."""

    @abstractmethod
    def shifted(self, layout: L, placed: P) -> bool:
        """Return whether nodes of elastic bodies have others opposite than in a layout."""

    def touch(self, placement: Placement) -> Touch | SolidTouch:
        """Return the contact points of the present layout."""
        assert self.layout is not None
        placed = self.surface.placed(placement)
        return self.layout.toucher.touch(placed)  # type: ignore[arg-type]  # made for this surface

    def rows(
        self, placement: Placement, velocity: Array, spin: Array, strain: Array, *, turning: bool = True
    ) -> Rows:
        """Return the rows of bodies placed so, after :meth:`update`; see :meth:`concio.contact.rows.RowMaker.rows`."""
        assert self.layout is not None
        return self.layout.maker.rows(self.touch(placement), placement, velocity, spin, strain, turning=turning)

    def handed_on(self, rows: Rows, carried: Array) -> tuple[Array, Array, Array]:
        """Return which pairs stop to stand for a point, which ones go on in their place, and whether sides are swapped.

        Parameters
        ----------
        rows : Rows
            Where the bodies stand now.
        carried : (m,) boolean array
            Pairs that carried force before.
        """
        none = np.zeros(0, dtype=int)
        return none, none, np.zeros(0, dtype=bool)

    def row_maker(self, slots: Slots, toucher: Toucher | SolidToucher) -> RowMaker:
        """Return what writes the rows of slots."""
        reference = self.reference
        return RowMaker(reference.disc, slots, toucher, reference.node_column, reference.spin_axes)
