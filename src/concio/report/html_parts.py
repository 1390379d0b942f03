"""Pieces of HTML: tables with units, figures as data, escaped text."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np

from concio.display import DEFAULT, Units
from concio.post.result_tables import KINDS
from concio.verdict.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

HEADINGS: dict[str, str] = {
    "body": "block", "body_a": "between", "body_b": "and", "u_x": "move x", "u_y": "move y",
    "u_z": "move z", "s_1": "largest stress",
    "s_2": "smallest stress", "normal_force": "normal force", "shear_force": "shear force", "shear_size": "shear force",
    "open_share": "open", "force_x": "force x", "force_y": "force y",
}  # fmt: skip
"""Headings of columns where their names are not words."""

GIVEN = frozenset({"body", "body_a", "body_b", "support", "tie", "role"})
"""Columns whose words the engineer gave: they stay as they are in every language."""

LARGEST_SVG = 350_000
"""Drawings above this many bytes are embedded as images of dots."""


def page_html(
    title: str, body: str, *, language: str = "en", kind: str = "", style: str = "", script: str = ""
) -> str:
    """Return a whole page that fetches nothing.

    Parameters
    ----------
    title : str
        Plain text.
    body : str
        HTML of its main part.
    language : str
    kind : {"", "assessment"}
        An assessment has a style of its own on top of that of all reports.
    style, script : str
        What this page adds.
    """
    styles = "".join(resource(name) for name in ("report.css", f"{kind}.css") if name != ".css")
    return (
        f'<!DOCTYPE html><html lang="{language}"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<title translate=no>{escape(title)} &middot; concio</title><link rel="icon" href="data:,">'
        f'<style>{styles}{style}</style></head><body class="{kind}"><main>{body}</main>'
        f"<script>{script}{resource('print.js')}</script></body></html>\n"
    )


def resource(name: str) -> str:
    """Return a style, a script or a frame of pages that comes with the package."""
    return (files("concio.report") / name).read_text(encoding="utf-8")


def verdict_html(verdict: Verdict, certificate: str, details: str = "", *, units: Units = DEFAULT) -> str:
    """Return an outcome: headline, meaning and certificate, its question, details in HTML, and what to do next."""
    steps = "".join(f"<li>{escape(s)}</li>" for s in verdict.next_steps)
    asked, answer = question_html(verdict, units), f"<p><b>{escape(verdict.sentence)}</b></p>"
    head = f'<div class="verdict {verdict.tone}"><h2>{escape(verdict.headline)}</h2>{answer}'
    meaning = f"<p>{escape(verdict.meaning)}</p><p class=cert>{escape(certificate)}</p></div>"
    following = f"<h3>What to do next</h3><ul>{steps}</ul>" if steps else ""
    return f"{head}{meaning}{asked}{details}{following}"


def question_html(verdict: Verdict, units: Units = DEFAULT) -> str:
    """Return what was asked, what acts with how many kN, what limits the answer and what was not checked."""
    question = verdict.question
    rows = [
        ("asked", (question.asked,)), ("acts", question.loads(units)), ("assumed", question.assumptions),
        ("limits", verdict.limits), ("not checked", verdict.unchecked), ("attention", verdict.attention),
    ]  # fmt: skip
    cells = "".join(
        f"<tr><th>{head}</th><td>{'<br>'.join(escape(line) for line in lines)}</td></tr>"
        for head, lines in rows
        if lines
    )
    return f'<h3>The question, and what limits the answer</h3><table class="facts"><tbody>{cells}</tbody></table>'


def table_html(
    table: Mapping[str, Array], columns: tuple[str, ...], *, rows: Array | None = None, units: Units = DEFAULT
) -> str:
    """Return a table; ``rows`` picks and orders its rows."""
    pick = np.arange(len(table[columns[0]])) if rows is None else rows
    headings, cells = zip(*(_column(name, table[name][pick], units) for name in columns), strict=True)
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = [f"<tr>{''.join(row)}</tr>" for row in zip(*cells, strict=True)]
    return f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table></div>"


def _column(name: str, values: Array, units: Units) -> tuple[str, list[str]]:
    """Return the heading and the cells of a column; what a cell rounds stands in its title, in kN and m."""
    word = HEADINGS.get(name, name.replace("_", " "))
    if not np.issubdtype(values.dtype, np.floating):
        return word, [_cell(value, given=name in GIVEN) for value in values]
    texts, symbol = units.column(KINDS.get(name, "number"), values.tolist())
    told = [f'<td class=n title="{float(v)!r}">{text}</td>' for v, text in zip(values, texts, strict=True)]
    return f"{word} [{symbol}]" if symbol else word, told


def _cell(value: object, *, given: bool) -> str:
    if isinstance(value, bool | np.bool_):
        return f"<td>{'yes' if value else 'no'}</td>"
    return f"<td{' translate=no' * given}>{escape(str(value))}</td>"


def figure_html(axes: Axes, name: str, caption: str, *, dots: bool = False) -> str:
    """Return a figure with its drawing inside, as SVG where that is small, else as PNG; its figure is given up."""
    import matplotlib as mpl

    figure = axes.get_figure(root=True)
    assert figure is not None
    drawing, kind = io.BytesIO(), "svg+xml"
    if not dots:
        with mpl.rc_context({"svg.hashsalt": "concio", "svg.fonttype": "path"}):
            figure.savefig(drawing, format="svg", metadata={"Date": None})
    if dots or drawing.tell() > LARGEST_SVG:
        drawing, kind = io.BytesIO(), "png"
        figure.savefig(drawing, format="png", dpi=140)
    data = base64.b64encode(drawing.getvalue()).decode("ascii")
    text = escape(caption)
    return f'<figure id="fig-{name}"><img alt="{text}" src="data:image/{kind};base64,{data}"></figure>'
