"""Figures of principal stresses as crosses: the paper's figure 3 for blocks, and the same for elements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from concio.arguments import strict
from concio.plot import style
from concio.post.crosses import crosses

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result

Array = np.ndarray


@strict
def plot_principal(
    result: Result,
    ax: Axes | None = None,
    *,
    of: Literal["bodies", "elements"] = "bodies",
    shade: bool = True,
    scale: float | None = None,
) -> Axes:
    """Draw mean principal stresses as crosses, compression and tension distinguished by colour and by dash.

    Parameters
    ----------
    result : Result
    ax : Axes, optional
        Where to draw; default a new figure.
    of : {"bodies", "elements"}
        One cross for each body, or for each element.
    shade : bool
        Fill the bodies the darker the more they are compressed.
    scale : float, optional
        Length of an arm that shows 1 kN/m2 [m].

    Returns
    -------
    Axes
    """
    found = crosses(result, of)
    largest = found.largest
    typical = float(np.median(found.size[found.size >= np.median(found.size)])) if len(found.size) else 1.0
    longest = typical * (1.25 if of == "bodies" else 1.8)
    scale = (longest / largest if largest > 0 else 1.0) if scale is None else scale
    lines, value = found.arms(scale)
    ax, _, box = style.draw_at_rest(result, ax, face=_shades(result) if shade else None, around=lines)
    size = np.abs(value) / (largest or 1.0)
    many = len(found.s1) > 1500
    for look, keep in ((style.COMPRESSION, value < 0), (style.TENSION, value > 0)):
        keep &= size > 0.01
        width = (0.5 + 1.1 * size[keep]) if many else (0.9 + 2.2 * size[keep])
        style.draw_lines(ax, lines[keep], look, width=width, zorder=3, capstyle="butt")
    units = result.model.report
    strongest = units.text("stress", float(np.min(found.s2, initial=0.0)), size=largest)
    weakest = units.text("stress", float(np.max(found.s1, initial=0.0)), size=largest)
    what = "block" if of == "bodies" else "element"
    style.dress(
        ax, box, f"Mean principal stresses of each {what}",
        f"from {strongest} (compression) to {weakest}" + (" (tension)" if np.max(found.s1, initial=0.0) > 0 else ""),
        units=units,
    )  # fmt: skip
    bar = style.round_value(0.16 * float((box[1] - box[0])[0]) / scale) if largest > 0 else 0.0
    if bar:
        style.scale_bar(ax, box, bar * scale, units.text("stress", bar, size=largest), style.COMPRESSION)
    handles: list[Any] = [style.handle(style.COMPRESSION), style.handle(style.TENSION)]
    if shade:
        handles.append(style.patch(_blend(1.0), f"body in compression of {strongest.lstrip('-')}"))
    style.legend(ax, handles)
    return ax


def _shades(result: Result) -> list[Any]:
    s2 = np.nan_to_num(result.stress.principal[1])
    strength = np.maximum(-s2, 0.0)
    share = strength / (strength.max(initial=0.0) or 1.0)
    return [_blend(v) for v in share]


def _blend(share: float) -> Any:
    """Return a colour from the fill of a block to a light compression blue."""
    low, high = np.array([0xF7, 0xF4, 0xEE]) / 255, np.array([0x8F, 0xBF, 0xE0]) / 255
    return tuple(low + float(share) * (high - low))
