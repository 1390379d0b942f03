"""How models and results show themselves in a notebook: the verdict with its question, numbers, one figure.

What is shown of a result begins with the sentence and the question of its verdict, whatever result it is; what else
there is to show is looked up by the name of its class.
"""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from concio.display import DEFAULT, Units
from concio.model.described import model_lines
from concio.report.html_parts import figure_html
from concio.verdict.limit_words import number_lines
from concio.verdict.path_verdict import stage_loads
from concio.verdict.proof_verdict import proved_line
from concio.verdict.study_verdict import output_words, verdict_counts
from concio.verdict.verdict import Verdict

if TYPE_CHECKING:
    from concio.analysis.cells.cell_path_result import CellPath
    from concio.analysis.cells.strength import StrengthDomain
    from concio.analysis.limit_result import LimitResult
    from concio.analysis.motion.dynamics_result import DynamicsResult
    from concio.analysis.motion.push_result import PushResult
    from concio.analysis.path_result import PathResult
    from concio.analysis.result import Result
    from concio.analysis.seismic.assessment import Assessment
    from concio.analysis.settlement import SettlementResult
    from concio.model.model import Model
    from concio.studies.compare import ComparisonTable
    from concio.studies.study_result import StudyResult

_TONE = {"good": "#0072B2", "bad": "#D55E00", "unsure": "#B07800"}

HEAD = 23
"""Width of the first column of the lines of a limit load."""

LARGEST = 2000
"""Models with more bodies than this show no figure by themselves."""

Rows = list[tuple[str, str]]


class HasVerdict(Protocol):
    """A result."""

    @property
    def verdict(self) -> Verdict:
        """Its verdict."""


def result_html(found: HasVerdict) -> str:
    """Return a result as a piece of HTML: its verdict with the question, then numbers and a figure of its kind.

    Parameters
    ----------
    found : Result, LimitResult, PathResult or any other result with a verdict
    """
    v, model = found.verdict, model_of(found)
    units = model.report if model is not None else DEFAULT
    more, figure = BENEATH.get(type(found).__name__, _nothing_more)(found)
    rows = verdict_rows(v, units)
    rows += [("model", model.title or "untitled")] if model is not None else []
    proved = getattr(found, "proved", "")
    rows += [("proof", proved_line(proved))] if proved else []
    return _piece(v.tone, v.headline, f"{v.sentence} {v.proof}", [*rows, *more], figure)


def model_of(found: object) -> Model | None:
    """Return the model that a result is of, or None of a bare problem or of many models."""
    for way in (("model",), ("assembly", "model"), ("cell", "model"), ("path", "assembly", "model"),
                ("of", "assembly", "model"), ("pushed", "model"), ("comparisons", 0, "assembly", "model")):  # fmt: skip
        at: Any = found
        for name in way:
            at = at[name] if isinstance(name, int) else getattr(at, name, None)
            if at is None:
                break
        if at is not None:
            model: Model = at
            return model
    return None


def verdict_rows(verdict: Verdict, units: Units) -> Rows:
    """Return question, what acts, what limits an answer, what was not checked and what is suspicious, a row each."""
    question = verdict.question
    parts = (("asked", (question.asked,)), ("acts", question.loads(units)), ("assumed", question.assumptions),
             ("limits", verdict.limits), ("not checked", verdict.unchecked),
             ("attention", verdict.attention))  # fmt: skip
    return [(head, line) for head, lines in parts for line in lines]


def _nothing_more(_: object) -> tuple[Rows, str]:
    return [], ""


def _of_step(result: Result) -> tuple[Rows, str]:
    """Return the numbers of a load step, and its deformed shape or mechanism."""
    size = f"{len(result.model.free_bodies)} bodies, {len(result.assembly.pairs)} contact pairs"
    rows = [("method", result.solved_by), ("size", size)]
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
    return rows, figure


def _of_path(path: PathResult) -> tuple[Rows, str]:
    """Return the stages of a load path, and its load curve."""
    rows = [
        (f"stage {path.stages[k].name}", f"{ended.name.lower()}, {stage_loads(path, k)}")
        for k, ended in enumerate(path.outcomes)
    ]
    rows.append(("size", f"{len(path.steps):,} states, {len(path.events):,} events"))
    return rows, figure_html(path.plot.curve(), "path", "load path")


def _of_settlement(found: SettlementResult) -> tuple[Rows, str]:
    """Return what a movement of supports reached, and the path that it is."""
    share = float(found.share[-1]) if len(found.share) else 0.0
    rows, figure = _of_path(found.path)
    return [("share of the movement", f"{share:.6g}"), *rows], figure


def _of_limit(found: LimitResult) -> tuple[Rows, str]:
    """Return every multiplier with what it is, and the associated mechanism."""
    rows = [(line[2:HEAD].strip(), line[HEAD:].strip()) for line in number_lines(found)]
    model, figure = found.assembly.model, ""
    if found.associated.mechanism is not None and model.dim == 2 and len(model.bodies) <= LARGEST:
        figure = figure_html(found.plot.mechanism(), "mechanism", "associated mechanism")
    return rows, figure


def _of_assessment(found: Assessment) -> tuple[Rows, str]:
    """Return every mechanism with its multiplier and zeta_E."""
    return [(f"{m.name}, push {m.direction}", f"alpha_0 {m.multiplier:.6g}, zeta_E {m.zeta:.4g}")
            for m in found.mechanisms], ""  # fmt: skip


def _of_push(found: PushResult) -> tuple[Rows, str]:
    """Return the events of a push, and its curve."""
    from concio.plot.motion_figure import plot_capacity

    rows = [("points", f"{len(found):,}"), *(("event", str(e)) for e in found.events[:FEW])]
    return rows, figure_html(plot_capacity(found), "capacity", "capacity curve")


def _of_motion(found: DynamicsResult) -> tuple[Rows, str]:
    """Return how long a motion was followed, and the rotations in time."""
    from concio.plot.motion_figure import plot_history

    return [("steps", f"{len(found.steps.time):,}")], figure_html(plot_history(found), "history", "rotations")


def _of_cell_path(found: CellPath) -> tuple[Rows, str]:
    """Return the size of a path of a cell, and its curve."""
    return [("size", f"{len(found.steps):,} states")], figure_html(found.plot.curve(), "path", "stress and strain")


def _of_strength(found: StrengthDomain) -> tuple[Rows, str]:
    """Return the strength in each direction."""
    from concio.verdict.cell_verdict import direction_words, ray_words

    return [(direction_words(ray), "; ".join(ray_words(ray))) for ray in found.rays], ""


def _of_study(found: StudyResult) -> tuple[Rows, str]:
    """Return what came out of a study, and how many runs came to what."""
    rows = [(o.name if o.unit == "-" else f"{o.name} [{o.unit}]", output_words(found, o)) for o in found.outputs]
    return [("runs", verdict_counts(found)), *rows], ""


def _of_comparison(found: ComparisonTable) -> tuple[Rows, str]:
    """Return what each method made of the problem."""
    return [(row.method, f"{row.outcome}, certificate {row.worst:.1e}") for row in found.rows], ""


BENEATH: dict[str, Callable[[Any], tuple[Rows, str]]] = {
    "Result": _of_step, "PathResult": _of_path, "SettlementResult": _of_settlement, "LimitResult": _of_limit,
    "Assessment": _of_assessment, "PushResult": _of_push, "DynamicsResult": _of_motion, "CellPath": _of_cell_path,
    "StrengthDomain": _of_strength, "ComparisonTable": _of_comparison, "StudyResult": _of_study,
}  # fmt: skip
"""What a result shows beneath its verdict, by the name of its class: rows, and a figure."""

FEW = 8
"""Events shown of a push."""


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
