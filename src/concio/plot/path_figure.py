"""Figure of a load path: load against the motion of a control point, with its events."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from concio.arguments import strict
from concio.display import number
from concio.plot import style
from concio.plot.diagram import diagram_axes, dress_diagram

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

SMALL = 0.1
"""Motions that all stay below this are reported in mm [m]."""


class PathEvent(Protocol):
    """An event on a curve: :class:`concio.solvers.path.record.Event` has it."""

    @property
    def parameter(self) -> float:
        """Load parameter, at the event or at each corner."""

    @property
    def control(self) -> float:
        """Motion of the control point, at the event or at each corner [m]."""

    @property
    def kind(self) -> str:
        """What happens: opens, closes, slips, sticks..."""


class PathCurve(Protocol):
    """A load path: load parameters and the motion of a control point at its corners, and its events."""

    @property
    def parameter(self) -> Sequence[float] | Array:
        """Load parameter, at the event or at each corner."""

    @property
    def control(self) -> Sequence[float] | Array:
        """Motion of the control point, at the event or at each corner [m]."""

    @property
    def events(self) -> Sequence[PathEvent]:
        """Events along the curve."""


MARKS: dict[str, tuple[str, str, str]] = {
    "opens": ("^", style.OPEN.colour, "opens"),
    "closes": ("v", style.OPEN.colour, "closes"),
    "slips": ("D", style.SLIP.colour, "slips"),
    "sticks": ("s", style.STICK.colour, "sticks"),
    "crushes": ("X", style.TENSION.colour, "crushes"),
    "breaks": ("*", style.TENSION.colour, "breaks"),
    "yields": ("X", style.TENSION.colour, "yields"),
    "slackens": ("^", style.OPEN.colour, "slackens"),
    "tightens": ("v", style.OPEN.colour, "tightens"),
    "unloads": ("P", style.COMPRESSION.colour, "unloads"),
    "recovers": ("P", style.COMPRESSION.colour, "recovers"),
    "jumps": (">", style.INK, "jumps"),
    "restarts": (".", style.INK, "restarts the path"),
}
"""Marker, colour and word of each kind of event."""

OF_TIES = ("yields", "slackens", "tightens", "unloads")
"""Events of ties alone."""


@strict
def plot_path(
    curve: PathCurve,
    ax: Axes | None = None,
    *,
    control_label: str = "displacement of the control point [m]",
    parameter_label: str = "load factor [-]",
    title: str = "Load path",
    bound: float | None = None,
    unit: str = "",
) -> Axes:
    """Draw a load path, its events and its peak.

    Parameters
    ----------
    curve : PathCurve
        Anything with ``parameter``, ``control`` (same length) and ``events``.
    ax : Axes, optional
        Where to draw; default a new figure.
    control_label, parameter_label, title : str
        Words of the axes, with units; an axis in [m] of which only the first 0.1 m are used is written in mm.
    bound : float, optional
        A bound on the load factor to draw beside it, such as the associated limit.
    unit : str
        Of the load, where it is not a factor.

    Returns
    -------
    Axes
    """
    ax = diagram_axes(ax, (7.6, 4.8))
    load, motion = np.asarray(curve.parameter, dtype=float), np.asarray(curve.control, dtype=float)
    ax.plot(motion, load, color=style.INK, lw=1.4, zorder=2)
    handles: list[Any] = []
    for kind in dict.fromkeys(event.kind for event in curve.events):
        marker, colour, word = MARKS.get(kind, ("o", style.INK, kind))
        places = np.array([(e.control, e.parameter) for e in curve.events if e.kind == kind])
        what = "a tie" if kind in OF_TIES else "a joint"
        size = 5.5 if len(curve.events) <= 60 else 3.0
        drawn = ax.plot(*places.T, ls="none", marker=marker, ms=size, mfc=colour, mec="white", mew=0.5, zorder=3,
                        label=f"{what} {word} ({len(places)})")  # fmt: skip
        handles += drawn
    if len(load):
        top = int(np.argmax(load))
        word = f"peak {number(float(load[top]))} {unit}".rstrip()
        ax.annotate(
            word, (motion[top], load[top]), (0, 7), textcoords="offset points", ha="center", fontsize=8.5,
            color=style.INK,
        )  # fmt: skip
    if bound is not None:
        line = ax.axhline(bound, color=style.COMPRESSION.colour, ls="--", lw=1.1, label=f"bound {number(bound)}")
        handles.append(line)
    ax.margins(0.05, 0.1)
    if control_label.endswith("[m]") and np.abs(motion).max(initial=0.0) < SMALL:
        control_label = control_label.removesuffix("[m]") + "[mm]"
        ax.xaxis.set_major_formatter(lambda value, _: f"{1e3 * value:g}")
    dress_diagram(ax, title, control_label, parameter_label)
    if handles:
        ax.legend(handles=handles, frameon=False, fontsize=8.5, loc="lower right")
    return ax
