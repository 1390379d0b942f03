"""``found.plot.curve()``, ``found.plot.mechanism()``, ``found.plot.changes()``: figures of a bridge by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from concio.plot.bridge_figures import plot_changes, plot_curve, plot_standing
from concio.representation import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.bridges.bridge_result import BridgeResult
    from concio.analysis.bridges.sweep import Standing


@short_repr
@dataclass(frozen=True, eq=False)
class BridgePlots:
    """Figures of a vehicle on a bridge. Each method takes ``ax=`` and returns the axes it drew on.

    Parameters
    ----------
    found : BridgeResult
    """

    found: BridgeResult

    def curve(self, ax: Axes | None = None) -> Axes:
        """Draw the load factor over the position: :func:`plot_curve`."""
        return plot_curve(self.found, ax)

    def mechanism(self, ax: Axes | None = None, *, standing: Standing | None = None) -> Axes:
        """Draw the mechanism of a position, by default of the worst: :func:`plot_standing`."""
        return plot_standing(self.found, standing, ax)

    def changes(self, ax: Axes | None = None) -> Axes:
        """Draw the sensitivities: :func:`plot_changes`."""
        return plot_changes(self.found, ax)
