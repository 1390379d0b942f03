"""What ``concio assess --out`` writes: the report, its numbers, and the capacity curves."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from concio.analysis.seismic.assessment import Assessment
from concio.cli.outcome import write_verdict
from concio.io.csv_table import write_csv
from concio.report.assessment_page import AssessmentReport, write_assessment_report


def write_assessment(
    found: Assessment, told: dict[str, Any], place: Path, language: str, *, docx: bool = False, **options: Any
) -> list[str]:
    """Write report, summary and curves into a directory; return the names of the files."""
    text = json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    write_assessment_report(found, place / "report.html", language=language, **options)
    written = ["report.html", "summary.json"]
    if language != "en":
        written += write_verdict(place, AssessmentReport(found, language=language).told, language)
    if docx:
        write_assessment_report(found, place / "report.docx", language=language, **options)
        written.append("report.docx")
    curves = [m for m in found.mechanisms if len(m.followed.displacement) > 1]
    if curves:
        columns: dict[str, list[Any]] = {k: [] for k in ("mechanism", "push", "d_C", "alpha", "d", "a")}
        for m in curves:
            d, a = m.spectral_curve(m.followed)
            n = len(d)
            columns["mechanism"] += [m.name] * n
            columns["push"] += [m.direction] * n
            for key, values in (("d_C", m.followed.displacement), ("alpha", m.followed.multiplier), ("d", d), ("a", a)):
                columns[key] += values.tolist()
        write_csv({k: np.array(v) for k, v in columns.items()}, place / "curves.csv")
        written.append("curves.csv")
    return written
