"""The report of a load path: how it ended and where, the load curve, the events, and every stage of the motion."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from concio.arguments import strict
from concio.display import number
from concio.plot.path_accessor import PathPlots
from concio.post.path_curve import most_moving
from concio.report.assessment_texts import Texts
from concio.report.html_parts import figure_html, verdict_html
from concio.report.italian_page import Language, figure_in
from concio.report.page import page
from concio.report.sensitivity_part import sensitivity_html
from concio.report.state_part import MOST_PAIRS
from concio.verdict.path_verdict import stage_loads, stage_sentence

if TYPE_CHECKING:
    from concio.analysis.path_result import NamedEvent, PathResult
    from concio.model.stages import ControlPoint

MOST_STEPS = 40
"""Steps the slider of the report shows."""

MOST_EVENTS = 250
"""Longest table of events."""


@strict
def write_path_report(
    found: PathResult, path: Path | str, *, point: ControlPoint | None = None, language: Language = "en",
    first: str = "",
) -> Path:  # fmt: skip
    """Write the report of a load path.

    Parameters
    ----------
    found : PathResult
    path : Path or str
    point : ControlPoint, optional
        Whose motion the load curve shows; by default the point that moved most in the end.
    language : {"en", "it"}
    first : str
        English HTML that stands before the stages, such as the movement of supports.

    Returns
    -------
    Path
        ``path``.
    """
    path = Path(path)
    path.write_text(path_html(found, point=point, language=language, first=first), encoding="utf-8")
    return path


@strict
def path_html(
    found: PathResult, *, point: ControlPoint | None = None, language: Language = "en", first: str = ""
) -> str:
    """Return the report of a load path as a text; see :func:`write_path_report`."""
    chosen = report_steps(found)
    curves = PathPlots(found).stages(point=most_moving(found) if point is None else point)
    return page(
        [found.result(i) for i in chosen],
        [step_words(found, i, language) for i in chosen],
        verdict=verdict_html(found.verdict, found.verdict.proof, units=found.assembly.model.report),
        figures=figure_html(figure_in(curves[-1], language), "path", "Load against motion, stage by stage"),
        more=first + _depends(found, language) + _stages(found) + _events(found),
        language=language,
    )


def _depends(found: PathResult, language: Language) -> str:
    """Return what the load factor at collapse depends on, where it has derivatives and the model is not large."""
    rows = found.sensitivity() if len(found.assembly.pairs) <= MOST_PAIRS else None
    if rows is None:
        return ""
    t = Texts(language)
    told = sensitivity_html(t, rows, of="collapse", value=t.n(rows.multiplier))
    return f"<h2>What the collapse depends on</h2><section translate=no>{told}</section>"


def report_steps(found: PathResult) -> list[int]:
    """Return the steps the slider of the report shows: all, or some evenly chosen, with the end of every stage."""
    count = len(found.steps)
    ends = {max(i for i, s in enumerate(found.steps) if s.stage == k) for k in {s.stage for s in found.steps}}
    spread = np.linspace(0, count - 1, min(count, MOST_STEPS)).round().astype(int)
    return sorted(ends | {int(i) for i in spread})


def step_words(found: PathResult, step: int, language: Language = "en") -> str:
    """Return where a step lies, in words: stage and load."""
    at = {"en": "at", "it": "a"}[language]
    chosen = found.steps[step]
    own = [i for i, s in enumerate(found.steps) if s.stage == chosen.stage]
    name, values = found.load(chosen.stage)
    value = float(values[len(values) - len(own) + own.index(step)])
    return f"{found.stages[chosen.stage].name}: {name} {at} {number(value, 4)}"


def _stages(found: PathResult) -> str:
    rows = []
    for k, stage in enumerate(found.stages):
        if k >= len(found.outcomes):
            rows.append((stage.name, "not begun", "", ""))
            continue
        count = sum(e.stage == k for e in found.events)
        rows.append((stage.name, stage_sentence(found, k), stage_loads(found, k), f"{count:,}"))
    return _table("Stages", ("stage", "how it ended", "load reached", "events"), rows)


def _events(found: PathResult) -> str:
    if not found.events:
        return ""
    shown = found.events[:MOST_EVENTS]
    rows = [_event_row(found, event) for event in shown]
    left = len(found.events) - len(rows)
    more = f"<p class=note>The first {MOST_EVENTS}; {left:,} more are in events.csv.</p>" if left else ""
    return _table("Events", ("stage", "load", "joint", "what happens", "at [m]"), rows) + more


def _event_row(found: PathResult, event: NamedEvent) -> tuple[str, ...]:
    at = "(" + ", ".join(f"{x:.4g}" for x in event.at) + ")"
    load = number(event_load(found, event), 6)
    return found.stages[event.stage].name, load, " | ".join(event.bodies), event.kind, at


def event_load(found: PathResult, event: NamedEvent) -> float:
    """Return the load factor (or share of the stage) at which an event happens."""
    _, values = found.load(event.stage)
    first = next(i for i, step in enumerate(found.steps) if step.stage == event.stage)
    skipped = len(values) - sum(step.stage == event.stage for step in found.steps)
    return float(values[event.step - first + skipped])


def _table(title: str, heads: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    head = "".join(f"<th>{escape(h)}</th>" for h in heads)
    named = [" translate=no" * (head in ("stage", "joint")) for head in heads]
    cells = [[f"<td{kept}>{escape(cell)}</td>" for kept, cell in zip(named, row, strict=True)] for row in rows]
    body = "".join(f"<tr>{''.join(row)}</tr>" for row in cells)
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    return f"<h2>{escape(title)}</h2><div class=scroll>{table}</div>"
