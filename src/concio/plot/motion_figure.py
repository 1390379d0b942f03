"""Figures of structures that move: capacity curves, histories, single frames, and films of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.motion.dynamics_result import DynamicsResult
from concio.analysis.motion.energy import NAMES
from concio.analysis.motion.push_result import PushResult
from concio.arguments import strict
from concio.display import number
from concio.errors import InputError
from concio.plot import style
from concio.plot.diagram import diagram_axes, dress_diagram, figure_of
from concio.plot.motion_in_space import painter
from concio.post.motion_frames import Frame, box_of, frames, positions

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

FILMS = (".gif", ".mp4")
"""Films that can be written."""

WIDE = (7.6, 4.4)
"""Width and height of a diagram [in]."""

BLOCKS = 4
"""Blocks whose rotations are drawn: those that turn most."""


@strict
def plot_capacity(result: PushResult, ax: Axes | None = None, *, title: str = "Capacity curve") -> Axes:
    """Draw the multiplier over the controlled displacement, with its peak and its end.

    Parameters
    ----------
    result : PushResult
    ax : Axes, optional
        Where to draw; default a new figure.
    title : str
    """
    ax = diagram_axes(ax, WIDE)
    d, load = result.displacement, result.multiplier
    ax.plot(d, load, color=style.INK, lw=1.5)
    top = result.peak_step
    ax.plot([d[top]], [load[top]], ls="none", marker="o", ms=5, color=style.TENSION.colour)
    peak = f"peak {number(result.peak, 4)}"
    ax.annotate(peak, (d[top], load[top]), (8, -2), textcoords="offset points", fontsize=8.5)
    if np.isfinite(result.capacity):
        ax.plot([d[-1]], [load[-1]], ls="none", marker="s", ms=5, color=style.TENSION.colour)
        ax.annotate(f"{number(1e3 * result.capacity, 4)} mm", (d[-1], load[-1]), (0, 8), textcoords="offset points",
                    fontsize=8.5, ha="right")  # fmt: skip
    ax.set_ylim(bottom=min(0.0, float(load.min())))
    ax.set_xlim(left=0.0)
    where = "mean displacement of the load" if result.control is None else f"displacement of '{result.control.body}'"
    return dress_diagram(ax, title, f"{where} [m]", "multiplier [-]")


@strict
def plot_history(result: DynamicsResult, ax: Axes | None = None, *, title: str = "Rotations") -> Axes:
    """Draw the rotations of the blocks that turn most over time.

    Parameters
    ----------
    result : DynamicsResult
    ax : Axes, optional
        Where to draw; default a new figure.
    title : str
    """
    ax = diagram_axes(ax, WIDE)
    plane = result.model.dim == 2
    turned = np.rad2deg(result.shots.rotation - result.shots.rotation[0] if plane else result.turned)
    most = np.argsort(-np.abs(turned).max(axis=0), kind="stable")[:BLOCKS]
    for b in most.tolist():
        if np.abs(turned[:, b]).max() > 0:
            ax.plot(result.shots.time, turned[:, b], lw=1.2, label=result.model.bodies[b].name)
    if ax.lines:
        ax.legend(frameon=False, fontsize=8.5)
    return dress_diagram(ax, title, "time [s]", f"rotation{', anticlockwise' if plane else ''} [degrees]")


@strict
def plot_ground(result: DynamicsResult, ax: Axes | None = None, *, title: str = "Motion of the ground") -> Axes:
    """Draw the acceleration of the ground over time, in shares of gravity.

    Parameters
    ----------
    result : DynamicsResult
    ax : Axes, optional
        Where to draw; default a new figure.
    title : str
    """
    ax = diagram_axes(ax, (7.6, 2.6))
    words = ("horizontal", "vertical") if result.model.dim == 2 else ("along x", "along y", "vertical")
    for k, word in enumerate(words):
        if result.ground[:, k].any():
            ax.plot(result.ground_time, result.ground[:, k] / result.gravity, lw=0.9, label=word)
    if ax.lines:
        ax.legend(frameon=False, fontsize=8.5)
    return dress_diagram(ax, title, "time [s]", "acceleration [g]")


@strict
def plot_energy(result: DynamicsResult, ax: Axes | None = None, *, title: str = "Energy") -> Axes:
    """Draw where the energy is and where it went.

    Parameters
    ----------
    result : DynamicsResult
    ax : Axes, optional
        Where to draw; default a new figure.
    title : str
    """
    ax = diagram_axes(ax, WIDE)
    energy, time = result.energy, result.shots.time
    for name in NAMES:
        values = energy[name] - (energy[name][0] if name == "potential" else 0.0)
        if np.abs(values).max(initial=0.0) > 1e-3 * energy.turned_over:
            ax.plot(time, values, lw=1.2, ls="--" if name == "input" else "-", label=name)
    if ax.lines:
        ax.legend(frameon=False, fontsize=8.5)
    return dress_diagram(ax, title, "time [s]", "energy [kN m]")


@strict
def plot_frame(result: PushResult | DynamicsResult, number: int = -1, ax: Axes | None = None) -> Axes:
    """Draw the structure where it stands, true to scale.

    Parameters
    ----------
    result : PushResult or DynamicsResult
    number : int
        Point of the curve, or shot.
    ax : Axes, optional
        Where to draw; default a new figure.
    """
    ax = diagram_axes(ax, (6.4, 5.2))
    if result.model.dim == 3:
        count, _, draw_one = painter(result, len(positions(result)[0]))
        return draw_one(ax, range(count)[number])
    at, words = positions(result)
    k = range(len(at))[number]
    standing = result.configuration(k)
    rings = tuple(standing.rings(b) for b in range(len(result.model.bodies)))
    picture = Frame(k, float(at[k]), words[k], rings)
    _draw(ax, result, picture, box_of([picture], result.model))
    return ax


def _draw(ax: Axes, result: PushResult | DynamicsResult, picture: Frame, box: Array) -> None:
    model = result.model
    for kind, options in (
        ("fixed", {"facecolors": style.OBSTACLE, "edgecolors": style.HATCH, "hatch": "/////", "linewidths": 0.8}),
        ("free", {"edgecolors": style.EDGE, "linewidths": 0.6}),
    ):
        own = [b for b, body in enumerate(model.bodies) if (body.kind == "fixed") == (kind == "fixed")]
        if kind == "free":
            options = {**options, "facecolors": [style.body_colour(model.bodies[b]) for b in own]}
        if own:
            ax.add_collection(style.polygons_of([picture.rings[b] for b in own], **options))
    style.dress(ax, box, model.title or "Motion", picture.word, units=model.report)


def _painter(result: PushResult | DynamicsResult, most: int) -> tuple[int, Array, Callable[[Axes, int], Axes]]:
    """Return how many frames a plane motion has, the box of its pictures (2, 2), and what draws one into axes."""
    pictures = frames(result, most)
    box = box_of(pictures, result.model)

    def draw_one(ax: Axes, k: int) -> Axes:
        _draw(ax, result, pictures[k], box)
        return ax

    return len(pictures), box, draw_one


@strict
def write_film(result: PushResult | DynamicsResult, path: Path | str, *, fps: int = 25, most: int = 250) -> Path:
    """Write a film of a motion.

    Parameters
    ----------
    result : PushResult or DynamicsResult
    path : Path or str
        Ends in ``.gif``, or in ``.mp4`` where FFmpeg is installed.
    fps : int
        Frames a second; a motion is shown at its own speed as far as the number of frames allows.
    most : int
        Frames at most.

    Raises
    ------
    InputError
        The name has another end, or FFmpeg is not there.
    """
    path = Path(path)
    if path.suffix.lower() not in FILMS:
        msg = f"a film ends in .gif or .mp4, not in '{path.suffix}'"
        raise InputError(msg, where=str(path), hint="for example rocking.gif")
    from matplotlib.animation import FuncAnimation, writers

    name = "pillow" if path.suffix.lower() == ".gif" else "ffmpeg"
    if not writers.is_available(name):
        need = "Pillow" if name == "pillow" else "FFmpeg"
        msg = f"{need} is not installed, which writes films of this kind"
        raise InputError(msg, where=str(path), hint="write a .gif" if name == "ffmpeg" else "pip install pillow")
    if not 1 <= fps <= 100 or most < 2:
        msg = f"fps = {fps} and most = {most} do not make a film"
        raise InputError(msg, where=str(path), hint="1 to 100 frames a second, at least two frames")
    if isinstance(result, DynamicsResult):
        span = float(result.shots.time[-1] - result.shots.time[0])
        most = max(2, min(most, round(span * fps) + 1))
    count, box, draw_one = painter(result, most) if result.model.dim == 3 else _painter(result, most)
    wide, high = box[1] - box[0]
    figure = figure_of((6.4, float(np.clip(6.4 * high / wide + 0.8, 2.4, 8.0))))
    figure.set_layout_engine("none")
    ax = figure.add_axes((0.09, 0.09, 0.88, 0.8))

    def draw(k: int) -> list[Any]:
        ax.clear()
        draw_one(ax, k)
        return []

    film = FuncAnimation(figure, draw, frames=count, interval=1000 / fps, init_func=lambda: [])
    film.save(str(path), writer=writers[name](fps=fps), dpi=90)
    return path
