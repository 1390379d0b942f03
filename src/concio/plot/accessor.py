"""``result.plot.deformed()`` and its like: every figure of a result by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from concio.representation import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result


@short_repr
@dataclass(frozen=True, eq=False)
class Plots:
    """Figures of one result. Each method takes ``ax=`` and returns the axes it drew on; none shows a window.

    Parameters
    ----------
    result : Result

    Examples
    --------
    >>> import concio
    >>> import io
    >>> result = concio.solve(concio.column(width=0.5, height=2.0, blocks=4))
    >>> picture = io.BytesIO()
    >>> result.plot.deformed().figure.savefig(picture, format="png")
    >>> picture.getvalue()[1:4]
    b'PNG'
    """

    result: Result

    def model(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the model with names and supports; see :func:`concio.plot.model_figure.plot_model`."""
        from concio.plot.model_figure import plot_model

        return plot_model(self.result.model, ax, **options)

    def deformed(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the deformed shape with joint states; see :func:`concio.plot.deformed.plot_deformed`."""
        from concio.plot.deformed import plot_deformed

        return plot_deformed(self.result, ax, **options)

    def principal(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw principal-stress crosses; see :func:`concio.plot.stress_figure.plot_principal`."""
        from concio.plot.stress_figure import plot_principal

        return plot_principal(self.result, ax, **options)

    def pressure(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw contact pressure along joints; see :func:`concio.plot.forces.plot_pressure`."""
        from concio.plot.forces import plot_pressure

        return plot_pressure(self.result, ax, **options)

    def forces(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw force chains, or contact forces pair by pair; see :func:`concio.plot.forces.plot_forces`."""
        from concio.plot.forces import plot_forces

        return plot_forces(self.result, ax, **options)

    def slip(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw opening and slip of the joints; see :func:`concio.plot.deformed.plot_slip`."""
        from concio.plot.deformed import plot_slip

        return plot_slip(self.result, ax, **options)

    def thrust(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the line of thrust; see :func:`concio.plot.forces.plot_thrust`."""
        from concio.plot.forces import plot_thrust

        return plot_thrust(self.result, ax, **options)

    def mechanism(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the mechanism of a collapse; see :func:`concio.plot.deformed.plot_mechanism`."""
        from concio.plot.deformed import plot_mechanism

        return plot_mechanism(self.result, ax, **options)
