"""The report of a limit load: the answer, the multipliers, the motions that bound them, what they depend on."""

from __future__ import annotations

import math
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import concio
from concio.arguments import strict
from concio.display import number
from concio.errors import ConcioError
from concio.report.assessment_texts import Texts
from concio.report.html_parts import figure_html, page_html, verdict_html
from concio.report.italian_page import Language, figure_in, page_in
from concio.report.page import page
from concio.report.sensitivity_part import sensitivity_html
from concio.verdict.no_limit import without_limit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.limit_result import LimitResult

MOST_PAIRS = 1000
"""Models with more contact pairs get no derivatives in their report; the result gives them when asked."""


@strict
def write_limit_report(found: LimitResult, path: Path | str, *, language: Language = "en") -> Path:
    """Write the report of a limit load.

    Parameters
    ----------
    found : LimitResult
    path : Path or str
    language : {"en", "it"}

    Returns
    -------
    Path
        ``path``.
    """
    path = Path(path)
    path.write_text(limit_html(found, language), encoding="utf-8")
    return path


def limit_html(found: LimitResult, language: Language = "en") -> str:
    """Return the report as a text; see :func:`write_limit_report`."""
    units, motions = found.assembly.model.report, found.plot.motions()
    verdict = verdict_html(found.verdict, found.verdict.proof, units=units) + _numbers(found)
    figures = "".join(
        figure_html(figure_in(axes, language), name, caption) for name, axes, caption in _drawn(found)
    )  # fmt: skip
    depends = _depends(found, language)
    if motions:
        results, labels = [result for _, result in motions], [words for words, _ in motions]
        return page(results, labels, verdict=verdict, figures=figures, more=depends, language=language)
    title = found.assembly.model.title
    heading = f"<h1 translate=no>{escape(title)}</h1>" if title else "<h1>The load multiplier</h1>"
    body = (
        f'<header><p class="brand">concio</p>{heading}</header><section id=verdict>{verdict}</section>'
        f"<section id=figures>{figures}</section>{depends}"
        f"<footer>Written by concio {escape(concio.__version__)}. Forces in kN, lengths in m.</footer>"
    )
    return page_in(page_html(title or "The load multiplier", body), language)


def _numbers(found: LimitResult) -> str:
    """Return the multipliers in a table, each with what it is."""
    path, steps, state = found.path, found.steps, found.collapse_state
    rows = [] if without_limit(found) else [("design value", found.design)]
    rows.append(("associated bound", found.associated.multiplier))
    if path is not None:
        shown = found.collapse_shown
        words = "Coulomb load path, collapse" if shown else "Coulomb load path, at least"
        rows.append((words, found.coulomb if shown else path.peak))
    if steps is not None:
        rows.append(("certified load steps", steps.carried))
    if state is not None:
        rows.append(("collapse state", state.multiplier))
    if found.friction is not None:
        rows.append(("least friction factor that holds", found.friction.factor))
    cells = "".join(
        f'<tr><th>{what}</th><td title="{value!r}">{number(value, 6)}</td></tr>'
        for what, value in rows
        if math.isfinite(value)
    )
    return f'<h3>The load multiplier</h3><table class="facts"><tbody>{cells}</tbody></table>' if cells else ""


def _drawn(found: LimitResult) -> list[tuple[str, Axes, str]]:
    """Return the figures there are: name, axes, caption."""
    plots, known = found.plot, []
    if found.collapse_state is not None:
        known.append(("collapse_state", plots.collapse_state(), "Collapse state with Coulomb friction"))
    if found.path is not None and found.path.direction.any():
        known.append(("path_mechanism", plots.path_mechanism(), "Motion at the end of the load path"))
    if found.associated.mechanism is not None:
        known.append(("mechanism", plots.mechanism(), "Mechanism of the associated bound"))
    return known


def _depends(found: LimitResult, language: Language) -> str:
    """Return what the associated bound depends on, where there is one and the model is not large."""
    bound = found.associated
    if bound.mechanism is None or not math.isfinite(bound.multiplier) or len(found.assembly.pairs) > MOST_PAIRS:
        return ""
    try:
        rows = found.sensitivity()
    except ConcioError:  # a model beside this one is none: the other parts stand
        return ""
    told = sensitivity_html(Texts(language), rows, of="limit") if rows.rows else ""
    heading = "<h2>What the multiplier depends on</h2>"
    return f"{heading}<section translate=no>{told}</section>" if told else ""
