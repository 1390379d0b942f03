"""Figures of a result in space by name: those of the plane that space has, each in a fixed view."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from concio.errors import InputError
from concio.plot.accessor import Plots

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class SpacePlots(Plots):
    """Figures of one result in space; ``view`` is "front", "side", "plan" or "axonometry"."""

    def model(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the blocks; see :func:`concio.plot.space_figures.plot_space_model`."""
        from concio.plot.space_figures import plot_space_model

        return plot_space_model(self.result.model, ax, **options)

    def deformed(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the displaced shape with joint states; see :func:`concio.plot.space_figures.plot_space`."""
        from concio.plot.space_figures import plot_space

        return plot_space(self.result, ax, **options)

    def mechanism(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Draw the mechanism of a collapse; see :func:`concio.plot.space_figures.plot_space`."""
        if self.result.mechanism is None:
            msg = "there is no mechanism: the outcome is " + self.result.status.name.lower()
            raise InputError(msg, hint="plot.deformed() shows an equilibrium")
        return self.deformed(ax, **options)

    def principal(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Raise: this figure is one of the plane."""
        return _plane_only("principal")

    def pressure(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Raise: this figure is one of the plane."""
        return _plane_only("pressure")

    def forces(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Raise: this figure is one of the plane."""
        return _plane_only("forces")

    def slip(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Raise: this figure is one of the plane."""
        return _plane_only("slip")

    def thrust(self, ax: Axes | None = None, **options: Any) -> Axes:
        """Raise: this figure is one of the plane."""
        return _plane_only("thrust")

    def suitable(self) -> dict[str, Callable[[], Axes]]:
        """Return the figures that make sense for the result: what draws each, by name."""
        whole = "mechanism" if self.result.mechanism is not None and not self.result.solved else "deformed"
        found: dict[str, Callable[[], Axes]] = {"model": self.model}
        if self.result.solved or self.result.mechanism is not None:
            found |= {f"{whole}_{view}": _seen(self, view) for view in ("axonometry", "front", "side", "plan")}
        return found


def _seen(plots: SpacePlots, view: str) -> Callable[[], Axes]:
    def draw() -> Axes:
        return plots.deformed(view=view)

    return draw


def _plane_only(name: str) -> Axes:
    msg = f"plot.{name}() is a figure of the plane"
    raise InputError(msg, hint="in space: plot.model(), plot.deformed(), plot.mechanism() with view=..., or the report")
