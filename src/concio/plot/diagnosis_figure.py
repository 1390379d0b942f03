"""Figures of a diagnosis: cracks measured beside predicted, on the drawing and one by one, and the causes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from concio.arguments import closest, strict
from concio.display import number
from concio.errors import InputError
from concio.plot import style
from concio.plot.diagram import diagram_axes, dress_diagram
from concio.plot.figure_language import in_language
from concio.post.outlines import display_scale, outlines

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.cracks.cause import Cause
    from concio.analysis.cracks.diagnosis import Diagnosis

Array = np.ndarray

WORDS = {
    "en": {
        "cracks": "Cracks, measured and predicted", "note": "displacements x {scale}; largest {largest}",
        "measured": "measured", "predicted": "predicted", "within": "measured | predicted, within 2 errors",
        "beyond": "beyond 2 errors", "out": "left out", "moves": "motion of a support",
        "readings": "Measurements and what each cause predicts", "cause": "cause", "causes": "Causes within the errors",
        "interval": "motions with intervals of {confidence} %", "none": "no cause",
    },
    "it": {
        "cracks": "Fessure, misurate e previste", "note": "spostamenti x {scale}; massimo {largest}",
        "measured": "misurato", "predicted": "previsto", "within": "misurato | previsto, entro 2 errori",
        "beyond": "oltre 2 errori", "out": "escluso", "moves": "movimento di un appoggio",
        "readings": "Misure e quanto prevede ciascuna causa", "cause": "causa", "causes": "Cause entro gli errori",
        "interval": "movimenti con intervalli del {confidence} %", "none": "nessuna causa",
    },
}  # fmt: skip
"""Words of the figures by language."""
FINE, FAR_OFF, MEASURED = style.COMPRESSION.colour, style.TENSION.colour, "#3A3A3A"
SIZE = (8.0, 4.2)
"""Width and height of diagrams [in]."""
NEAR = 2.0
"""Errors within which a prediction is drawn as one that agrees."""
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00")
MOST_CAUSES = len(COLOURS)
"""Causes drawn beside each other."""

Write = Callable[[float, int], str]


@strict
def plot_cracks(
    found: Diagnosis, ax: Axes | None = None, *, cause: int = 0, language: str = "en", write: Write = number
) -> Axes:
    """Draw the structure as a cause has moved it, with what was measured beside what is predicted at every place.

    Parameters
    ----------
    found : Diagnosis
        Of a plane model.
    ax : Axes, optional
        Where to draw; default a new figure.
    cause : int
        Number of the cause; where there is none within the errors, the nearest is drawn.
    language : {"en", "it"}
    write : callable, optional
        Writes a number with some digits.

    Raises
    ------
    InputError
        The model is in space, or nothing could be computed.

    Returns
    -------
    Axes
    """
    words, drawn = _words(language), _cause(found, cause)
    if found.model.dim != 2:
        msg = "cracks are drawn on plane models; the model is in space"
        raise InputError(msg, hint="found.plot.readings() draws them one by one")
    result, units = drawn.result, found.model.report
    shown = outlines(result)
    largest = float(np.hypot(*shown.displacement.T).max())
    scale = display_scale(largest, shown.size)
    box = style.box_of(shown.points, shown.points + scale * shown.displacement, margin=0.08)
    ax = style.axes_for(box, ax)
    style.ghost(ax, shown)
    style.draw_bodies(ax, result.model, shown, scale)
    _arrows(ax, found, drawn, scale)
    used = set()
    for i, (m, r) in enumerate(zip(found.measurements, found.readings, strict=True)):
        state = "out" if i in drawn.left_out else "within" if abs(drawn.residual[i]) <= NEAR else "beyond"
        used.add(state)
        factor, symbol = units.factor(m.quantity, max(abs(m.value), abs(float(drawn.predicted[i])), m.error))
        told = [write(factor * m.rounded(float(v)), 2) for v in (m.value, drawn.predicted[i])]
        text = f"{m.name}  {told[0]} | {told[1]} {symbol}"
        at = r.at + scale * _moved(drawn, r.bodies, r.at)
        ax.plot(*at, "o", ms=5, mfc="white", mec=_colour(state), mew=1.6, zorder=7)
        ax.annotate(
            text, (float(at[0]), float(at[1])), (6, 5), textcoords="offset points", fontsize=6.5, color=_colour(state),
            zorder=8, bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85},
        )  # fmt: skip
    note = words["note"].format(scale=f"{scale:g}", largest=units.text("motion", largest))
    style.dress(ax, box, words["cracks"], note, units=units)
    handles = [_dot(_colour(s), words[s]) for s in ("within", "beyond", "out") if s in used]
    style.legend(ax, [*handles, style.handle(style.LOAD, words["moves"])])
    return in_language(ax, language) if language != "en" else ax


@strict
def plot_readings(found: Diagnosis, ax: Axes | None = None, *, language: str = "en") -> Axes:
    """Draw every measurement with two errors to each side, and what each cause predicts, in errors from zero.

    Parameters
    ----------
    found : Diagnosis
    ax : Axes, optional
        Where to draw; default a new figure.
    language : {"en", "it"}

    Returns
    -------
    Axes
    """
    words = _words(language)
    shown = _causes(found)
    ax = diagram_axes(ax, SIZE)
    n = len(found.measurements)
    value, error = (np.array([getattr(m, key) for m in found.measurements]) for key in ("value", "error"))
    place = np.arange(n)
    units = found.model.report
    unit = np.array([units.factor(m.quantity, 1e-3)[0] for m in found.measurements])
    ax.errorbar(
        place, unit * value, yerr=NEAR * unit * error, fmt="o", color=MEASURED, ms=4, capsize=3, lw=1.0,
        label=f"{words['measured']}, ± {NEAR:g} s", zorder=3,
    )  # fmt: skip
    width = 0.5 / max(len(shown), 1)
    for k, cause in enumerate(shown):
        shift = 0.18 + width * k
        names = ", ".join(cause.names) or words["none"]
        ax.plot(place + shift, unit * cause.predicted, "_", ms=11, mew=2.4, color=COLOURS[k], label=names, zorder=2)
    ax.axhline(0.0, color="#BBBBBB", lw=0.7, zorder=1)
    ax.set_xticks(place, [m.name for m in found.measurements], rotation=45, ha="right", fontsize=7.5)
    symbols = dict.fromkeys(units.factor(m.quantity, 1e-3)[1] for m in found.measurements)
    dress_diagram(ax, words["readings"], "", f"[{', '.join(symbols)}]")
    ax.legend(fontsize=7.5, frameon=False)
    return in_language(ax, language) if language != "en" else ax


@strict
def plot_causes(found: Diagnosis, ax: Axes | None = None, *, language: str = "en") -> Axes:
    """Draw the motions of every cause with their intervals, over the size that was expected of each motion.

    Parameters
    ----------
    found : Diagnosis
    ax : Axes, optional
        Where to draw; default a new figure.
    language : {"en", "it"}

    Returns
    -------
    Axes
    """
    words = _words(language)
    shown = _causes(found)
    ax = diagram_axes(ax, SIZE)
    units = found.model.report
    names = [c.name for c in found.candidates]
    symbols: dict[str, None] = {}
    for k, cause in enumerate(shown):
        for c, s, a, b in zip(cause.chosen, cause.motion, cause.low, cause.high, strict=True):
            factor, symbol = units.factor(found.candidates[c].quantity, abs(s) or 1e-3)
            symbols |= {symbol: None} if symbol else {}
            y = c + 0.7 * ((k + 1) / (len(shown) + 1) - 0.5)
            ends = [v if np.isfinite(v) else s for v in (a, b)]
            ax.plot([factor * v for v in ends], [y, y], "-", color=COLOURS[k], lw=2.0)
            ax.plot(factor * s, y, "o", color=COLOURS[k], ms=5)
            ax.annotate(f" {number(factor * s, 3)} {symbol}", (factor * s, y), (3, 4), textcoords="offset points",
                        fontsize=7, color=COLOURS[k])  # fmt: skip
    ax.axvline(0.0, color="#BBBBBB", lw=0.7, zorder=1)
    ax.set_yticks(range(len(names)), names, fontsize=7.5)
    ax.set_ylim(len(names) - 0.5, -0.5)
    label = words["interval"].format(confidence=f"{100 * found.confidence:g}")
    dress_diagram(ax, words["causes"], f"{label} [{', '.join(symbols)}]" if symbols else label, "")
    return in_language(ax, language) if language != "en" else ax


def _words(language: str) -> dict[str, str]:
    if language not in WORDS:
        msg = f"there are no figures in the language '{language}'"
        raise InputError(msg, hint=closest(language, WORDS))
    return WORDS[language]


def _causes(found: Diagnosis) -> list[Cause]:
    """Return the causes that are drawn beside each other, those in doubt and what is less simple after the others."""
    return list(found.shown[:MOST_CAUSES]) or [_cause(found, 0)]


def _cause(found: Diagnosis, number: int) -> Cause:
    shown = found.shown
    if not 0 <= number < len(shown):
        msg = f"there is no cause {number}: there are {len(shown)}"
        raise InputError(msg, hint="counted from 0; the measurements may need no cause")
    return shown[number]


def _moved(cause: Cause, bodies: tuple[int, int], at: Array) -> Array:
    """Return the displacement (2,) of a place: the mean of the bodies that meet there [m]."""
    own = [b for b in bodies if b >= 0]
    result = cause.result
    found = []
    for b in own:
        nodes = result.nodes(b)
        found.append(result.node_displacement(b)[int(np.argmin(np.linalg.norm(nodes - at, axis=1)))])
    mean: Array = np.mean(found, axis=0)
    return mean


def _arrows(ax: Axes, found: Diagnosis, cause: Cause, scale: float) -> None:
    """Draw how each fixed body has moved, from the middle of where it was."""
    result = cause.result
    for b, body in enumerate(result.model.bodies):
        if body.kind != "fixed":
            continue
        motion = scale * result.node_displacement(b).mean(axis=0)
        if np.linalg.norm(motion) > 0.005 * found.model.size:
            start = result.nodes(b).mean(axis=0)
            look = {"arrowstyle": "-|>", "color": style.LOAD.colour, "lw": 2.0}
            ax.annotate("", tuple(start + motion), tuple(start), arrowprops=look, zorder=9)


def _colour(state: str) -> str:
    return {"within": FINE, "beyond": FAR_OFF, "out": style.SLIP.colour}[state]


def _dot(colour: str, word: str) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], color=colour, marker="o", mfc="white", mew=1.6, ls="none", ms=5, label=word)
