"""Figures of a vehicle on a bridge: load factor over position, and how the bridge begins to move at one of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.result import Result
from concio.display import number
from concio.plot import style
from concio.plot.road_figure import draw_fill, draw_vehicle, road_box
from concio.post.joint_lines import joint_lines
from concio.post.mechanism_states import mechanism_states
from concio.post.outlines import outlines
from concio.post.thrust_line import thrust_lines
from concio.problem.pair_state import PairState
from concio.problem.solution import Mechanism, Status, failed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.bridges.bridge_result import BridgeResult
    from concio.analysis.bridges.sweep import Standing
    from concio.analysis.bridges.variants import Change
    from concio.model.model import Model

Array = np.ndarray

ENGLISH = {
    "position": "x of the reference point [m]", "factor": "load factor", "bound": "bound, no equilibrium beyond",
    "coulomb": "Coulomb load steps", "required": "asked for", "no_soil": "without soil pressure, at its worst",
    "to_right": "to the right", "to_left": "to the left", "curve": "Load factor over position",
    "mechanism": "Mechanism at {factor} times the vehicle, x = {x} m", "thrust": "line of thrust",
    "crossing": "resultant of a joint", "opens": "opens", "slides": "slides",
    "moved": "velocities to scale, forces at the bound", "bars": "Load factor when one datum changes",
    "parts": "Contributions to the bound", "same": "no change", "decimal": ".",
}  # fmt: skip
"""Words of the figures; another language gives others."""
SHARE = 0.06
"""Size of the largest velocity as a share of the bridge."""
SAME = 1e-6
"""Changes below this share of the load factor are reported as none."""
LARGEST_SHOWN = 4.0
"""Load factors above this many times the least are cut off in the curve."""


def plot_curve(found: BridgeResult, ax: Axes | None = None, *, words: Mapping[str, str] = ENGLISH) -> Axes:
    """Draw the load factor over the position of the vehicle, with the Coulomb values of the worst positions."""
    ax = _plain(ax)
    least = found.worst.multiplier
    for way, dash in (("right", "-"), ("left", "--")):
        own = [s for s in found.standings if s.direction == way and np.isfinite(s.multiplier)]
        if own:
            both = len({s.direction for s in found.standings}) > 1
            word = f"{words['bound']}, {words['to_' + way]}" if both else words["bound"]
            ax.plot([s.position for s in own], [s.multiplier for s in own], dash, color=style.INK, lw=1.4, label=word)
    known = [b for b in found.brackets if np.isfinite(b.limit.design)]
    ax.plot([b.standing.position for b in known], [b.limit.design for b in known], "v", color=style.SLIP.colour, ms=6,
            label=words["coulomb"])  # fmt: skip
    if found.without_soil is not None and any(t.kind == "soil" for t in found.model.ties):
        ax.plot(found.without_soil.position, found.without_soil.multiplier, "s", color=style.OPEN.colour, ms=5,
                label=words["no_soil"])  # fmt: skip
    ax.axhline(found.required, color=style.TENSION.colour, lw=1.0, ls=":", label=words["required"])
    ax.set_ylim(0.0, LARGEST_SHOWN * max(least, 1e-9))
    ax.set_xlabel(words["position"], fontsize=9)
    ax.set_ylabel(words["factor"], fontsize=9)
    ax.set_title(words["curve"], loc="left", fontsize=11, fontweight="bold")
    ax.legend(fontsize=8, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2)
    return ax


def plot_standing(
    found: BridgeResult, standing: Standing | None = None, ax: Axes | None = None, *,
    words: Mapping[str, str] = ENGLISH, title: bool = True,
) -> Axes:  # fmt: skip
    """Draw the mechanism of one position, with the vehicle, the fill at rest and the resultants of the joints."""
    from matplotlib.collections import PolyCollection

    one = found.worst if standing is None else standing
    result = state_of(found, one)
    velocity = result.mechanism_velocity
    shown = outlines(result, velocity)
    speed = np.hypot(*shown.displacement.T)
    scale = SHARE * shown.size / max(float(speed.max()), 1e-300)
    road = road_box(found.model)
    box = style.box_of(shown.points, shown.points + scale * shown.displacement, road)
    box[1, 1] += 0.1 * float(np.ptp(road[:, 0]))
    ax = style.axes_for(box, ax)
    draw_fill(ax, found.model)
    style.ghost(ax, shown)
    style.draw_bodies(ax, found.model, shown, scale)
    pieces = joint_lines(result, shown)
    state = mechanism_states(result, pieces)
    opened = list(pieces.openings(scale)[state == PairState.OPEN])
    look: dict[str, Any] = {"facecolors": style.FILL_OPEN, "edgecolors": style.OPEN.colour, "linewidths": 0.6}
    ax.add_collection(PolyCollection(opened, zorder=3, **look))
    style.draw_lines(ax, pieces.side("middle", scale)[state == PairState.SLIP], style.SLIP, zorder=3.5)
    handles = [style.patch(style.FILL_OPEN, words["opens"]), style.handle(style.SLIP, words["slides"])]
    handles.append(_thrust(ax, result, words))
    draw_vehicle(ax, under(found, one), one.position, one.direction)
    text = words["mechanism"].format(factor=_n(one.multiplier, words), x=_n(one.position, words)) if title else ""
    style.dress(ax, box, text, words["moved"] if title else "", units=found.model.report)
    if title:
        style.legend(ax, handles)
    return ax


def plot_changes(found: BridgeResult, ax: Axes | None = None, *, words: Mapping[str, str] = ENGLISH) -> Axes:
    """Draw the load factor at the worst position as one datum after the other changes."""
    ax = _plain(ax)
    shown = [c for c in found.changes if np.isfinite(c.swing)][:10]
    base = found.worst.multiplier
    for k, c in enumerate(reversed(shown)):
        ax.barh(k, c.at_high - base, left=base, color=style.STICK.colour, height=0.55)
        ax.barh(k, c.at_low - base, left=base, color=style.OPEN.colour, height=0.55)
        if c.swing < SAME * base:
            ax.annotate(words["same"], (base, k), (3, 0), textcoords="offset points", va="center", fontsize=7)
            continue
        for value, at in ((c.low, c.at_low), (c.high, c.at_high)):
            side = "left" if at > base else "right"
            ax.annotate(_n(value, words, 3), (at, k), (3 if side == "left" else -3, 0), textcoords="offset points",
                        ha=side, va="center", fontsize=7)  # fmt: skip
    ax.set_yticks(range(len(shown)), [change_name(c, words) for c in reversed(shown)], fontsize=8)
    ax.axvline(base, color=style.INK, lw=0.8)
    ax.margins(x=0.15)
    ax.set_xlabel(words["factor"], fontsize=9)
    ax.set_title(words["bars"], loc="left", fontsize=11, fontweight="bold")
    return ax


def change_name(change: Change, words: Mapping[str, str] = ENGLISH) -> str:
    """Return the name of a datum that was changed, with its unit."""
    base, mark, rest = change.name.partition(" '")
    named = words.get("datum_" + base.replace(" ", "_"), base)
    return named + mark + rest + ("" if change.unit == "-" else f" [{change.unit}]")


def _n(value: float, words: Mapping[str, str], digits: int = 4) -> str:
    """Return a number with the decimal sign of the language."""
    return number(value, digits).replace(",", "\u2009").replace(".", words.get("decimal", "."))


def under(found: BridgeResult, standing: Standing) -> Model:
    """Return the model with uniform load where it stands at a position."""
    return replace(found.model, vehicle=replace(found.vehicle, loaded=standing.loaded))


def state_of(found: BridgeResult, standing: Standing) -> Result:
    """Return forces and mechanism of the bound at a position as a result that figures can draw."""
    assembly, limit = found.assembly, standing.limit
    motion = limit.mechanism
    if motion is not None:
        motion = Mechanism(motion.velocity / max(float(np.abs(motion.velocity).max()), 1e-300), 0.0, 0.0)
    solution = failed(assembly.problem(), Status.NO_EQUILIBRIUM, method="limit", mechanism=motion)
    forces = replace(solution, normal_force=limit.normal_force, friction_force=limit.friction_force)
    return Result(assembly, {}, forces, {})


def _thrust(ax: Axes, result: Result, words: Mapping[str, str]) -> Any:
    """Draw the line of thrust, of several rings the resultants of the joints across them; return its legend."""
    from matplotlib.lines import Line2D

    lines = thrust_lines(result)
    colour = style.TENSION.colour
    if 2 * sum(len(line.points) for line in lines) > len(result.model.free_bodies):
        for line in lines:
            ax.plot(*line.points.T, color=colour, lw=1.3, zorder=6)
        return Line2D([], [], color=colour, lw=1.3, label=words["thrust"])
    joints = result.joints
    strong = 0.02 * float(joints.N.max(initial=0.0)) < joints.N
    places = joints.middle + np.nan_to_num(joints.eccentricity)[:, None] * joints.tangent
    ax.plot(*places[strong].T, ".", color=colour, ms=3, zorder=6)
    return Line2D([], [], color=colour, marker=".", ls="none", label=words["crossing"])


def _plain(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    from concio.plot.shown import new_figure

    figure = new_figure((7.6, 3.6), layout="constrained")
    axes: Axes = figure.add_subplot()
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.tick_params(labelsize=8)
    return axes
