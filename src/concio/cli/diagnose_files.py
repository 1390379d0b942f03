"""What ``concio diagnose --out`` writes: the report, its numbers, its figures, and the residuals as a table."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.cracks.diagnosis import Diagnosis
from concio.cli.outcome import plain, write_verdict
from concio.io.csv_table import write_csv
from concio.plot.diagnosis_figure import plot_causes, plot_cracks, plot_readings
from concio.report.diagnosis_page import write_diagnosis_report
from concio.verdict.diagnosis_verdict import diagnosis_verdict


def write_diagnosis(
    found: Diagnosis, told: Mapping[str, Any], place: Path, language: str, head: Mapping[str, str]
) -> list[str]:
    """Write report, summary, figures and residuals into a directory; return the names of the files."""
    text = json.dumps(plain(told), indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    write_diagnosis_report(found, place / "report.html", language=language, head=head)
    written = ["report.html", "summary.json"]
    if language != "en":
        written += write_verdict(place, diagnosis_verdict(found, language), language)
    best = found.best
    if best is None:
        return written
    table = {
        "name": np.array([m.name for m in found.measurements]),
        "kind": np.array([m.kind for m in found.measurements]),
        "measured [m or rad]": np.array([m.value for m in found.measurements]),
        "error [m or rad]": np.array([m.error for m in found.measurements]),
    }
    for k, cause in enumerate(found.shown, 1):
        table[f"predicted by cause {k} [m or rad]"] = cause.predicted
        table[f"residual of cause {k} [errors]"] = cause.residual
    write_csv(table, place / "measurements.csv")
    written.append("measurements.csv")
    figures = {"readings": plot_readings(found, language=language), "causes": plot_causes(found, language=language)}
    if found.model.dim == 2:
        figures["cracks"] = plot_cracks(found, language=language)
    for name, axes in figures.items():
        figure = axes.get_figure(root=True)
        assert figure is not None
        for form in ("png", "svg"):
            figure.savefig(place / f"{name}.{form}", dpi=150)
            written.append(f"{name}.{form}")
    return written
