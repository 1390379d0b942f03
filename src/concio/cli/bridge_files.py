"""What ``concio bridge --out`` writes: report, numbers, the curve over positions, sensitivities, figures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Literal

import numpy as np

from concio.analysis.bridges.bridge_result import BridgeResult
from concio.io.csv_table import write_csv
from concio.report.bridge_page import write_bridge_report
from concio.verdict.bridge_verdict import bridge_verdict


def write_bridge(found: BridgeResult, told: dict[str, Any], place: Path, language: Literal["en", "it"]) -> list[str]:
    """Write summary, curve and sensitivities into a directory; return the names of the files."""
    from concio.cli.outcome import plain, write_verdict

    text = json.dumps(plain(told), indent=2, ensure_ascii=False, allow_nan=False)
    (place / "summary.json").write_text(text + "\n", encoding="utf-8")
    write_csv(found.curve(), place / "curve.csv")
    write_bridge_report(found, place / "report.html", language=language)
    written = ["report.html", "summary.json", "curve.csv"]
    if language != "en":
        written += write_verdict(place, bridge_verdict(found, language), language)
    if found.changes:
        columns = {key: np.array([getattr(c, key) for c in found.changes])
                   for key in ("name", "unit", "low", "high", "at_low", "at_high")}  # fmt: skip
        write_csv(columns, place / "sensitivity.csv")
        written.append("sensitivity.csv")
    figures = {"curve": found.plot.curve, "mechanism": found.plot.mechanism, "sensitivity": found.plot.changes}
    for name, draw in figures.items():
        if not {"mechanism": found.worst.limit.mechanism, "sensitivity": found.changes}.get(name, True):
            continue
        figure = draw().get_figure(root=True)
        figure.savefig(place / f"{name}.png", dpi=150)
        written.append(f"{name}.png")
    return written
