"""Figures of a periodic cell that has moved: its state under a macroscopic strain, a mechanism, with its neighbours."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.result import Result
from concio.arguments import strict
from concio.display import number
from concio.errors import InputError
from concio.plot import style
from concio.post.joint_lines import joint_lines
from concio.post.outlines import display_scale, outlines
from concio.problem.solution import Status, failed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.cells.cell_path_result import CellPath
    from concio.analysis.cells.periodic_cell import PeriodicCell
    from concio.analysis.cells.strength import StrengthDomain, StrengthRay

Array = np.ndarray

AROUND = [(i, j) for j in (-1, 0, 1) for i in (-1, 0, 1)]
"""The cells that are drawn."""

MOVES_VISIBLY = 1e-6
"""Relative motions below this share of the largest are none."""


@strict
def plot_cell_state(path: CellPath, step: int = -1, ax: Axes | None = None, *, scale: float | None = None) -> Axes:
    """Draw the cell at a step of a path, with its neighbours, deformed; joints as open, sticking, slipping.

    Parameters
    ----------
    path : CellPath
    step : int
    ax : Axes, optional
        Where to draw; default a new figure.
    scale : float, optional
        Factor of the displacements; default a round one.

    Returns
    -------
    Axes
    """
    result, chosen = path.result(step), path.steps[step]
    pairs = chosen.state.states
    state = np.where(pairs.open, 0, np.where(pairs.slips, 2, 1))
    words = ", ".join(f"{v:+.3g}" for v in chosen.stress)
    title = f"{path.stages[chosen.stage].name}, at {chosen.parameter:.3g} of its stage"
    return _draw(
        result, result.displacement, chosen.strain, state, ax, scale, title, f"stress xx, yy, xy: {words} kN/m2"
    )


@strict
def plot_cell_mechanism(domain: StrengthDomain, ray: StrengthRay | int = 0, ax: Axes | None = None) -> Axes:
    """Draw the mechanism that bounds the strength of a cell in one direction, with its neighbours.

    Parameters
    ----------
    domain : StrengthDomain
    ray : StrengthRay or int
        The direction.
    ax : Axes, optional
        Where to draw; default a new figure.

    Raises
    ------
    InputError
        No mechanism bounds the direction.

    Returns
    -------
    Axes
    """
    chosen = domain.rays[ray] if isinstance(ray, int) else ray
    if chosen.associated.mechanism is None:
        msg = "no mechanism bounds the strength in this direction, so that there is none to draw"
        raise InputError(msg, hint="choose another direction")
    words = ", ".join(f"{v:g}" for v in chosen.direction)
    title = f"Mechanism under stress along ({words})"
    note = (
        f"bound {number(chosen.multiplier)}; joints that slide open by the friction coefficient times their slip"
    )
    return plot_motion(domain.cell, chosen.associated.mechanism.velocity, ax, title=title, note=note)


@strict
def plot_motion(
    cell: PeriodicCell, velocity: Array, ax: Axes | None = None, *, title: str = "Mechanism", note: str = ""
) -> Axes:
    """Draw a motion of the unknowns of :meth:`PeriodicCell.problem` with free strains.

    Parameters
    ----------
    cell : PeriodicCell
    velocity : (N + 3,) array
        Free unknowns of the bodies, then strain rates times the size of the cell.
    ax : Axes, optional
    title, note : str

    Returns
    -------
    Axes
    """
    assembly = cell.assembly
    problem = assembly.problem()
    result = Result(assembly, {}, failed(problem, Status.NO_EQUILIBRIUM, method="limit"), {})
    strain = velocity[-3:] / cell.size
    normal, tangential = cell.columns
    opening = problem.C_n @ velocity[:-3] + normal @ strain
    slip = problem.C_t @ velocity[:-3] + tangential @ strain
    little = MOVES_VISIBLY * float(np.abs(np.concatenate([opening, slip])).max())
    opens = opening > problem.laws.friction * np.abs(slip) + little
    state = np.where(opens, 0, np.where(np.abs(slip) > little, 2, 1))
    u = assembly.supported.T @ velocity[:-3]
    return _draw(result, u, strain, state, ax, None, title, note, share=0.12)


def _draw(
    result: Result,
    u: Array,
    strain: Array,
    state: Array,
    ax: Axes | None,
    scale: float | None,
    title: str,
    note: str,
    *,
    share: float = 0.06,
) -> Axes:
    """Draw bodies and joints of the cell and its neighbours, moved by u (N_all,) and the strain (3,)."""
    from matplotlib.collections import PolyCollection

    E = np.array([[strain[0], strain[2] / 2], [strain[2] / 2, strain[1]]])
    shown = replace(outlines(result, u), strain=E)
    pieces = joint_lines(result, shown)
    p = np.asarray(result.model.periods, dtype=float)
    centred = shown.displacement - shown.displacement.mean(0)
    motion = np.abs(centred).max() + np.abs(E @ p.T).max()
    scale = display_scale(float(motion), shown.size, share) if scale is None else scale
    shown = replace(shown, displacement=centred)
    pieces = joint_lines(result, shown)
    middle = shown.points.mean(0)
    box = style.box_of(
        shown.points, middle + 1.0 * p, middle - 1.0 * p, middle + 0.6 * p.sum(0), middle - 0.6 * p.sum(0)
    )
    ax = style.axes_for(box, ax)
    code = state[pieces.pair]
    bodies = result.model.bodies
    for i, j in AROUND:
        shift = np.array([i, j]) @ p
        away = shift + scale * (E @ shift)
        own = i == j == 0
        face = [style.body_colour(b) if own else style.NEIGHBOUR for b in bodies]
        moved = [[ring + away for ring in rings] for rings in shown.moved(scale)]
        edge, pale = (style.EDGE, 1.0) if own else (style.GHOST, 0.45)
        ax.add_collection(style.polygons_of(moved, facecolors=face, edgecolors=edge, linewidths=0.6, zorder=1 + own))
        opened = list(pieces.openings(scale)[code == 0] + away)
        ax.add_collection(PolyCollection(opened, facecolors=style.FILL_OPEN, edgecolors="none", alpha=pale, zorder=3))
        style.draw_lines(ax, pieces.side("middle", scale)[code == 1] + away, style.STICK, zorder=3.2, alpha=pale)
        style.draw_lines(ax, pieces.side("middle", scale)[code > 1] + away, style.SLIP, zorder=3.4, alpha=pale)
    rate = ", ".join(f"{v:+.3g}" for v in strain / (float(np.abs(strain).max()) or 1.0))
    style.dress(
        ax, box, title, f"strain xx, yy, xy in proportion {rate}; displacements x {scale:g}; {note}".rstrip("; ")
    )
    handles: list[Any] = [style.handle(style.STICK), style.handle(style.SLIP, "slides")]
    style.legend(
        ax, [*handles, style.patch(style.FILL_OPEN, "opens"), style.patch(style.NEIGHBOUR, "neighbouring cells")]
    )
    return ax
