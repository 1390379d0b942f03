"""Figure of homogenised moduli: how stiff a cell is in each direction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from concio.arguments import strict
from concio.plot import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.cells.moduli import Moduli

Array = np.ndarray


@strict
def plot_moduli(moduli: Moduli, ax: Axes | None = None) -> Axes:
    """Draw Young's modulus and shear modulus over the angle of the axis to the bed joints.

    Parameters
    ----------
    moduli : Moduli
    ax : Axes, optional
        Polar axes; default a new figure.

    Returns
    -------
    Axes
    """
    ax = polar_axes(ax)
    angle = np.linspace(0, 2 * np.pi, 181)
    young = np.array([moduli.uniaxial(0, a)[0] for a in angle])
    shear = np.array([moduli.uniaxial(2, a)[0] for a in angle])
    looks = ((young, style.COMPRESSION, "Young's modulus"), (shear, style.TENSION, "shear modulus"))
    unit, word = (1e-6, "GPa") if young.max() >= 1e6 else (1e-3, "MPa") if young.max() >= 1e3 else (1.0, "kN/m2")
    handles: list[Any] = []
    for values, look, name in looks:
        ax.plot(angle, unit * values, color=look.colour, ls=look.dash, lw=look.width)
        handles.append(style.handle(look, f"{name} [{word}]"))
    note = f"E_x {moduli.E_x:.4g}, E_y {moduli.E_y:.4g}, G_xy {moduli.G_xy:.4g} kN/m2, nu_xy {moduli.nu_xy:.3g}"
    dress_polar(ax, "Moduli by direction", f"{note}; {moduli.states}", handles)
    return ax


def polar_axes(ax: Axes | None) -> Axes:
    """Return ``ax``, or polar axes of a new figure."""
    if ax is not None:
        return ax
    from concio.plot.shown import new_figure

    figure = new_figure((6.4, 6.6))
    axes: Axes = figure.add_axes((0.1, 0.1, 0.8, 0.76), projection="polar")
    return axes


def dress_polar(ax: Axes, title: str, note: str, handles: list[Any]) -> None:
    """Set ticks, title, note and legend of polar axes."""
    ax.tick_params(labelsize=8, colors="#555555")
    ax.grid(color="#E0DCD4", lw=0.6)
    ax.set_ylim(bottom=0.0)
    figure = ax.figure
    ax.annotate(title, (0, 1), (-30, 46), xycoords="axes fraction", textcoords="offset points", fontsize=11,
                fontweight="bold", color=style.INK)  # fmt: skip
    ax.annotate(note, (0, 1), (-30, 32), xycoords="axes fraction", textcoords="offset points", fontsize=8.5,
                color="#555555")  # fmt: skip
    ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.06), ncols=2, frameon=False, fontsize=8.5)
    figure.canvas.draw_idle()
