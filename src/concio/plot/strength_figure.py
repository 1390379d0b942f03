"""Figures of a strength domain: sections, strength by direction, the surface."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.analysis.cells.half_spaces import HalfSpaces
from concio.analysis.cells.periodic_cell import component
from concio.analysis.cells.tensors import stress_at
from concio.arguments import strict
from concio.contact.macroscopic_strain import COMPONENTS
from concio.plot import style
from concio.plot.diagram import diagram_axes, plain_frame
from concio.plot.moduli_figure import dress_polar, polar_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.cells.strength import StrengthDomain

Array = np.ndarray

SQUARE = (6.8, 6.2)
"""Width and height of a new figure [in]."""

DASHES = ("-", (0, (5, 2)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)), (0, (3, 1.2)))
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")


def typical(faces: HalfSpaces, base: Array) -> float:
    """Return a stress that is large for a domain, to draw as far as it [kN/m2]."""
    finite = np.abs(faces.offsets[np.abs(faces.offsets) > 1e-9 * faces.size])
    size = float(np.abs(base).max(initial=0.0))
    return max(4.0 * float(np.median(finite)) if finite.size else 0.0, 1.5 * size) or 1.0


@strict
def plot_sections(
    domain: StrengthDomain,
    ax: Axes | None = None,
    *,
    along: str = "yy",
    up: str = "xy",
    others: Sequence[float] = (0.0,),
    reach: float | None = None,
) -> Axes:
    """Draw sections of the strength domain in the plane of two components, at values of the third.

    Parameters
    ----------
    domain : StrengthDomain
        With half-spaces.
    ax : Axes, optional
        Where to draw; default a new figure.
    along, up : str
        Components on the axes: "xx", "yy", "xy".
    others : sequence of float
        Values of the third component [kN/m2].
    reach : float, optional
        What is unbounded is cut at this stress; default a few times the strength [kN/m2].

    Returns
    -------
    Axes
    """
    a, b = component(along), component(up)
    third = 3 - a - b
    faces = domain.faces
    reach = typical(faces, domain.base) if reach is None else reach
    ax = diagram_axes(ax, SQUARE)
    handles: list[Any] = []
    for k, value in enumerate(others):
        at = np.zeros(3)
        at[third] = value
        polygon = faces.section(np.eye(3)[a], np.eye(3)[b], at, reach)
        if not len(polygon):
            continue
        look = style.Line(COLOURS[k % 5], DASHES[k % 5], 1.6, f"stress {COMPONENTS[third]} = {value:g} kN/m2")
        ax.fill(*polygon.T, color=look.colour, alpha=0.06, lw=0)
        edge = np.abs(polygon).max(axis=1) >= reach * (1 - 1e-9)
        for p, q, cut in zip(polygon, np.roll(polygon, -1, 0), edge & np.roll(edge, -1), strict=True):
            same = cut and (np.isclose(p, q) & np.isclose(np.abs(p), reach)).any()
            if not same:
                ax.plot(*np.array([p, q]).T, color=look.colour, ls=look.dash, lw=look.width)
        handles.append(style.handle(look))
    for ray in domain.rays:
        point = ray.stress
        if np.isfinite(point).all() and any(abs(point[third] - v) <= 1e-9 * reach for v in others):
            ax.plot(point[a], point[b], "o", ms=4.5, mfc="white", mec=style.INK, zorder=4)
            if np.isfinite(ray.coulomb):
                low = ray.base + ray.coulomb * ray.direction
                ax.plot(low[a], low[b], "x", ms=5.5, color=style.TENSION.colour, zorder=4)
    _frame(ax, f"stress {along} [kN/m2]", f"stress {up} [kN/m2]")
    _title(ax, "Strength domain", _exact(domain))
    if handles:
        ax.legend(handles=handles, frameon=False, fontsize=8.5, loc="best")
    return ax


@strict
def plot_biaxial(
    domain: StrengthDomain,
    ax: Axes | None = None,
    *,
    angles: Sequence[float] = (0.0, 22.5, 45.0),
    reach: float | None = None,
) -> Axes:
    """Draw the strength under two principal stresses, for axes turned against the bed joints.

    Parameters
    ----------
    domain : StrengthDomain
        With half-spaces.
    ax : Axes, optional
        Where to draw; default a new figure.
    angles : sequence of float
        From x (the bed joints) to the first principal axis, anticlockwise [degrees].
    reach : float, optional
        What is unbounded is cut at this stress [kN/m2].

    Returns
    -------
    Axes
    """
    faces = domain.faces
    reach = typical(faces, domain.base) if reach is None else reach
    ax = diagram_axes(ax, SQUARE)
    handles = []
    for k, angle in enumerate(angles):
        first, second = stress_at(1.0, 0.0, np.deg2rad(angle)), stress_at(0.0, 1.0, np.deg2rad(angle))
        polygon = faces.section(first, second, np.zeros(3), reach)
        if not len(polygon):
            continue
        look = style.Line(COLOURS[k % 5], DASHES[k % 5], 1.6, f"{angle:g} degrees to the bed joints")
        closed = np.vstack([polygon, polygon[:1]])
        ax.plot(*closed.T, color=look.colour, ls=look.dash, lw=look.width)
        handles.append(style.handle(look))
    _frame(ax, "first principal stress [kN/m2]", "second principal stress [kN/m2]")
    _title(ax, "Strength under principal stresses", _exact(domain))
    ax.legend(handles=handles, frameon=False, fontsize=8.5, loc="best")
    return ax


@strict
def plot_uniaxial(domain: StrengthDomain, ax: Axes | None = None, *, pressure: float = 0.0) -> Axes:
    """Draw the strength under tension and compression alone over the angle of the stress to the bed joints.

    Parameters
    ----------
    domain : StrengthDomain
        With half-spaces.
    ax : Axes, optional
        Polar axes; default a new figure.
    pressure : float
        Vertical pressure that acts besides [kN/m2].

    Returns
    -------
    Axes
    """
    faces = domain.faces
    ax = polar_axes(ax)
    angle = np.linspace(0, 2 * np.pi, 721)
    base = np.array([0.0, -pressure, 0.0])
    handles: list[Any] = []
    most = 0.0
    for sign, look in ((1.0, style.TENSION), (-1.0, style.COMPRESSION)):
        values = np.array([faces.distance(stress_at(sign, 0.0, a), base) for a in angle])
        if np.isfinite(values).any():
            most = max(most, float(np.percentile(values[np.isfinite(values)], 80)))
        values = np.where(np.isfinite(values), values, np.nan)
        ax.plot(angle, values, color=look.colour, ls=look.dash, lw=look.width)
        handles.append(style.handle(look, f"strength in {look.word} [kN/m2]"))
    ax.set_ylim(0.0, 1.2 * most or 1.0)
    note = f"under a vertical pressure of {pressure:g} kN/m2; " if pressure else ""
    dress_polar(ax, "Strength by direction", f"{note}{_exact(domain)}", handles)
    return ax


@strict
def plot_surface(domain: StrengthDomain, ax: Any | None = None, *, reach: float | None = None) -> Any:
    """Draw the strength domain as a surface in the space of the three components.

    Parameters
    ----------
    domain : StrengthDomain
        With half-spaces.
    ax : Axes3D, optional
        Where to draw; default a new figure.
    reach : float, optional
        What is unbounded is cut at this stress [kN/m2].

    Returns
    -------
    Axes3D
    """
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    from concio.plot.shown import new_figure

    faces = domain.faces
    reach = typical(faces, domain.base) if reach is None else reach
    box = HalfSpaces.of(
        np.vstack([faces.normals, np.eye(3), -np.eye(3)]), np.concatenate([faces.offsets, np.full(6, reach)])
    )
    corners, _ = box.vertices
    polygons, cut = [], []
    for normal, offset in zip(box.normals, box.offsets, strict=True):
        on = corners[np.abs(corners @ normal - offset) <= 1e-6 * reach]
        if len(on) < 3:
            continue
        centre = on.mean(0)
        u = np.linalg.svd(on - centre)[2][:2]
        turn = np.arctan2((on - centre) @ u[1], (on - centre) @ u[0])
        polygons.append(on[np.argsort(turn)])
        cut.append(bool(np.isclose(offset, reach) and np.isclose(np.abs(normal).max(), 1.0)))
    if ax is None:
        figure = new_figure((7.0, 6.4))
        ax = figure.add_subplot(projection="3d")
    colours = ["#F4F4F4" if c else "#9CC3E0" for c in cut]
    alpha = [0.15 if c else 0.75 for c in cut]
    for polygon, colour, pale in zip(polygons, colours, alpha, strict=True):
        ax.add_collection3d(
            Poly3DCollection([polygon], facecolors=colour, edgecolors=style.EDGE, linewidths=0.6, alpha=pale)
        )
    low, high = corners.min(0), corners.max(0)
    for name, axis, a, b in zip(COMPONENTS, "xyz", low, high, strict=True):
        getattr(ax, f"set_{axis}lim")(a, b)
        getattr(ax, f"set_{axis}label")(f"stress {name} [kN/m2]", fontsize=8.5)
        ax.tick_params(labelsize=7)
    ax.set_title(f"Strength domain: {_exact(domain)}", loc="left", fontsize=10, color=style.INK)
    ax.view_init(elev=22, azim=-60)
    return ax


def _exact(domain: StrengthDomain) -> str:
    found = domain.domain
    if found is None:
        return ""
    if found.exact:
        return f"{len(found.faces)} half-spaces, exact (associated friction)"
    return (
        f"{len(found.faces)} half-spaces, from outside by at most {100 * found.shortfall:.2g} % (associated friction)"
    )


def _frame(ax: Axes, across: str, up: str) -> None:
    ax.axhline(0.0, color="#BBBBBB", lw=0.7, zorder=0.5)
    ax.axvline(0.0, color="#BBBBBB", lw=0.7, zorder=0.5)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel(across, fontsize=9)
    ax.set_ylabel(up, fontsize=9)
    plain_frame(ax)


def _title(ax: Axes, title: str, note: str) -> None:
    ax.set_title(title, loc="left", fontsize=11, fontweight="bold", color=style.INK, pad=20)
    ax.annotate(note, (0, 1), (0, 7), xycoords="axes fraction", textcoords="offset points", fontsize=8.5,
                color="#555555")  # fmt: skip
