"""What ``concio path`` prints and writes: stages, events with the names of their joints, and the curve."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.path import ControlPoint, PathResult
from concio.io.csv_table import write_csv
from concio.io.result_dir import write_result
from concio.report.page import write_report

Array = np.ndarray
MOST_STEPS = 40
"""Steps the slider of the report shows."""
SLIGHT = 1e-9
"""Components of a direction below this are rounding."""
MOST_EVENTS = 30
"""More events than this are counted, unless all are asked for."""


@dataclass(frozen=True)
class Mark:
    """An event where it lies on the curve."""

    parameter: float
    control: float
    kind: str


@dataclass(frozen=True, eq=False)
class Curve:
    """Load parameter, counted through the stages, against the motion of a point."""

    parameter: Array
    control: Array
    events: tuple[Mark, ...]


def curve_point(found: PathResult) -> ControlPoint:
    """Return the point that moved most in the end, in the direction in which it moved."""
    end = found.result()
    best: tuple[float, ControlPoint] | None = None
    for b, body in enumerate(found.assembly.model.bodies):
        if body.kind == "fixed":
            continue
        motion = end.node_displacement(b)
        size = np.linalg.norm(motion, axis=1)
        k = int(size.argmax())
        if best is None or size[k] > best[0]:
            at, u = end.nodes(b)[k], motion[k] / size[k] if size[k] > 0 else np.eye(motion.shape[1])[-1]
            u = np.where(np.abs(u) > SLIGHT, u, 0.0)
            best = float(size[k]), ControlPoint(body.name, tuple(map(float, at)), tuple(map(float, u)))
    assert best is not None  # a model without free bodies is not assembled
    return best[1]


def curve_of(found: PathResult, point: ControlPoint) -> Curve:
    """Return the curve of a path; stage k runs from k - 1 to k where its factors are reached."""
    motion, parameter = found.curve(point)
    through = parameter + np.array([step.stage for step in found.steps])
    marks = tuple(Mark(e.stage + e.parameter, float(motion[e.step]), e.kind) for e in found.events)
    return Curve(through, motion, marks)


def path_lines(found: PathResult, point: ControlPoint, *, every: bool) -> list[str]:
    """Return the path as lines of text."""
    lines = [found.assembly.model.title or "model without a title"]
    motion, _ = found.curve(point)
    for k, outcome in enumerate(found.outcomes):
        own = [i for i, step in enumerate(found.steps) if step.stage == k]
        events = [e for e in found.events if e.stage == k]
        moved = f", {1e3 * motion[own[-1]]:+.4g} mm at the end" if own else ""
        lines.append(
            f"stage {found.stages[k].name}: {outcome.value} {len(events):,} events; at most {found.peak(k):.6g} of it"
            f"{moved}"
        )
        shown = events if every else events[:MOST_EVENTS]
        lines += [f"  {event}" for event in shown]
        if len(events) > len(shown):
            lines.append(f"  ... and {len(events) - len(shown):,} more (--all lists them)")
    lines += list(found.notes)
    for later in found.stages[len(found.outcomes) :]:
        lines.append(f"stage {later.name}: not begun")
    at, along = ", ".join(f"{x:.4g}" for x in point.at), ", ".join(f"{x:.3g}" for x in point.direction)
    lines += [
        f"  point        '{point.body}' at ({at}) m, moving along ({along})",
        f"  certificate  worst {found.certificate:.1e} of {len(found.steps):,} states; energy closed to "
        f"{found.energy_error:.1e}",
    ]
    return lines


def path_facts(found: PathResult, point: ControlPoint) -> dict[str, Any]:
    """Return the path as plain types."""
    motion, parameter = found.curve(point)
    return {
        "status": "solved" if found.complete else found.outcomes[-1].name.lower(),
        "title": found.assembly.model.title,
        "stages": [
            {
                "name": stage.name,
                "factors": dict(stage.factors),
                "outcome": outcome.name.lower(),
                "peak": found.peak(k),
            }
            for k, (stage, outcome) in enumerate(zip(found.stages, found.outcomes, strict=False))
        ],
        "certificate": {"worst": found.certificate},
        "energy_error": found.energy_error,
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
    }


def write_path(found: PathResult, point: ControlPoint, place: Path) -> None:
    """Write summary, curve, events, figure, a report with a slider of load steps, and the last state's results."""
    from matplotlib.figure import Figure

    from concio.plot.path_figure import plot_path

    text = json.dumps(path_facts(found, point), indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    motion, parameter = found.curve(point)
    curve = {
        "stage [-]": np.array([step.stage + 1 for step in found.steps]),
        "parameter [-]": parameter,
        "displacement [m]": motion,
        **{f"factor {g} [-]": np.array([s.factors[g] for s in found.steps]) for g in found.assembly.groups},
    }
    write_csv(curve, place / "path.csv")
    events = {
        "stage [-]": np.array([e.stage + 1 for e in found.events]),
        "parameter [-]": np.array([e.parameter for e in found.events]),
        "kind": np.array([e.kind for e in found.events]),
        "body_a": np.array([e.bodies[0] for e in found.events]),
        "body_b": np.array([e.bodies[1] for e in found.events]),
        **{
            f"{axis} [m]": np.array([e.at[k] for e in found.events])
            for k, axis in enumerate("xyz"[: found.assembly.model.dim])
        },
    }
    write_csv(events, place / "events.csv")
    label = "stage and load factor within it [-]" if len(found.outcomes) > 1 else "load factor [-]"
    axes = plot_path(
        curve_of(found, point),
        control_label=f"displacement of '{point.body}' [m]",
        parameter_label=label,
        title=found.assembly.model.title or "Load path",
    )
    figure = axes.figure
    assert isinstance(figure, Figure)
    for form in ("png", "svg"):
        figure.savefig(place / f"path.{form}", dpi=150)
    write_result(found.result(), place / "end")
    chosen = report_steps(found)
    labels = [f"{found.stages[found.steps[i].stage].name} at {found.steps[i].parameter:.4g}" for i in chosen]
    write_report([found.result(i) for i in chosen], place / "report.html", labels=labels, figures=False)


def report_steps(found: PathResult) -> list[int]:
    """Return the steps the slider of the report shows: all, or some evenly chosen, with the end of every stage."""
    count = len(found.steps)
    ends = {max(i for i, s in enumerate(found.steps) if s.stage == k) for k in {s.stage for s in found.steps}}
    spread = np.linspace(0, count - 1, min(count, MOST_STEPS)).round().astype(int)
    return sorted(ends | {int(i) for i in spread})
