"""The report of a study: one HTML file with table, figures, and a model file for every run that failed."""

from __future__ import annotations

import base64
import math
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import concio
from concio.display import number
from concio.plot.study_figures import suitable
from concio.report.html_parts import figure_html, page_html, question_html
from concio.report.italian_page import Language, figure_in, page_in
from concio.verdict.study_verdict import output_words, required_words, verdict_counts

if TYPE_CHECKING:
    from concio.studies.study_reliability import RequiredMultiplier
    from concio.studies.study_result import StudyResult
    from concio.studies.study_rows import Row

SHOWN = 200
"""Failed runs listed one by one; of more, the first."""


def write_study_report(
    study: StudyResult,
    path: Path | str,
    *,
    title: str = "Study",
    figures: bool = True,
    language: Language = "en",
) -> Path:
    """Write the report of a study.

    Parameters
    ----------
    study : StudyResult
    path : Path or str
    title : str
    figures : bool
    language : {"en", "it"}

    Returns
    -------
    Path
        ``path``.
    """
    path = Path(path)
    text = study_html(study, title=title, figures=figures, language=language)
    path.write_text(text, encoding="utf-8")
    return path


def study_html(
    study: StudyResult, *, title: str = "Study", figures: bool = True, language: Language = "en"
) -> str:
    """Return the report as a text; see :func:`write_study_report`."""
    parts = [
        f'<header><p class="brand">concio</p><h1 translate=no>{escape(title)}</h1></header>',
        f"<section id=verdict>{_head(study)}</section>",
        f"<section><h2>Outputs</h2>{_outputs(study)}</section>",
        f"<section><h2>Variables</h2>{_variables(study)}</section>",
    ]
    if study.required is not None and study.required.index is not None:
        parts.append(f"<section id=reliability><h2>Reliability</h2>{_reliability(study, study.required)}</section>")
    if figures:
        drawn = "".join(
            figure_html(figure_in(axes, language), name, caption) for name, axes, caption in suitable(study)
        )
        parts.append(f"<section id=figures><h2>Figures</h2>{drawn}</section>")
    parts.append(f"<section id=failed><h2>Runs without an answer</h2>{_failed(study)}</section>")
    parts.append(f"<footer>Written by concio {escape(concio.__version__)}. Forces in kN, lengths in m.</footer>")
    return page_in(page_html(title, "".join(parts)), language)


def _head(study: StudyResult) -> str:
    v = study.verdict
    early = " It stopped there because the stopping criterion was met." if study.stopped else ""
    counts = escape(verdict_counts(study))
    return (
        f'<div class="verdict {v.tone}"><h2>{escape(v.headline)}</h2><p>Sample: {escape(study.sample.design)}, seed '
        f"{study.sample.seed}.{early} {escape(v.meaning)}</p><p>{counts}</p></div>{question_html(v)}"
    )


def _outputs(study: StudyResult) -> str:
    rows = []
    for o in study.outputs:
        spread = study.spread(o.name)
        unit = "" if o.unit == "-" else f" [{escape(o.unit)}]"
        cells = [f"{len(spread.known)} of {len(spread.values)}"]
        cells += [number(x) if math.isfinite(x) else "&ndash;" for x in (spread.mean, spread.sd)]
        numbers = "".join(f"<td class=n>{c}</td>" for c in cells)
        words = escape(output_words(study, o))
        rows.append(f"<tr><td translate=no>{escape(o.name)}{unit}</td><td>{words}</td>{numbers}</tr>")
    heads = ("output", "all runs", "finite numbers", "their mean", "their standard deviation")
    head = "".join(f"<th>{w}</th>" for w in heads)
    return f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"


def _variables(study: StudyResult) -> str:
    rows = "".join(
        f"<tr><td translate=no>{escape(v.name)}</td><td>{escape(v.describe())}</td>"
        f"<td translate=no>{escape(', '.join(v.keys))}</td></tr>"
        for v in study.sample.variables
    )
    head = "<th>variable</th><th>distribution</th><th>keys of the model file</th>"
    return f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"


def _reliability(study: StudyResult, asked: RequiredMultiplier) -> str:
    """Return the design point with what each variable contributes."""
    found = asked.index
    assert found is not None
    text = (
        f"{number(found.beta, 4)} standard deviations lie between the medians and the nearest values with which the "
        f"multiplier falls to {number(asked.required)}."
    )
    rows = "".join(
        f"<tr><td translate=no>{escape(v.name)}{f' [{escape(v.unit)}]' if v.unit else ''}</td>"
        f"<td class=n>{number(found.point[v.name], 4)}</td><td class=n>{number(100 * found.importance[v.name])}</td>"
        f"<td class=n>{number(found.direction[v.name])}</td></tr>"
        for v in study.sample.variables
    )
    heads = ("variable", "value at the design point", "share of the variance [%]", "index per standard deviation")
    head = "".join(f"<th>{w}</th>" for w in heads)
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
    return f"<p>{escape(required_words(study))} {text}</p><div class=scroll>{table}</div>"


def _failed(study: StudyResult) -> str:
    failed = study.failures
    if not failed:
        return "<p>None.</p>"
    rows = "".join(_failed_row(study, row) for row in failed[:SHOWN])
    head = "<th>run</th><th>values</th><th>what happened</th><th>model</th>"
    more = f"<p>{len(failed) - SHOWN} more are in the table.</p>" if len(failed) > SHOWN else ""
    return f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>{more}"


def _failed_row(study: StudyResult, row: Row) -> str:
    values = ", ".join(
        f"{name} = {number(value) if isinstance(value, float) else value}"
        for name, value in study.sample.row(row.index).items()
    )
    link = "&ndash;"
    if study.source is not None:
        data = base64.b64encode(study.model_text(row.index).encode()).decode("ascii")
        name = f"run-{row.index}.toml"
        link = f'<a download="{name}" href="data:application/toml;base64,{data}">{name}</a>'
    said = f"{row.verdict.replace('_', ' ')}: {row.message}" if row.message else row.verdict.replace("_", " ")
    told = f"<td translate=no>{escape(values)}</td><td>{escape(said)}</td><td translate=no>{link}</td>"
    return f"<tr><td class=n>{row.index}</td>{told}</tr>"
