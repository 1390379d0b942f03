"""``moduli.plot.polar()``, ``domain.plot.sections()``, ``path.plot.curve()``: figures of cells by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from concio.representation import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.cells.cell_path_result import CellPath
    from concio.analysis.cells.moduli import Moduli
    from concio.analysis.cells.strength import StrengthDomain


@short_repr
@dataclass(frozen=True, eq=False)
class ModuliPlots:
    """Figures of homogenised moduli. Each method takes ``ax=`` and returns the axes it drew on."""

    moduli: Moduli

    def polar(self, ax: Axes | None = None) -> Axes:
        """Draw the moduli by direction; see :func:`concio.plot.moduli_figure.plot_moduli`."""
        from concio.plot.moduli_figure import plot_moduli

        return plot_moduli(self.moduli, ax)


@short_repr
@dataclass(frozen=True, eq=False)
class StrengthPlots:
    """Figures of a strength domain. Each method takes ``ax=`` and returns the axes it drew on."""

    domain: StrengthDomain

    def sections(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw sections of the domain; see :func:`concio.plot.strength_figure.plot_sections`."""
        from concio.plot.strength_figure import plot_sections

        return plot_sections(self.domain, ax, **options)

    def biaxial(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw it under principal stresses; see :func:`concio.plot.strength_figure.plot_biaxial`."""
        from concio.plot.strength_figure import plot_biaxial

        return plot_biaxial(self.domain, ax, **options)

    def uniaxial(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw tension and compression by direction; see :func:`concio.plot.strength_figure.plot_uniaxial`."""
        from concio.plot.strength_figure import plot_uniaxial

        return plot_uniaxial(self.domain, ax, **options)

    def surface(self, ax: Any | None = None, **options: Any) -> Any:
        """Draw the surface; see :func:`concio.plot.strength_figure.plot_surface`."""
        from concio.plot.strength_figure import plot_surface

        return plot_surface(self.domain, ax, **options)

    def mechanism(self, ray: int = 0, ax: Axes | None = None) -> Axes:
        """Draw the mechanism of a direction; see :func:`concio.plot.cell_figure.plot_cell_mechanism`."""
        from concio.plot.cell_figure import plot_cell_mechanism

        return plot_cell_mechanism(self.domain, ray, ax)


@short_repr
@dataclass(frozen=True, eq=False)
class CellPathPlots:
    """Figures of the path of a cell. Each method takes ``ax=`` and returns the axes it drew on."""

    path: CellPath

    def curve(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw stress against strain; see :func:`concio.plot.cell_path_figure.plot_cell_path`."""
        from concio.plot.cell_path_figure import plot_cell_path

        return plot_cell_path(self.path, ax, **options)

    def state(self, step: int = -1, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the cell at a step; see :func:`concio.plot.cell_figure.plot_cell_state`."""
        from concio.plot.cell_figure import plot_cell_state

        return plot_cell_state(self.path, step, ax, **options)
