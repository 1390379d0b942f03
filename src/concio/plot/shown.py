"""Figures that no window shows and that a notebook shows by themselves: the figure, and the axes that a plot returns.

A plot returns its ``Axes``, as plots of NumPy's neighbours do. A notebook asks what ends a cell for its picture by
``_repr_png_``, which neither matplotlib's axes nor figures made without ``pyplot`` have.
"""

from __future__ import annotations

from functools import partial
from io import BytesIO
from typing import TYPE_CHECKING, Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DPI = 110
"""Resolution of pictures in notebooks."""


class ShownFigure(Figure):
    """A figure that a notebook shows by itself, as it does each of its axes."""

    def _repr_png_(self) -> bytes:
        return png(self)

    def add_axes(self, *args: Any, **options: Any) -> Axes:
        """Add axes, as :class:`matplotlib.figure.Figure` does."""
        axes: Axes = _shown(super().add_axes(*args, **options))
        return axes

    def add_subplot(self, *args: Any, **options: Any) -> Axes:
        """Add a subplot, as :class:`matplotlib.figure.Figure` does."""
        axes: Axes = _shown(super().add_subplot(*args, **options))
        return axes


def new_figure(size: tuple[float, float], **options: Any) -> Figure:
    """Return a figure of a width and a height [in] that no window shows and a notebook does.

    Parameters
    ----------
    size : (float, float)
    **options
        Of :class:`matplotlib.figure.Figure`.
    """
    figure = ShownFigure(figsize=size, **options)
    FigureCanvasAgg(figure)
    return figure


def png(figure: Figure) -> bytes:
    """Return the picture of a figure."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI)
    return buffer.getvalue()


def _shown(axes: Any) -> Any:
    axes._repr_png_ = partial(png, axes.figure)
    return axes
