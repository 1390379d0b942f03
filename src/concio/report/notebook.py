"""How a result shows itself in a notebook: verdict, numbers, and one figure."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from concio.report.html_parts import figure_html
from concio.report.wording import certificate_sentence, verdict

if TYPE_CHECKING:
    from concio.analysis.result import Result

_TONE = {"good": "#0072B2", "bad": "#D55E00", "unsure": "#B07800"}

LARGEST = 2000
"""Models with more bodies than this show no figure by themselves."""


def notebook_html(result: Result) -> str:
    """Return the result as a piece of HTML."""
    v = verdict(result)
    rows = [("model", result.model.title or "untitled"), ("method", result.method)]
    rows.append(("size", f"{len(result.model.free_bodies)} bodies, {len(result.assembly.pairs)} contact pairs"))
    if result.solved:
        contacts, units = result.contacts, result.model.report
        largest = max((float(np.linalg.norm(force)) for force in result.reactions.values()), default=0.0)
        rows.append(("pairs", contacts.counted))
        rows.append(("largest settlement", units.text("motion", result.max_settlement)))
        for name, (x, y) in list(result.reactions.items())[:8]:
            rows.append((f"reaction of {name}", units.force_vector((x, y), size=largest)))
    cells = "".join(
        f"<tr><td style='text-align:left;color:#666'>{escape(k)}</td><td style='text-align:left'>{escape(w)}</td></tr>"
        for k, w in rows
    )
    figure = ""
    if len(result.model.bodies) <= LARGEST:
        if result.solved:
            figure = figure_html(result.plot.deformed(), "deformed", "deformed shape")
        elif result.mechanism is not None:
            figure = figure_html(result.plot.mechanism(), "mechanism", "collapse mechanism")
    return (
        f"<div><p style='border-left:5px solid {_TONE[v.tone]};padding-left:.7em;margin:.4em 0'><b>{escape(v.headline)}"
        f"</b><br>{escape(certificate_sentence(result))}</p><table>{cells}</table>{figure}</div>"
    )
