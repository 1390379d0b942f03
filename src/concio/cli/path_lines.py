"""What ``concio path`` prints and writes: stages, events with the names of their joints, and the curve."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

import numpy as np

from concio.analysis.path import ControlPoint, PathResult
from concio.analysis.path_result import NamedEvent
from concio.cli.lines import tie_lines
from concio.display import counted, number
from concio.io.csv_table import write_csv
from concio.io.result_dir import write_result
from concio.report.path_page import event_load, write_path_report
from concio.verdict.path_verdict import stage_loads, stage_sentence

MOST_FINDINGS = 12
"""More lines of one kind than this are counted; the report holds all."""

MOST_EVENTS = 30
"""More events than this are counted, unless all are asked for."""


def path_lines(found: PathResult, point: ControlPoint, *, every: bool) -> list[str]:
    """Return the path as lines of text."""
    verdict, title = found.verdict, found.assembly.model.title or "model without a title"
    lines = [title, verdict.headline, f"  {verdict.sentence}"]
    lines += verdict.lines(found.assembly.model.report, most=MOST_FINDINGS)
    motion, _ = found.curve(point)
    units, farthest = found.assembly.model.report, float(np.abs(motion).max(initial=0.0))
    for k in range(len(found.outcomes)):
        own = [i for i, step in enumerate(found.steps) if step.stage == k]
        events = [e for e in found.events if e.stage == k]
        moved = f"; the point has moved {units.text('motion', motion[own[-1]], 4, size=farthest)}" if own else ""
        most = f"{stage_loads(found, k)}; {counted(len(events), 'event')}{moved}"
        lines += [f"stage {found.stages[k].name}: {stage_sentence(found, k)}", f"  {most}"]
        shown = events if every else [e for e in events if e.parameter > 0]
        if at_once := len(events) - len(shown):
            lines.append(f"  at once: {counted(at_once, 'change')} of state as the stage begins")
        lines += [f"  {_event_words(found, event)}" for event in shown[: None if every else MOST_EVENTS]]
        if len(shown) > MOST_EVENTS and not every:
            lines.append(f"  ... and {len(shown) - MOST_EVENTS:,} more")
        if not every and (at_once or len(shown) > MOST_EVENTS):
            lines.append("  (--all lists every event)")
    for later in found.stages[len(found.outcomes) :]:
        lines.append(f"stage {later.name}: not begun")
    if found.assembly.model.ties:
        lines += tie_lines(found.result())
    at, along = ", ".join(f"{x:.4g}" for x in point.at), ", ".join(f"{x:.3g}" for x in point.direction)
    lines += [
        f"  point        '{point.body}' at ({at}) m, moving along ({along})",
        f"  certificate  worst {found.certificate:.1e} of {len(found.steps):,} states; energy closed to "
        f"{found.energy_error:.1e}",
    ]
    return lines


def _event_words(found: PathResult, event: NamedEvent) -> str:
    a, b = event.bodies
    at = ", ".join(f"{x:.4g}" for x in event.at)
    return f"{number(event_load(found, event), 6)}: {a} | {b} {event.kind} at ({at})"


def path_facts(found: PathResult, point: ControlPoint) -> dict[str, Any]:
    """Return the path as plain types."""
    motion, parameter = found.curve(point)
    return {
        "status": found.verdict.status,
        "sentence": found.sentence,
        "verdict": found.verdict.as_dict(),
        "title": found.assembly.model.title,
        "engine": found.assembly.model.engine,
        "stages": [
            {
                "name": stage.name,
                "factors": dict(stage.factors),
                "outcome": outcome.name.lower(),
                "peak": found.peak(k),
                "load": found.load(k)[0],
                "most": float(found.load(k)[1].max()),
                "control": None if stage.control is None else {"body": stage.control.body, "until": stage.until},
                "loads": [asdict(load) | {"applied": load.applied} for load in found.group_loads(k)],
            }
            for k, (stage, outcome) in enumerate(zip(found.stages, found.outcomes, strict=False))
        ],
        "certificate": {"worst": found.certificate},
        "energy_error": found.energy_error,
        "ties": found.result().ties.as_list(),
        "broken_ties": [{"name": name, "elongation": far} for name, far in found.broken_ties],
        "point": {"body": point.body, "at": list(point.at), "direction": list(point.direction)},
        "curve": {
            "stage": [step.stage for step in found.steps],
            "parameter": parameter.tolist(),
            "displacement": motion.tolist(),
        },
        "events": [
            {"stage": e.stage, "parameter": e.parameter, "kind": e.kind, "bodies": list(e.bodies), "at": list(e.at)}
            for e in found.events
        ],
        "notes": list(found.notes),
        "lent_compliance": found.assembly.lent_compliance,
    }


def write_path(
    found: PathResult, point: ControlPoint, place: Path, language: Literal["en", "it"], *, first: str = ""
) -> None:
    """Write summary, curve, events, figure, a report with a slider of load steps, and the last state's results."""
    from matplotlib.figure import Figure

    from concio.plot.path_accessor import PathPlots

    text = json.dumps(path_facts(found, point), indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    write_csv(found.tables.curve(point), place / "path.csv")
    write_csv(found.tables.events(), place / "events.csv")
    figure = PathPlots(found).stages(point=point)[0].figure
    assert isinstance(figure, Figure)
    for form in ("png", "svg"):
        figure.savefig(place / f"path.{form}", dpi=150)
    write_result(found.result(), place / "end", report=False)
    write_path_report(found, place / "report.html", point=point, language=language, first=first)
