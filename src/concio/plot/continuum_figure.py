"""Figures of a wall side by side: its blocks, its blocks bonded, and its homogenised continuum."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from concio.analysis.cells import periodic_cell
from concio.analysis.result import Result
from concio.analysis.stress import Stress
from concio.arguments import strict
from concio.errors import InputError
from concio.plot import style
from concio.plot.deformed import plot_deformed, plot_mechanism
from concio.post.outlines import display_scale, outlines
from concio.problem.solution import Mechanism, Status, failed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.continuum.answers import ElasticComparison, StrengthComparison
    from concio.analysis.continuum.comparison import ContinuumComparison
    from concio.analysis.continuum.continuum import Continuum

Array = np.ndarray

GAP, TOP, BELOW = 0.55, 0.7, 0.95
"""Room between drawings, above and below them [inch]."""


@strict
def plot_displacements(
    comparison: ContinuumComparison, axes: Sequence[Axes] | None = None, *, scale: float | None = None
) -> list[Axes]:
    """Draw deformed shapes: blocks with their joints, blocks with all joints closed and stuck, the continuum.

    Parameters
    ----------
    comparison : ContinuumComparison
        With elastic answers.
    axes : sequence of three Axes, optional
        Where to draw; default a new figure.
    scale : float, optional
        Factor of all displacements; default a round one.

    Raises
    ------
    InputError
        There are no elastic answers.
    """
    found = elastic_of(comparison)
    model, at_rest = found.blocks.model, np.zeros(found.blocks.assembly.disc.unknowns)
    bonded = outlines(found.blocks, at_rest if found.bonded is None else found.bonded)
    moves = [np.abs(bonded.displacement).max(), np.abs(found.continuum.motion).max()]
    own = outlines(found.blocks).displacement if found.blocks.solved else bonded.displacement
    moves.append(np.abs(own).max())
    scale = display_scale(float(max(moves)), bonded.size) if scale is None else scale
    box = style.box_of(bonded.points, bonded.points + scale * bonded.displacement, bonded.points + scale * own)
    left, middle, right = _panels(box, 3, axes)
    blocks, tied, smooth = (f"{1e3 * v:.4g} mm" for v in found.settlements)
    if found.blocks.solved:
        plot_deformed(found.blocks, left, scale=scale)
        _untitled(left)
        style.dress(left, box, "Blocks: joints open and slip", f"displacements x {scale:g}; settle by {blocks}")
    else:
        style.dress(left, box, "Blocks: joints open and slip", f"no answer: {found.blocks.status.name.lower()}")
    style.ghost(middle, bonded)
    style.draw_bodies(middle, model, bonded, scale)
    note = f"settle by {tied}" if found.bonded is not None else "no answer: the supports tear blocks apart"
    style.dress(middle, box, "Blocks bonded: no joint opens or slips", note)
    _obstacles(right, comparison, scale)
    _filled(right, comparison.wall, scale * found.continuum.displacement)
    style.dress(right, box, "Homogenised continuum", f"moduli of the cell; settles by {smooth}")
    handles: list[Any] = [style.handle(style.STICK), style.handle(style.SLIP)]
    style.legend(left, [*handles, style.patch(style.FILL_OPEN, "open", style.OPEN.colour)])
    return [left, middle, right]


@strict
def plot_stresses(
    comparison: ContinuumComparison,
    axes: Sequence[Axes] | None = None,
    *,
    component: Literal["xx", "yy", "xy"] = "yy",
) -> list[Axes]:
    """Draw one component of stress: means of the blocks, of the bonded blocks, of the triangles of the continuum.

    Parameters
    ----------
    comparison : ContinuumComparison
        With elastic answers, of elastic blocks.
    axes : sequence of three Axes, optional
        Where to draw; default a new figure with a colour bar.
    component : {"xx", "yy", "xy"}

    Raises
    ------
    InputError
        There are no elastic answers, or the blocks are rigid.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    found = elastic_of(comparison)
    part = periodic_cell.component(component)
    if not found.blocks.solved:
        msg = f"the blocks have no answer: {found.blocks.status.name.lower()}"
        raise InputError(msg, hint="draw displacement() or mechanism()")
    disc = found.blocks.assembly.disc
    tied = np.zeros(disc.unknowns) if found.bonded is None else found.bonded
    values = [found.blocks.stress.mean[:, part], Stress(disc, tied).mean[:, part], found.continuum.stress[:, part]]
    if np.isnan(values[0][found.free]).any():
        msg = "rigid blocks have no stresses"
        raise InputError(msg, hint="make the blocks elastic")
    everything = np.abs(np.concatenate([values[0][found.free], values[1][found.free], values[2]]))
    most = float(np.percentile(everything, 99)) or 1.0
    shade = ScalarMappable(Normalize(-most, most), _signed())
    shown = outlines(found.blocks, np.zeros(disc.unknowns))
    box = style.box_of(shown.points)
    own = axes is None
    panels = _panels(box, 3, axes)
    words = ("Blocks: joints open and slip", "Blocks bonded", "Homogenised continuum")
    for ax, value, word in zip(panels[:2], values[:2], words[:2], strict=True):
        face = [shade.to_rgba(v) if np.isfinite(v) else style.OBSTACLE for v in value]
        style.draw_bodies(ax, found.blocks.model, shown, face=face)
        note = f"mean of each block, from {value[found.free].min():.4g} to {value[found.free].max():.4g} kN/m2"
        if found.bonded is None and ax is panels[1]:
            note = "no answer: the supports tear blocks apart"
        style.dress(ax, box, f"{word}: stress {component}", note)
    _obstacles(panels[2], comparison, 0.0)
    _filled(panels[2], comparison.wall, 0.0 * found.continuum.displacement, shade.to_rgba(values[2]))
    note = f"from {values[2].min():.4g} to {values[2].max():.4g} kN/m2"
    style.dress(panels[2], box, f"{words[2]}: stress {component}", note)
    if own:
        figure = panels[0].figure
        assert isinstance(figure, Figure)
        bar = figure.add_axes((0.36, 0.24 / figure.get_figheight(), 0.28, 0.1 / figure.get_figheight()))
        figure.colorbar(shade, cax=bar, orientation="horizontal", extend="both")
        bar.set_title(f"stress {component} [kN/m2]; tension is positive", fontsize=8.5, color=style.INK)
        bar.tick_params(labelsize=7.5)
    return panels


@strict
def plot_mechanisms(comparison: ContinuumComparison, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Draw the associated mechanism of the blocks and that of the continuum, shaded where it strains.

    Parameters
    ----------
    comparison : ContinuumComparison
        With limit loads.
    axes : sequence of two Axes, optional
        Where to draw; default a new figure.

    Raises
    ------
    InputError
        There are no limit loads, or no mechanism bounds them.
    """
    from matplotlib.colors import to_rgb

    found = strength_of(comparison)
    bound = found.blocks.associated
    if bound.mechanism is None or found.kinematic.multiplier == np.inf:
        msg = "no mechanism bounds the load, so that there is none to draw"
        raise InputError(msg, hint="let another load group grow")
    assembly = found.blocks.assembly
    velocity = bound.mechanism.velocity
    motion = Mechanism(velocity / float(np.abs(velocity).max()), 0.0, 0.0)
    solution = failed(assembly.problem(), Status.NO_EQUILIBRIUM, method="limit", mechanism=motion)
    result = Result(assembly, {}, solution, {})
    shown = outlines(result, result.mechanism_velocity)
    share = 0.08
    speed = np.hypot(*shown.displacement.T)
    moved = share * shown.size / float(speed.max()) * shown.displacement
    smooth = found.kinematic.velocity * share * shown.size / float(np.hypot(*found.kinematic.velocity.T).max())
    box = style.box_of(shown.points, shown.points + moved, found.kinematic.wall.points + smooth)
    left, right = _panels(box, 2, axes)
    plot_mechanism(result, left, share=share, title="Blocks", note="")
    _untitled(left)
    style.dress(left, box, "Blocks", f"no equilibrium beyond {bound.multiplier:.5g} times the load (associated)")
    _obstacles(right, comparison, 0.0)
    rate = np.linalg.norm(found.kinematic.strain_rate, axis=1)
    depth = np.clip(rate / (float(np.percentile(rate, 97)) or 1.0), 0.0, 1.0)[:, None]
    low, high = (np.array(to_rgb(c)) for c in (style.BLOCK, style.TENSION.colour))
    _filled(right, found.kinematic.wall, smooth, (1 - depth) * low + depth * high)
    low_word = f"{found.static.multiplier:.5g}" if np.isfinite(found.static.multiplier) else "nothing known"
    note = f"carries {low_word}, no equilibrium beyond {found.kinematic.multiplier:.5g}; dark: where it strains"
    if found.kinematic.multiplier == -np.inf:
        note = "does not even carry the constant loads; dark: where it strains"
    style.dress(right, box, "Homogenised continuum", note)
    return [left, right]


def _untitled(ax: Axes) -> None:
    """Take away what a figure of its own has written over the drawing."""
    for text in list(ax.texts):
        text.remove()


def elastic_of(comparison: ContinuumComparison) -> ElasticComparison:
    """Return the elastic answers; raises InputError where there are none."""
    if comparison.elastic is None:
        msg = f"there are no elastic answers: {comparison.elastic_note}"
        raise InputError(msg, hint="make the blocks elastic, or give joints a stiffness")
    return comparison.elastic


def strength_of(comparison: ContinuumComparison) -> StrengthComparison:
    """Return the limit loads; raises InputError where there are none."""
    if comparison.strength is None:
        msg = f"there are no limit loads: {comparison.strength_note}"
        raise InputError(msg, hint="name the load groups that grow: live=...")
    return comparison.strength


def _panels(box: Array, count: int, axes: Sequence[Axes] | None) -> list[Axes]:
    """Return ``axes``, or those of a new figure with drawings of equal shape side by side."""
    if axes is not None:
        found = list(axes)
        if len(found) != count:
            msg = f"axes are {len(found)}, not {count}"
            raise InputError(msg, hint="leave them out for a new figure")
        return found
    from concio.plot.shown import new_figure

    width, height = np.maximum(box[1] - box[0], 1e-9)
    wide = float(np.clip(5.2 * width / height, 3.6, 5.6 if count == 2 else 4.8))
    tall = float(np.clip(wide * height / width, 0.9, 6.5))
    size = (count * wide + (count + 1) * GAP, tall + TOP + BELOW)
    figure = new_figure(size)
    return [
        figure.add_axes(((GAP + k * (wide + GAP)) / size[0], BELOW / size[1], wide / size[0], tall / size[1]))
        for k in range(count)
    ]


def _filled(ax: Axes, wall: Continuum, moved: Array, colours: Any = style.BLOCK) -> None:
    """Draw the moved triangles and the outline."""
    from matplotlib.collections import LineCollection, PolyCollection

    points = wall.points + moved
    ax.add_collection(
        PolyCollection(list(points[wall.triangles]), facecolors=colours, edgecolors="face", linewidths=0.25, zorder=1)
    )
    ax.add_collection(LineCollection(list(points[wall.edges]), colors=style.EDGE, linewidths=1.0, zorder=2))


def _obstacles(ax: Axes, comparison: ContinuumComparison, scale: float) -> None:
    """Draw the fixed bodies, moved as in the elastic answers."""
    model = comparison.assembly.model
    found = [[b.outline, *b.holes] for b in model.outlines if b.kind == "fixed"]
    if scale and comparison.elastic is not None:
        shown = outlines(comparison.elastic.blocks).moved(scale)
        found = [rings for rings, b in zip(shown, model.bodies, strict=True) if b.kind == "fixed"]
    ax.add_collection(
        style.polygons_of(found, facecolors=style.OBSTACLE, edgecolors=style.HATCH, hatch="/////", linewidths=0.8,
                          zorder=0.9)
    )  # fmt: skip


def _signed() -> Any:
    """Return the colour map of stresses: compression blue, tension orange, nothing white."""
    from matplotlib.colors import LinearSegmentedColormap

    colours = ["#00375F", style.COMPRESSION.colour, "#FFFFFF", style.TENSION.colour, "#7A2F00"]
    return LinearSegmentedColormap.from_list("stress", colours)
