"""Fill, road and vehicle of a bridge in the figure of its model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from concio.model.road.earth import ground_of
from concio.plot import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.model.model import Model

Array = np.ndarray

EARTH, LAYER = "#E9DFC8", "#CFC6B4"
NEAR = 0.06
"""Axles nearer to each other than this share of the road have their loads written upwards."""


def road_box(model: Model) -> Array:
    """Return the corners (2, 2) of the box around the road line of a model [m]."""
    line = ground_of(model)[1].line
    return np.array([line.min(0), line.max(0)])


def draw_fill(ax: Axes, model: Model) -> list[Any]:
    """Draw fill, layers and road line below everything else; return their entries of the legend."""
    surface, road = ground_of(model)
    assert model.fill is not None
    x = np.unique(np.concatenate([surface.start[:, 0], surface.end[:, 0], road.line[:, 0], road.under[:, 0]]))
    low, high = surface.height(x), road.height(x)
    deep = road.surfacing(x) + sum(layer.depth for layer in model.fill.layers)
    ax.fill_between(x, low, high - deep, facecolor=EARTH, edgecolor="none", zorder=0.5)
    entries = [style.patch(EARTH, "fill", "none")]
    if deep.any():
        ax.fill_between(x, high - deep, high, facecolor=LAYER, edgecolor="none", zorder=0.6)
        entries.append(style.patch(LAYER, "layers of the road", "none"))
    ax.plot(*road.line.T, color=style.INK, lw=1.2, zorder=4)
    return entries


def draw_vehicle(ax: Axes, model: Model, position: float, direction: str = "", *, heights: float = 0.06) -> None:
    """Draw the axles of the vehicle of a model as arrows onto the road, and stretches of uniform load as bars."""
    assert model.vehicle is not None
    road = ground_of(model)[1]
    low, high = float(road.line[0, 0]), float(road.line[-1, 0])
    size = heights * (high - low)
    places = sorted(x for x, *_, stretch in model.vehicle.footprints(position, direction) if not stretch)
    turned = 90 if min(np.diff(places), default=np.inf) < NEAR * (high - low) else 0
    heaviest = model.vehicle.heaviest.load * model.vehicle.dynamic * model.vehicle.factor
    for x, length, load, stretch in model.vehicle.footprints(position, direction):
        a, b = max(x - length / 2, low), min(x + length / 2, high)
        if stretch and b > a:
            y = road.height(np.array([a, b]))
            ax.fill_between([a, b], y, y + 0.25 * size, color=style.LOAD.colour, alpha=0.35, lw=0, zorder=5)
        elif not stretch and low <= x <= high:
            y0 = float(road.height(np.array([x]))[0])
            tall = size * (0.4 + 0.6 * load / heaviest)
            ax.annotate("", (x, y0), (x, y0 + tall), zorder=5,
                        arrowprops={"arrowstyle": "-|>", "color": style.LOAD.colour, "lw": 1.4})  # fmt: skip
            ax.plot([x - length / 2, x + length / 2], [y0, y0], color=style.LOAD.colour, lw=3, zorder=5,
                    solid_capstyle="butt")  # fmt: skip
            ax.annotate(f"{load:.4g}", (x, y0 + tall), ha="center", va="bottom", fontsize=7, color=style.LOAD.colour,
                        rotation=turned)  # fmt: skip
