"""The report as one self-contained HTML file: nothing is fetched, so it opens offline and can be mailed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import concio
from concio.arguments import strict
from concio.display import Units, number
from concio.errors import InputError
from concio.model.described import law_words, material_words
from concio.plot.figures import TITLES, suitable_figures
from concio.report.html_parts import figure_html, resource, table_html, verdict_html
from concio.report.italian_page import Language, figure_in, page_in, script_words, text_in
from concio.report.report_tables_in_space import space_tables_html, ties_html
from concio.report.space_data import space_view_data
from concio.report.state_part import state_depends_html
from concio.report.view_data import view_data
from concio.verdict.proof_verdict import proved_line
from concio.verdict.step_verdict import checks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from concio.analysis.result import Result
    from concio.model.model import Model

ROWS = 250
"""Longest table; of longer ones the rows that matter most are shown."""


@strict
def write_report(
    results: Result | Sequence[Result],
    path: Path | str,
    *,
    labels: Sequence[str] | None = None,
    figures: bool = True,
    language: Language = "en",
) -> Path:
    """Write the report of a result, or of a load path.

    Parameters
    ----------
    results : Result or sequence of Result
        Steps of a load path share one assembly; tables, figures and verdict are those of the last.
    path : Path or str
    labels : sequence of str, optional
        What the steps are called; default their load factors.
    figures : bool
        Whether to draw figures into it; the interactive view is always there.
    language : {"en", "it"}

    Returns
    -------
    Path
        ``path``.
    """
    path = Path(path)
    text = report_html(results, labels=labels, figures=figures, language=language)
    path.write_text(text, encoding="utf-8")
    return path


@strict
def report_html(
    results: Result | Sequence[Result],
    *,
    labels: Sequence[str] | None = None,
    figures: bool = True,
    language: Language = "en",
) -> str:
    """Return the report as a text; see :func:`write_report`.

    Raises
    ------
    InputError
        There is no step, or the steps do not belong to one assembly.
    """
    steps = list(results) if isinstance(results, Sequence) else [results]
    if not steps:
        msg = "there is no result to report"
        raise InputError(msg, hint="give at least one step")
    if any(len(s.assembly.pairs) != len(steps[0].assembly.pairs) for s in steps):
        msg = "the steps belong to different models"
        raise InputError(msg, hint="write one report for each model")
    labels = [_label(s, i) for i, s in enumerate(steps)] if labels is None else list(labels)
    drawn = _figures(steps[-1], language) if figures else ""
    more = state_depends_html(steps[-1], language) if figures and len(steps) == 1 else ""
    return page(steps, labels, verdict=_verdict(steps[-1]), figures=drawn, more=more, language=language)


def report_of(result: Result, drawn: Sequence[str] | None = None, language: Language = "en") -> str:
    """Return the report of one result with figures that are drawn already, as :func:`captioned` gives them."""
    figures = _figures(result, language) if drawn is None else "".join(drawn)
    more = state_depends_html(result, language) if figures else ""
    verdict = _verdict(result)
    return page([result], [_label(result, 0)], verdict=verdict, figures=figures, more=more, language=language)


def captioned(name: str, axes: Axes, language: Language = "en", *, dots: bool = False) -> str:
    """Return a figure of a result for its report, under its title; with ``dots`` as PNG without trying SVG."""
    return figure_html(figure_in(axes, language), name, TITLES[name], dots=dots)


def page(
    steps: Sequence[Result],
    labels: Sequence[str],
    *,
    verdict: str,
    figures: str,
    more: str = "",
    language: Language = "en",
) -> str:
    """Return a report of steps that share one assembly: what was found in HTML, the view, figures, ``more``, tables."""
    last = steps[-1]
    space = last.model.dim == 3
    view = "space_view" if space else "view"
    shown = {**view_of(steps, [text_in(label, language) for label in labels]), **script_words(language)}
    data = json.dumps(shown, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    parts = {
        "TITLE": escape(last.model.title or "Result"),
        "NAME": _title(last),
        "STYLE": resource("report.css") + (resource("space_view.css") if space else ""),
        "SCRIPT": "".join(resource(f"{name}.js") for name in ("view_base", view, "names", "print")),
        "VIEW": resource(f"{view}.html"),
        "VERDICT": verdict,
        "MODEL": _model(last),
        "FIGURES": figures,
        "TABLES": more + _tables(last),
        "TRIED": _tried(last),
        "DATA": data,
        "UNITS": escape(_units_sentence(last.model.report)),
        "VERSION": escape(concio.__version__),
    }
    page = resource("report.html")
    head, *pieces = page.split("{{")
    for piece in pieces:
        name, rest = piece.split("}}", 1)
        head += parts[name] + rest
    return page_in(head, language)


def view_of(steps: Sequence[Result], labels: Sequence[str]) -> dict[str, Any]:
    """Return what the view of steps on one assembly draws, as plain types: outlines, motions, states of joints."""
    return (space_view_data if steps[-1].model.dim == 3 else view_data)(steps, labels)


def _title(result: Result) -> str:
    """Return the heading: a title that was given is a name, and stays as it is in every language."""
    return f"<h1 translate=no>{escape(result.model.title)}</h1>" if result.model.title else "<h1>Result</h1>"


def _units_sentence(units: Units) -> str:
    stress = "kN/m2 or MPa" if units.stress == "auto" else units.stress
    return (
        f"Forces in {units.force}, lengths in {units.length}, motions in {units.motion}, stresses in {stress}; tension "
        "is positive. A number that is rounded shows all its digits, in kN and m, under the pointer."
    )


def _label(result: Result, index: int) -> str:
    factors = ", ".join(f"{g} = {number(v)}" for g, v in result.factors.items())
    return factors or f"step {index + 1}"


def _verdict(result: Result) -> str:
    v = result.verdict
    checked = ""
    if result.solved:
        rows = "".join(
            f"<tr><td>{escape(c.what)}</td><td class=n>{c.value:.1e}</td>"
            f"<td>{'holds' if c.holds else 'fails'}</td></tr>"
            for c in checks(result)
        )
        checked = (
            "<details><summary>The certificate, equation by equation</summary><div class=scroll><table><thead><tr>"
            f"<th>checked</th><th>error</th><th></th></tr></thead><tbody>{rows}</tbody></table></div></details>"
        )
    proof = f"{v.proof} {proved_line(result.proved)}" if result.proved else v.proof
    return verdict_html(v, proof, checked, units=result.model.report)


def _elements(model: Model) -> str:
    """Return what bodies are made of; rigid ones have no elements."""
    words = model.element if any(body.kind == "elastic" for body in model.bodies) else "none: no body deforms"
    return f"{words}, plane {model.plane}" if model.dim == 2 else words


def _model(result: Result) -> str:
    model, units = result.model, result.model.report
    fixed = len(model.bodies) - len(model.free_bodies)
    rows = [
        ("bodies", f"{len(model.free_bodies)}, and {fixed} fixed"),
        ("joints", f"{len(result.assembly.detection.interfaces)} with {len(result.assembly.pairs)} contact pairs"),
        ("unknowns", f"{result.assembly.disc.unknowns:,}"),
        ("elements", _elements(model)),
        ("contact", ", ".join(f"{n:,} {name}" for name, n in result.assembly.pairs.contact_model.items())),
    ]
    for name, material in model.materials.items():
        if any(b.material == name and b.kind != "fixed" for b in model.bodies):
            rows.append((f"material '{name}'", material_words(material, units)))
    rows += [(f"joint law '{name}'", law_words(law, units)) for name, law in model.laws.items()]
    rows.append(("total load", units.force_vector(result.total_load)))
    if result.factors:
        rows.append(("load factors", _label(result, 0)))
    if result.solved:
        contacts = result.contacts
        rows.append(("largest settlement", units.text("motion", result.max_settlement)))
        rows.append(("contact pairs", contacts.counted))
    if result.seconds.get("total"):
        spent = f"{result.solution.iterations} iterations, {result.seconds['total']:.2g} s"
        rows.append(("solved by", f"{result.solved_by}, {spent}"))
    cells = "".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows)
    return f'<div class=scroll><table class="facts"><tbody>{cells}</tbody></table></div>'


def _figures(result: Result, language: Language) -> str:
    return "".join(captioned(name, draw(), language) for name, draw in suitable_figures(result).items())


def _tables(result: Result) -> str:
    if not result.solved:
        return ""
    if result.model.dim == 3:
        return space_tables_html(result, ROWS)
    tables, units = result.tables, result.model.report
    joints, bodies, reactions = tables.joints(), tables.bodies(), tables.reactions()
    force = np.hypot(joints["normal_force"], joints["shear_size"])
    strongest = np.argsort(-force, kind="stable")
    text = f"<h2>Reactions</h2>{table_html(reactions, ('support', 'force_x', 'force_y'), units=units)}"
    text += "<p class=note>Forces on the structure.</p>" + ties_html(result)
    columns: tuple[str, ...] = (
        "body_a", "body_b", "length", "normal_force", "shear_force", "eccentricity", "open_share", "slipping"
    )  # fmt: skip
    text += "<h2>Joints</h2>" + _note(len(force), "the largest forces")
    text += table_html(joints, columns, rows=strongest[:ROWS], units=units)
    text += "<p class=note>Normal force: compression positive. Shear force, on the second block, and eccentricity, "
    text += "from the middle of the joint, are positive along its tangent: the normal from the first block to the "
    text += "second, turned left.</p>"
    moved = np.hypot(bodies["u_x"], bodies["u_y"])
    free = np.flatnonzero(bodies["kind"] != "fixed")
    order = free[np.argsort(np.nan_to_num(bodies["s_2"][free]), kind="stable")] if len(free) > ROWS else free
    if not np.isfinite(bodies["s_2"]).any():
        order = free[np.argsort(-moved[free], kind="stable")]
    columns = ("body", "role", "u_x", "u_y", "rotation", "s_1", "s_2")
    text += "<h2>Blocks</h2>" + _note(len(free), "the largest compression")
    text += table_html(bodies, columns, rows=order[:ROWS], units=units)
    return text + "<p class=note>Mean motion and mean principal stresses; tension positive.</p>"


def _note(count: int, what: str) -> str:
    return "" if count <= ROWS else f"<p class=note>The {ROWS} with {what}, of {count:,}; the CSV tables hold all.</p>"


def _tried(result: Result) -> str:
    lines = "".join(f"<li>{escape(line)}</li>" for line in result.solution.trace)
    log = f'<ol lang="en" translate=no>{lines}</ol>'
    return f'<details class="log"><summary>What the solver did</summary>{log}</details>' if lines else ""
