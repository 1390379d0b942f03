"""Pieces of HTML: tables with units, figures as data, escaped text."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from concio.plot.style import number
from concio.post.tables import UNITS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

HEADINGS: dict[str, str] = {
    "body": "block", "body_a": "between", "body_b": "and", "u_x": "move x", "u_y": "move y", "s_1": "largest stress",
    "s_2": "smallest stress", "normal_force": "normal force", "shear_force": "shear force", "open_share": "open",
    "force_x": "force x", "force_y": "force y",
}  # fmt: skip
"""Headings of columns where their names are not words."""

LARGEST_SVG = 350_000
"""Drawings above this many bytes are embedded as images of dots."""


def table_html(table: Mapping[str, Array], columns: tuple[str, ...], *, rows: Array | None = None) -> str:
    """Return a table; ``rows`` picks and orders its rows."""
    head = "".join(f"<th>{escape(_heading(name))}</th>" for name in columns)
    pick = range(len(table[columns[0]])) if rows is None else rows.tolist()
    body = []
    for i in pick:
        cells = "".join(_cell(table[name][i]) for name in columns)
        body.append(f"<tr>{cells}</tr>")
    return f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table></div>"


def _heading(name: str) -> str:
    word = HEADINGS.get(name, name.replace("_", " "))
    unit = UNITS.get(name, "-")
    return word if unit == "-" else f"{word} [{unit}]"


def _cell(value: object) -> str:
    if isinstance(value, bool | np.bool_):
        return f"<td>{'yes' if value else 'no'}</td>"
    if isinstance(value, float | np.floating):
        if np.isnan(value):
            return "<td class=n>&ndash;</td>"
        return f'<td class=n title="{float(value)!r}">{number(float(value))}</td>'
    return f"<td>{escape(str(value))}</td>"


def figure_html(axes: Axes, name: str, caption: str) -> str:
    """Return a figure with its drawing inside, as SVG where that is small, else as PNG; its figure is given up."""
    import matplotlib as mpl

    figure = axes.get_figure(root=True)
    assert figure is not None
    with mpl.rc_context({"svg.hashsalt": "concio", "svg.fonttype": "path"}):
        drawing = io.BytesIO()
        figure.savefig(drawing, format="svg", metadata={"Date": None})
    kind = "svg+xml"
    if drawing.tell() > LARGEST_SVG:
        drawing, kind = io.BytesIO(), "png"
        figure.savefig(drawing, format="png", dpi=140)
    data = base64.b64encode(drawing.getvalue()).decode("ascii")
    text = escape(caption)
    return f'<figure id="fig-{name}"><img alt="{text}" src="data:image/{kind};base64,{data}"></figure>'
