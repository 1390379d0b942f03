"""``comparison.plot.displacement()``, ``halving.plot.limit()``: figures of walls beside their continuum, by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.continuum.comparison import ContinuumComparison
    from concio.analysis.continuum.halving import BlockHalving


@dataclass(frozen=True, eq=False)
class ContinuumPlots:
    """Figures side by side. Each method takes ``axes=`` and returns the axes it drew on."""

    comparison: ContinuumComparison

    def displacement(self, axes: Sequence[Axes] | None = None, **options: Any) -> list[Axes]:
        """Draw deformed shapes; see :func:`concio.plot.continuum_figure.plot_displacements`."""
        from concio.plot.continuum_figure import plot_displacements

        return plot_displacements(self.comparison, axes, **options)

    def stress(self, axes: Sequence[Axes] | None = None, **options: Any) -> list[Axes]:
        """Draw stresses; see :func:`concio.plot.continuum_figure.plot_stresses`."""
        from concio.plot.continuum_figure import plot_stresses

        return plot_stresses(self.comparison, axes, **options)

    def mechanism(self, axes: Sequence[Axes] | None = None, **options: Any) -> list[Axes]:
        """Draw mechanisms of collapse; see :func:`concio.plot.continuum_figure.plot_mechanisms`."""
        from concio.plot.continuum_figure import plot_mechanisms

        return plot_mechanisms(self.comparison, axes, **options)


@dataclass(frozen=True, eq=False)
class HalvingPlots:
    """Figures of a wall whose blocks become smaller. Each method takes ``ax=`` and returns the axes it drew on."""

    halving: BlockHalving

    def limit(self, ax: Axes | None = None) -> Axes:
        """Draw limit loads; see :func:`concio.plot.halving_figure.plot_limit_by_size`."""
        from concio.plot.halving_figure import plot_limit_by_size

        return plot_limit_by_size(self.halving, ax)

    def difference(self, ax: Axes | None = None) -> Axes:
        """Draw how far displacements are apart; see :func:`concio.plot.halving_figure.plot_difference_by_size`."""
        from concio.plot.halving_figure import plot_difference_by_size

        return plot_difference_by_size(self.halving, ax)
