"""Figures in the language of a report: decimal commas, symbols with their indices, squares in units."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from matplotlib.ticker import ScalarFormatter

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SYMBOL = re.compile(r"\b([adT])_(SLO|SLD|SLV|SLC|C0|C|0|g)\b")
SQUARE = re.compile(r"(?<=[A-Za-z])/(m|s)([23])\b")
DECIMAL = re.compile(r"(?<=\d)\.(?=\d)")


class _Comma(ScalarFormatter):
    """Numbers of an axis with a decimal comma."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the label of a tick."""
        return super().__call__(x, pos).replace(".", ",")


def in_language(ax: Axes, language: str) -> Axes:
    """Set the texts of a figure as a language writes them.

    Parameters
    ----------
    ax : Axes
    language : str
        "it" has decimal commas.
    """
    legend = ax.get_legend()
    texts = [*ax.texts, ax.xaxis.label, ax.yaxis.label, *(legend.get_texts() if legend else ())]
    for text in texts:
        words = SYMBOL.sub(r"$\1_{\\mathrm{\2}}$", text.get_text())
        words = SQUARE.sub(lambda m: f"/{m[1]}{'²³'[int(m[2]) - 2]}", words).replace("alpha", "α")
        text.set_text(DECIMAL.sub(",", words) if language == "it" else words)
    if language == "it" and ax.name == "rectilinear":
        for axis in (ax.xaxis, ax.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(_Comma())
    return ax
