"""What ``concio limit --out`` writes: numbers, a figure of each mechanism, and the report."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from concio.analysis.limit import LimitResult
from concio.report.limit_page import write_limit_report
from concio.report.page import view_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def write_limit(
    found: LimitResult, told: dict[str, Any], place: Path, language: Literal["en", "it"] = "en"
) -> list[str]:
    """Write ``summary.json``, the figures there are and the report; return the names of the files."""
    text = json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    written, plots = ["summary.json"], found.plot
    if found.associated.mechanism is not None:
        written += _save(plots.mechanism(), place / "associated_mechanism")
    if found.collapse_state is not None:
        written += _save(plots.collapse_state(), place / "collapse_state")
    if found.path is not None and np.abs(found.path.direction).any():
        written += _save(plots.path_mechanism(), place / "path_mechanism")
    motions = plots.motions()
    if motions:
        shown = {**view_of([result for _, result in motions], [words for words, _ in motions]), "alternatives": True}
        (place / "motions.json").write_text(json.dumps(shown, allow_nan=False), encoding="utf-8")
        written.append("motions.json")
    write_limit_report(found, place / "report.html", language=language)
    return [*written, "report.html"]


def _save(axes: Axes, place: Path) -> list[str]:
    """Write a figure as PNG and SVG; return the names of the files."""
    from matplotlib.figure import Figure

    figure = axes.figure
    assert isinstance(figure, Figure)
    names = [f"{place.name}.{form}" for form in ("png", "svg")]
    for name in names:
        figure.savefig(place.with_name(name), dpi=150)
    return names
