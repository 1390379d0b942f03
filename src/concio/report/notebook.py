"""How models, results, paths and limit loads show themselves in a notebook: what was found, numbers, one figure."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from concio.display import Units
from concio.model.described import model_lines
from concio.report.html_parts import figure_html
from concio.verdict.limit_words import limit_lines
from concio.verdict.path_verdict import stage_loads
from concio.verdict.verdict import Verdict

if TYPE_CHECKING:
    from concio.analysis.limit_result import LimitResult
    from concio.analysis.path_result import PathResult
    from concio.analysis.result import Result
    from concio.analysis.seismic.assessment import Assessment
    from concio.model.model import Model

_TONE = {"good": "#0072B2", "bad": "#D55E00", "unsure": "#B07800"}

HEAD = 23
"""Width of the first column of the lines of a limit load."""

LARGEST = 2000
"""Models with more bodies than this show no figure by themselves."""


def notebook_html(result: Result) -> str:
    """Return the result as a piece of HTML."""
    v = result.verdict
    rows = [("model", result.model.title or "untitled"), ("method", result.solved_by)]
    rows += verdict_rows(v, result.model.report)
    rows.append(("size", f"{len(result.model.free_bodies)} bodies, {len(result.assembly.pairs)} contact pairs"))
    if result.solved:
        contacts, units = result.contacts, result.model.report
        largest = max((float(np.linalg.norm(force)) for force in result.reactions.values()), default=0.0)
        rows.append(("pairs", contacts.counted))
        rows.append(("largest settlement", units.text("motion", result.max_settlement)))
        for name, force in list(result.reactions.items())[:8]:
            rows.append((f"reaction of {name}", units.force_vector(force, size=largest)))
    figure = ""
    if len(result.model.bodies) <= LARGEST:
        if result.solved:
            figure = figure_html(result.plot.deformed(), "deformed", "deformed shape")
        elif result.mechanism is not None:
            figure = figure_html(result.plot.mechanism(), "mechanism", "collapse mechanism")
    return _piece(v.tone, v.headline, f"{v.sentence} {v.proof}", rows, figure)


def verdict_rows(verdict: Verdict, units: Units) -> list[tuple[str, str]]:
    """Return what acts, what limits an answer, what was not checked and what is odd, a row each."""
    parts = (("acts", verdict.question.loads(units)), ("limits", verdict.limits), ("not checked", verdict.unchecked),
             ("attention", verdict.attention))  # fmt: skip
    return [(head, line) for head, lines in parts for line in lines]


def model_html(model: Model) -> str:
    """Return a model as a piece of HTML: what it holds, and its picture."""
    title, *lines = model_lines(model)
    figure = ""
    if len(model.bodies) <= LARGEST:
        if model.dim == 2:
            from concio.plot.model_figure import plot_model

            axes = plot_model(model)
        else:
            from concio.plot.space_figures import plot_space_model

            axes = plot_space_model(model)
        figure = figure_html(axes, "model", "the model")
    return _piece("good", title, "", [_halves(line) for line in lines], figure)


def path_html(path: PathResult) -> str:
    """Return a load path as a piece of HTML: how it ended, its stages, and its load curve."""
    v = path.verdict
    rows = [("model", path.assembly.model.title or "untitled")]
    for k, ended in enumerate(path.outcomes):
        rows.append((f"stage {path.stages[k].name}", f"{ended.name.lower()}, {stage_loads(path, k)}"))
    rows.append(("size", f"{len(path.steps):,} states, {len(path.events):,} events"))
    rows += verdict_rows(v, path.assembly.model.report)
    figure = figure_html(path.plot.curve(), "path", "load path")
    return _piece(v.tone, v.headline, f"{v.sentence} {v.proof}", rows, figure)


def limit_html(found: LimitResult) -> str:
    """Return a limit load as a piece of HTML: every number with what it is, and the associated mechanism."""
    title, _, *lines = limit_lines(found)
    v = found.verdict
    rows: list[tuple[str, str]] = []
    for line in lines:
        head, text = line[2:HEAD].strip(), line[HEAD:].strip()
        rows.append((head, text))
    figure = ""
    model = found.assembly.model
    if found.associated.mechanism is not None and model.dim == 2 and len(model.bodies) <= LARGEST:
        figure = figure_html(found.plot.mechanism(), "mechanism", "associated mechanism")
    return _piece(v.tone, v.headline, v.sentence, [("model", title), *rows], figure)


def assessment_html(found: Assessment) -> str:
    """Return an assessment as a piece of HTML: its verdict, and every mechanism with its multiplier and zeta_E."""
    v = found.verdict
    rows = [("model", found.model.title or "untitled"), *verdict_rows(v, found.model.report)]
    rows += [(f"{m.name}, push {m.direction}", f"alpha_0 {m.multiplier:.6g}, zeta_E {m.zeta:.4g}")
             for m in found.mechanisms]  # fmt: skip
    return _piece(v.tone, v.headline, f"{v.sentence} {v.proof}", rows, "")


def _halves(line: str) -> tuple[str, str]:
    head, found, text = line.strip().partition(": ")
    return (head, text) if found else ("", head)


def _piece(tone: str, headline: str, text: str, rows: list[tuple[str, str]], figure: str) -> str:
    cells = "".join(
        f"<tr><td style='text-align:left;color:#666'>{escape(k)}</td><td style='text-align:left'>{escape(w)}</td></tr>"
        for k, w in rows
    )
    return (
        f"<div><p style='border-left:5px solid {_TONE[tone]};padding-left:.7em;margin:.4em 0'><b>{escape(headline)}"
        f"</b><br>{escape(text)}</p><table>{cells}</table>{figure}</div>"
    )
