"""Figures of a study: what came out, over what went in; what matters; how likely failure is."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from concio.display import number
from concio.errors import InputError
from concio.plot import style
from concio.plot.diagram import diagram_axes, dress_diagram
from concio.problem.tolerances import SAME_VALUE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.studies.study_result import Event, StudyResult

Array = np.ndarray
SIZE = (6.4, 4.2)
"""Width and height of a new figure [in]."""
JITTER = 0.04
"""Height by which points of yes and no are spread, so that they can be distinguished."""


@dataclass(frozen=True, eq=False)
class StudyPlots:
    """Figures of one study. Each takes ``ax=`` and returns the axes it drew on; none shows a window.

    Parameters
    ----------
    study : StudyResult
    """

    study: StudyResult

    def scatter(self, variable: str, output: str, ax: Axes | None = None) -> Axes:
        """Draw an output over a variable, run by run; runs without a value are marked below.

        Parameters
        ----------
        variable, output : str
        ax : Axes, optional
        """
        ax = diagram_axes(ax, SIZE)
        x, y = self.study.values(variable), self.study.values(output)
        known = np.isfinite(y)
        ax.plot(x[known], y[known], ls="none", marker="o", ms=3.2, mfc=style.COMPRESSION.colour, mec="none", alpha=0.6)
        if (~known).any():
            below = np.full(int((~known).sum()), -0.02)
            ax.plot(x[~known], below, ls="none", marker="x", ms=4, color=style.TENSION.colour, clip_on=False,
                    transform=ax.get_xaxis_transform(), label=f"{(~known).sum()} runs without a number")  # fmt: skip
            ax.legend(frameon=False, fontsize=8)
        chosen = next((v for v in self.study.sample.variables if v.name == variable), None)
        if chosen is not None and chosen.distribution == "choice":
            ax.set_xticks(range(len(chosen.values)), [str(v) for v in chosen.values])
        return dress_diagram(ax, f"{output} over {variable}", self._label(variable), self._label(output))

    def histogram(self, output: str, ax: Axes | None = None, *, threshold: float | None = None) -> Axes:
        """Draw how the values of an output are distributed, with a threshold."""
        ax = diagram_axes(ax, SIZE)
        values = self.study.values(output)
        known = values[np.isfinite(values)]
        if len(known):
            alike = np.ptp(known) <= SAME_VALUE * np.abs(known).max()
            ax.hist(known, bins=1 if alike else "auto", color=style.BLOCK, edgecolor=style.EDGE)
        if threshold is not None:
            ax.axvline(threshold, color=style.TENSION.colour, ls="--", lw=1.2)
        of = f"{len(known)} of {len(values)} runs" if len(known) < len(values) else f"{len(known)} runs"
        return dress_diagram(ax, f"{output}, {of}", self._label(output), "runs")

    def tornado(self, output: str, ax: Axes | None = None) -> Axes:
        """Draw what matters for an output, the most important variable on top.

        Of a ``one-at-a-time`` sample: the output at the 5 and 95 per cent quantiles of each variable, others at their
        median. Of other samples: Sobol indices or rank correlations, as :meth:`StudyResult.sensitivity` finds them.
        """
        ax = diagram_axes(ax, SIZE)
        if self.study.sample.design == "one-at-a-time":
            return self._swings(output, ax)
        found = self.study.sensitivity(output)
        order = np.argsort(np.abs(found.total))
        places = np.arange(len(order))
        names = [found.names[i] for i in order]
        if found.kind == "Sobol":
            ax.barh(places, found.total[order], 0.7, color=style.BLOCK, edgecolor=style.EDGE, label="total",
                    xerr=found.total_error[order], error_kw={"lw": 0.9})  # fmt: skip
            ax.barh(places, found.first[order], 0.36, color=style.COMPRESSION.colour, label="alone")
            ax.legend(frameon=False, fontsize=8, loc="lower right")
            word = "share of the variance (Sobol index)"
        else:
            colours = np.where(found.first[order] >= 0, style.COMPRESSION.colour, style.TENSION.colour)
            ax.barh(places, found.first[order], 0.6, color=colours.tolist())
            ax.axvline(0.0, color=style.INK, lw=0.8)
            ax.set_xlim(-1.05, 1.05)
            word = "rank correlation (Spearman)"
        ax.set_yticks(places, names)
        return dress_diagram(ax, f"What matters for {output}", word, "")

    def _swings(self, output: str, ax: Axes) -> Axes:
        values = self.study.values(output)
        if len(values) < len(self.study.sample):
            values = np.concatenate([values, np.full(len(self.study.sample) - len(values), np.nan)])
        middle, ends = values[0], values[1:].reshape(-1, 2)
        names = np.array([v.name for v in self.study.sample.variables])
        width = np.nan_to_num(np.abs(_finite(ends[:, 1]) - _finite(ends[:, 0])))
        order = np.argsort(width)
        places = np.arange(len(order))
        for column, colour, word in ((0, style.TENSION.colour, "5 %"), (1, style.COMPRESSION.colour, "95 %")):
            length = np.nan_to_num(_finite(ends[order, column]) - middle)
            ax.barh(places, length, 0.6, left=middle, color=colour, label=f"variable at its {word} quantile")
        ax.axvline(float(middle), color=style.INK, lw=0.8)
        ax.set_yticks(places, names[order].tolist())
        ax.legend(frameon=False, fontsize=8, loc="lower right")
        return dress_diagram(ax, f"What matters for {output}", self._label(output), "")

    def fragility(
        self,
        intensity: str,
        event: Event,
        ax: Axes | None = None,
        *,
        below: float | None = None,
        above: float | None = None,
        confidence: float = 0.95,
    ) -> Axes:
        """Draw the fragility curve of an event over a variable, its band, and the runs it was fitted to."""
        ax = diagram_axes(ax, SIZE)
        curve = self.study.fragility(intensity, event, below=below, above=above)
        x, y = self.study.values(intensity), self.study.event(event, below=below, above=above)
        at = np.linspace(max(float(x.min()), 1e-9 * float(x.max())), float(x.max()), 200)
        low, high = curve.band(at, confidence)
        ax.fill_between(at, low, high, color=style.COMPRESSION.colour, alpha=0.18, lw=0,
                        label=f"{100 * confidence:g} % band")  # fmt: skip
        ax.plot(at, curve.probability(at), color=style.COMPRESSION.colour, lw=1.8,
                label=f"median {number(curve.median)}, beta {number(curve.beta)}")  # fmt: skip
        spread = JITTER * (np.arange(len(x)) * 0.618034 % 1.0)
        ax.plot(x, np.where(y > 0, y - spread, y + spread), ls="none", marker="|", ms=4, color=style.INK, alpha=0.5)
        ax.legend(frameon=False, fontsize=8, loc="center right")
        return dress_diagram(ax, "Fragility", self._label(intensity), "probability")

    def _label(self, name: str) -> str:
        units = {v.name: v.unit for v in self.study.sample.variables}
        units |= {o.name: o.unit for o in self.study.outputs}
        unit = units.get(name, "")
        return f"{name} [{unit}]" if unit not in ("", "-") else name


def _finite(values: Array) -> Array:
    """Return values with ``nan`` for infinite ones, which no bar reaches."""
    return np.where(np.isfinite(values), values, np.nan)


def suitable(study: StudyResult) -> list[tuple[str, Axes, str]]:
    """Return (name, axes, caption) of the figures that suit a study, for its report."""
    plots = StudyPlots(study)
    found: list[tuple[str, Axes, str]] = []
    for o in study.outputs:
        values = study.values(o.name)
        known = values[np.isfinite(values)]
        if not len(known):
            continue
        if not o.event:
            found.append((f"histogram-{o.name}", plots.histogram(o.name), f"Values of {o.name}"))
        with suppress(InputError):  # too few runs for indices: the other figures stand
            found.append((f"tornado-{o.name}", plots.tornado(o.name), f"What matters for {o.name}"))
        for v in study.sample.variables:
            if v.distribution != "seed":
                caption = f"{o.name} over {v.name}"
                found.append((f"scatter-{o.name}-{v.name}", plots.scatter(v.name, o.name), caption))
    return found
